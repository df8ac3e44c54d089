//! Tests of the solver in the window: launched, called off, out of date, its results looked at and exported.
//!
//! One test solves; the others look at made-up results.

use super::app::App;
use super::command::Command;
use super::outbox::Action;
use super::solve_session::{FinishedRun, request};
use super::tests::{Window, has_adapter, lay_out, project, run, settle, until, window};
use super::tests_shell::unnamed;
use super::ui_state::{Curve, Polarization, ResultTab, RightTab, SolveUi};
use crate::pipeline::made_up::made_up;
use crate::pipeline::{Density, Shape};
use crate::project::Edit;
use crate::units::GHZ;
use egui::accesskit::Role;
use egui::{Key, Theme};
use egui_kittest::kittest::Queryable;
use std::time::Duration;

/// A window with made-up results of the flat and the bent antenna.
pub(super) fn solved() -> Window {
    let mut window = window();
    add(&mut window, Shape::Flat, 10.8 * GHZ);
    add(&mut window, Shape::Deformed, 11.1 * GHZ);
    window.state_mut().state.solve.shows_results = true;
    window.run_steps(3);
    window
}

pub(super) fn add(window: &mut Window, shape: Shape, freq: f64) {
    let chosen = SolveUi { shape, ..SolveUi::default() };
    let request = request(&project(window), &chosen);
    window.state_mut().solve.add(request.job(), made_up(freq));
}

#[test]
fn the_launcher_solves_shows_the_curve_as_it_comes_and_keeps_old_results_when_called_off() {
    let mut window = window();
    window.get_all_by_label("Solve").last().expect("the tab is named").click();
    lay_out(&mut window);
    assert_eq!(window.state().state.right_tab, RightTab::Solve, "the tab was chosen");
    window.get_by_label_contains("There are no results yet");
    window.get_by_label_contains(" cells, ");
    let chosen = &mut window.state_mut().state.solve;
    // A wide band has a short pulse.
    (chosen.shape, chosen.density, chosen.band_ghz) = (Shape::Flat, Density::Coarse, Some([8.0, 40.0]));
    chosen.longest_ns = 0.5;
    window.key_press(Key::F5);
    window.step();
    assert!(window.state().solve.is_busy() && window.state().state.solve.shows_results, "it began");
    assert!(!window.state().session.is_busy(), "the deforming thread has nothing to do with it");
    until(&mut window, "a live curve", |app| app.solve.live().is_some_and(|live| live.sweep.is_some()));
    window.get_by_label_contains("under way");
    window.get_by_label_contains(" left · step ");
    window.get_by_label("Cancel").click();
    window.run_steps(2);
    let solve = &window.state().solve;
    assert!(!solve.is_busy() && solve.live().is_none() && solve.error().is_none(), "idle");
    window.get_by_label("Resume").click();
    until(&mut window, "an end", |app| !app.solve.is_busy() && app.solve.interrupted().is_none());
    let (runs, project) = (window.state().solve.runs().to_vec(), project(&window));
    assert!(runs.len() == 1 && !runs[0].is_stale(&project), "a result of this project");
    let result = &runs[0].result;
    let curve = result.sweep.freqs.iter().map(|f| f / GHZ).zip(result.sweep.db());
    let lowest = curve.filter(|(f, _)| *f < 13.0).min_by(|a, b| a.1.total_cmp(&b.1));
    let (freq, db) = lowest.expect("the patch's own resonance, below the next one");
    assert!((10.0..11.8).contains(&freq) && db < -3.0, "{db} dB at {freq} GHz");
    let broadside = result.patterns.iter().map(|pattern| pattern.field.boresight());
    assert!(result.patterns.len() > 20 && broadside.fold(f64::NEG_INFINITY, f64::max) > 5.0, "patterns");
    assert!(window.state().messages.texts().any(|m| m.starts_with("Solved:")), "and it was said");
    // Again, called off before the field runs.
    run(&mut window, Command::Solve);
    window.get_by_label("Cancel").click();
    window.run_steps(2);
    assert!(!window.state().solve.is_busy() && window.query_by_label("Resume").is_none(), "nothing to go on with");
    assert_eq!(window.state().solve.runs()[0].serial, runs[0].serial, "the earlier result is still there");
    // A run that cannot be.
    window.state_mut().edit("hand edits", Edit::MoveVertices(vec![(3, [0.0, 0.0, 0.2])]));
    settle(&mut window);
    window.state_mut().state.solve.shape = Shape::Cylinder;
    run(&mut window, Command::Solve);
    until(&mut window, "a refusal", |app| app.solve.error().is_some());
    window.get_by_label_contains("No result: there is no exact cylinder");
    assert_eq!(window.state().solve.runs().len(), 1, "and the earlier result is still there");
}

