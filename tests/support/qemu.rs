//! The image of a robot in QEMU: start it, read its log, exchange frames with it.
//!
//! Nothing here measures time. Reads wait for the emulator; the [`PATIENCE`] only ends a test that
//! hangs.

use crate::gdb::Paused;
use firmware::page::Slots;
use host_sim::{FirmwareLog, LogItem};
use std::io::{BufReader, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// QEMU's machine with an STM32F405.
const MACHINE: &str = "netduinoplus2";

/// QEMU's machine with a RISC-V.
pub const RISC_V: &str = "virt";

/// QEMU's machine with an nRF51822, whose only serial port is the link.
pub const MICROBIT: &str = "microbit";

/// Where a robot on an STM32F405 looks for the first copy of its page.
const PAGE: u32 = 0x0800_0000 + Slots::STM32F405.first;

/// Options with which the emulated chip starts again after a reset; without them, QEMU ends.
pub const RESTARTING: [&str; 2] = ["-action", "reboot=reset"];

/// How long a robot may take for one answer before the test fails.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Builds the image `name` of the package `firmware` for size, as it is released, and returns the
/// path of its ELF file.
///
/// # Panics
/// When it does not build; the compiler's messages are on the standard error stream.
#[must_use]
pub fn image(name: &str) -> PathBuf {
    image_with(name, "firmware")
}

/// The same with a profile of Cargo's.
///
/// # Panics
/// As [`image`].
#[must_use]
pub fn image_with(name: &str, profile: &str) -> PathBuf {
    image_for(name, profile, "thumbv7em-none-eabihf", "stm32f405")
}

/// The same for another board.
///
/// # Panics
/// As [`image`].
#[must_use]
pub fn image_for(name: &str, profile: &str, target: &str, board: &str) -> PathBuf {
    image_of("firmware", name, profile, target, Some(board))
}

/// Builds the image `name` of a package, with the feature of a board, and others after commas.
///
/// # Panics
/// As [`image`].
#[must_use]
pub fn image_of(package: &str, name: &str, profile: &str, target: &str, board: Option<&str>) -> PathBuf {
    // Cargo puts an image with other features in the same place: each is kept where nothing else
    // is.
    static BUILD: Mutex<()> = Mutex::new(());
    let _building = BUILD.lock().unwrap_or_else(PoisonError::into_inner);
    let built = build(package, name, profile, target, board);
    let folder = built.with_file_name("images").join(board.unwrap_or("all").replace(',', "-"));
    std::fs::create_dir_all(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let (new, kept) = (folder.join(format!("{name}.new")), folder.join(name));
    std::fs::copy(&built, &new).unwrap_or_else(|error| panic!("{}: {error}", new.display()));
    std::fs::rename(&new, &kept).unwrap_or_else(|error| panic!("{}: {error}", kept.display()));
    kept
}

fn build(package: &str, name: &str, profile: &str, target: &str, board: Option<&str>) -> PathBuf {
    let output = Command::new(env!("CARGO"))
        .args(["build", "-p", package, "--profile", profile, "--target", target])
        .args(board.map(|board| ["--features", board]).iter().flatten())
        .args(["--bin", name, "--message-format", "json-render-diagnostics"])
        .envs((profile == "reduced").then_some(("DEFMT_LOG", "off")))
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo starts");
    assert!(
        output.status.success(),
        "the image {name} does not build: is the target installed? `tests/run` does it"
    );
    let messages = String::from_utf8(output.stdout).expect("cargo writes UTF-8");
    let executable = messages.lines().filter_map(executable).next_back();
    executable.unwrap_or_else(|| panic!("cargo names no executable for {name}"))
}

/// The image `team_member`, built once.
///
/// # Panics
/// As [`image`].
pub fn team_member() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image("team_member"))
}

/// The image `team_member` in the reduced configuration, without a log.
///
/// # Panics
/// As [`image`].
#[must_use]
pub fn reduced_image() -> PathBuf {
    image_for("team_member", "reduced", "thumbv6m-none-eabi", "nrf51822")
}

/// The executable that a message of cargo announces.
fn executable(message: &str) -> Option<PathBuf> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    message.get("executable")?.as_str().map(PathBuf::from)
}

