//! The outlines of all parts, cut where they cross and divided to the wanted edge lengths.
//!
//! Ground, patch, pin and outer conductor bound the triangles of the footprint. The outer conductor's circle may reach
//! past the patch's edges; its polygon then has corners exactly at the crossings and even segments between them, so
//! that no short edge arises there. An arc of about one segment beyond an edge becomes a chord along that edge.

use super::sizing::{Circle, Sizing};
use crate::antenna::PatchParams;
use crate::geometry::DVec2;
use std::f64::consts::{PI, TAU};

/// Samples of the wanted length along a piece of an outline; they resolve its growth from the shortest edges.
const SAMPLES: usize = 400;

/// Divided outlines: what the triangulation must respect.
#[derive(Clone, Debug, Default)]
pub(super) struct Outlines {
    /// Their points, m.
    pub(super) points: Vec<DVec2>,
    /// Edges between them, each once.
    pub(super) segments: Vec<[usize; 2]>,
    /// Corners of the polygons of the circles, counter-clockwise.
    pub(super) polygons: Vec<Vec<DVec2>>,
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
    pub(super) fn new(params: &PatchParams, sizing: &Sizing) -> Self {
        let patch = DVec2::new(params.width, params.length) / 2.0;
        let ground = DVec2::new(params.ground_width, params.ground_length) / 2.0;
        let mut outlines = Self { patch, ground, ..Self::default() };
        let mut cuts: Vec<(usize, usize)> = Vec::new();
        let mut chords: Vec<[usize; 2]> = Vec::new();
        for circle in &sizing.circles {
            outlines.add_circle(circle, &mut cuts, &mut chords);
        }
        outlines.add_rectangle(patch, sizing, &cuts, &chords);
        outlines.add_rectangle(ground, sizing, &[], &[]);
        outlines
    }

    fn point(&mut self, p: DVec2) -> usize {
        self.points.push(p);
        self.points.len() - 1
    }

    /// Adds a circle's polygon; its crossings with the patch's sides go to `cuts` (side, point), and the segments of
    /// it that run along a side to `chords`.
    fn add_circle(&mut self, circle: &Circle, cuts: &mut Vec<(usize, usize)>, chords: &mut Vec<[usize; 2]>) {
        let crossings = crossings(circle, self.patch);
        let on_circle = |angle: f64| circle.center + circle.radius * DVec2::new(angle.sin(), -angle.cos());
        let step = TAU / circle.segments as f64;
        let first = self.points.len();
        for (k, crossing) in crossings.iter().enumerate() {
            let corner = self.point(crossing.point);
            cuts.push((crossing.side, corner));
            let next = &crossings[(k + 1) % crossings.len()];
            let arc = (next.angle - crossing.angle).rem_euclid(TAU);
            let n = pieces(arc / step);
            if n == 1 && next.side == crossing.side {
                chords.push([corner, if k + 1 < crossings.len() { corner + 1 } else { first }]);
            }
            for m in 1..n {
                self.point(on_circle(crossing.angle + arc * m as f64 / n as f64));
            }
        }
        if crossings.is_empty() {
            for k in 0..circle.segments {
                self.point(on_circle(step * (k as f64 + 0.5)));
            }
        }
        let n = self.points.len() - first;
        let sides = (0..n).map(|k| [first + k, first + (k + 1) % n]);
        self.segments.extend(sides.filter(|side| !chords.contains(side)));
        self.polygons.push(self.points[first..].to_vec());
    }

    /// Adds an axis-parallel rectangle about the origin, through the `cuts`; a piece among `chords` is not divided.
    fn add_rectangle(&mut self, half: DVec2, sizing: &Sizing, cuts: &[(usize, usize)], chords: &[[usize; 2]]) {
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
                let piece = [piece[0], piece[1]];
                if chords.contains(&piece) || chords.contains(&[piece[1], piece[0]]) {
                    self.segments.push(piece);
                } else {
                    self.divide(piece, sizing);
                }
            }
        }
    }

    /// Divides a straight piece so that each part is as long as wanted at its place.
    fn divide(&mut self, [from, to]: [usize; 2], sizing: &Sizing) {
        let (a, b) = (self.points[from], self.points[to]);
        let length = a.distance(b);
        // Trapezoidal running integral of ds / h.
        // Not `lerp`, which would leave the line by a rounding error.
        let place = |t: f64| a + (b - a) * t;
        let part = |k: usize| k as f64 / SAMPLES as f64;
        let mut count = vec![0.0];
        for k in 0..SAMPLES {
            let density = [k, k + 1].map(|k| 1.0 / sizing.at(place(part(k)))).iter().sum::<f64>() / 2.0;
            count.push(count[k] + density * length / SAMPLES as f64);
        }
        let total = count[SAMPLES];
        let n = pieces(total);
        let mut last = from;
        for m in 1..n {
            let wanted = total * m as f64 / n as f64;
            let k = count.partition_point(|&c| c < wanted).max(1);
            let t = (k - 1) as f64 + (wanted - count[k - 1]) / (count[k] - count[k - 1]);
            let next = self.point(place(t / SAMPLES as f64));
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
                found.push(Crossing { angle: arm.x.atan2(-arm.y).rem_euclid(2.0 * PI), side, point });
            }
        }
    }
    found.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    found
}