#[test]
fn a_changed_project_marks_the_runs_that_depend_on_it() {
    let mut window = solved();
    assert!(window.query_by_label_contains("⚠").is_none(), "fresh");
    window.state_mut().edit("hand edits", Edit::MoveVertices(vec![(3, [0.0, 0.0, 0.2])]));
    settle(&mut window);
    window.run_steps(2);
    window.get_by_role_and_label(Role::CheckBox, "⚠ R 10 H, raw");
    window.get_by_role_and_label(Role::CheckBox, "Flat");
    run(&mut window, Command::Undo);
    settle(&mut window);
    window.run_steps(2);
    window.get_by_role_and_label(Role::CheckBox, "R 10 H, raw");
}

#[test]
fn the_legend_hides_colours_and_removes_runs() {
    let mut window = solved();
    let figures = |window: &Window| window.query_all_by_label("49.87 Ω").count();
    assert_eq!(figures(&window), 2, "a column for each run");
    window.get_by_role_and_label(Role::CheckBox, "Flat").click();
    window.run_steps(3);
    assert_eq!(window.state().solve.shown().count(), 1, "hidden");
    assert_eq!(figures(&window), 1, "its figures too");
    let other = window.state().solve.runs()[1].color;
    assert_ne!(window.state().solve.runs()[0].color, other, "told apart by colour");
    window.get_by_label("Colour of Flat").click();
    lay_out(&mut window);
    window.get_by_label("Colour 6").click();
    lay_out(&mut window);
    assert_eq!(window.state().solve.runs()[0].color, 5, "recoloured");
    window.get_by_label("Remove Flat").click();
    window.run_steps(3);
    let names: Vec<&str> = window.state().solve.runs().iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["R 10 H, raw"], "removed");
    run(&mut window, Command::New);
    assert!(window.state().solve.runs().is_empty(), "another project has none");
    window.get_by_label("No results yet.");
}

#[test]
fn the_same_request_replaces_its_result_and_another_gets_a_name_of_its_own() {
    let mut window = solved();
    add(&mut window, Shape::Flat, 10.9 * GHZ);
    assert_eq!(window.state().solve.runs().len(), 2, "the same again");
    window.state_mut().state.solve.band_ghz = Some([9.0, 12.0]);
    let other =
        request(&project(&window), &SolveUi { band_ghz: Some([9.0, 12.0]), shape: Shape::Flat, ..SolveUi::default() });
    window.state_mut().solve.add(other.job(), made_up(10.8 * GHZ));
    assert_eq!(window.state().solve.runs()[2].name, "Flat (2)", "over another band");
}

#[test]
fn figures_and_charts_are_there_by_name() {
    let mut window = solved();
    for name in ["10.8000 GHz", "−10 dB band", "Smith chart: 2 curves", "Plot of |S11| (dB) over frequency: 2 curves"]
    {
        assert!(window.query_all_by_label(name).next().is_some(), "{name}");
    }
    let result = &window.state().solve.runs()[0].result;
    let found = result.resonance.expect("a resonance");
    // |S11| = 0.1 / 1.1 at resonance, -10 dB where the detuning is a third.
    assert!((found.depth_db - 20.0 * (1.0_f64 / 11.0).log10()).abs() < 0.05, "{found:?}");
    window.get_by_label("Phase").click();
    window.run_steps(2);
    window.get_by_label("Plot of Phase of S11 (°) over frequency: 2 curves");
    window.get_by_label("Pattern").click();
    window.run_steps(3);
    window.get_by_label("Polar plot of the E plane (y z): 1 runs");
    window.state_mut().state.solve.pattern_freq = Some(10.8 * GHZ);
    window.run_steps(2);
    let app = window.state();
    let freq = super::polar::frequency(&app.solve, &app.state.solve).expect("a frequency");
    assert!((freq / (10.8 * GHZ) - 1.0).abs() < 1e-9, "as chosen: {freq}");
    assert!(window.query_all_by_label("97.1 %").next().is_some(), "the efficiency");
}

#[test]
fn pointing_at_a_chart_reads_it() {
    let mut window = solved();
    for (chart, reading) in [("Smith chart: 2 curves", " j"), ("Plot of |S11| (dB) over frequency: 2 curves", "VSWR")] {
        let place = window.get_by_label(chart).rect().center() + egui::vec2(10.0, 12.0);
        window.event(egui::Event::PointerMoved(place));
        lay_out(&mut window);
        std::thread::sleep(Duration::from_millis(600));
        lay_out(&mut window);
        assert!(window.query_all_by_label_contains(reading).next().is_some(), "{chart} is read");
    }
    window.state_mut().state.solve.tab = ResultTab::Pattern;
    window.run_steps(3);
    let place = window.get_by_label("Polar plot of the H plane (x z): 1 runs").rect().center();
    window.event(egui::Event::PointerMoved(place + egui::vec2(0.0, -20.0)));
    lay_out(&mut window);
    window.get_by_label("0° from broadside");
}

