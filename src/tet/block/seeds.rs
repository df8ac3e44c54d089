//! First places for the points inside the footprint, packed row by row from the outlines.
//!
//! On both sides of every outline segment a seed makes a near equilateral triangle with it; every accepted seed
//! proposes six more around it, at the length wanted there. A place is taken unless another point or an outline is too
//! near. This gives the even rows along the rim that the field wants, and hardly any empty spot.

use super::outlines::Outlines;
use super::sizing::Sizing;
use crate::geometry::DVec2;
use std::collections::{HashMap, VecDeque};

/// Nearest neighbor allowed, in wanted lengths: much less makes acute triangles, much more leaves holes.
const APART: f64 = 0.76;
/// Nearest outline allowed, in wanted lengths; an equilateral triangle would have 0.87.
const CLEAR: f64 = 0.5;

/// Knows where there is room for one more point.
#[derive(Debug)]
pub(super) struct Room<'a> {
    outlines: &'a Outlines,
    sizing: &'a Sizing,
    /// Points by square cells of side `cell`.
    cells: HashMap<(i64, i64), Vec<DVec2>>,
    cell: f64,
}

impl<'a> Room<'a> {
    /// Starts with some points taken.
    pub(super) fn new(outlines: &'a Outlines, sizing: &'a Sizing, cell: f64, points: &[DVec2]) -> Self {
        let mut room = Self { outlines, sizing, cells: HashMap::new(), cell };
        points.iter().for_each(|&p| room.take(p));
        room
    }

    #[allow(clippy::cast_possible_truncation, reason = "a cell number within the ground")]
    fn key(&self, p: DVec2) -> (i64, i64) {
        ((p.x / self.cell).floor() as i64, (p.y / self.cell).floor() as i64)
    }

    fn take(&mut self, p: DVec2) {
        self.cells.entry(self.key(p)).or_default().push(p);
    }

    /// Takes a place if nothing is too near.
    pub(super) fn try_take(&mut self, p: DVec2) -> bool {
        let h = self.sizing.at(p);
        if (p.abs() + CLEAR * h).cmpgt(self.outlines.ground).any() {
            return false;
        }
        let (x, y) = self.key(p);
        let near = (x - 1..=x + 1).flat_map(|i| (y - 1..=y + 1).map(move |j| (i, j)));
        let crowded =
            near.filter_map(|key| self.cells.get(&key)).flatten().any(|q| q.distance_squared(p) < (APART * h).powi(2));
        if crowded || self.outlines.distance(p) < CLEAR * h {
            return false;
        }
        self.take(p);
        true
    }
}

impl Outlines {
    /// Distance of a place to the nearest outline, m.
    pub(super) fn distance(&self, p: DVec2) -> f64 {
        let to_segment = |[a, b]: &[usize; 2]| {
            let (a, b) = (self.points[*a], self.points[*b]);
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance_squared(a.lerp(b, t))
        };
        self.segments.iter().map(to_segment).fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// Packs seeds between the outlines.
pub(super) fn pack(outlines: &Outlines, sizing: &Sizing, cell: f64) -> Vec<DVec2> {
    let mut room = Room::new(outlines, sizing, cell, &outlines.points);
    let mut candidates: VecDeque<(DVec2, DVec2)> = VecDeque::new();
    for &[a, b] in &outlines.segments {
        let (a, b) = (outlines.points[a], outlines.points[b]);
        let side = (b - a).perp() * (3.0_f64.sqrt() / 2.0);
        candidates.extend([side, -side].map(|side| (a.midpoint(b) + side, side)));
    }
    let mut seeds = Vec::new();
    while let Some((place, from)) = candidates.pop_front() {
        if !room.try_take(place) {
            continue;
        }
        seeds.push(place);
        let ahead = from.normalize_or(DVec2::X) * sizing.at(place);
        for k in 0..6 {
            let turned = DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_3).rotate(ahead);
            let step = turned * (sizing.at(place + turned) / sizing.at(place)).sqrt();
            candidates.push_back((place + step, turned));
        }
    }
    seeds
}
