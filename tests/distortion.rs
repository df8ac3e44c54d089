//! Distortion and compensation of the paper's antenna against independent reference data.
#![allow(clippy::print_stdout, reason = "figures are shown by --nocapture")]

use conformant::antenna::PatchParams;
use conformant::cage::{Axis, BendRule, Cage, CageParams, Preset, pose};
use conformant::deform::{GreenCage, GreenMap, Pose, Warp};
use conformant::distortion::{
    Compensated, CompensationError, Cylinder, IsometricProblem, RhoGrid, Scope, Sheet, WlProblem, compensate_isometric,
    compensate_wl, measure,
};
use conformant::geometry::{DVec2, DVec3};
use conformant::project::AntennaSpec;
use conformant::task::Task;
use conformant::units::{from_mm, to_mm};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A tenth of a percentage point of rho.
const RHO_TOLERANCE: f64 = 1e-3;

fn paper() -> PatchParams {
    AntennaSpec::default().to_params()
}

struct BentCage {
    cage: Cage,
    green: Arc<GreenCage>,
}

impl BentCage {
    fn new(padding_mm: f64, segments: [usize; 2]) -> Self {
        let params = CageParams { padding: DVec3::splat(from_mm(padding_mm)), segments };
        let cage = Cage::around(paper().bounds(), &params).expect("valid cage");
        let green = Arc::new(GreenCage::new(cage.mesh.clone()).expect("closed cage"));
        Self { cage, green }
    }

    fn pose(&self, presets: &[Preset]) -> Pose {
        let posed = pose(&self.cage, presets).expect("valid presets");
        Pose::new(&self.green, &posed).expect("no collapsed face")
    }

    fn map(&self, presets: &[Preset]) -> GreenMap {
        GreenMap::new(Arc::clone(&self.green), self.pose(presets))
    }
}

fn bend(axis: Axis, radius_mm: f64, rule: BendRule) -> Preset {
    Preset::Bend { axis, radius: from_mm(radius_mm), rule, kept_plane: 0.0 }
}

fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().skip(1).map(|l| l.split(',').collect()).collect()
}

fn rule(name: &str) -> BendRule {
    if name == "tangent" { BendRule::Tangent } else { BendRule::Arc }
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number")
}

#[test]
fn raw_rho_equals_the_reference_over_paddings_segments_radii_and_rules() {
    let table = rows(include_str!("golden/green/rho_raw.csv"));
    let grid = RhoGrid::new(&paper());
    let mut by_cage: BTreeMap<(&str, &str), Vec<&Vec<&str>>> = BTreeMap::new();
    table.iter().for_each(|r| by_cage.entry((r[1], r[2])).or_default().push(r));
    let mut worst = 0.0_f64;
    for ((padding, n), rows) in by_cage {
        let cage = BentCage::new(number(padding), [n.parse().expect("a count"), 1]);
        let weights = cage.green.weights(&grid.points(DVec2::ONE), &Task::default()).expect("inside");
        for row in rows {
            let pose = cage.pose(&[bend(Axis::X, number(row[3]), rule(row[0]))]);
            let [patch, substrate] = grid.rho(&weights.apply(&pose));
            let error = (patch - number(row[4])).abs().max((substrate - number(row[5])).abs());
            assert!(error < RHO_TOLERANCE, "{row:?}: patch {patch}, substrate {substrate}");
            worst = worst.max(error);
        }
    }
    println!("worst difference {:.4} percentage points", worst * 100.0);
}

#[test]
fn wl_compensation_equals_the_reference() {
    let table = rows(include_str!("golden/green/rho_wl.csv"));
    let params = paper();
    let grid = RhoGrid::new(&params);
    for row in table {
        let cage = BentCage::new(number(row[1]), [row[2].parse().expect("a count"), 1]);
        let map = cage.map(&[bend(Axis::X, number(row[5]), rule(row[0]))]);
        let orders = [3, 4].map(|i| row[i].parse().expect("an order"));
        let problem = WlProblem { params: &params, map: &map, scope: Scope::Patch, orders };
        let found = compensate_wl(&problem, &Task::default()).expect("converges");
        assert_eq!(found.steps.len() - 1, row[6].parse::<usize>().expect("a count"), "rescalings of {row:?}");
        let width = to_mm(params.width * found.patch_scale.x);
        let length = to_mm(params.length * found.patch_scale.y);
        let apart = (width / number(row[7]) - 1.0).abs().max((length / number(row[8]) - 1.0).abs());
        assert!(apart < 2e-4, "{row:?}: {width} x {length} mm");
        let sheet = Sheet { scale: found.patch_scale, warp: &found.warp, map: &map };
        let [rho, _] = grid.rho_of(&sheet, &sheet_unscaled(&found, &map)).expect("inside");
        assert!((rho - number(row[9])).abs() < RHO_TOLERANCE, "{row:?}: rho {rho}");
    }
}

fn sheet_unscaled<'a>(found: &'a Compensated, map: &'a GreenMap) -> Sheet<'a> {
    Sheet { scale: DVec2::ONE, warp: &found.warp, map }
}

