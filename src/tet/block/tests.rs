use super::prisms::smallest_dihedral;
use super::*;
use crate::antenna::outline::doubled_area;
use crate::antenna::outline::tests::{disc, e_shape};
use crate::antenna::params::tests::paper;
use crate::geometry::DVec2;
use crate::tet::FaceRole;
use crate::units::from_mm;
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

const KINDS: [(Metal, bool); 3] = [(Metal::Sheet, true), (Metal::Sheet, false), (Metal::Solid, true)];

fn settings((metal, coax): (Metal, bool)) -> BlockSettings {
    BlockSettings { rim: from_mm(0.4), inner: from_mm(0.8), layers: 4, metal, coax }
}

fn flat(params: &PatchParams, settings: &BlockSettings) -> Block {
    build::<BlockError>(params, settings, |flat| Ok(flat.to_vec())).expect("a flat block")
}

/// Onto an exact cylinder of some radius (mm) along y, whose top is the patch's plane.
fn arc(settings: &BlockSettings, radius_mm: f64) -> Block {
    let r = from_mm(radius_mm);
    let map = |p: &DVec3| DVec3::new((r + p.z) * (p.x / r).sin(), p.y, (r + p.z) * (p.x / r).cos() - r);
    build::<BlockError>(&paper(), settings, |flat| Ok(flat.iter().map(map).collect())).expect("a bent block")
}

/// The paper's antenna with the feed so far inside that no outlines cross: its circles are regular polygons.
fn deep_feed() -> PatchParams {
    PatchParams { inset: from_mm(3.5), ..paper() }
}

fn polygon(radius: f64, n: usize) -> f64 {
    n as f64 / 2.0 * radius * radius * (TAU / n as f64).sin()
}

fn area_vector(block: &Block, face: [VertexId; 3]) -> DVec3 {
    let [a, b, c] = face.map(|v| block.vertices[v.index()]);
    (b - a).cross(c - a) / 2.0
}

/// Marked area of a group, m².
fn marked(block: &Block, name: &str) -> f64 {
    let of = |face: &&MarkedFace| block.groups[face.group].name == name;
    block.faces.iter().filter(of).map(|f| area_vector(block, f.vertices).length()).sum()
}

fn volume_of(block: &Block, name: &str) -> f64 {
    let of = |t: &usize| block.regions[block.tets[*t].region.index()].name == name;
    (0..block.tets.len()).filter(of).map(|t| crate::tet::volume(block.corners(t))).sum()
}

fn assert_close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-12 * expected, "{what}: {found:e} against {expected:e}");
}

/// Dihedral angles in degrees, ascending, and the smallest inradius in mm, of the tetrahedra that carry a field.
fn quality(block: &Block) -> (Vec<f64>, f64) {
    let live = |t: &usize| block.regions[block.tets[*t].region.index()].role != RegionRole::Conductor;
    let corners: Vec<_> = (0..block.tets.len()).filter(live).map(|t| block.corners(t)).collect();
    let mut angles: Vec<f64> = corners.iter().map(|&c| smallest_dihedral(c).to_degrees()).collect();
    angles.sort_by(f64::total_cmp);
    let inradius = |c: &[DVec3; 4]| {
        let area = |f: &[usize; 3]| (c[f[1]] - c[f[0]]).cross(c[f[2]] - c[f[0]]).length() / 2.0;
        3.0 * crate::tet::volume(*c) / crate::tet::FACES.iter().map(area).sum::<f64>()
    };
    (angles, to_mm(corners.iter().map(inradius).fold(f64::INFINITY, f64::min)))
}

/// Smallest angle of the footprint in degrees.
fn footprint_angle(params: &PatchParams, settings: &BlockSettings) -> f64 {
    let print = footprint::triangulate(params, settings).expect("a footprint");
    let angles = print.triangles.iter().map(|t| draft::smallest_angle(t.map(|v| print.points[v])));
    angles.fold(PI, f64::min).to_degrees()
}

#[test]
fn blocks_are_valid_and_their_skin_is_a_sphere() {
    for kind in KINDS.into_iter().chain([(Metal::Solid, false)]) {
        for params in [paper(), deep_feed()] {
            let block = flat(&params, &settings(kind));
            assert_eq!(block.check(), Ok(()), "{kind:?}");
            // Closed and oriented by the check; with no pinched vertex, V - E + F is 2 for a sphere.
            let skin = block.skin();
            let corners: HashSet<_> = skin.iter().flatten().collect();
            assert_eq!(corners.len() + skin.len(), 2 + skin.len() * 3 / 2, "{kind:?}: Euler count");
        }
    }
}

