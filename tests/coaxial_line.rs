//! A coaxial line in the time domain, against the closed forms of line theory.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use conformant::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use conformant::io::checkpoint;
use conformant::results::{FeedLine, Sweep, frequencies, sweep};
use conformant::task::Task;
use conformant::tet::{FaceGroup, FaceRole, SizingSettings, Surface, SurfaceFacet, TetMesh, fill};
use conformant::tlm::{Loads, Network, NetworkSettings, Pulse, Resistor, Run, StepLimit, TlmError};
use conformant::units::{C0, ETA0};
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

const INNER: f64 = 1.0e-3;
const OUTER: f64 = 2.3e-3;
const LENGTH: f64 = 6.0e-3;
const EPS_R: f64 = 2.2;
const PEC: usize = 0;
const PORT: usize = 1;
const FAR_END: usize = 2;

/// A line along z between polygons of the circles' areas: `n` segments, `layers` of facets from conductor to conductor.
fn line(n: usize, layers: usize, n_z: usize, far_end: FaceRole) -> TetMesh {
    let to_area = (TAU / n as f64 / (TAU / n as f64).sin()).sqrt();
    let radius = |layer: usize| INNER + (OUTER - INNER) * layer as f64 / layers as f64;
    let mut vertices = Vec::new();
    let mut id = std::collections::HashMap::new();
    let mut vertex = |k: usize, layer: usize, z: usize| {
        *id.entry((k % n, layer, z)).or_insert_with(|| {
            let (sin, cos) = (TAU * (k % n) as f64 / n as f64).sin_cos();
            let r = radius(layer) * to_area;
            vertices.push(DVec3::new(r * cos, r * sin, LENGTH * z as f64 / n_z as f64));
            VertexId::new(vertices.len() - 1)
        })
    };
    let mut facets = Vec::new();
    let mut quad = |[a, b, c, d]: [VertexId; 4], group: usize| {
        for vertices in [[a, b, c], [a, c, d]] {
            facets.push(SurfaceFacet { vertices, back: RegionId::new(1), front: RegionId::new(0), group: Some(group) });
        }
    };
    for k in 0..n {
        for layer in 0..layers {
            let mut end = |z| {
                [vertex(k, layer, z), vertex(k, layer + 1, z), vertex(k + 1, layer + 1, z), vertex(k + 1, layer, z)]
            };
            let [a, b, c, d] = end(0);
            quad([a, d, c, b], PORT);
            quad(end(n_z), FAR_END);
        }
        for z in 0..n_z {
            let mut wall = |layer| {
                [vertex(k, layer, z), vertex(k + 1, layer, z), vertex(k + 1, layer, z + 1), vertex(k, layer, z + 1)]
            };
            let [a, b, c, d] = wall(0);
            quad([a, d, c, b], PEC);
            quad(wall(layers), PEC);
        }
    }
    let region =
        |name: &str, eps_r| Region { name: name.to_owned(), role: RegionRole::Dielectric, eps_r, tan_delta: 0.0 };
    let group = |name: &str, role| FaceGroup { name: name.to_owned(), role };
    let surface = Surface {
        vertices,
        facets,
        regions: vec![region("outside", 1.0), region("sheath", EPS_R)],
        groups: vec![group("pec", FaceRole::Conductor), group("port1", FaceRole::Port), group("end", far_end)],
    };
    let settings = SizingSettings { h_max: (OUTER - INNER) / layers as f64, grading: 0.5 };
    let mesh = fill(&surface, &[], settings, &Task::default()).unwrap().mesh;
    assert_eq!(mesh.check(), Ok(()), "a valid mesh");
    mesh
}

/// Runs the line for a band around 10 GHz; S11 at a distance from the port, and the port's impedance.
fn reflection(mesh: &TetMesh, distance: f64, step: StepLimit) -> (Sweep, f64) {
    loaded(mesh, distance, step, Loads::default())
}

