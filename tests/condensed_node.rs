//! The symmetrical condensed node on cubes [JOH87], from which the idea of scattering and connecting comes: a reference
//! that shares no code with the tetrahedra. Fields are sums of incident pulses, a port reflects the field across it less
//! what came in opposite, and a cavity of such nodes rings at its closed form.
#![allow(clippy::print_stdout, reason = "a test")]

use std::f64::consts::{PI, TAU};

/// A port: axis of its line, side of the node (-1 or 1), polarisation.
type Port = (usize, i32, usize);

/// The twelve ports in the order in which the node was published.
const PORTS: [Port; 12] = [
    (1, -1, 0),
    (2, -1, 0),
    (0, -1, 1),
    (2, -1, 1),
    (1, -1, 2),
    (0, -1, 2),
    (1, 1, 2),
    (2, 1, 1),
    (2, 1, 0),
    (0, 1, 2),
    (0, 1, 1),
    (1, 1, 0),
];

/// Twice the published scattering matrix.
const PUBLISHED: [[i32; 12]; 12] = [
    [0, 1, 1, 0, 0, 0, 0, 0, 1, 0, -1, 0],
    [1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0, 1],
    [1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1],
    [0, 0, 1, 0, 1, 0, -1, 0, 0, 0, 1, 0],
    [0, 0, 0, 1, 0, 1, 0, -1, 0, 1, 0, 0],
    [0, 1, 0, 0, 1, 0, 1, 0, -1, 0, 0, 0],
    [0, 0, 0, -1, 0, 1, 0, 1, 0, 1, 0, 0],
    [0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 1, 0],
    [1, 0, 0, 0, 0, -1, 0, 0, 0, 1, 0, 1],
    [0, -1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0],
    [-1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1],
    [0, 1, -1, 0, 0, 0, 0, 0, 1, 0, 1, 0],
];

fn find(port: Port) -> usize {
    PORTS.iter().position(|&p| p == port).expect("one of the twelve")
}

/// The axis that is neither of two, and the sign of their cross product.
fn third(a: usize, b: usize) -> (usize, f64) {
    let c = 3 - a - b;
    (c, if (a + 1) % 3 == b { 1.0 } else { -1.0 })
}

/// What a port's pulse adds to the magnetic field along an axis: a wave that travels into the node carries
/// `Z H = direction x E`.
fn magnetic((line, side, polarisation): Port, axis: usize) -> f64 {
    let (across, sign) = third(line, polarisation);
    if across == axis { -f64::from(side) * sign } else { 0.0 }
}

fn scatter(incident: &[f64; 12]) -> [f64; 12] {
    let electric =
        |axis: usize| PORTS.iter().zip(incident).filter(|(p, _)| p.2 == axis).map(|(_, a)| a / 2.0).sum::<f64>();
    let field = [0, 1, 2].map(electric);
    let turned =
        [0, 1, 2].map(|axis| PORTS.iter().zip(incident).map(|(&p, a)| magnetic(p, axis) * a / 2.0).sum::<f64>());
    std::array::from_fn(|k| {
        let (line, side, polarisation) = PORTS[k];
        let across = third(line, polarisation).0;
        // What leaves carries Z H the other way round than what comes in.
        let h = -magnetic(PORTS[k], across) * turned[across];
        field[polarisation] + h - incident[find((line, -side, polarisation))]
    })
}

#[test]
fn fields_and_opposite_pulses_give_the_published_scattering() {
    for column in 0..12 {
        let mut incident = [0.0; 12];
        incident[column] = 1.0;
        let out = scatter(&incident);
        for row in 0..12 {
            let published = f64::from(PUBLISHED[row][column]) / 2.0;
            assert!((out[row] - published).abs() < 1e-15, "S({}, {}) is {}", row + 1, column + 1, out[row]);
        }
        assert!((out.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15, "power is kept");
    }
}

#[test]
fn a_cavity_of_condensed_nodes_rings_at_its_closed_form() {
    // Mode 110 of a 12 x 10 x 2 cavity; a pulse moves one cell in two half steps, light half as fast as the lines.
    const N: [usize; 3] = [12, 10, 2];
    let exact = (PI / N[0] as f64).hypot(PI / N[1] as f64) / 2.0;
    let index = |c: [usize; 3]| (c[0] * N[1] + c[1]) * N[2] + c[2];
    let cells: Vec<[usize; 3]> =
        (0..N[0] * N[1] * N[2]).map(|k| [k / (N[1] * N[2]), k / N[2] % N[1], k % N[2]]).collect();
    let profile =
        |c: [usize; 3]| (PI * (c[0] as f64 + 0.5) / N[0] as f64).sin() * (PI * (c[1] as f64 + 0.5) / N[1] as f64).sin();
    let mut state: Vec<[f64; 12]> =
        cells.iter().map(|&c| std::array::from_fn(|p| if PORTS[p].2 == 2 { profile(c) } else { 0.0 })).collect();
    const STEPS: usize = 1200;
    let mut record = Vec::with_capacity(STEPS);
    for n in 0..STEPS {
        let out: Vec<[f64; 12]> = state.iter().map(scatter).collect();
        for (&c, incident) in cells.iter().zip(&mut state) {
            for (p, &(line, side, polarisation)) in PORTS.iter().enumerate() {
                let is_wall = if side < 0 { c[line] == 0 } else { c[line] + 1 == N[line] };
                incident[p] = if is_wall {
                    -out[index(c)][p]
                } else {
                    let mut neighbor = c;
                    neighbor[line] = if side < 0 { c[line] - 1 } else { c[line] + 1 };
                    out[index(neighbor)][find((line, -side, polarisation))]
                };
            }
        }
        let window = (PI * (n as f64 + 0.5) / STEPS as f64).sin().powi(2);
        let seen: f64 = cells.iter().map(|&c| profile(c) * state[index(c)][find((0, -1, 2))]).sum();
        record.push(seen * window);
    }
    let level = |k: f64| {
        let [re, im] = record.iter().enumerate().fold([0.0; 2], |[re, im], (n, y)| {
            let (sin, cos) = (k * n as f64).sin_cos();
            [re + y * cos, im + y * sin]
        });
        re.hypot(im)
    };
    let best = (0..=2000)
        .map(|k| exact * (0.95 + f64::from(k) * 5e-5))
        .max_by(|a, b| level(*a).total_cmp(&level(*b)))
        .expect("some frequencies");
    let error = best / exact - 1.0;
    println!("{:.1} cells per wavelength: {error:+.2e}", TAU / (2.0 * exact));
    // Dispersion of the node is of second order: less than (k h)² / 24.
    assert!(error.abs() < (2.0 * exact).powi(2) / 24.0, "{error:e}");
}
