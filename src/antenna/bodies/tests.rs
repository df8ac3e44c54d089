//! Bodies that touch, overlap or are open.

use super::*;
use crate::antenna::{flat_complex, params};
use std::sync::{Arc, Mutex};

const TOLERANCE: f64 = 1e-6;

/// A box in mm with each side cut into `n` squares a side.
pub(crate) fn cuboid(name: &str, lo: [f64; 3], hi: [f64; 3], n: [usize; 3]) -> Body {
    let (lo, size) = (DVec3::from_array(lo), DVec3::from_array(hi) - DVec3::from_array(lo));
    let mut surface = TriMesh::default();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0.0, 1.0] {
            let first = surface.vertices.len();
            for i in 0..=n[u] {
                for j in 0..=n[v] {
                    let mut part = DVec3::ZERO;
                    (part[axis], part[u], part[v]) = (side, i as f64 / n[u] as f64, j as f64 / n[v] as f64);
                    surface.vertices.push((lo + size * part) * 1e-3);
                }
            }
            let id = |i: usize, j: usize| VertexId::new(first + i * (n[v] + 1) + j);
            for (i, j) in (0..n[u]).flat_map(|i| (0..n[v]).map(move |j| (i, j))) {
                let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
                let faces = if side > 0.5 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                surface.faces.extend(faces);
            }
        }
    }
    let material = Dielectric { eps_r: 2.2, tan_delta: 0.0 };
    Body { name: name.to_owned(), role: RegionRole::Dielectric, material, surface }
}

fn volume_mm3(plc: &Plc, name: &str) -> f64 {
    plc.boundary(plc.region(name).expect("a region")).volume() * 1e9
}

fn shared_area_mm2(plc: &Plc) -> f64 {
    let is_shared = |f: &usize| plc.facets[*f].front != RegionId::AIR;
    let area = |f: usize| crate::geometry::tri_mesh::doubled_area_vector(plc.corners(f)).length() / 2.0;
    (0..plc.facets.len()).filter(is_shared).map(area).sum::<f64>() * 1e6
}

#[test]
fn touching_boxes_with_different_triangles_share_their_interface() {
    let below = cuboid("below", [0.0, 0.0, 0.0], [6.0, 4.0, 1.0], [3, 2, 1]);
    // As large, and finer; smaller and within; hanging over the edge; moved by less than the tolerance.
    let above = [
        (cuboid("above", [0.0, 0.0, 1.0], [6.0, 4.0, 2.0], [5, 7, 2]), 24.0),
        (cuboid("above", [1.1, 1.3, 1.0], [2.7, 2.9, 2.0], [1, 1, 1]), 1.6 * 1.6),
        (cuboid("above", [4.3, 1.7, 1.0], [8.0, 6.0, 2.0], [2, 3, 1]), 1.7 * 2.3),
        (cuboid("above", [4.3, 1.7, 1.0 + 4e-4], [8.0, 6.0, 2.0], [2, 3, 1]), 1.7 * 2.3),
        (cuboid("above", [2.0, 4.0, 0.0], [4.0, 5.0, 1.0], [4, 1, 3]), 2.0),
    ];
    for (k, (above, area)) in above.into_iter().enumerate() {
        let own = above.surface.volume() * 1e9;
        let plc = weld(&[below.clone(), above], &[], TOLERANCE, &Task::default())
            .unwrap_or_else(|faults| panic!("{k}: {faults:?}"));
        assert_eq!(plc.check(), Ok(()), "{k}");
        assert!((volume_mm3(&plc, "below") - 24.0).abs() < 0.01, "{k}: {}", volume_mm3(&plc, "below"));
        assert!((volume_mm3(&plc, "above") - own).abs() < 0.01, "{k}: {}", volume_mm3(&plc, "above"));
        assert!((shared_area_mm2(&plc) - area).abs() < 1e-3, "{k}: {} for {area}", shared_area_mm2(&plc));
    }
}

#[test]
fn boxes_apart_by_more_than_the_tolerance_share_nothing() {
    let below = cuboid("below", [0.0, 0.0, 0.0], [6.0, 4.0, 1.0], [1, 1, 1]);
    let above = cuboid("above", [0.0, 0.0, 1.01], [6.0, 4.0, 2.0], [1, 1, 1]);
    let plc = weld(&[below, above], &[], TOLERANCE, &Task::default()).expect("apart");
    assert_eq!(plc.n_shared_facets(), 0, "a gap of 0.01 mm");
}

