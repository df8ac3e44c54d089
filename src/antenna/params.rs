//! Parameters of the coax-fed patch antenna and their validation.

use super::loads::{Conductor, MAX_RESISTORS, Resistor};
use super::outline::OutlineError;
use crate::geometry::{DVec2, DVec3};
use crate::units::to_mm;

/// A dielectric by its relative permittivity and loss tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Relative permittivity, at least 1.
    pub eps_r: f64,
    /// Loss tangent, at least 0.
    pub tan_delta: f64,
}

/// All dimensions of the patch antenna; lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchParams {
    /// Patch width W, along x.
    pub width: f64,
    /// Patch length L, along y: the resonant side.
    pub length: f64,
    /// Corners of a patch that is no rectangle, counter-clockwise; its box is width by length about the origin. Empty for
    /// the rectangle.
    pub outline: Vec<DVec2>,
    /// Thickness of the patch's metal.
    pub patch_thickness: f64,
    /// Substrate height h.
    pub height: f64,
    /// Extent of substrate and ground along x.
    pub ground_width: f64,
    /// Extent of substrate and ground along y.
    pub ground_length: f64,
    /// Thickness of the ground's metal.
    pub ground_thickness: f64,
    /// Distance of the feed from the radiating edge at y = -L/2.
    pub inset: f64,
    /// Offset of the feed from the patch's center line, along x.
    pub feed_offset: f64,
    /// Radius of the feed pin.
    pub pin_radius: f64,
    /// Inner radius of the coaxial line's outer conductor.
    pub coax_radius: f64,
    /// Length of the coaxial line below the ground.
    pub coax_length: f64,
    /// Segments of the polygon that stands for the pin's circle.
    pub pin_segments: usize,
    /// Segments of the polygon that stands for the outer circle.
    pub coax_segments: usize,
    /// Substrate material.
    pub substrate: Dielectric,
    /// Sheath of the coaxial line.
    pub sheath: Dielectric,
    /// What the patch's metal is.
    pub patch_metal: Conductor,
    /// What the ground's metal is.
    pub ground_metal: Conductor,
    /// Resistors between ground and patch.
    pub resistors: Vec<Resistor>,
}

/// What is wrong with a parameter, by the name that the project file and the window use for it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParamError {
    /// A length is not positive and finite.
    #[error("{field} must be a positive length, but is {value_mm} mm")]
    NotPositive {
        /// Name of the field.
        field: &'static str,
        /// Its value, mm.
        value_mm: f64,
    },
    /// A value lies outside its range.
    #[error("{field} is {value}, but must lie between {lo} and {hi}")]
    OutOfRange {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Smallest allowed.
        lo: f64,
        /// Greatest allowed.
        hi: f64,
    },
    /// A part does not fit into another.
    #[error("{field} is {value_mm:.4} mm, but {reason}: it must be {bound} {limit_mm:.4} mm")]
    DoesNotFit {
        /// Name of the field.
        field: &'static str,
        /// Its value, mm.
        value_mm: f64,
        /// Why there is a limit.
        reason: &'static str,
        /// "less than" or "more than".
        bound: &'static str,
        /// The limit, mm.
        limit_mm: f64,
    },
    /// The patch's outline is none.
    #[error(transparent)]
    Outline(#[from] OutlineError),
    /// The feed is not under a patch that is no rectangle.
    #[error(
        "inset and feed_offset put the feed at ({x_mm:.4}, {y_mm:.4}) mm, which is {inside_mm:.4} mm inside the patch's \
         outline, but must be at least {limit_mm:.4} mm: move the feed"
    )]
    FeedOutside {
        /// x, mm.
        x_mm: f64,
        /// y, mm.
        y_mm: f64,
        /// How far inside the outline it is, mm; negative outside.
        inside_mm: f64,
        /// Least distance, mm.
        limit_mm: f64,
    },
    /// There are too many resistors.
    #[error("resistors has {count} resistors, but at most {MAX_RESISTORS} can be placed: remove some")]
    TooManyResistors {
        /// How many there are.
        count: usize,
    },
    /// A resistor's value lies outside its range.
    #[error("resistors[{index}] (resistor {}) has {value} ohm, but must have between {lo} and {hi}", index + 1)]
    Resistance {
        /// Place in the list.
        index: usize,
        /// Its value, ohm.
        value: f64,
        /// Smallest allowed.
        lo: f64,
        /// Greatest allowed.
        hi: f64,
    },
    /// A resistor stands where it cannot.
    #[error(
        "resistors[{index}] (resistor {}) at ({x_mm:.4}, {y_mm:.4}) mm is {distance_mm:.4} mm {what}, but must be at \
         least {limit_mm:.4} mm: move it",
        index + 1
    )]
    Misplaced {
        /// Place in the list.
        index: usize,
        /// x, mm.
        x_mm: f64,
        /// y, mm.
        y_mm: f64,
        /// What it is too near to.
        what: String,
        /// Its distance from that, mm.
        distance_mm: f64,
        /// Least distance, mm.
        limit_mm: f64,
    },
}

