//! What lies under the pointer, on the processor: handles, parts of the gizmo, and the surface with its value.
//!
//! Places on the screen are points from the top left, as everywhere in [`super`].

use super::camera::Ray;
use super::gizmo::{self, Gizmo, GizmoPart};
use super::scene::Surface;
use super::view::View;
use super::{Vec2, Vec3};

/// Handles whose distances from the pointer differ by less than this many points overlap: the nearer to the eye wins.
const OVERLAP: f32 = 3.0;
/// How far beside an arrow or a ring still counts, points.
const ARROW_MARGIN: f32 = 6.0;
const RING_MARGIN: f32 = 6.0;
/// How far from the middle of a knob still counts, points.
const KNOB_RADIUS: f32 = 10.0;
/// How far beside the center still counts, points.
const CENTER_MARGIN: f32 = 3.0;

/// The handle closest to `pointer` among those at most `radius` points away; where several overlap, the front one.
#[must_use]
pub fn handle_at(view: &View, positions: &[Vec3], pointer: Vec2, radius: f32) -> Option<usize> {
    let near: Vec<(usize, f32, f32)> = positions
        .iter()
        .enumerate()
        .filter_map(|(i, &p)| view.project(p).map(|q| (i, q.at.distance(pointer), q.depth)))
        .filter(|&(_, distance, _)| distance <= radius)
        .collect();
    let least = near.iter().map(|h| h.1).min_by(f32::total_cmp)?;
    let overlapping = near.iter().filter(|h| h.1 <= least + OVERLAP);
    overlapping.min_by(|a, b| a.2.total_cmp(&b.2)).map(|h| h.0)
}

/// The handles in the rectangle between two opposite corners, in ascending order.
#[must_use]
pub fn handles_in(view: &View, positions: &[Vec3], corner: Vec2, opposite: Vec2) -> Vec<usize> {
    let (low, high) = (corner.min(opposite), corner.max(opposite));
    let inside = |p: Vec2| p.cmpge(low).all() && p.cmple(high).all();
    let seen = positions.iter().enumerate();
    seen.filter(|&(_, &p)| view.project(p).is_some_and(|q| inside(q.at))).map(|(i, _)| i).collect()
}

/// The handles inside a closed line drawn by hand, by the even-odd rule, in ascending order.
#[must_use]
pub fn handles_within(view: &View, positions: &[Vec3], outline: &[Vec2]) -> Vec<usize> {
    let sides = || outline.iter().zip(outline.iter().cycle().skip(1));
    let crosses =
        |p: Vec2, a: Vec2, b: Vec2| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    let inside = |p: Vec2| sides().filter(|(a, b)| crosses(p, **a, **b)).count() % 2 == 1;
    let seen = positions.iter().enumerate();
    seen.filter(|&(_, &p)| view.project(p).is_some_and(|q| inside(q.at))).map(|(i, _)| i).collect()
}

/// The part of `gizmo` under the pointer: the center, then knobs and arrows, near ones before far ones, then the rings.
#[must_use]
pub fn gizmo_at(view: &View, gizmo: &Gizmo, pointer: Vec2) -> Option<GizmoPart> {
    let center = view.project(gizmo.center)?;
    if center.at.distance(pointer) <= gizmo::CENTER_RADIUS + CENTER_MARGIN {
        return Some(GizmoPart::Center);
    }
    let arms = gizmo::arms(view, gizmo.center);
    let knob = arms.iter().rev().find(|arm| gizmo.is_whole && arm.knob.distance(pointer) <= KNOB_RADIUS);
    if let Some(arm) = knob {
        return Some(GizmoPart::Knob(arm.axis));
    }
    let arrow = arms.iter().rev().find(|arm| distance_to_segment(pointer, arm.from, arm.tip) <= ARROW_MARGIN);
    if let Some(arm) = arrow {
        return Some(GizmoPart::Arrow(arm.axis));
    }
    let distance = |line: &[Vec2]| {
        line.windows(2).map(|pair| distance_to_segment(pointer, pair[0], pair[1])).fold(f32::INFINITY, f32::min)
    };
    let rings = gizmo::rings(view, gizmo.center).into_iter().filter(|_| gizmo.is_whole);
    let nearest = rings.map(|(axis, line)| (axis, distance(&line))).min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.filter(|(_, distance)| *distance <= RING_MARGIN).map(|(axis, _)| GizmoPart::Ring(axis))
}