#[test]
fn wl_of_the_patch_alone_converges_in_at_most_five_iterations_at_padding_1() {
    let params = paper();
    let cage = BentCage::new(1.0, [10, 1]);
    for radius in [4.2, 4.5, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 40.0, 60.0] {
        let map = cage.map(&[bend(Axis::X, radius, BendRule::Tangent)]);
        let problem = WlProblem { params: &params, map: &map, scope: Scope::Patch, orders: [5, 5] };
        let found = compensate_wl(&problem, &Task::default()).expect("converges");
        assert!(found.steps.len() <= 5, "R = {radius}: {} iterations", found.steps.len());
    }
}

#[test]
fn an_order_that_cannot_follow_the_bend_ends_in_a_message() {
    let params = paper();
    let cage = BentCage::new(1.0, [10, 1]);
    let map = cage.map(&[bend(Axis::X, 4.2, BendRule::Tangent)]);
    let problem = WlProblem { params: &params, map: &map, scope: Scope::Patch, orders: [1, 1] };
    let error = compensate_wl(&problem, &Task::default()).expect_err("a straight line has no arc length");
    assert!(
        matches!(error, CompensationError::Diverged { .. } | CompensationError::LeavesCage { .. }),
        "a clear refusal: {error}"
    );
}

fn isometric(axis: Axis, radius_mm: f64, padding_mm: f64) -> Result<(Compensated, Cylinder), CompensationError> {
    let params = paper();
    let segments = if axis == Axis::X { [10, 1] } else { [1, 10] };
    let cage = BentCage::new(padding_mm, segments);
    let cylinder = Cylinder { axis, radius: from_mm(radius_mm), kept_plane: 0.0 };
    let map_at = |factor: f64| Ok(cage.map(&[bend(axis, radius_mm * factor, BendRule::Tangent)]));
    let degrees = if axis == Axis::X { [9, 5] } else { [5, 9] };
    let problem = IsometricProblem { params: &params, degrees, cylinder: Some(cylinder), map_at: &map_at };
    Ok((compensate_isometric(&problem, &Task::default())?, cylinder))
}

#[test]
fn isometric_compensation_restores_strain_radius_and_thickness() {
    let params = paper();
    // The greatest distance from the cylinder is the sheet's anticlastic curve: it grows with the extent across the
    // bend, so that the E plane (10.83 mm across) shows more of it than the H plane (8.177 mm).
    for (axis, radius, padding, limit_mm) in [
        (Axis::X, 10.0, 3.0, 0.05),
        (Axis::Y, 10.0, 3.0, 0.06),
        (Axis::X, 6.5, 3.0, 0.05),
        (Axis::X, 10.0, 1.0, 0.05),
        (Axis::X, 10.0, 6.0, 0.05),
        (Axis::X, 60.0, 6.0, 0.05),
    ] {
        let (found, cylinder) = isometric(axis, radius, padding).expect("converges");
        let sheet = Sheet { scale: DVec2::ONE, warp: &found.warp, map: &found.map };
        let figures = measure(&params, &sheet, &sheet, Some(&cylinder), [5, 5]).expect("inside");
        let distance = figures.cylinder_distance.expect("a cylinder").greatest;
        println!(
            "{axis:?} R {radius} padding {padding}: {} steps, strain {:.5}, substrate strain {:.4}, distance {:.4} mm, thickness {:+.5}, radius {:.4} mm, rho {:+.4} %",
            found.steps.len(),
            figures.patch_strain,
            figures.substrate_strain,
            to_mm(distance),
            figures.thickness_error,
            to_mm(figures.radius.expect("a cylinder")),
            figures.rho_patch * 100.0
        );
        assert!(figures.patch_strain < 0.005, "{axis:?} R {radius}: patch strain {}", figures.patch_strain);
        assert!(to_mm(distance) < limit_mm, "{axis:?} R {radius}: {} mm from the cylinder", to_mm(distance));
        assert!(figures.thickness_error.abs() < 1e-3, "{axis:?} R {radius}: thickness {}", figures.thickness_error);
    }
}

#[test]
fn a_compensation_that_needs_more_room_than_the_cage_has_is_refused() {
    // Green coordinates shorten the sheet by a fifth at R = 4.2 mm; 1 mm of padding cannot hold what that takes.
    let error = isometric(Axis::X, 4.2, 1.0).expect_err("no room");
    assert!(matches!(error, CompensationError::LeavesCage { .. }), "{error}");
}

#[test]
fn a_warp_that_leaves_the_cage_is_refused() {
    let params = paper();
    let cage = BentCage::new(0.2, [10, 1]);
    let map = cage.map(&[bend(Axis::X, 4.2, BendRule::Tangent)]);
    let warp = Warp::scale(DVec2::splat(from_mm(10.0)), DVec2::new(1.2, 1.0));
    let sheet = Sheet { scale: DVec2::ONE, warp: &warp, map: &map };
    let error = measure(&params, &sheet, &sheet, None, [5, 5]).expect_err("12 mm in a half width of 10.2 mm");
    assert!(matches!(error, CompensationError::LeavesCage { .. }), "{error}");
}
