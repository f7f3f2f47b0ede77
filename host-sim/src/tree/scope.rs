//! The blackboards of a tree and its SubTrees, and how they are connected.

use super::value::{ValueType, integer, real};
use std::collections::{BTreeMap, BTreeSet};

/// An entry: the blackboard that holds it, and its key there.
pub(super) type Entry = (usize, String);

/// One blackboard for the main tree, the first, and one for each SubTree.
#[derive(Clone, Debug)]
pub(super) struct Scopes {
    scopes: Vec<Scope>,
    /// Entries that a node may change.
    written: BTreeSet<Entry>,
}

#[derive(Clone, Debug, Default)]
struct Scope {
    outer: Option<usize>,
    /// Keys that stand for keys outside.
    connected: BTreeMap<String, String>,
    constants: BTreeMap<String, String>,
    /// Whether all other keys stand for the same keys outside.
    is_automatic: bool,
}

impl Scopes {
    pub(super) fn new() -> Self {
        Self { scopes: vec![Scope::default()], written: BTreeSet::new() }
    }

    /// A blackboard for a SubTree in a tree with blackboard `outer`.
    pub(super) fn open(&mut self, outer: usize, is_automatic: bool) -> usize {
        self.scopes.push(Scope { outer: Some(outer), is_automatic, ..Scope::default() });
        self.scopes.len() - 1
    }

    pub(super) fn connect(&mut self, scope: usize, key: &str, outer: &str) {
        if let Some(scope) = self.scopes.get_mut(scope) {
            scope.connected.insert(key.into(), outer.into());
        }
    }

    pub(super) fn fix(&mut self, scope: usize, key: &str, value: &str) {
        if let Some(scope) = self.scopes.get_mut(scope) {
            scope.constants.insert(key.into(), value.into());
        }
    }

    /// The entry that `key` stands for in a blackboard.
    pub(super) fn resolve(&self, scope: usize, key: &str) -> Entry {
        let (mut at, mut key) = (scope, key);
        while let Some(scope) = self.scopes.get(at) {
            if let Some(root_key) = key.strip_prefix('@') {
                return (0, root_key.to_owned());
            }
            let Some(outer) = scope.outer.filter(|_| !scope.constants.contains_key(key)) else { break };
            key = match scope.connected.get(key) {
                Some(outer_key) => outer_key,
                None if scope.is_automatic && !key.starts_with('_') => key,
                None => break,
            };
            at = outer;
        }
        (at, key.to_owned())
    }

    pub(super) fn note_write(&mut self, entry: Entry) {
        self.written.insert(entry);
    }

    /// The text of an entry that is given by a SubTree's attribute and that no node changes.
    pub(super) fn constant(&self, scope: usize, key: &str) -> Option<&str> {
        let entry = self.resolve(scope, key);
        let constants = &self.scopes.get(entry.0)?.constants;
        constants.get(&entry.1).filter(|_| !self.written.contains(&entry)).map(String::as_str)
    }

    /// Every entry that has a value from the start.
    pub(super) fn constants(&self) -> impl Iterator<Item = (Entry, &str)> {
        self.scopes.iter().enumerate().flat_map(|(at, scope)| {
            scope.constants.iter().map(move |(key, value)| ((at, key.clone()), value.as_str()))
        })
    }
}

/// The type that BehaviorTree.CPP gives a constant.
pub(super) fn constant_type(text: &str) -> ValueType {
    let is_whole = |length: usize| length == text.len();
    match (integer(text), real(text)) {
        (Some((value, length)), _) if is_whole(length) => match i32::try_from(value) {
            Ok(_) => ValueType::Int,
            Err(_) => ValueType::Own("int64_t".into()),
        },
        (_, Some((_, length))) if is_whole(length) => ValueType::Double,
        _ => ValueType::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_leads_outwards_until_it_is_nobody_else_s() {
        let mut scopes = Scopes::new();
        let middle = scopes.open(0, false);
        let inner = scopes.open(middle, true);
        scopes.connect(middle, "goal", "dock");
        scopes.fix(middle, "speed", "3");
        assert_eq!(scopes.resolve(inner, "goal"), (0, "dock".into()));
        assert_eq!(scopes.resolve(inner, "speed"), (middle, "speed".into()));
        assert_eq!(scopes.resolve(inner, "_own"), (inner, "_own".into()));
        assert_eq!(scopes.resolve(inner, "@goal"), (0, "goal".into()));
        assert_eq!(scopes.resolve(middle, "other"), (middle, "other".into()));
        assert_eq!(scopes.constant(inner, "speed"), Some("3"));
        scopes.note_write((middle, "speed".into()));
        assert_eq!(scopes.constant(inner, "speed"), None);
    }

    #[test]
    fn constants_have_the_types_of_behavior_tree_cpp() {
        for (text, kind) in [
            ("3", ValueType::Int),
            ("0.3", ValueType::Double),
            ("1;2", ValueType::Text),
            ("", ValueType::Text),
        ] {
            assert_eq!(constant_type(text), kind, "{text}");
        }
    }
}
