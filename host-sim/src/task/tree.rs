//! The behavior trees of the robots of a task: their aims one after the other, or from a file.

use super::mission::TaskError;
use super::read::TableMission;
use crate::tree::{BoundTree, Diagnostic, Document, Instance, LeafNode};
use firmware::TaskLeaf;
use iibt_core::iibt::table::{Aim, Role, TablesError};
use iibt_core::tree::{Full, Node, OwnedTree, Row};

/// The tree of a robot: aims and facts of its role, and [`SKILLS`] by their numbers.
pub type TaskTree = BoundTree<TaskLeaf<u8>>;

/// The names of the skills that robots in simulation have, those of [`firmware::Finished`].
pub const SKILLS: [&str; 1] = ["finished"];

/// The number of the skill that is done when the robot has pursued its aims.
const FINISHED: u8 = 0;

/// A tree as the robots in simulation tick it.
pub(super) type FlownTree = OwnedTree<TaskLeaf<()>, Vec<Row<TaskLeaf<()>>>, Full>;

impl TableMission<'_> {
    /// Gives the robots the trees of a file: each the one that has its name, else the main tree.
    ///
    /// The actions are `Pursue` with the port `aim` and `Do` with `skill`, the conditions `Reached`
    /// with `aim`, `Holds` with `fact` and `Has` with `skill`. A port has a name of the robot's
    /// role, or a number.
    ///
    /// # Errors
    /// What is wrong with the file, with its places.
    pub fn with_trees(mut self, document: &Document) -> Result<Self, Vec<Diagnostic>> {
        let trees = self.tables.roles().iter().map(|role| tree_of(role, document));
        self.trees = Some(trees.collect::<Result<_, _>>()?);
        Ok(self)
    }

    /// Returns the tree of a robot.
    ///
    /// # Errors
    /// [`TaskError`] when there is no such robot, or it has more aims than a tree can have.
    pub fn tree(&self, robot: usize) -> Result<TaskTree, TaskError> {
        let none = TablesError { role: None, table: "roles", row: None, reason: "there is no such robot" };
        let role = self.tables.role(robot).ok_or(none)?;
        match self.trees.as_ref().and_then(|trees| trees.get(robot)) {
            Some(tree) => Ok(tree.clone()),
            None => Ok(of_aims(role.aims)?),
        }
    }
}

/// The aims one after the other, and then nothing more.
fn of_aims(aims: &[Aim<'_>]) -> Result<TaskTree, TablesError> {
    let too_many = TablesError { role: None, table: "aims", row: None, reason: "a robot has at most 250" };
    let aims = u8::try_from(aims.len()).ok().filter(|&aims| aims <= 250).ok_or(too_many)?;
    let finished = TaskLeaf::Own(FINISHED);
    let mut nodes = vec![Node::Fallback(2), Node::Condition(finished), Node::Sequence(aims + 1)];
    nodes.extend((0..aims).map(|aim| Node::Inference(TaskLeaf::Aim(aim))));
    nodes.push(Node::Action(finished));
    OwnedTree::try_new(nodes.into_iter().map(Row::new).collect()).map_err(|_| too_many)
}

/// The tree for a role in a file.
fn tree_of(role: &Role<'_>, document: &Document) -> Result<TaskTree, Vec<Diagnostic>> {
    let named = document.tree_names().find(|&name| name == role.name);
    let main = document.main_tree(named).map_err(|error| vec![error])?;
    let instance = Instance::of(document, &main)?;
    let reached = instance.check_reach().and_then(|()| instance.bind(|leaf| leaf_of(leaf, role)));
    reached.map_err(|error| vec![error])
}

fn leaf_of(leaf: &LeafNode, role: &Role<'_>) -> Result<TaskLeaf<u8>, String> {
    let port = match leaf.kind.as_str() {
        "Pursue" | "Reached" => "aim",
        "Holds" => "fact",
        "Do" | "Has" => "skill",
        kind => {
            let known = "Pursue, Do, Reached, Holds and Has";
            return Err(format!("the robots of a task have no leaf '{kind}', but {known}"));
        }
    };
    let name = leaf.port(port).ok_or_else(|| format!("{} needs the port '{port}'", leaf.kind))?;
    match port {
        "aim" => number(port, name, role.aims.iter().map(|aim| aim.name)).map(TaskLeaf::Aim),
        "fact" => number(port, name, role.facts.iter().map(|fact| fact.name)).map(TaskLeaf::Fact),
        _ => skill(name).map(TaskLeaf::Own),
    }
}

/// The number of an aim or a fact by its name, or as it is written.
fn number<'n>(what: &str, text: &str, names: impl Iterator<Item = &'n str>) -> Result<u8, String> {
    let names: Vec<_> = names.collect();
    let Some(last) = names.len().checked_sub(1) else {
        return Err(format!("there is no {what} '{text}': there is none at all"));
    };
    let by_name = names.iter().position(|&name| name == text);
    let number = by_name.or_else(|| text.parse().ok()).filter(|&number| number <= last);
    let number = number.and_then(|number| u8::try_from(number).ok());
    number
        .ok_or_else(|| format!("there is no {what} '{text}': there are {}, or 0 to {last}", names.join(", ")))
}

/// The number of a skill: any, since an image of one's own may have others.
fn skill(text: &str) -> Result<u8, String> {
    let by_name = SKILLS.iter().position(|&name| name == text).map(|number| number as u8);
    by_name.or_else(|| text.parse().ok()).ok_or_else(|| {
        format!("there is no skill '{text}': there are {}, or numbers from 0 to 255", SKILLS.join(", "))
    })
}

/// The tree for the robots in simulation.
pub(super) fn flown(tree: &TaskTree) -> Result<FlownTree, TaskError> {
    let with_skills = |leaf| match leaf {
        TaskLeaf::Aim(aim) => Ok(TaskLeaf::Aim(aim)),
        TaskLeaf::Fact(fact) => Ok(TaskLeaf::Fact(fact)),
        TaskLeaf::Own(FINISHED) => Ok(TaskLeaf::Own(())),
        TaskLeaf::Own(skill) => Err(TaskError::NoSkill(skill)),
    };
    let rows = tree.by_ref().nodes().map(|node| Ok(Row::new(node.try_map(with_skills)?)));
    let rows = rows.collect::<Result<_, TaskError>>()?;
    // What was a tree is one under other names.
    OwnedTree::try_new(rows).map_err(|_| TaskError::NoTree)
}