/// One line of a robot's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The level in lower case, such as `info`.
    pub level: &'static str,
    /// The text.
    pub message: String,
}

/// The number that follows `before` in a log line.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn number(line: &str, before: &str) -> u32 {
    let rest = line.split(before).nth(1).unwrap_or_else(|| panic!("{before:?} in {line:?}"));
    let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().unwrap_or_else(|_| panic!("a number after {before:?} in {line:?}"))
}

/// A running image; dropping it ends QEMU.
#[derive(Debug)]
pub struct Robot {
    qemu: Child,
    link: ChildStdin,
    sent: Receiver<u8>,
    log: Receiver<Logged>,
    bytes: Vec<u8>,
    seen: Vec<Line>,
    sockets: PathBuf,
}

impl Robot {
    /// Starts an image. Wait for its first log line before sending: a byte that arrives before the
    /// image listens is kept, but QEMU looks for it only once a second.
    ///
    /// # Panics
    /// When QEMU is missing or does not start the image, or the file is no image with a defmt
    /// table.
    #[must_use]
    pub fn boot(image: &Path) -> Self {
        Self::boot_with(image, MACHINE, &[], None)
    }

    /// Starts an image with a page in its flash.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_with_page(image: &Path, page: &[u8]) -> Self {
        Self::boot_with(image, MACHINE, &[], Some((PAGE, page)))
    }

    /// Starts an image on another machine of QEMU, with a page at an address. The log leaves
    /// [`RISC_V`] by semihosting, and [`MICROBIT`] has none; of other machines the first serial
    /// port is the log. The next one is the link.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_on(machine: &str, image: &Path, page: (u32, &[u8])) -> Self {
        Self::boot_with(image, machine, &[], Some(page))
    }

    /// Starts an image with a page, which does not run before it was [paused](Self::pause) and let
    /// go.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_stopped(image: &Path, page: &[u8]) -> Self {
        Self::boot_stopped_on(MACHINE, image, (PAGE, page))
    }

    /// The same on another machine, with a page at an address.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_stopped_on(machine: &str, image: &Path, page: (u32, &[u8])) -> Self {
        Self::boot_with(image, machine, &["-S"], Some(page))
    }

    /// Starts an image that takes a nanosecond of its own time for each instruction, so that its
    /// timers count instructions.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_counting(image: &Path) -> Self {
        Self::boot_with(image, MACHINE, &["-icount", "shift=0"], None)
    }

    /// The same with a page in its flash.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_counting_with_page(image: &Path, page: &[u8]) -> Self {
        Self::boot_with(image, MACHINE, &["-icount", "shift=0"], Some((PAGE, page)))
    }

    /// Starts an image, with a page, in an emulator with further options of its command line.
    ///
    /// # Panics
    /// As [`Robot::boot`].
    #[must_use]
    pub fn boot_as(image: &Path, options: &[&str], page: Option<&[u8]>) -> Self {
        Self::boot_with(image, MACHINE, options, page.map(|page| (PAGE, page)))
    }

    fn boot_with(image: &Path, machine: &str, options: &[&str], page: Option<(u32, &[u8])>) -> Self {
        let elf = std::fs::read(image).unwrap_or_else(|error| panic!("{}: {error}", image.display()));
        let sockets = directory();
        let log = listen(&sockets, "log");
        let loader = page.map(|(address, page)| {
            let file = sockets.join("page");
            std::fs::write(&file, page).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            format!("loader,file={},addr={address:#x},force-raw=on", file.display())
        });
        let loader = loader.iter().flat_map(|loader| ["-device", loader]);
        let options: Vec<_> = options.iter().copied().chain(loader).collect();
        let mut qemu = start(image, &sockets, machine, &options);
        let log = accept(&log, &mut qemu);
        let link = qemu.stdin.take().expect("a pipe");
        let sent = collect(qemu.stdout.take().expect("a pipe"));
        let log = decode(image, &elf, log);
        Self { qemu, link, sent, log, bytes: Vec::new(), seen: Vec::new(), sockets }
    }

    /// Waits for a log line that contains `part`, passing over others.
    ///
    /// # Panics
    /// When QEMU ends or the robot is silent before there is one.
    pub fn wait_for(&mut self, part: &str) -> Line {
        loop {
            let line = match self.log.recv_timeout(PATIENCE) {
                Ok(Logged::Line(line)) => line,
                Ok(Logged::Bytes(bytes)) => {
                    self.bytes.extend(bytes);
                    continue;
                }
                Err(_) => panic!("the robot logged no {part:?}; it logged {:#?}", self.seen),
            };
            self.seen.push(line.clone());
            if line.message.contains(part) {
                return line;
            }
        }
    }

    /// The bytes of the log so far.
    #[must_use]
    pub fn log_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The log lines so far, those passed over included.
    #[must_use]
    pub fn seen(&self) -> &[Line] {
        &self.seen
    }

    /// Pauses the robot, to look at its memory.
    ///
    /// # Panics
    /// When QEMU does not answer.
    #[must_use]
    pub fn pause(&self) -> Paused {
        Paused::at(&self.sockets.join("gdb"))
    }

    /// Sends bytes over the link.
    ///
    /// # Panics
    /// When QEMU has ended.
    pub fn send(&mut self, bytes: &[u8]) {
        self.link.write_all(bytes).expect("QEMU takes the bytes");
    }

    /// Whether the robot has taken all that was sent to it, but for the few bytes that its port
    /// holds.
    ///
    /// On a busy host QEMU may need some 20 ms for a byte: who sends a frame in each tick of such a
    /// robot is heard ever later.
    ///
    /// # Panics
    /// When the pipe cannot be asked.
    #[must_use]
    pub fn has_taken_all(&self) -> bool {
        rustix::io::ioctl_fionread(&self.link).expect("a pipe tells how much it holds") == 0
    }

    /// Waits for the next `N` bytes on the link.
    ///
    /// # Panics
    /// When QEMU ends or the robot is silent before they are there.
    pub fn read<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    /// Waits for as many bytes on the link as there is room for.
    ///
    /// # Panics
    /// As [`read`](Self::read).
    pub fn fill(&mut self, bytes: &mut [u8]) {
        bytes.fill_with(|| self.byte());
    }

    /// Waits for the next frame on the link: the bytes up to and with the next zero.
    ///
    /// # Panics
    /// When QEMU ends or the robot is silent before the frame is whole.
    pub fn receive(&mut self) -> Vec<u8> {
        let mut frame = Vec::new();
        while frame.len() < 2 || frame.last() != Some(&0) {
            frame.push(self.byte());
        }
        frame
    }

    /// Throws away what has come on the link so far: the next frame is sent from now on.
    pub fn discard_sent(&mut self) {
        self.sent.try_iter().for_each(drop);
    }

    fn byte(&mut self) -> u8 {
        let byte = self.sent.recv_timeout(PATIENCE);
        byte.unwrap_or_else(|error| panic!("no byte ({error}); the robot logged {:#?}", self.seen))
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
        let _ = std::fs::remove_dir_all(&self.sockets);
    }
}

