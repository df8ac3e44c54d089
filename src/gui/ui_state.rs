//! What the user looks at and has selected: never part of a project, never undone, kept between runs.

use crate::render::{Camera, Projection, Vec3};
use egui::ThemePreference;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Which tab the left panel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Tab {
    /// Dimensions and materials.
    Antenna,
    /// Cage, presets, hand edits.
    #[default]
    Cage,
}

/// What is painted on the antenna.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Heat {
    /// Its materials.
    #[default]
    None,
    /// Area over flat area, minus 1.
    Area,
    /// Greater principal stretch, minus 1.
    MaxStrain,
    /// Smaller principal stretch, minus 1.
    MinStrain,
}

impl Heat {
    /// All of them, in the order of the choice.
    pub(super) const ALL: [Self; 4] = [Self::None, Self::Area, Self::MaxStrain, Self::MinStrain];

    /// Name in the choice and over the colour bar.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::None => "None (materials)",
            Self::Area => "Area change",
            Self::MaxStrain => "Greatest strain",
            Self::MinStrain => "Smallest strain",
        }
    }
}

/// The camera as it is kept between runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SavedCamera {
    target: [f32; 3],
    yaw: f32,
    pitch: f32,
    distance: f32,
    orthographic: bool,
}

/// State of the window.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default)]
#[allow(clippy::struct_excessive_bools, reason = "each is an independent switch of the window")]
pub(super) struct UiState {
    pub(super) tab: Tab,
    pub(super) theme: ThemePreference,
    pub(super) heat: Heat,
    /// Half range of the colour bar in percent, where the user fixed it.
    pub(super) heat_range: Option<f32>,
    pub(super) shows_cage: bool,
    pub(super) sees_through: bool,
    pub(super) shows_log: bool,
    /// Whether one number sets all three paddings.
    pub(super) equal_padding: bool,
    /// Wanted frequency and input resistance of the first guess.
    pub(super) guess_freq_ghz: f64,
    pub(super) guess_ohm: f64,
    /// Where the last file or folder was.
    pub(super) last_folder: Option<std::path::PathBuf>,
    camera_kept: Option<SavedCamera>,
    /// Selected cage vertices.
    #[serde(skip)]
    pub(super) selection: BTreeSet<u32>,
    /// Whether the next drag on empty ground draws a box.
    #[serde(skip)]
    pub(super) selects_by_box: bool,
    #[serde(skip)]
    pub(super) camera: Camera,
    /// Asks the viewport to show all in the next frame.
    #[serde(skip)]
    pub(super) fit: bool,
    /// The field whose last change was refused, and why.
    #[serde(skip)]
    pub(super) refused: Option<(&'static str, String)>,
}

impl Default for UiState {
    fn default() -> Self {
        Self {
            tab: Tab::default(),
            theme: ThemePreference::System,
            heat: Heat::None,
            heat_range: None,
            shows_cage: true,
            sees_through: false,
            shows_log: false,
            equal_padding: true,
            guess_freq_ghz: 11.0,
            guess_ohm: 50.0,
            last_folder: None,
            camera_kept: None,
            selection: BTreeSet::new(),
            selects_by_box: false,
            camera: Camera::default(),
            fit: true,
            refused: None,
        }
    }
}

impl UiState {
    /// Notes the camera for the next run.
    pub(super) fn keep_camera(&mut self) {
        let c = &self.camera;
        self.camera_kept = Some(SavedCamera {
            target: c.target.to_array(),
            yaw: c.yaw,
            pitch: c.pitch,
            distance: c.distance,
            orthographic: c.projection == Projection::Orthographic,
        });
    }

    /// Puts the camera where it was in the last run, if that is a possible place.
    pub(super) fn restore_camera(&mut self) {
        let Some(kept) = self.camera_kept else { return };
        let numbers = [kept.yaw, kept.pitch, kept.distance];
        if numbers.iter().chain(&kept.target).all(|v| v.is_finite()) && kept.distance > 0.0 {
            let camera = &mut self.camera;
            camera.target = Vec3::from_array(kept.target);
            (camera.yaw, camera.pitch, camera.distance) = (kept.yaw, kept.pitch, kept.distance);
            camera.projection = if kept.orthographic { Projection::Orthographic } else { Projection::Perspective };
            self.fit = false;
        }
    }
}
