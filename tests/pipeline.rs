//! The whole way from a project to the deformed antenna.
#![allow(clippy::print_stdout, reason = "figures are shown by --nocapture")]

use conformant::deform::DeformError;
use conformant::distortion::Figures;
use conformant::geometry::{DVec3, Plc, VertexId};
use conformant::pipeline::{Deformed, PipelineError, deform, exact_cylinder, retreat, run};
use conformant::project::{BendPlane, CompensationMode, PresetEntry, PresetSpec, Project, RuleSpec, ScopeSpec};
use conformant::task::{Cancelled, Task};

fn bend(plane: BendPlane, radius_mm: f64) -> PresetEntry {
    let preset = PresetSpec::Bend { plane, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    PresetEntry { enabled: true, preset }
}

fn project(presets: &[PresetEntry], mode: CompensationMode) -> Project {
    let mut project = Project { presets: presets.to_vec(), ..Project::default() };
    project.settings.compensation = mode;
    // Segments where the sheet curves.
    let along_y = matches!(presets, [PresetEntry { preset: PresetSpec::Bend { plane: BendPlane::E, .. }, .. }]);
    project.cage.segments = if along_y { [1, 10] } else { [10, 1] };
    project
}

fn done(project: &Project) -> Deformed {
    deform(project, &Task::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn figures(deformed: &Deformed) -> Figures {
    deformed.figures.expect("the template has figures")
}

/// Regions of the deformed surface are closed, and have about the volumes of the flat one.
fn check_surface(surface: &Plc, flat: &Plc) {
    assert_eq!(surface.check(), Ok(()), "every region is closed");
    for (region, named) in surface.solids() {
        let ratio = surface.boundary(region).volume() / flat.boundary(region).volume();
        assert!((0.5..2.0).contains(&ratio), "{}: volume ratio {ratio}", named.name);
    }
}

#[test]
fn the_flat_antenna_stays_as_drawn() {
    for mode in [CompensationMode::None, CompensationMode::Wl, CompensationMode::Isometric] {
        let result = done(&project(&[], mode));
        for (flat, posed) in result.flat.vertices.iter().zip(&result.positions) {
            assert!(flat.distance(*posed) < 1e-12, "{mode:?}: {flat} went to {posed}");
        }
        assert!(figures(&result).rho_patch.abs() < 1e-9, "{mode:?}: rho {}", figures(&result).rho_patch);
        assert!(figures(&result).patch_strain < 1e-9, "{mode:?}: strain {}", figures(&result).patch_strain);
    }
}

#[test]
fn every_compensation_of_a_bend_gives_a_closed_surface_with_shared_interfaces() {
    for plane in [BendPlane::H, BendPlane::E] {
        for mode in [CompensationMode::None, CompensationMode::Wl, CompensationMode::Isometric] {
            for scope in [ScopeSpec::Whole, ScopeSpec::Patch] {
                let mut project = project(&[bend(plane, 10.0)], mode);
                project.settings.scope = scope;
                let result = done(&project);
                check_surface(&result.surface(), &result.flat);
                if mode != CompensationMode::None {
                    let errors = (figures(&result).width_error, figures(&result).length_error);
                    assert!(errors.0.abs() < 2e-3 && errors.1.abs() < 2e-3, "{plane:?} {mode:?} {scope:?}: {errors:?}");
                }
            }
        }
    }
}

#[test]
fn the_heatmap_shows_the_strain_that_the_figures_state() {
    let result = done(&project(&[bend(BendPlane::H, 10.0)], CompensationMode::Isometric));
    let patch = result.flat.region("patch").expect("a patch");
    // The patch's bottom plane: facets whose normal points up into it.
    let bottom = |v: VertexId| result.flat.vertices[v.index()].z.abs() < 1e-12;
    let bottoms = result.flat.facets.iter().filter(|f| f.front == patch && f.vertices.iter().all(|&v| bottom(v)));
    let on_patch = bottoms.flat_map(|f| f.vertices);
    let strain = |v: usize| (result.fields.stretch_max[v] - 1.0).abs().max((result.fields.stretch_min[v] - 1.0).abs());
    let largest = on_patch.map(|v| strain(v.index())).fold(0.0, f64::max);
    // Facets see chords, and at the rim also the substrate beside the patch.
    assert!(largest < 3.0 * figures(&result).patch_strain, "{largest} against {}", figures(&result).patch_strain);
}

#[test]
fn faceted_and_smooth_rho_agree() {
    let result = done(&project(&[bend(BendPlane::H, 10.0)], CompensationMode::None));
    let surface = result.surface();
    let patch = surface.region("patch").expect("a patch");
    let faceted = surface.boundary_area(patch) / result.flat.boundary_area(patch) - 1.0;
    assert!((faceted - figures(&result).rho_patch).abs() < 5e-4, "{faceted} against {}", figures(&result).rho_patch);
    assert!((figures(&result).rho_patch + 0.1088).abs() < 1e-3, "rho {}", figures(&result).rho_patch);
}

#[test]
fn the_shapes_of_section_vi_and_crumpling_work_with_isometric_compensation() {
    let shapes = [
        PresetSpec::Convex { radius_mm: 20.0, amplitude_mm: 10.0 },
        PresetSpec::Concave { radius_mm: 20.0, amplitude_mm: 10.0 },
        PresetSpec::Saddle { radius_mm: 20.0, amplitude_mm: 10.0 },
        PresetSpec::Twist { amplitude_mm: 10.0, rate_deg_per_mm: 0.573 },
        PresetSpec::Crumple { amplitude_mm: 1.0, waves: [1.0, 0.0], phase_deg: 0.0 },
    ];
    for preset in shapes {
        for mode in [CompensationMode::None, CompensationMode::Isometric] {
            let mut project = project(&[PresetEntry { enabled: true, preset }], mode);
            project.cage.segments = [10, 10];
            match deform(&project, &Task::default()) {
                Ok(result) => {
                    check_surface(&result.surface(), &result.flat);
                    println!(
                        "{preset:?} {mode:?}: strain {:.4} rho {:+.3} % in {:.2} s, {} vertices",
                        figures(&result).patch_strain,
                        figures(&result).rho_patch * 100.0,
                        result.seconds,
                        result.positions.len()
                    );
                }
                Err(error) => panic!("{preset:?} {mode:?}: {error}"),
            }
        }
    }
}

#[test]
fn hand_edits_lie_on_the_calibrated_bend() {
    let bent = project(&[bend(BendPlane::H, 10.0)], CompensationMode::Isometric);
    let mut edited = bent.clone();
    edited.hand_edits.insert(0, [0.0, 0.0, 1e-9]);
    let (a, b) = (done(&bent), done(&edited));
    let apart = a.posed.iter().zip(&b.posed).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
    assert!(apart < 1e-6, "an edit of a picometre moves the cage by {apart:e} m");
}

#[test]
fn the_exact_cylinder_is_a_closed_surface_too() {
    let project = project(&[bend(BendPlane::E, 6.5)], CompensationMode::None);
    let surface = exact_cylinder(&project, &Task::default()).expect("possible").expect("a bend");
    assert_eq!(surface.check(), Ok(()), "every region is closed");
    assert_eq!(exact_cylinder(&Project::default(), &Task::default()), Ok(None), "flat is no cylinder");
}

#[test]
fn impossible_projects_say_what_to_change() {
    let mut rough = project(&[bend(BendPlane::H, 10.0)], CompensationMode::None);
    rough.settings.tolerance_mm = 0.05;
    let mut edited = project(&[], CompensationMode::None);
    edited.hand_edits.insert(4000, [1.0; 3]);
    let mut pierced = project(&[], CompensationMode::None);
    pierced.hand_edits.insert(21, [0.0, 0.0, -30.0]);
    let mut tight = project(&[bend(BendPlane::H, 4.2)], CompensationMode::None);
    tight.cage.padding_mm = [1.0; 3];
    let mut crowded = project(&[bend(BendPlane::H, 4.2)], CompensationMode::Isometric);
    crowded.cage.padding_mm = [1.0; 3];
    let cases = [
        (project(&[bend(BendPlane::H, 4.0)], CompensationMode::None), "radius"),
        (rough, "tolerance"),
        (edited, "hand edits"),
        (pierced, "crosses itself"),
        (tight, "coaxial line"),
        (crowded, "padding"),
    ];
    for (project, word) in cases {
        let error = deform(&project, &Task::default()).expect_err(word).to_string();
        assert!(error.contains(word), "{word}: {error}");
    }
}

#[test]
fn a_cancelled_task_ends_without_a_result() {
    let task = Task::default();
    task.cancel();
    let result = deform(&project(&[bend(BendPlane::H, 10.0)], CompensationMode::Isometric), &task);
    assert!(matches!(result, Err(PipelineError::Cancelled(Cancelled))), "cancelled");
}

#[test]
fn the_same_project_gives_the_same_bits_on_any_number_of_threads() {
    let project = project(&[bend(BendPlane::H, 10.0)], CompensationMode::Isometric);
    let on = |threads: usize| -> Vec<DVec3> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| done(&project).positions)
    };
    assert_eq!(on(1), on(3), "bit for bit");
}

#[test]
fn a_refused_edit_retreats_to_the_furthest_valid_cage() {
    let good = project(&[bend(BendPlane::H, 10.0)], CompensationMode::None);
    let refused = project(&[bend(BendPlane::H, 3.0)], CompensationMode::None);
    assert!(deform(&refused, &Task::default()).is_err(), "3 mm is impossible at padding 3");
    let valid = retreat(&good, &refused, &Task::default()).expect("not cancelled");
    let PresetSpec::Bend { radius_mm, .. } = valid.presets[0].preset else { panic!("still a bend") };
    assert!((4.6..8.0).contains(&radius_mm), "stopped at {radius_mm} mm");
    done(&valid);
}

#[test]
fn previews_agree_with_full_runs() {
    use conformant::pipeline::live::Live;
    let start = project(&[bend(BendPlane::H, 10.0)], CompensationMode::None);
    let stages = run(&start, &Task::default()).expect("valid");
    let mut live = Live::new(start.clone(), stages, &Task::default()).expect("inside");
    for step in 1..=3 {
        let mut dragged = start.clone();
        dragged.hand_edits.insert(21, [0.2, 0.1 * f64::from(step), 0.3]);
        assert!(live.serves(&dragged), "a drag is what previews are for");
        let preview = live.preview(&dragged).expect("valid");
        let full = done(&dragged);
        // The split differs, the figures must not by more than the preview's facets and f32 weights account for.
        let (a, b) = (figures(&preview), figures(&full));
        assert!((a.rho_patch - b.rho_patch).abs() < 1e-3, "rho {} {}", a.rho_patch, b.rho_patch);
        assert!((a.width / b.width - 1.0).abs() < 1e-4, "width {} {}", a.width, b.width);
        assert!((a.thickness / b.thickness - 1.0).abs() < 2e-3, "thickness {} {}", a.thickness, b.thickness);
    }
    let mut thicker = start.clone();
    thicker.antenna.height_mm = 1.6;
    assert!(!live.serves(&thicker), "another antenna needs a full run");
}

#[test]
fn errors_of_points_outside_name_the_point() {
    let cage = conformant::cage::Cage::around(
        (DVec3::ZERO, DVec3::ONE),
        &conformant::cage::CageParams { padding: DVec3::ONE, segments: [1, 1] },
    )
    .expect("valid");
    let posed = cage.mesh.vertices.clone();
    let error =
        conformant::pipeline::apply_cage(cage.mesh, &posed, &[DVec3::ZERO, DVec3::splat(9.0)], &Task::default())
            .expect_err("outside");
    assert!(matches!(error, PipelineError::Deform(DeformError::OutsideCage { point: 1, .. })), "{error}");
}
