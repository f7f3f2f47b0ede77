//! An expanded tree: every SubTree in its place, every node with its ports.

use super::diagnostic::{Place, Remarks};
use super::document::Document;
use super::model::{self, Class, Direction, NodeModel, POST_CONDITIONS, PRE_CONDITIONS};
use super::scope::{Scopes, constant_type};
use super::script::Script;
use super::value::{Fit, ValueType, pointer, truth};
use super::xml::{Attribute, Element};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most nodes of a tree with all its SubTrees. The engine's tables hold fewer, as `lower` says.
pub(super) const MAX_NODES: usize = 1 << 15;

/// The most levels of a tree with all its SubTrees: what the engine walks.
pub(super) const MAX_LEVELS: usize = 256;

/// A tree whose SubTrees are expanded. The nodes are in preorder, so that a node's place in the
/// list, plus one, is its unique identifier in BehaviorTree.CPP.
#[derive(Clone, Debug)]
pub struct Instance {
    pub(super) main: String,
    pub(super) nodes: Vec<Node>,
    pub(super) scopes: Scopes,
    /// The instantiated trees: ID, path and root node, the main tree first.
    pub(super) trees: Vec<PlacedTree>,
}

/// A tree and where it stands.
#[derive(Clone, Debug)]
pub(super) struct PlacedTree {
    pub id: String,
    pub path: String,
    pub root: usize,
}

/// A node of a tree.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub model: Arc<NodeModel>,
    pub name: String,
    pub parent: Option<usize>,
    pub children: Vec<usize>,
    pub level: usize,
    pub place: Place,
    pub scope: usize,
    /// The ports that have a value, given or by default.
    pub ports: BTreeMap<String, PortValue>,
    /// Scripts before and after it, in the order in which they are evaluated.
    pub guards: Vec<Guard>,
    /// Whether the leaf is marked as an inference node.
    pub is_inference: bool,
    /// The tree that a SubTree stands for.
    pub subtree: Option<String>,
}

/// The value of a port, as text.
#[derive(Clone, Debug)]
pub(super) struct PortValue {
    pub text: String,
    pub place: Place,
}

/// A pre- or post-condition.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    /// Its attribute, `_skipIf` for example.
    pub attribute: &'static str,
    pub text: String,
    pub script: Script,
    pub place: Place,
}

impl Node {
    pub(super) fn id(&self) -> &str {
        &self.model.id
    }
}

impl Document {
    /// Expands the tree called `main`; what is wrong with it goes to `remarks`.
    pub(super) fn instantiate(&self, main: &str, remarks: &mut Remarks) -> Instance {
        let instance =
            Instance { main: main.into(), nodes: Vec::new(), scopes: Scopes::new(), trees: Vec::new() };
        let mut assembly = Assembly {
            document: self,
            instance,
            remarks,
            ancestors: Vec::new(),
            types: BTreeMap::new(),
            is_full: false,
        };
        let from = Site { parent: None, scope: 0, level: 1, tree_path: "" };
        assembly.tree(main, &self.place, &from);
        assembly.instance
    }
}

/// The place of the next node.
#[derive(Clone, Copy)]
struct Site<'s> {
    parent: Option<usize>,
    scope: usize,
    level: usize,
    /// The path of the tree.
    tree_path: &'s str,
}

struct Assembly<'d> {
    document: &'d Document,
    instance: Instance,
    remarks: &'d mut Remarks,
    ancestors: Vec<String>,
    /// The type of each entry of the blackboard, and the port that gave it.
    types: BTreeMap<(usize, String), (ValueType, Place)>,
    is_full: bool,
}

