//! One emulated microcontroller: a process of QEMU with the robot's image, and the far ends of its
//! serial ports.

use super::difference::Done;
use firmware::adapters::base::{self, BaseAnswer, BaseRequest};
use iibt_core::team::{Deframer, MAX_FRAME, Stamp};
use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// The program.
pub(super) const EMULATOR: &str = "qemu-system-arm";

/// How long a robot may take for an answer: a tick takes milliseconds, so it hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs QEMU for as long as the standard input is open, and then removes the folder of its sockets:
/// also when the simulator is killed.
const KEEPER: &str = r#"exec 3<&0
trap "" INT TERM HUP
"$@" </dev/null 3<&- &
machine=$!
{ cat <&3 >/dev/null; kill -9 $machine; } 2>/dev/null &
keeper=$!
wait $machine 2>/dev/null
status=$?
kill $keeper 2>/dev/null
rm -rf "$SOCKETS"
exit $status"#;

/// A running image; dropping it ends QEMU.
#[derive(Debug)]
pub(super) struct Machine {
    keeper: Child,
    link: UnixStream,
    base: UnixStream,
    deframer: Deframer,
    stamp: Stamp,
}

/// What a machine is started with.
#[derive(Clone, Debug)]
pub(super) struct Setup<'s> {
    /// The ELF file.
    pub(super) image: &'s Path,
    /// What its flash holds beside the image, and where.
    pub(super) page: (u32, Vec<u8>),
    /// The file for its log, as defmt frames.
    pub(super) log: Option<PathBuf>,
}

impl Machine {
    /// Starts the image, and waits until it listens.
    pub(super) fn start(setup: &Setup<'_>) -> io::Result<Self> {
        let folder = Folder::new()?;
        let [link, base] = ["link", "base"].map(|name| folder.listen(name));
        let (link, base) = (link?, base?);
        let page = folder.0.join("page");
        fs::write(&page, &setup.page.1)?;
        let mut keeper = folder.keep(&arguments(setup, &folder.0, &page)).spawn()?;
        let ports = accept(&link, &mut keeper).and_then(|link| Ok((link, accept(&base, &mut keeper)?)));
        let (link, base) = ports.inspect_err(|_| end(&mut keeper))?;
        let stamp = Stamp { epoch: 1, sequence: 0 };
        let mut machine = Self { keeper, link, base, deframer: Deframer::new(), stamp };
        match machine.answer()? {
            (_, BaseAnswer::Ready) => Ok(machine),
            (_, other) => Err(odd(&format!("begins with {other:?}"))),
        }
    }

    /// Sends a request of the base.
    pub(super) fn request(&mut self, request: BaseRequest) -> io::Result<()> {
        self.stamp = self.stamp.next().ok_or_else(|| odd("has been asked too often"))?;
        let mut buffer = [0; MAX_FRAME];
        let frame = base::write(request, self.stamp, &mut buffer).map_err(io::Error::other)?;
        self.base.write_all(frame)
    }

    /// Waits for an answer to the last request.
    fn reply(&mut self) -> io::Result<BaseAnswer> {
        match self.answer()? {
            (stamp, answer) if stamp == self.stamp => Ok(answer),
            (stamp, answer) => Err(odd(&format!("answers {answer:?} to request {}", stamp.sequence))),
        }
    }

    /// Sends bytes of teammates, and waits until the robot has `waiting` bytes to read.
    pub(super) fn deliver(&mut self, bytes: &[u8], waiting: usize) -> io::Result<()> {
        self.link.write_all(bytes)?;
        let since = Instant::now();
        loop {
            self.request(BaseRequest::Waiting)?;
            match self.reply()? {
                BaseAnswer::Waiting(there) if usize::from(there) == waiting => return Ok(()),
                BaseAnswer::Waiting(there) if since.elapsed() > PATIENCE => {
                    return Err(odd(&format!("has {there} of {waiting} bytes of its teammates")));
                }
                BaseAnswer::Waiting(_) => {}
                other => return Err(odd(&format!("answers {other:?} to the question what waits"))),
            }
        }
    }

