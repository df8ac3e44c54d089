//! Starts the window or the command line.

use conformant::cli::{self, Choice};
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::parse() {
        Choice::Command(command) => cli::run(command, DRAW),
        Choice::Window(file) => window(file),
    }
}

/// Draws the view of a project, where this program can.
#[cfg(feature = "gui")]
const DRAW: cli::Draw<'_> = &conformant::gui::picture;
#[cfg(not(feature = "gui"))]
const DRAW: cli::Draw<'_> = &|_, _| Ok(None);

#[cfg(feature = "gui")]
fn window(file: Option<PathBuf>) -> ExitCode {
    if !conformant::gui::has_display() {
        let why = "there is no display (DISPLAY and WAYLAND_DISPLAY are not set)";
        return cli::run_without_window(file, why, DRAW);
    }
    match conformant::gui::run(file) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::fail(&error),
    }
}

#[cfg(not(feature = "gui"))]
fn window(file: Option<PathBuf>) -> ExitCode {
    cli::run_without_window(file, "this program was built without the window (feature \"gui\")", DRAW)
}
