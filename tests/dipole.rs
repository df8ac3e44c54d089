//! A small current in free space, against the closed form of the elementary dipole.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use conformant::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use conformant::results::{FarField, far_field};
use conformant::task::Task;
use conformant::tet::{FaceGroup, FaceRole, SizingSettings, Surface, SurfaceFacet, TetMesh, fill};
use conformant::tlm::{FieldRecorder, Huygens, Network, NetworkSettings, Pulse, Run, StepLimit};
use conformant::units::{C0, ETA0};
use nalgebra::Complex;
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

const FREQS: [f64; 3] = [9e9, 10e9, 11e9];
const WAVELENGTH: f64 = C0 / 10e9;

/// A ball of air: a cube's surface with n x n quads a side, blown up.
fn ball(radius: f64, edge: f64) -> TetMesh {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ten")]
    let n = (radius * FRAC_PI_4 * 2.0 / edge).ceil() as usize;
    let mut names = HashMap::new();
    let (mut vertices, mut facets) = (Vec::new(), Vec::new());
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
        let mut id = |i: usize, j: usize| {
            let mut place = [0; 3];
            (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (side, i, j);
            *names.entry(place).or_insert_with(|| {
                let even = place.map(|k| ((2.0 * k as f64 / n as f64 - 1.0) * FRAC_PI_4).tan());
                vertices.push(DVec3::from_array(even).try_normalize().unwrap() * radius);
                VertexId::new(vertices.len() - 1)
            })
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let quad = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            for [a, b, c] in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                let vertices = if side == 0 { [a, c, b] } else { [a, b, c] };
                facets.push(SurfaceFacet { vertices, back: RegionId::new(1), front: RegionId::new(0), group: Some(0) });
            }
        }
    }
    let region =
        |name: &str| Region { name: name.to_owned(), role: RegionRole::Dielectric, eps_r: 1.0, tan_delta: 0.0 };
    let groups = vec![FaceGroup { name: "outer".to_owned(), role: FaceRole::Outer }];
    let surface = Surface { vertices, facets, regions: vec![region("outside"), region("air")], groups };
    let settings = SizingSettings { h_max: edge, grading: 0.35 };
    fill(&surface, &[], settings, &Task::default()).unwrap().mesh
}

/// The edge of the mesh whose middle is nearest to the origin.
fn middle_edge(mesh: &TetMesh) -> [VertexId; 2] {
    let edges = mesh.tets.iter().flat_map(|t| {
        let v = t.vertices;
        [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| [v[i].min(v[j]), v[i].max(v[j])])
    });
    let middle = |[a, b]: &[VertexId; 2]| mesh.vertices[a.index()].midpoint(mesh.vertices[b.index()]).length();
    edges.min_by(|p, q| middle(p).total_cmp(&middle(q))).unwrap()
}

/// What a current of 1 A (peak phasor) along the middle edge radiates, and that edge.
fn radiated(mesh: &TetMesh, surface_radius: f64) -> (Vec<FarField>, [DVec3; 2]) {
    radiated_into(mesh, surface_radius, NetworkSettings::new(10e9).wave_degrees)
}

/// * `wave_degrees`: of the waves that the outer boundary lets pass.
fn radiated_into(mesh: &TetMesh, surface_radius: f64, wave_degrees: usize) -> (Vec<FarField>, [DVec3; 2]) {
    let task = Task::default();
    let settings = NetworkSettings { step: StepLimit::Clip(0.003), wave_degrees, ..NetworkSettings::new(10e9) };
    let network: Network<f32> = Network::new(mesh, &settings, &task).unwrap();
    let huygens = Huygens::sphere(mesh, DVec3::ZERO, surface_radius);
    let recorder = FieldRecorder::new(mesh, &network, &huygens, &FREQS).unwrap();
    let pulse = Pulse::new(7e9, 13e9).unwrap();
    let ends = middle_edge(mesh);
    let mut run = Run::new(&network, pulse).with_current(network.edge(mesh, ends).unwrap()).with_fields(recorder);
    let dt = network.dt;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousand steps")]
    let n_steps = ((pulse.end() + 6.0 * WAVELENGTH / C0) / dt).ceil() as usize;
    run.advance(n_steps, &task).unwrap();
    let seen = run.fields().unwrap().fields();
    let mut fields = Vec::new();
    for mut seen in seen {
        let times = (0..n_steps).map(|n| (n as f64 + 0.5) * dt);
        let current: Complex<f64> = times.map(|t| Complex::from_polar(pulse.at(t) * dt, -TAU * seen.freq * t)).sum();
        seen.voltages.iter_mut().chain(&mut seen.currents).for_each(|x| *x /= current);
        fields.push(far_field(&huygens.surface, &seen));
    }
    (fields, ends.map(|v| mesh.vertices[v.index()]))
}

