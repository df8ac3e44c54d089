//! The outlines of all parts, cut where they cross and divided to the wanted edge lengths.
//!
//! Ground, patch, pin and outer conductor bound the triangles of the footprint. The outer conductor's circle may reach
//! past the patch's edges; its polygon then has corners exactly at the crossings and segments of the wanted
//! length between them, so that no short edge arises there. An arc of about one segment beyond an edge becomes a chord
//! along that edge.
//!
//! Corners of a patch that is no rectangle are put onto a circle that passes close by, so that no short edge arises.
//!
//! Not handled: a circle through a corner of a rectangle, to about the height of a segment's arc.

use super::BlockError;
use super::sizing::{Circle, Sizing};
use crate::antenna::PatchParams;
use crate::geometry::DVec2;
use std::collections::HashSet;
use std::f64::consts::TAU;

/// Longest arc beyond a side of the patch, in segments, that becomes a chord along it.
const CHORD: f64 = 1.5;
/// Distance of a corner from a circle, in segments, within which it is put onto it; more would be seen.
const ONTO: f64 = 0.15;
/// A crossing closer than this to a corner on the circle, over the side's length, is that corner.
const AT_CORNER: f64 = 1e-6;
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
    /// Corners of the patch, counter-clockwise, m.
    pub(super) patch: Vec<DVec2>,
    /// Which of these are on the outer conductor's circle; for a patch that is no rectangle.
    on_circle: Vec<bool>,
    /// Half the extents of the ground, m.
    pub(super) ground: DVec2,
}

/// Where a circle meets a side of the patch, or one of its corners.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Angle around the circle, counter-clockwise from below (-y).
    angle: f64,
    /// The side, counter-clockwise from the first corner; of a corner, the side that it begins.
    side: usize,
    is_corner: bool,
    point: DVec2,
}