#[test]
fn an_open_body_is_refused_with_the_place() {
    let mut open = cuboid("lid", [0.0, 0.0, 0.0], [2.0, 2.0, 1.0], [1, 1, 1]);
    let lost = open.surface.faces.pop().expect("a face").map(|v| open.surface.vertices[v.index()]);
    let faults = weld(&[open], &[], TOLERANCE, &Task::default());
    let Err(WeldError::Faults(faults)) = faults else { panic!("open") };
    let [BodyFault::Open { body, count: 3, places }] = &faults[..] else { panic!("{faults:?}") };
    assert_eq!(body, "lid", "which");
    let middle = lost[0].midpoint(lost[1]);
    assert!(places.iter().any(|p| p.distance(middle) < 1e-9), "at the edges of the missing face: {places:?}");
    assert!(faults[0].to_string().contains("\"lid\" is open at 3 edges, ("), "{}", faults[0]);
}

#[test]
fn overlaps_are_refused_with_names_and_places() {
    let base = || cuboid("a", [0.0, 0.0, 0.0], [4.0, 4.0, 4.0], [2, 2, 2]);
    let others = [
        // Through each other; within; flush on all sides but one; the very same.
        ([2.0, 1.0, 1.0], [6.0, 3.0, 3.0]),
        ([1.0, 1.0, 1.0], [3.0, 3.0, 3.0]),
        ([2.0, 0.0, 0.0], [6.0, 4.0, 4.0]),
        ([0.0, 0.0, 0.0], [4.0, 4.0, 4.0]),
        ([1.0, 1.0, 0.0], [3.0, 3.0, 2.0]),
    ];
    for (k, (lo, hi)) in others.into_iter().enumerate() {
        let faults = weld(&[base(), cuboid("b", lo, hi, [1, 1, 1])], &[], TOLERANCE, &Task::default());
        let Err(WeldError::Faults(faults)) = faults else { panic!("overlap") };
        let BodyFault::Overlap { bodies, places, .. } = &faults[0] else { panic!("{k}: {faults:?}") };
        assert_eq!(bodies, &["a", "b"].map(str::to_owned), "{k}");
        let near = |p: &DVec3| p.cmpge(DVec3::splat(-1e-6)).all() && p.cmple(DVec3::splat(6.001e-3)).all();
        assert!(!places.is_empty() && places.iter().all(near), "{k}: {places:?}");
    }
}

#[test]
fn a_body_inside_out_is_turned_and_one_with_a_flipped_face_is_refused() {
    let mut body = cuboid("a", [0.0, 0.0, 0.0], [4.0, 4.0, 4.0], [2, 2, 2]);
    body.surface.faces.iter_mut().for_each(|f| f.swap(0, 1));
    let plc = weld(std::slice::from_ref(&body), &[], TOLERANCE, &Task::default()).expect("turned");
    assert!((volume_mm3(&plc, "a") - 64.0).abs() < 1e-9, "outward");
    body.surface.faces[5].swap(0, 1);
    let faults = weld(&[body], &[], TOLERANCE, &Task::default());
    let Err(WeldError::Faults(faults)) = faults else { panic!("flipped") };
    assert!(faults.iter().any(|f| matches!(f, BodyFault::Branching { .. })), "{faults:?}");
}

#[test]
fn a_body_that_fills_the_hole_of_another_shares_all_its_walls() {
    // A frame of four boxes around a fifth.
    let boxes = [
        ([0.0, 0.0], [9.0, 3.0]),
        ([0.0, 6.0], [9.0, 9.0]),
        ([0.0, 3.0], [3.0, 6.0]),
        ([6.0, 3.0], [9.0, 6.0]),
        ([3.0, 3.0], [6.0, 6.0]),
    ];
    let body = |(k, ([x, y], [u, v])): (usize, ([f64; 2], [f64; 2]))| {
        cuboid(&format!("b{k}"), [x, y, 0.0], [u, v, 1.0], [k + 1, 5 - k, 1 + k % 2])
    };
    let bodies: Vec<Body> = boxes.into_iter().enumerate().map(body).collect();
    let plc = weld(&bodies, &[], TOLERANCE, &Task::default()).expect("they touch");
    assert!((shared_area_mm2(&plc) - 24.0).abs() < 1e-6, "all walls: {}", shared_area_mm2(&plc));
}

