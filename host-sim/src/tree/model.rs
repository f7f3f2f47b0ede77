//! Models: which kinds of nodes there are, and which ports they have.

use super::diagnostic::{Place, Remarks};
use super::value::{Fit, ValueType};
use super::xml::Element;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The class of a node: what it is to its parent and children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// One or more children.
    Control,
    /// One child.
    Decorator,
    /// A leaf that may take several ticks.
    Action,
    /// A leaf that answers at once.
    Condition,
    /// Stands for another tree.
    SubTree,
}

impl Class {
    const ALL: [Self; 5] = [Self::Control, Self::Decorator, Self::Action, Self::Condition, Self::SubTree];

    /// The tag of the explicit form and of the models.
    #[must_use]
    pub fn tag(self) -> &'static str {
        match self {
            Self::Control => "Control",
            Self::Decorator => "Decorator",
            Self::Action => "Action",
            Self::Condition => "Condition",
            Self::SubTree => "SubTree",
        }
    }

    pub(super) fn with_tag(tag: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.tag() == tag)
    }
}

/// The direction in which a port carries values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Into the node.
    Input,
    /// Out of the node.
    Output,
    /// Both.
    InOut,
}

impl Direction {
    const ALL: [Self; 3] = [Self::Input, Self::Output, Self::InOut];

    /// The tag of the models.
    #[must_use]
    pub fn tag(self) -> &'static str {
        match self {
            Self::Input => "input_port",
            Self::Output => "output_port",
            Self::InOut => "inout_port",
        }
    }
}

/// A named value that a node reads or writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// The name, which is that of the attribute.
    pub name: String,
    /// Its direction.
    pub direction: Direction,
    /// The type of its value.
    pub kind: ValueType,
    /// The default value of an input whose attribute is missing.
    pub default: Option<String>,
    /// Its description.
    pub description: String,
}

/// A kind of node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeModel {
    /// The tag of its nodes.
    pub id: String,
    /// Its class.
    pub class: Class,
    /// Its ports.
    pub ports: Vec<Port>,
    /// Whether it needs no declaration.
    pub is_built_in: bool,
}

impl NodeModel {
    /// The port with a name.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<&Port> {
        self.ports.iter().find(|port| port.name == name)
    }

    /// A leaf without ports of its own.
    pub(super) fn leaf(id: &str) -> Self {
        Self { id: id.into(), class: Class::Action, ports: Vec::new(), is_built_in: false }
    }
}

/// The leaf that plays the script of statuses in its port `s`.
pub(super) const SCRIPTED: &str = "L";

