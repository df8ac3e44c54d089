//! One planar triangulation in which every part of the antenna has its outline.
//!
//! Substrate, patch, pin and outer conductor are drawn together as constraints of a two-dimensional Delaunay
//! triangulation, refined to a smallest angle; outlines that cross (the coaxial line reaches past the radiating edge)
//! are split at the crossing. Every layer of the antenna uses this one triangulation, so layers match by construction.

use super::outline::contains;
use super::params::PatchParams;
use super::patch::PatchError;
use crate::geometry::DVec2;
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, HasPosition, Point2, RefinementParameters, Triangulation,
    handles::FixedVertexHandle,
};
use std::f64::consts::TAU;

/// Smallest angle asked of the triangulation, degrees: 20.7 is where refinement provably ends, and up to about 30 it
/// does in practice; more gains nothing for a surface whose edges are split again on demand.
const MIN_ANGLE_DEG: f64 = 25.0;
/// Triangles per square of the ground's shorter side; fewer leave long triangles at the rim, more only cost time,
/// since edges that deform are split on demand.
const AREAS_PER_GROUND: f64 = 120.0;
/// Distance, relative to the ground's size, within which a vertex is put exactly onto an outline: above rounding,
/// far below any feature.
const SNAP: f64 = 1e-12;

/// Which parts lie over a triangle of the footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cover {
    pub(super) patch: bool,
    pub(super) pin: bool,
    /// Within the outer conductor's circle but not the pin's.
    pub(super) sheath: bool,
}

/// The common triangulation of all outlines, seen from above: points in metres, triangles counter-clockwise.
#[derive(Debug)]
pub(super) struct Footprint {
    pub(super) points: Vec<DVec2>,
    pub(super) triangles: Vec<[usize; 3]>,
    pub(super) covers: Vec<Cover>,
}

/// Triangulates the outlines of valid parameters.
pub(super) fn triangulate(params: &PatchParams) -> Result<Footprint, PatchError> {
    let pin = circle(params, params.pin_radius, params.pin_segments);
    let sheath = circle(params, params.coax_radius, params.coax_segments);
    let ground = rectangle(params.ground_width, params.ground_length);
    let patch = params.patch_corners();
    let mut cdt = Cdt::new();
    for outline in [&ground[..], &patch[..], &pin[..], &sheath[..]] {
        add_outline(&mut cdt, outline)?;
    }
    let max_area = params.ground_width * params.ground_length / AREAS_PER_GROUND;
    let refinement = cdt.refine(
        RefinementParameters::new()
            .with_angle_limit(AngleLimit::from_deg(MIN_ANGLE_DEG))
            .with_max_allowed_area(max_area)
            .with_max_additional_vertices(200_000),
    );
    if !refinement.refinement_complete {
        return Err(PatchError::Refinement);
    }
    let tolerance = SNAP * params.ground_width.max(params.ground_length);
    // The lines of a polygon are of any slope: what is added on them lies off by rounding, which shifts no triangle's
    // center across.
    let onto_patch = |p: DVec2| match patch[..] {
        [a, _, c, _] if params.outline.is_empty() => snap(p, [a, c], tolerance),
        _ => p,
    };
    let snapped = |p: DVec2| onto_patch(snap(p, [ground[0], ground[2]], tolerance));
    let points: Vec<DVec2> = cdt.vertices().map(|v| snapped(v.data().0)).collect();
    let triangles: Vec<[usize; 3]> = cdt.inner_faces().map(|f| f.vertices().map(|v| v.index())).collect();
    let covers = triangles
        .iter()
        .map(|t| {
            let center = t.iter().map(|&v| points[v]).sum::<DVec2>() / 3.0;
            let in_pin = in_convex(&pin, center);
            Cover { patch: contains(&patch, center), pin: in_pin, sheath: !in_pin && in_convex(&sheath, center) }
        })
        .collect();
    Ok(Footprint { points, triangles, covers })
}

type Cdt = ConstrainedDelaunayTriangulation<Corner>;

/// A point as spade wants it.
#[derive(Clone, Copy, Debug)]
struct Corner(DVec2);

impl HasPosition for Corner {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        Point2::new(self.0.x, self.0.y)
    }
}

