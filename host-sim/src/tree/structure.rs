//! Checks of a file before its SubTrees are expanded: tags, IDs and numbers of children.

use super::diagnostic::Remarks;
use super::model::{self, Class, Models};
use super::xml::Element;

/// The deepest nesting of nodes in one tree.
const MAX_NESTING: usize = 256;

/// Remarks on the file with this root.
pub(super) fn verify(root: &Element, models: &Models, remarks: &mut Remarks) {
    if root.tag != "root" {
        remarks.error(&root.place, format!("the first element must be <root>, not <{}>", root.tag));
        return;
    }
    format(root, remarks);
    if let Some(second) = root.children_called("TreeNodesModel").nth(1) {
        remarks.error(&second.place, "a file has one <TreeNodesModel>, this is a second one");
    }
    let only = root.children.len() == 1;
    for child in &root.children {
        match child.tag.as_str() {
            "BehaviorTree" => tree(child, only, models, remarks),
            "TreeNodesModel" | "include" => {}
            tag if Class::with_tag(tag).is_some() && child.attribute("ID").is_none() => {
                remarks.error(
                    &child.place,
                    format!("<{tag}> must have the attribute 'ID', and stands in a tree or a model"),
                );
            }
            tag => {
                let message =
                    format!("<{tag}> means nothing here: <BehaviorTree>, <TreeNodesModel> or <include>");
                remarks.warning(&child.place, message);
            }
        }
    }
}

fn format(root: &Element, remarks: &mut Remarks) {
    match root.attribute("BTCPP_format") {
        None => remarks.warning(&root.place, "<root> should have the attribute BTCPP_format=\"4\""),
        Some(format) if format.value != "4" => {
            let message = format!("format '{}' is read as if it were 4", format.value);
            remarks.warning(&format.place, message);
        }
        Some(_) => {}
    }
}

fn tree(tree: &Element, only: bool, models: &Models, remarks: &mut Remarks) {
    match tree.attribute("ID") {
        None if !only => {
            let message = "<BehaviorTree> needs the attribute 'ID' when it is not all there is in the file";
            remarks.error(&tree.place, message);
        }
        None => {}
        Some(id) => {
            if let Err(reason) = model::model_name(&id.value) {
                remarks.error(&id.place, reason);
            } else if models.contains_key(&id.value) {
                remarks.error(
                    &id.place,
                    format!("a tree cannot be called '{}', as a kind of node is", id.value),
                );
            }
        }
    }
    if tree.children.len() != 1 {
        let count = tree.children.len();
        remarks.error(&tree.place, format!("<BehaviorTree> must have exactly 1 child, here are {count}"));
    }
    tree.children.iter().for_each(|child| node(child, 1, models, remarks));
}

fn node(element: &Element, depth: usize, models: &Models, remarks: &mut Remarks) {
    if depth > MAX_NESTING {
        remarks.error(&element.place, format!("nodes are nested more than {MAX_NESTING} deep"));
        return;
    }
    if !element.text.is_empty() {
        remarks.warning(&element.place, format!("the text in <{}> means nothing", element.tag));
    }
    if let Some(id) = identity(element, models, remarks) {
        if element.tag == "SubTree" {
            subtree(element, id, models, remarks);
        } else {
            known_node(element, id, models, remarks);
        }
    }
    element.children.iter().for_each(|child| node(child, depth + 1, models, remarks));
}

/// The kind of node that an element stands for: its tag in the compact form, its ID in the explicit
/// one.
fn identity<'e>(element: &'e Element, models: &Models, remarks: &mut Remarks) -> Option<&'e str> {
    let tag = element.tag.as_str();
    if Class::with_tag(tag).is_none() {
        if let Some(id) = element.attribute("ID") {
            remarks.error(&id.place, format!("<{tag}> cannot have the attribute 'ID'"));
        }
        return Some(tag);
    }
    let id = element.attribute("ID").filter(|id| !id.value.is_empty());
    let Some(id) = id else {
        remarks.error(&element.place, format!("<{tag}> must have the attribute 'ID'"));
        return None;
    };
    let class = models.get(&id.value).map(|model| model.class);
    if let Some(class) = class.filter(|class| class.tag() != tag && tag != "SubTree") {
        remarks.warning(&id.place, format!("'{}' is {}, not {tag}", id.value, class.tag()));
    }
    Some(&id.value)
}

