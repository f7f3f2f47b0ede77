//! A tree file with all that it includes.

use super::diagnostic::{Diagnostic, Place, Remarks};
use super::model::{self, Class, Models, NodeModel, SubTreeModel};
use super::structure;
use super::xml::{self, Element};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Reads the text of a file by its path.
pub type Files<'f> = &'f dyn Fn(&Path) -> io::Result<String>;

/// The trees of a file and of those it includes, and the kinds of nodes that they declare.
#[derive(Clone, Debug)]
pub struct Document {
    pub(super) trees: BTreeMap<String, Definition>,
    /// The names of the trees in the order they are written.
    pub(super) order: Vec<String>,
    pub(super) models: Models,
    pub(super) subtree_models: BTreeMap<String, SubTreeModel>,
    /// The tree to execute, as the file names it.
    pub(super) main: Option<(String, Place)>,
    pub(super) place: Place,
    pub(super) remarks: Remarks,
}

/// `<BehaviorTree>`.
#[derive(Clone, Debug)]
pub(super) struct Definition {
    pub place: Place,
    /// Its attributes but the ID.
    pub attributes: Vec<xml::Attribute>,
    /// The root node; missing only where an error says so.
    pub root: Option<Element>,
}

/// Declarations besides those in the files.
#[derive(Clone, Debug, Default)]
pub struct Extras<'e> {
    /// Leaves that need no declaration.
    pub leaves: &'e [String],
}

impl Document {
    /// Reads a file and what it includes. Whether it is fit for use is in its remarks: see
    /// [`check`](fn@super::check).
    ///
    /// # Errors
    /// When the file, or one that it includes, cannot be read or is not XML.
    pub fn load(path: &Path, files: Files<'_>, extras: &Extras<'_>) -> Result<Self, LoadError> {
        let name = path.display().to_string();
        let text = files(path).map_err(|source| LoadError::Unreadable(name.clone(), source.to_string()))?;
        Ok(Self::with_includes(&name, path, &text, files, extras)?)
    }

    /// Reads the text of a file that includes no others.
    ///
    /// # Errors
    /// When it is not XML.
    pub fn parse(name: &str, text: &str, extras: &Extras<'_>) -> Result<Self, Diagnostic> {
        let refuse: Files<'_> = &|_| Err(io::Error::other("nothing can be included here"));
        Self::with_includes(name, Path::new(name), text, refuse, extras)
    }

    fn with_includes(
        name: &str,
        path: &Path,
        text: &str,
        files: Files<'_>,
        extras: &Extras<'_>,
    ) -> Result<Self, Diagnostic> {
        let root = xml::read(name, text)?;
        let mut gathering = Gathering { files, roots: Vec::new(), seen: BTreeSet::new(), open: Vec::new() };
        gathering.enter(path, root)?;
        Ok(Self::of(gathering.roots, extras))
    }

    /// Merges what the files declare, the main file being the last.
    fn of(roots: Vec<Element>, extras: &Extras<'_>) -> Self {
        let place = roots.last().map_or_else(|| Place::start_of(""), |root| root.place.clone());
        let mut document = Self {
            trees: BTreeMap::new(),
            order: Vec::new(),
            models: model::built_in(),
            subtree_models: BTreeMap::new(),
            main: None,
            place,
            remarks: Remarks::default(),
        };
        for leaf in extras.leaves.iter().filter(|leaf| model::model_name(leaf).is_ok()) {
            document.models.entry(leaf.clone()).or_insert_with(|| Arc::new(NodeModel::leaf(leaf)));
        }
        roots.iter().for_each(|root| document.declare(root));
        for root in &roots {
            structure::verify(root, &document.models, &mut document.remarks);
        }
        document.main = roots
            .last()
            .and_then(|root| root.attribute("main_tree_to_execute"))
            .map(|main| (main.value.clone(), main.place.clone()));
        roots.into_iter().for_each(|root| document.define(root));
        if document.trees.is_empty() {
            document.remarks.error(&document.place.clone(), "there is no <BehaviorTree> in the file");
        }
        document
    }

    /// Errors of tags, IDs and numbers of children; [`check`](fn@super::check) finds more.
    pub fn remarks(&self) -> impl Iterator<Item = &Diagnostic> {
        self.remarks.iter()
    }

    /// Adds the models of one file.
    fn declare(&mut self, root: &Element) {
        for entry in root.children_called("TreeNodesModel").flat_map(|models| &models.children) {
            let Some(class) = Class::with_tag(&entry.tag) else {
                let message = format!(
                    "<{}> is no kind of node: Action, Condition, Control, Decorator or SubTree",
                    entry.tag
                );
                self.remarks.warning(&entry.place, message);
                continue;
            };
            let Some(id) = entry.attribute("ID") else {
                self.remarks.error(&entry.place, format!("this <{}> has no attribute 'ID'", entry.tag));
                continue;
            };
            if let Err(reason) = model::model_name(&id.value) {
                self.remarks.error(&id.place, reason);
            }
            let ports = model::ports_of(entry, &mut self.remarks);
            if class == Class::SubTree {
                let model = SubTreeModel { id: id.value.clone(), ports, place: entry.place.clone() };
                self.subtree_models.insert(id.value.clone(), model);
                continue;
            }
            let model = NodeModel { id: id.value.clone(), class, ports, is_built_in: false };
            self.declare_node(model, &id.place);
        }
    }