fn loaded(mesh: &TetMesh, distance: f64, step: StepLimit, loads: Loads) -> (Sweep, f64) {
    let settings = NetworkSettings { step, loads, ..NetworkSettings::new(10e9) };
    let network = Network::<f32>::new(mesh, &settings, &Task::default()).unwrap();
    let pulse = Pulse::new(5e9, 15e9).unwrap();
    let mut run = Run::new(&network, pulse);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousand steps")]
    let n_steps = ((pulse.end() + 6.0 * LENGTH * EPS_R.sqrt() / C0) / network.dt).ceil() as usize;
    run.advance(n_steps, &Task::default()).unwrap();
    let impedance = network.port_impedance.unwrap();
    let at = FeedLine { impedance, length: distance, eps_r: EPS_R, reference: impedance };
    (sweep(run.record(), &at, &frequencies(6e9, 14e9, 1e9)), impedance)
}

fn exact_impedance() -> f64 {
    ETA0 / EPS_R.sqrt() * (OUTER / INNER).ln() / TAU
}

#[test]
fn a_matched_end_reflects_nothing_and_the_impedance_is_the_lines() {
    let mut found = Vec::new();
    for (n, layers) in [(16, 2), (40, 5)] {
        let mesh = line(n, layers, 3 * layers, FaceRole::Outer);
        let (sweep, impedance) = reflection(&mesh, 0.0, StepLimit::Clip(0.003));
        let worst = sweep.s11.iter().map(|s| s.norm()).fold(0.0, f64::max);
        let error = impedance / exact_impedance() - 1.0;
        println!("{} tetrahedra: |S11| {worst:.5}, impedance {error:+.5}", mesh.tets.len());
        found.push((worst, error.abs()));
    }
    // Second order in the edge length, which falls to two fifths.
    assert!(found[1].1 < 0.005 && found[1].1 < 0.25 * found[0].1, "(|S11|, impedance error): {found:?}");
    assert!(found[0].0 < 0.02 && found[1].0 < 0.01, "(|S11|, impedance error): {found:?}");
}

#[test]
fn a_shorted_end_reflects_everything_with_the_lines_delay() {
    let mesh = line(24, 3, 12, FaceRole::Conductor);
    for step in [StepLimit::Exact, StepLimit::Clip(0.003)] {
        // Moved to the short, the reflection is -1.
        let (sweep, _) = reflection(&mesh, LENGTH, step);
        for (f, s) in sweep.freqs.iter().zip(&sweep.s11) {
            let phase = (-s).arg();
            // The dispersion of the mesh is of second order: (k h)² / 100 over twice the length.
            let k = TAU * f * EPS_R.sqrt() / C0;
            let allowed = 2.0 * k * LENGTH * 0.02 * (k * 0.45e-3).powi(2) + 0.02;
            assert!((s.norm() - 1.0).abs() < 2e-3, "{step:?}: |S11| {} at {f:e} Hz", s.norm());
            assert!(phase.abs() < allowed.min(PI / 8.0), "{step:?}: {phase} rad at {f:e} Hz, {allowed} allowed");
        }
        let mean: Complex<f64> = sweep.s11.iter().sum::<Complex<f64>>() / sweep.s11.len() as f64;
        println!("{step:?}: mean S11 at the short {mean:.5}");
    }
}

/// Greatest distance of S11 from a number.
fn distance_from(sweep: &Sweep, expected: f64) -> f64 {
    sweep.s11.iter().map(|s| (s - expected).norm()).fold(0.0, f64::max)
}

