//! JSON as notebooks write it: with the tokens NaN, Infinity and -Infinity, which Python adds.

use super::fault::Fault;

/// A value of a JSON text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    /// A number; not finite for Python's tokens and for numbers that no `f64` holds.
    Number(f64),
    Text(String),
    List(Vec<Value>),
    /// Keys in the order of the text, each once.
    Object(Vec<(String, Value)>),
}

impl Value {
    /// What it is, in words.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a truth value",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        }
    }

    /// The number as a count, if it is a whole one from zero.
    pub(super) fn as_count(&self) -> Option<usize> {
        match self {
            Self::Number(number) if *number >= 0.0 && number.fract() == 0.0 && *number < 1e9 => {
                Some(*number as usize)
            }
            _ => None,
        }
    }

    /// The value as a message shows it: numbers themselves, else what it is.
    pub(super) fn shown(&self) -> String {
        match self {
            Self::Number(number) => format!("{number}"),
            other => other.kind().to_owned(),
        }
    }
}

/// No model is nested deeper.
const MAX_DEPTH: usize = 64;

/// Reads one JSON value and nothing after it.
pub(super) fn read(text: &[u8]) -> Result<Value, Fault> {
    let mut reader = Reader { text, at: 0 };
    let value = reader.value(0)?;
    match reader.peek() {
        None => Ok(value),
        Some(_) => Err(reader.fault("there is more after the end of the value")),
    }
}

struct Reader<'a> {
    text: &'a [u8],
    at: usize,
}

/// The bare words that are values.
const WORDS: [(&[u8], Value); 6] = [
    (b"null", Value::Null),
    (b"true", Value::Bool(true)),
    (b"false", Value::Bool(false)),
    (b"NaN", Value::Number(f64::NAN)),
    (b"Infinity", Value::Number(f64::INFINITY)),
    (b"-Infinity", Value::Number(f64::NEG_INFINITY)),
];

