//! The log of an image: defmt frames, decoded by the tables in the image's ELF file.
//!
//! ```text
//! bytes ─► frame ─► its messages and lengths, checked ─► decoder ─► line
//! ```
//!
//! Frames end with a zero. One that was cut off or garbled is reported with its place and the
//! reason, and decoding goes on at the next.

mod formats;
mod rzcobs;

use crate::input::FileError;
use defmt_decoder::{Encoding, Locations, Table};
use formats::Formats;
use serde::Serialize;
use std::fmt;

/// No frame is longer: the log of an image holds 4,096 bytes.
const MAX_FRAME: usize = 1 << 16;

/// A decoder for the log of one image.
///
/// ```
/// use host_sim::FirmwareLog;
///
/// let refused = FirmwareLog::of_image("notes.txt", b"no image").unwrap_err();
/// assert!(refused.to_string().starts_with("notes.txt: this is no ELF file"));
/// ```
#[derive(Clone)]
pub struct FirmwareLog {
    table: Table,
    formats: Formats,
    places: Locations,
    /// The bytes of the frame that has begun, but for those beyond [`MAX_FRAME`].
    frame: Vec<u8>,
    /// The byte at which it begins, and how many have been received.
    begin: u64,
    received: u64,
}

/// What a frame holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LogItem {
    /// A message.
    Line(LogLine),
    /// A frame that cannot be read.
    Unreadable(Unreadable),
}

/// A message of a log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LogLine {
    /// The time in the image's form; the images of this project count seconds since the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// The level in lower case, such as `info`; none for `println!`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<&'static str>,
    /// The tick that the message names: images of this project begin with `tick 7: `.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tick: Option<u32>,
    /// The text.
    pub message: String,
    /// The file and the line of the source, if the image has them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

/// A frame that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// The byte at which it begins, from zero.
    pub at: u64,
    /// Its length in bytes, without the zero at its end.
    pub len: u64,
    /// The reason.
    pub reason: String,
}

impl FirmwareLog {
    /// The decoder for the log of an image, from the bytes of its ELF file, which is called `name`
    /// in errors.
    ///
    /// # Errors
    /// [`FileError`] when this is no ELF file, or one of an image that does not log with defmt.
    pub fn of_image(name: &str, elf: &[u8]) -> Result<Self, FileError> {
        let refuse = |reason| FileError { file: name.to_owned(), line: None, column: None, reason };
        let formats = Formats::of_image(elf).map_err(refuse)?;
        let table = Table::parse(elf).map_err(|error| refuse(format!("{error:#}")))?;
        let table = table.ok_or_else(|| refuse("the image does not log with defmt".into()))?;
        if table.encoding() != Encoding::Rzcobs {
            let reason =
                "the frames of this image have no ends: build it with rzCOBS, as defmt does by default";
            return Err(refuse(reason.into()));
        }
        // Without debug information there are no places, and the log is read all the same.
        let places = table.get_locations(elf).unwrap_or_default();
        Ok(Self { table, formats, places, frame: Vec::new(), begin: 0, received: 0 })
    }

    /// Takes in bytes of the log; returns what the frames that have ended hold.
    pub fn receive(&mut self, bytes: &[u8]) -> Vec<LogItem> {
        let mut items = Vec::new();
        for &byte in bytes {
            self.received += 1;
            if byte != 0 {
                if self.frame.len() < MAX_FRAME {
                    self.frame.push(byte);
                }
                continue;
            }
            let frame = std::mem::take(&mut self.frame);
            if !frame.is_empty() {
                let len = self.received - 1 - self.begin;
                let unreadable = |reason| Unreadable { at: self.begin, len, reason };
                let item = self.decode(&frame, len).map_err(unreadable);
                items.push(item.map_or_else(LogItem::Unreadable, LogItem::Line));
            }
            self.begin = self.received;
        }
        items
    }

    /// Ends the log; returns the frame that has begun and not ended.
    #[must_use]
    pub fn finish(self) -> Option<Unreadable> {
        let len = self.received - self.begin;
        let reason = "the log ends within this frame".to_owned();
        (len > 0).then_some(Unreadable { at: self.begin, len, reason })
    }

    fn decode(&self, frame: &[u8], len: u64) -> Result<LogLine, String> {
        if len > MAX_FRAME as u64 {
            return Err(format!(
                "no frame is longer than {MAX_FRAME} bytes: this is no log, or its ends are lost"
            ));
        }
        let bytes = rzcobs::decode(frame).ok_or("its bytes are no rzCOBS: some are missing or changed")?;
        self.formats.check(&bytes)?;
        let (frame, _) = self.table.decode(&bytes).map_err(|error| error.to_string())?;
        let message = frame.display_message().to_string();
        Ok(LogLine {
            time: frame.display_timestamp().map(|time| time.to_string()),
            level: frame.level().map(|level| level.as_str()),
            tick: tick_of(&message),
            source: self
                .places
                .get(&frame.index())
                .map(|place| format!("{}:{}", place.file.display(), place.line)),
            message,
        })
    }
}

impl fmt::Debug for FirmwareLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FirmwareLog").field("received", &self.received).finish_non_exhaustive()
    }
}

/// The tick that a message begins with.
fn tick_of(message: &str) -> Option<u32> {
    message.strip_prefix("tick ")?.split_once(':')?.0.parse().ok()
}

/// `12.345 INFO  tick 7: heard the team`.
impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(time) = &self.time {
            write!(f, "{time} ")?;
        }
        if let Some(level) = self.level {
            write!(f, "{:<5} ", level.to_uppercase())?;
        }
        f.write_str(&self.message)
    }
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { at, len, reason } = self;
        write!(f, "byte {at}: a frame of {len} bytes cannot be read: {reason}")
    }
}