/// Greatest error of E relative to its greatest value; errors of radiated and crossing power; directivity, dBi.
fn compare(field: &FarField, [from, to]: [DVec3; 2]) -> [f64; 4] {
    let k = TAU * field.freq / C0;
    let (moment, source) = (to - from, from.midpoint(to));
    let peak = ETA0 * k * moment.length() / (4.0 * PI);
    let mut worst = 0.0_f64;
    for (t, theta) in field.theta.iter().enumerate() {
        for (p, phi) in field.phi.iter().enumerate() {
            let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
            let direction = DVec3::new(st * cp, st * sp, ct);
            let factor =
                Complex::new(0.0, -ETA0 * k / (4.0 * PI)) * Complex::from_polar(1.0, k * direction.dot(source));
            let place = t * field.phi.len() + p;
            let wanted = [DVec3::new(ct * cp, ct * sp, -st), DVec3::new(-sp, cp, 0.0)].map(|u| factor * u.dot(moment));
            worst = worst.max((field.e_theta[place] - wanted[0]).norm()).max((field.e_phi[place] - wanted[1]).norm());
        }
    }
    // 80 pi² (l/lambda)² |I|²/2, with the exact wave impedance of vacuum for 120 pi.
    let power = ETA0 * (k * moment.length()).powi(2) / (12.0 * PI);
    let powers = field.powers;
    [worst / peak, powers.radiated / power - 1.0, powers.crossing / power - 1.0, field.max_directivity().0]
}

#[test]
fn a_small_current_radiates_as_an_elementary_dipole() {
    let mut at_ten = Vec::new();
    for divisions in [9.0, 14.0] {
        let mesh = ball(0.6 * WAVELENGTH, WAVELENGTH / divisions);
        let (fields, ends) = radiated(&mesh, 0.3 * WAVELENGTH);
        for field in &fields {
            let found = compare(field, ends);
            println!("{} tetrahedra, {:.0} GHz: {found:?}", mesh.tets.len(), field.freq / 1e9);
        }
        at_ten.push(compare(&fields[1], ends));
    }
    let [error, radiated, crossing, directivity] = at_ten[1];
    assert!(error < 0.02 && error < 0.7 * at_ten[0][0], "far field: {at_ten:?}");
    assert!(radiated.abs() < 0.02 && crossing.abs() < 0.02, "powers: {at_ten:?}");
    assert!((radiated - crossing).abs() < 0.01, "far field against surface: {at_ten:?}");
    assert!((directivity - 10.0 * 1.5_f64.log10()).abs() < 0.05, "directivity: {directivity} dBi");
}

/// What a boundary reflects changes the power that the current gives away in its own field.
#[test]
fn spherical_waves_leave_a_close_boundary_as_if_there_were_none() {
    let mesh = ball(0.6 * WAVELENGTH, WAVELENGTH / 14.0);
    let crossing = |degrees| {
        let (fields, ends) = radiated_into(&mesh, 0.3 * WAVELENGTH, degrees);
        let found = fields.iter().map(|field| compare(field, ends));
        found
            .map(|[error, radiated, crossing, _]| {
                assert!(error < 0.02 && radiated.abs() < 0.02, "degrees {degrees}: {error}, {radiated}");
                crossing.abs()
            })
            .fold(0.0, f64::max)
    };
    let [first_order, free] = [0, 3].map(crossing);
    println!("error of the radiated power: {first_order} with the first-order boundary alone, {free} with free waves");
    assert!(free < 0.01 && first_order > 0.04, "{free} against {first_order}");
}

#[test]
fn the_gathered_field_is_the_same_bits_on_any_number_of_threads() {
    let mesh = ball(0.6 * WAVELENGTH, WAVELENGTH / 5.0);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| radiated(&mesh, 0.35 * WAVELENGTH).0)
    };
    assert_eq!(run(1), run(3), "one and three threads");
}
