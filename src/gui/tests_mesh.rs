//! Tests of the mesh in the window: made from the panel, called off, out of date, looked at, exported.

use super::command::Command;
use super::mesh_scene::{Look, MeshScene};
use super::scene::rgba;
use super::tests::{Window, lay_out, project, run, settle, wait_for, window};
use super::tests_shell::unnamed;
use super::theme::Tokens;
use super::ui_state::{MeshPaint, RightTab};
use crate::pipeline::{Density, Shape};
use crate::project::Edit;
use crate::render::{Paint, Vec3};
use crate::tet::BIN_WIDTH;
use egui::{Key, Theme};
use egui_kittest::kittest::Queryable;
use std::time::{Duration, Instant};

/// Steps until the meshing thread is idle.
fn wait(window: &mut Window) {
    let start = Instant::now();
    window.step();
    while window.state().mesh.is_busy() {
        assert!(start.elapsed() < Duration::from_secs(300), "the mesh is not finished");
        std::thread::sleep(Duration::from_millis(5));
        window.step();
    }
    // The answer is taken in one frame and drawn in the next.
    window.run_steps(2);
}

/// A window on a coarse mesh of the first project, made with the key.
fn meshed() -> Window {
    let mut window = window();
    window.state_mut().state.mesh.density = Density::Coarse;
    window.key_press(Key::M);
    wait(&mut window);
    window
}

#[test]
fn the_panel_meshes_and_shows_what_came_of_it() {
    let mut window = window();
    window.get_all_by_label("Mesh").last().expect("the tab is named").click();
    lay_out(&mut window);
    assert_eq!(window.state().state.right_tab, RightTab::Mesh, "the tab was chosen");
    window.get_by_label_contains("There is no mesh yet");
    window.state_mut().state.mesh.density = Density::Coarse;
    window.get_all_by_label("Mesh").last().expect("the button of the panel").click();
    window.step();
    assert!(window.state().mesh.is_busy(), "it began");
    assert!(!window.state().session.is_busy(), "the deforming thread has nothing to do with it");
    wait(&mut window);
    let shown = window.state().mesh.shown().expect("a mesh").clone();
    assert!(window.state().state.mesh.shows, "the view shows it");
    assert_eq!(shown.ready.meshed.mesh.check(), Ok(()), "a valid one");
    assert_eq!(shown.request.project, project(&window), "it belongs to this project");
    assert!(!shown.is_stale(&project(&window)), "and fits it");
    window.get_by_label(&super::mesh_session::grouped(shown.ready.meshed.mesh.tets.len()));
    assert!(window.state().messages.texts().any(|m| m.starts_with("Meshed:")), "and it was said");
    assert!(window.query_by_label("Cage vertex 0").is_none(), "no cage in the view of the mesh");
    assert_eq!(unnamed(&window), Vec::<String>::new(), "every control of mesh and histogram has a name");
    window.key_press(Key::V);
    window.run_steps(2);
    assert!(window.query_by_label("Cage vertex 0").is_some(), "the antenna in its cage is back");
}

#[test]
fn a_cancelled_mesh_leaves_nothing_behind() {
    let mut window = window();
    window.state_mut().state.mesh.density = Density::Fine;
    run(&mut window, Command::Mesh);
    wait_for(&mut window, "Cancel");
    window.get_by_label("Cancel").click();
    window.run_steps(2);
    let app = window.state();
    assert!(!app.mesh.is_busy() && app.mesh.shown().is_none() && app.mesh.error().is_none(), "as before");
    assert!(!app.state.mesh.shows, "the antenna stays in view");
    window.get_by_label_contains("There is no mesh yet");
    window.state_mut().state.mesh.density = Density::Coarse;
    run(&mut window, Command::Mesh);
    wait(&mut window);
    let density = window.state().mesh.shown().map(|s| s.request.settings.density);
    assert_eq!(density, Some(Density::Coarse), "the next one is made as asked, and the cancelled one never comes");
}

