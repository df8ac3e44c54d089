//! Places of what was refused: listed where it is told, marked in the view, and gone to by a press.

use super::ui_state::UiState;
use crate::geometry::DVec3;
use crate::pipeline::Shape;
use crate::pipeline::job::JobError;
use crate::project::Project;
use crate::render::Vec3;
use egui::{RichText, Ui};

/// Places listed: the others lie beside them.
const MAX_LISTED: usize = 6;
/// Distance of the eye from such a place, mm.
const NEAR: f32 = 12.0;

/// Why a mesh or a result was not made.
#[derive(Clone, Debug)]
pub(super) struct Refusal {
    /// The reason, for the user.
    pub(super) text: String,
    project: Project,
    places_mm: Vec<[f64; 3]>,
}

impl Refusal {
    /// What an error says of one of a project's shapes.
    pub(super) fn new(error: &JobError, project: Project, shape: Shape) -> Self {
        // The view shows the deformed antenna: places on another shape would lie beside it.
        let places_mm = if shape == Shape::Deformed { error.places_mm() } else { Vec::new() };
        Self { text: error.to_string(), project, places_mm }
    }

    /// Where, mm; nowhere once the project is another one.
    pub(super) fn places_mm(&self, project: &Project) -> &[[f64; 3]] {
        if self.project == *project { &self.places_mm } else { &[] }
    }
}

/// A button for each place, mm, that goes there.
pub(super) fn list(ui: &mut Ui, places_mm: &[[f64; 3]], state: &mut UiState) {
    ui.horizontal_wrapped(|ui| {
        for (k, place) in places_mm.iter().enumerate().take(MAX_LISTED) {
            let [x, y, z] = place;
            let button = ui.small_button(format!("{x:.1}, {y:.1}, {z:.1} mm"));
            if button.on_hover_text(format!("Look at place {}", k + 1)).clicked() {
                state.show_mesh(false);
                state.look_at(DVec3::from_array(*place).as_vec3(), NEAR);
            }
        }
        if places_mm.len() > MAX_LISTED {
            ui.label(RichText::new(format!("and {} more", places_mm.len() - MAX_LISTED)).weak());
        }
    });
}

impl UiState {
    /// Brings a place before the eye, which comes within a distance of it; both in mm.
    pub(super) fn look_at(&mut self, place: Vec3, distance: f32) {
        self.fit = false;
        self.camera.target = place;
        self.camera.distance = distance;
    }
}
