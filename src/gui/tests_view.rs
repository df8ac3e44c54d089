//! Tests of what is looked at and got out: painted distortion, comparison, crossings, pictures, the report.

use super::app::App;
use super::command::Command;
use super::heat::OnShow;
use super::places::Refusal;
use super::tests::{Window, has_adapter, lay_out, project, run, settle, until, window};
use super::ui_state::{Heat, HeatPart};
use crate::geometry::DVec3;
use crate::pipeline::job::JobError;
use crate::pipeline::worker::Reply;
use crate::pipeline::{PipelineError, Shape};
use crate::project::{CompensationMode, ResistorSpec};
use crate::render::StandardView;
use crate::tet::{EncloseError, TetError};
use egui::{Event, Shape as Shape2d, vec2};
use egui_kittest::kittest::Queryable;

#[test]
fn every_quantity_is_painted_with_its_histogram_and_a_fixed_range_holds() {
    let mut window = window();
    for heat in Heat::ALL.into_iter().filter(|h| *h != Heat::None) {
        let state = &mut window.state_mut().state;
        (state.heat, state.heat_part, state.shows_ghost) = (heat, HeatPart::Patch, true);
        lay_out(&mut window);
        let name = format!("Histogram of {}", heat.text().to_lowercase());
        assert!(window.query_by_label(&name).is_some(), "{name}");
    }
    window.get_by_label("Fixed range").click();
    lay_out(&mut window);
    let ends = window.state().state.heat_ends.expect("fixed");
    assert!(ends[0].abs() < 1e-6 && ends[1] > 100.0, "the uncompensated antenna is off by more than 100 µm: {ends:?}");
    window.state_mut().state.heat_ends = Some([5.0, 2.0]);
    lay_out(&mut window);
    window.get_by_label_contains("is not below the upper");
    run(&mut window, Command::SavePlot);
    window.get_by_label("Save plot");
    window.get_by_label("Cancel").click();
    lay_out(&mut window);
    window.state_mut().state.heat = Heat::Area;
    lay_out(&mut window);
}

#[test]
fn before_and_after_are_compared_and_looked_at_without_changing_the_project() {
    let mut window = window();
    let before = project(&window);
    run(&mut window, Command::Compare);
    until(&mut window, "a comparison", |app| app.compare.compared().is_some());
    let strain = |mode| match window.state().compare.on_show(mode) {
        Some(OnShow { deformed, .. }) => deformed.figures.as_ref().map_or(f64::NAN, |f| f.patch_strain),
        None => f64::NAN,
    };
    let [raw, wl, isometric] = crate::pipeline::compare_job::MODES.map(strain);
    assert!(raw > 5.0 * wl && wl > 2.0 * isometric, "each does better: {raw}, {wl}, {isometric}");
    window.get_all_by_label("Isometric").next().expect("the switch of the view").click();
    lay_out(&mut window);
    assert_eq!(window.state().state.preview, Some(CompensationMode::Isometric), "looked at");
    assert!(window.query_by_label("Cage vertex 3").is_none(), "nothing can be taken hold of");
    assert_eq!(project(&window), before, "the project stays");
    assert!(!window.state().session.history().can_undo(), "no step");
    window.state_mut().edit("hand edits", crate::project::Edit::MoveVertices(vec![(3, [0.1, 0.0, 0.0])]));
    settle(&mut window);
    assert_eq!(window.state().state.preview, None, "a change ends the look");
    window.get_by_label_contains("The project has changed since");
}

#[test]
fn crossings_of_a_refused_shape_are_listed_and_gone_to() {
    let mut window = window();
    window.state_mut().edit("hand edits", crate::project::Edit::MoveVertices(vec![(3, [0.01, 0.0, 0.0])]));
    let places_mm = vec![[1.0, 2.0, -3.0], [1.5, 2.0, -3.0]];
    let error = PipelineError::Crossing { count: 2, what: "coax with ground".to_owned(), places_mm };
    window.state_mut().session.sync();
    let generation = window.state().session.generation().expect("a request was sent");
    window.state_mut().session.receive(Reply { generation, result: Err(error), retreat: None });
    lay_out(&mut window);
    window.get_by_label("1.5, 2.0, -3.0 mm").click();
    lay_out(&mut window);
    let target = window.state().state.camera.target;
    assert!(target.distance(crate::render::Vec3::new(1.5, 2.0, -3.0)) < 1e-6, "looked at: {target}");
}

#[test]
fn a_folded_shape_tells_where_and_the_mesh_too() {
    let folded = PipelineError::Folded { x_mm: 1.0, y_mm: 2.0, at_mm: [1.5, 2.0, -3.0] };
    assert_eq!(folded.places_mm(), [[1.5, 2.0, -3.0]], "where it was carried to");
    let missing = TetError::NotRecovered { n_missing: 1, places: vec![DVec3::new(1e-3, 2e-3, 0.0)] };
    let error = JobError::from(PipelineError::from(EncloseError::from(missing)));
    let drawn = project(&window());
    let refusal = Refusal::new(&error, drawn.clone(), Shape::Deformed);
    assert_eq!(refusal.places_mm(&drawn), [[1.0, 2.0, 0.0]], "as long as the project is the same");
    let mut other = drawn.clone();
    other.antenna.width_mm += 1.0;
    assert!(refusal.places_mm(&other).is_empty(), "and no longer");
    assert!(Refusal::new(&error, drawn.clone(), Shape::Flat).places_mm(&drawn).is_empty(), "not on another shape");
}

