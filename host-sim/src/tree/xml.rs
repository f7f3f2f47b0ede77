//! Reading XML, each element and attribute with its place.
//!
//! As lenient as the reader of BehaviorTree.CPP, so that its files load: attribute values may hold
//! `<` and a bare `&`, which scripts do; entities that are not XML's own stay as they are written.
//! Entities are never defined by a file, so a small file cannot grow.

use super::diagnostic::{Diagnostic, Place};
use std::sync::Arc;

/// The deepest nesting that is read, the root being the first level.
pub(super) const MAX_LEVELS: usize = 500;

/// An element, its attributes and the elements in it.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub tag: String,
    pub place: Place,
    pub attributes: Vec<Attribute>,
    pub children: Vec<Element>,
    /// The text between its children, without white space around it.
    pub text: String,
}

/// `name="value"`.
#[derive(Clone, Debug)]
pub(super) struct Attribute {
    pub name: String,
    pub value: String,
    pub place: Place,
}

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    pub(super) fn value(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|attribute| attribute.value.as_str())
    }

    pub(super) fn children_called<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.tag == tag)
    }
}

/// The root element of the text of a file.
///
/// # Errors
/// What is not well-formed, and where.
pub(super) fn read(file: &str, text: &str) -> Result<Element, Diagnostic> {
    let skipped = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    XmlReader { file: file.into(), text, at: skipped, counted: 0, line: 1, line_start: skipped }.document()
}

struct XmlReader<'t> {
    file: Arc<str>,
    text: &'t str,
    /// The byte that is read next.
    at: usize,
    /// The byte up to which lines are counted.
    counted: usize,
    line: usize,
    line_start: usize,
}

impl<'t> XmlReader<'t> {
    fn document(&mut self) -> Result<Element, Diagnostic> {
        let mut open: Vec<Element> = Vec::new();
        let mut root = None;
        loop {
            self.text_into(open.last_mut())?;
            if self.rest().is_empty() {
                break;
            }
            if self.skips_markup()? {
                continue;
            }
            let finished = if self.rest().starts_with("</") {
                self.closing_tag(&mut open)?
            } else {
                if root.is_some() && open.is_empty() {
                    return Err(self.error("a file has one root element, this is a second one"));
                }
                if open.len() == MAX_LEVELS {
                    return Err(self.error(format!("more than {MAX_LEVELS} elements in each other")));
                }
                self.opening_tag(&mut open)?
            };
            match (finished, open.last_mut()) {
                (Some(element), Some(parent)) => parent.children.push(element),
                (Some(element), None) => root = Some(element),
                (None, _) => {}
            }
        }
        match (open.pop(), root) {
            (Some(element), _) => {
                Err(Diagnostic::error(&element.place, format!("<{}> is never closed", element.tag)))
            }
            (None, Some(root)) => Ok(root),
            (None, None) => Err(self.error("this is no XML: there is no element in it")),
        }
    }

    fn text_into(&mut self, element: Option<&mut Element>) -> Result<(), Diagnostic> {
        let length = self.rest().find('<').unwrap_or(self.rest().len());
        let text = self.rest().get(..length).unwrap_or_default();
        let blank = text.len() - text.trim_start().len();
        match element {
            Some(element) => push_text(&mut element.text, &decoded(text.trim())),
            None if blank < length => {
                self.at += blank;
                return Err(self.error("text outside the root element"));
            }
            None => {}
        }
        self.at += length;
        Ok(())
    }

    /// Skips a comment, an instruction or a declaration, if one is next.
    fn skips_markup(&mut self) -> Result<bool, Diagnostic> {
        for (start, end, what) in
            [("<!--", "-->", "comment"), ("<?", "?>", "instruction"), ("<![CDATA[", "]]>", "CDATA section")]
        {
            if let Some(inner) = self.rest().strip_prefix(start) {
                let Some(length) = inner.find(end) else {
                    return Err(self.error(format!("this {what} is never closed with '{end}'")));
                };
                self.at += start.len() + length + end.len();
                return Ok(true);
            }
        }
        if let Some(inner) = self.rest().strip_prefix("<!") {
            return match inner.find(['>', '[']) {
                Some(length) if inner[length..].starts_with('>') => {
                    self.at += 2 + length + 1;
                    Ok(true)
                }
                _ => Err(self.error("a document type with definitions of its own is not read: delete it")),
            };
        }
        Ok(false)
    }