impl From<Point2<f64>> for Corner {
    fn from(p: Point2<f64>) -> Self {
        Self(DVec2::new(p.x, p.y))
    }
}

fn add_outline(cdt: &mut Cdt, outline: &[DVec2]) -> Result<(), PatchError> {
    let insert =
        |cdt: &mut Cdt, p: &DVec2| cdt.insert(Corner(*p)).map_err(|_reason| PatchError::Coordinates { x: p.x, y: p.y });
    let handles: Vec<FixedVertexHandle> = outline.iter().map(|p| insert(cdt, p)).collect::<Result<_, _>>()?;
    for (k, &from) in handles.iter().enumerate() {
        let to = handles[(k + 1) % handles.len()];
        cdt.add_constraint_and_split(from, to, Corner::from);
    }
    Ok(())
}

fn rectangle(width: f64, length: f64) -> [DVec2; 4] {
    let (x, y) = (width / 2.0, length / 2.0);
    [DVec2::new(-x, -y), DVec2::new(x, -y), DVec2::new(x, y), DVec2::new(-x, y)]
}

/// A regular polygon with its corners on the circle, symmetric about the feed's x plane.
fn circle(params: &PatchParams, radius: f64, segments: usize) -> Vec<DVec2> {
    let angle = |k: usize| TAU * (k as f64 + 0.5) / segments as f64;
    (0..segments).map(|k| params.feed() + radius * DVec2::new(angle(k).sin(), -angle(k).cos())).collect()
}

fn in_convex(outline: &[DVec2], p: DVec2) -> bool {
    (0..outline.len()).all(|k| {
        let (a, b) = (outline[k], outline[(k + 1) % outline.len()]);
        (b - a).perp_dot(p - a) > 0.0
    })
}

/// Puts a point that is within `tolerance` of a line of an axis-parallel rectangle, given by opposite corners, exactly
/// onto it.
fn snap(p: DVec2, [lo, hi]: [DVec2; 2], tolerance: f64) -> DVec2 {
    let to = |value: f64, lines: [f64; 2]| lines.into_iter().find(|l| (l - value).abs() <= tolerance).unwrap_or(value);
    DVec2::new(to(p.x, [lo.x, hi.x]), to(p.y, [lo.y, hi.y]))
}

#[cfg(test)]
mod tests {
    use super::super::params::tests::paper;
    use super::*;

    #[test]
    fn areas_of_all_parts_are_exact() {
        let params = paper();
        let print = triangulate(&params).expect("the paper's antenna");
        let area = |keep: &dyn Fn(&Cover) -> bool| -> f64 {
            let one = |t: &[usize; 3]| {
                let [a, b, c] = t.map(|v| print.points[v]);
                (b - a).perp_dot(c - a) / 2.0
            };
            print.triangles.iter().zip(&print.covers).filter(|(_, c)| keep(c)).map(|(t, _)| one(t)).sum()
        };
        let polygon = |r: f64, n: usize| n as f64 / 2.0 * r * r * (TAU / n as f64).sin();
        let pin = polygon(params.pin_radius, params.pin_segments);
        let cases = [
            (area(&|_| true), params.ground_width * params.ground_length),
            (area(&|c| c.patch), params.width * params.length),
            (area(&|c| c.pin), pin),
            (area(&|c| c.sheath), polygon(params.coax_radius, params.coax_segments) - pin),
        ];
        for (found, expected) in cases {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found:e} against {expected:e}");
        }
    }

    #[test]
    fn every_triangle_is_well_shaped_away_from_the_crossing_outlines() {
        let print = triangulate(&paper()).expect("the paper's antenna");
        let angles = print.triangles.iter().map(|t| {
            let p = t.map(|v| print.points[v]);
            (0..3)
                .map(|k| (p[(k + 1) % 3] - p[k]).angle_to(p[(k + 2) % 3] - p[k]).to_degrees())
                .fold(f64::INFINITY, f64::min)
        });
        let smallest = angles.fold(f64::INFINITY, f64::min);
        assert!(smallest > 10.0, "smallest angle {smallest} degrees");
        assert!(print.triangles.len() < 2500, "{} triangles", print.triangles.len());
    }
}
