//! Presets: bend, convex, concave, saddle, twist and crumple, as maps of space applied to the cage's vertices.
//!
//! Each preset is a map of a point `(x, y, z)` of the flat frame; a stack of presets is their composition, first to
//! last. Angles are radians, lengths metres. The maps of section VI of the paper (convex, concave, saddle, twist) use
//! `f(s) = A (cos(π s / L_c) − 1)` with `L_c` the cage's extent along s.

use super::build::Cage;
use crate::geometry::DVec3;
use crate::units::to_mm;
use std::f64::consts::{PI, TAU};

/// The axis along which a shape curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// x, across the width: H-plane bending, with the cylinder's axis along y.
    X,
    /// y, along the resonant length: E-plane bending, with the cylinder's axis along x.
    Y,
}

/// How the stations of a bent cage are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BendRule {
    /// Segments tangent to the cylinder: nearly independent of their number.
    Tangent,
    /// Vertices on the cylinder.
    Arc,
}

/// The form of a section VI shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Curved the same way in both directions.
    Convex,
    /// Convex, towards the other side.
    Concave,
    /// Curved in opposite ways.
    Saddle,
}

/// One deformation of the cage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Preset {
    /// Bend onto a circular cylinder.
    Bend {
        /// Axis that curves.
        axis: Axis,
        /// Radius R of the patch's bottom plane, m; negative bends the other way, with the ground outside.
        radius: f64,
        /// Tangent or arc.
        rule: BendRule,
        /// Height `z_n` of the plane whose length is kept, m (0: the patch's bottom).
        kept_plane: f64,
    },
    /// Doubly curved shape.
    Curved {
        /// Which one.
        section: Section,
        /// Radius R of the bend along x, m.
        radius: f64,
        /// Amplitude A along y, m.
        amplitude: f64,
    },
    /// Half a wave along x, then a rotation about y that grows with y.
    Twist {
        /// Amplitude A of the wave, m.
        amplitude: f64,
        /// Angle per length along y, rad/m.
        rate: f64,
    },
    /// Sine waves in the sheet.
    Crumple {
        /// Amplitude, m.
        amplitude: f64,
        /// Waves over the cage's extent along x and y; 0 for none along that axis.
        waves: [f64; 2],
        /// Phase, rad.
        phase: f64,
    },
}

/// Why a preset cannot be applied; says which number to change.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PresetError {
    /// A number is NaN or infinite.
    #[error("{field} is not a finite number")]
    NotFinite {
        /// The parameter.
        field: &'static str,
    },
    /// The inner side of the cage would pass the axis of the bend.
    #[error(
        "radius {radius_mm:.4} mm turns the cage inside out: choose more than {limit_mm:.4} mm, or a smaller padding z"
    )]
    RadiusTooSmall {
        /// The radius, mm.
        radius_mm: f64,
        /// It must be greater in magnitude than this, mm.
        limit_mm: f64,
    },
    /// The cage would close on itself.
    #[error("the bend turns through {angle_deg:.1} degrees: choose a radius above {limit_mm:.4} mm, or less padding")]
    FullTurn {
        /// Total angle, degrees.
        angle_deg: f64,
        /// Smallest radius, mm.
        limit_mm: f64,
    },
}

/// Applies presets, first to last, to the rest cage and returns the posed vertices with centers in place, m.
///
/// # Errors
/// The first [`PresetError`], with the index of the preset that caused it.
pub fn pose(cage: &Cage, presets: &[Preset]) -> Result<Vec<DVec3>, (usize, PresetError)> {
    let mut vertices = cage.mesh.vertices.clone();
    for (index, preset) in presets.iter().enumerate() {
        preset.check(cage).map_err(|e| (index, e))?;
        vertices.iter_mut().for_each(|p| *p = preset.map(cage, *p));
    }
    Ok(cage.with_centers(vertices))
}

