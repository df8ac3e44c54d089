//! The outlines of all parts, cut where they cross and divided to the wanted edge lengths.
//!
//! Ground, patch, pin and outer conductor bound the triangles of the footprint. The outer conductor's circle may reach
//! past the patch's edges; its polygon then has corners exactly at the crossings and segments of the wanted
//! length between them, so that no short edge arises there. An arc of about one segment beyond an edge becomes a chord
//! along that edge.
//!
//! Not handled: a circle through a corner of the patch, to about the height of a segment's arc.

use super::BlockError;
use super::sizing::{Circle, Sizing};
use crate::antenna::PatchParams;
use crate::geometry::DVec2;
use std::f64::consts::TAU;

/// Longest arc beyond a side of the patch, in segments, that becomes a chord along it.
const CHORD: f64 = 1.5;
/// Samples of the wanted length along a piece of an outline; they resolve its growth from the shortest edges.
const SAMPLES: usize = 200;

/// Divided outlines: what the triangulation must respect.
#[derive(Clone, Debug, Default)]
pub(super) struct Outlines {
    /// Their points, m.
    pub(super) points: Vec<DVec2>,
    /// Edges between them, each once.
    pub(super) segments: Vec<[usize; 2]>,
    /// Corners of the polygons of the circles, counter-clockwise.
    pub(super) polygons: Vec<Vec<DVec2>>,
    /// The points that stand alone, one for each resistor.
    pub(super) posts: Vec<usize>,
    /// Half the extents of the patch, m.
    pub(super) patch: DVec2,
    /// Half the extents of the ground, m.
    pub(super) ground: DVec2,
}

/// Where a circle meets a side of the patch.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Angle around the circle, counter-clockwise from below (-y).
    angle: f64,
    /// The side, counter-clockwise from the one at the bottom.
    side: usize,
    point: DVec2,
}

impl Outlines {
    /// Draws the outlines of valid parameters.
    pub(super) fn new(params: &PatchParams, sizing: &Sizing) -> Result<Self, BlockError> {
        let patch = DVec2::new(params.width, params.length) / 2.0;
        let ground = DVec2::new(params.ground_width, params.ground_length) / 2.0;
        let mut outlines = Self { patch, ground, ..Self::default() };
        let mut cuts: Vec<(usize, usize)> = Vec::new();
        for circle in &sizing.circles {
            outlines.add_circle(circle, sizing, &mut cuts)?;
        }
        outlines.add_rectangle(patch, sizing, &cuts);
        outlines.add_rectangle(ground, sizing, &[]);
        outlines.posts = params.resistors.iter().map(|resistor| outlines.point(resistor.at)).collect();
        Ok(outlines)
    }

    fn point(&mut self, p: DVec2) -> usize {
        self.points.push(p);
        self.points.len() - 1
    }

    /// Adds a circle's polygon; its crossings with the patch's sides go to `cuts`, as side and point.
    fn add_circle(
        &mut self,
        circle: &Circle,
        sizing: &Sizing,
        cuts: &mut Vec<(usize, usize)>,
    ) -> Result<(), BlockError> {
        let crossings = crossings(circle, self.patch);
        if crossings.len() % 2 == 1 {
            // Through a corner: a closed curve crosses another an even number of times.
            return Err(BlockError::Outlines);
        }
        let on_circle = |angle: f64| circle.center + circle.radius * DVec2::new(angle.sin(), -angle.cos());
        let step = TAU / circle.segments as f64;
        let corners: Vec<(f64, usize)> = if crossings.is_empty() {
            // As the surface complex has them.
            let angles = (0..circle.segments).map(|k| step * (k as f64 + 0.5));
            angles.map(|angle| (angle, self.point(on_circle(angle)))).collect()
        } else {
            crossings.iter().map(|c| (c.angle, self.point(c.point))).collect()
        };
        cuts.extend(crossings.iter().zip(&corners).map(|(crossing, corner)| (crossing.side, corner.1)));
        let mut polygon = Vec::new();
        for (k, &(angle, corner)) in corners.iter().enumerate() {
            let (next_angle, next) = corners[(k + 1) % corners.len()];
            let arc = (next_angle - angle).rem_euclid(TAU);
            let along_side = crossings.get(k).is_some_and(|c| c.side == crossings[(k + 1) % crossings.len()].side);
            polygon.push(self.points[corner]);
            if !(along_side && arc < CHORD * step) {
                let before = self.points.len();
                self.divide([corner, next], circle.radius * arc, sizing, |t| on_circle(angle + arc * t));
                polygon.extend(&self.points[before..]);
            }
        }
        self.polygons.push(polygon);
        Ok(())
    }

