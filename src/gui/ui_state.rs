//! What the user looks at and has selected: never part of a project, never undone, kept between runs.

use super::bodies_feed::FeedUi;
use super::edit_ui::EditUi;
use super::layout::Layout;
use super::play::Play;
use crate::pipeline::{Density, Shape};
use crate::project::CompensationMode;
use crate::render::{Camera, Projection, Vec3};
use crate::tet::Metal;
use egui::ThemePreference;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files remembered as used last: more are no menu any more.
const MAX_RECENT_FILES: usize = 10;

/// A pane that is left of the view at first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Tab {
    /// Dimensions and materials.
    Antenna,
    /// Cage, presets, hand edits.
    #[default]
    Cage,
    /// Steps of the project's history.
    History,
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
    /// Thickness of the substrate over the one drawn, minus 1.
    Thickness,
    /// Distance from the exact cylinder.
    Distance,
}

impl Heat {
    /// All of them, in the order of the choice.
    pub(super) const ALL: [Self; 6] =
        [Self::None, Self::Area, Self::MaxStrain, Self::MinStrain, Self::Thickness, Self::Distance];

    /// Name in the choice and over the colour bar.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::None => "None (materials)",
            Self::Area => "Area change",
            Self::MaxStrain => "Greatest strain",
            Self::MinStrain => "Smallest strain",
            Self::Thickness => "Thickness change",
            Self::Distance => "Off cylinder",
        }
    }

    /// What it means.
    pub(super) fn tip(self) -> &'static str {
        match self {
            Self::None => "Show what the parts are made of",
            Self::Area => "Area over flat area, minus 1",
            Self::MaxStrain => "Greater principal stretch, minus 1",
            Self::MinStrain => "Smaller principal stretch, minus 1",
            Self::Thickness => "Thickness of the substrate over the one drawn, minus 1",
            Self::Distance => "Distance from the exact cylinder, shifted along z to lie nearest",
        }
    }

    /// Label of an axis of its values.
    pub(super) fn axis(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Area => "Area change (%)",
            Self::MaxStrain => "Greatest strain (%)",
            Self::MinStrain => "Smallest strain (%)",
            Self::Thickness => "Thickness change (%)",
            Self::Distance => "Distance from the cylinder (µm)",
        }
    }
}

/// Which parts are painted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum HeatPart {
    /// Substrate, patch and ground.
    #[default]
    All,
    Patch,
    Substrate,
    Ground,
}

impl HeatPart {
    /// All of them, in the order of the choice.
    pub(super) const ALL: [Self; 4] = [Self::All, Self::Patch, Self::Substrate, Self::Ground];

    /// Name in the choice.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::All => "All parts",
            Self::Patch => "Patch",
            Self::Substrate => "Substrate",
            Self::Ground => "Ground",
        }
    }
}

/// A pane that is right of the view at first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum RightTab {
    /// Distortion and compensation.
    #[default]
    Figures,
    /// The tetrahedral mesh.
    Mesh,
    /// The field solver.
    Solve,
}

/// What the colours of a mesh show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum MeshPaint {
    /// What the cells are made of.
    #[default]
    Region,
    /// Their smallest dihedral angle.
    Angle,
}

/// What is meshed, and how the mesh is looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[allow(clippy::struct_excessive_bools, reason = "each is an independent switch of the view")]
pub(super) struct MeshUi {
    pub(super) shape: Shape,
    pub(super) density: Density,
    pub(super) metal: Metal,
    /// Whether the view shows the mesh instead of the antenna.
    #[serde(skip)]
    pub(super) shows: bool,
    /// Axis across which the mesh is cut.
    pub(super) axis: usize,
    /// Place of the cut along its axis, mm.
    pub(super) place_mm: f64,
    /// Keeps what is below the place instead of what is above.
    pub(super) flipped: bool,
    /// Whether the antenna is cut too, and not only the air around it.
    pub(super) cuts_antenna: bool,
    pub(super) shows_air: bool,
    pub(super) paint: MeshPaint,
    /// Whether the worst cells are marked.
    pub(super) marks_worst: bool,
    /// The worst cell last chosen, by its place in the list.
    #[serde(skip)]
    pub(super) chosen: Option<usize>,
    /// The camera of the view that is not on show.
    #[serde(skip)]
    pub(super) other_camera: Option<Camera>,
}

