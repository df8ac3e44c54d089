//! Tests of the whole window without a graphics adapter: real panels, real worker, pointer events one per frame.

use super::app::App;
use super::command::Command;
use super::outbox::Action;
use super::preset_fields;
use super::ui_state::{Heat, Tab};
use crate::project::{CompensationMode, Edit, PresetSpec, Project, file};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Theme, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::time::{Duration, Instant};

pub(super) type Window = Harness<'static, App>;

pub(super) fn window() -> Window {
    let builder = Harness::builder().with_size((1280.0, 800.0)).with_theme(Theme::Dark);
    let mut window = builder.build_eframe(|cc| App::new(cc, None));
    settle(&mut window);
    window
}

/// Steps until the worker has answered; generous, because machines are slow and busy.
pub(super) fn settle(window: &mut Window) {
    let start = Instant::now();
    window.step();
    while window.state().session.is_busy() {
        assert!(start.elapsed() < Duration::from_secs(300), "the worker does not answer");
        std::thread::sleep(Duration::from_millis(5));
        window.step();
    }
    window.step();
}

/// Runs a command, and lets a dialog that it opens find its size.
pub(super) fn run(window: &mut Window, command: Command) {
    let ctx = window.ctx.clone();
    window.state_mut().carry_out(&ctx, Action::Run(command));
    lay_out(window);
}

/// Steps until something is so; generous, because machines are slow and busy.
pub(super) fn until(window: &mut Window, what: &str, is_so: impl Fn(&App) -> bool) {
    let start = Instant::now();
    while !is_so(window.state()) {
        assert!(start.elapsed() < Duration::from_secs(300), "{what} does not happen");
        std::thread::sleep(Duration::from_millis(5));
        window.step();
    }
    lay_out(window);
}

pub(super) fn project(window: &Window) -> Project {
    window.state().session.project().clone()
}

pub(super) fn vertex_place(window: &Window, vertex: usize) -> Pos2 {
    window.get_by_label(&format!("Cage vertex {vertex}")).rect().center()
}

pub(super) fn button(window: &mut Window, at: Pos2, pressed: bool, modifiers: Modifiers) {
    window.event(Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers });
    window.step();
}

pub(super) fn move_to(window: &mut Window, at: Pos2) {
    window.event(Event::PointerMoved(at));
    window.step();
}

/// Presses at `from` and moves to `to` in steps, one event per frame; the button stays down.
pub(super) fn drag(window: &mut Window, from: Pos2, to: Pos2) {
    move_to(window, from);
    button(window, from, true, Modifiers::NONE);
    for k in 1..=5u8 {
        move_to(window, from.lerp(to, f32::from(k) / 5.0));
    }
}

pub(super) fn drop(window: &mut Window, at: Pos2) {
    button(window, at, false, Modifiers::NONE);
    settle(window);
}

/// The vertex with the most room around it, away from the border of the view.
pub(super) fn lone_vertex(window: &Window) -> usize {
    let count = window.state().session.project().cage.n_handles();
    let places: Vec<Pos2> = (0..count).map(|v| vertex_place(window, v)).collect();
    let gap = |v: usize| {
        let others = (0..count).filter(|&w| w != v);
        others.map(|w| places[v].distance(places[w])).fold(f32::INFINITY, f32::min)
    };
    let view = window.get_by_label("3-D view").rect().shrink(40.0);
    let inside = (0..count).filter(|&v| view.contains(places[v]));
    inside.max_by(|&a, &b| gap(a).total_cmp(&gap(b))).expect("vertices are in view")
}

#[test]
fn the_first_window_shows_the_bent_antenna_with_its_figures() {
    let window = window();
    let shown = window.state().session.finished().expect("computed in full");
    let rho = shown.figures.as_ref().expect("the template's").rho_patch;
    assert!((rho + 0.1088).abs() < 0.002, "rho at R = 10, padding 3: {rho}");
    assert!(shown.ideal.is_some(), "the exact cylinder's figures stand beside");
    let label = super::panel_distortion::percent(rho);
    assert!(window.query_all_by_label(&label).next().is_some(), "{label} is read out");
    window.get_by_label("Computed in full");
    assert!(!window.state().session.history().is_dirty(), "nothing to save yet");
}