fn distance_to_segment(point: Vec2, from: Vec2, to: Vec2) -> f32 {
    let along = to - from;
    let t = ((point - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(from + t * along)
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Part of the surface.
    pub part: usize,
    /// Triangle of the part.
    pub triangle: usize,
    /// Weights of the triangle's corners; they sum to 1.
    pub weights: [f32; 3],
    /// The place, mm.
    pub point: Vec3,
    /// From the origin of the ray, mm.
    pub distance: f32,
    /// The surface's scalar there, in its unit, if it has one.
    pub value: Option<f32>,
}

/// The first triangle of `surface` under the pointer, from either side, whatever its opacity.
#[must_use]
pub fn surface_at(view: &View, surface: &Surface, pointer: Vec2) -> Option<SurfaceHit> {
    let ray = view.ray(pointer);
    let mut nearest: Option<SurfaceHit> = None;
    for (place, part) in surface.parts.iter().enumerate() {
        for (triangle, &indices) in part.triangles.iter().enumerate() {
            let [Some(&a), Some(&b), Some(&c)] = indices.map(|v| surface.positions.get(v as usize)) else { continue };
            let Some((distance, weights)) = meet(&ray, [a, b, c]) else { continue };
            if nearest.is_none_or(|hit| distance < hit.distance) {
                let value = value_at(surface, indices, weights);
                nearest = Some(SurfaceHit { part: place, triangle, weights, point: ray.at(distance), distance, value });
            }
        }
    }
    nearest
}

fn value_at(surface: &Surface, indices: [u32; 3], weights: [f32; 3]) -> Option<f32> {
    let values = &surface.scalars.as_ref()?.values;
    let [a, b, c] = indices.map(|v| values.get(v as usize));
    Some(weights[0] * a? + weights[1] * b? + weights[2] * c?)
}

/// Distance along the ray and the weights of the corners where it meets a triangle, border included.
///
/// Source: \[MT97\] Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection*, 1997. In `f64`, so that
/// slivers seen at a grazing angle are still hit.
fn meet(ray: &Ray, corners: [Vec3; 3]) -> Option<(f32, [f32; 3])> {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (u_side, v_side) = (b - a, c - a);
    let p = direction.cross(v_side);
    let determinant = u_side.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from_corner = origin - a;
    let u = from_corner.dot(p) / determinant;
    let q = from_corner.cross(u_side);
    let v = direction.dot(q) / determinant;
    let t = v_side.dot(q) / determinant;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= f64::from(ray.start);
    inside.then(|| narrow(t, [1.0 - u - v, u, v]))
}

#[allow(clippy::cast_possible_truncation, reason = "rounded to what the picture shows")]
fn narrow(distance: f64, weights: [f64; 3]) -> (f32, [f32; 3]) {
    (distance as f32, weights.map(|w| w as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Array, Camera, ColorMap, Paint, Part, Projection, Scalars, StandardView};

    fn top() -> View {
        let mut camera = Camera { distance: 100.0, ..Camera::default() };
        camera.look_from(StandardView::Top);
        View::new(camera, 800.0, 600.0)
    }

    fn on_screen(view: &View, point: Vec3) -> Vec2 {
        view.project(point).expect("in front of the eye").at
    }

    #[test]
    fn the_closest_handle_within_the_radius_is_taken() {
        let view = top();
        let handles = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0)];
        let pointer = on_screen(&view, handles[1]) + Vec2::new(-4.0, 0.0);
        assert_eq!(handle_at(&view, &handles, pointer, 10.0), Some(1), "the second is closer");
        assert_eq!(handle_at(&view, &handles, pointer, 3.0), None, "out of reach");
    }

    #[test]
    fn of_overlapping_handles_the_front_one_is_taken() {
        let view = top();
        // Seen from above, both at the middle of the picture; the lower one is hit a trifle better.
        let handles = [Vec3::new(0.0, 0.0, -5.0), Vec3::new(0.1, 0.0, 5.0)];
        assert_eq!(handle_at(&view, &handles, view.size / 2.0, 10.0), Some(1), "the upper one is in front");
    }

    #[test]
    fn a_rectangle_selects_what_it_covers_whichever_way_it_was_drawn() {
        let view = top();
        let handles = [Vec3::ZERO, Vec3::new(5.0, 5.0, 0.0), Vec3::new(-5.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 200.0)];
        let [a, b] = [Vec3::new(-1.0, 6.0, 0.0), Vec3::new(6.0, -1.0, 0.0)].map(|p| on_screen(&view, p));
        assert_eq!(handles_in(&view, &handles, a, b), [0, 1], "the fourth is behind the eye");
        assert_eq!(handles_in(&view, &handles, b, a), [0, 1], "dragged backwards");
    }

    #[test]
    fn a_lasso_selects_what_lies_inside_it_and_not_in_its_bay() {
        let view = top();
        let handles = [[0.0, 6.0], [-6.0, -6.0], [6.0, -6.0], [20.0, 0.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        // A "U" turned over: the first handle is in its bow, the next two in its legs; the middle is left out.
        let line =
            [[-9.0, -9.0], [-9.0, 9.0], [9.0, 9.0], [9.0, -9.0], [3.0, -9.0], [3.0, 3.0], [-3.0, 3.0], [-3.0, -9.0]];
        let line: Vec<Vec2> = line.iter().map(|&[x, y]| on_screen(&view, Vec3::new(x, y, 0.0))).collect();
        assert_eq!(handles_within(&view, &handles, &line), [0, 1, 2], "the fourth is outside");
        assert_eq!(handles_within(&view, &[Vec3::ZERO], &line), [0; 0], "nor is the bay part of it");
        assert_eq!(handles_within(&view, &handles, &line[..1]), [0; 0], "a point encloses nothing");
    }

    #[test]
    fn every_part_is_found_where_it_is_and_what_no_drag_could_use_is_not_there() {
        let mut gizmo = Gizmo { center: Vec3::ZERO, is_whole: true, colors: [[0; 4]; 4], hot: None, hot_color: [0; 4] };
        let view = top();
        let middle = view.size / 2.0;
        let at = |gizmo: &Gizmo, x: f32, y: f32| gizmo_at(&view, gizmo, middle + Vec2::new(x, -y));
        assert_eq!(at(&gizmo, 0.0, 0.0), Some(GizmoPart::Center), "the middle");
        assert_eq!(at(&gizmo, 66.0, 3.0), Some(GizmoPart::Arrow(0)), "to the right");
        assert_eq!(at(&gizmo, -3.0, 66.0), Some(GizmoPart::Arrow(1)), "upwards");
        assert_eq!(at(&gizmo, -66.0, 0.0), None, "there is no arrow to the left");
        assert_eq!(at(&gizmo, 92.0, -7.0), Some(GizmoPart::Knob(0)), "beyond the tip");
        assert_eq!(at(&gizmo, -37.0, -37.0), Some(GizmoPart::Ring(2)), "around z, from the back too");
        let has_z = gizmo::arms(&view, Vec3::ZERO).iter().any(|arm| arm.axis == 2);
        assert!(!has_z, "z points at the viewer");
        let rings: Vec<usize> = gizmo::rings(&view, Vec3::ZERO).iter().map(|ring| ring.0).collect();
        assert_eq!(rings, [2], "the others are seen from their edges");
        gizmo.is_whole = false;
        assert_eq!((at(&gizmo, 92.0, 0.0), at(&gizmo, -37.0, -37.0)), (None, None), "one vertex is not turned");
    }

    #[test]
    fn each_part_can_be_taken_hold_of_at_its_grip_from_near_and_far() {
        let gizmo = Gizmo { center: Vec3::ONE, is_whole: true, colors: [[0; 4]; 4], hot: None, hot_color: [0; 4] };
        for distance in [40.0, 400.0] {
            let mut camera = Camera { distance, ..Camera::default() };
            camera.look_from(StandardView::Isometric);
            let view = View::new(camera, 800.0, 600.0);
            let center = on_screen(&view, gizmo.center);
            let parts = (0..3).flat_map(|a| [GizmoPart::Arrow(a), GizmoPart::Ring(a), GizmoPart::Knob(a)]);
            for part in parts.chain([GizmoPart::Center]) {
                let grip = gizmo::grip(&view, &gizmo, part).expect("it is there");
                assert_eq!(gizmo_at(&view, &gizmo, grip), Some(part), "at a distance of {distance}");
                assert!(grip.distance(center) < 100.0, "{part:?}: of constant size on the screen");
            }
        }
    }

    /// A square of 20 mm in z = 0 and one below it, with the field 3x + 2.
    fn squares() -> Surface {
        let square =
            |z: f32| [(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)].map(|(x, y)| Vec3::new(x, y, z));
        let positions: Vec<Vec3> = square(-4.0).into_iter().chain(square(0.0)).collect();
        let values: Vec<f32> = positions.iter().map(|p| 3.0 * p.x + 2.0).collect();
        let part = |k: u32| Part::new(vec![[k, k + 1, k + 2], [k, k + 2, k + 3]].into(), Paint::Heat);
        let scalars = Scalars { values: values.into(), range: [0.0, 1.0], map: ColorMap::Viridis };
        Surface { positions: positions.into(), parts: vec![part(0), part(4)], scalars: Some(scalars) }
    }

    #[test]
    fn the_nearest_surface_is_hit_with_its_value() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let mut view = top();
            view.camera.projection = projection;
            let mut rng = fastrand::Rng::with_seed(5);
            let surface = squares();
            for _ in 0..50 {
                let place = Vec3::new(rng.f32() * 18.0 - 9.0, rng.f32() * 18.0 - 9.0, 0.0);
                let hit = surface_at(&view, &surface, on_screen(&view, place)).expect("the square is hit");
                assert_eq!(hit.part, 1, "the upper square is nearer");
                assert!(hit.point.distance(place) < 1e-3, "{} for {place}", hit.point);
                assert!((hit.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "weights {:?}", hit.weights);
                let value = hit.value.expect("there is a field");
                assert!((value - (3.0 * place.x + 2.0)).abs() < 1e-2, "value {value} at {place}");
            }
        }
    }

    #[test]
    fn nothing_is_hit_beside_behind_or_in_broken_triangles() {
        let (view, mut surface) = (top(), squares());
        let beside = on_screen(&view, Vec3::new(15.0, 0.0, 0.0));
        assert_eq!(surface_at(&view, &surface, beside), None, "beside");
        surface.positions = surface.positions.iter().map(|p| *p + 200.0 * Vec3::Z).collect::<Vec<_>>().into();
        assert_eq!(surface_at(&view, &surface, view.size / 2.0), None, "behind the eye");
        surface.positions = Array::default();
        assert_eq!(surface_at(&view, &surface, view.size / 2.0), None, "no positions");
    }
}
