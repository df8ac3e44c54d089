//! A folder in which the real binary runs.

use serde_json::Value;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder of its own in which the binary runs, without a display.
pub(crate) struct Bench {
    folder: TempDir,
}

pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_conformant"));
        command.args(line.split_whitespace()).current_dir(&self.folder);
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(variable);
        }
        command
    }

    pub(crate) fn run(&self, line: &str) -> Ran {
        let Output { status, stdout, stderr } = self.command(line).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Ran { code: status.code().expect("ended by itself"), out: text(stdout), err: text(stderr) }
    }

    /// Runs a command that must succeed.
    pub(crate) fn ok(&self, line: &str) -> String {
        let ran = self.run(line);
        assert_eq!(ran.code, 0, "{line}: {}", ran.err);
        ran.out
    }

    pub(crate) fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.ok(line)).unwrap_or_else(|e| panic!("{line}: {e}"))
    }

    /// Runs a command that must fail with `code` and say `what`, and nothing on the standard output.
    pub(crate) fn fails(&self, line: &str, code: i32, what: &str) {
        let ran = self.run(line);
        assert_eq!(ran.code, code, "{line}: {} {}", ran.out, ran.err);
        assert!(ran.err.contains(what), "{line}: {}", ran.err);
        assert_eq!(ran.out, "", "{line}: nothing but the message");
    }
}
