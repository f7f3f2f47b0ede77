//! The formats of an image's messages, and what a frame must hold to be one of them.
//!
//! The decoder takes the room for a list before it reads it: the length in a garbled frame would
//! end the program. So every frame is checked first, which also gives the reasons.

use defmt_parser::{Fragment, ParserMode, Type};
use object::{Object, ObjectSection, ObjectSymbol};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;

/// The most elements of a list that takes no bytes, and the most levels of values in values.
const MAX_ELEMENTS: usize = 1 << 12;
const MAX_LEVELS: usize = 16;

/// rzCOBS may add this many zeros at the end of a frame.
const PADDING: usize = 6;

/// The formats by their numbers.
#[derive(Clone)]
pub(super) struct Formats {
    formats: BTreeMap<u16, Format>,
    timestamp: Option<String>,
}

#[derive(Clone)]
struct Format {
    text: String,
    is_message: bool,
}

/// The name of a symbol in the section `.defmt`.
#[derive(Deserialize)]
struct Symbol {
    tag: String,
    data: String,
}

impl Formats {
    /// Reads them from an ELF file.
    pub(super) fn of_image(elf: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(elf).map_err(|error| format!("this is no ELF file: {error}"))?;
        let sections =
            file.sections().filter(|section| section.name().is_ok_and(|name| name.starts_with(".defmt")));
        let sections: Vec<_> = sections.map(|section| section.index()).collect();
        let (mut formats, mut timestamp) = (BTreeMap::new(), None);
        for symbol in file.symbols() {
            let is_format = symbol.section_index().is_some_and(|section| sections.contains(&section));
            let name = symbol.name().unwrap_or_default();
            // Other names in the section are the linker's.
            let Some(Symbol { tag, data }) = is_format.then(|| serde_json::from_str(name).ok()).flatten()
            else {
                continue;
            };
            if tag == "defmt_timestamp" {
                timestamp = Some(data);
            } else if let Ok(number) = u16::try_from(symbol.address()) {
                let is_message = MESSAGES.contains(&tag.as_str());
                formats.insert(number, Format { text: data, is_message });
            }
        }
        Ok(Self { formats, timestamp })
    }

    /// Checks that a frame holds one message of the image, with all its values.
    pub(super) fn check(&self, frame: &[u8]) -> Result<(), String> {
        let mut reader = Reader { formats: self, rest: frame };
        let number = u16::from_le_bytes(reader.array()?);
        let message = self.formats.get(&number).filter(|format| format.is_message);
        let message = message.ok_or_else(|| format!("the image has no message {number:#06x}"))?;
        if let Some(timestamp) = &self.timestamp {
            reader.values(timestamp, 0)?;
        }
        reader.values(&message.text, 0)?;
        if reader.rest.len() > PADDING || reader.rest.iter().any(|&byte| byte != 0) {
            return Err(format!("{} bytes follow its message \"{}\"", reader.rest.len(), message.text));
        }
        Ok(())
    }
}

/// The tags of messages.
const MESSAGES: [&str; 6] =
    ["defmt_trace", "defmt_debug", "defmt_info", "defmt_warn", "defmt_error", "defmt_println"];

/// A frame that is read.
struct Reader<'f> {
    formats: &'f Formats,
    rest: &'f [u8],
}

