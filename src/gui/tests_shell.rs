//! Tests of the window's frame: commands by key and palette.

use super::command::{Command, Facts};
use super::tests::{Window, lay_out, settle, window};
use egui::{Event, Key, Modifiers, RawInput};
use egui_kittest::kittest::Queryable;

/// Facts under which every command can be used.
fn everything() -> Facts {
    Facts {
        can_undo: true,
        can_redo: true,
        has_recent: true,
        has_selection: true,
        has_hand_edits: true,
        has_mesh: true,
        has_results: true,
        has_pattern: true,
        compensates: true,
        shows_cage: true,
        can_play: true,
        ..Facts::default()
    }
}

#[test]
fn every_key_runs_its_command_and_no_other() {
    let ctx = egui::Context::default();
    for &command in Command::ALL {
        assert!(command.is_enabled(&everything()), "{command:?} can be used");
        for shortcut in command.keys(ctx.os()) {
            let (key, modifiers) = (shortcut.logical_key, shortcut.modifiers);
            let event = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
            ctx.begin_pass(RawInput { events: vec![event], ..RawInput::default() });
            assert_eq!(Command::pressed(&ctx, &everything()), [command], "{shortcut:?}");
            ctx.end_pass().drop_without_applying_deltas();
        }
    }
}

fn open_palette(window: &mut Window, query: &str) {
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    lay_out(window);
    window.get_by_label("Find a command");
    window.event(Event::Text(query.to_owned()));
    lay_out(window);
}

#[test]
fn the_palette_runs_what_is_chosen_with_the_keys() {
    let mut window = window();
    open_palette(&mut window, "select");
    // All vertices come before none.
    window.key_press(Key::ArrowDown);
    window.key_press(Key::ArrowUp);
    window.key_press(Key::Enter);
    settle(&mut window);
    assert!(window.query_by_label("Find a command").is_none(), "closed");
    assert!(!window.state().state.selection.is_empty(), "all vertices are selected");
    assert_eq!(window.state().state.recent_commands, ["Select: Select all vertices"], "remembered");
    open_palette(&mut window, "redo");
    window.key_press(Key::Enter);
    lay_out(&mut window);
    window.get_by_label("Find a command");
    window.key_press(Key::Escape);
    lay_out(&mut window);
    assert!(window.query_by_label("Find a command").is_none(), "called off");
    assert!(!window.state().state.selection.is_empty(), "and nothing else happened");
}