/// Whether a text is painted on its own somewhere in the window.
fn is_painted(window: &Window, text: &str) -> bool {
    fn holds(shape: &Shape2d, text: &str) -> bool {
        match shape {
            Shape2d::Text(written) => written.galley.text() == text,
            Shape2d::Vec(shapes) => shapes.iter().any(|shape| holds(shape, text)),
            _ => false,
        }
    }
    window.output().shapes.iter().any(|clipped| holds(&clipped.shape, text))
}

#[test]
fn feed_and_resistors_tell_their_values_under_the_pointer() {
    let mut window = window();
    let mut antenna = project(&window).antenna;
    antenna.resistors.push(ResistorSpec { x_mm: -3.0, y_mm: 2.5, ohm: 75.0 });
    window.state_mut().edit("resistors", crate::project::Edit::SetAntenna(antenna));
    // Where no vertex of the cage is nearer.
    window.state_mut().state.shows_cage = false;
    run(&mut window, Command::LookFrom(StandardView::Top));
    settle(&mut window);
    for name in ["Feed point", "Resistor 1: 75 Ω"] {
        assert!(!is_painted(&window, name), "not without the pointer: {name}");
        let at = window.get_by_label(name).rect().center();
        window.event(Event::PointerMoved(at));
        lay_out(&mut window);
        assert!(is_painted(&window, name), "under the pointer: {name}");
        window.event(Event::PointerMoved(at + vec2(40.0, 0.0)));
        lay_out(&mut window);
        assert!(!is_painted(&window, name), "beside it no more: {name}");
    }
}

#[test]
fn the_report_is_saved_from_its_dialog() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window();
    window.state_mut().session.path = Some(folder.path().join("wrist.json"));
    run(&mut window, Command::Report);
    window.get_by_label_contains("no mesh: none was made");
    window.get_all_by_label("Save").last().expect("the button of the dialog").click();
    let path = folder.path().join("wrist-report.html");
    let file = path.clone();
    until(&mut window, "a report", move |_| file.exists());
    until(&mut window, "an end", |app| matches!(app.dialog, super::dialogs::Dialog::None));
    let html = std::fs::read_to_string(path).expect("written beside the project");
    assert!(html.contains("<h1>wrist</h1>") && html.contains("Crossing triangles"), "a whole report");
    assert_eq!(html.contains("data:image/png"), has_adapter(), "with a picture where one can be drawn");
}

#[test]
fn an_idle_window_draws_nothing_turning_uploads_nothing_and_a_drag_positions_alone() {
    if !has_adapter() {
        return;
    }
    let render = std::sync::Arc::new(std::sync::Mutex::new(None));
    let kept = std::sync::Arc::clone(&render);
    let builder = egui_kittest::Harness::builder().with_size((1280.0, 800.0)).with_theme(egui::Theme::Dark).wgpu();
    let mut window = builder.build_eframe(move |cc| {
        *kept.lock().expect("no panic") = cc.wgpu_render_state.clone();
        App::new(cc, None)
    });
    settle(&mut window);
    let draw = |window: &mut Window| {
        window.step();
        window.render().expect("an adapter");
        let state = render.lock().expect("no panic");
        let renderer = state.as_ref().expect("an adapter").renderer.read();
        renderer.callback_resources.get::<crate::render::Renderer>().expect("installed").counts()
    };
    let away = egui::pos2(640.0, 790.0);
    window.event(Event::PointerMoved(away));
    draw(&mut window);
    let idle = draw(&mut window);
    assert_eq!(draw(&mut window), idle, "idle");
    window.state_mut().state.camera.orbit(crate::render::Vec2::new(7.0, 3.0));
    let turned = draw(&mut window);
    assert_eq!(turned, crate::render::Counts { pictures: idle.pictures + 1, ..idle }, "turned");
    window.state_mut().session.begin();
    let moved = crate::project::Edit::MoveVertices(vec![(3, [0.0, 0.0, 0.2])]);
    window.state_mut().edit("hand edits", moved);
    until(&mut window, "a preview", |app| app.session.shown().is_some_and(|s| !s.deformed.is_final));
    let dragged = draw(&mut window);
    assert_eq!((dragged.triangles, dragged.values), (turned.triangles, turned.values), "neither triangles nor fields");
    assert!(dragged.positions > turned.positions && dragged.lines > turned.lines, "the antenna and its outlines moved");
    assert_eq!(draw(&mut window), dragged, "and rests again");
}