#[test]
fn dragging_a_vertex_is_live_and_one_undo_step() {
    let mut window = window();
    let before = project(&window);
    let vertex = lone_vertex(&window);
    let from = vertex_place(&window, vertex);
    let to = from + vec2(9.0, -14.0);
    drag(&mut window, from, to);
    settle(&mut window);
    assert_eq!(project(&window).hand_edits.len(), 1, "moved while the button is down");
    let shown = window.state().session.shown().expect("a preview");
    assert!(!shown.deformed.is_final && shown.project == project(&window), "the antenna follows");
    window.get_by_label("Preview");
    drop(&mut window, to);
    let after = project(&window);
    assert!(vertex_place(&window, vertex).distance(to) < 1.0, "the vertex is where the pointer left it");
    assert!(window.state().session.finished().is_some(), "computed in full at the end");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(project(&window), before, "one step back, bit for bit");
    assert!(!window.state().session.history().can_undo(), "there was one step only");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    settle(&mut window);
    assert_eq!(project(&window), after, "and forward again");
}

#[test]
fn escape_calls_a_drag_off() {
    let mut window = window();
    let before = project(&window);
    let from = vertex_place(&window, lone_vertex(&window));
    drag(&mut window, from, from + vec2(30.0, 0.0));
    assert_ne!(project(&window), before, "moved");
    window.key_press(Key::Escape);
    window.step();
    assert_eq!(project(&window), before, "restored while the button is still down");
    move_to(&mut window, from + vec2(50.0, 10.0));
    drop(&mut window, from + vec2(50.0, 10.0));
    assert_eq!(project(&window), before, "nothing follows");
    assert!(!window.state().session.history().can_undo(), "no step");
}

#[test]
fn a_locked_drag_moves_along_one_axis() {
    let mut window = window();
    let vertex = lone_vertex(&window);
    let from = vertex_place(&window, vertex);
    drag(&mut window, from, from + vec2(4.0, -10.0));
    window.key_press(Key::Z);
    window.step();
    move_to(&mut window, from + vec2(5.0, -12.0));
    drop(&mut window, from + vec2(5.0, -12.0));
    let offsets: Vec<[f64; 3]> = project(&window).hand_edits.values().copied().collect();
    let said: Vec<&str> = window.state().messages.texts().collect();
    assert!(matches!(offsets[..], [[0.0, 0.0, z]] if z > 0.1), "along z alone: {offsets:?}, {said:?}");
}

#[test]
fn a_drag_that_ends_in_an_impossible_pose_is_taken_back() {
    let mut window = window();
    let from = vertex_place(&window, lone_vertex(&window));
    let middle = pos2(630.0, 420.0);
    let to = middle + (middle - from) * 1.5;
    drag(&mut window, from, to);
    settle(&mut window);
    drop(&mut window, to);
    let session = &window.state().session;
    assert!(session.finished().is_some() && session.refusal().is_none(), "the pose is possible again");
    let said = window.state().messages.texts().last().expect("a message").to_owned();
    assert!(said.starts_with("Not possible that far"), "{said}");
}

#[test]
fn a_box_selects_the_vertices_inside_it() {
    let mut window = window();
    window.key_press(Key::B);
    window.step();
    let vertex = lone_vertex(&window);
    let at = vertex_place(&window, vertex);
    drag(&mut window, at - vec2(8.0, 8.0), at + vec2(8.0, 8.0));
    drop(&mut window, at + vec2(8.0, 8.0));
    let selected: Vec<u32> = window.state().state.selection.iter().copied().collect();
    assert_eq!(selected, [u32::try_from(vertex).expect("small")], "exactly the one in the box");
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    assert_eq!(window.state().state.selection.len(), project(&window).cage.n_handles(), "all");
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::A);
    window.step();
    assert!(window.state().state.selection.is_empty(), "none");
}

#[test]
fn keys_belong_to_a_field_while_it_is_edited() {
    let mut window = window();
    let slider = window.get_all_by_label("Radius R").next().expect("the slider is labelled").rect();
    let mut numbers = window.get_all_by_role(egui::accesskit::Role::SpinButton).map(|n| n.rect());
    let number = numbers.find(|r| r.y_range().contains(slider.center().y)).expect("a number beside it").center();
    std::mem::drop(numbers);
    move_to(&mut window, number);
    button(&mut window, number, true, Modifiers::NONE);
    button(&mut window, number, false, Modifiers::NONE);
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    assert!(window.ctx.text_edit_focused(), "the number is being edited");
    assert!(window.state().state.selection.is_empty(), "no vertex was selected");
    window.event(Event::Text("12".to_owned()));
    window.key_press(Key::Enter);
    settle(&mut window);
    let PresetSpec::Bend { radius_mm, .. } = project(&window).presets[0].preset else { panic!("a bend") };
    assert!((radius_mm - 12.0).abs() < 1e-12, "typed: {radius_mm}");
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.step();
    assert_eq!(
        window.state().state.selection.len(),
        project(&window).cage.n_handles(),
        "afterwards the key selects vertices"
    );
}

