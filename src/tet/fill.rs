//! Fills the regions of a surface with tetrahedra: the stages one after the other.

use super::classify::classify;
use super::delaunay::Triangulation;
use super::error::TetError;
use super::mesh::{MarkedFace, Tet, TetMesh};
use super::optimise::Optimiser;
use super::order::insertion_order;
use super::recover::{Recovery, RecoveryReport, raise_walls};
use super::seeds::seeds;
use super::sizing::{Sizing, SizingSettings};
use super::surface::{Surface, SurfaceFacet};
use crate::geometry::{DVec3, RegionRole, VertexId, intersect};
use crate::task::Task;

/// A filled surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// The mesh. Its regions and groups are the surface's.
    pub mesh: TetMesh,
    /// The facets that bound a filled region, by vertices of the mesh; some are halves of the surface's.
    pub facets: Vec<SurfaceFacet>,
    /// For each vertex of the surface its number in the mesh; `NONE` where it bounds no filled region. New vertices of
    /// halved edges follow, in the order of [`RecoveryReport::splits`].
    pub vertex_of: Vec<VertexId>,
    /// What it took to recover the surface.
    pub recovery: RecoveryReport,
    /// The edge lengths that were wanted.
    pub sizing: Sizing,
}

/// Fills a surface.
///
/// * `inner_points`: points that help the surface's recovery where nothing is filled (the inside of a part that is
///   meshed by other means); they do not appear in the mesh.
///
/// # Errors
/// [`TetError`] with places; a surface that crosses itself is refused beforehand.
pub fn fill(
    surface: &Surface,
    inner_points: &[DVec3],
    settings: SizingSettings,
    task: &Task,
) -> Result<Filled, TetError> {
    refuse_crossings(surface)?;
    let sizing = Sizing::new(surface, settings);
    let mut points = surface.vertices.clone();
    let phase = task.phase("placing points", 1);
    points.extend(seeds(surface, &sizing, task)?);
    points.extend(inner_points.iter().enumerate().filter_map(|(k, &p)| beside_surface(k, p, &sizing)));
    phase.advance(1);
    let mut mesh = triangulate(points, surface.vertices.len(), task)?;
    let mut recovery = Recovery::new(&mut mesh, &surface.facets);
    recovery.run(task)?;
    let (facets, report) = (recovery.facets, recovery.report);
    raise_walls(&mut mesh, &facets)?;
    classify(&mut mesh, &facets, surface)?;
    let is_filled: Vec<bool> =
        surface.regions.iter().enumerate().map(|(r, region)| r != 0 && region.role != RegionRole::Conductor).collect();
    let n_surface = surface.vertices.len();
    let is_fixed = |v: VertexId| v.index() < n_surface || report.splits.iter().any(|s| s.middle == v);
    Optimiser::new(&mut mesh, &is_filled, is_fixed).run(task)?;
    let found = Found { facets: &facets, recovery: report, sizing };
    Ok(extract(&mesh, surface, &is_filled, found))
}

fn refuse_crossings(surface: &Surface) -> Result<(), TetError> {
    let faces: Vec<_> = surface.facets.iter().map(|f| f.vertices).collect();
    let crossings = intersect::crossings(&surface.vertices, &faces);
    if crossings.is_empty() {
        return Ok(());
    }
    let center = |f: usize| faces[f].map(|v| surface.vertices[v.index()]).iter().sum::<DVec3>() / 3.0;
    let places = crossings.iter().take(TetError::MAX_PLACES).map(|c| center(c.first.index())).collect();
    Err(TetError::Crossing { count: crossings.len(), places })
}

/// A point a little beside a given one, where that is not too near the surface: such points come in regular rows, and
/// five of them on one sphere only cost time.
fn beside_surface(k: usize, p: DVec3, sizing: &Sizing) -> Option<DVec3> {
    const JITTER: f64 = 0.12;
    const CLEARANCE: f64 = 0.3;
    let mut random = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut part = || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
    };
    let moved = p + DVec3::new(part(), part(), part()) * (JITTER * sizing.at(p).size);
    let wanted = sizing.at(moved);
    (wanted.distance > CLEARANCE * wanted.size).then_some(moved)
}

/// The Delaunay mesh of all points, of which the first `n_surface` must all be in it.
fn triangulate(points: Vec<DVec3>, n_surface: usize, task: &Task) -> Result<Triangulation, TetError> {
    let order = insertion_order(&points);
    let phase = task.phase("triangulating", order.len());
    let mut mesh = Triangulation::new(points);
    for chunk in order.chunks(4096) {
        task.check()?;
        for &v in chunk {
            let v = VertexId::new(v);
            if !mesh.insert(v) && v.index() < n_surface {
                return Err(TetError::Coincident { places: vec![mesh.point(v)] });
            }
        }
        phase.advance(chunk.len());
    }
    Ok(mesh)
}