#[test]
fn lossy_sheets_and_resistors_end_the_line_as_theory_says() {
    let mesh = line(24, 3, 12, FaceRole::Conductor);
    let end = |loads| loaded(&mesh, LENGTH, StepLimit::Clip(0.003), loads).0;
    let wave = ETA0 / EPS_R.sqrt();
    // The mesh's dispersion turns the reflection by some hundredths on its way there and back.
    for (resistance, expected, allowed) in [(wave, 0.0, 0.01), (2.0 * wave, 1.0 / 3.0, 0.03), (1e9, 1.0, 0.08)] {
        let sheets = vec![("end".to_owned(), resistance)];
        let off = distance_from(&end(Loads { sheets, ..Loads::default() }), expected);
        assert!(off < allowed, "{resistance} ohm per square: {off} from {expected}");
    }
    // Resistors along all edges of the open end make it a short.
    let of_end = mesh.faces.iter().filter(|f| f.group == FAR_END).flat_map(|f| {
        let [a, b, c] = f.vertices;
        [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
    });
    let edges: std::collections::BTreeSet<[VertexId; 2]> = of_end.collect();
    let resistors = edges.into_iter().map(|edge| Resistor { edge, resistance: 1e-3 }).collect();
    let short = Loads { sheets: vec![("end".to_owned(), 1e9)], resistors, ..Loads::default() };
    let off = distance_from(&end(short), -1.0);
    assert!(off < 0.08, "shorted by resistors: {off} from -1");
}

#[test]
fn a_permeable_line_has_its_impedance_and_is_matched_by_its_wave() {
    const MU_R: f64 = 1.5;
    let mesh = line(24, 3, 12, FaceRole::Outer);
    let permeable = vec![(RegionId::new(1), MU_R)];
    let (sweep, impedance) = loaded(&mesh, 0.0, StepLimit::Exact, Loads { permeable, ..Loads::default() });
    let error = impedance / (exact_impedance() * MU_R.sqrt()) - 1.0;
    assert!(error.abs() < 0.02, "impedance {impedance}, {error} off");
    let off = distance_from(&sweep, 0.0);
    assert!(off < 0.02, "reflects {off}");
}

#[test]
fn loads_that_cannot_be_are_refused() {
    let mesh = line(16, 2, 4, FaceRole::Conductor);
    let refused = |loads| {
        let settings = NetworkSettings { loads, ..NetworkSettings::new(10e9) };
        Network::<f32>::new(&mesh, &settings, &Task::default()).unwrap_err().to_string()
    };
    let sheet = |name: &str, ohm| Loads { sheets: vec![(name.to_owned(), ohm)], ..Loads::default() };
    assert!(refused(sheet("felt", 1.0)).contains("\"felt\""), "a sheet that is not there is named");
    assert!(refused(sheet("end", -1.0)).contains("-1"), "a sheet that gives power is refused");
}

#[test]
fn the_field_is_the_same_bits_on_any_number_of_threads() {
    let mesh = line(16, 2, 8, FaceRole::Conductor);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| reflection(&mesh, 0.0, StepLimit::Exact).0)
    };
    assert_eq!(run(1), run(3), "one and three threads");
}

#[test]
fn a_resumed_run_has_the_bits_of_an_uninterrupted_one_and_belongs_to_its_network_alone() {
    let task = Task::default();
    let network = |far_end| {
        let settings = NetworkSettings { step: StepLimit::Clip(0.003), ..NetworkSettings::new(10e9) };
        Network::<f32>::new(&line(16, 2, 8, far_end), &settings, &task).unwrap()
    };
    let (open, pulse) = (network(FaceRole::Outer), Pulse::new(5e9, 15e9).unwrap());
    let mut straight = Run::new(&open, pulse);
    straight.advance(1200, &task).unwrap();
    let mut first = Run::new(&open, pulse);
    first.advance(600, &task).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.checkpoint");
    checkpoint::write(&first.checkpoint(), &path).unwrap();
    let kept = checkpoint::read(&path).unwrap();
    let mut resumed = Run::new(&open, pulse).resumed(&kept).unwrap();
    resumed.advance(600, &task).unwrap();
    let (end, expected) = (resumed.checkpoint(), straight.checkpoint());
    assert!(expected.record.total.iter().any(|v| v.abs() > 0.1), "there is a field");
    assert_eq!((end.record, end.field), (expected.record, expected.field), "the same bits");
    let shorted = network(FaceRole::Conductor);
    for other in [Run::new(&shorted, pulse), Run::new(&open, Pulse::new(5e9, 16e9).unwrap())] {
        assert_eq!(other.resumed(&kept).unwrap_err(), TlmError::ForeignCheckpoint, "another end, another band");
    }
}