#[test]
fn empty_ground_turns_the_view_and_changes_nothing_else() {
    let mut window = window();
    let before = (project(&window), window.state().state.camera);
    drag(&mut window, pos2(360.0, 120.0), pos2(420.0, 140.0));
    drop(&mut window, pos2(420.0, 140.0));
    assert_ne!(window.state().state.camera, before.1, "turned");
    assert_eq!(project(&window), before.0, "the project stays");
}

#[test]
fn a_preset_slider_is_one_undo_step() {
    let mut window = window();
    let before = project(&window);
    let slider =
        window.get_all_by_label("Radius R").find(|n| n.accesskit_node().role() == egui::accesskit::Role::Slider);
    let rect = slider.expect("the slider is labelled").rect();
    let from = pos2(rect.left() + 12.0, rect.center().y);
    drag(&mut window, from, from + vec2(40.0, 0.0));
    drop(&mut window, from + vec2(40.0, 0.0));
    let radius = |p: &Project| match p.presets[0].preset {
        PresetSpec::Bend { radius_mm, .. } => radius_mm,
        _ => f64::NAN,
    };
    assert!(radius(&project(&window)) > 12.0, "a larger radius: {}", radius(&project(&window)));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(project(&window), before, "one step back");
}

#[test]
fn compensation_converges_and_is_listed() {
    let mut window = window();
    window.get_by_label("Compensate").click();
    settle(&mut window);
    let shown = window.state().session.finished().expect("computed in full");
    let strain = shown.figures.as_ref().expect("the template's").patch_strain;
    assert!(strain < 0.005, "strain {strain}");
    assert!(shown.compensation.len() > 1, "each iteration is reported");
    assert_eq!(super::tests_shell::unnamed(&window), Vec::<String>::new(), "every control has a name");
    window.get_by_label("WL").click();
    settle(&mut window);
    assert_eq!(project(&window).settings.compensation, CompensationMode::Wl, "chosen in the panel");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(project(&window).settings.compensation, CompensationMode::Isometric, "a choice is a step");
}

#[test]
fn a_refused_number_is_explained_beside_its_field() {
    let mut window = window();
    window.state_mut().state.tab = Tab::Antenna;
    window.step();
    let before = project(&window);
    let mut antenna = before.antenna.clone();
    antenna.width_mm = 25.0;
    let ctx = window.ctx.clone();
    window.state_mut().carry_out(&ctx, Action::Edit("width", Edit::SetAntenna(antenna)));
    window.step();
    assert_eq!(project(&window), before, "refused");
    window.get_by_label_contains("the patch lies within the ground");
}

#[test]
fn saving_and_opening_bring_back_the_same_project() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.json");
    let mut window = window();
    let ctx = window.ctx.clone();
    let app = window.state_mut();
    app.edit("hand edits", Edit::MoveVertices(vec![(3, [0.1, 0.2, 0.3])]));
    assert!(app.session.history().is_dirty(), "unsaved");
    app.carry_out(&ctx, Action::SavePath(path.clone(), None));
    assert!(!app.session.history().is_dirty(), "saved");
    let saved = app.session.project().clone();
    assert_eq!(file::read(&path).expect("readable"), saved, "the file holds the project");
    app.edit("hand edits", Edit::ClearHandEdits);
    app.carry_out(&ctx, Action::Run(Command::New));
    lay_out(&mut window);
    window.get_by_label("Unsaved changes");
    window.get_by_label("Discard changes").click();
    window.step();
    window.step();
    assert!(window.state().session.path.is_none(), "a new project has no file");
    window.state_mut().carry_out(&ctx, Action::OpenPath(path));
    assert_eq!(project(&window), saved, "opened again");
    window.state_mut().carry_out(&ctx, Action::OpenPath(folder.path().join("missing.json")));
    assert_eq!(project(&window), saved, "a file that cannot be read changes nothing");
    assert!(window.state().messages.texts().last().is_some_and(|m| m.contains("missing.json")), "and is named");
}

