//! The field at the edge of a thin sheet, which no linear function follows.
//!
//! Near the edge of a sheet without thickness the fields across it grow as `r^-1/2`. Whitney functions on cells of size
//! h cannot follow; they store too much electric energy there (too much capacitance) and too much magnetic energy for a
//! given voltage (too little inductance), both in proportion to h: the sheet looks 0.3 to 0.4 h larger than it is, and a
//! patch resonates some percent too low. The remedy is local: in the cells at the edge the permittivity and the inverse
//! permeability are multiplied by [`PERMITTIVITY`] and [`RELUCTIVITY`], so that these cells hold the energy of the true
//! field.
//!
//! Both factors follow from the edge alone. `u = r^1/2 cos(θ/2)` is the potential across the edge of a half-plane, and
//! equally the vector potential along it. With exact values on a surrounding surface, the potential in linear elements
//! and the vector potential in Whitney functions are solved with the factor as the unknown, until their energy is that
//! of u. In tetrahedra of this mesher around straight edges of sheets, at three densities, the factors are 0.65 to 0.66
//! and 0.72 to 0.74, whatever the size of the cells; dielectrics on the two sides do not matter, since u is even in θ.
//! That they hold for whole fields is tested on a cylinder with a radial sheet, whose resonances are roots of `J_1/2` and
//! its derivative.

use crate::geometry::VertexId;
use crate::tet::{FaceRole, TetMesh};
use std::collections::{HashMap, HashSet};

/// Factor of the permittivity in cells with a vertex on the edge of a sheet.
pub(super) const PERMITTIVITY: f64 = 0.655;
/// Factor of the inverse permeability there.
pub(super) const RELUCTIVITY: f64 = 0.738;

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
