//! Whatever a cage does to the antenna, the mesh is valid or refused with a reason.
//!
//! Thirty deformations in a plain test run; all three hundred with
//! `CAMPAIGN=full cargo test --release --test meshing -- --nocapture`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use conformant::geometry::DVec3;
use conformant::pipeline::{Density, MeshSettings, Meshed, PipelineError, Shape, mesh};
use conformant::project::{
    BendPlane, CageSpec, CompensationMode, PresetEntry, PresetSpec, Project, RuleSpec, ScopeSpec,
};
use conformant::task::Task;
use conformant::tet::Metal;

fn count() -> usize {
    if std::env::var("CAMPAIGN").is_ok_and(|c| c == "full") { 300 } else { 30 }
}

fn bend(plane: BendPlane, radius_mm: f64) -> PresetSpec {
    PresetSpec::Bend { plane, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 }
}

fn bent(plane: BendPlane, radius_mm: f64) -> Project {
    let preset = bend(plane, radius_mm);
    let segments = if plane == BendPlane::H { [10, 1] } else { [1, 10] };
    Project {
        presets: vec![PresetEntry { enabled: true, preset }],
        cage: CageSpec { segments, ..CageSpec::default() },
        ..Project::default()
    }
}

/// A random deformation of the paper's antenna.
fn random_project(seed: u64) -> (Project, String) {
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut between = |lo: f64, hi: f64| lo + (hi - lo) * rng.f64();
    let radius_mm = 4.2 * (60.0_f64 / 4.2).powf(between(0.0, 1.0));
    let (wide_mm, amplitude_mm) = (between(15.0, 40.0), between(1.0, 10.0));
    let rate_deg_per_mm = between(-3.4, 3.4);
    let padding = between(1.0, 6.0);
    let kind = rng.usize(0..7);
    let (name, preset) = match kind {
        0 => ("bend H", bend(BendPlane::H, radius_mm)),
        1 => ("bend E", bend(BendPlane::E, radius_mm)),
        2 => ("twist", PresetSpec::Twist { amplitude_mm: 0.0, rate_deg_per_mm }),
        3 => ("saddle", PresetSpec::Saddle { radius_mm: wide_mm, amplitude_mm }),
        4 => ("convex", PresetSpec::Convex { radius_mm: wide_mm, amplitude_mm }),
        5 => ("concave", PresetSpec::Concave { radius_mm: wide_mm, amplitude_mm }),
        _ => ("dragged", bend(BendPlane::H, 4.0 * radius_mm)),
    };
    let mut project = Project { presets: vec![PresetEntry { enabled: true, preset }], ..Project::default() };
    project.cage.padding_mm = [padding; 3];
    project.cage.segments = match kind {
        0 => [rng.usize(4..13), 1],
        1 => [1, rng.usize(4..13)],
        6 => [rng.usize(2..6), rng.usize(2..6)],
        _ => [10, 10],
    };
    if kind == 6 {
        for _ in 0..rng.usize(1..6) {
            let mut part = || 3.0 * (rng.f64() - 0.5);
            let offset = [part(), part(), part()];
            project.hand_edits.insert(rng.u32(0..18), offset);
        }
    }
    project.settings.compensation =
        [CompensationMode::None, CompensationMode::Wl, CompensationMode::Isometric][rng.usize(0..3)];
    project.settings.scope = if rng.bool() { ScopeSpec::Whole } else { ScopeSpec::Patch };
    (project, format!("{seed}: {name}, {preset:?}, padding {padding:.2}"))
}

