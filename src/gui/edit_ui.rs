//! How cage vertices are selected and moved: switches and steps that are kept between runs.

use crate::cage::Mirror;
use crate::render::operator::Steps;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Ends of the radius of proportional editing, mm.
pub(super) const RADII_MM: RangeInclusive<f64> = 0.1..=1000.0;
/// Ends of the step that lengths are snapped to, mm, and of that of angles, degrees.
pub(super) const STEPS_MM: RangeInclusive<f64> = 0.001..=100.0;
pub(super) const STEPS_DEG: RangeInclusive<f64> = 0.1..=90.0;

/// What a drag on empty ground draws around vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outline {
    /// A rectangle.
    Box,
    /// Any closed line.
    Lasso,
}

/// The numbers that the table of vertices shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Columns {
    /// Where the vertices are.
    #[default]
    Places,
    /// How far they were moved by hand from where the presets have them.
    Offsets,
}

/// Switches and steps of editing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct EditUi {
    /// Whether moves are rounded to whole steps; Ctrl does the opposite.
    pub(super) snaps: bool,
    pub(super) step_mm: f64,
    pub(super) step_deg: f64,
    /// Whether vertices near the selection follow it.
    pub(super) is_proportional: bool,
    pub(super) radius_mm: f64,
    /// Whether edits are mirrored about the planes x = 0 and y = 0.
    pub(super) mirrors: [bool; 2],
    pub(super) columns: Columns,
    /// What the next drag draws; `None` turns the view.
    #[serde(skip)]
    pub(super) outline: Option<Outline>,
}

impl Default for EditUi {
    fn default() -> Self {
        Self {
            snaps: false,
            step_mm: 0.5,
            step_deg: 5.0,
            is_proportional: false,
            radius_mm: 6.0,
            mirrors: [false; 2],
            columns: Columns::default(),
            outline: None,
        }
    }
}

impl EditUi {
    /// Steps as operators take them.
    pub(super) fn steps(&self) -> Steps {
        Steps { length: self.step_mm, angle: self.step_deg.to_radians() }
    }

    /// The radius, where near vertices follow.
    pub(super) fn radius(&self) -> Option<f64> {
        self.is_proportional.then_some(self.radius_mm)
    }

    /// Changes the radius by a factor.
    pub(super) fn scale_radius(&mut self, factor: f64) {
        self.radius_mm = (self.radius_mm * factor).clamp(*RADII_MM.start(), *RADII_MM.end());
    }

    /// The mirror planes that are on.
    pub(super) fn mirror(&self) -> Mirror {
        Mirror { axes: self.mirrors, ..Mirror::default() }
    }

    /// Starts or ends drawing an outline.
    pub(super) fn toggle_outline(&mut self, outline: Outline) {
        self.outline = (self.outline != Some(outline)).then_some(outline);
    }

    /// Takes back numbers that no run of the program can have written.
    pub(super) fn restore(&mut self) {
        let default = Self::default();
        for (value, range, normal) in [
            (&mut self.step_mm, STEPS_MM, default.step_mm),
            (&mut self.step_deg, STEPS_DEG, default.step_deg),
            (&mut self.radius_mm, RADII_MM, default.radius_mm),
        ] {
            if !range.contains(value) {
                *value = normal;
            }
        }
    }
}
