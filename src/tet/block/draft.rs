//! A planar triangulation in the making, and the steps that make it even.

use super::BlockError;
use super::outlines::Outlines;
use super::seeds::Room;
use super::sizing::Sizing;
use crate::geometry::DVec2;
use crate::geometry::predicates::orient2d;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::f64::consts::TAU;

/// Shortest edge, in wanted lengths, before one of its ends is taken out.
const SHORT: f64 = 0.6;
/// Greatest empty circle, in wanted lengths, before a point is put in; of an equilateral triangle it is 0.58.
const HOLLOW: f64 = 0.72;
/// Angles below this are worth opening, degrees; hardly any larger ones can be reached everywhere.
const OPEN_BELOW: f64 = 36.0;
/// Steps tried in opening, in wanted lengths, in eight directions.
const OPENING_STEPS: [f64; 4] = [0.15, 0.06, 0.025, 0.01];

/// A footprint in the making; the first `n_fixed` points are the outlines'.
pub(super) struct Draft<'a> {
    pub(super) points: Vec<DVec2>,
    pub(super) n_fixed: usize,
    pub(super) outlines: &'a Outlines,
    pub(super) sizing: &'a Sizing,
}

/// A point as spade wants it.
#[derive(Clone, Copy, Debug)]
struct Corner(DVec2);

impl HasPosition for Corner {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        Point2::new(self.0.x, self.0.y)
    }
}

impl Draft<'_> {
    /// The constrained Delaunay triangulation of the points, by their numbers.
    pub(super) fn delaunay(&self) -> Result<Vec<[usize; 3]>, BlockError> {
        let corners: Vec<Corner> = self.points.iter().copied().map(Corner).collect();
        let mut n_conflicts = 0;
        let cdt = ConstrainedDelaunayTriangulation::<Corner>::try_bulk_load_cdt(
            corners,
            self.outlines.segments.clone(),
            |_segment| n_conflicts += 1,
        );
        match cdt {
            // Points that coincide are merged, which would shift the numbers.
            Ok(cdt) if n_conflicts == 0 && cdt.num_vertices() == self.points.len() => {
                Ok(cdt.inner_faces().map(|f| f.vertices().map(|v| v.index())).collect())
            }
            _ => Err(BlockError::Outlines),
        }
    }

    /// The triangles around each point.
    fn stars(&self, triangles: &[[usize; 3]]) -> Vec<Vec<usize>> {
        let mut stars = vec![Vec::new(); self.points.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| stars[v].push(t));
        }
        stars
    }

    /// The corners of a triangle if one of its points were elsewhere.
    fn moved(&self, triangle: [usize; 3], vertex: usize, place: DVec2) -> [DVec2; 3] {
        triangle.map(|v| if v == vertex { place } else { self.points[v] })
    }

    /// Moves each free point to the center of its star, weighted so that triangles grow with the wanted length.
    pub(super) fn spread(&mut self, triangles: &[[usize; 3]]) {
        let stars = self.stars(triangles);
        let weigh = |t: &[usize; 3]| {
            let corners = t.map(|v| self.points[v]);
            let center = corners.iter().sum::<DVec2>() / 3.0;
            (center, orient2d(corners[0], corners[1], corners[2]) / self.sizing.at(center).powi(3))
        };
        let weighed: Vec<(DVec2, f64)> = triangles.iter().map(weigh).collect();
        let place = |v: usize| {
            let (sum, weight) = stars[v]
                .iter()
                .map(|&t| weighed[t])
                .fold((DVec2::ZERO, 0.0), |(sum, total), (center, weight)| (sum + center * weight, total + weight));
            let from = self.points[v];
            let to = sum / weight;
            let fits = |p: &DVec2| {
                stars[v].iter().all(|&t| {
                    let [a, b, c] = self.moved(triangles[t], v, *p);
                    orient2d(a, b, c) > 0.0
                })
            };
            [to, from.midpoint(to)].into_iter().find(fits).unwrap_or(from)
        };
        let places: Vec<DVec2> = (self.n_fixed..self.points.len()).map(place).collect();
        self.points.truncate(self.n_fixed);
        self.points.extend(places);
    }

    /// Takes out points that crowd others or an outline, and puts points into holes.
    pub(super) fn thin_and_fill(&mut self, triangles: &[[usize; 3]], cell: f64) {
        let mut out = vec![false; self.points.len()];
        let mut touched = vec![false; self.points.len()];
        for triangle in triangles {
            for k in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
                let [pa, pb, pc] = [a, b, c].map(|v| self.points[v]);
                let short = |h: f64| pa.distance(pb) < SHORT * h;
                let flat = c >= self.n_fixed && (pa - pc).dot(pb - pc) < 0.0 && a.max(b) < self.n_fixed;
                let victim = if flat { c } else { a.max(b) };
                if victim >= self.n_fixed && !touched[victim] && (flat || short(self.sizing.at(pa.midpoint(pb)))) {
                    out[victim] = true;
                    [a, b, c].into_iter().for_each(|v| touched[v] = true);
                }
            }
        }
        let hollow = |t: &[usize; 3]| {
            let center = circumcenter(t.map(|v| self.points[v]));
            let wide = center.distance(self.points[t[0]]) > HOLLOW * self.sizing.at(center);
            (wide && t.iter().all(|&v| !touched[v])).then_some(center)
        };
        let centers: Vec<DVec2> = triangles.iter().filter_map(hollow).collect();
        let mut numbers = 0..;
        self.points.retain(|_| numbers.next().is_none_or(|v: usize| !out[v]));
        let mut room = Room::new(self.outlines, self.sizing, cell, &self.points);
        self.points.extend(centers.into_iter().filter(|&c| room.try_take(c)));
    }

    /// Moves free corners of acute triangles, one after the other, wherever the smallest angle around them grows.
    pub(super) fn open_angles(&mut self, triangles: &[[usize; 3]]) {
        let stars = self.stars(triangles);
        let n_fixed = self.n_fixed;
        for &triangle in triangles {
            if smallest_angle(triangle.map(|v| self.points[v])) >= OPEN_BELOW.to_radians() {
                continue;
            }
            for v in triangle.into_iter().filter(|&v| v >= n_fixed) {
                self.open_around(v, &stars[v], triangles);
            }
        }
    }

    fn open_around(&mut self, v: usize, star: &[usize], triangles: &[[usize; 3]]) {
        let smallest = |draft: &Self, p: DVec2| {
            star.iter().map(|&t| smallest_angle(draft.moved(triangles[t], v, p))).fold(f64::INFINITY, f64::min)
        };
        let mut best = (smallest(self, self.points[v]), self.points[v]);
        let h = self.sizing.at(self.points[v]);
        for step in OPENING_STEPS {
            let from = best.1;
            for k in 0..8 {
                let place = from + DVec2::from_angle(TAU * f64::from(k) / 8.0) * step * h;
                let angle = smallest(self, place);
                if angle > best.0 {
                    best = (angle, place);
                }
            }
        }
        self.points[v] = best.1;
    }
}

/// Center of the circle through three points.
fn circumcenter([a, b, c]: [DVec2; 3]) -> DVec2 {
    let (u, v) = (b - a, c - a);
    a + (v.perp() * u.length_squared() - u.perp() * v.length_squared()) / (-2.0 * u.perp_dot(v))
}

/// Smallest angle of a triangle, radians; negative when it is turned over.
pub(super) fn smallest_angle(corners: [DVec2; 3]) -> f64 {
    let angle = |k: usize| {
        let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
        u.perp_dot(v).atan2(u.dot(v))
    };
    angle(0).min(angle(1)).min(angle(2))
}