#[test]
fn closing_with_unsaved_changes_asks_first() {
    let mut window = window();
    window.state_mut().edit("hand edits", Edit::MoveVertices(vec![(3, [0.1, 0.2, 0.3])]));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    lay_out(&mut window);
    window.get_by_label("Unsaved changes");
    window.get_by_label("Cancel").click();
    window.step();
    window.step();
    assert!(window.query_by_label("Unsaved changes").is_none(), "back at work");
}

#[test]
fn everything_can_be_drawn_at_every_size_in_both_themes() {
    for theme in [Theme::Dark, Theme::Light] {
        for size in [(900.0, 560.0), (1280.0, 800.0), (1920.0, 1080.0)] {
            let mut window = Harness::builder().with_size(size).with_theme(theme).build_eframe(|cc| App::new(cc, None));
            settle(&mut window);
            let ctx = window.ctx.clone();
            for (_, _, preset) in preset_fields::choices() {
                window.state_mut().carry_out(&ctx, Action::AddPreset(preset));
            }
            window.state_mut().state.shows_log = true;
            for (tab, heat) in [(Tab::Antenna, Heat::Area), (Tab::Cage, Heat::MaxStrain)] {
                window.state_mut().state.tab = tab;
                window.state_mut().state.heat = heat;
                window.step();
            }
            for command in [Command::Keys, Command::Export, Command::SaveAs] {
                window.state_mut().carry_out(&ctx, Action::Run(command));
                window.step();
                window.step();
            }
        }
    }
}

#[test]
fn an_export_is_certified_and_verified() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window();
    window.state_mut().session.path = Some(folder.path().join("bent.json"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::E);
    lay_out(&mut window);
    window.get_by_label("Export geometry");
    window.get_all_by_label("Export").last().expect("the button of the dialog").click();
    wait_for(&mut window, "Exported, free of gaps and crossings");
    assert!(folder.path().join("bent-export/certificate.json").is_file(), "written beside the project");
    window.get_by_label("Verify").click();
    wait_for(&mut window, "Verified: every claim of the certificate holds");
}

pub(super) fn wait_for(window: &mut Window, label: &str) {
    let start = Instant::now();
    while window.query_by_label(label).is_none() {
        assert!(start.elapsed() < Duration::from_secs(300), "\"{label}\" does not appear");
        std::thread::sleep(Duration::from_millis(5));
        window.step();
    }
    lay_out(window);
}

/// Lets a dialog find its size and its place, which depend on each other.
pub(super) fn lay_out(window: &mut Window) {
    window.run_steps(4);
}

/// Skips, saying so, where there is no graphics adapter; fails there if `REQUIRE_GPU` is set.
#[allow(clippy::print_stderr, reason = "a skipped test says so")]
pub(super) fn has_adapter() -> bool {
    match crate::render::Gpu::headless() {
        Ok(_) => true,
        Err(error) => {
            assert!(std::env::var_os("REQUIRE_GPU").is_none(), "REQUIRE_GPU is set, but {error}");
            eprintln!("skipped: {error}");
            false
        }
    }
}

#[test]
fn the_picture_shows_metal_substrate_and_cage_in_both_themes() {
    if !has_adapter() {
        return;
    }
    for theme in [Theme::Dark, Theme::Light] {
        let builder = Harness::builder().with_size((1000.0, 640.0)).with_theme(theme).wgpu();
        let mut window = builder.build_eframe(|cc| App::new(cc, None));
        window.state_mut().state.theme = theme.into();
        settle(&mut window);
        let picture = window.render().expect("an adapter");
        let view = |x: u32, y: u32| (300..680).contains(&x) && (80..600).contains(&y);
        let count = |is: fn([u32; 4]) -> bool| {
            picture.enumerate_pixels().filter(|(x, y, p)| view(*x, *y) && is(p.0.map(u32::from))).count()
        };
        let copper = count(|[r, g, b, _]| r > 120 && r > g + 30 && g > b + 15);
        let blue = count(|[r, _, b, _]| b > r + 50);
        assert!(copper > 500, "{theme:?}: {copper} texels of metal");
        assert!(blue > 500, "{theme:?}: {blue} texels of cage");
    }
}