    fn declare_node(&mut self, model: NodeModel, place: &Place) {
        match self.models.get(&model.id) {
            Some(known) if known.is_built_in => {
                if known.class != model.class {
                    let message = format!("'{}' is built in, as {}", known.id, known.class.tag());
                    self.remarks.error(place, message);
                }
            }
            Some(known) if known.class != model.class && !known.ports.is_empty() => {
                self.remarks.error(place, format!("'{}' is declared twice, differently", model.id));
            }
            _ => _ = self.models.insert(model.id.clone(), Arc::new(model)),
        }
    }

    /// Adds the trees of one file.
    fn define(&mut self, root: Element) {
        for mut tree in root.children.into_iter().filter(|child| child.tag == "BehaviorTree") {
            let id =
                tree.value("ID").map_or_else(|| format!("BehaviorTree_{}", self.order.len()), str::to_owned);
            tree.attributes.retain(|attribute| attribute.name != "ID");
            let definition = Definition {
                root: (tree.children.len() == 1).then(|| tree.children.remove(0)),
                attributes: tree.attributes,
                place: tree.place,
            };
            if let Some(earlier) = self.trees.insert(id.clone(), definition) {
                let place = self.trees[&id].place.clone();
                let message =
                    format!("a second tree is called '{id}'; it replaces that of {}", earlier.place);
                self.remarks.warning(&place, message);
                continue;
            }
            self.order.push(id);
        }
    }

    /// Returns the names of the trees in the order in which they are written.
    pub fn tree_names(&self) -> impl Iterator<Item = &str> {
        self.order.iter().map(String::as_str)
    }

    /// The tree to execute: the one that is asked for, else the one that the file names, else its
    /// only one.
    ///
    /// # Errors
    /// When there is no such tree, or several and none is named.
    pub fn main_tree(&self, wanted: Option<&str>) -> Result<String, Diagnostic> {
        let names = || self.order.iter().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
        let named = self.main.as_ref().map(|(name, place)| (name.as_str(), place));
        match (wanted.map(|name| (name, &self.place)).or(named), &self.order[..]) {
            (Some((name, place)), _) if !self.trees.contains_key(name) => {
                Err(Diagnostic::error(place, format!("there is no tree called '{name}', only {}", names())))
            }
            (Some((name, _)), _) => Ok(name.to_owned()),
            (None, [only]) => Ok(only.clone()),
            (None, []) => Err(Diagnostic::error(&self.place, "there is no <BehaviorTree> in the file")),
            (None, _) => {
                let reason = "the attribute 'main_tree_to_execute' must name the tree to execute, or --tree";
                Err(Diagnostic::error(&self.place, format!("{reason}: there are {}", names())))
            }
        }
    }
}

/// Reads files in the order in which they are included.
struct Gathering<'f> {
    files: Files<'f>,
    roots: Vec<Element>,
    seen: BTreeSet<PathBuf>,
    /// The files that are being read, each included by the one before.
    open: Vec<PathBuf>,
}

impl Gathering<'_> {
    fn enter(&mut self, path: &Path, root: Element) -> Result<(), Diagnostic> {
        self.open.push(plain(path));
        self.seen.insert(plain(path));
        for include in root.children_called("include") {
            self.include(include, path)?;
        }
        self.open.pop();
        self.roots.push(root);
        Ok(())
    }

    fn include(&mut self, include: &Element, from: &Path) -> Result<(), Diagnostic> {
        let Some(target) = include.attribute("path") else {
            return Err(Diagnostic::error(&include.place, "<include> has no attribute 'path'"));
        };
        if let Some(package) = include.attribute("ros_pkg") {
            let message = "ROS packages are not known here: write 'path' relative to this file";
            return Err(Diagnostic::error(&package.place, message));
        }
        let path = from.parent().unwrap_or(Path::new("")).join(&target.value);
        if self.open.contains(&plain(&path)) {
            return Err(Diagnostic::error(&target.place, format!("'{}' includes itself", path.display())));
        }
        if self.seen.contains(&plain(&path)) {
            return Ok(());
        }
        if self.open.len() > 64 {
            return Err(Diagnostic::error(&target.place, "more than 64 files include each other"));
        }
        let name = path.display().to_string();
        let text = (self.files)(&path)
            .map_err(|error| Diagnostic::error(&target.place, format!("cannot include '{name}': {error}")))?;
        self.enter(&path, xml::read(&name, &text)?)
    }
}

/// A path without detours, so that one file has one path.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::CurDir => {}
            std::path::Component::ParentDir if plain.file_name().is_some() => _ = plain.pop(),
            part => plain.push(part),
        }
    }
    plain
}

/// The reason why a file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LoadError {
    /// A file that does not exist or cannot be opened: its name, and the reason.
    #[error("{0}: {1}")]
    Unreadable(String, String),
    /// A remark on the file, or on a file that it includes.
    #[error(transparent)]
    Malformed(#[from] Diagnostic),
}