    fn closing_tag(&mut self, open: &mut Vec<Element>) -> Result<Option<Element>, Diagnostic> {
        let place = self.place();
        self.at += 2;
        let name = self.name();
        self.skip_white_space();
        if !self.skips(">") {
            return Err(self.error(format!("expected '>' to end </{name}")));
        }
        match open.pop() {
            Some(element) if element.tag == name => Ok(Some(element)),
            Some(element) => {
                let from = element.place.line;
                let message = format!("</{name}> closes nothing: <{}> of line {from} is open", element.tag);
                Err(Diagnostic::error(&place, message))
            }
            None => Err(Diagnostic::error(&place, format!("</{name}> closes nothing"))),
        }
    }

    /// Reads a tag; one that has no content is returned, another is left open.
    fn opening_tag(&mut self, open: &mut Vec<Element>) -> Result<Option<Element>, Diagnostic> {
        let place = self.place();
        self.at += 1;
        let tag = self.name();
        if tag.is_empty() {
            return Err(self.error("expected the name of an element after '<'"));
        }
        let mut element = Element {
            tag: tag.into(),
            place,
            attributes: Vec::new(),
            children: Vec::new(),
            text: String::new(),
        };
        loop {
            let spaced = self.skip_white_space();
            if self.skips("/>") {
                return Ok(Some(element));
            }
            if self.skips(">") {
                open.push(element);
                return Ok(None);
            }
            let attribute = self.attribute(&element, spaced)?;
            element.attributes.push(attribute);
        }
    }

    fn attribute(&mut self, element: &Element, spaced: bool) -> Result<Attribute, Diagnostic> {
        let (tag, place) = (&element.tag, self.place());
        let name = self.name();
        if name.is_empty() {
            return Err(match self.rest().chars().next() {
                None => Diagnostic::error(&element.place, format!("the tag <{tag}> is never ended with '>'")),
                Some(found) => {
                    self.error(format!("expected an attribute or '>' in <{tag}>, found '{found}'"))
                }
            });
        }
        if !spaced {
            return Err(Diagnostic::error(&place, format!("expected a space before the attribute '{name}'")));
        }
        if element.attribute(name).is_some() {
            return Err(Diagnostic::error(&place, format!("<{tag}> has the attribute '{name}' twice")));
        }
        self.skip_white_space();
        if !self.skips("=") {
            return Err(self.error(format!("expected '=' after the attribute '{name}'")));
        }
        self.skip_white_space();
        let Some(quote) = self.rest().chars().next().filter(|sign| matches!(sign, '"' | '\'')) else {
            return Err(self.error(format!("the value of '{name}' must stand in quotes")));
        };
        let inner = self.rest().get(1..).unwrap_or_default();
        let Some(length) = inner.find(quote) else {
            return Err(self.error(format!("the value of '{name}' is never ended with {quote}")));
        };
        self.at += length + 2;
        let value = decoded(inner.get(..length).unwrap_or_default());
        Ok(Attribute { name: name.into(), value, place })
    }

    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn skips(&mut self, sign: &str) -> bool {
        let is_next = self.rest().starts_with(sign);
        if is_next {
            self.at += sign.len();
        }
        is_next
    }

    fn skip_white_space(&mut self) -> bool {
        let length = self.rest().len() - self.rest().trim_start().len();
        self.at += length;
        length > 0
    }

    /// Reads a name, which may be empty.
    fn name(&mut self) -> &'t str {
        let rest = self.rest();
        let is_start =
            |sign: char| !sign.is_ascii() || sign.is_ascii_alphabetic() || matches!(sign, '_' | ':');
        let is_part = |sign: char| is_start(sign) || sign.is_ascii_digit() || matches!(sign, '-' | '.');
        if !rest.starts_with(is_start) {
            return "";
        }
        let name = rest.split(|sign| !is_part(sign)).next().unwrap_or_default();
        self.at += name.len();
        name
    }

    /// The place of the next character.
    fn place(&mut self) -> Place {
        let passed = self.text.get(self.counted..self.at).unwrap_or_default();
        for (offset, _) in passed.match_indices('\n') {
            self.line += 1;
            self.line_start = self.counted + offset + 1;
        }
        self.counted = self.at;
        let column = 1 + self.text.get(self.line_start..self.at).unwrap_or_default().chars().count();
        Place { file: self.file.clone(), line: self.line, column }
    }

    fn error(&mut self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(&self.place(), message)
    }
}

fn push_text(text: &mut String, more: &str) {
    if !text.is_empty() && !more.is_empty() {
        text.push(' ');
    }
    text.push_str(more);
}

