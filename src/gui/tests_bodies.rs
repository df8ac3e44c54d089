//! Tests of the import of bodies: dialog, panel, undo.

use super::command::Command;
use super::dialogs::Dialog;
use super::outbox::Action;
use super::tests::{Window, button, lay_out, move_to, project, settle, window};
use super::ui_state::Tab;
use crate::antenna::bodies::tests::cuboid;
use crate::geometry::DVec3;
use crate::io::{ExportOptions, export};
use crate::pipeline::{Density, flat};
use crate::project::{
    BendPlane, BodiesSpec, BodyKind, BodySpec, Edit, LooseBody, PresetEntry, PresetSpec, Project, RuleSpec, WELD_MM,
};
use crate::render::{StandardView, Vec2, Vec3, View};
use crate::task::Task;
use egui::Modifiers;
use egui_kittest::kittest::Queryable;
use std::path::Path;
use std::time::{Duration, Instant};

/// A file with an open body: a single triangle.
const OPEN: &str = "solid lid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 5 0 0\nvertex 0 5 0\nendloop\n\
                    endfacet\nendsolid\n";

fn open_dialog(window: &mut Window) {
    window.state_mut().carry_out(&egui::Context::default(), Action::Run(Command::ImportBodies));
    window.run_steps(2);
    window.get_by_label("Import bodies");
}

fn add(window: &mut Window, path: &Path) {
    let Dialog::Bodies(dialog) = &mut window.state_mut().dialog else { panic!("the dialog is open") };
    dialog.field.text = path.display().to_string();
    window.run_steps(2);
    lay_out(window);
    window.get_by_label("Add file").click();
    lay_out(window);
}

/// Waits until the dialog says something.
fn wait_for(window: &mut Window, said: &str) {
    let started = Instant::now();
    while window.query_by_label_contains(said).is_none() {
        assert!(started.elapsed() < Duration::from_secs(60), "{said} is said");
        std::thread::sleep(Duration::from_millis(10));
        window.run_steps(1);
    }
    lay_out(window);
}

#[test]
fn bodies_are_imported_shown_and_taken_back_by_one_undo() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = flat(&Project::default()).expect("the template");
    export(&drawn, folder.path(), &ExportOptions::default()).expect("gap-free");
    let mut window = window();
    window.state_mut().state.tab = Tab::Antenna;
    settle(&mut window);
    let before = project(&window);
    open_dialog(&mut window);
    add(&mut window, &folder.path().join("antenna.glb"));
    wait_for(&mut window, "All closed");
    window.get_by_label_contains("5 bodies, 20.000 × 20.000 × 4.645 mm");
    window.get_by_label("Import").click();
    settle(&mut window);
    let after = project(&window);
    let spec = after.bodies.as_ref().expect("bodies");
    let names: Vec<&str> = spec.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["substrate", "patch", "ground", "pin", "coax"], "as exported");
    assert_eq!(spec.bodies[1].kind, BodyKind::Metal, "as the file says");
    assert!(after.presets.is_empty(), "flat at first");
    let shown = &window.state().session.shown().expect("computed").deformed;
    assert!(shown.figures.is_none() && shown.flat.region("coax").is_some(), "on show");
    window.get_by_label_contains("figures of the patch's template");
    window.get_by_label("Patch template");
    // Between ground and patch, beside the pin.
    window.state_mut().state.feed.ends_mm[0] = [3.0, 2.0, 0.0];
    lay_out(&mut window);
    window.get_by_label("Place feed").click();
    settle(&mut window);
    let fed = project(&window).bodies.expect("bodies").feed.expect("placed");
    assert!((fed.from_mm[2] + 1.575).abs() < 1e-3 && fed.to_mm[2].abs() < 1e-3, "across the substrate: {fed:?}");
    window.get_by_label("Feed: 50 Ω across the gap");
    window.state_mut().state.mesh.density = Density::Coarse;
    window.state_mut().carry_out(&egui::Context::default(), Action::Run(Command::Mesh));
    let started = Instant::now();
    while window.state().mesh.shown().is_none() {
        assert!(started.elapsed() < Duration::from_secs(120), "the mesh is not finished");
        std::thread::sleep(Duration::from_millis(10));
        window.run_steps(1);
    }
    let mesh = &window.state().mesh.shown().expect("a mesh").ready.meshed;
    assert_eq!((mesh.mesh.check(), mesh.posts.len()), (Ok(()), 1), "with the feed's line");
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Z);
    settle(&mut window);
    assert_eq!(project(&window), after, "the feed is one step, undone to the bit");
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Z);
    settle(&mut window);
    assert_eq!(project(&window), before, "one step back");
}

fn block(name: &str, lo: [f64; 3], hi: [f64; 3]) -> LooseBody {
    LooseBody {
        spec: BodySpec { name: name.to_owned(), kind: BodyKind::Metal },
        surface: cuboid(name, lo, hi, [4, 4, 1]).surface,
    }
}

/// Seen from above, so that all of it fits.
fn from_above(window: &mut Window) {
    window.state_mut().carry_out(&egui::Context::default(), Action::Run(Command::LookFrom(StandardView::Top)));
    window.state_mut().carry_out(&egui::Context::default(), Action::Run(Command::Fit));
    settle(window);
}

fn click(window: &mut Window, at: egui::Pos2) {
    move_to(window, at);
    button(window, at, true, Modifiers::NONE);
    button(window, at, false, Modifiers::NONE);
}