impl Default for MeshUi {
    fn default() -> Self {
        Self {
            shape: Shape::default(),
            density: Density::default(),
            metal: Metal::default(),
            shows: false,
            axis: 1,
            place_mm: 0.0,
            flipped: false,
            cuts_antenna: false,
            shows_air: true,
            paint: MeshPaint::default(),
            marks_worst: true,
            chosen: None,
            other_camera: None,
        }
    }
}

impl MeshUi {
    /// Keeps the place of the cut within the mesh: least and greatest coordinate along each axis, mm.
    pub(super) fn keep_within(&mut self, bounds_mm: &[[f64; 2]; 3]) {
        let [lo, hi] = bounds_mm[self.axis];
        self.place_mm = self.place_mm.clamp(lo, hi);
    }
}

/// What the plot of the reflection shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Curve {
    /// |S11| in dB.
    #[default]
    Magnitude,
    /// Its phase.
    Phase,
}

/// When a run of the solver stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Stop {
    /// When the reflected voltage has fallen far enough.
    #[default]
    Decayed,
    /// When the resonance stays where it is.
    Settled,
}

/// Which results are shown below the view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum ResultTab {
    /// S11, Smith chart and their figures.
    #[default]
    Reflection,
    /// Far field.
    Pattern,
}

/// Which part of the far field the polar plots show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Polarization {
    /// Both together.
    #[default]
    Total,
    /// Along the flat patch's resonant length, and across it beside.
    Parts,
}

/// What is solved, and how the results are looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct SolveUi {
    pub(super) shape: Shape,
    pub(super) density: Density,
    /// Ends of the band where the user chose them; else it lies around the antenna's resonance.
    pub(super) band_ghz: Option<[f64; 2]>,
    pub(super) stop: Stop,
    /// How far the reflected voltage is to fall, dB (positive).
    pub(super) decay_db: f64,
    /// It stops after this time in the antenna at the latest.
    pub(super) longest_ns: f64,
    /// Whether the results are shown below the view.
    pub(super) shows_results: bool,
    pub(super) tab: ResultTab,
    pub(super) curve: Curve,
    pub(super) polarization: Polarization,
    /// Decibels from the rim of a pattern to its middle.
    pub(super) range_db: f64,
    /// Whether the pattern is drawn around the antenna.
    #[serde(skip)]
    pub(super) shows_pattern: bool,
    /// Frequency of the patterns, Hz; the resonance's where it is `None`.
    #[serde(skip)]
    pub(super) pattern_freq: Option<f64>,
}