impl<'f> Reader<'f> {
    fn take(&mut self, len: usize) -> Result<&'f [u8], String> {
        let (taken, rest) = self.rest.split_at_checked(len).ok_or("it ends before its values do")?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.take(N)?.try_into().map_err(|_| String::new())
    }

    fn length(&mut self) -> Result<usize, String> {
        Ok(u32::from_le_bytes(self.array()?) as usize)
    }

    /// Reads the values that a format asks for, in the order of their numbers.
    fn values(&mut self, format: &str, level: usize) -> Result<(), String> {
        if level > MAX_LEVELS {
            return Err(format!("its values lie in one another, more than {MAX_LEVELS} deep"));
        }
        let fragments = defmt_parser::parse(format, ParserMode::ForwardsCompatible)
            .map_err(|_| format!("\"{format}\" is no format"))?;
        let mut parameters: Vec<_> = fragments
            .into_iter()
            .filter_map(|fragment| match fragment {
                Fragment::Parameter(parameter) => Some(parameter),
                Fragment::Literal(_) => None,
            })
            .collect();
        // A value that is shown several times is sent once.
        parameters.sort_by_key(|parameter| parameter.index);
        for group in parameters.chunk_by(|a, b| a.index == b.index) {
            // Parts of one number are sent together: the bytes from the first to the last.
            let parts = group.iter().filter_map(|parameter| match &parameter.ty {
                Type::BitField(range) => Some(range.clone()),
                _ => None,
            });
            match parts.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)) {
                Some(range) => self.bit_field(&range)?,
                None => self.value(&group[0].ty, level)?,
            }
        }
        Ok(())
    }

    fn bit_field(&mut self, range: &Range<u8>) -> Result<(), String> {
        let bytes = usize::from((range.end.saturating_sub(1) / 8).saturating_sub(range.start / 8)) + 1;
        self.take(bytes.next_power_of_two()).map(|_| ())
    }

    fn value(&mut self, kind: &Type, level: usize) -> Result<(), String> {
        let size = match kind {
            Type::Bool => return self.truth_value(),
            Type::I8 | Type::U8 => 1,
            Type::I16 | Type::U16 => 2,
            Type::I32 | Type::U32 | Type::Isize | Type::Usize | Type::F32 => 4,
            Type::I64 | Type::U64 | Type::F64 => 8,
            Type::I128 | Type::U128 => 16,
            Type::U8Array(len) => *len,
            Type::U8Slice => self.length()?,
            Type::Str => return self.text(),
            Type::Char => return self.character(),
            Type::IStr => return self.format().map(|_| ()),
            Type::Debug | Type::Display => return self.preformatted(),
            Type::Format => return self.nested(level),
            Type::FormatArray(len) => return self.list(*len, level),
            Type::FormatSlice => {
                let len = self.length()?;
                return self.list(len, level);
            }
            Type::FormatSequence => return self.sequence(level),
            Type::BitField(range) => return self.bit_field(range),
        };
        self.take(size).map(|_| ())
    }

    fn truth_value(&mut self) -> Result<(), String> {
        let [value] = self.array()?;
        if value < 2 { Ok(()) } else { Err(format!("{value} is no truth value")) }
    }

    fn text(&mut self) -> Result<(), String> {
        let len = self.length()?;
        std::str::from_utf8(self.take(len)?).map(|_| ()).map_err(|_| "a text in it is no UTF-8".into())
    }

    fn character(&mut self) -> Result<(), String> {
        let code = u32::from_le_bytes(self.array()?);
        char::from_u32(code).map(|_| ()).ok_or_else(|| format!("{code:#x} is no character"))
    }

    /// A text that ends with 0xff.
    fn preformatted(&mut self) -> Result<(), String> {
        let end = self.rest.iter().position(|&byte| byte == 0xff).ok_or("a text in it does not end")?;
        let text = self.take(end + 1)?;
        std::str::from_utf8(&text[..end]).map(|_| ()).map_err(|_| "a text in it is no UTF-8".into())
    }

    /// The format of a value that says itself what it is.
    fn format(&mut self) -> Result<&'f str, String> {
        let number = u16::from_le_bytes(self.array()?);
        self.numbered(number)
    }

    fn numbered(&self, number: u16) -> Result<&'f str, String> {
        let format = self.formats.formats.get(&number).filter(|format| !format.is_message);
        Ok(&format.ok_or_else(|| format!("the image has no value of the kind {number:#06x}"))?.text)
    }

    /// One of the variants that a format lists, or the format itself.
    fn variant(&mut self, format: &'f str) -> Result<&'f str, String> {
        let count = format.matches('|').count();
        let number = match count {
            0 => return Ok(format),
            1..=0xff => usize::from(u8::from_le_bytes(self.array()?)),
            _ => usize::from(u16::from_le_bytes(self.array()?)),
        };
        format.split('|').nth(number).ok_or_else(|| format!("\"{format}\" has no variant {number}"))
    }

    fn nested(&mut self, level: usize) -> Result<(), String> {
        let format = self.format()?;
        let variant = self.variant(format)?;
        self.values(variant, level + 1)
    }

    fn list(&mut self, len: usize, level: usize) -> Result<(), String> {
        let most = self.rest.len().max(MAX_ELEMENTS);
        if len > most {
            return Err(format!("a list of {len} values in a frame of {} bytes more", self.rest.len()));
        }
        let format = self.format()?;
        for _ in 0..len {
            let variant = self.variant(format)?;
            self.values(variant, level + 1)?;
        }
        Ok(())
    }

    fn sequence(&mut self, level: usize) -> Result<(), String> {
        loop {
            let number = u16::from_le_bytes(self.array()?);
            if number == 0 {
                return Ok(());
            }
            let format = self.numbered(number)?;
            self.values(format, level + 1)?;
        }
    }
}
