//! The antenna as a block of tetrahedra: layers of prisms, split and carried through a map.
//!
//! Enters: the parameters of the flat antenna, edge lengths, and the map of the deformation. Leaves: positive
//! tetrahedra of all parts, each with its region, and the marked faces of conductors and of the port; [`Block::skin`]
//! is the surface that the air around it meets.
//!
//! 1. All outlines (ground, patch, pin, outer conductor) are cut where they cross, divided, and triangulated together,
//!    with a point for each resistor.
//! 2. The triangles are extruded through the layers: the coaxial line, the substrate, and the metal if it is solid; a
//!    resistor's point becomes a chain of edges through the substrate.
//! 3. The map carries the vertices.
//! 4. Each prism becomes three tetrahedra whose diagonals agree with its neighbors', chosen for their angles; one that
//!    the map turns over is an error with its place.
//!
//! Parts share their interfaces because they share the triangles. Without thickness the metal is a sheet of marked
//! faces: foil as thin as a real patch's caps the quality of every mesh and with it the time step.
//!
//! The vertices and their numbers depend on parameters and settings, not on the map; the diagonals may.
//!
//! Not handled: outlines that meet at a sharp angle or leave a narrow gap (a circle that barely clears the rim) bound
//! the angles there; a map that makes distant parts of the block intersect is not seen here.

mod draft;
mod footprint;
mod layers;
mod marks;
mod outlines;
mod prisms;
mod seeds;
mod sizing;

use super::{FaceGroup, MarkedFace, MeshFault, Tet};
use crate::antenna::{COAX, Dielectric, GROUND, PATCH, PIN, ParamError, PatchParams, SUBSTRATE};
use crate::geometry::predicates::orient3d;
use crate::geometry::{DVec3, Region, RegionRole, SurfaceError, TriMesh, VertexId};
use crate::units::to_mm;
use layers::Layers;
use prisms::Prisms;

const SUBSTRATE_ID: usize = 2;
const COAX_ID: usize = 3;
const PIN_ID: usize = 4;
const PATCH_ID: usize = 5;
const GROUND_ID: usize = 6;

/// What the patch and the ground are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metal {
    /// Sheets without thickness: marked faces of the substrate.
    #[default]
    Sheet,
    /// Bodies of their true thickness.
    Solid,
}

/// How finely the block is divided, and what of the antenna it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockSettings {
    /// Edge length at the patch's rim, m; it rules the accuracy of the field.
    pub rim: f64,
    /// Edge length far from it, m: a tenth above the mean, and three quarters of the longest.
    pub inner: f64,
    /// Layers of the substrate, at least one.
    pub layers: usize,
    /// What patch and ground are made of.
    pub metal: Metal,
    /// True if the antenna has its pin and its coaxial line; without them nothing feeds it.
    pub coax: bool,
}

/// The antenna's tetrahedra, those of conductors included.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Positions, m; each used by at least one tetrahedron.
    pub vertices: Vec<DVec3>,
    /// Where each vertex is in the flat antenna, m.
    pub flat: Vec<DVec3>,
    /// Tetrahedra.
    pub tets: Vec<Tet>,
    /// Faces of conductors and of the port, each once; its normal points out of the conductor or sheath, and for a
    /// sheet out of the substrate.
    pub faces: Vec<MarkedFace>,
    /// Regions: outside, air, substrate, coax, pin, and with solid metal patch and ground; a region may be empty.
    pub regions: Vec<Region>,
    /// For each resistor a chain of edges through the substrate: its vertices from the ground up to the patch.
    pub posts: Vec<Vec<VertexId>>,
    /// Groups: `pec_patch`, `pec_ground`, `pec_feed`, `port1`, and `outer`, which has no face here.
    pub groups: Vec<FaceGroup>,
}

/// Why there is no block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// A parameter is wrong.
    #[error(transparent)]
    Param(#[from] ParamError),
    /// An edge length is not positive and finite.
    #[error("the edge length {field} must be positive, but is {value_mm} mm", value_mm = to_mm(*value))]
    Length {
        /// Name of the setting.
        field: &'static str,
        /// Its value, m.
        value: f64,
    },
    /// No layers.
    #[error("the substrate needs at least one layer")]
    NoLayers,
    /// More points than a mesh of any use has.
    #[error(
        "the footprint would have about {n_points:.0} points: increase the edge lengths, or use fewer segments for \
         the circles of the feed"
    )]
    TooFine {
        /// Points expected of the footprint.
        n_points: f64,
    },
    /// The outlines could not be triangulated.
    #[error("the antenna's outlines could not be triangulated: two of them nearly touch; move the feed a little")]
    Outlines,
    /// The map turns tetrahedra over.
    #[error(
        "the deformation folds the antenna at ({x_mm:.3}, {y_mm:.3}, {z_mm:.3}) mm, flat ({flat_x_mm:.3}, \
         {flat_y_mm:.3}, {flat_z_mm:.3}) mm, and in {n_folded} tetrahedra in all: bend it less there, or use larger \
         edge lengths",
        x_mm = to_mm(at.x), y_mm = to_mm(at.y), z_mm = to_mm(at.z),
        flat_x_mm = to_mm(flat.x), flat_y_mm = to_mm(flat.y), flat_z_mm = to_mm(flat.z)
    )]
    Folded {
        /// Center of the first such tetrahedron, m.
        at: DVec3,
        /// The same in the flat antenna, m.
        flat: DVec3,
        /// How many there are.
        n_folded: usize,
    },
}

