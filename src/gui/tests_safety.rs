//! Tests that the user's work is safe: crash, recovery, files changed from outside, recent files.

use super::command::Command;
use super::outbox::Action;
use super::recovery::{Pace, Recovery};
use super::tests::{Window, lay_out, project, window};
use super::tests_shell::unnamed;
use crate::project::{Edit, Project, file};
use egui_kittest::kittest::Queryable;
use std::path::Path;
use std::process::{Command as Process, Stdio};
use std::time::{Duration, Instant};

const LIFTED: u32 = 3;

fn lift(window: &mut Window, mm: f64) {
    window.state_mut().edit("hand edits", Edit::MoveVertices(vec![(LIFTED, [0.0, 0.0, mm])]));
}

/// Which lift a project holds, in micrometres.
fn lifted(project: &Project) -> i64 {
    project.hand_edits.get(&LIFTED).map_or(0, |offset| (offset[2] * 1e3).round() as i64)
}

fn carry_out(window: &mut Window, action: Action) {
    let ctx = window.ctx.clone();
    window.state_mut().carry_out(&ctx, action);
    lay_out(window);
}

/// Where the process that is killed keeps its work, for the test that starts it.
const CRASH_DIR: &str = "CONFORMANT_TEST_CRASH_DIR";

/// Edits until it is killed. Not a test of its own: the next one starts it in another process.
#[test]
#[ignore = "runs until it is killed"]
fn edits_without_end() {
    let Some(dir) = std::env::var_os(CRASH_DIR) else { return };
    let mut window = window();
    let mut recovery = Recovery::new(Some(dir.clone().into()));
    // A tenth of the real times, so that the test is short.
    let real = Pace::default();
    recovery.pace = Pace { rest: real.rest / 10, longest: real.longest / 10 };
    window.state_mut().recovery = recovery;
    for count in 1_i32.. {
        if count % 3 == 0 {
            carry_out(&mut window, Action::Begin);
        }
        lift(&mut window, f64::from(count) * 1e-3);
        if count % 3 == 2 {
            carry_out(&mut window, Action::End);
        }
        window.step();
        // Whole at every moment, as the process is killed at any.
        let [new, told] = ["count.new", "count"].map(|name| Path::new(&dir).join(name));
        std::fs::write(&new, count.to_string()).expect("writable");
        std::fs::rename(new, told).expect("writable");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn work_of_a_killed_process_is_offered_and_recovered() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut child = Process::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "gui::tests_safety::edits_without_end", "--ignored"])
        .env(CRASH_DIR, dir.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("started");
    let start = Instant::now();
    let kept = |file: &str| {
        let folders = std::fs::read_dir(dir.path()).expect("readable").flatten();
        folders.map(|f| f.path().join(file)).find(|f| f.is_file())
    };
    while kept("project.json").is_none() {
        assert!(start.elapsed() < Duration::from_secs(120), "something is kept");
        std::thread::sleep(Duration::from_millis(20));
    }
    // In the middle of edits, and perhaps of a write.
    std::thread::sleep(Duration::from_millis(700));
    assert!(Recovery::new(Some(dir.path().to_owned())).found.is_empty(), "it still lives");
    child.kill().expect("killed");
    child.wait().expect("gone");
    let count: i64 = std::fs::read_to_string(dir.path().join("count")).expect("told").parse().expect("a number");
    let mut window = window();
    window.state_mut().recovery = Recovery::new(Some(dir.path().to_owned()));
    window.state_mut().offer_recovery();
    lay_out(&mut window);
    window.get_by_label("Unsaved work was found");
    window.key_press(egui::Key::Enter);
    lay_out(&mut window);
    let found = lifted(&project(&window));
    assert!(found > 0 && found <= count + 1, "a state that the process was in: {found} of {count}");
    // An edit takes 20 ms at least, so that this is less than ten seconds of work even at the real pace.
    assert!(count - found < 500, "at most ten seconds lost: {found} of {count}");
    assert!(window.state().session.history().is_dirty(), "it is not saved yet");
    carry_out(&mut window, Action::Run(Command::Undo));
    assert_eq!(lifted(&project(&window)), 0, "recovered as one step");
}

