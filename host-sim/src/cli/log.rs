//! `log`: the messages in the log of an image.

use super::{Failure, about, read};
use clap::Args;
use host_sim::{FirmwareLog, LogItem};
use serde::Serialize;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
ELF is the image that runs on the chip, as the compiler wrote it: with the log of another build every frame is refused,
or means something else.

Examples:
  host-sim log target/thumbv7em-none-eabihf/firmware/team_member < robot-1.bin
  stty -F /dev/ttyUSB0 115200 raw && host-sim log team_member /dev/ttyUSB0
  host-sim log team_member localhost:4444       QEMU with -serial tcp::4444,server
  host-sim log team_member robot-1.bin --json | jq -r 'select(.level == \"error\").message'

One line a message: the time, the level, the text. With --json an object a line, which also has the place in the
source and the tick. Messages of frames that were cut off or garbled are lost; each such frame is reported on the
standard error stream, with its place and the reason.

Exit status:
  0  every frame was read
  1  some were not
  2  the image or the log cannot be used, or wrong usage";

/// The exit status when a frame could not be read.
const UNREADABLE: u8 = 1;

/// No image is larger than this.
const MAX_IMAGE: u64 = 1 << 28;

#[derive(Args, Debug)]
pub(super) struct Log {
    /// The image whose log this is
    #[arg(value_name = "ELF")]
    image: String,
    /// The log: a file, a serial port, or a TCP port; the standard input if there is none, or -
    #[arg(value_name = "FILE|HOST:PORT", default_value = "-")]
    source: String,
    /// Print a JSON object a line
    #[arg(long)]
    json: bool,
}

/// What is printed of a frame that cannot be read, with `--json`.
#[derive(Serialize)]
struct Refused<'u> {
    unreadable: &'u str,
    at: u64,
    len: u64,
}

impl Log {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        let mut log = FirmwareLog::of_image(&self.image, &read(&self.image, MAX_IMAGE)?)?;
        let mut source = opened(&self.source)?;
        let (mut bytes, mut unreadable) = ([0; 4096], 0);
        loop {
            let count = match source.read(&mut bytes) {
                Ok(0) => break,
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(about(&self.source)(error).into()),
            };
            match self.print(log.receive(&bytes[..count]))? {
                Some(more) => unreadable += more,
                None => return Ok(ExitCode::SUCCESS),
            }
        }
        let rest = log.finish().map(LogItem::Unreadable);
        unreadable += self.print(rest.into_iter().collect())?.unwrap_or(0);
        Ok(if unreadable == 0 { ExitCode::SUCCESS } else { ExitCode::from(UNREADABLE) })
    }

    /// Prints what frames hold; returns how many cannot be read, and `None` when nobody listens any
    /// more.
    fn print(&self, items: Vec<LogItem>) -> Result<Option<usize>, Failure> {
        let (mut text, mut unreadable) = (String::new(), 0);
        for item in items {
            match item {
                LogItem::Line(line) if self.json => text += &(serde_json::to_string(&line)? + "\n"),
                LogItem::Line(line) => text += &format!("{line}\n"),
                LogItem::Unreadable(frame) => {
                    unreadable += 1;
                    eprintln!("{}: {frame}", self.source);
                    if self.json {
                        let refused = Refused { unreadable: &frame.reason, at: frame.at, len: frame.len };
                        text += &(serde_json::to_string(&refused)? + "\n");
                    }
                }
            }
        }
        match io::stdout().write_all(text.as_bytes()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(None),
            written => Ok(written.map(|()| Some(unreadable))?),
        }
    }
}

/// The source of a log. A name that is no file, with a port at its end, is an address.
fn opened(source: &str) -> Result<Box<dyn Read>, String> {
    if source == "-" {
        return Ok(Box::new(io::stdin()));
    }
    let is_address = source.rsplit_once(':').is_some_and(|(_, port)| port.parse::<u16>().is_ok());
    if is_address && !Path::new(source).exists() {
        return Ok(Box::new(TcpStream::connect(source).map_err(about(source))?));
    }
    Ok(Box::new(File::open(source).map_err(about(source))?))
}
