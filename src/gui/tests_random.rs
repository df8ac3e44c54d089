//! Ten thousand random commands and edits, and that every change can be taken back to the bit.
//!
//! The window is real but for the graphics adapter; frames are drawn now and then only. Left out: what leads to another
//! project or closes the window (done between the rounds instead, where it belongs), the dialogs' own buttons, and waiting
//! for results: meshing and solving are called off as soon as they are asked for.

use super::app::App;
use super::command::Command;
use super::outbox::Action;
use super::preset_fields;
use super::session::first_project;
use super::tests::{Window, window};
use crate::project::{CompensationMode, Edit, PresetEntry, Project, Settings};
use egui::Context;
use fastrand::Rng;

const ROUNDS: usize = 50;
/// Fewer than the history holds, so that the beginning of a round can be gone back to.
const PER_ROUND: usize = 200;

/// The project as its file spells it, without the line's end.
fn bytes(app: &App) -> Vec<u8> {
    serde_json::to_vec(app.session.project()).expect("finite numbers")
}

/// Whether it leads to another project or out of the window.
fn leaves(command: Command) -> bool {
    matches!(command, Command::New | Command::Open | Command::Quit | Command::Example(_))
}

/// Now and then nonsense.
fn number(rng: &mut Rng) -> f64 {
    match rng.u32(0..12) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => 0.0,
        3 => 1e300,
        _ => (rng.f64() - 0.3) * 10.0,
    }
}

fn entry(rng: &mut Rng) -> PresetEntry {
    let choices = preset_fields::choices();
    PresetEntry { enabled: rng.bool(), preset: choices[rng.usize(0..choices.len())].2 }
}

/// An edit that may be refused.
fn edit(rng: &mut Rng, project: &Project) -> Edit {
    let count = project.presets.len() + 1;
    match rng.u32(0..12) {
        0 => {
            let mut antenna = project.antenna.clone();
            *[&mut antenna.width_mm, &mut antenna.height_mm, &mut antenna.substrate.eps_r][rng.usize(0..3)] =
                number(rng);
            Edit::SetAntenna(antenna)
        }
        1 => {
            let mut cage = project.cage;
            if rng.bool() {
                cage.segments[rng.usize(0..2)] = rng.usize(0..14);
            } else {
                cage.padding_mm[rng.usize(0..3)] = number(rng);
            }
            Edit::SetCage(cage)
        }
        2 => Edit::SetPresets((0..rng.usize(0..4)).map(|_| entry(rng)).collect()),
        3 => Edit::SetPreset { index: rng.usize(0..count), entry: entry(rng) },
        4 => Edit::InsertPreset { index: rng.usize(0..count), entry: entry(rng) },
        5 => Edit::RemovePreset { index: rng.usize(0..count) },
        6 => Edit::ReorderPreset { from: rng.usize(0..count), to: rng.usize(0..count) },
        7 => Edit::ClearHandEdits,
        11 => Edit::Restore(Box::new(first_project())),
        8 => {
            let mut settings = project.settings;
            match rng.u32(0..3) {
                0 => settings.tolerance_mm = number(rng).abs() / 100.0,
                1 => settings.fit_orders[rng.usize(0..2)] = rng.usize(0..14),
                _ => settings.compensation = [CompensationMode::None, CompensationMode::Wl][rng.usize(0..2)],
            }
            Edit::SetSettings(settings)
        }
        _ => {
            let vertex = |rng: &mut Rng| rng.u32(0..u32::try_from(project.cage.n_handles() + 1).expect("few"));
            let moved = (0..rng.usize(1..5)).map(|_| (vertex(rng), [number(rng), 0.25, -number(rng)]));
            Edit::MoveVertices(moved.collect())
        }
    }
}

/// One random wish, carried out as the window does it.
fn act(app: &mut App, ctx: &Context, rng: &mut Rng) {
    let action = match rng.u32(0..20) {
        0..=7 => Action::Edit("anywhere", edit(rng, app.session.project())),
        8 => Action::Begin,
        9 => Action::End,
        10 => Action::Cancel,
        11 => {
            let steps = app.session.history().entries();
            Action::GoTo(steps[rng.usize(0..steps.len())].number)
        }
        12 => Action::AddPreset(entry(rng).preset),
        13 => Action::Run([Command::Undo, Command::Redo][rng.usize(0..2)]),
        _ => Action::Run(Command::ALL[rng.usize(0..Command::ALL.len())]),
    };
    if !matches!(action, Action::Run(command) if leaves(command)) {
        app.carry_out(ctx, action);
    }
    app.mesh.cancel();
    app.solve.cancel();
}