impl Outlines {
    /// Draws the outlines of valid parameters.
    pub(super) fn new(params: &PatchParams, sizing: &Sizing) -> Result<Self, BlockError> {
        let ground = DVec2::new(params.ground_width, params.ground_length) / 2.0;
        let mut outlines = Self { patch: params.patch_corners(), ground, ..Self::default() };
        if let Some(circle) = sizing.circles.last().filter(|_| !params.outline.is_empty()) {
            outlines.put_corners_onto(circle);
        }
        let mut cuts: Vec<Cut> = Vec::new();
        for circle in &sizing.circles {
            outlines.add_circle(circle, sizing, &mut cuts)?;
        }
        outlines.add_polygon(&outlines.patch.clone(), sizing, &cuts);
        let corners = [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
        outlines.add_polygon(&corners.map(|c| c * ground), sizing, &[]);
        // A side between two corners on a circle may be a piece of the circle's polygon as well.
        let mut seen = HashSet::new();
        outlines.segments.retain(|&[a, b]| seen.insert([a.min(b), a.max(b)]));
        outlines.posts = params.resistors.iter().map(|resistor| outlines.point(resistor.at)).collect();
        Ok(outlines)
    }

    fn point(&mut self, p: DVec2) -> usize {
        self.points.push(p);
        self.points.len() - 1
    }

    /// Puts the corners of the patch that are close to a circle onto it.
    fn put_corners_onto(&mut self, circle: &Circle) {
        self.on_circle = vec![false; self.patch.len()];
        for (corner, is_on) in self.patch.iter_mut().zip(&mut self.on_circle) {
            let arm = *corner - circle.center;
            if (arm.length() - circle.radius).abs() < ONTO * circle.segment() {
                *corner = circle.center + arm * (circle.radius / arm.length());
                *is_on = true;
            }
        }
    }

    /// Adds a circle's polygon; its crossings with the patch's outline go to `cuts`.
    fn add_circle(&mut self, circle: &Circle, sizing: &Sizing, cuts: &mut Vec<Cut>) -> Result<(), BlockError> {
        let crossings = self.crossings(circle);
        if crossings.len() % 2 == 1 && self.on_circle.is_empty() {
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
        let cut = |(crossing, corner): (&Crossing, &(f64, usize))| Cut {
            side: crossing.side,
            point: corner.1,
            is_corner: crossing.is_corner,
        };
        cuts.extend(crossings.iter().zip(&corners).map(cut));
        let mut polygon = Vec::new();
        for (k, &(angle, corner)) in corners.iter().enumerate() {
            let (next_angle, next) = corners[(k + 1) % corners.len()];
            let arc = (next_angle - angle).rem_euclid(TAU);
            let along_side =
                crossings.get(k).is_some_and(|c| self.share_a_side(c, &crossings[(k + 1) % crossings.len()]));
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

    /// Whether both ends of an arc lie on one side of the patch.
    fn share_a_side(&self, from: &Crossing, to: &Crossing) -> bool {
        let n = self.patch.len();
        let sides = |c: &Crossing| [c.side, if c.is_corner { (c.side + n - 1) % n } else { c.side }];
        sides(from).iter().any(|side| sides(to).contains(side))
    }

    /// The crossings of a circle with the patch's outline, by their angle.
    fn crossings(&self, circle: &Circle) -> Vec<Crossing> {
        let n = self.patch.len();
        let mut found = Vec::new();
        let mut add = |point: DVec2, side: usize, is_corner: bool| {
            let arm = point - circle.center;
            found.push(Crossing { angle: arm.x.atan2(-arm.y).rem_euclid(TAU), side, is_corner, point });
        };
        let is_on = |k: usize| {
            let is_outer = (self.patch[k].distance(circle.center) - circle.radius).abs() < AT_CORNER * circle.radius;
            self.on_circle.get(k).is_some_and(|on| *on) && is_outer
        };
        for side in 0..n {
            let (from, to) = (side, (side + 1) % n);
            let (a, b) = (self.patch[from], self.patch[to]);
            if is_on(from) {
                add(a, side, true);
            }
            for point in meetings(circle, a, b) {
                let at = |corner: usize, p: DVec2| is_on(corner) && p.distance(point) < AT_CORNER * a.distance(b);
                if !at(from, a) && !at(to, b) {
                    add(point, side, false);
                }
            }
        }
        found.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        found
    }

    /// Adds a polygon, through the `cuts`.
    fn add_polygon(&mut self, corners: &[DVec2], sizing: &Sizing, cuts: &[Cut]) {
        let existing = |k: usize| cuts.iter().find(|c| c.is_corner && c.side == k).map(|c| c.point);
        let corners: Vec<usize> =
            corners.iter().enumerate().map(|(k, c)| existing(k).unwrap_or_else(|| self.point(*c))).collect();
        for side in 0..corners.len() {
            let (from, to) = (corners[side], corners[(side + 1) % corners.len()]);
            let on_side = cuts.iter().filter(|c| c.side == side && !c.is_corner);
            let mut stops: Vec<usize> = on_side.map(|c| c.point).collect();
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

/// A point of a circle's polygon on the patch's outline.
struct Cut {
    /// The side, or the corner that begins it.
    side: usize,
    point: usize,
    is_corner: bool,
}

/// The nearest number of parts, at least one.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive count")]
fn pieces(count: f64) -> usize {
    count.round().max(1.0) as usize
}

/// Where a circle meets a side, its ends excluded.
fn meetings(circle: &Circle, a: DVec2, b: DVec2) -> Vec<DVec2> {
    let mut found = Vec::new();
    let along = b - a;
    let level = [0, 1].into_iter().find(|&axis| a[axis].to_bits() == b[axis].to_bits());
    let Some(axis) = level else {
        // |a + t (b - a) - center|^2 = radius^2
        let arm = a - circle.center;
        let (p, q) = (arm.dot(along) / along.length_squared(), arm.length_squared() - circle.radius.powi(2));
        let root = p * p - q / along.length_squared();
        if root > 0.0 {
            let roots = [-p - root.sqrt(), -p + root.sqrt()];
            found.extend(roots.into_iter().filter(|t| *t > 0.0 && *t < 1.0).map(|t| a + along * t));
        }
        return found;
    };
    // Exactly on a side along an axis.
    let other = 1 - axis;
    let reach = circle.radius.powi(2) - (a[axis] - circle.center[axis]).powi(2);
    if reach > 0.0 {
        for sign in [-1.0, 1.0] {
            let mut point = DVec2::ZERO;
            point[axis] = a[axis];
            point[other] = circle.center[other] + sign * reach.sqrt();
            if point[other] > a[other].min(b[other]) && point[other] < a[other].max(b[other]) {
                found.push(point);
            }
        }
    }
    found
}
