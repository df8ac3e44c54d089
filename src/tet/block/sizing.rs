//! How long the edges of the footprint should be at a place.
//!
//! The rim of the patch rules the accuracy of the field, so lengths start there, and at the segments of the feed's
//! circles, and grow linearly to the length wanted inside the block; so they do from a resistor that stands close to
//! something else.

use super::{BlockError, BlockSettings, Metal};
use crate::antenna::PatchParams;
use crate::antenna::outline::{edges, nearest};
use crate::geometry::DVec2;
use std::f64::consts::TAU;

/// Growth of the edge length per distance: above it neighboring triangles differ too much to be well shaped, below it
/// the fine rim costs more triangles than it is worth.
const SLOPE: f64 = 0.22;
/// Width of the strip on both sides of the rim in which lengths do not grow yet, in rim lengths: the field's
/// singularity at the edge wants two even rows of triangles.
const STRIP: f64 = 0.75;
/// Length aimed at far from the rim, relative to the one asked for: the packing leaves single edges much longer, which
/// with the layers' height rule the flattest tetrahedra there.
const AIM: f64 = 0.83;
/// Greatest edge of the sheath within a solid ground, in thicknesses of it: longer ones make its tetrahedra, the
/// flattest of all that carry a field, flatter still.
const SHEATH: f64 = 10.0;
/// The least that this asks for, in segments of the outer conductor: thin foil must not make the mesh grow without end.
const SHEATH_LEAST: f64 = 0.6;
/// Fewest segments of the pin's and the outer conductor's polygon: with fewer their triangles have angles that no
/// placing of inner points mends.
const MIN_SEGMENTS: [usize; 2] = [10, 20];
/// Greatest number of points expected of a footprint; about a million tetrahedra in four layers.
const MAX_POINTS: f64 = 50_000.0;

/// A circle of the feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Circle {
    pub(super) center: DVec2,
    pub(super) radius: f64,
    /// Segments of the polygon that stands for it.
    pub(super) segments: usize,
}

impl Circle {
    /// Length of a segment, m.
    pub(super) fn segment(&self) -> f64 {
        TAU * self.radius / self.segments as f64
    }
}

/// The wanted edge length as a function of the place.
#[derive(Clone, Debug)]
pub(super) struct Sizing {
    /// Half the patch's extents, m.
    patch: DVec2,
    /// Sides of a patch that is no rectangle, and the length wanted at each, m.
    sides: Vec<(DVec2, DVec2, f64)>,
    rim: f64,
    inner: f64,
    /// Greatest length within the outer conductor.
    sheath: f64,
    /// The pin's and the outer conductor's circle; none without a feed.
    pub(super) circles: Vec<Circle>,
    /// Places of the resistors, and the length wanted there.
    posts: Vec<(DVec2, f64)>,
}

/// Places of the resistors, and the distance of each to whatever is nearest.
fn posts(params: &PatchParams) -> Vec<(DVec2, f64)> {
    let room = |k: usize| {
        let at = params.resistors[k].at;
        let others = params.resistors.iter().enumerate().filter(|(other, _)| *other != k);
        let to_others = others.map(|(_, other)| at.distance(other.at));
        let to_feed = at.distance(params.feed()) - params.coax_radius;
        (at, to_others.fold(to_feed.min(params.inside_patch(at)), f64::min))
    };
    (0..params.resistors.len()).map(room).collect()
}

impl Sizing {
    /// Checks the settings and takes the lengths from them and from valid parameters.
    pub(super) fn new(params: &PatchParams, settings: &BlockSettings) -> Result<Self, BlockError> {
        for (field, value) in [("rim", settings.rim), ("inner", settings.inner)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(BlockError::Length { field, value });
            }
        }
        if settings.layers == 0 {
            return Err(BlockError::NoLayers);
        }
        let circle =
            |radius, segments: usize, fewest| Circle { center: params.feed(), radius, segments: segments.max(fewest) };
        let pin = circle(params.pin_radius, params.pin_segments, MIN_SEGMENTS[0]);
        let sheath = circle(params.coax_radius, params.coax_segments, MIN_SEGMENTS[1]);
        let rim = settings.rim.min(AIM * settings.inner);
        let sizing = Self {
            patch: DVec2::new(params.width, params.length) / 2.0,
            sides: edges(&params.outline).map(|(a, b)| (a, b, rim.min(a.distance(b)))).collect(),
            rim,
            inner: AIM * settings.inner,
            sheath: match settings.metal {
                Metal::Sheet => f64::INFINITY,
                Metal::Solid => (SHEATH * params.ground_thickness).max(SHEATH_LEAST * sheath.segment()),
            },
            circles: if settings.coax { vec![pin, sheath] } else { Vec::new() },
            posts: posts(params),
        };
        let n_points = sizing.n_points(params.ground_width * params.ground_length);
        if n_points > MAX_POINTS {
            return Err(BlockError::TooFine { n_points });
        }
        Ok(sizing)
    }

    /// Edge length wanted at a place, m.
    pub(super) fn at(&self, p: DVec2) -> f64 {
        let from_rim = if self.sides.is_empty() {
            let off = p.abs() - self.patch;
            let to_rim = if off.max_element() > 0.0 { off.max(DVec2::ZERO).length() } else { -off.max_element() };
            self.rim + SLOPE * (to_rim - STRIP * self.rim).max(0.0)
        } else {
            let from_side = |&(a, b, rim): &(DVec2, DVec2, f64)| {
                rim + SLOPE * (nearest((a, b), p).distance(p) - STRIP * rim).max(0.0)
            };
            self.sides.iter().map(from_side).fold(f64::INFINITY, f64::min)
        };
        let from_circles = self.circles.iter().map(|c| {
            let away = p.distance(c.center) - c.radius;
            let from_circle = c.segment() + SLOPE * away.abs();
            if away <= 0.0 { from_circle.min(self.sheath) } else { from_circle.min(self.sheath + SLOPE * away) }
        });
        let from_posts = self.posts.iter().map(|(at, room)| room + SLOPE * p.distance(*at));
        from_circles.chain(from_posts).fold(self.inner.min(from_rim), f64::min)
    }

    /// About the number of points of a footprint of some area, m².
    fn n_points(&self, area: f64) -> f64 {
        // Along a line, the integral of 1 / h² over the growth on both sides; triangles are near equilateral.
        let along = |length: f64, h: f64| 2.0 * length / (SLOPE * h);
        let rim = match self.sides.is_empty() {
            true => along(4.0 * self.patch.element_sum(), self.rim),
            false => self.sides.iter().map(|&(a, b, rim)| along(a.distance(b), rim)).sum(),
        };
        let circles: f64 = self.circles.iter().map(|c| along(c.segment() * c.segments as f64, c.segment())).sum();
        (area / self.inner.powi(2) + rim + circles) * 2.0 / 3.0_f64.sqrt()
    }
}
