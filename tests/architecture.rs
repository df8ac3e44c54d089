//! The direction of the code: which module may name which, who may use what from outside, and how long a file may be.
#![allow(clippy::unwrap_used, reason = "a source file that cannot be read fails the test")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What the two edges of the program, command line and window, may name.
const EDGE: &[&str] = &[
    "antenna",
    "cage",
    "deform",
    "distortion",
    "geometry",
    "io",
    "pipeline",
    "plot",
    "project",
    "render",
    "report",
    "results",
    "task",
    "tet",
    "units",
];

/// Each module with the modules of this crate that it may name.
const LAYERS: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("task", &[]),
    ("geometry", &[]),
    ("antenna", &["geometry", "task", "units"]),
    ("cage", &["geometry", "units"]),
    ("deform", &["geometry", "task", "units"]),
    ("distortion", &["antenna", "cage", "deform", "geometry", "task", "units"]),
    ("tet", &["antenna", "geometry", "task", "units"]),
    ("tlm", &["geometry", "task", "tet", "units"]),
    ("results", &["geometry", "task", "tlm", "units"]),
    ("plot", &["results", "units"]),
    ("io", &["geometry", "results", "tet", "tlm", "units"]),
    ("project", &["antenna", "cage", "geometry", "io", "task", "units"]),
    ("render", &["geometry", "units"]),
    (
        "pipeline",
        &[
            "antenna",
            "cage",
            "deform",
            "distortion",
            "geometry",
            "io",
            "project",
            "results",
            "task",
            "tet",
            "tlm",
            "units",
        ],
    ),
    ("report", &["distortion", "io", "pipeline", "plot", "project", "tet", "units"]),
    ("cli", EDGE),
    ("gui", EDGE),
    ("main", &["cli", "gui"]),
    ("lib", &[]),
];

/// Names from outside that only some modules may use.
const OUTSIDE: &[(&str, &[&str])] = &[
    ("egui", &["gui"]),
    ("eframe", &["gui"]),
    ("rfd", &["gui"]),
    ("wgpu", &["render", "gui"]),
    ("naga", &["render"]),
    ("anyhow", &["cli", "gui", "main"]),
    ("clap", &["cli", "main"]),
    ("plotters", &["plot"]),
    ("kurbo", &["io"]),
    ("roxmltree", &["io"]),
    ("std::thread", &["pipeline", "gui"]),
    ("std::fs", &["io", "project", "cli", "gui"]),
    ("println!", &["cli", "main"]),
    ("eprintln!", &["cli", "gui", "main"]),
];

const LONGEST_FILE: usize = 500;

fn sources() -> Vec<(String, PathBuf, String)> {
    fn collect(folder: &Path, into: &mut Vec<PathBuf>) {
        let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                collect(&path, into);
            } else if path.extension().is_some_and(|e| e == "rs") {
                into.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    collect(&root, &mut paths);
    assert!(paths.len() > 20, "the sources were found");
    let module = |path: &Path| {
        let first = path.strip_prefix(&root).unwrap().components().next().unwrap();
        first.as_os_str().to_string_lossy().trim_end_matches(".rs").to_owned()
    };
    paths.into_iter().map(|p| (module(&p), p.clone(), std::fs::read_to_string(&p).unwrap())).collect()
}

/// The code without its tests and comments: tests may reach anywhere.
fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let end = text.lines().position(|l| l.trim_start().starts_with("#[cfg(test)]")).unwrap_or(usize::MAX);
    text.lines().enumerate().take(end).filter(|(_, l)| !l.trim_start().starts_with("//"))
}

/// Modules named by `crate::x` in a line; `use crate::{a, b}` is not allowed, so that this stays simple.
fn named_modules(line: &str) -> Vec<&str> {
    let after = |prefix: &str| -> Vec<usize> { line.match_indices(prefix).map(|(i, p)| i + p.len()).collect() };
    let mut starts = after("crate::");
    starts.extend(after("conformant::"));
    starts.iter().map(|&s| line[s..].split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("")).collect()
}

#[test]
fn imports_point_one_way() {
    let allowed: BTreeMap<&str, BTreeSet<&str>> =
        LAYERS.iter().map(|(m, names)| (*m, names.iter().copied().collect())).collect();
    let mut faults = Vec::new();
    for (module, path, text) in sources() {
        let Some(may) = allowed.get(module.as_str()) else {
            faults.push(format!("{}: module {module} is in no layer", path.display()));
            continue;
        };
        for (n, line) in code_lines(&text) {
            for name in named_modules(line) {
                if name != module && !may.contains(name) {
                    faults.push(format!("{}:{}: {module} may not name \"{name}\"", path.display(), n + 1));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn outside_names_stay_where_they_belong() {
    let mut faults = Vec::new();
    for (module, path, text) in sources() {
        for (n, line) in code_lines(&text) {
            for (name, modules) in OUTSIDE {
                let used = if name.ends_with('!') || name.contains("::") {
                    line.contains(name) && !line.contains(&format!("e{name}"))
                } else {
                    line.contains(&format!("{name}::")) || line.contains(&format!("use {name};"))
                };
                if used && !modules.contains(&module.as_str()) {
                    faults.push(format!("{}:{}: {module} may not use {name}", path.display(), n + 1));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn no_file_is_too_long() {
    let long: Vec<String> = sources()
        .iter()
        .filter(|(_, _, text)| text.lines().count() > LONGEST_FILE)
        .map(|(_, path, text)| format!("{}: {} lines", path.display(), text.lines().count()))
        .collect();
    assert!(long.is_empty(), "more than {LONGEST_FILE} lines:\n{}", long.join("\n"));
}

#[test]
fn the_check_itself_sees_a_lawless_line() {
    assert_eq!(named_modules("use crate::gui::App;"), ["gui"], "a plain import");
    assert_eq!(named_modules("let x = crate::cli::run(crate::task::Task::default());"), ["cli", "task"], "in code");
    assert_eq!(code_lines("// crate::gui\nuse a;\n#[cfg(test)]\nuse crate::gui;").count(), 1, "comments and tests");
}
