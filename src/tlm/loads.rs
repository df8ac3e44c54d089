//! What is in a mesh beside perfect conductors and dielectrics: lossy sheets, resistors, magnetic materials, absorber.

use super::TlmError;
use crate::geometry::{DVec3, RegionId, VertexId};
use crate::tet::{FaceRole, TetMesh};

/// A resistor along an edge of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistor {
    /// Its ends, ascending.
    pub edge: [VertexId; 2],
    /// Ohm.
    pub resistance: f64,
}

/// Loads of a mesh; by default there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// Conductors that are lossy sheets: name of the group, and ohm per square.
    pub sheets: Vec<(String, f64)>,
    /// Resistors at edges.
    pub resistors: Vec<Resistor>,
    /// Relative permeability of regions where it is not 1.
    pub permeable: Vec<(RegionId, f64)>,
    /// Thickness of the absorbing layer before the outer boundary, m: matched to the air, graded from nothing.
    pub absorber: Option<f64>,
}

impl Loads {
    /// Whether every load is physical and belongs to something in the mesh.
    pub(super) fn check(&self, mesh: &TetMesh) -> Result<(), TlmError> {
        for (name, resistance) in &self.sheets {
            let is_there = mesh.groups.iter().any(|g| g.name == *name && g.role == FaceRole::Conductor);
            if !is_there {
                return Err(TlmError::NoSheet { name: name.clone() });
            }
            positive("the surface resistance", *resistance)?;
        }
        self.resistors.iter().try_for_each(|r| positive("a resistor", r.resistance))?;
        self.permeable.iter().try_for_each(|(_, mu_r)| positive("a relative permeability", *mu_r))?;
        self.absorber.map_or(Ok(()), |thickness| positive("the thickness of the absorber", thickness))
    }

    pub(super) fn sheet_resistance(&self, group: &str) -> Option<f64> {
        self.sheets.iter().find(|(name, _)| name == group).map(|(_, resistance)| *resistance)
    }

    pub(super) fn mu_r(&self, region: RegionId) -> f64 {
        self.permeable.iter().find(|(r, _)| *r == region).map_or(1.0, |(_, mu_r)| *mu_r)
    }
}

fn positive(what: &'static str, value: f64) -> Result<(), TlmError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(TlmError::NotPositive { what, value }) }
}

/// Reflection that the absorbing layer would have by itself at normal incidence; what comes through meets the outer
/// boundary, which absorbs most of it. Less makes the profile steep, which reflects in coarse cells.
const REFLECTION: f64 = 0.02;

/// A spherical shell in which electric and magnetic losses rise together, so that nothing is reflected at its face.
///
/// With `σ/ε = σ_m/µ = s(r)` a plane wave decays as `exp(-∫ s dr / c)` without reflection, and a spherical one nearly so.
#[derive(Clone, Copy, Debug)]
pub(super) struct Absorber {
    center: DVec3,
    /// Where it begins, and its thickness, m.
    start: f64,
    thickness: f64,
}

impl Absorber {
    /// The layer before the outer boundary of a mesh, which is taken for a sphere; `None` if there is none.
    pub(super) fn new(mesh: &TetMesh, thickness: f64) -> Option<Self> {
        let outer = mesh.faces.iter().filter(|f| mesh.groups[f.group].role == FaceRole::Outer);
        let points: Vec<DVec3> = outer.flat_map(|f| f.vertices).map(|v| mesh.vertices[v.index()]).collect();
        let first = *points.first()?;
        let (lo, hi) = points.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let center = (lo + hi) / 2.0;
        let radius = points.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        Some(Self { center, start: radius - thickness, thickness })
    }

    /// Rate of decay with length at a place, 1/m.
    pub(super) fn rate(&self, at: DVec3) -> f64 {
        let depth = ((at.distance(self.center) - self.start) / self.thickness).clamp(0.0, 1.0);
        // There and back through a quadratic profile: 2/3 of the greatest rate times the thickness.
        -REFLECTION.ln() * 1.5 / self.thickness * depth * depth
    }
}