#[test]
fn regions_have_the_volumes_of_their_solids() {
    let params = deep_feed();
    let pin = polygon(params.pin_radius, params.pin_segments);
    let sheath = polygon(params.coax_radius, params.coax_segments) - pin;
    let ground = params.ground_width * params.ground_length;
    let below = params.ground_thickness + params.coax_length;
    for kind in KINDS {
        let block = flat(&params, &settings(kind));
        let pin = if kind.1 { pin } else { 0.0 };
        assert_close(volume_of(&block, SUBSTRATE), (ground - pin) * params.height, "substrate");
        if kind.1 {
            assert_close(volume_of(&block, PIN), pin * (params.height + below), "pin");
            assert_close(volume_of(&block, COAX), sheath * below, "coax");
        }
        if kind.0 == Metal::Solid {
            assert_close(volume_of(&block, PATCH), params.width * params.length * params.patch_thickness, "patch");
            assert_close(volume_of(&block, GROUND), (ground - pin - sheath) * params.ground_thickness, "ground");
        }
    }
}

#[test]
fn sheets_port_and_sleeve_have_their_areas() {
    let params = deep_feed();
    let block = flat(&params, &settings((Metal::Sheet, true)));
    let [pin, line] = [(params.pin_radius, params.pin_segments), (params.coax_radius, params.coax_segments)]
        .map(|(r, n)| polygon(r, n));
    let rim = |r: f64, n: usize| 2.0 * n as f64 * r * (PI / n as f64).sin();
    let below = params.ground_thickness + params.coax_length;
    let feed = rim(params.pin_radius, params.pin_segments) * (params.height + below)
        + rim(params.coax_radius, params.coax_segments) * below
        + pin;
    assert_close(marked(&block, "pec_patch"), params.width * params.length, "patch");
    assert_close(marked(&block, "pec_ground"), params.ground_width * params.ground_length - line, "ground");
    assert_close(marked(&block, "port1"), line - pin, "port");
    assert_close(marked(&block, "pec_feed"), feed, "pin, its end and the sleeve");
    for face in block.faces.iter().filter(|f| block.groups[f.group].role == FaceRole::Port) {
        assert!(area_vector(&block, face.vertices).z < 0.0, "the port faces the air below");
        assert!(face.vertices.iter().all(|v| block.vertices[v.index()].z <= params.port_plane()), "on its plane");
    }
}

#[test]
fn solid_metal_is_marked_where_it_touches_no_metal() {
    let params = deep_feed();
    let block = flat(&params, &settings((Metal::Solid, true)));
    let pin = polygon(params.pin_radius, params.pin_segments);
    let line = polygon(params.coax_radius, params.coax_segments);
    let hole = 2.0 * params.coax_segments as f64 * params.coax_radius * (PI / params.coax_segments as f64).sin();
    let box_area = |x: f64, y: f64, t: f64| 2.0 * x * y + 2.0 * (x + y) * t;
    let patch = box_area(params.width, params.length, params.patch_thickness) - pin;
    let ground = box_area(params.ground_width, params.ground_length, params.ground_thickness) - 2.0 * line
        + hole * params.ground_thickness;
    assert_close(marked(&block, "pec_patch"), patch, "patch");
    assert_close(marked(&block, "pec_ground"), ground, "ground");
    assert_close(marked(&block, "port1"), line - pin, "port");
}

#[test]
fn crossing_outlines_keep_exact_areas_and_corners_on_the_circle() {
    let params = paper();
    let block = flat(&params, &settings((Metal::Sheet, true)));
    assert_close(marked(&block, "pec_patch"), params.width * params.length, "patch");
    let total = params.ground_width * params.ground_length;
    let pin = polygon(params.pin_radius, params.pin_segments);
    assert_close(marked(&block, "pec_ground") + marked(&block, "port1") + pin, total, "ground, port and pin");
    let on_port = |f: &&MarkedFace| block.groups[f.group].role == FaceRole::Port;
    let corners = block.faces.iter().filter(on_port).flat_map(|f| f.vertices);
    let radii = corners.map(|v| (block.flat[v.index()].truncate() - params.feed()).length());
    let largest = radii.fold(0.0, f64::max);
    assert!(largest <= params.coax_radius * (1.0 + 1e-12), "no corner leaves the rigid disc: {largest:e}");
    // The crossings of circle and radiating edge are corners of both.
    let edge = DVec2::new((params.coax_radius.powi(2) - params.inset.powi(2)).sqrt(), -params.length / 2.0);
    assert!(block.flat.iter().any(|p| p.truncate().distance(edge) < 1e-12), "a column at the crossing");
}

