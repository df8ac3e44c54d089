//! The command line: what is typed becomes a project and a few calls of the pipeline, what comes back becomes text.
//!
//! Enters: the arguments. Leaves: human text with units or, with `--json`, one JSON document on the standard output;
//! errors and progress on the standard error; an exit code (0 done, 1 failed, 2 wrong usage, 3 `verify` found faults,
//! 130 cancelled). Each command is a file; `args` holds all that can be typed. JSON keys are stable: lengths carry
//! their unit in the name, errors and strains are fractions.

#![allow(clippy::print_stderr, reason = "the edge that reports errors and progress")]

mod apply;
mod args;
mod choices;
mod compare;
mod deform;
mod example;
mod export;
mod import;
mod info;
mod mesh;
mod new;
mod page;
mod pattern;
mod plot_files;
mod progress;
mod report;
mod runs;
mod solve;
mod study;

pub use args::Command;
pub use example::Draw;

use crate::task::Task;
use anyhow::Result;
use clap::Parser;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// `verify` found faults.
const FAULTS: u8 = 3;
/// Ended by Ctrl-C: 128 and the signal's number.
const CANCELLED: u8 = 130;

/// What was asked for on the command line.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "made once")]
pub enum Choice {
    /// The window, with a project if one was named.
    Window(Option<PathBuf>),
    /// A command.
    Command(Command),
}

/// Reads the arguments; prints help or what is wrong with them and ends the process where that is all there is to do.
#[must_use]
pub fn parse() -> Choice {
    let arguments = args::Arguments::parse();
    arguments.command.map_or(Choice::Window(arguments.file), Choice::Command)
}

/// Runs a command; reports what goes wrong.
///
/// * `draw`: draws the view, if this program can.
#[must_use]
pub fn run(command: Command, draw: Draw<'_>) -> ExitCode {
    let progress = progress::Progress::start();
    let result = dispatch(command, draw, progress.task());
    finish(result, progress)
}

/// Does what can be done where the editor cannot open: says why, and without a project runs the built-in example.
///
/// * `draw`: draws the view, if this program can.
#[must_use]
pub fn run_without_window(file: Option<PathBuf>, why: &str, draw: Draw<'_>) -> ExitCode {
    if let Some(file) = file {
        let name = file.display();
        return fail(&anyhow::anyhow!(
            "the editor cannot open {name}: {why}; try `conformant info {name}` or `conformant deform {name} --out DIR`"
        ));
    }
    eprintln!(
        "The editor cannot open: {why}. Running the built-in example instead; `conformant --help` lists commands."
    );
    let progress = progress::Progress::start();
    let result = example::run(draw, progress.task()).map(|()| ExitCode::SUCCESS);
    finish(result, progress)
}

/// Reports an error with its causes.
#[must_use]
pub fn fail(error: &anyhow::Error) -> ExitCode {
    eprintln!("error: {}", report::chain(error));
    ExitCode::FAILURE
}

fn dispatch(command: Command, draw: Draw<'_>, task: &Task) -> Result<ExitCode> {
    match command {
        Command::New(args) => new::run(&args)?,
        Command::Import(args) => import::run(&args, task)?,
        Command::Deform(args) => deform::deform(&args, task)?,
        Command::Compensate(args) => deform::compensate(&args, task)?,
        Command::Export(args) => export::export(&args, task)?,
        Command::Mesh(args) => mesh::run(&args, task)?,
        Command::Solve(args) => solve::run(&args, task)?,
        Command::Compare(args) => compare::run(&args, task)?,
        Command::Verify(args) => return Ok(if export::verify(&args)? { ExitCode::SUCCESS } else { FAULTS.into() }),
        Command::Report(args) => page::run(&args, draw, task)?,
        Command::Study(args) => study::run(&args, task)?,
        Command::Info(args) => info::run(&args)?,
        Command::Apply(args) => apply::run(&args, task)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn finish(result: Result<ExitCode>, progress: progress::Progress) -> ExitCode {
    let cancelled = progress.task().is_cancelled();
    drop(progress);
    match result {
        Ok(code) => code,
        Err(_) if cancelled => {
            eprintln!("cancelled");
            CANCELLED.into()
        }
        Err(error) => fail(&error),
    }
}

/// Prints to the standard output; a reader that has left (`| head`) is no failure.
fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