/// What the stages found beside the mesh.
struct Found<'a> {
    facets: &'a [SurfaceFacet],
    recovery: RecoveryReport,
    sizing: Sizing,
}

/// The filled tetrahedra with the vertices they use, the surface's first.
fn extract(mesh: &Triangulation, surface: &Surface, is_filled: &[bool], found: Found<'_>) -> Filled {
    let Found { facets, recovery, sizing } = found;
    let kept: Vec<_> = mesh.store.tets().filter(|&t| is_filled[mesh.store.region(t).index()]).collect();
    let mut number = vec![VertexId::NONE; mesh.points.len()];
    for &t in &kept {
        mesh.store.corners(t).iter().for_each(|v| number[v.index()] = VertexId::default());
    }
    let mut vertices = Vec::new();
    for (v, number) in number.iter_mut().enumerate().filter(|(_, n)| **n != VertexId::NONE) {
        *number = VertexId::new(vertices.len());
        vertices.push(mesh.points[v]);
    }
    let renumber = |v: VertexId| number[v.index()];
    let tets =
        kept.iter().map(|&t| Tet { vertices: mesh.store.corners(t).map(renumber), region: mesh.store.region(t) });
    let bounds = |f: &&SurfaceFacet| is_filled[f.back.index()] || is_filled[f.front.index()];
    let facets: Vec<SurfaceFacet> =
        facets.iter().filter(bounds).map(|f| SurfaceFacet { vertices: f.vertices.map(renumber), ..*f }).collect();
    let marked = |f: &SurfaceFacet| f.group.map(|group| MarkedFace { vertices: f.vertices, group });
    let surface_vertices = (0..surface.vertices.len()).map(VertexId::new);
    let vertex_of = surface_vertices.chain(recovery.splits.iter().map(|s| s.middle)).map(renumber).collect();
    Filled {
        mesh: TetMesh {
            vertices,
            tets: tets.collect(),
            faces: facets.iter().filter_map(marked).collect(),
            regions: surface.regions.clone(),
            groups: surface.groups.clone(),
        },
        facets,
        vertex_of,
        recovery,
        sizing,
    }
}

#[cfg(test)]
mod tests {
    use super::super::sphere::sphere;
    use super::*;
    use crate::geometry::{Region, RegionId};

    /// A small ball off center in a large one.
    fn balls() -> Surface {
        let mut surface = Surface { vertices: Vec::new(), facets: Vec::new(), regions: Vec::new(), groups: Vec::new() };
        for (r, (center, radius, edge)) in [(DVec3::ZERO, 5.0, 1.0), (DVec3::X, 2.0, 0.3)].into_iter().enumerate() {
            let (points, faces) = sphere(center, radius, edge);
            let first = surface.vertices.len();
            surface.vertices.extend(points);
            surface.facets.extend(faces.iter().map(|f| SurfaceFacet {
                vertices: f.map(|v| VertexId::new(first + v)),
                back: RegionId::new(r + 1),
                front: RegionId::new(r),
                group: None,
            }));
        }
        surface.regions = ["outside", "shell", "core"]
            .map(|n| Region { name: n.to_owned(), role: RegionRole::Dielectric, eps_r: 1.0, tan_delta: 0.0 })
            .into();
        surface
    }

    #[test]
    fn the_mesh_is_whole_after_every_stage() {
        let (surface, task) = (balls(), Task::default());
        let sizing = Sizing::new(&surface, SizingSettings { h_max: 1.0, grading: 0.3 });
        let mut points = surface.vertices.clone();
        points.extend(seeds(&surface, &sizing, &task).expect("not cancelled"));
        let mut mesh = triangulate(points, surface.vertices.len(), &task).expect("distinct points");
        assert_eq!((mesh.check(), mesh.n_not_delaunay()), (Ok(()), 0), "triangulated");
        let mut recovery = Recovery::new(&mut mesh, &surface.facets);
        recovery.run(&task).expect("recovered");
        let facets = recovery.facets;
        assert_eq!(mesh.check(), Ok(()), "recovered");
        raise_walls(&mut mesh, &facets).expect("all facets are faces");
        classify(&mut mesh, &facets, &surface).expect("closed");
        assert_eq!(mesh.check(), Ok(()), "classified");
        let n_surface = surface.vertices.len();
        let is_filled = [false, true, true];
        Optimiser::new(&mut mesh, &is_filled, |v| v.index() < n_surface).run(&task).expect("not cancelled");
        assert_eq!(mesh.check(), Ok(()), "optimised");
        let found = Found { facets: &facets, recovery: RecoveryReport::default(), sizing };
        let filled = extract(&mesh, &surface, &is_filled, found);
        let volumes = (filled.mesh.volumes(), surface.volumes());
        for r in [1, 2] {
            assert!((volumes.0[r] / volumes.1[r] - 1.0).abs() < 1e-12, "region {r}: {volumes:?}");
        }
    }
}
