//! The words of a script.

/// A word and the byte at which it starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'t> {
    pub kind: Kind,
    pub text: &'t str,
    pub at: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Integer,
    Real,
    Text,
    Truth,
    Name,
    Operator,
    Wrong,
    End,
}

const PAIRS: [&str; 12] = ["..", "&&", "||", "==", "!=", "<=", ">=", ":=", "+=", "-=", "*=", "/="];
const SINGLES: &str = "+-*/&|^~!<>=?:();";

/// The words of a script, the last of kind [`Kind::End`].
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut at = 0;
    loop {
        let rest = text.get(at..).unwrap_or_default();
        let word = rest.trim_start_matches([' ', '\t', '\n', '\r']);
        at += rest.len() - word.len();
        let (kind, length) = first(word);
        tokens.push(Token { kind, text: word.get(..length).unwrap_or_default(), at });
        if kind == Kind::End {
            return tokens;
        }
        at += length;
    }
}

/// The kind and the length of the word that a text starts with.
fn first(text: &str) -> (Kind, usize) {
    let Some(sign) = text.chars().next() else { return (Kind::End, 0) };
    if sign == '\'' {
        let end = text.get(1..).and_then(|inner| inner.find('\''));
        return end.map_or((Kind::Wrong, text.len()), |length| (Kind::Text, length + 2));
    }
    if sign.is_ascii_digit() {
        return number(text);
    }
    if sign.is_ascii_alphabetic() || matches!(sign, '_' | '@') {
        let length = 1 + text.get(1..).unwrap_or_default().bytes().take_while(is_part_of_name).count();
        let is_truth = matches!(text.get(..length), Some("true" | "false"));
        return (if is_truth { Kind::Truth } else { Kind::Name }, length);
    }
    if PAIRS.iter().any(|pair| text.starts_with(pair)) {
        return (Kind::Operator, 2);
    }
    (if SINGLES.contains(sign) { Kind::Operator } else { Kind::Wrong }, sign.len_utf8())
}

fn number(text: &str) -> (Kind, usize) {
    let bytes = text.as_bytes();
    let is_hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    let (kind, length) = if is_hexadecimal { hexadecimal(bytes) } else { decimal(bytes) };
    let rest = bytes.get(length..).unwrap_or_default();
    let junk = rest.iter().take_while(|byte| is_part_of_name(byte)).count();
    if junk > 0 || rest.first() == Some(&b'@') { (Kind::Wrong, length + junk) } else { (kind, length) }
}

fn hexadecimal(bytes: &[u8]) -> (Kind, usize) {
    let digits = bytes.iter().skip(2).take_while(|byte| byte.is_ascii_hexdigit()).count();
    if digits == 0 || bytes.get(2 + digits) == Some(&b'.') {
        return (Kind::Wrong, 2 + digits);
    }
    (Kind::Integer, 2 + digits)
}

fn decimal(bytes: &[u8]) -> (Kind, usize) {
    let digits = |from: usize| bytes.iter().skip(from).take_while(|byte| byte.is_ascii_digit()).count();
    let is = |at: usize, signs: &[u8]| bytes.get(at).is_some_and(|byte| signs.contains(byte));
    let mut kind = Kind::Integer;
    let mut length = digits(0);
    if is(length, b".") && !is(length + 1, b".") {
        let fraction = digits(length + 1);
        if fraction == 0 {
            return (Kind::Wrong, length + 1);
        }
        kind = Kind::Real;
        length += 1 + fraction;
    }
    if is(length, b"eE") {
        kind = Kind::Real;
        length += 1 + usize::from(is(length + 1, b"+-"));
        let exponent = digits(length);
        if exponent == 0 {
            kind = Kind::Wrong;
        }
        length += exponent;
    }
    (kind, length)
}

fn is_part_of_name(byte: &u8) -> bool {
    byte.is_ascii_alphanumeric() || *byte == b'_'
}
