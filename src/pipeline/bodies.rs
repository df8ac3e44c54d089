//! Imported bodies as a mesh: their split surface in a sphere of air, all of it filled at once, with the feed's line.
//!
//! Thin metal plates are sheets unless their true thickness is asked for. The feed is a line of edges across the gap: a
//! narrow strip of facets within the region that it runs through keeps the line in the mesh, and carries no condition.

use super::PipelineError;
use super::bodies_edges::{Edges, edges};
use super::mesh::{GRADING, MeshSettings, Meshed, N_WORST, Shape};
use super::scene::Scene;
use super::stages::{check_folds, guarded_split, splitting};
use crate::antenna::bodies::{Gap, WithSheets, with_sheets};
use crate::deform::{DeformError, SmoothMap, SplitSettings};
use crate::geometry::bvh::Aabb;
use crate::geometry::{DVec3, FaceId, Plc, Region, RegionId, RegionRole, VertexId, intersect};
use crate::project::{BodiesSpec, Project};
use crate::task::Task;
use crate::tet::{FaceGroup, FaceRole, SizingSettings, Surface, SurfaceFacet, fill, quality, remesh, sphere};
use crate::tlm::LumpedPort;
use crate::units::{C0, from_mm, to_mm};
use std::time::Instant;

/// Number of the air among the mesh's regions; the bodies follow it.
const AIR_ID: usize = 1;
/// Least edges along the feed's line: a single one would be longer than the cells around it.
const LEAST_PIECES: usize = 2;
/// Directions in which the feed's strip is tried.
const DIRECTIONS: usize = 12;
/// Widths of the strip that are tried, in pieces of the line.
const WIDTHS: [f64; 3] = [0.7, 0.3, 0.1];
/// Room between the antenna and the outer sphere, wavelengths at the middle of the band.
const ROOM: f64 = 0.5;

/// Meshes imported bodies and the air around them.
pub(super) fn mesh(
    (project, bodies): (&Project, &BodiesSpec),
    shape: Shape,
    settings: MeshSettings,
    band: [f64; 2],
    task: &Task,
) -> Result<Meshed, PipelineError> {
    let started = Instant::now();
    let edges = edges(bodies, settings, band);
    let how = How { splitting: splitting(project), edges, band };
    let mut meshed = match shape {
        Shape::Flat => how.carried(bodies, |p| Ok(p.to_vec()), task)?,
        Shape::Deformed => {
            let scene = Scene::new(project)?;
            let map = scene.map(&scene.checked_pose()?)?;
            check_folds(&map, bodies.bounds())?;
            how.carried(bodies, |p| map.positions(p), task)?
        }
        Shape::Cylinder => {
            let cylinder = Scene::new(project)?.cylinder().ok_or(PipelineError::NoCylinder)?;
            how.carried(bodies, |p| cylinder.positions(p), task)?
        }
    };
    meshed.seconds = started.elapsed().as_secs_f64();
    Ok(meshed)
}

struct How {
    splitting: SplitSettings,
    edges: Edges,
    band: [f64; 2],
}

impl How {
    fn carried(
        &self,
        bodies: &BodiesSpec,
        carry: impl Fn(&[DVec3]) -> Result<Vec<DVec3>, DeformError>,
        task: &Task,
    ) -> Result<Meshed, PipelineError> {
        let flat = bodies.to_plc();
        let gap = bodies.gap().map_err(|e| PipelineError::Feed(e.into()))?;
        let kept: Vec<VertexId> = gap.iter().flat_map(|g| g.ends).collect();
        let WithSheets { plc, is_sheet } = with_sheets(&flat, self.edges.thickest, &kept);
        let fine = remesh(&plc, &kept, self.edges.sizes, from_mm(bodies.weld_mm))
            .map_err(|at| PipelineError::Unmeshable { place_mm: at.to_array().map(to_mm) })?;
        let split = guarded_split(&fine, &carry, self.splitting, task)?;
        let posed = split.flat.with_vertices(split.images);
        let mut surface = surface_of(&posed, &is_sheet);
        let mut line = Vec::new();
        if let Some(gap) = gap {
            let ends = gap.ends.map(|v| flat.vertices[v.index()]);
            let number = |p: DVec3| split.flat.vertices.iter().position(|q| *q == p).map(VertexId::new);
            let [Some(from), Some(to)] = ends.map(number) else { return Err(PipelineError::NoRoomForFeed) };
            let flat_place = |part: f64, aside: DVec3| ends[0].lerp(ends[1], part) + aside;
            line =
                add_feed(&mut surface, Gap { ends: [from, to], ..gap }, self.edges.sizes.at_metal, flat_place, &carry)?;
        }
        let n_surface = self.add_sphere(&mut surface);
        let sizing = SizingSettings { h_max: self.edges.in_air, grading: GRADING };
        let filled = fill(&surface, &[], sizing, task).map_err(crate::tet::EncloseError::from)?;
        // Halved edges: their middles are numbered after the surface's vertices.
        let splits = &filled.recovery.splits;
        for (k, split) in splits.iter().enumerate() {
            let number = |v: VertexId| {
                splits[..k].iter().position(|s| s.middle == v).map_or(v, |e| VertexId::new(n_surface + e))
            };
            let ends = split.ends.map(number);
            if let Some(at) = line.windows(2).position(|w| ends.iter().all(|e| w.contains(e))) {
                line.insert(at + 1, VertexId::new(n_surface + k));
            }
        }
        let line: Vec<VertexId> = line.iter().map(|v| filled.vertex_of[v.index()]).collect();
        Ok(Meshed {
            quality: quality(&filled.mesh, Some(&|p| filled.sizing.at(p).size), N_WORST),
            mesh: filled.mesh,
            posts: if line.is_empty() { Vec::new() } else { vec![line] },
            recovery: filled.recovery,
            map_distance: self.splitting.tolerance,
            seconds: 0.0,
        })
    }