fn subtree(element: &Element, id: &str, models: &Models, remarks: &mut Remarks) {
    if !element.children.is_empty() {
        remarks.error(&element.place, format!("<SubTree ID=\"{id}\"> must have no children"));
    }
    if let Err(reason) = model::model_name(id) {
        remarks.error(&element.place, reason);
    } else if models.contains_key(id) {
        remarks.error(&element.place, format!("'{id}' is a kind of node, not a tree"));
    }
}

fn known_node(element: &Element, id: &str, models: &Models, remarks: &mut Remarks) {
    if let Err(reason) = model::model_name(id) {
        remarks.error(&element.place, reason);
        return;
    }
    let Some(model) = models.get(id) else {
        let old = match id {
            "SequenceStar" => "; version 4 calls it SequenceWithMemory",
            "SubTreePlus" => "; version 4 calls it SubTree",
            _ => "",
        };
        let nearest =
            nearest(id, models).map_or_else(String::new, |name| format!("; did you mean '{name}'?"));
        let hint = if !old.is_empty() {
            old.to_owned()
        } else if nearest.is_empty() {
            format!("; declare it in <TreeNodesModel>{}", declaration(element, id))
        } else {
            nearest
        };
        remarks.error(&element.place, format!("there is no kind of node called '{id}'{hint}"));
        return;
    };
    children(element, id, model.class, remarks);
    if id == "ReactiveSequence" {
        children_of_reactive_sequence(element, models, remarks);
    }
}

/// How a leaf is declared that has the ports that it is given here.
fn declaration(element: &Element, id: &str) -> String {
    if !element.children.is_empty() {
        return String::new();
    }
    let names = element.attributes.iter().map(|attribute| attribute.name.as_str());
    let ports = names.filter(|name| !name.starts_with('_') && !["ID", "name"].contains(name));
    let ports: String = ports.map(|name| format!("<input_port name=\"{name}\"/>")).collect();
    let leaf = |tag: &str| match ports.as_str() {
        "" => format!("<{tag} ID=\"{id}\"/>"),
        ports => format!("<{tag} ID=\"{id}\">{ports}</{tag}>"),
    };
    format!(": {}, or {}", leaf("Action"), leaf("Condition"))
}

fn nearest<'m>(id: &str, models: &'m Models) -> Option<&'m str> {
    let similarity = |name: &str| strsim::jaro_winkler(&name.to_lowercase(), &id.to_lowercase());
    let best = models.keys().max_by(|a, b| similarity(a).total_cmp(&similarity(b)))?;
    (similarity(best) > 0.88).then_some(best)
}

fn children(element: &Element, id: &str, class: Class, remarks: &mut Remarks) {
    let count = element.children.len();
    let rule = match class {
        Class::Control if id == "TryCatch" && count < 2 => "at least 2 children",
        Class::Control if count == 0 => "at least 1 child",
        Class::Decorator if count != 1 => "exactly 1 child",
        Class::Action | Class::Condition if count != 0 => "no children",
        Class::Control => return number_at_run_time(element, id, count, remarks),
        _ => return,
    };
    remarks.error(&element.place, format!("{id} must have {rule}, here are {count}"));
}

/// Numbers of children that BehaviorTree.CPP complains about when the node is first ticked.
fn number_at_run_time(element: &Element, id: &str, count: usize, remarks: &mut Remarks) {
    let rule = match id {
        "IfThenElse" | "WhileDoElse" if !matches!(count, 2 | 3) => "2 or 3 children".to_owned(),
        "RecoveryNode" if count != 2 => "exactly 2 children".to_owned(),
        _ => match id.strip_prefix("Switch").and_then(|cases| cases.parse::<usize>().ok()) {
            Some(cases) if count != cases + 1 => {
                format!("{} children, one for each case and a default", cases + 1)
            }
            _ => return,
        },
    };
    remarks.error(&element.place, format!("{id} must have {rule}, here are {count}"));
}

/// BehaviorTree.CPP wants the compact form here, and at most one asynchronous sequence.
fn children_of_reactive_sequence(element: &Element, models: &Models, remarks: &mut Remarks) {
    for child in element.children.iter().filter(|child| !models.contains_key(&child.tag)) {
        if let (Some(_), Some(id)) = (Class::with_tag(&child.tag), child.value("ID")) {
            let message = format!(
                "a child of ReactiveSequence must be written <{id}>, not <{} ID=\"{id}\">",
                child.tag
            );
            remarks.error(&child.place, message);
        }
    }
    if let Some(second) = element.children_called("AsyncSequence").nth(1) {
        remarks.error(&second.place, "a ReactiveSequence may have only one AsyncSequence among its children");
    }
}