#[test]
fn the_template_taken_apart_and_welded_again_is_the_same() {
    let flat = flat_complex(&params::tests::paper()).expect("the paper's antenna");
    let body = |(id, region): (RegionId, &Region)| Body {
        name: region.name.clone(),
        role: region.role,
        material: Dielectric { eps_r: region.eps_r, tan_delta: region.tan_delta },
        surface: flat.boundary(id),
    };
    let bodies: Vec<Body> = flat.solids().map(body).collect();
    let plc = weld(&bodies, &[], TOLERANCE, &Task::default()).expect("it was a complex");
    assert_eq!(plc.regions, flat.regions, "the same regions");
    assert_eq!(plc.facets.len(), flat.facets.len(), "the same facets");
    assert_eq!(plc.n_shared_facets(), flat.n_shared_facets(), "the same interfaces");
}

#[test]
fn a_feed_is_found_between_metal_and_its_ends_become_vertices() {
    let mut bodies = [
        cuboid("ground", [-8.0, -6.0, -1.1], [8.0, 6.0, -1.0], [1, 1, 1]),
        cuboid("base", [-8.0, -6.0, -1.0], [8.0, 6.0, 0.0], [3, 2, 1]),
        cuboid("top", [-3.3, -2.1, 0.0], [4.1, 2.3, 0.1], [1, 1, 1]),
    ];
    (bodies[0].role, bodies[2].role) = (RegionRole::Conductor, RegionRole::Conductor);
    let plain = weld(&bodies, &[], TOLERANCE, &Task::default()).expect("they touch");
    let at = crate::geometry::DVec2::new(1.23e-3, -0.7e-3);
    let ends = upright(&plain, at).expect("ground below, top above");
    assert!(ends[0].distance(at.extend(-1e-3)) < 1e-12 && ends[1].distance(at.extend(0.0)) < 1e-12, "{ends:?}");
    assert!(matches!(gap(&plain, ends, TOLERANCE), Err(GapError::OffMetal { .. })), "not yet vertices");
    let plc = weld(&bodies, &ends, TOLERANCE, &Task::default()).expect("with the feed");
    assert_eq!(plc.check(), Ok(()), "still a complex");
    let found = gap(&plc, ends, TOLERANCE).expect("a gap");
    assert_eq!(Some(found.region), plc.region("base"), "through the base");
    assert!(upright(&plain, crate::geometry::DVec2::new(6e-3, 0.0)).is_err(), "no metal above");
    let aslant = [ends[0], DVec3::new(4.1e-3, 2.3e-3, 0.1e-3)];
    assert!(matches!(gap(&plc, aslant, TOLERANCE), Err(GapError::Crosses { .. })), "through the top");
}

#[test]
fn welding_is_called_off_at_every_stage() {
    let bodies = [
        cuboid("a", [0.0, 0.0, 0.0], [4.0, 4.0, 4.0], [9, 9, 9]),
        cuboid("b", [0.0, 0.0, 4.0], [4.0, 4.0, 5.0], [7, 7, 1]),
    ];
    let seen = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&seen);
    let task = Task::with_progress(move |step| sink.lock().expect("no panic").push(step.phase));
    weld(&bodies, &[], TOLERANCE, &task).expect("they touch");
    let mut phases = seen.lock().expect("no panic").clone();
    phases.dedup();
    assert!(phases.len() >= 4, "all stages tell of themselves: {phases:?}");
    for phase in phases {
        let cancel = Task::default();
        let stop = cancel.clone();
        let task = cancel.listening(move |step| {
            if step.phase == phase {
                stop.cancel();
            }
        });
        let outcome = weld(&bodies, &[], TOLERANCE, &task);
        assert!(matches!(outcome, Err(WeldError::Cancelled(_))), "{phase}: {:?}", outcome.map(|plc| plc.facets.len()));
    }
}