#[test]
fn clicks_near_the_edges_of_two_arms_place_the_feed_across_their_gap() {
    let mut window = window();
    window.state_mut().state.tab = Tab::Antenna;
    let arms = [block("left", [-8.0, -2.0, 0.0], [-1.0, 2.0, 0.5]), block("right", [1.0, -2.0, 0.0], [8.0, 2.0, 0.5])];
    let bodies = BodiesSpec::weld(&arms, WELD_MM, &Task::default()).expect("apart");
    window.state_mut().edit("bodies", Edit::SetBodies(Some(Box::new(bodies))));
    window.state_mut().state.feed.is_upright = false;
    from_above(&mut window);
    window.get_by_label("Pick in the view").click();
    lay_out(&mut window);
    for side in [-1.0, 1.0] {
        let rect = window.get_by_label("3-D view").rect();
        let size = Vec2::new(rect.width(), rect.height());
        let view = View { camera: window.state().state.camera, size, scale: 1.0 };
        let seen = view.project(Vec3::new(side, 0.3, 0.5)).expect("before the eye").at;
        click(&mut window, rect.min + egui::vec2(seen.x + 4.0 * side, seen.y));
    }
    settle(&mut window);
    let feed = project(&window).bodies.expect("bodies").feed.expect("placed");
    let typed = &window.state().state.feed;
    assert_eq!((typed.is_upright, typed.ends_mm), (false, [feed.from_mm, feed.to_mm]), "the fields say where");
    for (end, x) in [(feed.from_mm, -1.0), (feed.to_mm, 1.0)] {
        let far = DVec3::from_array(end).distance(DVec3::new(x, 0.3, 0.5));
        assert!(far < 0.05, "on the edge of the arm: {end:?}");
    }
}

#[test]
fn a_click_on_the_bent_antenna_places_the_feed_on_the_flat_one() {
    let mut window = window();
    window.state_mut().state.tab = Tab::Antenna;
    let plates =
        [block("low", [-8.0, -8.0, -2.0], [8.0, 8.0, -1.5]), block("high", [-8.0, -8.0, 0.0], [8.0, 8.0, 0.5])];
    let bodies = BodiesSpec::weld(&plates, WELD_MM, &Task::default()).expect("apart");
    let bend = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 20.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    window.state_mut().edit("bodies", Edit::SetBodies(Some(Box::new(bodies))));
    window.state_mut().edit("presets", Edit::SetPresets(vec![PresetEntry { enabled: true, preset: bend }]));
    from_above(&mut window);
    window.get_by_label("Pick in the view").click();
    lay_out(&mut window);
    let view = window.get_by_label("3-D view").rect();
    // Beside the middle, where no cage vertex is.
    let at = view.center() + egui::vec2(0.11, 0.07) * view.height();
    click(&mut window, at);
    settle(&mut window);
    assert_eq!(window.state().state.feed.picks, None, "done");
    let feed = project(&window).bodies.expect("bodies").feed.expect("placed");
    let ([x, y, z], top) = (feed.from_mm, feed.to_mm[2]);
    assert!((z + 1.5).abs() < 1e-6 && top.abs() < 1e-6, "across the gap: {feed:?}");
    assert!((0.5..6.0).contains(&x) && (-5.0..-0.3).contains(&y), "right of the middle and below it: {feed:?}");
    // Seen where it was clicked, although the antenna is bent.
    let mark = window.get_by_label("Feed: 50 Ω across the gap").rect().center();
    assert!(mark.distance(at) < 12.0, "{mark:?} for {at:?}");
}

#[test]
fn what_is_open_is_said_with_the_place_and_cannot_be_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lid.stl");
    std::fs::write(&path, OPEN).unwrap();
    let mut window = window();
    settle(&mut window);
    let (before, camera) = (project(&window), window.state().state.camera);
    open_dialog(&mut window);
    add(&mut window, &path);
    wait_for(&mut window, "\"lid\" is open at 3 edges, (2.500, 0.000, 0.000)");
    window.get_by_label("Import").click();
    window.run_steps(2);
    window.get_by_label("Import bodies");
    assert!(window.query_by_label("Feed point").is_none(), "the view shows the lid alone");
    window.get_by_label("2.5, 0.0, 0.0 mm").click();
    lay_out(&mut window);
    let target = window.state().state.camera.target;
    assert!(target.distance(Vec3::new(2.5, 0.0, 0.0)) < 1e-4, "looked at: {target}");
    window.get_by_label("Cancel").click();
    settle(&mut window);
    assert_eq!(project(&window), before, "nothing happened");
    assert_eq!(window.state().state.camera, camera, "the eye is where it was");
    window.get_by_label("Feed point");
}

#[test]
fn closing_the_dialog_stops_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lid.stl");
    std::fs::write(&path, OPEN).unwrap();
    let mut window = window();
    open_dialog(&mut window);
    let Dialog::Bodies(dialog) = &mut window.state_mut().dialog else { panic!("the dialog is open") };
    dialog.field.text = path.display().to_string();
    let task = |window: &Window| match &window.state().dialog {
        Dialog::Bodies(dialog) => dialog.task().cloned(),
        _ => None,
    };
    window.run_steps(2);
    window.get_by_label("Add file").click();
    // Asked after in the next frame at the soonest, so it is seen at work once however fast it is.
    let first = (0..10).find_map(|_| {
        window.step();
        task(&window)
    });
    let first = first.expect("it works");
    assert!(!first.is_cancelled(), "in earnest");
    window.state_mut().dialog = Dialog::None;
    assert!(first.is_cancelled(), "nobody waits for it any more");
}
