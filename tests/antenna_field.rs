//! The field of the paper's antenna: passive cell by cell, and no growth however long it runs.
//!
//! Twelve thousand steps in a plain test run; a million with
//! `CAMPAIGN=full cargo test --release --test antenna_field -- --nocapture`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use conformant::pipeline::{Density, MeshSettings, Shape, mesh};
use conformant::project::{BendPlane, CageSpec, PresetEntry, PresetSpec, Project, RuleSpec};
use conformant::task::Task;
use conformant::tet::{Metal, TetMesh};
use conformant::tlm::{Network, NetworkSettings, Pulse, Run, StepLimit, orthogonality_error};

/// The coarse mesh of the antenna bent to 10 mm in the H plane, compensated.
fn bent() -> TetMesh {
    let preset = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    let project = Project {
        presets: vec![PresetEntry { enabled: true, preset }],
        cage: CageSpec { segments: [10, 1], ..CageSpec::default() },
        ..Project::default()
    };
    let settings = MeshSettings { density: Density::Coarse, metal: Metal::Sheet };
    mesh(&project, Shape::Deformed, settings, &Task::default()).unwrap().mesh
}

#[test]
fn every_cell_of_an_antenna_scatters_without_loss() {
    let mesh = bent();
    let settings = NetworkSettings::new(10e9);
    let exact = orthogonality_error(&mesh, &settings).unwrap();
    let clipped = orthogonality_error(&mesh, &NetworkSettings { step: StepLimit::Clip(0.003), ..settings }).unwrap();
    println!("{} cells: {exact:e} at the exact step, {clipped:e} at the clipped one", mesh.tets.len());
    assert!(exact < 1e-12 && clipped < 1e-12, "{exact:e}, {clipped:e}");
}

#[test]
fn the_field_of_an_antenna_dies_away_and_stays_away() {
    let n_steps = if std::env::var("CAMPAIGN").is_ok_and(|c| c == "full") { 1_000_000 } else { 12_000 };
    let settings = NetworkSettings { step: StepLimit::Clip(0.003), ..NetworkSettings::new(10e9) };
    let network = Network::<f32>::new(&bent(), &settings, &Task::default()).unwrap();
    let mut run = Run::new(&network, Pulse::new(7e9, 14e9).unwrap());
    let largest = |run: &Run<'_, f32>| run.checkpoint().field.iter().fold(0.0_f32, |max, v| max.max(v.abs()));
    let mut peak = 0.0_f32;
    let mut ends = Vec::new();
    for _ in 0..20 {
        run.advance(n_steps / 20, &Task::default()).unwrap();
        ends.push(largest(&run));
        peak = peak.max(ends[ends.len() - 1]);
    }
    println!("largest number of the field after each twentieth of {n_steps} steps: {ends:?}");
    let reflected: Vec<f64> = run.record().reflected().map(f64::abs).collect();
    let (most, last) = (
        reflected.iter().copied().fold(0.0, f64::max),
        reflected[n_steps - n_steps / 20..].iter().copied().fold(0.0, f64::max),
    );
    assert!(last < 1e-4 * most, "the port still sees {last} of {most}");
    assert!(ends[19] <= 1.02 * ends[9], "no growth: {ends:?}");
}
