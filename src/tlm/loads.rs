//! What is in a mesh beside perfect conductors and dielectrics: lossy sheets, resistors, magnetic materials.

use super::TlmError;
use crate::geometry::{RegionId, VertexId};
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
        self.permeable.iter().try_for_each(|(_, mu_r)| positive("a relative permeability", *mu_r))
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
