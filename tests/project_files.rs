//! Project files that went wrong: ten thousand damaged ones, and a save that is killed half-way.

#![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]

use conformant::cage::pose;
use conformant::project::{BendPlane, PresetEntry, PresetSpec, Project, RuleSpec, file};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A project with every kind of entry, so that mutations reach each reader.
fn rich_project() -> Project {
    let mut project = Project::default();
    project.cage.segments = [6, 5];
    let presets = [
        PresetSpec::Bend { plane: BendPlane::H, radius_mm: 20.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 },
        PresetSpec::Convex { radius_mm: 25.0, amplitude_mm: 3.0 },
        PresetSpec::Concave { radius_mm: 25.0, amplitude_mm: 3.0 },
        PresetSpec::Saddle { radius_mm: 25.0, amplitude_mm: 3.0 },
        PresetSpec::Twist { amplitude_mm: 2.0, rate_deg_per_mm: 0.6 },
        PresetSpec::Crumple { amplitude_mm: 1.0, waves: [2.0, 0.5], phase_deg: 30.0 },
    ];
    project.presets = presets.map(|preset| PresetEntry { enabled: true, preset }).to_vec();
    for vertex in [0, 5, 83] {
        project.hand_edits.insert(vertex, [0.25, -0.5, 1.0]);
    }
    project
}

/// The places of the numbers in a JSON text.
fn numbers(text: &[u8]) -> Vec<(usize, usize)> {
    let is_number = |b: u8| b.is_ascii_digit() || matches!(b, b'-' | b'+' | b'.' | b'e');
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let before = at == 0 || matches!(text[at - 1], b' ' | b'[' | b':' | b'\n' | b',');
        let end = at + text[at..].iter().take_while(|&&b| is_number(b)).count();
        if before && end > at {
            found.push((at, end));
        }
        at = end.max(at + 1);
    }
    found
}

fn mutate(text: &mut Vec<u8>, rng: &mut fastrand::Rng) {
    const VALUES: [&str; 14] = [
        "1e308",
        "-1",
        "NaN",
        "\"ten\"",
        "0",
        "-0.0",
        "1e999",
        "null",
        "[]",
        "{}",
        "4294967296",
        "18446744073709551616",
        "1e-320",
        "2.5",
    ];
    if text.is_empty() {
        return;
    }
    let (a, b) = (rng.usize(0..text.len()), rng.usize(0..text.len()));
    let (lo, hi) = (a.min(b), a.max(b).min(a.min(b) + 200));
    match rng.u8(0..8) {
        0 => text[a] ^= 1 << rng.u8(0..8),
        1 => text[a] = rng.u8(..),
        2 => drop(text.drain(lo..hi)),
        3 => {
            let copy = text[lo..hi].to_vec();
            text.splice(b..b, copy);
        }
        4 => text.truncate(a),
        5 => {
            if let Some(&(start, end)) = rng.choice(&numbers(text)) {
                text.splice(start..end, VALUES[rng.usize(0..VALUES.len())].bytes());
            }
        }
        _ => {
            if let Some(&(start, end)) = rng.choice(&numbers(text)) {
                let value: f64 = String::from_utf8_lossy(&text[start..end]).parse().unwrap_or(1.0);
                text.splice(start..end, (value * (rng.f64() + 0.5)).to_string().bytes());
            }
        }
    }
}

#[test]
fn ten_thousand_damaged_files_load_or_give_a_message() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.json");
    file::write(&path, &rich_project()).expect("valid");
    let good = fs::read(&path).unwrap();
    let mut rng = fastrand::Rng::with_seed(77);
    let (mut loaded, mut posed, mut refused) = (0, 0, 0);
    for case in 0..10_000 {
        let mut text = good.clone();
        for _ in 0..rng.usize(1..4) {
            mutate(&mut text, &mut rng);
        }
        fs::write(&path, &text).unwrap();
        match file::read(&path) {
            Ok(project) => {
                loaded += 1;
                project.antenna.to_params().validate().expect("what loads has been validated");
                let cage = project.rest_cage().expect("what loads has a cage");
                assert_eq!(cage.n_handles(), project.cage.n_handles(), "case {case}");
                match pose(&cage, &project.active_presets()) {
                    Ok(vertices) => posed += usize::from(vertices.iter().all(|p| p.is_finite())),
                    Err((index, error)) => assert!(!error.to_string().is_empty(), "preset {index} says why"),
                }
            }
            Err(error) => {
                refused += 1;
                let message = error.to_string();
                assert!(message.contains("a.json") && message.len() < 600, "case {case}: {message}");
            }
        }
    }
    // Both sides of the reader were really tried.
    assert!(loaded > 1000 && refused > 5000, "{loaded} loaded, {refused} refused");
    assert!(posed > 500, "{posed} of {loaded} posed");
}

/// The project that the saving child writes in its n-th round: sizes differ, so that a torn file could not go unseen.
fn round(n: u32) -> Project {
    let mut project = Project::default();
    for vertex in 0..(n * 37) % 240 {
        project.hand_edits.insert(vertex, [f64::from(n), 0.1, 0.2]);
    }
    project.settings.tolerance_mm = 0.01 + f64::from(n % 1000) * 1e-6;
    project
}

const CHILD: &str = "CONFORMANT_TEST_SAVE_TO";

/// Run as a child by the test below; alone it has nothing to do.
#[test]
fn child_that_saves_until_it_is_killed() {
    let Some(path) = std::env::var_os(CHILD) else { return };
    for n in 0.. {
        file::write(Path::new(&path), &round(n)).expect("saves");
    }
}

#[test]
fn a_save_killed_half_way_leaves_a_whole_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.json");
    file::write(&path, &rich_project()).expect("valid");
    let mut rng = fastrand::Rng::with_seed(9);
    let mut replaced = 0;
    for kill in 0..25 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "child_that_saves_until_it_is_killed", "--test-threads", "1"])
            .env(CHILD, &path)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_micros(rng.u64(5_000..60_000)));
        child.kill().unwrap();
        child.wait().unwrap();
        let project = file::read(&path).unwrap_or_else(|e| panic!("kill {kill}: {e}"));
        replaced += usize::from(project != rich_project());
    }
    assert!(replaced > 5, "the child did save in {replaced} of 25 rounds");
}
