//! Which region every tetrahedron belongs to: the walls say so on both sides, and what hangs together is one region.

use super::delaunay::Triangulation;
use super::error::TetError;
use super::store::FACE;
use super::surface::{Surface, SurfaceFacet};
use crate::geometry::{RegionId, TetId};

/// Sets the region of every tetrahedron; all facets must be walls already.
///
/// # Errors
/// [`TetError::Leak`] where two regions meet without a wall.
pub(super) fn classify(mesh: &mut Triangulation, facets: &[SurfaceFacet], surface: &Surface) -> Result<(), TetError> {
    let n_slots = mesh.store.tets().map(|t| t.index() + 1).max().unwrap_or(0);
    let mut region: Vec<Option<RegionId>> = vec![None; n_slots];
    let mut open: Vec<TetId> = Vec::new();
    // The hull lies outside of everything.
    let mut seeds: Vec<(TetId, RegionId, Option<usize>)> = mesh
        .store
        .tets()
        .filter(|&t| (0..4).any(|i| mesh.store.neighbor(t, i) == TetId::NONE))
        .map(|t| (t, RegionId::default(), None))
        .collect();
    let mut star = Vec::new();
    for (f, facet) in facets.iter().enumerate() {
        let Some(t) = mesh.store.tet_with(&facet.vertices, &mut star) else { continue };
        let opposite = FACE.iter().position(|c| c.iter().all(|&k| facet.vertices.contains(&mesh.store.corners(t)[k])));
        let Some(i) = opposite else { continue };
        // Face i is positive with corner i: its even permutations have the tetrahedron before them.
        let before = is_rotation(mesh.store.face(t, i), facet.vertices);
        let (here, there) = if before { (facet.front, facet.back) } else { (facet.back, facet.front) };
        seeds.push((t, here, Some(f)));
        let beyond = mesh.store.neighbor(t, i);
        if beyond != TetId::NONE {
            seeds.push((beyond, there, Some(f)));
        }
    }
    for (seed, wanted, facet) in seeds {
        match region[seed.index()] {
            Some(found) if found != wanted => {
                let name =
                    |r: RegionId| surface.regions.get(r.index()).map_or_else(|| r.to_string(), |r| r.name.clone());
                let corners = facet.map_or_else(|| mesh.store.face(seed, 0), |f| facets[f].vertices);
                let center = corners.map(|v| mesh.point(v)).iter().sum::<crate::geometry::DVec3>() / 3.0;
                return Err(TetError::Leak { places: vec![center], first: name(found), second: name(wanted) });
            }
            Some(_) => continue,
            None => region[seed.index()] = Some(wanted),
        }
        open.push(seed);
        while let Some(t) = open.pop() {
            for i in 0..4 {
                let beyond = mesh.store.neighbor(t, i);
                if beyond != TetId::NONE && !mesh.store.is_wall(t, i) && region[beyond.index()].is_none() {
                    region[beyond.index()] = Some(wanted);
                    open.push(beyond);
                }
            }
        }
    }
    for (t, region) in region.into_iter().enumerate() {
        if let Some(region) = region {
            mesh.store.set_region(TetId::new(t), region);
        }
    }
    Ok(())
}

/// True if the two triples are cyclic rotations of each other.
fn is_rotation<T: PartialEq + Copy>(p: [T; 3], q: [T; 3]) -> bool {
    (0..3).any(|k| p == [q[k], q[(k + 1) % 3], q[(k + 2) % 3]])
}
