//! A package outside of the workspace that depends on the core, as a user's does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{fs, io};

/// The manifest of a package but for the path of the core.
const MANIFEST: &str = "[package]\nname = \"outside\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
                        [profile.dev]\ndebug = false\n\n[dependencies]\n";

/// A package with its sources in a folder of its own.
#[derive(Debug)]
pub struct Package {
    folder: PathBuf,
}

impl Package {
    /// Writes a package into `folder`: its manifest, the versions of the workspace, and `sources`,
    /// each with its path below `src`. Sources of an earlier run are gone.
    ///
    /// # Panics
    /// Where a file cannot be written.
    #[must_use]
    pub fn new(folder: &str, sources: impl IntoIterator<Item = (impl AsRef<Path>, String)>) -> Self {
        let package = Self { folder: folder.into() };
        package.write(sources).expect("the package can be written");
        package
    }

    fn write(&self, sources: impl IntoIterator<Item = (impl AsRef<Path>, String)>) -> io::Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
        let source = self.folder.join("src");
        if source.exists() {
            fs::remove_dir_all(&source)?;
        }
        fs::create_dir_all(&source)?;
        let core = format!("iibt-core = {{ path = {:?} }}\n", root.join("iibt-core"));
        fs::write(self.folder.join("Cargo.toml"), MANIFEST.to_owned() + &core)?;
        fs::copy(root.join("Cargo.lock"), self.folder.join("Cargo.lock"))?;
        for (name, text) in sources {
            let path = source.join(name);
            fs::create_dir_all(path.parent().unwrap_or(&source))?;
            fs::write(path, text)?;
        }
        Ok(())
    }

    /// What cargo answers in the package.
    ///
    /// # Panics
    /// Without cargo.
    #[must_use]
    pub fn cargo(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("cargo starts")
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO"));
        command.args(arguments).args(["--offline", "--target-dir"]).arg(self.folder.join("target"));
        command.current_dir(&self.folder);
        command
    }

    /// The program of this name that [`cargo`](Self::cargo) builds.
    #[must_use]
    pub fn program(&self, name: &str) -> PathBuf {
        self.folder.join("target/debug").join(name)
    }

    /// Holds the package, a library, against the chip.
    ///
    /// # Panics
    /// If it does not compile, or with a warning.
    pub fn assert_compiles_for_the_chip(&self) {
        let mut check = self.command(&["check", "--target", "thumbv7em-none-eabihf"]);
        let output = check.env("RUSTFLAGS", "-D warnings").output().expect("cargo starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// Compares source that is kept in `exported` with what `export` writes now.
///
/// # Panics
/// Where they differ.
pub fn assert_is_kept(name: &str, written: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("exported").join(name);
    let kept = fs::read_to_string(&path).expect("the exported source");
    assert!(written == kept, "{}: write it anew with `host-sim export`", path.display());
}