/// Checks what every mesh of the antenna promises.
fn assert_antenna_mesh(meshed: &Meshed, what: &str) {
    let mesh = &meshed.mesh;
    assert_eq!(mesh.check(), Ok(()), "{what}");
    // Conductors, port and outer boundary are all there: the marked faces of each have an area.
    for (g, group) in mesh.groups.iter().enumerate() {
        let corners = |f: &conformant::tet::MarkedFace| f.vertices.map(|v| mesh.vertices[v.index()]);
        let doubled = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length();
        let area: f64 = mesh.faces.iter().filter(|f| f.group == g).map(|f| doubled(corners(f)) / 2.0).sum();
        assert!(area > 1e-6, "{what}: {} has {area:e} m2", group.name);
    }
    // Region by region, the cells' volumes are what their boundary encloses.
    let total: f64 = mesh.volumes().iter().sum();
    let hull: f64 = mesh
        .faces
        .iter()
        .filter(|f| mesh.groups[f.group].name == "outer")
        .map(|f| {
            let [a, b, c] = f.vertices.map(|v| mesh.vertices[v.index()]);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    assert!(total < hull && total > 0.99 * hull, "{what}: cells {total:e} m3 of {hull:e}");
}

#[test]
fn random_deformations_give_a_valid_mesh_or_a_reason() {
    let settings = MeshSettings { density: Density::Coarse, metal: Metal::Sheet };
    let (mut n_meshed, mut least) = (0, (f64::INFINITY, String::new()));
    let mut refused: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    for seed in 0..count() as u64 {
        let (project, what) = random_project(seed);
        match mesh(&project, Shape::Deformed, settings, &Task::default()) {
            Ok(meshed) => {
                assert_antenna_mesh(&meshed, &what);
                n_meshed += 1;
                let dihedral = meshed.quality.whole.dihedral_min.to_degrees();
                if dihedral < least.0 {
                    least = (dihedral, what);
                }
            }
            Err(error) => {
                let text = error.to_string();
                assert!(text.len() > 20, "{what}: \"{text}\" says too little");
                let kind = match error {
                    PipelineError::Mesh(_) => "mesh",
                    PipelineError::Pose(_) | PipelineError::Preset { .. } => "cage",
                    PipelineError::Compensation(_) => "compensation",
                    PipelineError::Deform(_) => "feed or map",
                    PipelineError::Folded { .. } => "fold",
                    other => panic!("{what}: {other}"),
                };
                println!("refused {what}: {text}");
                *refused.entry(kind).or_default() += 1;
            }
        }
    }
    println!("{n_meshed} of {} meshed, refused {refused:?}, smallest dihedral angle {least:?}", count());
    assert!(2 * n_meshed > count(), "more than half can be meshed, but only {n_meshed} were");
    assert!(least.0 > 1.0, "smallest dihedral angle {least:?}");
}

#[test]
fn the_papers_antenna_meets_the_quality_targets_at_the_default_density() {
    // Least dihedral angle and inradius, its first percentile and the largest dihedral angle: a mesh of sheets is good
    // enough for a time step of 0.6 inradii over c; solid foil of 35 micrometres caps it.
    let cases = [
        (Project::default(), Shape::Flat, Metal::Sheet),
        (bent(BendPlane::H, 10.0), Shape::Deformed, Metal::Sheet),
        (bent(BendPlane::H, 6.5), Shape::Cylinder, Metal::Sheet),
        (bent(BendPlane::H, 10.0), Shape::Deformed, Metal::Solid),
    ];
    for (project, shape, metal) in cases {
        let settings = MeshSettings { density: Density::Default, metal };
        let meshed = mesh(&project, shape, settings, &Task::default()).unwrap();
        let what = format!("{shape:?} {metal:?}");
        assert_antenna_mesh(&meshed, &what);
        let whole = &meshed.quality.whole;
        let [least, first, most] = [whole.dihedral_min, whole.dihedral_p1, whole.dihedral_max].map(f64::to_degrees);
        println!("{what}: {least:.2}, 1 % {first:.2}, {most:.2} degrees, {:.4} mm", whole.inradius_min * 1e3);
        if metal == Metal::Sheet {
            assert!(least > 12.0 && first > 25.0 && most < 150.0, "{what}: {least}, {first}, {most} degrees");
            assert!(whole.inradius_min > 0.030e-3, "{what}: inradius {}", whole.inradius_min);
        } else {
            assert!(least > 3.0 && whole.inradius_min > 0.0115e-3, "{what}: {least}, {}", whole.inradius_min);
        }
        assert!(meshed.map_distance <= 0.01e-3, "{what}: {} m off the smooth map", meshed.map_distance);
    }
}

#[test]
fn the_same_project_gives_the_same_bits_on_any_number_of_threads() {
    let project = bent(BendPlane::E, 8.0);
    let settings = MeshSettings { density: Density::Coarse, metal: Metal::Sheet };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| mesh(&project, Shape::Deformed, settings, &Task::default()).unwrap().mesh)
    };
    assert_eq!(run(1), run(3), "one and three threads");
}