impl Default for SolveUi {
    fn default() -> Self {
        Self {
            shape: Shape::default(),
            density: Density::default(),
            band_ghz: None,
            stop: Stop::default(),
            decay_db: 40.0,
            longest_ns: 4.0,
            shows_results: false,
            tab: ResultTab::default(),
            curve: Curve::default(),
            polarization: Polarization::default(),
            range_db: 30.0,
            shows_pattern: false,
            pattern_freq: None,
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
    /// Of the panes that are left and right of the view at first, the one to be in front.
    pub(super) tab: Tab,
    pub(super) right_tab: RightTab,
    /// Both as they were drawn last.
    #[serde(skip)]
    pub(super) tabs_seen: Option<(Tab, RightTab)>,
    pub(super) layout: Layout,
    pub(super) theme: ThemePreference,
    pub(super) heat: Heat,
    pub(super) heat_part: HeatPart,
    /// Ends of the colour bar in the unit of what is painted, where the user fixed them.
    pub(super) heat_ends: Option<[f32; 2]>,
    /// Whether the exact cylinder is drawn through the antenna.
    pub(super) shows_ghost: bool,
    /// The way of compensation that is looked at instead of the project's own.
    #[serde(skip)]
    pub(super) preview: Option<CompensationMode>,
    /// Size of the interface, as a factor.
    pub(super) scale: f32,
    pub(super) shows_left: bool,
    pub(super) shows_right: bool,
    pub(super) shows_cage: bool,
    pub(super) sees_through: bool,
    pub(super) shows_log: bool,
    /// Whether one number sets all three paddings.
    pub(super) equal_padding: bool,
    /// Wanted frequency and input resistance of the first guess.
    pub(super) guess_freq_ghz: f64,
    pub(super) guess_ohm: f64,
    /// The feed of bodies being typed.
    #[serde(skip)]
    pub(super) feed: FeedUi,
    /// Name being typed for the substrate's values.
    #[serde(skip)]
    pub(super) material_name: String,
    /// Where the last file or folder was.
    pub(super) last_folder: Option<PathBuf>,
    /// Files opened or saved last, newest first.
    pub(super) recent_files: Vec<PathBuf>,
    /// Whether the welcome was shown.
    pub(super) is_welcomed: bool,
    /// Names of the commands used last, newest first.
    pub(super) recent_commands: Vec<String>,
    camera_kept: Option<SavedCamera>,
    pub(super) mesh: MeshUi,
    pub(super) solve: SolveUi,
    pub(super) editing: EditUi,
    /// How much of the deformation is shown.
    #[serde(skip)]
    pub(super) play: Play,
    /// Whether a part of it can be shown.
    #[serde(skip)]
    pub(super) can_play: bool,
    /// Selected cage vertices.
    #[serde(skip)]
    pub(super) selection: BTreeSet<u32>,
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
            right_tab: RightTab::default(),
            tabs_seen: None,
            layout: Layout::default(),
            theme: ThemePreference::System,
            heat: Heat::None,
            heat_part: HeatPart::default(),
            heat_ends: None,
            shows_ghost: false,
            preview: None,
            scale: 1.0,
            shows_left: true,
            shows_right: true,
            shows_cage: true,
            sees_through: false,
            shows_log: false,
            equal_padding: true,
            guess_freq_ghz: 11.0,
            guess_ohm: 50.0,
            feed: FeedUi::default(),
            material_name: String::new(),
            last_folder: None,
            recent_files: Vec::new(),
            is_welcomed: false,
            recent_commands: Vec::new(),
            camera_kept: None,
            mesh: MeshUi::default(),
            solve: SolveUi::default(),
            editing: EditUi::default(),
            play: Play::default(),
            can_play: false,
            selection: BTreeSet::new(),
            camera: Camera::default(),
            fit: true,
            refused: None,
        }
    }
}

impl UiState {
    /// Paints a quantity; a fixed range holds as long as the unit does.
    pub(super) fn paint(&mut self, heat: Heat) {
        if heat.unit() != self.heat.unit() {
            self.heat_ends = None;
        }
        self.heat = heat;
    }

    /// Ends of the colour bar: the fixed ones where they are a range, else those that follow the values.
    pub(super) fn heat_range(&self, auto: [f32; 2]) -> [f32; 2] {
        self.heat_ends.filter(|[lo, hi]| lo < hi).unwrap_or(auto)
    }

    /// Notes that a file was opened or saved.
    pub(super) fn note_recent(&mut self, path: &Path) {
        // Where the program starts next time is not known.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent_files.retain(|other| *other != path);
        self.recent_files.insert(0, path);
        self.recent_files.truncate(MAX_RECENT_FILES);
    }

    /// Shows the mesh or the antenna; each keeps its own camera, and is fitted when it is shown first.
    pub(super) fn show_mesh(&mut self, shows: bool) {
        if std::mem::replace(&mut self.mesh.shows, shows) != shows {
            let here = self.camera;
            match self.mesh.other_camera.replace(here) {
                Some(other) => self.camera = other,
                None => self.fit = true,
            }
        }
    }

    /// Goes back to the antenna: there is no mesh any more.
    pub(super) fn forget_mesh(&mut self) {
        self.show_mesh(false);
        self.mesh.other_camera = None;
        self.mesh.chosen = None;
    }

    /// Notes the antenna's camera for the next run.
    pub(super) fn keep_camera(&mut self) {
        let c = if self.mesh.shows { self.mesh.other_camera.as_ref().unwrap_or(&self.camera) } else { &self.camera };
        self.camera_kept = Some(SavedCamera {
            target: c.target.to_array(),
            yaw: c.yaw,
            pitch: c.pitch,
            distance: c.distance,
            orthographic: c.projection == Projection::Orthographic,
        });
    }

    /// Puts the camera where it was in the last run, if that is a possible place, and corrects impossible numbers.
    pub(super) fn restore_camera(&mut self) {
        self.mesh.axis = self.mesh.axis.min(2);
        self.editing.restore();
        if !self.layout.is_sound() {
            self.layout = Layout::default();
        }
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