impl Preset {
    /// Checks the numbers against the cage, as if this preset were the only one.
    fn check(&self, cage: &Cage) -> Result<(), PresetError> {
        let finite = |field, value: f64| if value.is_finite() { Ok(()) } else { Err(PresetError::NotFinite { field }) };
        match *self {
            Self::Bend { axis, radius, kept_plane, .. } => {
                finite("radius", radius)?;
                finite("kept plane", kept_plane)?;
                check_radius(cage, radius, 0.0)?;
                let extent = if axis == Axis::X { cage.extent().x } else { cage.extent().y };
                // The kept plane's own radius must not vanish either.
                let limit = extent / TAU;
                let kept = (radius + kept_plane) * radius.signum();
                if kept <= limit {
                    let angle_deg = (extent / kept).to_degrees();
                    let limit_mm = to_mm(limit - kept_plane * radius.signum());
                    return Err(PresetError::FullTurn { angle_deg, limit_mm });
                }
                Ok(())
            }
            Self::Curved { section, radius, amplitude } => {
                finite("radius", radius)?;
                finite("amplitude", amplitude)?;
                // r = R ± z ± f(y) with f between -A (at the rim, where cos = 0) and 0.
                let dip = if section == Section::Saddle { -amplitude } else { amplitude };
                check_radius(cage, if section == Section::Concave { -radius } else { radius }, dip.max(0.0))?;
                let extent = cage.extent().x;
                if extent >= TAU * radius.abs() {
                    let angle_deg = (extent / radius.abs()).to_degrees();
                    return Err(PresetError::FullTurn { angle_deg, limit_mm: to_mm(extent / TAU) });
                }
                Ok(())
            }
            Self::Twist { amplitude, rate } => finite("amplitude", amplitude).and(finite("rate", rate)),
            Self::Crumple { amplitude, waves, phase } => {
                finite("amplitude", amplitude).and(finite("waves", waves[0] + waves[1])).and(finite("phase", phase))
            }
        }
    }

    /// Maps one point of the flat frame.
    fn map(&self, cage: &Cage, p: DVec3) -> DVec3 {
        let extent = cage.extent();
        match *self {
            Self::Bend { axis: Axis::X, .. } => self.bend(extent.x, cage.segments[0], p),
            Self::Bend { axis: Axis::Y, .. } => {
                let q = self.bend(extent.y, cage.segments[1], DVec3::new(p.y, p.x, p.z));
                DVec3::new(q.y, q.x, q.z)
            }
            Self::Curved { section, radius, amplitude } => {
                let f = amplitude * ((PI * p.y / extent.y).cos() - 1.0);
                let (sin, cos) = (p.x / radius).sin_cos();
                match section {
                    Section::Convex => on_circle(radius + p.z + f, sin, cos, p.y, radius),
                    Section::Saddle => on_circle(radius + p.z - f, sin, cos, p.y, radius),
                    Section::Concave => {
                        let r = radius - p.z + f;
                        DVec3::new(r * sin, p.y, radius - r * cos)
                    }
                }
            }
            Self::Twist { amplitude, rate } => {
                let z = p.z + amplitude * ((PI * p.x / extent.x).cos() - 1.0);
                let (sin, cos) = (rate * p.y).sin_cos();
                DVec3::new(p.x * cos + z * sin, p.y, z * cos - p.x * sin)
            }
            Self::Crumple { amplitude, waves, phase } => {
                let wave = |n: f64, s: f64| {
                    if n.abs() > 0.0 { amplitude * (TAU * n * s + phase).sin() } else { 0.0 }
                };
                p + DVec3::Z * (wave(waves[0], p.x / extent.x) + wave(waves[1], p.y / extent.y))
            }
        }
    }

    /// Bend along x of a cage with this extent and number of segments along x.
    fn bend(&self, extent: f64, segments: usize, p: DVec3) -> DVec3 {
        let Self::Bend { radius, rule, kept_plane, .. } = *self else { return p };
        let kept = radius + kept_plane;
        let (angle, r) = match rule {
            BendRule::Arc => (p.x / kept, radius + p.z),
            BendRule::Tangent => {
                let segment = extent / segments as f64;
                let half = (segment / (2.0 * kept)).atan();
                (p.x * 2.0 * half / segment, (radius + p.z) / half.cos())
            }
        };
        let (sin, cos) = angle.sin_cos();
        on_circle(r, sin, cos, p.y, radius)
    }
}

fn on_circle(r: f64, sin: f64, cos: f64, y: f64, radius: f64) -> DVec3 {
    DVec3::new(r * sin, y, r * cos - radius)
}