    /// Adds an axis-parallel rectangle about the origin, through the `cuts`.
    fn add_rectangle(&mut self, half: DVec2, sizing: &Sizing, cuts: &[(usize, usize)]) {
        let corners = [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
        let corners = corners.map(|c| self.point(c * half));
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            let mut stops: Vec<usize> = cuts.iter().filter(|c| c.0 == side).map(|c| c.1).collect();
            stops.extend([from, to]);
            let origin = self.points[from];
            stops.sort_by(|&a, &b| {
                let along = |i: usize| self.points[i].distance_squared(origin);
                along(a).total_cmp(&along(b))
            });
            for piece in stops.windows(2) {
                let (a, b) = (self.points[piece[0]], self.points[piece[1]]);
                // Not `lerp`, which would leave the line by a rounding error.
                self.divide([piece[0], piece[1]], a.distance(b), sizing, |t| a + (b - a) * t);
            }
        }
    }

    /// Divides a piece of an outline, given by its ends, its length and its path from 0 to 1, so that each part is as
    /// long as wanted at its place.
    fn divide(&mut self, [from, to]: [usize; 2], length: f64, sizing: &Sizing, path: impl Fn(f64) -> DVec2) {
        // Trapezoidal running integral of ds / h.
        let part = |k: usize| k as f64 / SAMPLES as f64;
        let mut count = vec![0.0];
        for k in 0..SAMPLES {
            let density = [k, k + 1].map(|k| 1.0 / sizing.at(path(part(k)))).iter().sum::<f64>() / 2.0;
            count.push(count[k] + density * length / SAMPLES as f64);
        }
        let total = count[SAMPLES];
        let n = pieces(total);
        let mut last = from;
        for m in 1..n {
            let wanted = total * m as f64 / n as f64;
            let k = count.partition_point(|&c| c < wanted).max(1);
            let t = (k - 1) as f64 + (wanted - count[k - 1]) / (count[k] - count[k - 1]);
            let next = self.point(path(t / SAMPLES as f64));
            self.segments.push([last, next]);
            last = next;
        }
        self.segments.push([last, to]);
    }
}

/// The nearest number of parts, at least one.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive count")]
fn pieces(count: f64) -> usize {
    count.round().max(1.0) as usize
}

/// The crossings of a circle with the sides of a rectangle about the origin, by their angle.
fn crossings(circle: &Circle, half: DVec2) -> Vec<Crossing> {
    let mut found = Vec::new();
    for side in 0..4 {
        let (axis, other) = if side % 2 == 0 { (1, 0) } else { (0, 1) };
        let level = if side == 0 || side == 3 { -half[axis] } else { half[axis] };
        let reach = circle.radius.powi(2) - (level - circle.center[axis]).powi(2);
        if reach <= 0.0 {
            continue;
        }
        for sign in [-1.0, 1.0] {
            let mut point = DVec2::ZERO;
            point[axis] = level;
            point[other] = circle.center[other] + sign * reach.sqrt();
            if point[other].abs() < half[other] {
                let arm = point - circle.center;
                found.push(Crossing { angle: arm.x.atan2(-arm.y).rem_euclid(TAU), side, point });
            }
        }
    }
    found.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    found
}
