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

/// A source with a resistance across a gap between conductors.
#[derive(Clone, Debug, PartialEq)]
pub struct LumpedPort {
    /// Vertices of the mesh from one side of the gap to the other, each joined to the next by an edge.
    pub chain: Vec<VertexId>,
    /// Of the source, ohm.
    pub resistance: f64,
}

impl Resistor {
    /// A resistance shared by the edges of a chain of vertices in proportion to their length.
    #[must_use]
    pub fn along(mesh: &TetMesh, chain: &[VertexId], resistance: f64) -> Vec<Self> {
        let length = |pair: &[VertexId]| mesh.vertices[pair[0].index()].distance(mesh.vertices[pair[1].index()]);
        let total: f64 = chain.windows(2).map(length).sum();
        let share = |pair: &[VertexId]| Self {
            edge: [pair[0].min(pair[1]), pair[0].max(pair[1])],
            resistance: resistance * length(pair) / total,
        };
        chain.windows(2).map(share).collect()
    }
}

/// Loads of a mesh; by default there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// Conductors that are lossy sheets: name of the group, and ohm per square.
    pub sheets: Vec<(String, f64)>,
    /// Resistors at edges.
    pub resistors: Vec<Resistor>,
    /// Where the antenna is fed if not by a line; what the source's own resistance takes is not counted as lost.
    pub port: Option<LumpedPort>,
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
        self.port.iter().try_for_each(|port| positive("the source's resistance", port.resistance))?;
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