#[test]
fn the_pattern_is_drawn_around_the_antenna() {
    let mut window = solved();
    window.key_press(Key::L);
    window.run_steps(2);
    assert!(window.state().state.solve.shows_pattern, "switched on");
    let app = window.state();
    let mut scene = super::pattern_scene::PatternScene::default();
    let ends = [crate::render::Vec3::splat(-4.0), crate::render::Vec3::splat(6.0)];
    let surface = scene.surface(&app.solve, &app.state.solve, ends).expect("a pattern");
    let again = scene.surface(&app.solve, &app.state.solve, ends).expect("a pattern");
    assert_eq!(surface, again, "nothing is made twice");
    let center = crate::render::Vec3::ONE;
    let distance = |p: &crate::render::Vec3| p.distance(center);
    let furthest = surface.positions.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).expect("points");
    assert!((*furthest - center).normalize_or_zero().z > 0.99, "the lobe is at the front: {furthest}");
    let scalars = surface.scalars.as_ref().expect("values");
    assert_eq!(scalars.values.len(), surface.positions.len(), "a value for each point");
    let greatest = scalars.values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    assert!((greatest - scalars.range[1]).abs() < 0.05, "the scale ends at the greatest directivity");
    let n = surface.positions.len() as u32;
    assert!(surface.parts[0].triangles.iter().flatten().all(|&v| v < n), "valid triangles");
}

#[test]
fn results_are_kept_beside_the_project_and_shown_when_it_is_opened_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bent.json");
    let mut window = solved();
    let before = window.state().solve.runs().to_vec();
    let ctx = window.ctx.clone();
    let carry_out = |window: &mut Window, action| {
        window.state_mut().carry_out(&ctx, action);
        window.run_steps(2);
    };
    carry_out(&mut window, Action::SavePath(path.clone(), None));
    run(&mut window, Command::New);
    assert!(window.state().solve.runs().is_empty(), "another project");
    carry_out(&mut window, Action::OpenPath(path.clone()));
    for run in &before {
        let back = window.state().solve.runs().iter().find(|r| r.name == run.name).expect("there again");
        assert!(back.is_shown && back.result.sweep == run.result.sweep, "{}: its curve is shown", run.name);
        let fields = |run: &FinishedRun| run.result.patterns.iter().map(|p| p.field.clone()).collect::<Vec<_>>();
        assert!(back.result.figures == run.result.figures && fields(back) == fields(run), "{}: all of it", run.name);
    }
    // The file is changed by something else: only the flat antenna's result is of it.
    let mut changed = project(&window);
    changed.presets.clear();
    crate::project::file::write(&path, &changed).expect("writable");
    carry_out(&mut window, Action::OpenPath(path.clone()));
    window.get_by_role_and_label(Role::CheckBox, "⚠ R 10 H, raw");
    let shown: Vec<&str> = window.state().solve.shown().map(|run| run.name.as_str()).collect();
    assert_eq!(shown, ["Flat"], "what is out of date is not shown");
    let dir = crate::pipeline::results_dir(&path);
    std::fs::write(dir.join("0.json"), "{}").expect("writable");
    carry_out(&mut window, Action::OpenPath(path));
    assert!(window.state().messages.texts().any(|m| m.contains("0.json")), "what cannot be read is said");
    assert_eq!(window.state().solve.runs().len(), 2, "and does not matter to the others");
}

#[test]
fn each_result_is_written_to_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = solved();
    let heads = [
        ("Touchstone (.s1p)", "bent.s1p", "! Conformant, R 10 H, raw"),
        ("Reflection (.csv)", "bent.csv", "freq_ghz,s11_re"),
        ("Pattern cuts (.csv)", "bent.csv", "freq_ghz,psi_deg"),
    ];
    for (format, name, head) in heads {
        let path = folder.path().join(name);
        let _ = std::fs::remove_file(&path);
        window.state_mut().session.path = Some(folder.path().join("bent.json"));
        run(&mut window, Command::ExportResults);
        assert_eq!(unnamed(&window), Vec::<String>::new(), "every control of the dialog has a name");
        window.get_by_label(format).click();
        lay_out(&mut window);
        window.get_all_by_label("Export").last().expect("the button of the dialog").click();
        lay_out(&mut window);
        let text = std::fs::read_to_string(&path).expect("the file");
        assert!(text.starts_with(head), "{format}: {}", &text[..60]);
        assert!(text.lines().count() > 300, "{format}: whole");
        assert!(window.query_by_label("Format").is_none(), "the dialog is closed");
    }
}

