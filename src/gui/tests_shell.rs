//! Tests of the window's frame: commands by key and palette, names for screen readers, sides and sizes.

use super::app::UNKNOWN;
use super::command::{Command, Facts};
use super::dialogs::Dialog;
use super::layout::Pane;
use super::outbox::Action;
use super::tests::{Window, drag, drop, lay_out, run, settle, window};
use super::ui_state::{ResultTab, RightTab, Tab};
use crate::project::{Example, PresetSpec};
use egui::accesskit::{self, Role};
use egui::{Event, Key, Modifiers, RawInput};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

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
        has_cylinder: true,
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
        assert!(!command.keys(ctx.os()).is_empty(), "{command:?} has a key");
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

/// The controls on show that have no name for a screen reader.
pub(super) fn unnamed<S>(window: &Harness<'_, S>) -> Vec<String> {
    let nodes = window.root().children_recursive().map(|node| node.accesskit_node());
    let nameless = nodes.filter(|node| {
        // Edges of panels are told by their role and their value; egui gives them no name.
        let is_control = node.data().supports_action(accesskit::Action::Focus) && node.role() != Role::Splitter;
        is_control && node.label().is_none_or(|label| label.trim().is_empty())
    });
    nameless.map(|node| format!("{:?} {:?} {:?}", node.role(), node.value(), node.bounding_box())).collect()
}

#[test]
fn a_control_without_a_name_is_noticed() {
    let plain = Harness::builder().with_accessibility_check(false).build_ui(|ui| {
        ui.add(egui::Button::new(""));
        ui.add(egui::Button::new("Named"));
    });
    assert_eq!(unnamed(&plain).len(), 1, "{:?}", unnamed(&plain));
}

