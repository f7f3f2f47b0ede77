//! The error of tables that do not fit, with its place.

/// The error of tables that do not fit, with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TablesError {
    /// The role, by its number; `None` where it is about the team.
    pub role: Option<u8>,
    /// The table.
    pub table: &'static str,
    /// The row of the table; `None` where it is about all of it.
    pub row: Option<u16>,
    /// The reason.
    pub reason: &'static str,
}

impl TablesError {
    pub(super) const fn of_team(table: &'static str, reason: &'static str) -> Self {
        Self { role: None, table, row: None, reason }
    }

    /// Fails the build, or panics, with this as the message.
    pub(super) const fn fail(self) -> ! {
        let mut text = Text { bytes: [0; Text::ROOM], len: 0 };
        text.write(self);
        let (bytes, _) = text.bytes.split_at(text.len);
        match core::str::from_utf8(bytes) {
            Ok(text) => panic!("{}", text),
            Err(_) => panic!("a task's tables do not fit together"),
        }
    }
}

/// A message assembled by the compiler, which cannot format.
struct Text {
    bytes: [u8; Self::ROOM],
    len: usize,
}

impl Text {
    const ROOM: usize = 192;

    const fn write(&mut self, error: TablesError) {
        if let Some(role) = error.role {
            self.push("roles[");
            self.push_number(role as u16);
            self.push("].");
        }
        self.push(error.table);
        if let Some(row) = error.row {
            self.push("[");
            self.push_number(row);
            self.push("]");
        }
        self.push(": ");
        self.push(error.reason);
    }

    const fn push(&mut self, text: &str) {
        let (bytes, mut at) = (text.as_bytes(), 0);
        while at < bytes.len() && self.len < Self::ROOM {
            self.bytes[self.len] = bytes[at];
            self.len += 1;
            at += 1;
        }
    }

    const fn push_number(&mut self, number: u16) {
        if number >= 10 {
            self.push_number(number / 10);
        }
        if self.len < Self::ROOM {
            self.bytes[self.len] = b'0' + (number % 10) as u8;
            self.len += 1;
        }
    }
}

impl core::fmt::Display for TablesError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if let Some(role) = self.role {
            write!(f, "roles[{role}].")?;
        }
        f.write_str(self.table)?;
        if let Some(row) = self.row {
            write!(f, "[{row}]")?;
        }
        write!(f, ": {}", self.reason)
    }
}

impl core::error::Error for TablesError {}