/// An invariant that a block breaks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockFault {
    /// One of its tetrahedra or marked faces.
    #[error(transparent)]
    Mesh(#[from] MeshFault),
    /// Its skin is not closed.
    #[error("the skin of the block is not closed: {0}")]
    Skin(#[from] SurfaceError),
}

/// Builds the block and carries it through a map from flat to deformed positions, m, one for each.
///
/// # Errors
/// [`BlockError`] if parameters or settings are not valid, the outlines cannot be triangulated, or the map folds the
/// block; and the map's own error.
///
/// # Panics
/// If the map returns another number of positions.
pub fn build<E: From<BlockError>>(
    params: &PatchParams,
    settings: &BlockSettings,
    carry: impl FnOnce(&[DVec3]) -> Result<Vec<DVec3>, E>,
) -> Result<Block, E> {
    params.validate().map_err(BlockError::from)?;
    let print = footprint::triangulate(params, settings)?;
    let layers = Layers::new(params, settings);
    let prisms = Prisms::new(&print, &layers);
    let vertices = carry(&prisms.flat)?;
    assert_eq!(vertices.len(), prisms.flat.len(), "one new position per vertex");
    let split = prisms.split(&print, &vertices);
    let block = Block {
        vertices,
        faces: marks::mark(&split, &prisms.plane, &print, &layers),
        flat: prisms.flat,
        posts: prisms.posts,
        tets: split.tets,
        regions: regions(params, settings.metal),
        groups: marks::groups(),
    };
    block.refuse_folds()?;
    Ok(block)
}

fn regions(params: &PatchParams, metal: Metal) -> Vec<Region> {
    let region = |name: &str, role, material: Dielectric| Region {
        name: name.to_owned(),
        role,
        eps_r: material.eps_r,
        tan_delta: material.tan_delta,
    };
    let vacuum = Dielectric { eps_r: 1.0, tan_delta: 0.0 };
    let mut regions = vec![
        region("outside", RegionRole::Air, vacuum),
        region("air", RegionRole::Air, vacuum),
        region(SUBSTRATE, RegionRole::Dielectric, params.substrate),
        region(COAX, RegionRole::Dielectric, params.sheath),
        region(PIN, RegionRole::Conductor, vacuum),
    ];
    if metal == Metal::Solid {
        regions.extend([PATCH, GROUND].map(|name| region(name, RegionRole::Conductor, vacuum)));
    }
    regions
}

impl Block {
    /// Corner positions of a tetrahedron, m.
    #[must_use]
    pub fn corners(&self, tet: usize) -> [DVec3; 4] {
        self.tets[tet].vertices.map(|v| self.vertices[v.index()])
    }

    /// The faces of one tetrahedron only, counter-clockwise seen from outside, in the order of the tetrahedra: a closed
    /// surface.
    #[must_use]
    pub fn skin(&self) -> Vec<[VertexId; 3]> {
        let table = marks::face_table(&self.tets);
        let faces = self.tets.iter().flat_map(|tet| (0..4).map(|i| tet.face(i)));
        faces.filter(|&face| table.get(&super::face_key(face)).is_some_and(|sides| sides.1.is_none())).collect()
    }

    /// True if a tetrahedron is positive; one with a position that is no number is not.
    fn is_positive(&self, tet: usize) -> bool {
        let [a, b, c, d] = self.corners(tet);
        orient3d(a, b, c, d) > 0.0
    }

    fn refuse_folds(&self) -> Result<(), BlockError> {
        let mut folded = (0..self.tets.len()).filter(|&t| !self.is_positive(t));
        let Some(first) = folded.next() else { return Ok(()) };
        let center =
            |points: &[DVec3]| self.tets[first].vertices.iter().map(|v| points[v.index()]).sum::<DVec3>() / 4.0;
        Err(BlockError::Folded { at: center(&self.vertices), flat: center(&self.flat), n_folded: 1 + folded.count() })
    }

    /// Checks every invariant: positive tetrahedra of meshed regions, at most two at a face and then on its two sides,
    /// each marked face present once, no loose vertex, a closed skin.
    ///
    /// # Errors
    /// The first [`BlockFault`].
    pub fn check(&self) -> Result<(), BlockFault> {
        let mut used = vec![false; self.vertices.len()];
        let mut sides = std::collections::HashSet::new();
        for (t, tet) in self.tets.iter().enumerate() {
            if !self.is_positive(t) {
                return Err(MeshFault::Inverted { tet: t, at: self.corners(t).iter().sum::<DVec3>() / 4.0 }.into());
            }
            if !(SUBSTRATE_ID..self.regions.len()).contains(&tet.region.index()) {
                return Err(MeshFault::BadRegion { tet: t, region: tet.region }.into());
            }
            tet.vertices.iter().for_each(|v| used[v.index()] = true);
            // A face may come once from each side.
            if !(0..4).all(|i| sides.insert(one_side(tet.face(i)))) {
                return Err(MeshFault::Crowded { tet: t }.into());
            }
        }
        let table = marks::face_table(&self.tets);
        let mut marked = std::collections::HashSet::new();
        for (f, face) in self.faces.iter().enumerate() {
            if !table.contains_key(&super::face_key(face.vertices)) {
                return Err(MeshFault::LooseFace { face: f }.into());
            }
            if !marked.insert(super::face_key(face.vertices)) {
                return Err(MeshFault::MarkedTwice { face: f }.into());
            }
        }
        if let Some(vertex) = used.iter().position(|u| !u) {
            return Err(MeshFault::LooseVertex { vertex }.into());
        }
        Ok(TriMesh { vertices: self.vertices.clone(), faces: self.skin() }.check()?)
    }
}

/// Corners turned so that the first has the lowest number: the identity of one side of a face.
fn one_side([a, b, c]: [VertexId; 3]) -> [VertexId; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests;