#[test]
fn every_control_has_a_name_for_screen_readers() {
    let mut window = window();
    let ctx = window.ctx.clone();
    let mut faults = Vec::new();
    let mut look = |window: &mut Window, at: &str| {
        lay_out(window);
        faults.extend(unnamed(window).into_iter().map(|fault| format!("{at}: {fault}")));
    };
    look(&mut window, "first window");
    for (_, _, preset) in super::preset_fields::choices() {
        window.state_mut().carry_out(&ctx, Action::AddPreset(preset));
    }
    window.state_mut().state.selection = [1, 2].into();
    look(&mut window, "all presets");
    for tab in [Tab::Antenna, Tab::History] {
        window.state_mut().state.tab = tab;
        look(&mut window, "left tabs");
    }
    window.state_mut().carry_out(&ctx, Action::Run(Command::Compensate));
    for tab in [RightTab::Figures, RightTab::Mesh, RightTab::Solve] {
        window.state_mut().state.right_tab = tab;
        look(&mut window, "right tabs");
    }
    for command in [Command::ShowResults, Command::ShowLog] {
        window.state_mut().carry_out(&ctx, Action::Run(command));
        look(&mut window, "below the view");
    }
    let dialogs = [Command::Palette, Command::Keys, Command::Welcome, Command::SaveAs, Command::Open, Command::Export];
    let saving = [Command::SavePlot, Command::SavePicture, Command::Report, Command::ImportOutline];
    window.state_mut().state.heat = super::ui_state::Heat::Area;
    for command in dialogs.into_iter().chain(saving) {
        window.state_mut().dialog = Dialog::None;
        window.state_mut().session.apply(crate::project::Edit::ClearHandEdits).expect("always possible");
        window.state_mut().carry_out(&ctx, Action::Run(command));
        look(&mut window, "dialogs");
    }
    window.state_mut().dialog = Dialog::Changed;
    look(&mut window, "file changed");
    window.state_mut().dialog = Dialog::Overwrite("a.json".into(), None);
    look(&mut window, "file to replace");
    window.state_mut().dialog = Dialog::None;
    lay_out(&mut window);
    for (title, _) in super::bars::MENUS {
        window.get_all_by_role_and_label(Role::Button, title).next().expect("the menu").click();
        look(&mut window, title);
        window.key_press(Key::Escape);
        lay_out(&mut window);
    }
    assert!(faults.is_empty(), "{} without a name:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_control_of_the_results_has_a_name() {
    let mut window = super::tests_solve::solved();
    window.state_mut().state.right_tab = RightTab::Solve;
    for tab in [ResultTab::Reflection, ResultTab::Pattern] {
        window.state_mut().state.solve.tab = tab;
        lay_out(&mut window);
        assert_eq!(unnamed(&window), Vec::<String>::new(), "{tab:?}");
    }
}

#[test]
fn every_command_is_carried_out() {
    let mut window = window();
    for &command in Command::ALL {
        run(&mut window, command);
        let said: Vec<&str> = window.state().messages.texts().filter(|text| text.starts_with(UNKNOWN)).collect();
        assert!(said.is_empty(), "{command:?}: {said:?}");
        window.state_mut().dialog = Dialog::None;
        window.state_mut().mesh.cancel();
        window.state_mut().solve.cancel();
    }
}

#[test]
fn long_numbers_widen_no_panel() {
    let mut window = window();
    let left = |window: &Window| window.get_by_label("3-D view").rect().left();
    let before = left(&window);
    let ctx = window.ctx.clone();
    for (_, _, preset) in super::preset_fields::choices() {
        window.state_mut().carry_out(&ctx, Action::AddPreset(preset));
    }
    let twist = PresetSpec::Twist { amplitude_mm: -14.375, rate_deg_per_mm: -2.345 };
    window.state_mut().carry_out(&ctx, Action::AddPreset(twist));
    for tab in [Tab::Cage, Tab::Antenna, Tab::History] {
        window.state_mut().state.tab = tab;
        lay_out(&mut window);
        assert!((left(&window) - before).abs() < 0.5, "{tab:?}: {} instead of {before}", left(&window));
    }
}

#[test]
fn f6_goes_from_panel_to_panel_and_back() {
    let mut window = window();
    let focused = |window: &Window| {
        let id = window.ctx.memory(|m| m.focused()).expect("something has the keys");
        window.ctx.viewport(|v| v.prev_pass.widgets.get(id).map(|w| w.rect)).expect("it is on show")
    };
    let mut places = Vec::new();
    for _ in 0..6 {
        window.key_press(Key::F6);
        lay_out(&mut window);
        places.push(focused(&window));
    }
    for (k, place) in places.iter().enumerate() {
        assert!(!places[..k].contains(place), "panel {k} is another one: {places:?}");
    }
    window.key_press_modifiers(Modifiers::SHIFT, Key::F6);
    lay_out(&mut window);
    assert_eq!(focused(&window), places[4], "and back");
    window.key_press(Key::Tab);
    lay_out(&mut window);
    assert_ne!(focused(&window), places[4], "Tab goes on within");
}

#[test]
fn sides_are_hidden_and_the_layout_is_reset() {
    let mut window = window();
    let width = |window: &Window| window.get_by_label("3-D view").rect().width();
    let before = width(&window);
    for key in [Key::F8, Key::F9] {
        window.key_press(key);
    }
    window.run_steps(60);
    assert!(width(&window) > before + 400.0, "the view takes the room: {}", width(&window));
    window.state_mut().state.shows_log = true;
    let ctx = window.ctx.clone();
    window.state_mut().carry_out(&ctx, Action::Run(Command::ZoomIn));
    window.run_steps(2);
    window.state_mut().carry_out(&ctx, Action::Run(Command::ResetLayout));
    window.run_steps(60);
    assert!((width(&window) - before).abs() < 1.0, "as at the start: {} and {before}", width(&window));
}

#[test]
fn a_tab_is_dragged_to_another_place_kept_and_put_back() {
    let mut window = window();
    let view = |window: &Window| window.get_by_label("3-D view").rect();
    let before = view(&window);
    let from = window.get_by_label("History").rect().center();
    let to = egui::pos2(before.right() - 30.0, before.center().y);
    drag(&mut window, from, to);
    drop(&mut window, to);
    lay_out(&mut window);
    let in_front = |window: &Window, pane| window.state().state.layout.is_in_front(pane);
    assert!(in_front(&window, Pane::History) && in_front(&window, Pane::Cage), "side by side");
    assert!(view(&window).width() < before.width() - 200.0, "beside the view: {}", view(&window));
    assert_eq!(unnamed(&window), Vec::<String>::new(), "every tab has a name");
    let text = serde_json::to_string(&window.state().state).expect("plain values");
    let mut back: super::ui_state::UiState = serde_json::from_str(&text).expect("readable");
    back.restore_camera();
    assert_eq!(back.layout, window.state().state.layout, "kept between runs");
    run(&mut window, Command::ResetLayout);
    window.run_steps(4);
    assert!((view(&window).width() - before.width()).abs() < 1.0, "as at the first start: {}", view(&window));
    assert!(!in_front(&window, Pane::History), "behind the cage's tab again");
    window.get_by_label("History").click();
    lay_out(&mut window);
    assert_eq!(window.state().state.tab, Tab::History, "a click brings it forward");
    run(&mut window, Command::Mesh);
    assert!(in_front(&window, Pane::Mesh), "a command brings its pane forward");
    window.state_mut().mesh.cancel();
}

#[test]
fn results_and_messages_are_panes_that_commands_show_bring_forward_and_hide() {
    let mut window = super::tests_solve::solved();
    let in_front = |window: &Window, pane| window.state().state.layout.is_in_front(pane);
    let place = |window: &Window, pane| {
        let areas = window.state().state.layout.areas();
        areas.into_iter().find(|(p, _)| *p == pane).expect("it is on show").1
    };
    let tab = |window: &Window, name| window.get_all_by_label(name).last().expect("its tab").rect().center();
    let corner = |window: &Window| window.state().state.layout.height_at_corner(400.0);
    let below = place(&window, Pane::Results);
    assert!((corner(&window) - below.height()).abs() < 1.0, "notifications stay above: {below}");
    run(&mut window, Command::ShowLog);
    assert!(in_front(&window, Pane::Results) && in_front(&window, Pane::Messages), "upon each other");
    let (from, to) = (tab(&window, "Messages"), place(&window, Pane::Results).center());
    drag(&mut window, from, to);
    drop(&mut window, to);
    lay_out(&mut window);
    assert!(in_front(&window, Pane::Messages) && !in_front(&window, Pane::Results), "one behind the other");
    run(&mut window, Command::ShowResults);
    assert!(in_front(&window, Pane::Results), "brought forward, and not hidden");
    let view = window.get_by_label("3-D view").rect();
    let (from, to) = (tab(&window, "Results"), egui::pos2(view.right() - 20.0, view.center().y));
    drag(&mut window, from, to);
    drop(&mut window, to);
    lay_out(&mut window);
    let beside = place(&window, Pane::Results);
    assert!(beside.width() < 500.0 && beside.height() > beside.width(), "beside the view: {beside}");
    let messages = place(&window, Pane::Messages).height();
    assert!((corner(&window) - messages).abs() < 1.0, "notifications stay above the messages: {}", corner(&window));
    assert_eq!(unnamed(&window), Vec::<String>::new(), "every control has a name");
    window.get_by_label("Close the results").click();
    lay_out(&mut window);
    assert!(!in_front(&window, Pane::Results) && !window.state().state.solve.shows_results, "hidden");
    run(&mut window, Command::ShowLog);
    assert!(!in_front(&window, Pane::Messages) && corner(&window) < 1.0, "hidden");
    run(&mut window, Command::ResetLayout);
    run(&mut window, Command::ShowResults);
    assert!((place(&window, Pane::Results).top() - below.top()).abs() < 1.0, "where it was at first");
}

#[test]
fn the_interface_grows_and_shrinks_by_key_and_within_limits() {
    let mut window = window();
    let scale = |window: &Window| (window.ctx.zoom_factor() * 10.0).round() as i32;
    window.key_press_modifiers(Modifiers::COMMAND, Key::Plus);
    window.run_steps(2);
    assert_eq!(scale(&window), 11, "larger");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num0);
    window.run_steps(2);
    assert_eq!(scale(&window), 10, "normal");
    for _ in 0..9 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Minus);
        window.run_steps(2);
    }
    assert_eq!(scale(&window), 7, "not too small to be undone");
    assert!((window.state().state.scale - 0.7).abs() < 1e-6, "remembered");
}

#[test]
fn the_status_line_tells_what_all_workers_do() {
    let mut window = window();
    window.state_mut().state.mesh.density = crate::pipeline::Density::Coarse;
    let ctx = window.ctx.clone();
    window.state_mut().carry_out(&ctx, Action::Run(Command::Mesh));
    window.step();
    let busy = window.state().mesh.is_busy();
    let told = window.query_all_by_label_contains("Meshing").count();
    assert!(!busy || told > 0, "meshing is told");
    window.state_mut().mesh.cancel();
}

#[test]
fn examples_are_computed_and_need_no_file() {
    for example in Example::ALL {
        let mut window = window();
        let ctx = window.ctx.clone();
        window.state_mut().carry_out(&ctx, Action::Run(Command::Example(example)));
        settle(&mut window);
        let session = &window.state().session;
        assert!(session.finished().is_some(), "{example:?}: {:?}", session.refusal());
        assert!(session.path.is_none() && !session.history().is_dirty(), "{example:?} is new");
    }
}