#[test]
fn a_changed_project_marks_the_mesh_as_out_of_date() {
    let mut window = meshed();
    assert!(window.query_by_label_contains("out of date").is_none(), "fresh");
    window.state_mut().edit("hand edits", Edit::MoveVertices(vec![(3, [0.0, 0.0, 0.2])]));
    settle(&mut window);
    window.get_by_label_contains("out of date");
    assert!(window.state().mesh.shown().is_some() && window.state().state.mesh.shows, "the picture stays");
    run(&mut window, Command::Undo);
    settle(&mut window);
    assert!(window.query_by_label_contains("out of date").is_none(), "taken back: it fits again");
    run(&mut window, Command::Redo);
    settle(&mut window);
    window.get_by_label("Mesh again").click();
    wait(&mut window);
    assert!(window.query_by_label_contains("out of date").is_none(), "meshed again");
    assert_eq!(window.state().mesh.shown().expect("a mesh").request.project, project(&window), "as it is now");
}

#[test]
fn what_cannot_be_meshed_is_explained_and_the_old_mesh_stays() {
    let mut window = meshed();
    let before = window.state().mesh.shown().expect("a mesh").serial;
    window.state_mut().edit("hand edits", Edit::MoveVertices(vec![(3, [0.0, 0.0, 0.2])]));
    window.state_mut().state.mesh.shape = Shape::Cylinder;
    run(&mut window, Command::Mesh);
    wait(&mut window);
    window.get_by_label_contains("No mesh was made: there is no exact cylinder");
    assert_eq!(window.state().mesh.shown().map(|s| s.serial), Some(before), "the old one is still there");
    run(&mut window, Command::New);
    window.get_by_label("Discard changes").click();
    window.run_steps(2);
    assert!(window.state().mesh.shown().is_none() && !window.state().state.mesh.shows, "another project has none");
}

#[test]
fn a_worst_cell_is_brought_before_the_eye() {
    let mut window = meshed();
    // The list is below the part of the panel that is in view.
    window.get_by_label("Worst cell 2").click_accesskit();
    window.run_steps(2);
    let (app, shown) = (window.state(), window.state().mesh.shown().expect("a mesh"));
    let cell = &shown.ready.meshed.quality.worst[1];
    let target = app.state.camera.target;
    assert!(target.distance((cell.at * 1e3).as_vec3()) < 1e-4, "the camera looks at it");
    let mut scene = MeshScene::default();
    let tokens = Tokens::of(Theme::Dark);
    let picture = scene.scene(shown, &app.state.mesh, tokens);
    let signal = Paint::Matt(rgba(Look::Worst.color(tokens)));
    let marked = picture.surfaces[0].parts.iter().find(|part| part.paint == signal).expect("it is seen on the cut");
    let corners = shown.ready.meshed.mesh.tets[cell.tet].vertices.map(|v| v.raw());
    assert!(marked.triangles.iter().any(|t| t.iter().all(|v| corners.contains(v))), "a face of it");
    let longest = cell.quality.edge_max * 1e3;
    let height = 2.0 * f64::from(app.state.camera.distance) * f64::from(app.state.camera.fov / 2.0).tan();
    assert!((4.0..20.0).contains(&(height / longest)), "the view is {:.1} cells high", height / longest);
}