impl Assembly<'_> {
    fn tree(&mut self, id: &str, user: &Place, site: &Site<'_>) {
        let document = self.document;
        let Some(definition) = document.trees.get(id) else {
            self.remarks.error(user, format!("there is no tree called '{id}'"));
            return;
        };
        if self.ancestors.iter().any(|ancestor| ancestor == id) {
            self.remarks.error(user, format!("the tree '{id}' contains itself"));
            return;
        }
        let root = self.instance.nodes.len();
        self.instance.trees.push(PlacedTree { id: id.into(), path: site.tree_path.into(), root });
        if let Some(root) = &definition.root {
            self.ancestors.push(id.into());
            self.node(root, site);
            self.ancestors.pop();
        }
    }

    fn node(&mut self, element: &Element, site: &Site<'_>) {
        if !self.has_room(element, site.level) {
            return;
        }
        let is_explicit = Class::with_tag(&element.tag).is_some();
        let id = if is_explicit { element.value("ID").unwrap_or_default() } else { &element.tag };
        let is_subtree = element.tag == "SubTree";
        if id.is_empty() {
            return; // The structure's remarks say so.
        }
        let Some(model) = self.document.models.get(if is_subtree { "SubTree" } else { id }) else {
            return; // The structure's remarks say so.
        };
        let index = self.instance.nodes.len();
        let name = element.value("name").unwrap_or(id).to_owned();
        let node = Node {
            model: model.clone(),
            name,
            parent: site.parent,
            children: Vec::new(),
            level: site.level,
            place: element.place.clone(),
            scope: site.scope,
            ports: BTreeMap::new(),
            guards: self.guards(element),
            is_inference: element.value("_inference") == Some("true"),
            subtree: is_subtree.then(|| id.to_owned()),
        };
        self.instance.nodes.push(node);
        if let Some(parent) = site.parent.and_then(|parent| self.instance.nodes.get_mut(parent)) {
            parent.children.push(index);
        }
        self.name(element);
        self.writes(index, site.scope);
        if is_subtree {
            self.subtree(element, id, index, site);
        } else {
            self.ports(element, &model.clone(), index, site.scope);
            self.writes_of_code(index, site.scope);
            let below = Site { parent: Some(index), level: site.level + 1, ..*site };
            element.children.iter().for_each(|child| self.node(child, &below));
        }
    }

    fn has_room(&mut self, element: &Element, level: usize) -> bool {
        if self.is_full {
            return false;
        }
        let limit = if level > MAX_LEVELS {
            format!("more than {MAX_LEVELS} levels, SubTrees included")
        } else if self.instance.nodes.len() == MAX_NODES {
            self.is_full = true;
            format!("more than {MAX_NODES} nodes, SubTrees included")
        } else {
            return true;
        };
        self.remarks.error(&element.place, limit);
        false
    }

    fn name(&mut self, element: &Element) {
        let is_wrong = |sign: char| sign.is_ascii_control() && !matches!(sign, '\t' | '\n' | '\r');
        if let Some(name) = element.attribute("name").filter(|name| name.value.contains(is_wrong)) {
            self.remarks.error(&name.place, "a name must not contain control characters");
        }
    }

    fn guards(&mut self, element: &Element) -> Vec<Guard> {
        let mut guards = Vec::new();
        for attribute in PRE_CONDITIONS.into_iter().chain(POST_CONDITIONS) {
            let Some(written) = element.attribute(attribute) else { continue };
            match Script::read(&written.value) {
                Ok(script) => {
                    let (text, place) = (written.value.clone(), written.place.clone());
                    guards.push(Guard { attribute, text, script, place });
                }
                Err(reason) => {
                    self.remarks.error(&written.place, format!("in the script of {attribute}: {reason}"))
                }
            }
        }
        guards
    }

    fn ports(&mut self, element: &Element, model: &NodeModel, index: usize, scope: usize) {
        let mut values = BTreeMap::new();
        for attribute in &element.attributes {
            if !model::is_port(&attribute.name) {
                self.not_a_port(attribute);
            } else if let Some(port) = model.port(&attribute.name) {
                self.literal(&port.kind, attribute);
                self.entry(port.direction, &port.kind, attribute, scope);
                let value = PortValue { text: attribute.value.clone(), place: attribute.place.clone() };
                values.insert(attribute.name.clone(), value);
            } else {
                let known = model.ports.iter().map(|port| port.name.as_str()).collect::<Vec<_>>().join(", ");
                let known = if known.is_empty() { "it has none".into() } else { format!("it has {known}") };
                let message = format!("{} has no port '{}': {known}", model.id, attribute.name);
                self.remarks.error(&attribute.place, message);
            }
        }
        for port in model.ports.iter().filter(|port| port.direction != Direction::Output) {
            if let Some(default) = &port.default {
                let value = || PortValue { text: default.clone(), place: element.place.clone() };
                values.entry(port.name.clone()).or_insert_with(value);
            }
        }
        if let Some(node) = self.instance.nodes.get_mut(index) {
            node.ports = values;
        }
    }

    /// Notes the entries that the scripts around a node write.
    fn writes(&mut self, index: usize, scope: usize) {
        let scripts = self.instance.nodes.get(index).into_iter().flat_map(|node| &node.guards);
        let keys: Vec<_> = scripts.flat_map(|guard| guard.script.writes()).map(str::to_owned).collect();
        keys.iter().for_each(|key| self.note_write(scope, key));
    }

    /// Notes the entries that a script or an assignment that is a node writes.
    fn writes_of_code(&mut self, index: usize, scope: usize) {
        let Some(node) = self.instance.nodes.get(index).filter(|node| node.model.is_built_in) else { return };
        let port = |name: &str| node.ports.get(name).map(|value| value.text.clone());
        let script = port("code").and_then(|code| Script::read(&code).ok());
        let written = script.iter().flat_map(Script::writes).map(str::to_owned);
        let keys: Vec<_> = written.chain(port("output_key")).chain(port("key")).collect();
        keys.iter().for_each(|key| self.note_write(scope, pointer(key).unwrap_or(key)));
    }

    fn note_write(&mut self, scope: usize, key: &str) {
        let entry = self.instance.scopes.resolve(scope, key);
        self.instance.scopes.note_write(entry);
    }

    fn not_a_port(&mut self, attribute: &Attribute) {
        let name = attribute.name.as_str();
        let is_ours = matches!(name, "name" | "ID") || name.starts_with('_');
        if name == "_autoremap" || !is_ours {
            self.remarks.warning(&attribute.place, format!("the attribute '{name}' means nothing here"));
        }
    }

    fn literal(&mut self, kind: &ValueType, attribute: &Attribute) {
        let (name, text) = (&attribute.name, &attribute.value);
        if pointer(text).is_some() || text == "=" {
            return;
        }
        match kind.fit(text) {
            Fit::Whole => {}
            Fit::Beginning => {
                let message = format!("'{text}' for port '{name}' is read as a {} only in part", kind.name());
                self.remarks.warning(&attribute.place, message);
            }
            Fit::None => {
                self.remarks
                    .error(&attribute.place, format!("'{text}' for port '{name}' is no {}", kind.name()));
            }
        }
    }

    /// Sets the type of a blackboard entry, or compares it with the type it has.
    fn entry(&mut self, direction: Direction, kind: &ValueType, attribute: &Attribute, scope: usize) {
        let key = match attribute.value.as_str() {
            "{=}" | "=" => attribute.name.as_str(),
            text => match pointer(text) {
                Some(key) => key,
                None => return,
            },
        };
        let entry = self.instance.scopes.resolve(scope, key);
        if direction != Direction::Input {
            self.instance.scopes.note_write(entry.clone());
        }
        let Some((known, first)) = self.types.get(&entry) else {
            self.types.insert(entry, (kind.clone(), attribute.place.clone()));
            return;
        };
        if known != kind && ![known, kind].contains(&&ValueType::Any) && *known != ValueType::Text {
            let message = format!(
                "'{}' is of type {} here, but of type {} at {}:{}",
                attribute.value,
                kind.name(),
                known.name(),
                first.line,
                first.column
            );
            self.remarks.error(&attribute.place, message);
        }
    }

    fn subtree(&mut self, element: &Element, id: &str, index: usize, site: &Site<'_>) {
        let is_automatic = self.autoremap(element);
        let scope = self.instance.scopes.open(site.scope, is_automatic);
        let given = element.attributes.iter().filter(|attribute| model::is_port(&attribute.name));
        for attribute in given {
            self.remap(scope, &attribute.name, &attribute.value, &attribute.place);
        }
        for attribute in element.attributes.iter().filter(|attribute| attribute.name != "_autoremap") {
            if !model::is_port(&attribute.name) {
                self.not_a_port(attribute);
            }
        }
        if let Some(model) = self.document.subtree_models.get(id).filter(|_| !is_automatic) {
            for port in model.ports.iter().filter(|port| element.attribute(&port.name).is_none()) {
                match &port.default {
                    Some(default) if !default.is_empty() => {
                        self.remap(scope, &port.name, default, &element.place);
                    }
                    _ => {
                        let declared = format!("{}:{}", model.place.file, model.place.line);
                        let message = format!(
                            "the tree '{id}' needs a value for its port '{}', declared at {declared}",
                            port.name
                        );
                        self.remarks.error(&element.place, message);
                    }
                }
            }
        }
        let own = element.value("name").map_or_else(|| format!("{id}::{}", index + 1), str::to_owned);
        let path = if site.tree_path.is_empty() { own } else { format!("{}/{own}", site.tree_path) };
        if self.instance.trees.iter().any(|tree| tree.path == path) {
            let message = format!("a second SubTree is called '{path}': give it another name, or none");
            self.remarks.error(&element.place, message);
        }
        let below = Site { parent: Some(index), scope, level: site.level + 1, tree_path: &path };
        self.tree(id, &element.place, &below);
    }

    fn autoremap(&mut self, element: &Element) -> bool {
        let Some(attribute) = element.attribute("_autoremap") else { return false };
        truth(&attribute.value).unwrap_or_else(|| {
            self.remarks.error(&attribute.place, format!("'{}' is neither true nor false", attribute.value));
            false
        })
    }

    /// Connects a port of a SubTree with an entry outside, or gives it a constant.
    fn remap(&mut self, scope: usize, name: &str, value: &str, place: &Place) {
        let value = if value == "{=}" { format!("{{{name}}}") } else { value.to_owned() };
        match pointer(&value) {
            Some(key) => self.instance.scopes.connect(scope, name, key),
            None => {
                self.instance.scopes.fix(scope, name, &value);
                self.types.insert((scope, name.into()), (constant_type(&value), place.clone()));
            }
        }
    }
}

impl Instance {
    pub(super) fn children_of(&self, node: &Node) -> impl Iterator<Item = &Node> {
        node.children.iter().filter_map(|&child| self.nodes.get(child))
    }
}