type PortRow = (&'static str, &'static str, Option<&'static str>);

const CONTROLS: &[(&str, &[PortRow])] = &[
    ("Sequence", &[]),
    ("AsyncSequence", &[]),
    ("SequenceWithMemory", &[]),
    ("ReactiveSequence", &[]),
    ("Fallback", &[]),
    ("AsyncFallback", &[]),
    ("ReactiveFallback", &[]),
    ("Parallel", &[("success_count", "int", Some("-1")), ("failure_count", "int", Some("1"))]),
    ("ParallelAll", &[("max_failures", "int", Some("1"))]),
    ("IfThenElse", &[]),
    ("WhileDoElse", &[]),
    ("TryCatch", &[("catch_on_halt", "bool", Some("false"))]),
    ("PipelineSequence", &[]),
    ("RoundRobin", &[]),
    ("RecoveryNode", &[("number_of_retries", "int", Some("1"))]),
];

const DECORATORS: &[(&str, &[PortRow])] = &[
    ("Inverter", &[]),
    ("ForceSuccess", &[]),
    ("ForceFailure", &[]),
    ("RetryUntilSuccessful", &[("num_attempts", "int", None)]),
    ("Repeat", &[("num_cycles", "int", None)]),
    ("KeepRunningUntilFailure", &[]),
    ("Timeout", &[("msec", "unsigned int", None)]),
    ("Delay", &[("delay_msec", "unsigned int", None)]),
    ("RunOnce", &[("then_skip", "bool", Some("true"))]),
    ("Precondition", &[("if", "string", None), ("else", "NodeStatus", Some("FAILURE"))]),
    ("SkipUnlessUpdated", &[("entry", "", None)]),
    ("WaitValueUpdate", &[("entry", "", None)]),
    ("RateController", &[("hz", "double", Some("10.0"))]),
];

const ACTIONS: &[(&str, &[PortRow])] = &[
    ("AlwaysSuccess", &[]),
    ("AlwaysFailure", &[]),
    ("Sleep", &[("msec", "unsigned int", None)]),
    ("Script", &[("code", "string", None)]),
    ("SetBlackboard", &[("value", "", None), ("output_key", "", None)]),
    ("UnsetBlackboard", &[("key", "string", None)]),
    ("WasEntryUpdated", &[("entry", "", None)]),
    (SCRIPTED, &[("s", "string", None)]),
];

const CONDITIONS: &[(&str, &[PortRow])] = &[("ScriptCondition", &[("code", "", None)])];

const LOOPS: [(&str, &str); 4] =
    [("LoopInt", "int"), ("LoopBool", "bool"), ("LoopDouble", "double"), ("LoopString", "string")];

/// All kinds of nodes, by their names.
pub(super) type Models = BTreeMap<String, Arc<NodeModel>>;

/// The kinds of nodes that need no declaration: BehaviorTree.CPP's, four of Nav2's, and the
/// scripted leaf.
pub(super) fn built_in() -> Models {
    let groups = [
        (Class::Control, CONTROLS),
        (Class::Decorator, DECORATORS),
        (Class::Action, ACTIONS),
        (Class::Condition, CONDITIONS),
        (Class::SubTree, &[("SubTree", &[][..])]),
    ];
    let rows = groups.into_iter().flat_map(|(class, rows)| rows.iter().map(move |row| (class, row)));
    let plain = rows.map(|(class, (id, ports))| built_in_model(class, id, ports.iter().map(port).collect()));
    let switches = (2..=6).map(|cases| {
        let cases = (1..=cases).map(|case| format!("case_{case}"));
        let names = std::iter::once("variable".to_owned()).chain(cases);
        let ports = names.map(|name| input(&name, ValueType::Text, None)).collect::<Vec<_>>();
        built_in_model(Class::Control, &format!("Switch{}", ports.len() - 1), ports)
    });
    let loops = LOOPS.into_iter().map(|(id, kind)| {
        let inout = Port { direction: Direction::InOut, ..input("queue", ValueType::Any, None) };
        let value = Port { direction: Direction::Output, ..input("value", ValueType::named(kind), None) };
        let ports = vec![inout, input("if_empty", ValueType::Status, Some("SUCCESS")), value];
        built_in_model(Class::Decorator, id, ports)
    });
    plain.chain(switches).chain(loops).map(|model| (model.id.clone(), Arc::new(model))).collect()
}

fn built_in_model(class: Class, id: &str, ports: Vec<Port>) -> NodeModel {
    NodeModel { id: id.into(), class, ports, is_built_in: true }
}

fn port(&(name, kind, default): &PortRow) -> Port {
    let direction = if name == "output_key" { Direction::InOut } else { Direction::Input };
    Port { direction, ..input(name, ValueType::named(kind), default) }
}

fn input(name: &str, kind: ValueType, default: Option<&str>) -> Port {
    Port {
        name: name.into(),
        direction: Direction::Input,
        kind,
        default: default.map(str::to_owned),
        description: String::new(),
    }
}

/// Reads the ports of one entry of `<TreeNodesModel>`.
pub(super) fn ports_of(entry: &Element, remarks: &mut Remarks) -> Vec<Port> {
    let mut ports: Vec<Port> = Vec::new();
    for child in &entry.children {
        let Some(direction) = Direction::ALL.into_iter().find(|direction| direction.tag() == child.tag)
        else {
            if !matches!(child.tag.as_str(), "description" | "MetadataFields" | "Metadata") {
                remarks.warning(&child.place, format!("<{}> means nothing in a model of a node", child.tag));
            }
            continue;
        };
        let Some(name) = child.attribute("name") else {
            remarks.error(&child.place, "this port has no attribute 'name'");
            continue;
        };
        if let Err(reason) = port_name(&name.value) {
            remarks.error(&name.place, reason);
        }
        if ports.iter().any(|port| port.name == name.value) {
            remarks.error(&name.place, format!("the port '{}' is declared twice", name.value));
            continue;
        }
        let kind = ValueType::named(child.value("type").unwrap_or_default());
        if let Some(default) = child.attribute("default")
            && super::value::pointer(&default.value).is_none()
            && kind.fit(&default.value) == Fit::None
        {
            let reason =
                format!("the default '{}' of port '{}' is no {}", default.value, name.value, kind.name());
            remarks.error(&default.place, reason);
        }
        ports.push(Port {
            name: name.value.clone(),
            direction,
            kind,
            default: child.value("default").map(str::to_owned),
            description: child.value("description").map_or_else(|| child.text.clone(), str::to_owned),
        });
    }
    ports
}

/// The attributes of a node that are no ports.
pub(super) const PRE_CONDITIONS: [&str; 4] = ["_failureIf", "_successIf", "_skipIf", "_while"];

/// Scripts that run after a node has ended.
pub(super) const POST_CONDITIONS: [&str; 4] = ["_onHalted", "_onFailure", "_onSuccess", "_post"];

/// Whether an attribute is that of a port.
pub(super) fn is_port(name: &str) -> bool {
    !matches!(name, "name" | "ID" | "_autoremap")
        && name.starts_with(|sign: char| sign.is_ascii_alphabetic())
        && forbidden(name).is_none()
}

/// Returns why a name cannot be that of a port.
pub(super) fn port_name(name: &str) -> Result<(), String> {
    let reserved = ["name", "ID", "_autoremap"];
    if name.is_empty() {
        Err("the name of a port is empty".into())
    } else if reserved.iter().chain(&PRE_CONDITIONS).chain(&POST_CONDITIONS).any(|word| *word == name) {
        Err(format!("no port may be called '{name}': the word is reserved"))
    } else if let Some(sign) = forbidden(name) {
        Err(format!("the name of port '{name}' has the forbidden character {sign:?}"))
    } else if !name.starts_with(|sign: char| sign.is_ascii_alphabetic()) {
        Err(format!("the name of port '{name}' must start with a letter"))
    } else {
        Ok(())
    }
}

/// Returns why a name cannot be that of a tree or a kind of node.
pub(super) fn model_name(name: &str) -> Result<(), String> {
    if name.is_empty() {
        Err("the ID is empty".into())
    } else if matches!(name, "Root" | "root") {
        Err(format!("'{name}' is a reserved word"))
    } else if let Some(sign) = forbidden(name) {
        Err(format!("the ID '{name}' has the forbidden character {sign:?}"))
    } else {
        Ok(())
    }
}

/// The first character of a name that breaks files or editors.
fn forbidden(name: &str) -> Option<char> {
    let is_forbidden = |sign: &char| sign.is_ascii_control() || " <>&\"'/\\:*?|.".contains(*sign);
    name.chars().find(is_forbidden)
}

/// A model of a tree's ports, from `<TreeNodesModel>`.
#[derive(Clone, Debug)]
pub(super) struct SubTreeModel {
    pub id: String,
    pub ports: Vec<Port>,
    pub place: Place,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_nodes_are_there_with_their_ports() {
        let models = built_in();
        assert_eq!(models.len(), 47);
        assert_eq!(models["Switch3"].ports.len(), 4);
        assert_eq!(models["Parallel"].port("success_count").unwrap().default.as_deref(), Some("-1"));
        assert_eq!(models["Timeout"].port("msec").unwrap().kind, ValueType::Unsigned);
        assert!(models.values().all(|model| model.is_built_in && model_name(&model.id).is_ok()));
    }

    #[test]
    fn names_that_break_editors_are_refused() {
        assert!(port_name("goal").is_ok() && model_name("Move To").is_err());
        for name in ["", "1st", "a.b", "a b", "name", "_while", "_private"] {
            assert!(port_name(name).is_err(), "{name}");
        }
    }
}