#[test]
fn the_picture_of_a_mesh_follows_the_cut_and_is_kept_otherwise() {
    let window = meshed();
    let shown = window.state().mesh.shown().expect("a mesh");
    let tokens = Tokens::of(Theme::Light);
    let mut ui = window.state().state.mesh.clone();
    let mut scene = MeshScene::default();
    let first = scene.scene(shown, &ui, tokens);
    assert_eq!(first, scene.scene(shown, &ui, tokens), "nothing is made twice");
    let faces = |s: &crate::render::Scene| -> usize {
        s.surfaces.iter().flat_map(|s| &s.parts).map(|part| part.triangles.len()).sum()
    };
    assert_eq!(2 * first.lines[0].edges.len(), 3 * faces(&first), "a closed surface");
    ui.place_mm = 1.0;
    let moved = scene.scene(shown, &ui, tokens);
    assert_eq!(moved.surfaces[0].positions, first.surfaces[0].positions, "the corners are uploaded once");
    assert_ne!(moved.surfaces[0].parts, first.surfaces[0].parts, "other faces");
    ui.paint = MeshPaint::Angle;
    let painted = scene.scene(shown, &ui, tokens);
    assert_eq!(faces(&painted), faces(&moved), "the same faces");
    let field = painted.surfaces[1].scalars.as_ref().expect("angles");
    assert_eq!(field.values.len(), painted.surfaces[1].positions.len(), "a value for each corner");
    let least = shown.ready.meshed.quality.whole.dihedral_min.to_degrees();
    assert!(field.values.iter().all(|&v| f64::from(v) > least - 1e-3 && v < 71.0), "degrees");
    ui.shows_air = false;
    let (lo, hi) = scene.bounds(shown, &ui);
    let ball = Vec3::from_array(shown.bounds_mm.map(|[lo, hi]| (hi - lo) as f32));
    assert!((hi - lo).max_element() < 0.6 * ball.max_element(), "without the air the antenna is fitted");
    let bins = shown.ready.meshed.quality.whole.histogram.len() as f64 * BIN_WIDTH.to_degrees();
    assert!((bins - 75.0).abs() < 1e-9, "the histogram goes to 75 degrees");
}

#[test]
fn each_format_is_written_whole_with_its_head() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = meshed();
    let heads = [
        ("Gmsh MSH 4.1", "bent.msh", "$MeshFormat\n4.1 0 8\n"),
        ("Gmsh MSH 2.2", "bent.msh", "$MeshFormat\n2.2 0 8\n"),
        ("VTK (VTU)", "bent.vtu", "<?xml version=\"1.0\""),
        ("NASTRAN", "bent.nas", "$ Conformant mesh, unit mm\n"),
    ];
    for (format, name, head) in heads {
        let path = folder.path().join(name);
        let _ = std::fs::remove_file(&path);
        window.state_mut().session.path = Some(folder.path().join("bent.json"));
        run(&mut window, Command::ExportMesh);
        window.get_by_label("Format");
        assert_eq!(unnamed(&window), Vec::<String>::new(), "every control of the dialog has a name");
        window.get_by_label(format).click();
        lay_out(&mut window);
        window.get_all_by_label("Export").last().expect("the button of the dialog").click();
        let start = Instant::now();
        let said = format!("Exported the mesh: {}", path.display());
        let count = |w: &Window| w.state().messages.texts().filter(|m| *m == said).count();
        let before = count(&window);
        while count(&window) == before {
            assert!(start.elapsed() < Duration::from_secs(120), "{format} is not written");
            std::thread::sleep(Duration::from_millis(5));
            window.step();
        }
        let bytes = std::fs::read(&path).expect("the file");
        assert!(bytes.starts_with(head.as_bytes()), "{format}: {:?}", String::from_utf8_lossy(&bytes[..40]));
        let left = std::fs::read_dir(folder.path()).expect("the folder").count();
        assert!(left <= 3, "{format}: no temporary file is left");
        window.step();
        assert!(window.query_by_label("Format").is_none(), "the dialog is closed");
    }
}

#[test]
fn the_mesh_can_be_drawn_at_every_size_in_both_themes() {
    for theme in [Theme::Dark, Theme::Light] {
        for size in [(900.0, 560.0), (1280.0, 800.0), (1920.0, 1080.0)] {
            let builder = egui_kittest::Harness::builder().with_size(size).with_theme(theme);
            let mut window = builder.build_eframe(|cc| super::app::App::new(cc, None));
            settle(&mut window);
            window.state_mut().state.mesh.density = Density::Coarse;
            run(&mut window, Command::Mesh);
            wait(&mut window);
            for paint in [MeshPaint::Region, MeshPaint::Angle] {
                window.state_mut().state.mesh.paint = paint;
                window.run_steps(2);
            }
            run(&mut window, Command::ExportMesh);
        }
    }
}