    /// Waits for what the robot does in the tick that was requested.
    pub(super) fn done(&mut self) -> io::Result<Done> {
        let mut done = Done::default();
        loop {
            match self.reply()? {
                BaseAnswer::Decided(decision) => done.decision = Some(decision),
                BaseAnswer::Act(act) => {
                    let (step, watched) = (act.step(), act.watched.to_vec());
                    return Ok(Done { step, watched, sent: self.sent()?, ..done });
                }
                BaseAnswer::Operate(operation) => {
                    return Ok(Done { operation, sent: self.sent()?, ..done });
                }
                other => return Err(odd(&format!("answers {other:?} to the readings of a tick"))),
            }
        }
    }

    /// Takes what the robot has sent to its teammates.
    fn sent(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.link.set_nonblocking(true)?;
        let read = self.link.read_to_end(&mut bytes);
        self.link.set_nonblocking(false)?;
        match read {
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(bytes),
            Err(error) => Err(error),
            Ok(_) => Err(odd("has ended: its log tells why")),
        }
    }

    fn answer(&mut self) -> io::Result<(Stamp, BaseAnswer)> {
        let mut byte = [0];
        loop {
            self.base.read_exact(&mut byte).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => odd("has ended: its log tells why"),
                ErrorKind::WouldBlock | ErrorKind::TimedOut => odd("does not answer"),
                _ => error,
            })?;
            let Some(frame) = self.deframer.feed(byte[0]) else { continue };
            match base::read(frame).map_err(io::Error::other)? {
                // The emulator's time runs ahead while others are waited for: between two ticks the
                // robot may miss its base. Nothing moves then.
                (_, BaseAnswer::Stop) => {}
                answer => return Ok(answer),
            }
        }
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        end(&mut self.keeper);
    }
}

/// Ends a machine, and waits until it and its folder are gone.
fn end(keeper: &mut Child) {
    drop(keeper.stdin.take());
    // There is nothing to do about one that cannot be waited for.
    let _ = keeper.wait();
}

fn odd(what: &str) -> io::Error {
    io::Error::other(what.to_owned())
}

/// A new folder for the sockets of one machine. Its keeper removes it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> io::Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("host-sim-hil-{}-{number}", std::process::id()));
        fs::create_dir_all(&path)?;
        Ok(Self(path))
    }

    fn listen(&self, name: &str) -> io::Result<UnixListener> {
        let listener = UnixListener::bind(self.0.join(name))?;
        listener.set_nonblocking(true)?;
        Ok(listener)
    }

    /// The command that keeps QEMU.
    fn keep(&self, arguments: &[String]) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", KEEPER, "keeper", EMULATOR]).args(arguments);
        command.env("SOCKETS", &self.0).stdin(Stdio::piped()).stdout(Stdio::null());
        command
    }
}

fn arguments(setup: &Setup<'_>, folder: &Path, page: &Path) -> Vec<String> {
    let shown = |path: &Path| path.display().to_string().replace(',', ",,");
    let log = match &setup.log {
        Some(path) => format!("file,id=log,path={}", shown(path)),
        None => "null,id=log".to_owned(),
    };
    let socket = |name: &str| format!("socket,id={name},path={}", shown(&folder.join(name)));
    let page = format!("loader,file={},addr={:#x},force-raw=on", shown(page), setup.page.0);
    let mut arguments = vec!["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-no-reboot"]
        .into_iter()
        .map(str::to_owned)
        .collect::<Vec<_>>();
    // The n-th port is USARTn: the log, the link, the base.
    for (chardev, serial) in
        [(log, "chardev:log"), (socket("link"), "chardev:link"), (socket("base"), "chardev:base")]
    {
        arguments.extend(["-chardev".to_owned(), chardev, "-serial".to_owned(), serial.to_owned()]);
    }
    arguments.extend(["-kernel".to_owned(), setup.image.display().to_string(), "-device".to_owned(), page]);
    arguments
}

fn accept(listener: &UnixListener, keeper: &mut Child) -> io::Result<UnixStream> {
    let start = Instant::now();
    loop {
        if let Ok((stream, _)) = listener.accept() {
            stream.set_nonblocking(false)?;
            stream.set_read_timeout(Some(PATIENCE))?;
            return Ok(stream);
        }
        if let Some(status) = keeper.try_wait()? {
            return Err(odd(&format!("does not start: {EMULATOR} ended with {status}")));
        }
        if start.elapsed() > PATIENCE {
            return Err(odd("does not open its ports"));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