/// A new directory for the sockets of one robot.
pub(crate) fn directory() -> PathBuf {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = format!("iibt-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    path
}

fn listen(directory: &Path, name: &str) -> UnixListener {
    let path = directory.join(name);
    let listener = UnixListener::bind(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    listener.set_nonblocking(true).expect("a socket can be made non-blocking");
    listener
}

/// Starts QEMU as the client of the log's socket, so that no byte of it is lost. The link is its
/// standard input and output.
fn start(image: &Path, sockets: &Path, machine: &str, options: &[&str]) -> Child {
    let log = format!("socket,id=log,path={}", sockets.join("log").display());
    let (emulator, ports) = emulator(machine);
    let mut command = Command::new(emulator);
    command.args(["-M", machine, "-display", "none", "-monitor", "none", "-no-reboot"]);
    command.args(["-chardev", &log, "-chardev", "stdio,id=link,signal=off"]).args(ports);
    command.args(["-gdb", &format!("unix:{},server=on,wait=off", sockets.join("gdb").display())]);
    command.args(options).arg("-kernel").arg(image).stdin(Stdio::piped()).stdout(Stdio::piped());
    command.spawn().unwrap_or_else(|error| panic!("{emulator}: {error}; `tests/run` installs it"))
}

/// The emulator of a machine, and where its log and its link leave it.
fn emulator(machine: &str) -> (&'static str, &'static [&'static str]) {
    const SEMIHOSTING: &str = "enable=on,target=native,chardev=log";
    match machine {
        RISC_V => (
            "qemu-system-riscv32",
            &["-bios", "none", "-semihosting-config", SEMIHOSTING, "-serial", "chardev:link"],
        ),
        // With the RAM of the QFAC; QEMU's own board has the QFAA.
        MICROBIT => ("qemu-system-arm", &["-global", "nrf51-soc.sram-size=32768", "-serial", "chardev:link"]),
        _ => ("qemu-system-arm", &["-serial", "chardev:log", "-serial", "chardev:link"]),
    }
}

fn accept(listener: &UnixListener, qemu: &mut Child) -> UnixStream {
    let start = Instant::now();
    loop {
        if let Ok((stream, _)) = listener.accept() {
            stream.set_nonblocking(false).expect("a socket can be made blocking");
            return stream;
        }
        if let Ok(Some(status)) = qemu.try_wait() {
            panic!("QEMU ended before it ran the image: {status}");
        }
        assert!(start.elapsed() < PATIENCE, "QEMU does not open its ports");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Takes what comes from a link on a thread of its own. QEMU stands still, and does not even answer
/// its debugger, where some hundred bytes of a robot wait to be read.
fn collect(link: ChildStdout) -> Receiver<u8> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut bytes = BufReader::new(link).bytes().map_while(Result::ok);
        bytes.all(|byte| sender.send(byte).is_ok())
    });
    receiver
}

/// What comes from a log: its bytes, and then the lines that end in them.
#[derive(Debug)]
enum Logged {
    Bytes(Vec<u8>),
    Line(Line),
}

/// The decoder for the log of an image.
///
/// # Panics
/// When the file is no image that logs with defmt.
#[must_use]
pub fn log_of(image: &Path, elf: &[u8]) -> FirmwareLog {
    FirmwareLog::of_image(&image.display().to_string(), elf).unwrap_or_else(|error| panic!("{error}"))
}

/// Decodes the log on a thread of its own, so that the robot never waits for the test.
fn decode(image: &Path, elf: &[u8], log: UnixStream) -> Receiver<Logged> {
    let (sender, receiver) = channel();
    let decoder = log_of(image, elf);
    std::thread::spawn(move || pass_on(decoder, log, &sender));
    receiver
}

/// Runs until the robot or the test is gone.
fn pass_on(mut decoder: FirmwareLog, mut log: UnixStream, logged: &Sender<Logged>) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = log.read(&mut bytes) {
        let bytes = &bytes[..count];
        let lines = decoder.receive(bytes).into_iter().map(|item| match item {
            LogItem::Line(line) => Line { level: line.level.unwrap_or("print"), message: line.message },
            LogItem::Unreadable(frame) => Line { level: "error", message: frame.to_string() },
        });
        let items = std::iter::once(Logged::Bytes(bytes.to_vec())).chain(lines.map(Logged::Line));
        if items.into_iter().any(|item| logged.send(item).is_err()) {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_frames_without_room_are_dropped_whole_counted_and_told() {
        let mut robot = Robot::boot(&image("fault"));
        robot.wait_for("boot");
        robot.send(b"o");
        let counted = number(&robot.wait_for("dropped ").message, "dropped ");
        let line = robot.wait_for("log frames were dropped").message;
        let told: u32 = line.split(' ').next().and_then(|told| told.parse().ok()).expect("a number");
        let kept = robot.seen().iter().filter(|line| line.message.starts_with("line ")).count();
        assert!(kept > 100 && told > 1000, "{kept} kept, {told} dropped");
        assert_eq!((kept as u32 + told, told), (2000, counted));
        assert!(robot.seen().iter().all(|line| line.level != "error"), "every frame is whole");
    }
}