/// Segment counts below this make a pin that is no cylinder; see [`PatchParams::validate`].
const MIN_SEGMENTS: usize = 6;
/// Segment counts above this give chords shorter than the foil is thick, and triangles nobody needs.
const MAX_SEGMENTS: usize = 256;

impl PatchParams {
    /// Place of the feed's axis in the plane of the patch.
    #[must_use]
    pub fn feed(&self) -> DVec2 {
        DVec2::new(self.feed_offset, self.inset - self.length / 2.0)
    }

    /// Height of the ground's lower face (negative).
    #[must_use]
    pub fn ground_bottom(&self) -> f64 {
        -(self.height + self.ground_thickness)
    }

    /// Height of the port plane that ends the coaxial line (negative).
    #[must_use]
    pub fn port_plane(&self) -> f64 {
        self.ground_bottom() - self.coax_length
    }

    /// The box around all that the cage carries: everything but the coaxial line below the ground.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let half = DVec2::new(self.ground_width, self.ground_length) / 2.0;
        (half.extend(0.0) * -1.0 + DVec3::Z * self.ground_bottom(), half.extend(self.patch_thickness))
    }

    /// Thinnest layer: it bounds the tolerance of edge splitting.
    #[must_use]
    pub fn thinnest_layer(&self) -> f64 {
        self.patch_thickness.min(self.height).min(self.ground_thickness)
    }

    /// Checks every dimension and that the parts fit together.
    ///
    /// # Errors
    /// The first [`ParamError`] found; it names the field, its value and the limit.
    pub fn validate(&self) -> Result<(), ParamError> {
        self.check_lengths()?;
        self.check_ranges()?;
        self.check_fit()?;
        self.check_outline()?;
        self.check_loads()
    }

    fn check_lengths(&self) -> Result<(), ParamError> {
        let lengths = [
            ("width", self.width),
            ("length", self.length),
            ("patch_thickness", self.patch_thickness),
            ("height", self.height),
            ("ground_width", self.ground_width),
            ("ground_length", self.ground_length),
            ("ground_thickness", self.ground_thickness),
            ("inset", self.inset),
            ("pin_radius", self.pin_radius),
            ("coax_radius", self.coax_radius),
            ("coax_length", self.coax_length),
        ];
        for (field, value) in lengths {
            if !(value.is_finite() && value > 0.0) {
                return Err(ParamError::NotPositive { field, value_mm: to_mm(value) });
            }
        }
        Ok(())
    }

    fn check_ranges(&self) -> Result<(), ParamError> {
        let counts = |n: usize| n as f64;
        let ranges = [
            ("feed_offset", to_mm(self.feed_offset), -1e6, 1e6),
            ("substrate.eps_r", self.substrate.eps_r, 1.0, 1000.0),
            ("substrate.tan_delta", self.substrate.tan_delta, 0.0, 1.0),
            ("sheath.eps_r", self.sheath.eps_r, 1.0, 1000.0),
            ("sheath.tan_delta", self.sheath.tan_delta, 0.0, 1.0),
            ("pin_segments", counts(self.pin_segments), counts(MIN_SEGMENTS), counts(MAX_SEGMENTS)),
            ("coax_segments", counts(self.coax_segments), counts(MIN_SEGMENTS), counts(MAX_SEGMENTS)),
        ];
        for (field, value, lo, hi) in ranges {
            if !(lo..=hi).contains(&value) {
                return Err(ParamError::OutOfRange { field, value, lo, hi });
            }
        }
        Ok(())
    }

    fn check_fit(&self) -> Result<(), ParamError> {
        let feed = self.feed();
        let less = |field, value: f64, limit: f64, reason| {
            let wrong = ParamError::DoesNotFit {
                field,
                value_mm: to_mm(value),
                reason,
                bound: "less than",
                limit_mm: to_mm(limit),
            };
            if value < limit { Ok(()) } else { Err(wrong) }
        };
        less("width", self.width, self.ground_width, "the patch lies within the ground")?;
        less("length", self.length, self.ground_length, "the patch lies within the ground")?;
        less("inset", self.inset, self.length - self.pin_radius, "the pin ends under the patch")?;
        less("pin_radius", self.pin_radius, self.inset, "the pin ends under the patch")?;
        let sideways = self.width / 2.0 - self.pin_radius;
        less("feed_offset", self.feed_offset.abs(), sideways, "the pin ends under the patch")?;
        // The inscribed circle of the outer polygon must clear the pin.
        let clear = self.coax_radius * (std::f64::consts::PI / self.coax_segments as f64).cos();
        less("pin_radius", self.pin_radius, clear, "the coaxial line's outer conductor surrounds the pin")?;
        let room = (self.ground_width / 2.0 - feed.x.abs()).min(self.ground_length / 2.0 - feed.y.abs());
        less("coax_radius", self.coax_radius, room, "the coaxial line meets the ground within its outline")
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::units::from_mm;

    /// The paper's antenna.
    pub(crate) fn paper() -> PatchParams {
        PatchParams {
            width: from_mm(10.83),
            length: from_mm(8.177),
            outline: Vec::new(),
            patch_thickness: from_mm(0.035),
            height: from_mm(1.575),
            ground_width: from_mm(20.0),
            ground_length: from_mm(20.0),
            ground_thickness: from_mm(0.035),
            inset: from_mm(1.75),
            feed_offset: 0.0,
            pin_radius: from_mm(0.625),
            coax_radius: from_mm(2.16),
            coax_length: from_mm(3.0),
            pin_segments: 14,
            coax_segments: 28,
            substrate: Dielectric { eps_r: 2.2, tan_delta: 0.0009 },
            sheath: Dielectric { eps_r: 2.2, tan_delta: 0.0009 },
            patch_metal: Conductor::Perfect,
            ground_metal: Conductor::Perfect,
            resistors: Vec::new(),
        }
    }

    #[test]
    fn the_paper_antenna_is_valid_and_in_its_frame() {
        let params = paper();
        assert_eq!(params.validate(), Ok(()), "valid");
        assert!((to_mm(params.ground_bottom()) + 1.61).abs() < 1e-12, "ground bottom");
        assert!((to_mm(params.feed().y) + 2.3385).abs() < 1e-12, "feed place");
    }

    #[test]
    fn each_fault_names_its_field() {
        type Spoil = fn(&mut PatchParams);
        let faults: [(&str, Spoil); 9] = [
            ("width", |p| p.width = -1.0),
            ("height", |p| p.height = f64::NAN),
            ("width", |p| p.width = from_mm(20.0)),
            ("inset", |p| p.inset = from_mm(8.0)),
            ("pin_radius", |p| p.pin_radius = from_mm(1.8)),
            ("feed_offset", |p| p.feed_offset = from_mm(-5.0)),
            ("coax_radius", |p| p.coax_radius = from_mm(8.0)),
            ("substrate.eps_r", |p| p.substrate.eps_r = 0.5),
            ("pin_segments", |p| p.pin_segments = 2),
        ];
        for (field, spoil) in faults {
            let mut params = paper();
            spoil(&mut params);
            let message = params.validate().expect_err("spoiled").to_string();
            assert!(message.starts_with(field), "{field}: {message}");
        }
    }
}
