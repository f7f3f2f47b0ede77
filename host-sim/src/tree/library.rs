//! The trees that are built in.

use super::diagnostic::Diagnostic;
use super::document::{Document, Extras};
use super::instance::Instance;
use crate::text;

macro_rules! trees {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../../trees/", $name, ".xml")))),*]
    };
}

const TEXTS: [(&str, &str); 17] = trees![
    "pilot"
    "figure-5-classical"
    "figure-5-inference"
    "figure-8-classical"
    "figure-8-inference"
    "figure-14-left"
    "figure-14-right"
    "figure-14-left-classical"
    "figure-14-right-classical"
    "figure-15a"
    "figure-15b"
    "figure-16a"
    "table-6-conventional"
    "bottle-conventional"
    "plate-conventional"
    "t21"
    "t33"
];

/// The names, in the order they are listed.
pub fn names() -> impl Iterator<Item = &'static str> {
    TEXTS.iter().map(|&(name, _)| name)
}

/// The built-in document with a name, or `None`. A test holds that all parse.
#[must_use]
pub fn find(name: &str) -> Option<Result<Document, Diagnostic>> {
    let (name, text) = TEXTS.iter().find(|(known, _)| *known == name)?;
    Some(Document::parse(name, text, &Extras::default()))
}

/// The built-in tree with a name, with its SubTrees expanded, or `None`. A test holds that all are
/// sound.
#[must_use]
pub(crate) fn instance(name: &str) -> Option<Result<Instance, Diagnostic>> {
    let put_together = |document: Document| {
        let main = document.main_tree(None)?;
        Instance::of(&document, &main).map_err(|mut remarks| remarks.remove(0))
    };
    Some(find(name)?.and_then(put_together))
}

/// The built-in name that is most like `name`.
#[must_use]
pub fn nearest(name: &str) -> Option<&'static str> {
    text::nearest(names(), name)
}
