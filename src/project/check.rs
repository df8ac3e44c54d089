//! What every number of a project must satisfy, wherever it comes from: a file, the window or the command line.
//!
//! Enters: a [`Project`]. Leaves: the first [`ProjectError`], which names the field as the project file spells it.
//! Ranges keep all that is built from a project finite and bounded; whether a preset bends the cage too far depends
//! on the cage and is told by [`crate::cage::pose`], so that such a project can still be opened and put right.

use super::materials::DIELECTRICS;
use super::{AntennaSpec, BodiesError, BodiesSpec, CageSpec, CompensationMode, PresetSpec, Project, Settings};
use crate::antenna::ParamError;
use crate::cage::build::MAX_SEGMENTS;
use crate::cage::{Cage, CageError};
use crate::geometry::DVec3;

/// Why a project is refused; names the field and what to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProjectError {
    /// The antenna's parameters are wrong or do not fit together.
    #[error("antenna.{0}")]
    Antenna(#[from] ParamError),
    /// The imported bodies are not valid.
    #[error("bodies: {0}")]
    Bodies(#[from] BodiesError),
    /// No cage can be built.
    #[error("cage: {0}")]
    Cage(#[from] CageError),
    /// A number lies outside its range, or is none.
    #[error("{field} is {value}, but must lie between {lo} and {hi}")]
    OutOfRange {
        /// Path of the field, as in the project file.
        field: String,
        /// Its value, in the unit of its name.
        value: f64,
        /// Smallest allowed.
        lo: f64,
        /// Greatest allowed.
        hi: f64,
    },
    /// A hand edit names a vertex that the cage does not have.
    #[error("hand_edits names cage vertex {vertex}, but the cage has {count} (0 to {}): remove it", count - 1)]
    NoVertex {
        /// The vertex.
        vertex: u32,
        /// Number of vertices that can be moved.
        count: usize,
    },
    /// The stack of presets is too long.
    #[error("there are {count} presets, but at most {MAX_PRESETS} can be stacked: remove some")]
    TooManyPresets {
        /// How many there are.
        count: usize,
    },
    /// A material of the user's own has no name.
    #[error("materials[{index}] has no name: give it one")]
    NamelessMaterial {
        /// Place in the list.
        index: usize,
    },
    /// Two materials have the same name.
    #[error("materials[{index}] is called \"{name}\", as another material is: choose another name")]
    NameTaken {
        /// Place in the list.
        index: usize,
        /// The name.
        name: String,
    },
    /// There are too many materials.
    #[error("there are {count} materials, but at most {MAX_MATERIALS} can be kept: remove some")]
    TooManyMaterials {
        /// How many there are.
        count: usize,
    },
}

/// More materials than this are no list to choose from.
pub const MAX_MATERIALS: usize = 64;
/// More presets than this are no design but a broken file; each costs a pass over the cage.
pub const MAX_PRESETS: usize = 64;
/// Range of a length of the antenna, mm: 0.1 micrometre to 100 m. Beyond, coordinates of one model differ by so much
/// that lengths vanish in rounding.
const LENGTH_MM: (f64, f64) = (1e-4, 1e5);
/// Range of an offset or amplitude, mm.
const OFFSET_MM: (f64, f64) = (-1e5, 1e5);
/// Range of a bend radius, mm; at the limit a sheet of 100 m is flat to 0.1 mm.
const RADIUS_MM: (f64, f64) = (-1e10, 1e10);
/// Range of the splitting tolerance, mm: below it a bent foil takes millions of triangles.
const TOLERANCE_MM: (f64, f64) = (1e-3, 10.0);
/// Degrees of a fitted polynomial: degree 0 has no length, and more than 12 cannot be told apart by the fit's samples.
const FIT_ORDER: (f64, f64) = (1.0, 12.0);

impl Project {
    /// Checks every number: ranges, that the antenna's parts fit together, that hand edits name vertices of the cage.
    ///
    /// # Errors
    /// The first [`ProjectError`] found, in the order of the project file.
    pub fn validate(&self) -> Result<(), ProjectError> {
        self.antenna.validate()?;
        self.cage.validate()?;
        if self.presets.len() > MAX_PRESETS {
            return Err(ProjectError::TooManyPresets { count: self.presets.len() });
        }
        for (index, entry) in self.presets.iter().enumerate() {
            entry.preset.validate(index)?;
        }
        let count = self.cage.n_handles();
        for (&vertex, offset) in &self.hand_edits {
            if usize::try_from(vertex).map_or(true, |v| v >= count) {
                return Err(ProjectError::NoVertex { vertex, count });
            }
            for value in offset {
                in_range(|| format!("hand_edits.{vertex}"), *value, OFFSET_MM)?;
            }
        }
        self.settings.validate()?;
        self.check_materials()?;
        let Some(bodies) = &self.bodies else { return Ok(()) };
        bodies.validate()?;
        let is_compensated = self.settings.compensation != CompensationMode::None;
        if is_compensated { Err(BodiesError::Compensated.into()) } else { Ok(()) }
    }

    fn check_materials(&self) -> Result<(), ProjectError> {
        let count = self.materials.len();
        if count > MAX_MATERIALS {
            return Err(ProjectError::TooManyMaterials { count });
        }
        for (index, material) in self.materials.iter().enumerate() {
            let name = &material.name;
            if name.trim().is_empty() {
                return Err(ProjectError::NamelessMaterial { index });
            }
            let is_taken = self.materials[..index].iter().any(|m| m.name == *name);
            if is_taken || DIELECTRICS.iter().any(|d| d.name == name) {
                return Err(ProjectError::NameTaken { index, name: name.clone() });
            }
            in_range(|| format!("materials[{index}].eps_r"), material.eps_r, (1.0, 1000.0))?;
            in_range(|| format!("materials[{index}].tan_delta"), material.tan_delta, (0.0, 1.0))?;
        }
        Ok(())
    }

    /// The rest cage around this antenna.
    ///
    /// # Errors
    /// [`CageError`] if padding or segments are out of range.
    pub fn rest_cage(&self) -> Result<Cage, CageError> {
        Cage::around(self.bounds(), &self.cage.to_params())
    }

    /// The box around the flat antenna, m.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bodies.as_ref().map_or_else(|| self.antenna.to_params().bounds(), BodiesSpec::bounds)
    }
}

impl AntennaSpec {
    fn validate(&self) -> Result<(), ProjectError> {
        let lengths = [
            ("width_mm", self.width_mm),
            ("length_mm", self.length_mm),
            ("patch_thickness_mm", self.patch_thickness_mm),
            ("height_mm", self.height_mm),
            ("ground_width_mm", self.ground_width_mm),
            ("ground_length_mm", self.ground_length_mm),
            ("ground_thickness_mm", self.ground_thickness_mm),
            ("inset_mm", self.inset_mm),
            ("pin_radius_mm", self.pin_radius_mm),
            ("coax_radius_mm", self.coax_radius_mm),
            ("coax_length_mm", self.coax_length_mm),
        ];
        for (name, value) in lengths {
            in_range(|| format!("antenna.{name}"), value, LENGTH_MM)?;
        }
        in_range(|| "antenna.feed_offset_mm".to_owned(), self.feed_offset_mm, OFFSET_MM)?;
        Ok(self.to_params().validate()?)
    }
}

impl CageSpec {
    /// Number of cage vertices that can be moved: both ends of each station's post.
    #[must_use]
    pub fn n_handles(&self) -> usize {
        2 * (self.segments[0] + 1) * (self.segments[1] + 1)
    }

    fn validate(&self) -> Result<(), ProjectError> {
        for value in self.padding_mm {
            in_range(|| "cage.padding_mm".to_owned(), value, LENGTH_MM)?;
        }
        let wrong = ['x', 'y'].into_iter().zip(self.segments).find(|(_, count)| !(1..=MAX_SEGMENTS).contains(count));
        wrong.map_or(Ok(()), |(axis, count)| Err(CageError::Segments { axis, count }.into()))
    }
}

impl PresetSpec {
    fn validate(&self, index: usize) -> Result<(), ProjectError> {
        let check = |name: &str, value, range| in_range(|| format!("presets[{index}].{name}"), value, range);
        match *self {
            Self::Bend { radius_mm, kept_plane_mm, .. } => {
                check("radius_mm", radius_mm, RADIUS_MM)?;
                check("kept_plane_mm", kept_plane_mm, OFFSET_MM)
            }
            Self::Convex { radius_mm, amplitude_mm }
            | Self::Concave { radius_mm, amplitude_mm }
            | Self::Saddle { radius_mm, amplitude_mm } => {
                check("radius_mm", radius_mm, RADIUS_MM)?;
                check("amplitude_mm", amplitude_mm, OFFSET_MM)
            }
            Self::Twist { amplitude_mm, rate_deg_per_mm } => {
                check("amplitude_mm", amplitude_mm, OFFSET_MM)?;
                check("rate_deg_per_mm", rate_deg_per_mm, (-360.0, 360.0))
            }
            Self::Crumple { amplitude_mm, waves, phase_deg } => {
                check("amplitude_mm", amplitude_mm, OFFSET_MM)?;
                check("waves", waves[0], (-1e3, 1e3))?;
                check("waves", waves[1], (-1e3, 1e3))?;
                check("phase_deg", phase_deg, (-1e6, 1e6))
            }
        }
    }
}

impl Settings {
    fn validate(&self) -> Result<(), ProjectError> {
        in_range(|| "settings.tolerance_mm".to_owned(), self.tolerance_mm, TOLERANCE_MM)?;
        for order in self.fit_orders {
            in_range(|| "settings.fit_orders".to_owned(), order as f64, FIT_ORDER)?;
        }
        Ok(())
    }
}

fn in_range(field: impl Fn() -> String, value: f64, (lo, hi): (f64, f64)) -> Result<(), ProjectError> {
    // Not the other way round: NaN is in no range.
    if (lo..=hi).contains(&value) { Ok(()) } else { Err(ProjectError::OutOfRange { field: field(), value, lo, hi }) }
}

#[cfg(test)]
mod tests {
    use super::super::{MaterialSpec, PresetEntry};
    use super::*;

    #[test]
    fn the_default_project_is_valid_and_counts_its_vertices() {
        let mut project = Project::default();
        assert_eq!(project.validate(), Ok(()), "the paper's antenna");
        for segments in [[1, 1], [3, 2], [10, 10]] {
            project.cage.segments = segments;
            assert_eq!(project.cage.n_handles(), project.rest_cage().expect("valid").n_handles(), "{segments:?}");
        }
    }

    #[test]
    fn every_fit_order_that_can_be_computed_is_allowed() {
        let highest = crate::distortion::MAX_FIT_ORDER;
        let mut project = Project::default();
        project.settings.fit_orders = [1, highest];
        assert_eq!(project.validate(), Ok(()), "lowest and highest");
        project.settings.fit_orders = [1, highest + 1];
        assert!(project.validate().is_err(), "above");
    }

    fn own(name: &str) -> MaterialSpec {
        MaterialSpec { name: name.to_owned(), eps_r: 1.3, tan_delta: 0.02 }
    }

    #[test]
    fn each_fault_names_its_field() {
        type Spoil = fn(&mut Project);
        let bend = |radius_mm| PresetSpec::Convex { radius_mm, amplitude_mm: 1.0 };
        let entry = PresetEntry { enabled: false, preset: bend(f64::NAN) };
        let mut switched_off = Project::default();
        switched_off.presets.push(entry);
        let message = switched_off.validate().expect_err("NaN, even switched off").to_string();
        assert!(message.starts_with("presets[0].radius_mm is NaN"), "{message}");
        let faults: [(&str, Spoil); 14] = [
            ("materials[0] has no name", |p| p.materials = vec![own(" ")]),
            ("materials[1] is called \"my felt\", as another", |p| p.materials = vec![own("my felt"); 2]),
            ("materials[0] is called \"FR-4\", as another", |p| p.materials = vec![own("FR-4")]),
            ("materials[0].eps_r is 0.5", |p| p.materials = vec![MaterialSpec { eps_r: 0.5, ..own("a") }]),
            ("there are 65 materials", |p| p.materials = vec![own("a"); 65]),
            ("antenna.width_mm is 1", |p| p.antenna.width_mm = 1e308),
            ("antenna.length ", |p| p.antenna.length_mm = 30.0),
            ("antenna.feed_offset_mm", |p| p.antenna.feed_offset_mm = f64::INFINITY),
            ("cage.padding_mm is -1", |p| p.cage.padding_mm[1] = -1.0),
            ("cage: the cage has 65 segments along x", |p| p.cage.segments = [65, 1]),
            ("hand_edits names cage vertex 242, but the cage has 242 (0 to 241)", |p| {
                p.hand_edits.insert(242, [0.0; 3]);
            }),
            ("hand_edits.7 is NaN", |p| {
                p.hand_edits.insert(7, [0.0, f64::NAN, 0.0]);
            }),
            ("settings.tolerance_mm is 0", |p| p.settings.tolerance_mm = 0.0),
            ("settings.fit_orders is 0", |p| p.settings.fit_orders = [5, 0]),
        ];
        for (start, spoil) in faults {
            let mut project = Project::default();
            spoil(&mut project);
            let message = project.validate().expect_err("spoiled").to_string();
            assert!(message.starts_with(start), "{start}: {message}");
        }
    }
}