/// The cage's inner side must stay on its side of the axis: |R| minus its depth, minus `dip`, must be positive.
fn check_radius(cage: &Cage, radius: f64, dip: f64) -> Result<(), PresetError> {
    let (lo, hi) = cage.mesh.bounds();
    let depth = if radius < 0.0 { hi.z } else { -lo.z };
    let limit = depth + dip;
    if radius.abs() > limit {
        Ok(())
    } else {
        Err(PresetError::RadiusTooSmall { radius_mm: to_mm(radius.abs()), limit_mm: to_mm(limit) })
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::paper_cage;
    use super::*;
    use crate::units::from_mm;

    fn bend(radius_mm: f64, rule: BendRule, axis: Axis) -> Preset {
        Preset::Bend { axis, radius: from_mm(radius_mm), rule, kept_plane: 0.0 }
    }

    #[test]
    fn tangent_segments_touch_the_cylinder_and_keep_their_length() {
        let cage = paper_cage(3.0, [10, 1]);
        let posed = pose(&cage, &[bend(10.0, BendRule::Tangent, Axis::X)]).expect("valid");
        // On the plane z = 0 (between bottom and top by linear interpolation) each segment keeps its flat length and
        // its middle lies on the cylinder of radius R about (0, -R).
        let at = |i: usize| {
            let find = |k| cage.lattice.iter().position(|p| *p == [i, 0, k]).expect("station");
            let (bottom, top) = (cage.mesh.vertices[find(0)].z, cage.mesh.vertices[find(1)].z);
            posed[find(0)].lerp(posed[find(1)], -bottom / (top - bottom))
        };
        for i in 0..10 {
            let (a, b) = (at(i), at(i + 1));
            assert!(((b - a).length() - from_mm(2.6)).abs() < 1e-15, "segment {i} keeps its length");
            let middle = (a + b) / 2.0 + DVec3::Z * from_mm(10.0);
            assert!((middle.x.hypot(middle.z) - from_mm(10.0)).abs() < 1e-15, "segment {i} is tangent");
        }
    }

    #[test]
    fn bending_along_y_is_bending_along_x_with_the_axes_swapped() {
        let cage = paper_cage(3.0, [10, 10]);
        for rule in [BendRule::Tangent, BendRule::Arc] {
            let x = pose(&cage, &[bend(8.0, rule, Axis::X)]).expect("valid");
            let y = pose(&cage, &[bend(8.0, rule, Axis::Y)]).expect("valid");
            for (v, &[i, j, k]) in cage.lattice.iter().enumerate() {
                let swapped = cage.lattice.iter().position(|p| *p == [j, i, k]).expect("square lattice");
                let p = y[swapped];
                assert!(x[v].distance(DVec3::new(p.y, p.x, p.z)) < 1e-15, "vertex {v}");
            }
        }
    }

    #[test]
    fn impossible_bends_name_the_number_to_change() {
        let cage = paper_cage(3.0, [10, 1]);
        let small = pose(&cage, &[bend(4.5, BendRule::Arc, Axis::X)]).expect_err("inside out");
        assert!(matches!(small, (0, PresetError::RadiusTooSmall { .. })), "{small:?}");
        let cage = paper_cage(1.0, [10, 1]);
        let turn = pose(&cage, &[bend(3.4, BendRule::Arc, Axis::X)]).expect_err("more than a full turn");
        assert!(matches!(turn, (0, PresetError::FullTurn { .. })), "{turn:?}");
        let nan = pose(&cage, &[bend(f64::NAN, BendRule::Arc, Axis::X)]).expect_err("NaN");
        assert!(matches!(nan.1, PresetError::NotFinite { field: "radius" }), "{nan:?}");
    }

    #[test]
    fn a_negative_radius_mirrors_the_bend() {
        let cage = paper_cage(1.0, [4, 1]);
        let down = pose(&cage, &[bend(10.0, BendRule::Arc, Axis::X)]).expect("valid");
        let up = pose(&cage, &[bend(-10.0, BendRule::Arc, Axis::X)]).expect("valid");
        let edge = |p: &[DVec3]| p.iter().map(|q| q.z).fold(f64::NEG_INFINITY, f64::max);
        assert!(edge(&up) > from_mm(4.0) && edge(&down) < from_mm(1.2), "rim up and rim down");
    }

    #[test]
    fn stacked_presets_compose_in_order() {
        let cage = paper_cage(3.0, [4, 4]);
        let wave = Preset::Crumple { amplitude: from_mm(1.0), waves: [1.0, 0.0], phase: 0.3 };
        let twist = Preset::Twist { amplitude: 0.0, rate: 10.0 };
        let both = pose(&cage, &[wave, twist]).expect("valid");
        let by_hand = cage.mesh.vertices.iter().map(|&p| twist.map(&cage, wave.map(&cage, p)));
        for (a, b) in both.iter().zip(by_hand) {
            assert!(a.distance(b) < 1e-15, "twist after wave");
        }
    }
}
