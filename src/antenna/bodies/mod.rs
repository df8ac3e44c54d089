//! Closed bodies of any shape, welded into one surface complex in which bodies that touch share their interface.
//!
//! Enters: bodies, each a closed triangle surface, and how far apart two places may be and still be one. Leaves: a
//! [`Plc`] in which each facet knows the bodies on both its sides, or every reason why there is none, with the places.
//!
//! 1. Vertices within the tolerance become one; what collapses is dropped; a body that is inside out is turned.
//! 2. Where a vertex lies on an edge or in a face of any body, or two edges cross, there is a node on both
//!    (`imprint`).
//! 3. Each face with nodes is cut along all edges that lie in it; the cells that two bodies have in common are
//!    triangulated once for both (`cells`). A facet that two bodies have is then the same three vertices.
//! 4. What is left is checked: each body closed, no facet on the same side of two bodies, no two facets that cross, no
//!    body within another.
//!
//! Nothing moves but the vertices that become one, so a face bends by at most the tolerance. Not handled: faces of one
//! body that are turned against each other, and overlaps, which are refused and not cut.

mod cells;
mod fault;
mod foil;
pub mod gap;
mod imprint;
mod inspect;
#[cfg(test)]
pub(crate) mod tests;

pub use fault::{BodyFault, WeldError};
pub use foil::{WithSheets, with_sheets};
pub use gap::{Gap, GapError, gap, upright};

use super::Dielectric;
use crate::geometry::{DVec3, Facet, Plc, Region, RegionId, RegionRole, TriMesh, VertexId};
use crate::task::{Cancelled, Task};
use imprint::Merge;
use std::collections::HashMap;

/// More triangles than this are no flat antenna, and every step of the editor would be slow with them.
pub const MAX_TRIANGLES: usize = 200_000;

/// Items between two looks at the task: some milliseconds.
const STRIDE: usize = 1024;

/// One body as drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// What it is called; the name of its region.
    pub name: String,
    /// Dielectric or conductor.
    pub role: RegionRole,
    /// What it is made of; vacuum for a conductor.
    pub material: Dielectric,
    /// Its surface, m.
    pub surface: TriMesh,
}

impl Body {
    /// The region it becomes.
    #[must_use]
    pub fn region(&self) -> Region {
        let Dielectric { eps_r, tan_delta } = self.material;
        Region { name: self.name.clone(), role: self.role, eps_r, tan_delta }
    }
}

/// Faces of all bodies over common vertices.
#[derive(Debug)]
struct Soup {
    vertices: Vec<DVec3>,
    faces: Vec<Face>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Face {
    corners: [usize; 3],
    body: usize,
}

/// Welds bodies into one complex: the air, then a region for each body in their order.
///
/// * `places`: become vertices where they lie on a surface, m.
/// * `tolerance`: distance within which two places are one, m; well above rounding, well below the thinnest part.
///
/// # Errors
/// [`WeldError::Faults`]: everything that is wrong, with the places. [`WeldError::Cancelled`].
pub fn weld(bodies: &[Body], places: &[DVec3], tolerance: f64, task: &Task) -> Result<Plc, WeldError> {
    let (mut soup, mut merge) = gather(bodies, tolerance).map_err(WeldError::Faults)?;
    for &place in places {
        merge.vertex(place, &mut soup.vertices);
    }
    let nodes = imprint::imprint(&mut soup, merge, tolerance, task)?;
    let (faces, mut faults) = cells::cut(&soup, &nodes, bodies, task)?;
    let plc = join(&soup.vertices, &faces, bodies, &mut faults);
    if faults.is_empty() {
        faults = inspect::inspect(&plc, task)?;
    }
    if faults.is_empty() {
        faults.extend(plc.check().err().map(BodyFault::Complex));
    }
    if faults.is_empty() { Ok(plc) } else { Err(WeldError::Faults(faults)) }
}

/// The items of a slice, as a phase of a task that is looked at now and then.
fn watched<'a, T>(
    name: &'static str,
    items: &'a [T],
    task: &'a Task,
) -> impl Iterator<Item = Result<(usize, &'a T), Cancelled>> {
    let phase = task.phase(name, items.len());
    items.iter().enumerate().map(move |(k, item)| {
        if k % STRIDE == 0 {
            task.check()?;
            phase.advance(STRIDE.min(k));
        }
        Ok((k, item))
    })
}