impl Reader<'_> {
    fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault::of_syntax(self.text, self.at, reason)
    }

    /// The next byte that is no blank.
    fn peek(&mut self) -> Option<u8> {
        while let Some(b' ' | b'\t' | b'\r' | b'\n') = self.text.get(self.at) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    /// Takes `wanted` if it comes next.
    fn take(&mut self, wanted: u8) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, wanted: u8, what: &str) -> Result<(), Fault> {
        if self.take(wanted) { Ok(()) } else { Err(self.unexpected(what)) }
    }

    fn unexpected(&mut self, wanted: &str) -> Fault {
        match self.peek() {
            None => self.fault(format!("the text ends where {wanted} should be")),
            Some(_) => {
                let rest = String::from_utf8_lossy(&self.text[self.at..(self.at + 4).min(self.text.len())])
                    .into_owned();
                let found = rest.chars().next().unwrap_or(' ').escape_debug();
                self.fault(format!("'{found}' where {wanted} should be"))
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, Fault> {
        if depth > MAX_DEPTH {
            return Err(self.fault(format!("nested deeper than {MAX_DEPTH} levels")));
        }
        let next = self.peek();
        if let Some((word, value)) = WORDS.iter().find(|(word, _)| self.text[self.at..].starts_with(word)) {
            self.at += word.len();
            return Ok(value.clone());
        }
        match next {
            Some(b'[') => self.list(depth),
            Some(b'{') => self.object(depth),
            Some(b'"') => self.string().map(Value::Text),
            Some(b'-' | b'0'..=b'9') => self.number(),
            _ => Err(self.unexpected("a value")),
        }
    }

    fn list(&mut self, depth: usize) -> Result<Value, Fault> {
        self.at += 1;
        let mut items = Vec::new();
        if self.take(b']') {
            return Ok(Value::List(items));
        }
        loop {
            items.push(self.value(depth + 1)?);
            if !self.take(b',') {
                self.expect(b']', "',' or ']'")?;
                return Ok(Value::List(items));
            }
        }
    }

    fn object(&mut self, depth: usize) -> Result<Value, Fault> {
        self.at += 1;
        let mut entries: Vec<(String, Value)> = Vec::new();
        if self.take(b'}') {
            return Ok(Value::Object(entries));
        }
        loop {
            if self.peek() != Some(b'"') {
                return Err(self.unexpected("a key in quotes"));
            }
            let begin = self.at;
            let key = self.string()?;
            if entries.iter().any(|(known, _)| *known == key) {
                self.at = begin;
                return Err(self.fault(format!("the key \"{key}\" is there twice")));
            }
            self.expect(b':', "':'")?;
            entries.push((key, self.value(depth + 1)?));
            if !self.take(b',') {
                self.expect(b'}', "',' or '}'")?;
                return Ok(Value::Object(entries));
            }
        }
    }

    fn number(&mut self) -> Result<Value, Fault> {
        let rest = &self.text[self.at..];
        let is_part = |byte: &u8| matches!(byte, b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9');
        let length = rest.iter().take_while(|byte| is_part(byte)).count();
        let word = std::str::from_utf8(&rest[..length]).unwrap_or("");
        match word.parse().ok().filter(|_| is_number(word)) {
            Some(number) => {
                self.at += length;
                Ok(Value::Number(number))
            }
            None => Err(self.fault(format!("'{word}' is no number"))),
        }
    }

    /// A text in quotes.
    fn string(&mut self) -> Result<String, Fault> {
        let begin = self.at;
        self.at += 1;
        let mut bytes = Vec::new();
        loop {
            let Some(&byte) = self.text.get(self.at) else {
                self.at = begin;
                return Err(self.fault("a text without its closing quote"));
            };
            self.at += 1;
            match byte {
                b'"' => break,
                b'\\' => self.escaped(&mut bytes)?,
                0..0x20 => {
                    self.at -= 1;
                    return Err(self.fault("a control character in a text"));
                }
                _ => bytes.push(byte),
            }
        }
        String::from_utf8(bytes).map_err(|_| Fault::of_syntax(self.text, begin, "a text that is not UTF-8"))
    }

    fn escaped(&mut self, bytes: &mut Vec<u8>) -> Result<(), Fault> {
        let byte = self.text.get(self.at).copied();
        let plain = match byte {
            Some(b'"' | b'\\' | b'/') => byte,
            Some(b'n') => Some(b'\n'),
            Some(b't') => Some(b'\t'),
            Some(b'r') => Some(b'\r'),
            Some(b'b') => Some(8),
            Some(b'f') => Some(12),
            _ => None,
        };
        if let Some(plain) = plain {
            self.at += 1;
            bytes.push(plain);
            return Ok(());
        }
        let unit = self.unit().ok_or_else(|| self.fault("an escape that JSON does not have"))?;
        let second = if (0xd800..0xdc00).contains(&unit) && self.text.get(self.at) == Some(&b'\\') {
            self.at += 1;
            self.unit()
        } else {
            None
        };
        let mut decoded = char::decode_utf16([unit].into_iter().chain(second));
        decoded.try_for_each(|sign| {
            let sign = sign.map_err(|_| self.fault("half of a surrogate pair"))?;
            bytes.extend_from_slice(sign.encode_utf8(&mut [0; 4]).as_bytes());
            Ok(())
        })
    }

    /// `u` and four hexadecimal digits.
    fn unit(&mut self) -> Option<u16> {
        let digits = self.text.get(self.at..self.at + 5)?.strip_prefix(b"u")?;
        let digits = std::str::from_utf8(digits).ok().filter(|text| !text.contains('+'))?;
        let unit = u16::from_str_radix(digits, 16).ok()?;
        self.at += 5;
        Some(unit)
    }
}

/// Whether a word is a number by JSON's grammar, which is narrower than Rust's.
fn is_number(word: &str) -> bool {
    let word = word.strip_prefix('-').unwrap_or(word);
    let (mantissa, exponent) = match word.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (word, None),
    };
    let (whole, fraction) = match mantissa.split_once('.') {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (mantissa, None),
    };
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let unsigned = |text: &str| digits(text.strip_prefix(['+', '-']).unwrap_or(text));
    digits(whole)
        && (whole.len() == 1 || !whole.starts_with('0'))
        && fraction.is_none_or(digits)
        && exponent.is_none_or(unsigned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        read(text.as_bytes()).expect_err(text).in_file("f").to_string()
    }

    #[test]
    fn values_are_read_as_json_has_them() {
        let text = " {\"a\": [1, -2.5e-1, null, true], \"b\\u00e9\\ud83d\\ude00\": {}} ";
        let list = vec![Value::Number(1.0), Value::Number(-0.25), Value::Null, Value::Bool(true)];
        let object =
            vec![("a".to_owned(), Value::List(list)), ("b\u{e9}\u{1f600}".to_owned(), Value::Object(vec![]))];
        assert_eq!(read(text.as_bytes()).ok(), Some(Value::Object(object)));
    }

    #[test]
    fn what_python_writes_for_no_number_is_read() {
        let Ok(Value::List(items)) = read(b"[NaN, Infinity, -Infinity, 1e999]") else { panic!("no list") };
        assert!(items.iter().all(|item| matches!(item, Value::Number(number) if !number.is_finite())));
    }

    #[test]
    fn syntax_errors_have_a_line_and_a_column() {
        assert_eq!(refusal("{\n  \"a\": [1,,2]}"), "f:2:11: ',' where a value should be");
        assert_eq!(refusal("{\"a\": 1"), "f:1:8: the text ends where ',' or '}' should be");
        assert_eq!(refusal("[1] x"), "f:1:5: there is more after the end of the value");
        assert_eq!(refusal("{\"a\": 1, \"a\": 2}"), "f:1:10: the key \"a\" is there twice");
        for text in
            ["", "[01]", "[1.]", "[+1]", "[.5]", "[1e]", "{a: 1}", "\"x", "[nul]", "\"\\u12\"", "\"\\ud800\""]
        {
            assert!(refusal(text).starts_with("f:1:"), "{text}");
        }
        assert!(refusal(&"[".repeat(100_000)).contains("nested deeper than 64"));
    }
}
