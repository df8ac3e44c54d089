//! Pictures of the main views, light and dark, compared with those in `tests/snapshots`.
//!
//! They are those of Mesa's software renderer (lavapipe), which draws the same everywhere; without it these tests say
//! so and return, or fail where `REQUIRE_GPU` is set. `UPDATE_SNAPSHOTS=1` makes the pictures anew.

use super::app::App;
use super::command::Command;
use super::dialogs::Dialog;
use super::tests::{Window, has_adapter, run, settle, until};
use super::tests_solve::add;
use super::ui_state::Heat;
use crate::pipeline::Shape;
use crate::project::Example;
use crate::units::GHZ;
use egui::{Event, Theme, pos2};
use egui_kittest::{Harness, SnapshotOptions, image_snapshot_options};
use std::sync::{Arc, Mutex};

/// Size of the pictures, points: small, and yet as the window is used.
const SIZE: [u16; 2] = [960, 600];
/// How far a pixel's colour may be off, and how many pixels may be: what another build of the renderer changes, and less
/// than a letter or a line.
const THRESHOLD: f32 = 2.0;
const FAILED_PIXELS: usize = 12;
/// Frames until nothing moves any more.
const REST: usize = 40;

/// A window that can be drawn by the software renderer; `None`, saying why, where there is none.
#[allow(clippy::print_stderr, reason = "a skipped test says so")]
fn drawable(theme: Theme) -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let adapter = Arc::new(Mutex::new(None));
    let seen = Arc::clone(&adapter);
    let [width, height] = SIZE.map(f32::from);
    let builder = Harness::builder().with_size((width, height)).with_theme(theme).wgpu();
    let mut window = builder.build_eframe(move |cc| {
        *seen.lock().expect("no panic") = cc.wgpu_render_state.as_ref().map(|state| state.adapter.get_info());
        App::new(cc, None)
    });
    let info = adapter.lock().expect("no panic").clone().expect("an adapter");
    if info.device_type != wgpu::DeviceType::Cpu {
        let why = format!("the pictures are those of lavapipe (mesa-vulkan-drivers), and this is {}", info.name);
        assert!(std::env::var_os("REQUIRE_GPU").is_none(), "REQUIRE_GPU is set, but {why}");
        eprintln!("skipped: {why}");
        return None;
    }
    window.state_mut().state.theme = theme.into();
    settle(&mut window);
    Some(window)
}

/// Compares the window at rest with a picture; the status line, which tells times, is left out.
fn compare(window: &mut Window, name: &str, theme: Theme) {
    // Where the pointer lights nothing up.
    window.event(Event::PointerMoved(pos2(2.0, f32::from(SIZE[1]) - 2.0)));
    window.run_steps(REST);
    let status = *window.state().areas.last().expect("the status line");
    let mut picture = window.render().expect("an adapter");
    for (_, y, pixel) in picture.enumerate_pixels_mut() {
        if y as f32 >= status.top() {
            pixel.0 = [0, 0, 0, 255];
        }
    }
    let options = SnapshotOptions::new().threshold(THRESHOLD).max_failed_pixels(FAILED_PIXELS);
    let theme = if theme == Theme::Dark { "dark" } else { "light" };
    image_snapshot_options(&picture, format!("{name}_{theme}"), &options);
}

#[test]
fn picture_of_the_welcome() {
    let Some(mut window) = drawable(Theme::Dark) else { return };
    window.state_mut().dialog = Dialog::Welcome;
    compare(&mut window, "welcome", Theme::Dark);
}

#[test]
fn picture_of_the_flat_antenna_with_a_selection() {
    let Some(mut window) = drawable(Theme::Light) else { return };
    run(&mut window, Command::Example(Example::Flat));
    settle(&mut window);
    window.state_mut().state.selection = [10, 12, 40, 42].into();
    compare(&mut window, "flat", Theme::Light);
}

#[test]
fn picture_of_the_bent_antenna_painted_with_its_distortion() {
    for theme in [Theme::Dark, Theme::Light] {
        let Some(mut window) = drawable(theme) else { return };
        window.state_mut().state.heat = Heat::Area;
        compare(&mut window, "heat", theme);
    }
}

#[test]
fn picture_of_the_results() {
    let Some(mut window) = drawable(Theme::Light) else { return };
    add(&mut window, Shape::Flat, 10.8 * GHZ);
    add(&mut window, Shape::Deformed, 11.1 * GHZ);
    window.state_mut().state.solve.shows_results = true;
    compare(&mut window, "results", Theme::Light);
}

#[test]
fn picture_of_a_compensated_antenna() {
    let Some(mut window) = drawable(Theme::Dark) else { return };
    run(&mut window, Command::Compensate);
    until(&mut window, "a compensated antenna", |app| app.session.finished().is_some_and(|d| d.compensation.len() > 1));
    settle(&mut window);
    compare(&mut window, "compensation", Theme::Dark);
}
