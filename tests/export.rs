//! Exports of deformed antennas are gap-free for whatever valid cage.

use conformant::io::{ExportOptions, export, import, verify};
use conformant::pipeline::deform;
use conformant::project::{BendPlane, CompensationMode, PresetEntry, PresetSpec, Project, RuleSpec};
use conformant::task::Task;
use rayon::prelude::*;

/// A random antenna in a random cage: a preset or none, and a few vertices pulled about.
fn random_project(seed: u64) -> Project {
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut between = |lo: f64, hi: f64| lo + (hi - lo) * rng.f64();
    let mut project = Project::default();
    project.antenna.width_mm = between(8.0, 12.0);
    project.antenna.length_mm = between(7.0, 10.0);
    project.antenna.height_mm = between(0.8, 2.0);
    project.antenna.pin_segments = 8;
    project.antenna.coax_segments = 12;
    project.cage.padding_mm = [between(1.5, 5.0), between(1.5, 5.0), between(1.5, 3.5)];
    project.cage.segments = [4, 4];
    project.settings.compensation = CompensationMode::None;
    let radius_mm = between(12.0, 60.0);
    let amplitude_mm = between(1.0, 6.0);
    let presets = [
        PresetSpec::Bend { plane: BendPlane::H, radius_mm, rule: RuleSpec::Arc, kept_plane_mm: 0.0 },
        PresetSpec::Bend { plane: BendPlane::E, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 },
        PresetSpec::Convex { radius_mm: radius_mm + 15.0, amplitude_mm },
        PresetSpec::Saddle { radius_mm: radius_mm + 15.0, amplitude_mm },
        PresetSpec::Twist { amplitude_mm, rate_deg_per_mm: between(-1.0, 1.0) },
        PresetSpec::Crumple { amplitude_mm: amplitude_mm / 6.0, waves: [1.0, 0.5], phase_deg: 30.0 },
    ];
    let choice = seed % 7;
    if let Some(&preset) = presets.get(usize::try_from(choice).expect("below 7")) {
        project.presets.push(PresetEntry { enabled: true, preset });
    }
    for _ in 0..4 {
        let vertex = rng.u32(0..50);
        let offset = [0; 3].map(|_| rng.f64() * 1.6 - 0.8);
        project.hand_edits.insert(vertex, offset);
    }
    project
}

#[test]
fn two_hundred_random_valid_cages_share_every_interface_facet_bit_for_bit() {
    const WANTED: usize = 200;
    let outcomes: Vec<Result<usize, String>> = (0..260_u64)
        .into_par_iter()
        .map(|seed| {
            let deformed = deform(&random_project(seed), &Task::default()).map_err(|error| error.to_string())?;
            let surface = deformed.surface();
            assert_eq!(surface.check(), Ok(()), "cage {seed}: closed regions");
            let folder = tempfile::tempdir().expect("a temporary folder");
            let options = ExportOptions { obj: false, gltf: false, ..ExportOptions::default() };
            let exported = export(&surface, folder.path(), &options).unwrap_or_else(|e| panic!("cage {seed}: {e}"));
            let shared = exported.certificate.n_shared_facets();
            assert_eq!(shared, surface.n_shared_facets(), "cage {seed}: every interface facet is in both files");
            let verification = verify(folder.path()).expect("readable");
            assert!(verification.is_valid(), "cage {seed}: {:?}", verification.findings);
            Ok(shared)
        })
        .collect();
    let valid = outcomes.iter().filter(|o| o.is_ok()).count();
    let refused: Vec<&String> = outcomes.iter().filter_map(|o| o.as_ref().err()).collect();
    assert!(valid >= WANTED, "only {valid} cages were valid: {refused:#?}");
}

#[test]
fn a_deformed_antenna_comes_back_from_every_format() {
    let surface = deform(&random_project(1), &Task::default()).expect("valid").surface();
    let folder = tempfile::tempdir().expect("a temporary folder");
    export(&surface, folder.path(), &ExportOptions::default()).expect("exported");
    for file in ["", "antenna.obj", "antenna.glb"] {
        let back = import(&folder.path().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(back.facets.len(), surface.facets.len(), "{file}: facets");
        assert_eq!(back.vertices.len(), surface.vertices.len(), "{file}: vertices");
        assert_eq!(back.n_shared_facets(), surface.n_shared_facets(), "{file}: shared facets");
        assert_eq!(back.check(), Ok(()), "{file}: closed");
        for (region, named) in surface.solids() {
            let found = back.region(&named.name).unwrap_or_else(|| panic!("{file}: {}", named.name));
            let ratio = back.boundary(found).volume() / surface.boundary(region).volume();
            assert!((ratio - 1.0).abs() < 1e-5, "{file}: {} has {ratio} of its volume", named.name);
        }
    }
}
