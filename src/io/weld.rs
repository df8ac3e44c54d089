//! Corners that agree bit for bit become one vertex; solids that share facets become one complex.

use super::IoError;
use crate::geometry::{DVec3, FaceId, Facet, Plc, PlcError, Region, RegionId, RegionRole, SurfaceError, VertexId};
use crate::units::MM;
use std::collections::HashMap;
use std::path::Path;

/// Vertices found so far, by the bits of their coordinates.
#[derive(Debug, Default)]
pub(super) struct Weld {
    pub(super) vertices: Vec<DVec3>,
    ids: HashMap<[u64; 3], VertexId>,
}

impl Weld {
    /// The vertex at this very position.
    pub(super) fn vertex(&mut self, position: DVec3) -> VertexId {
        let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
        *self.ids.entry(key).or_insert_with(|| {
            self.vertices.push(position);
            VertexId::new(self.vertices.len() - 1)
        })
    }
}

/// Corners sorted: what a facet is called when its direction does not matter.
pub(super) fn undirected(mut face: [VertexId; 3]) -> [VertexId; 3] {
    face.sort_unstable();
    face
}

/// True if the two faces with the same corners run around them in opposite directions.
pub(super) fn are_opposite(a: [VertexId; 3], b: [VertexId; 3]) -> bool {
    let [x, y, z] = a;
    let reversed = [x, z, y];
    (0..3).any(|k| b == [reversed[k], reversed[(k + 1) % 3], reversed[(k + 2) % 3]])
}

/// One solid as read from a file: outward triangles, m.
#[derive(Debug)]
pub(super) struct LooseSolid {
    pub(super) region: Region,
    pub(super) triangles: Vec<[DVec3; 3]>,
}

/// Joins closed solids into one complex: a facet that two of them have, bit for bit, becomes one with a region on each
/// side; all others bound the air.
pub(super) fn join(solids: Vec<LooseSolid>, path: &Path) -> Result<Plc, IoError> {
    let air = Region { name: "air".to_owned(), role: RegionRole::Air, eps_r: 1.0, tan_delta: 0.0 };
    let mut regions = vec![air];
    let mut weld = Weld::default();
    let mut facets: Vec<Facet> = Vec::new();
    let mut known = HashMap::new();
    for solid in solids {
        let region = RegionId::new(regions.len());
        for corners in &solid.triangles {
            let vertices = corners.map(|p| weld.vertex(p));
            let facet = FaceId::new(facets.len());
            let [a, b, c] = vertices;
            if a == b || b == c || c == a {
                let source = SurfaceError::Degenerate { face: facet };
                let source = PlcError::Open { region: solid.region.name.clone(), source };
                return Err(IoError::NotAComplex { path: path.to_owned(), source });
            }
            let first = *known.entry(undirected(vertices)).or_insert(facet);
            if first == facet {
                facets.push(Facet { vertices, back: region, front: RegionId::AIR });
                continue;
            }
            let other = &mut facets[first.index()];
            if other.front != RegionId::AIR || other.back == region || !are_opposite(other.vertices, vertices) {
                let place_mm = (corners[0] / MM).to_array();
                return Err(IoError::Overlap { path: path.to_owned(), region: solid.region.name, place_mm });
            }
            other.front = region;
        }
        regions.push(solid.region);
    }
    let plc = Plc { vertices: weld.vertices, facets, regions };
    plc.check().map_err(|source| IoError::NotAComplex { path: path.to_owned(), source })?;
    Ok(plc)
}
