//! The field at the edge of a thin sheet, which no linear function follows.
//!
//! Near the edge of a sheet without thickness the fields across it grow as `r^-1/2`. Whitney functions on cells of size
//! h cannot follow; they store too much electric energy there (too much capacitance) and too much magnetic energy for a
//! given voltage (too little inductance), both in proportion to h: the sheet looks about 0.4 h larger than it is, and a
//! patch resonates some percent too low. The remedy is local: in the cells at the edge the permittivity and the inverse
//! permeability are multiplied by [`SHARE`], so that these cells hold the energy of the true field. The velocity of
//! light stays as it is, and so does the time step.
//!
//! The share follows from the edge alone. For `u = r^1/2 cos(θ/2)`, which is the potential across the edge of a
//! half-plane, and equally the electric field along it, linear elements with exact values on a surrounding surface are
//! solved with the share as the unknown, until their energy is that of u. On tetrahedra of this mesher around straight
//! sheet edges it is 0.62 to 0.67, whatever the size of the cells; dielectrics on the two sides do not matter, since u is
//! even in θ. That it holds for whole fields is tested on a cylinder with a radial sheet, whose resonances are known:
//! `J_1/2` and its derivative.

use crate::geometry::VertexId;
use crate::tet::{FaceRole, TetMesh};
use std::collections::{HashMap, HashSet};

/// Factor of permittivity and inverse permeability in cells with a vertex on the edge of a sheet.
pub(super) const SHARE: f64 = 0.65;

/// Vertices at the edges of sheets: of edges with one conducting face, away from the port and the outer boundary.
pub(super) fn rim(mesh: &TetMesh) -> HashSet<VertexId> {
    let mut conducting: HashMap<[VertexId; 2], usize> = HashMap::new();
    let mut closed: HashSet<[VertexId; 2]> = HashSet::new();
    for face in &mesh.faces {
        for k in 0..3 {
            let (a, b) = (face.vertices[k], face.vertices[(k + 1) % 3]);
            let edge = [a.min(b), a.max(b)];
            match mesh.groups[face.group].role {
                FaceRole::Conductor => *conducting.entry(edge).or_default() += 1,
                FaceRole::Port | FaceRole::Outer => {
                    closed.insert(edge);
                }
            }
        }
    }
    let open = conducting.into_iter().filter(|(edge, count)| *count == 1 && !closed.contains(edge));
    open.flat_map(|(edge, _)| edge).collect()
}