#[test]
fn the_paper_antenna_has_well_shaped_tetrahedra() {
    for (kind, angle, percentile, inradius_mm) in
        [(KINDS[0], 20.0, 25.0, 0.045), (KINDS[1], 22.0, 26.0, 0.059), (KINDS[2], 4.5, 6.0, 0.014)]
    {
        let block = flat(&paper(), &settings(kind));
        let (angles, inradius) = quality(&block);
        assert!(angles[0] >= angle, "{kind:?}: smallest dihedral {:.2} degrees", angles[0]);
        assert!(angles[angles.len() / 100] >= percentile, "{kind:?}: 1 % below {:.2}", angles[angles.len() / 100]);
        assert!(inradius >= inradius_mm, "{kind:?}: smallest inradius {inradius:.4} mm");
        assert!((24_000..40_000).contains(&angles.len()), "{kind:?}: {} tetrahedra", angles.len());
        let smallest = footprint_angle(&paper(), &settings(kind));
        assert!(smallest >= 28.0, "{kind:?}: smallest footprint angle {smallest:.1} degrees");
    }
}

#[test]
fn a_cylinder_keeps_the_quality() {
    for radius_mm in [10.0, 6.5] {
        let block = arc(&settings(KINDS[1]), radius_mm);
        assert_eq!(block.check(), Ok(()), "R = {radius_mm} mm");
        let (angles, inradius) = quality(&block);
        assert!(angles[0] >= 22.0, "R = {radius_mm} mm: smallest dihedral {:.2} degrees", angles[0]);
        assert!(inradius >= 0.050, "R = {radius_mm} mm: smallest inradius {inradius:.4} mm");
    }
}

#[test]
fn footprints_of_clear_outlines_have_no_small_angle() {
    for (inset, offset, rim) in [(3.5, 0.0, 0.4), (3.5, 1.3, 0.25), (1.2, 0.4, 0.3), (3.0, -2.0, 0.5), (1.75, 0.0, 0.3)]
    {
        let params = PatchParams { inset: from_mm(inset), feed_offset: from_mm(offset), ..paper() };
        let settings = BlockSettings { rim: from_mm(rim), ..settings(KINDS[0]) };
        let smallest = footprint_angle(&params, &settings);
        assert!(smallest >= 28.0, "inset {inset}, offset {offset}, rim {rim} mm: {smallest:.1} degrees");
    }
}

#[test]
fn a_circle_that_barely_passes_the_rim_ends_in_a_chord_along_it() {
    let params = PatchParams { coax_radius: from_mm(1.77), ..paper() };
    let settings = settings(KINDS[0]);
    let block = flat(&params, &settings);
    assert_eq!(block.check(), Ok(()), "valid");
    let below = |p: &&DVec3| p.z <= params.port_plane() && p.y < -params.length / 2.0;
    assert_eq!(block.flat.iter().filter(below).count(), 0, "the line ends at the rim");
    let smallest = footprint_angle(&params, &settings);
    assert!(smallest >= 12.0, "the outlines leave about 15 degrees: {smallest:.1}");
}

#[test]
fn edges_are_as_long_as_asked_for() {
    let settings = settings(KINDS[0]);
    let print = footprint::triangulate(&paper(), &settings).expect("a footprint");
    let mean = |within: &dyn Fn(DVec2) -> bool| {
        let edges = print.triangles.iter().flat_map(|t| [0, 1, 2].map(|k| [t[k], t[(k + 1) % 3]]));
        let ends = edges.map(|edge| edge.map(|v| print.points[v])).filter(|ends| ends.iter().all(|&p| within(p)));
        let lengths: Vec<f64> = ends.map(|[a, b]| a.distance(b)).collect();
        lengths.iter().sum::<f64>() / lengths.len() as f64
    };
    let far = mean(&|p| p.y > from_mm(6.0)) / settings.inner;
    assert!((0.85..1.0).contains(&far), "far from the rim {far:.3} of what was asked for");
    let rim = mean(&|p| (p.y - paper().length / 2.0).abs() < 1e-9 && p.x.abs() < paper().width / 2.0) / settings.rim;
    assert!((0.95..1.05).contains(&rim), "along the rim {rim:.3} of what was asked for");
}