/// Text with its entities replaced and its line ends made alike.
fn decoded(text: &str) -> String {
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let mut pieces = text.split('&');
    let mut decoded = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let entity = piece.split_once(';').and_then(|(name, rest)| Some((entity(name)?, rest)));
        match entity {
            Some((sign, rest)) => {
                decoded.push(sign);
                decoded.push_str(rest);
            }
            None => {
                decoded.push('&');
                decoded.push_str(piece);
            }
        }
    }
    decoded
}

fn entity(name: &str) -> Option<char> {
    match name {
        "amp" => Some('&'),
        "lt" => Some('<'),
        "gt" => Some('>'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        _ => {
            let number = name.strip_prefix('#')?;
            let code = match number.strip_prefix('x') {
                Some(digits) => u32::from_str_radix(digits, 16).ok()?,
                None => number.parse().ok()?,
            };
            char::from_u32(code).filter(|&sign| sign != '\0')
        }
    }
}

/// Text as it must be written in an attribute's value.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\r' => escaped.push_str("&#13;"),
            '\t' => escaped.push_str("&#9;"),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        read("f", text).map_or_else(|error| error.to_string(), |root| format!("{root:?}"))
    }

    #[test]
    fn elements_attributes_and_text_are_read_with_their_places() {
        let root = read(
            "f",
            "\u{feff}<?xml version=\"1.0\"?>\n<!-- note -->\n<root a='1'>\n  <b é=\"&lt;x&gt;\"/>to &amp; fro</root>\n",
        );
        let root = root.unwrap();
        assert_eq!((root.tag.as_str(), root.value("a"), root.text.as_str()), ("root", Some("1"), "to & fro"));
        assert_eq!(root.place.to_string(), "f:3:1");
        let child = &root.children[0];
        assert_eq!((child.value("é"), child.place.to_string().as_str()), (Some("<x>"), "f:4:3"));
        assert_eq!(child.attributes[0].place.to_string(), "f:4:6");
    }

    #[test]
    fn scripts_may_be_written_without_entities() {
        let root = read("f", "<a s=\"x < 3 && y\" t='&#65;&#x42;&what;&#0;&'/>").unwrap();
        assert_eq!((root.value("s"), root.value("t")), (Some("x < 3 && y"), Some("AB&what;&#0;&")));
    }

    #[test]
    fn what_is_not_well_formed_is_refused_at_its_place() {
        for (text, expected) in [
            ("", "f:1:1: error: this is no XML: there is no element in it"),
            ("hello", "f:1:1: error: text outside the root element"),
            ("<a>\n</b>", "f:2:1: error: </b> closes nothing: <a> of line 1 is open"),
            ("<a/>\n</a>", "f:2:1: error: </a> closes nothing"),
            ("<a>\n <b>\n</b>", "f:1:1: error: <a> is never closed"),
            ("<a/> <b/>", "f:1:6: error: a file has one root element, this is a second one"),
            ("<a b=1/>", "f:1:6: error: the value of 'b' must stand in quotes"),
            ("<a b='1/>", "f:1:6: error: the value of 'b' is never ended with '"),
            ("<a b/>", "f:1:5: error: expected '=' after the attribute 'b'"),
            ("<a b='1' b='2'/>", "f:1:10: error: <a> has the attribute 'b' twice"),
            ("<a b='1'c='2'/>", "f:1:9: error: expected a space before the attribute 'c'"),
            ("<a b='1' %/>", "f:1:10: error: expected an attribute or '>' in <a>, found '%'"),
            ("<a b='1'", "f:1:1: error: the tag <a> is never ended with '>'"),
            ("<1/>", "f:1:2: error: expected the name of an element after '<'"),
            ("<a></a", "f:1:7: error: expected '>' to end </a"),
            ("<!-- <a/>", "f:1:1: error: this comment is never closed with '-->'"),
            (
                "<!DOCTYPE a [<!ENTITY b 'c'>]><a/>",
                "f:1:1: error: a document type with definitions of its own is not read: delete it",
            ),
        ] {
            assert_eq!(refusal(text), expected, "{text}");
        }
    }

    #[test]
    fn nesting_is_bounded() {
        let nested = |levels: usize| "<a>".repeat(levels) + &"</a>".repeat(levels);
        assert!(read("f", &nested(MAX_LEVELS)).is_ok());
        assert!(refusal(&nested(MAX_LEVELS + 1)).ends_with("more than 500 elements in each other"));
        assert!(refusal(&"<a>".repeat(1_000_000)).ends_with("more than 500 elements in each other"));
    }

    #[test]
    fn what_is_escaped_is_read_again() {
        let text = "a<b>&\"c'\n\td\r é &amp;";
        assert_eq!(read("f", &format!("<a b=\"{}\"/>", escaped(text))).unwrap().value("b"), Some(text));
    }
}
