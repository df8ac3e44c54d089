//! A closed surface of the mesh around the antenna, on which the field says everything about the outside.
//!
//! A [`TetMesh`] enters; a [`Huygens`] leaves: which cells are inside, and the triangles between them and the others.
//! Inside are the cells whose centroid lies within a sphere that holds all conductors and all that is not air, and
//! leaves air on both sides. That the surface is rough does not matter to the weak form in which it is used.
//!
//! By the equivalence principle the field outside is that of the currents `J = n x H` and `M = -n x E` on the surface,
//! n outward. E is known by the voltages `V_e` of the surface's edges. H is not taken from cells, where it is only of
//! first order, but weakly: multiply `curl H = ε dE/dt` by the Whitney function `w_e` and integrate over the inside,
//!
//! ```text
//! ∫ ε dE/dt · w_e dV - ∫ H · curl w_e dV = ∮ w_e · (n x H) dS
//! ```
//!
//! The left side, summed over the inside cells at e, is what their own circuits take up beyond their own curl: the
//! currents that flow into their ports from e. A port's line brings back `V_e` less what the cell sent, so the current
//! at the line's edge end is `Y (V_e - 2 u_out) = Y V_e - 2 p`, at the same instant as `V_e`. Hence
//!
//! ```text
//! J_e = ∮ w_e · J dS = sum over inside cells at e of Y V_e - 2 p,    power outward = -1/2 Re sum_e V_e conj(J_e)
//! ```
//!
//! Lines and stubs take no power on average: this power, what is lost inside, and what the port takes in balance
//! exactly, whatever the mesh. And a smooth field a tested with J is `∫ a · J dS = sum_e J_e ∫_e a·dl`, since the
//! Whitney functions interpolate a by its integrals along edges.
//!
//! Not handled: an antenna whose conductors reach the outer boundary.
//!
//! Sources: \[LOV01\], \[BOS98\] (Whitney forms).

use super::TlmError;
use crate::geometry::{DVec3, VertexId};
use crate::tet::{FaceRole, MarkedFace, Tet, TetMesh, face_key};
use std::collections::{HashMap, HashSet};

/// A closed surface of triangles and the edges on which its field is known.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedSurface {
    /// Positions, m.
    pub points: Vec<DVec3>,
    /// Corners, counter-clockwise seen from outside.
    pub faces: Vec<[usize; 3]>,
    /// Ends, the lower number first: the direction along which the edge's voltage counts.
    pub edges: Vec<[usize; 2]>,
    /// Edges of each face: between its corners 0 and 1, 1 and 2, 2 and 0.
    pub edges_of: Vec<[usize; 3]>,
}

impl ClosedSurface {
    /// A surface with its edges.
    #[must_use]
    pub fn new(points: Vec<DVec3>, faces: Vec<[usize; 3]>) -> Self {
        let mut number: HashMap<[usize; 2], usize> = HashMap::new();
        let mut edges = Vec::new();
        let mut edge = |a: usize, b: usize| {
            let ends = [a.min(b), a.max(b)];
            *number.entry(ends).or_insert_with(|| {
                edges.push(ends);
                edges.len() - 1
            })
        };
        let edges_of = faces.iter().map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]).collect();
        Self { points, faces, edges, edges_of }
    }
}

/// The closed surface in its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Huygens {
    /// The surface.
    pub surface: ClosedSurface,
    /// Vertex of the mesh for each of the surface's points, ascending.
    pub(super) vertices: Vec<VertexId>,
    /// By cell of the mesh.
    pub(super) inside: Vec<bool>,
}

/// Where the sphere lies in the room between the antenna and the outer boundary: some cells away from both at every
/// density.
const SHARE: f64 = 0.35;

impl Huygens {
    /// The surface around everything that is not air, within the outer boundary.
    ///
    /// # Errors
    /// [`TlmError::NoRoom`] if there is too little air between the two.
    pub fn new(mesh: &TetMesh) -> Result<Self, TlmError> {
        let role = |f: &MarkedFace| mesh.groups[f.group].role;
        let (outer, marked): (Vec<&MarkedFace>, Vec<&MarkedFace>) =
            mesh.faces.iter().partition(|f| role(f) == FaceRole::Outer);
        let is_outer: HashSet<_> = outer.iter().map(|f| face_key(f.vertices)).collect();
        let at_rim = |t: &&Tet| (0..4).any(|i| is_outer.contains(&face_key(t.face(i))));
        let air = mesh.tets.iter().find(at_rim).ok_or(TlmError::NoRoom { room: 0.0 })?.region;
        let parts = mesh.tets.iter().filter(|t| t.region != air).flat_map(|t| t.vertices);
        let held: Vec<VertexId> = parts.chain(marked.iter().flat_map(|f| f.vertices)).collect();
        let at = |v: &VertexId| mesh.vertices[v.index()];
        let (lo, hi) =
            held.iter().map(at).fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let center = (lo + hi) / 2.0;
        let reach = held.iter().map(|v| at(v).distance(center)).fold(0.0, f64::max);
        let limit =
            outer.iter().flat_map(|f| &f.vertices).map(|v| at(v).distance(center)).fold(f64::INFINITY, f64::min);
        let found = Self::sphere(mesh, center, reach + SHARE * (limit - reach));
        let mut is_held = vec![false; mesh.vertices.len()];
        held.iter().chain(outer.iter().flat_map(|f| &f.vertices)).for_each(|v| is_held[v.index()] = true);
        if found.surface.faces.is_empty() || found.vertices.iter().any(|v| is_held[v.index()]) {
            return Err(TlmError::NoRoom { room: limit - reach });
        }
        Ok(found)
    }

    /// The surface of all cells with their centroid within a sphere.
    ///
    /// * `center`, `radius`: of the sphere, m.
    #[must_use]
    pub fn sphere(mesh: &TetMesh, center: DVec3, radius: f64) -> Self {
        let centroid = |t: usize| mesh.corners(t).iter().sum::<DVec3>() / 4.0;
        let inside: Vec<bool> = (0..mesh.tets.len()).map(|t| centroid(t).distance(center) < radius).collect();
        // Faces of outside cells, by their corners.
        let outside = mesh.tets.iter().zip(&inside).filter(|(_, inside)| !**inside);
        let beyond: HashSet<_> = outside.flat_map(|(t, _)| (0..4).map(|i| face_key(t.face(i)))).collect();
        let within = mesh.tets.iter().zip(&inside).filter(|(_, inside)| **inside);
        let faces: Vec<[VertexId; 3]> =
            within.flat_map(|(t, _)| (0..4).map(|i| t.face(i))).filter(|f| beyond.contains(&face_key(*f))).collect();
        let mut vertices: Vec<VertexId> = faces.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number: HashMap<VertexId, usize> = vertices.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let points = vertices.iter().map(|v| mesh.vertices[v.index()]).collect();
        let surface = ClosedSurface::new(points, faces.iter().map(|f| f.map(|v| number[&v])).collect());
        Self { surface, vertices, inside }
    }

    /// Ends of an edge of the surface as vertices of the mesh, ascending.
    pub(super) fn ends(&self, edge: usize) -> [VertexId; 2] {
        self.surface.edges[edge].map(|p| self.vertices[p])
    }
}
