//! The window: a cage editor over the pipeline.
//!
//! It owns what the user looks at (`ui_state`), the open project with its history (`session`) and one worker
//! thread, the mesh made of it by another (`mesh_session`) and the runs of the solver by a third (`solve_session`). Each
//! frame: replies are collected, panels and the 3-D view are drawn from plain values and put their wishes into an outbox
//! (`outbox`), the wishes are carried out (`app`), and the worker is sent the project if it changed.
//! Lengths here are millimetres, as in the project file; `scene` turns the domain into a picture.
//!
//! Unsaved work is kept for the case of a crash (`recovery`), and a file changed by another program is noticed (`disk`).
//!
//! Not handled: several projects in one window, and tools that change the cage's topology by hand.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "numbers on their way to the screen, and sliders of small counts"
)]

mod app;
mod bars;
mod bodies_dialog;
mod bodies_feed;
mod body_rows;
mod command;
mod command_input;
mod compare_session;
mod dialogs;
mod disk;
mod draft;
mod edit_commands;
mod edit_overlay;
mod edit_ui;
mod export_dialog;
mod field;
mod file_field;
mod files;
mod frame;
mod guard;
mod hand_edits;
mod heat;
mod keys;
mod layout;
mod mark_overlay;
mod mesh_export;
mod mesh_scene;
mod mesh_session;
mod notices;
mod operating;
mod outbox;
mod outline_dialog;
mod overlay;
mod paint;
mod palette;
mod panel_antenna;
mod panel_bodies;
mod panel_cage;
mod panel_compare;
mod panel_compensation;
mod panel_distortion;
mod panel_heat;
mod panel_history;
mod panel_materials;
mod panel_mesh;
mod panel_results;
mod panel_solve;
mod panel_stack;
mod panel_vertices;
mod panes;
mod pattern_scene;
mod picture;
mod places;
mod play;
mod plot_export;
mod plot_s11;
mod plots;
mod polar;
mod preset_fields;
mod readouts;
mod recovery;
mod report_export;
mod result_export;
mod scene;
mod selecting;
mod session;
mod smith;
mod solve_session;
mod status;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_bodies;
#[cfg(test)]
mod tests_edit;
#[cfg(test)]
mod tests_materials;
#[cfg(test)]
mod tests_mesh;
#[cfg(test)]
mod tests_pictures;
#[cfg(test)]
mod tests_random;
#[cfg(test)]
mod tests_safety;
#[cfg(test)]
mod tests_shell;
#[cfg(test)]
mod tests_solve;
#[cfg(test)]
mod tests_view;
mod theme;
mod trace;
mod ui_state;
mod view_export;
mod viewport;

pub use picture::picture;

use anyhow::Context as _;
use std::path::PathBuf;

/// Names the window and its folder of remembered choices to the desktop.
const APP_ID: &str = "conformant";
/// Width and height of the window at its first start, points.
const FIRST_SIZE: [f32; 2] = [1280.0, 800.0];
/// Smallest size at which the panels still leave room for the view, points.
const LEAST_SIZE: [f32; 2] = [900.0, 560.0];

/// Whether there is a display to open a window on.
#[must_use]
pub fn has_display() -> bool {
    let named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(not(target_os = "linux")) || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].into_iter().any(named)
}

/// Opens the window on a project file, or on the paper's antenna bent to R = 10 mm, and returns when it is closed.
///
/// # Errors
/// If there is no display, or neither it nor the graphics adapter can be used; the message says what to try.
pub fn run(path: Option<PathBuf>) -> anyhow::Result<()> {
    anyhow::ensure!(has_display(), "there is no display: set DISPLAY or WAYLAND_DISPLAY, or use the command line");
    let viewport = egui::ViewportBuilder::default()
        .with_title("Conformant")
        .with_app_id(APP_ID)
        .with_inner_size(FIRST_SIZE)
        .with_min_inner_size(LEAST_SIZE);
    let options = eframe::NativeOptions { viewport, centered: true, ..Default::default() };
    let start = move |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(app::App::new(cc, path.as_deref())))
    };
    match eframe::run_native(APP_ID, options, Box::new(start)) {
        Err(error @ eframe::Error::Wgpu(_)) => Err(error)
            .context("no graphics adapter can draw the window: install mesa-vulkan-drivers, or try WGPU_BACKEND=gl"),
        other => other.context("the window cannot be opened"),
    }
}