/// All faces over merged vertices; bodies that are inside out are turned.
fn gather(bodies: &[Body], tolerance: f64) -> Result<(Soup, Merge), Vec<BodyFault>> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(vec![BodyFault::Tolerance { tolerance }]);
    }
    let count = bodies.iter().map(|b| b.surface.faces.len()).sum();
    if bodies.is_empty() || count > MAX_TRIANGLES {
        return Err(vec![BodyFault::Count { bodies: bodies.len(), triangles: count }]);
    }
    let mut merge = Merge::new(tolerance);
    let (mut soup, mut faults) = (Soup { vertices: Vec::new(), faces: Vec::new() }, Vec::new());
    for (body, Body { name, surface, .. }) in bodies.iter().enumerate() {
        if surface.vertices.iter().any(|p| !p.is_finite()) {
            faults.push(BodyFault::NotFinite { body: name.clone() });
            continue;
        }
        let own: Vec<usize> = surface.vertices.iter().map(|&p| merge.vertex(p, &mut soup.vertices)).collect();
        let is_inside_out = surface.volume() < 0.0;
        let before = soup.faces.len();
        for face in &surface.faces {
            let [a, b, c] = face.map(|v| own[v.index()]);
            if a != b && b != c && c != a {
                soup.faces.push(Face { corners: if is_inside_out { [a, c, b] } else { [a, b, c] }, body });
            }
        }
        if soup.faces.len() == before {
            faults.push(BodyFault::Empty { body: name.clone() });
        }
    }
    if faults.is_empty() { Ok((soup, merge)) } else { Err(faults) }
}

/// Facets with the bodies on both sides; where two bodies or two parts of one claim the same side, a fault.
fn join(vertices: &[DVec3], faces: &[Face], bodies: &[Body], faults: &mut Vec<BodyFault>) -> Plc {
    let air = Region { name: "air".to_owned(), role: RegionRole::Air, eps_r: 1.0, tan_delta: 0.0 };
    let regions = std::iter::once(air).chain(bodies.iter().map(Body::region)).collect();
    let mut plc = Plc { vertices: Vec::new(), facets: Vec::with_capacity(faces.len()), regions };
    let mut number = vec![None; vertices.len()];
    let mut known: HashMap<[VertexId; 3], usize> = HashMap::with_capacity(faces.len());
    let mut clashes = inspect::Clashes::default();
    for face in faces {
        let corners = face.corners.map(|v| {
            *number[v].get_or_insert_with(|| {
                plc.vertices.push(vertices[v]);
                VertexId::new(plc.vertices.len() - 1)
            })
        });
        let region = RegionId::new(face.body + 1);
        let mut key = corners;
        key.sort_unstable();
        let Some(&first) = known.get(&key) else {
            known.insert(key, plc.facets.len());
            plc.facets.push(Facet { vertices: corners, back: region, front: RegionId::AIR });
            continue;
        };
        let other = &mut plc.facets[first];
        let is_opposite = (0..3).any(|k| [corners[k], corners[(k + 2) % 3], corners[(k + 1) % 3]] == other.vertices);
        if is_opposite && other.front == RegionId::AIR && other.back != region {
            other.front = region;
        } else {
            let place = face.corners.iter().map(|&v| vertices[v]).sum::<DVec3>() / 3.0;
            clashes.add([other.back, region], place);
        }
    }
    faults.extend(clashes.into_faults(&plc.regions));
    plc
}