#[test]
fn patches_of_any_outline_are_blocks_with_their_area() {
    // The outer conductor's circle reaches past the disc's edge in both, and into a slot of the letter.
    let near_edge = PatchParams { inset: from_mm(1.6), ..disc() };
    let near_slot = PatchParams { feed_offset: from_mm(0.5), inset: from_mm(2.2), ..e_shape() };
    for (params, allowed) in [(disc(), 1e-3), (near_edge, 0.01), (e_shape(), 0.01), (near_slot, 0.02)] {
        assert_eq!(params.validate(), Ok(()), "{params:?}");
        for kind in [KINDS[0], KINDS[2]] {
            let block = flat(&params, &settings(kind));
            assert_eq!(block.check(), Ok(()), "{kind:?} {params:?}");
            if kind.0 == Metal::Sheet {
                // Corners close to the circle are put onto it.
                let (found, drawn) = (marked(&block, "pec_patch"), doubled_area(&params.outline) / 2.0);
                assert!((found / drawn - 1.0).abs() < allowed, "{found:e} m2, drawn {drawn:e}");
                let (angles, _) = quality(&block);
                assert!(angles[0] > 4.0, "smallest dihedral angle {}", angles[0]);
            }
        }
    }
}

#[test]
fn random_valid_parameters_give_valid_blocks() {
    let mut rng = fastrand::Rng::with_seed(5);
    let mut built = 0;
    for _ in 0..16 {
        let mut params = paper();
        let mut scale = |value: &mut f64| *value *= 0.6 + 0.8 * rng.f64();
        for value in [&mut params.width, &mut params.length, &mut params.inset, &mut params.coax_radius] {
            scale(value);
        }
        params.feed_offset = from_mm(6.0 * rng.f64() - 3.0);
        params.coax_segments = rng.usize(8..40);
        let kind = KINDS[rng.usize(0..3)];
        let settings = BlockSettings { layers: rng.usize(1..5), inner: from_mm(1.0), ..settings(kind) };
        if params.validate().is_ok() {
            assert_eq!(flat(&params, &settings).check(), Ok(()), "{params:?}");
            built += 1;
        }
    }
    assert!(built > 8, "only {built} of 16 were valid");
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let settings = settings(KINDS[0]);
    assert_eq!(flat(&paper(), &settings), flat(&paper(), &settings), "no chance is involved");
}

#[test]
fn a_folding_map_is_refused_with_its_place() {
    let crease = from_mm(6.0);
    let fold = |p: &DVec3| if p.x > crease { DVec3::new(2.0 * crease - p.x, p.y, p.z) } else { *p };
    let refused = build::<BlockError>(&paper(), &settings(KINDS[0]), |flat| Ok(flat.iter().map(fold).collect()))
        .expect_err("the sheet is doubled back");
    let BlockError::Folded { at, flat, n_folded } = refused else { panic!("{refused}") };
    assert!(flat.x > crease - from_mm(1.0) && at.x < crease + from_mm(1.0), "{at} from {flat}");
    assert!(n_folded > 1000, "{n_folded} tetrahedra lie beyond the crease");
    let gone = build::<BlockError>(&paper(), &settings(KINDS[0]), |flat| Ok(vec![DVec3::NAN; flat.len()]));
    assert!(matches!(gone, Err(BlockError::Folded { .. })), "no number is no place");
}

#[test]
fn useless_settings_are_refused() {
    let good = settings(KINDS[0]);
    let refused = |settings: &BlockSettings| {
        build::<BlockError>(&paper(), settings, |flat| Ok(flat.to_vec())).expect_err("not of use").to_string()
    };
    assert!(refused(&BlockSettings { rim: 0.0, ..good }).contains("rim"), "no length");
    assert!(refused(&BlockSettings { inner: f64::NAN, ..good }).contains("inner"), "no number");
    assert!(refused(&BlockSettings { layers: 0, ..good }).contains("layer"), "no layers");
    assert!(refused(&BlockSettings { rim: 1e-7, ..good }).contains("points"), "out of memory");
}