#[test]
fn ten_thousand_random_commands_do_no_harm_and_can_all_be_taken_back() {
    let mut rng = Rng::with_seed(17);
    let mut window = window();
    let ctx = window.ctx.clone();
    let mut n_changes = 0;
    for round in 0..ROUNDS {
        let app = window.state_mut();
        app.carry_out(&ctx, Action::End);
        let project = if rng.bool() { app.session.project().clone() } else { first_project() };
        app.carry_out(&ctx, Action::Start(Box::new(project)));
        let start = bytes(app);
        for _ in 0..PER_ROUND {
            let before = app.session.project().clone();
            act(app, &ctx, &mut rng);
            n_changes += usize::from(*app.session.project() != before);
        }
        assert!(app.session.project().validate().is_ok(), "valid in round {round}");
        // Some frames show it as it is; the worker is asked, and what is outdated is dropped.
        app.dialog = super::dialogs::Dialog::None;
        window.step();
        window.state_mut().session.stop_work();
        let app = window.state_mut();
        while app.session.history().can_undo() {
            app.session.undo();
        }
        assert_eq!(bytes(app), start, "back at the start of round {round}");
    }
    assert!(n_changes > 2000, "the commands do something: {n_changes} changes");
}

/// A window in which every command that changes the project can change it.
fn busy_window() -> Window {
    let mut window = window();
    let app = window.state_mut();
    app.edit("", Edit::MoveVertices(vec![(3, [0.1, 0.2, 0.3]), (5, [0.0, 0.1, 0.0])]));
    window
}

fn set_compensation(app: &mut App, compensation: CompensationMode) {
    let settings = app.session.project().settings;
    app.edit("", Edit::SetSettings(Settings { compensation, ..settings }));
}

#[test]
fn every_command_that_changes_the_project_is_undone_and_redone_to_the_bit() {
    let mut window = busy_window();
    let ctx = window.ctx.clone();
    let app = window.state_mut();
    let mut changing = Vec::new();
    for &command in Command::ALL.iter().filter(|c| !leaves(**c)) {
        if matches!(command, Command::Undo | Command::Redo) {
            continue;
        }
        for compensation in [CompensationMode::None, CompensationMode::Isometric] {
            set_compensation(app, compensation);
            app.state.selection = [3].into();
            let before = bytes(app);
            app.carry_out(&ctx, Action::Run(command));
            app.mesh.cancel();
            app.solve.cancel();
            let after = bytes(app);
            if after == before {
                continue;
            }
            changing.push(command);
            app.session.undo();
            assert_eq!(bytes(app), before, "{command:?} undone");
            app.session.redo();
            assert_eq!(bytes(app), after, "{command:?} redone");
            app.session.undo();
        }
    }
    let expected = [Command::ResetSelected, Command::ResetAll, Command::Compensate, Command::CompensateNot];
    for command in expected {
        assert!(changing.contains(&command), "{command:?} changes the project: {changing:?}");
    }
}

#[test]
fn every_kind_of_edit_is_undone_and_redone_to_the_bit() {
    let mut window = busy_window();
    let app = window.state_mut();
    let mut rng = Rng::with_seed(29);
    let mut kinds = std::collections::BTreeSet::new();
    for _ in 0..400 {
        let edit = edit(&mut rng, app.session.project());
        let kind = format!("{edit:?}").split([' ', '(']).next().map(str::to_owned);
        let before = bytes(app);
        app.edit("", edit);
        let after = bytes(app);
        if after != before {
            app.session.undo();
            assert_eq!(bytes(app), before, "{kind:?} undone");
            app.session.redo();
            assert_eq!(bytes(app), after, "{kind:?} redone");
            kinds.extend(kind);
        }
    }
    assert_eq!(kinds.len(), 11, "{kinds:?}");
}