#[test]
fn discarded_work_is_gone_and_a_saved_window_leaves_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let root = || Some(dir.path().join("kept"));
    let mut first = window();
    let mut recovery = Recovery::new(root());
    recovery.pace = Pace { rest: Duration::ZERO, longest: Duration::ZERO };
    first.state_mut().recovery = recovery;
    lift(&mut first, 0.1);
    first.step();
    first.state_mut().recovery.close(true);
    drop(first);
    let mut second = window();
    second.state_mut().recovery = Recovery::new(root());
    second.state_mut().offer_recovery();
    lay_out(&mut second);
    second.get_by_label("A project that was never saved");
    assert_eq!(unnamed(&second), Vec::<String>::new(), "every control of the dialog has a name");
    second.get_by_label("Discard").click();
    lay_out(&mut second);
    lay_out(&mut second);
    assert!(second.query_by_label("Unsaved work was found").is_none(), "nothing more to decide");
    assert!(Recovery::new(root()).found.is_empty(), "gone");
    lift(&mut second, 0.2);
    second.state_mut().recovery.pace = Pace { rest: Duration::ZERO, longest: Duration::ZERO };
    second.run_steps(2);
    carry_out(&mut second, Action::SavePath(dir.path().join("a.json"), None));
    let left = std::fs::read_dir(dir.path().join("kept")).expect("readable").count();
    assert_eq!(left, 0, "saved work is not kept twice");
}

/// A window on a saved project.
fn saved(path: &Path) -> Window {
    let mut window = window();
    lift(&mut window, 0.1);
    carry_out(&mut window, Action::SavePath(path.to_owned(), None));
    assert!(path.is_file(), "saved");
    window
}

fn change_outside(path: &Path) {
    file::write(path, &Project::default()).expect("writable");
}

#[test]
fn a_file_changed_outside_is_offered_for_reload_and_mine_can_be_had_back() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.json");
    let mut window = saved(&path);
    let mine = project(&window);
    change_outside(&path);
    let start = Instant::now();
    while window.query_by_label("Keep mine").is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "noticed");
        std::thread::sleep(Duration::from_millis(20));
        window.step();
    }
    lay_out(&mut window);
    window.get_by_label("Reload").click();
    lay_out(&mut window);
    assert_eq!(project(&window), Project::default(), "taken over");
    assert!(!window.state().session.history().is_dirty(), "as in the file");
    carry_out(&mut window, Action::Run(Command::Undo));
    assert_eq!(project(&window), mine, "mine is one step back");
}

#[test]
fn a_file_changed_outside_is_not_replaced_unasked() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.json");
    let mut window = saved(&path);
    lift(&mut window, 0.2);
    let mine = project(&window);
    change_outside(&path);
    carry_out(&mut window, Action::Run(Command::Save));
    assert_eq!(file::read(&path).expect("readable"), Project::default(), "not replaced");
    window.get_by_label("Replace it").click();
    lay_out(&mut window);
    assert_eq!(file::read(&path).expect("readable"), mine, "replaced as told");
    assert!(!window.state().session.history().is_dirty(), "saved");
    lift(&mut window, 0.3);
    carry_out(&mut window, Action::Run(Command::Save));
    assert!(!window.state().session.history().is_dirty(), "own changes are saved without a question");
}

#[test]
fn files_are_remembered_newest_first_and_opened_again() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, second] = ["a.json", "b.json"].map(|name| dir.path().join(name));
    let mut window = saved(&first);
    carry_out(&mut window, Action::SavePath(second.clone(), None));
    carry_out(&mut window, Action::OpenPath(first.clone()));
    assert_eq!(window.state().state.recent_files, [first.clone(), second.clone()], "each once");
    lift(&mut window, 0.5);
    carry_out(&mut window, Action::AskRecent(second.clone()));
    window.get_by_label("Unsaved changes");
    window.get_by_label("Discard changes").click();
    lay_out(&mut window);
    assert_eq!(window.state().session.path.as_deref(), Some(second.as_path()), "opened");
    std::fs::remove_file(&first).expect("removable");
    window.get_by_label("File").click();
    lay_out(&mut window);
    window.get_by_label_contains("Open recent").click();
    lay_out(&mut window);
    let item = window.get_by_label("a.json");
    assert!(egui_kittest::kittest::NodeT::accesskit_node(&item).is_disabled(), "a file that is gone is greyed");
    carry_out(&mut window, Action::Run(Command::ClearRecent));
    assert!(window.state().state.recent_files.is_empty(), "forgotten");
}

#[test]
fn saving_before_quitting_asks_for_the_file_and_then_quits() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut window = window();
    window.state_mut().state.last_folder = Some(dir.path().to_owned());
    lift(&mut window, 0.1);
    carry_out(&mut window, Action::Run(Command::Quit));
    window.get_by_label("Unsaved changes");
    assert_eq!(unnamed(&window), Vec::<String>::new(), "every control of the dialog has a name");
    window.get_all_by_label("Save").last().expect("the button of the dialog").click();
    lay_out(&mut window);
    window.get_by_label("Save project");
    window.get_all_by_label("Save").last().expect("the button of the dialog").click();
    lay_out(&mut window);
    assert!(dir.path().join("antenna.json").is_file(), "saved as suggested");
    assert!(window.state().may_close, "and quits");
}
