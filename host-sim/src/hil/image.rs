//! The image that the emulated robots run, built from the checkout.

use super::HilError;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Builds the image of a navigating robot as it is released, and returns the path of its ELF file.
/// Cargo's progress goes to the standard error stream.
///
/// # Errors
/// [`HilError::Build`] when it does not build, in a folder outside of the checkout for example.
pub fn build_image() -> Result<PathBuf, HilError> {
    build("based_member")
}

/// Builds the image of a robot that works on the task `bottle-and-plate`.
///
/// # Errors
/// As [`build_image`].
pub fn build_task_image() -> Result<PathBuf, HilError> {
    build("based_table_robot")
}

fn build(name: &str) -> Result<PathBuf, HilError> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["build", "-p", "firmware", "--profile", "firmware", "--target", "thumbv7em-none-eabihf"])
        .args(["--features", "stm32f405", "--bin", name])
        .args(["--message-format", "json-render-diagnostics"])
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| HilError::Build(format!("cargo does not start: {error}")))?;
    if !output.status.success() {
        let hint = "run it in the checkout of the project, or name an image with --image";
        return Err(HilError::Build(format!("cargo ended with {}: {hint}", output.status)));
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    let image = messages.lines().filter_map(executable).next_back();
    image.ok_or_else(|| HilError::Build("cargo names no executable".to_owned()))
}

/// The executable that a message of cargo announces.
fn executable(message: &str) -> Option<PathBuf> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    message.get("executable")?.as_str().map(PathBuf::from)
}