#[test]
fn settings_are_kept_between_runs_of_the_program() {
    let mut window = window();
    let state = &mut window.state_mut().state;
    (state.solve.band_ghz, state.solve.density, state.solve.decay_db) = (Some([9.0, 12.5]), Density::Fine, 55.0);
    (state.mesh.shape, state.mesh.shows, state.mesh.axis) = (Shape::Flat, true, 2);
    let text = serde_json::to_string(state).expect("plain values");
    let back: super::ui_state::UiState = serde_json::from_str(&text).expect("readable");
    assert_eq!(back.solve, state.solve, "the launcher's");
    assert_eq!((back.mesh.shape, back.mesh.axis, back.mesh.shows), (Shape::Flat, 2, false), "the mesh view's");
}

#[test]
fn the_results_can_be_drawn_at_every_size_in_both_themes() {
    for theme in [Theme::Dark, Theme::Light] {
        for size in [(900.0, 560.0), (1280.0, 800.0), (1920.0, 1080.0)] {
            let builder = egui_kittest::Harness::builder().with_size(size).with_theme(theme);
            let mut window = builder.build_eframe(|cc| App::new(cc, None));
            settle(&mut window);
            window.state_mut().state.solve.shows_results = true;
            window.state_mut().state.right_tab = RightTab::Solve;
            window.run_steps(2);
            add(&mut window, Shape::Flat, 10.8 * GHZ);
            add(&mut window, Shape::Deformed, 11.1 * GHZ);
            window.state_mut().state.solve.shows_pattern = true;
            for (tab, curve, polarization) in [
                (ResultTab::Reflection, Curve::Magnitude, Polarization::Total),
                (ResultTab::Reflection, Curve::Phase, Polarization::Total),
                (ResultTab::Pattern, Curve::Phase, Polarization::Parts),
            ] {
                let chosen = &mut window.state_mut().state.solve;
                (chosen.tab, chosen.curve, chosen.polarization) = (tab, curve, polarization);
                window.run_steps(2);
            }
            run(&mut window, Command::ExportResults);
        }
    }
}

#[test]
fn the_pattern_is_seen_in_the_picture() {
    if !has_adapter() {
        return;
    }
    let builder = egui_kittest::Harness::builder().with_size((1280.0, 800.0)).with_theme(Theme::Dark).wgpu();
    let mut window = builder.build_eframe(|cc| App::new(cc, None));
    settle(&mut window);
    add(&mut window, Shape::Deformed, 11.1 * GHZ);
    // The yellow and green end of the scale, which nothing else in the view has.
    let greens = |window: &mut Window| {
        let picture = window.render().expect("an adapter");
        let view = |x: u32, y: u32| (320..800).contains(&x) && (80..700).contains(&y);
        let is_green = |[r, g, b, _]: [u8; 4]| g > 110 && g > b.saturating_add(30) && g >= r;
        picture.enumerate_pixels().filter(|(x, y, p)| view(*x, *y) && is_green(p.0)).count()
    };
    let before = greens(&mut window);
    window.key_press(Key::L);
    window.run_steps(3);
    let after = greens(&mut window);
    assert!(after > before + 2000, "{before} texels of green before, {after} with the pattern");
}

#[test]
fn every_plot_is_saved_in_every_form_from_its_menu() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = solved();
    window.state_mut().session.path = Some(folder.path().join("two.json"));
    window.get_by_label("Smith chart: 2 curves").click_secondary();
    window.run_steps(3);
    window.get_by_label("Save plot…").click();
    lay_out(&mut window);
    window.get_all_by_label("Save").last().expect("the button of the dialog").click();
    window.run_steps(3);
    let svg = std::fs::read_to_string(folder.path().join("two-smith.svg")).expect("written beside the project");
    assert!(svg.contains("Reflection, two") && svg.contains("Flat") && svg.contains("R 10 H, raw"), "both runs");
    window.state_mut().state.solve.tab = ResultTab::Pattern;
    run(&mut window, Command::SavePlot);
    assert_eq!(unnamed(&window), Vec::<String>::new(), "every control of the dialog has a name");
    window.get_by_label("CSV").click();
    window.run_steps(2);
    window.get_all_by_label("Save").last().expect("the button of the dialog").click();
    window.run_steps(3);
    let csv = std::fs::read_to_string(folder.path().join("two-pattern.csv")).expect("the plot on show");
    assert!(csv.starts_with("dial,curve,angle_deg,value_dBi") && csv.lines().count() > 700, "its numbers: {csv:.200}");
}