    /// Adds the outer sphere; returns the number of vertices that the surface then has.
    fn add_sphere(&self, surface: &mut Surface) -> usize {
        let Aabb { lo, hi } = Aabb::around(&surface.vertices);
        let center = lo.midpoint(hi);
        let reach = surface.vertices.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        let wavelength = 2.0 * C0 / (self.band[0] + self.band[1]);
        let radius = reach + (ROOM * wavelength).max(2.0 * self.edges.in_air);
        let (points, faces) = sphere(center, radius, self.edges.in_air);
        let first = surface.vertices.len();
        surface.vertices.extend(points);
        surface.groups.push(FaceGroup { name: "outer".to_owned(), role: FaceRole::Outer });
        let group = Some(surface.groups.len() - 1);
        surface.facets.extend(faces.iter().map(|f| SurfaceFacet {
            vertices: f.map(|v| VertexId::new(first + v)),
            back: RegionId::new(AIR_ID),
            front: RegionId::new(0),
            group,
        }));
        surface.vertices.len()
    }
}

/// The bodies' surface with the outside, the air, and a group for each conductor; what a sheet was is air.
fn surface_of(plc: &Plc, is_sheet: &[bool]) -> Surface {
    let outside = Region { name: "outside".to_owned(), ..plc.regions[0].clone() };
    let regions: Vec<Region> = std::iter::once(outside).chain(plc.regions.iter().cloned()).collect();
    let mut groups = Vec::new();
    let mut group_of = vec![None; plc.regions.len()];
    for (id, region) in plc.solids().filter(|(_, r)| r.role == RegionRole::Conductor) {
        group_of[id.index()] = Some(groups.len());
        groups.push(FaceGroup { name: format!("pec_{}", region.name), role: FaceRole::Conductor });
    }
    let facet = |f: &crate::geometry::Facet| {
        let is_body = |r: RegionId| group_of[r.index()].is_some() && !is_sheet[r.index()];
        let group = match [f.back, f.front] {
            // What lies between two bodies of metal bounds nothing.
            sides if sides.into_iter().all(is_body) => None,
            [back, front] if is_body(front) => group_of[front.index()].or(group_of[back.index()]),
            [back, front] => group_of[back.index()].or(group_of[front.index()]),
        };
        let [back, front] =
            [f.back, f.front].map(|r| RegionId::new(if is_sheet[r.index()] { AIR_ID } else { r.index() + AIR_ID }));
        SurfaceFacet { vertices: f.vertices, back, front, group }
    };
    Surface { vertices: plc.vertices.clone(), facets: plc.facets.iter().map(facet).collect(), regions, groups }
}

/// Adds the feed's strip where it crosses nothing; its line from end to end.
///
/// * `flat`: the flat place at a part of the line, and so far aside.
fn add_feed(
    surface: &mut Surface,
    gap: Gap,
    edge: f64,
    flat: impl Fn(f64, DVec3) -> DVec3,
    carry: impl Fn(&[DVec3]) -> Result<Vec<DVec3>, DeformError>,
) -> Result<Vec<VertexId>, PipelineError> {
    let length = flat(0.0, DVec3::ZERO).distance(flat(1.0, DVec3::ZERO));
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few pieces")]
    let n = ((length / edge).ceil() as usize).max(LEAST_PIECES);
    let along = (flat(1.0, DVec3::ZERO) - flat(0.0, DVec3::ZERO)) / length;
    let (u, v) = along.any_orthonormal_pair();
    let inner: Vec<f64> = (1..n).map(|k| k as f64 / n as f64).collect();
    let first = surface.vertices.len();
    let line: Vec<VertexId> =
        std::iter::once(gap.ends[0]).chain((0..n - 1).map(|k| VertexId::new(first + k))).chain([gap.ends[1]]).collect();
    let aside = |k: usize| VertexId::new(first + n - 2 + k);
    let mut strip = vec![[line[0], line[1], aside(1)], [line[n - 1], line[n], aside(n - 1)]];
    for k in 1..n - 1 {
        strip.extend([[line[k], line[k + 1], aside(k)], [aside(k), line[k + 1], aside(k + 1)]]);
    }
    let region = RegionId::new(gap.region.index() + AIR_ID);
    let facets = strip.iter().map(|&vertices| SurfaceFacet { vertices, back: region, front: region, group: None });
    for width in WIDTHS {
        for turn in 0..DIRECTIONS {
            let angle = std::f64::consts::TAU * turn as f64 / DIRECTIONS as f64;
            let offset = (u * angle.cos() + v * angle.sin()) * (width * length / n as f64);
            let points = inner.iter().map(|&t| flat(t, DVec3::ZERO)).chain(inner.iter().map(|&t| flat(t, offset)));
            let posed = carry(&points.collect::<Vec<_>>())?;
            let vertices: Vec<DVec3> = surface.vertices.iter().copied().chain(posed).collect();
            let faces: Vec<_> = surface.facets.iter().map(|f| f.vertices).chain(strip.iter().copied()).collect();
            let n_before = FaceId::new(surface.facets.len());
            if intersect::crossings(&vertices, &faces).iter().all(|c| c.second < n_before) {
                surface.vertices = vertices;
                surface.facets.extend(facets);
                return Ok(line);
            }
        }
    }
    Err(PipelineError::NoRoomForFeed)
}

/// The source across the feed's line.
pub(super) fn port(meshed: &Meshed, resistance: f64) -> Option<LumpedPort> {
    meshed.posts.first().map(|chain| LumpedPort { chain: chain.clone(), resistance })
}
