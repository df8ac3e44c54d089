//! Whole meshes against closed forms: the energy of a closed box, the edge of a sheet, losses.

use super::assembly::Assembly;
use super::blocks::{FLUX, LANES};
use super::cell::EDGES;
use super::loads::Loads;
use super::slots::Slots;
use super::tests_cavity::cavity_mode;
use super::{Network, NetworkSettings, Pulse, Real, Run};
use crate::geometry::{DQuat, DVec3, Region, RegionId, RegionRole, VertexId};
use crate::task::Task;
use crate::tet::{FaceGroup, FaceRole, SizingSettings, Surface, SurfaceFacet, TetMesh, fill};
use crate::units::{C0, ETA0};
use nalgebra::{DMatrix, DVector, SMatrix};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// A surface of quads, made of named places.
#[derive(Default)]
struct Quads {
    vertices: Vec<DVec3>,
    names: HashMap<[usize; 3], VertexId>,
    facets: Vec<SurfaceFacet>,
}

impl Quads {
    fn vertex(&mut self, name: [usize; 3], at: DVec3) -> VertexId {
        *self.names.entry(name).or_insert_with(|| {
            self.vertices.push(at);
            VertexId::new(self.vertices.len() - 1)
        })
    }

    fn add(&mut self, [a, b, c, d]: [VertexId; 4], [back, front]: [usize; 2], group: Option<usize>) {
        for vertices in [[a, b, c], [a, c, d]] {
            self.facets.push(SurfaceFacet { vertices, back: RegionId::new(back), front: RegionId::new(front), group });
        }
    }

    /// The mesh is made askew and turned back: the mesher's lattice must not lie along the waves, or their errors cancel.
    fn fill(self, eps_r: &[f64], h: f64) -> TetMesh {
        let turn = DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7);
        let region = |k: usize| Region {
            name: format!("region {k}"),
            role: RegionRole::Dielectric,
            eps_r: eps_r.get(k.wrapping_sub(1)).copied().unwrap_or(1.0),
            tan_delta: 0.0,
        };
        let surface = Surface {
            vertices: self.vertices.iter().map(|p| turn * *p).collect(),
            facets: self.facets,
            regions: (0..=eps_r.len()).map(region).collect(),
            groups: ["walls", "sheet"]
                .map(|name| FaceGroup { name: name.to_owned(), role: FaceRole::Conductor })
                .into(),
        };
        let filled = fill(&surface, &[], SizingSettings { h_max: h, grading: 0.4 }, &Task::default());
        let mut mesh = filled.expect("a simple surface").mesh;
        mesh.vertices.iter_mut().for_each(|p| *p = turn.inverse() * *p);
        mesh
    }
}

/// The box from the origin to `size`, of layers along z of equal thickness, with conducting walls.
pub(super) fn layered_box(size: DVec3, eps_r: &[f64], h: f64) -> TetMesh {
    divided_box(size, eps_r, h, None)
}

/// The same with the faces between the layers in a group.
fn divided_box(size: DVec3, eps_r: &[f64], h: f64, divider: Option<usize>) -> TetMesh {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few quads")]
    let count = |length: f64| (length / h).round().max(1.0) as usize;
    let per_layer = count(size.z / eps_r.len() as f64);
    let n = [count(size.x), count(size.y), per_layer * eps_r.len()];
    let mut quads = Quads::default();
    let at = |name: [usize; 3]| size * DVec3::from_array([0, 1, 2].map(|i| name[i] as f64 / n[i] as f64));
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let inner = (1..eps_r.len()).map(|k| k * per_layer).filter(|_| axis == 2);
        for place in [0, n[axis]].into_iter().chain(inner) {
            for (i, j) in (0..n[u]).flat_map(|i| (0..n[v]).map(move |j| (i, j))) {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
                    let mut name = [0; 3];
                    (name[axis], name[u], name[v]) = (place, i, j);
                    quads.vertex(name, at(name))
                });
                let z = [i, j][usize::from(v == 2)];
                let layer = if axis == 2 { place.div_ceil(per_layer).max(1) } else { z / per_layer + 1 };
                let [a, b, c, d] = corners;
                if place == 0 {
                    quads.add([a, d, c, b], [layer, 0], Some(0));
                } else if place == n[axis] {
                    quads.add(corners, [layer, 0], Some(0));
                } else {
                    quads.add(corners, [layer, layer + 1], divider);
                }
            }
        }
    }
    quads.fill(eps_r, h)
}

/// A closed mesh with the places of its lanes.
pub(super) struct Closed<'a, T> {
    mesh: &'a TetMesh,
    assembly: Assembly<'a>,
    slots: Slots,
    network: Network<T>,
}

impl<'a, T: Real> Closed<'a, T> {
    pub(super) fn new(mesh: &'a TetMesh, edge_correction: bool) -> Self {
        Self::loaded(mesh, edge_correction, Loads::default())
    }

    fn loaded(mesh: &'a TetMesh, edge_correction: bool, loads: Loads) -> Self {
        let settings = NetworkSettings { edge_correction, loads, ..NetworkSettings::new(1e9) };
        let assembly = Assembly::new(mesh, &settings).expect("no port");
        let slots = Slots::new(&assembly);
        let network = Network::new(mesh, &settings, &Task::default()).expect("no port");
        Self { mesh, assembly, slots, network }
    }

    /// Half a time step, m.
    fn x(&self) -> f64 {
        self.network.dt * C0 / 2.0
    }

    /// Line integrals of a field along all edges.
    fn along_edges(&self, field: impl Fn(DVec3) -> DVec3) -> Vec<f64> {
        let place = |v: VertexId| self.mesh.vertices[v.index()];
        let of_edge = |&[a, b]: &[VertexId; 2]| {
            let (a, b) = (place(a), place(b));
            // Three points of Gauss.
            let nodes = [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)];
            nodes.iter().map(|(t, weight)| field(a + (b - a) * (0.5 + 0.5 * t)).dot(b - a) * weight).sum::<f64>()
        };
        self.slots.edge_ends.iter().map(of_edge).collect()
    }

    /// A run that begins with an electric field and no magnetic one.
    fn start(&self, voltages: &[f64]) -> Run<'_, T> {
        let mut run = Run::new(&self.network, Pulse::new(1.0, 2.0).expect("a band"));
        for (lane, cell) in self.slots.cells.iter().enumerate() {
            let Some(k) = *cell else { continue };
            let ports = self.slots.edges[lane];
            let v = DVector::from_fn(6, |e, _| voltages.get(ports[e] as usize).copied().unwrap_or(0.0));
            let capacitance = self.assembly.cell(k).capacitance;
            let flux = DMatrix::from_fn(6, 6, |i, j| capacitance[(i, j)]) * v / self.x();
            for e in 0..6 {
                run.states_mut()[lane / LANES][e][lane % LANES] = T::new(flux[e]);
            }
        }
        run
    }

    /// Frequency (as a wave number, 1/m) of the mode that a field begins with.
    ///
    /// The record is the projection onto that field, windowed; its spectrum's peak is searched around `guess`.
    pub(super) fn wave_number(&self, field: impl Fn(DVec3) -> DVec3, guess: f64) -> f64 {
        const PERIODS: f64 = 12.0;
        let voltages = self.along_edges(field);
        let mut run = self.start(&voltages);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousand steps")]
        let n = (PERIODS * TAU / guess / (2.0 * self.x())) as usize;
        let mut record = Vec::with_capacity(n);
        for k in 0..n {
            run.advance(1, &Task::default()).expect("not cancelled");
            let seen: f64 = run.voltages().iter().zip(&voltages).map(|(v, mode)| v.to_f64() * mode).sum();
            record.push(seen * (PI * (k as f64 + 0.5) / n as f64).sin().powi(2));
        }
        let level = |k: f64| {
            let turn = k * 2.0 * self.x();
            let sums = record.iter().enumerate().fold([0.0; 2], |[re, im], (n, y)| {
                let (sin, cos) = (turn * n as f64).sin_cos();
                [re + y * cos, im + y * sin]
            });
            sums[0].hypot(sums[1])
        };
        let (mut lo, mut hi) = (guess * 0.96, guess * 1.04);
        while hi - lo > 1e-7 * guess {
            let (a, b) = (lo + 0.382 * (hi - lo), lo + 0.618 * (hi - lo));
            if level(a) > level(b) { hi = b } else { lo = a }
        }
        (lo + hi) / 2.0
    }
}

/// Least-squares slope of log error over log h.
pub(super) fn order(errors: &[(f64, f64)]) -> f64 {
    let points: Vec<(f64, f64)> = errors.iter().map(|(h, e)| (h.ln(), e.abs().ln())).collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>();
    slope / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

pub(super) const CAVITY: DVec3 = DVec3::new(1.0, 0.9, 0.7);

/// Mean edge length of a mesh, m.
pub(super) fn mean_edge(mesh: &TetMesh) -> f64 {
    let edges: std::collections::BTreeSet<[VertexId; 2]> = mesh
        .tets
        .iter()
        .flat_map(|t| EDGES.map(|(i, j)| [t.vertices[i].min(t.vertices[j]), t.vertices[i].max(t.vertices[j])]))
        .collect();
    let length = |[a, b]: &[VertexId; 2]| mesh.vertices[a.index()].distance(mesh.vertices[b.index()]);
    edges.iter().map(length).sum::<f64>() / edges.len() as f64
}

/// A cylinder of radius 1 with a conducting sheet from its axis to its wall, between conducting lids.
///
/// * `m`: cells along the radius.
fn slit_cylinder(m: usize, n_z: usize, height: f64) -> TetMesh {
    // A polygon of the circle's area.
    let turn = TAU / (8 * m) as f64;
    let radius = (turn / turn.sin()).sqrt();
    // The square grid's rings become circles, its rays of constant slope straight lines.
    let at = |[i, j, z]: [usize; 3]| {
        let (x, y) = (i as f64 / m as f64 - 1.0, j as f64 / m as f64 - 1.0);
        let (r, angle) = if x.abs() >= y.abs() {
            (x, if i == m { 0.0 } else { y / x * PI / 4.0 })
        } else {
            (y, PI / 2.0 - x / y * PI / 4.0)
        };
        DVec3::new(radius * r * angle.cos(), radius * r * angle.sin(), height * z as f64 / n_z as f64)
    };
    let mut quads = Quads::default();
    let mut quad = |names: [[usize; 3]; 4], sides: [usize; 2]| {
        let corners = names.map(|name| quads.vertex(name, at(name)));
        quads.add(corners, sides, Some(0));
    };
    for (i, j) in (0..2 * m).flat_map(|i| (0..2 * m).map(move |j| (i, j))) {
        quad([[i, j, 0], [i, j + 1, 0], [i + 1, j + 1, 0], [i + 1, j, 0]], [1, 0]);
        quad([[i, j, n_z], [i + 1, j, n_z], [i + 1, j + 1, n_z], [i, j + 1, n_z]], [1, 0]);
    }
    for (k, z) in (0..2 * m).flat_map(|k| (0..n_z).map(move |z| (k, z))) {
        let up =
            |p: [usize; 2], q: [usize; 2]| [[p[0], p[1], z], [q[0], q[1], z], [q[0], q[1], z + 1], [p[0], p[1], z + 1]];
        quad(up([k, 0], [k + 1, 0]), [1, 0]);
        quad(up([2 * m, k], [2 * m, k + 1]), [1, 0]);
        quad(up([k + 1, 2 * m], [k, 2 * m]), [1, 0]);
        quad(up([0, k + 1], [0, k]), [1, 0]);
        if k >= m {
            quad(up([k, m], [k + 1, m]), [1, 1]);
        }
    }
    quads.fill(&[1.0], 1.0 / m as f64)
}

/// The fields at a sheet's edge, capacitive and inductive: modes of order one half of a cylinder with a radial sheet.
#[test]
fn sheet_edges_hold_the_energy_of_the_singular_field() {
    // Along the axis E = J_1/2(k r) sin(phi / 2): sin(k r) / sqrt(r) vanishes at the wall for k = pi.
    let inductive = |p: DVec3| {
        let r = p.truncate().length().max(1e-9);
        let half = 0.5 * p.y.atan2(p.x).rem_euclid(TAU);
        DVec3::Z * (PI * r).sin() / r.sqrt() * half.sin()
    };
    // Across it H = J_1/2(k r) cos(phi / 2), whose slope vanishes at the wall for tan k = 2 k.
    const K: f64 = 1.165_561_185_207_211;
    let height = 1.5;
    let along = PI / height;
    let capacitive = |p: DVec3| {
        let r = p.truncate().length().max(1e-9);
        let phi = p.y.atan2(p.x).rem_euclid(TAU);
        let (sin, cos) = (K * r).sin_cos();
        let slope = (K * cos - 0.5 * sin / r) / r.sqrt() * (0.5 * phi).cos();
        let turned = -0.5 * sin / r.sqrt() * (0.5 * phi).sin() / r;
        let (radial, around) = (DVec3::new(p.x, p.y, 0.0) / r, DVec3::new(-p.y, p.x, 0.0) / r);
        (radial * turned - around * slope) * (along * p.z).sin()
    };
    for (name, field, exact) in
        [("inductive", &inductive as &dyn Fn(DVec3) -> DVec3, PI), ("capacitive", &capacitive, K.hypot(along))]
    {
        let mut last = (0.0, 0.0);
        for m in [4, 6] {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few cells")]
            let mesh = slit_cylinder(m, (height * m as f64).round() as usize, height);
            let [without, with] =
                [false, true].map(|on| Closed::<f64>::new(&mesh, on).wave_number(field, exact) / exact - 1.0);
            last = (without, with);
        }
        assert!(last.1.abs() < 0.25 * last.0.abs() && last.0.abs() > 0.01, "{name}: {last:?}");
    }
}

/// Twice the energy of the field between scattering and connection, from the normalised states.
fn energy<T: Real>(closed: &Closed<'_, T>, run: &mut Run<'_, T>) -> f64 {
    let mut sum = 0.0;
    for (lane, cell) in closed.slots.cells.iter().enumerate() {
        let Some(k) = *cell else { continue };
        let cell = closed.assembly.cell(k);
        let c = cell.coefficients(closed.x(), &SMatrix::zeros());
        let live: Vec<usize> = (0..6).filter(|&e| c.y[e] > 0.0).collect();
        let (b, w) = (lane / LANES, lane % LANES);
        let p: Vec<f64> = live.iter().map(|&e| run.reflected()[b][e][w].to_f64()).collect();
        let state = run.states_mut()[b];
        let stub = DMatrix::from_fn(live.len(), live.len(), |i, j| {
            let (a, b) = (live[i], live[j]);
            cell.capacitance[(a, b)] / closed.x() - if i == j { c.y[a] } else { 0.0 }
        });
        let rest = DVector::from_fn(live.len(), |i, _| state[live[i]][w].to_f64() - p[i]);
        let flux = SMatrix::<f64, 3, 1>::from_fn(|i, _| state[FLUX + i][w].to_f64());
        sum += p.iter().zip(&live).map(|(p, &e)| p * p / c.y[e]).sum::<f64>();
        sum += rest.dot(&stub.lu().solve(&rest).expect("the stub has a margin"));
        sum += flux.dot(&cell.stub(closed.x()).lu().solve(&flux).expect("the stub has a margin"));
    }
    sum
}

/// Change of the energy of random fields in a closed box over a million steps, relative.
fn drift<T: Real>() -> f64 {
    const STEPS: usize = 1_000_000;
    let mesh = layered_box(CAVITY, &[2.2, 1.0], 0.4);
    let closed = Closed::<T>::new(&mesh, true);
    let mut rng = fastrand::Rng::with_seed(12);
    let voltages: Vec<f64> = closed.slots.edge_ends.iter().map(|_| rng.f64() - 0.5).collect();
    let mut run = closed.start(&voltages);
    let task = Task::default();
    run.advance(1, &task).expect("not cancelled");
    let before = energy(&closed, &mut run);
    run.advance(STEPS, &task).expect("not cancelled");
    energy(&closed, &mut run) / before - 1.0
}

#[test]
fn a_closed_box_keeps_its_energy_over_a_million_steps() {
    let drift = drift::<f64>();
    assert!(drift.abs() < 1e-9, "{drift:e}");
}

#[test]
fn a_closed_box_in_single_precision_stays_bounded_over_a_million_steps() {
    let drift = drift::<f32>();
    assert!(drift.abs() < 0.05, "{drift:e}");
}

/// Rate at which the mode of a box that a field begins with decays by a lossy sheet, 1/m.
fn decay(mesh: &TetMesh, (name, ohm_per_square): (&str, f64), mode: impl Fn(DVec3) -> DVec3, wave_number: f64) -> f64 {
    const PERIODS: usize = 10;
    let sheets = vec![(name.to_owned(), ohm_per_square)];
    let closed = Closed::<f64>::loaded(mesh, false, Loads { sheets, ..Loads::default() });
    let voltages = closed.along_edges(mode);
    let mut run = closed.start(&voltages);
    let step = 2.0 * closed.x();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred steps")]
    let in_period = (TAU / wave_number / step).round() as usize;
    let mut project = || {
        run.advance(1, &Task::default()).expect("not cancelled");
        run.voltages().iter().zip(&voltages).map(|(v, m)| v * m).sum::<f64>()
    };
    let mut last = project();
    let mut energies = Vec::new();
    for _ in 0..PERIODS {
        let mut energy = 0.0;
        for _ in 0..in_period {
            let now = project();
            // The start is rough: a part of it goes on to alternate from step to step.
            energy += (now + last).powi(2);
            last = now;
        }
        energies.push(energy);
    }
    0.5 * (energies[0] / energies[PERIODS - 1]).ln() / ((PERIODS - 1) * in_period) as f64 / step
}

/// Loss `R |K|^2 / 2` on walls, or on a sheet in the middle below which the field rings alone, over the energy.
#[test]
fn lossy_sheets_damp_as_perturbation_says() {
    const OHM_PER_SQUARE: f64 = 0.01 * ETA0;
    let k = DVec3::new(PI, PI, 0.0) / CAVITY;
    let (a, b, h) = (CAVITY.x, CAVITY.y, CAVITY.z);
    let sides = (k.x.powi(2) * b + k.y.powi(2) * a) * h / k.length_squared();
    let mesh = layered_box(CAVITY, &[1.0], 0.15);
    let walls = decay(&mesh, ("walls", OHM_PER_SQUARE), |p| cavity_mode(0, p), k.length());
    let mut rates = vec![(walls, 2.0 * OHM_PER_SQUARE / ETA0 * (a * b / 2.0 + sides) / (a * b * h))];
    // Other materials, so that the halves do not ring together.
    for eps_r in [[1.0, 2.2], [2.2, 1.0]] {
        let mesh = divided_box(CAVITY, &eps_r, 0.15, Some(1));
        let lower = |p: DVec3| if p.z < h / 2.0 { cavity_mode(0, p) } else { DVec3::ZERO };
        let found = decay(&mesh, ("sheet", OHM_PER_SQUARE), lower, k.length() / eps_r[0].sqrt());
        rates.push((found, OHM_PER_SQUARE / ETA0 / h));
    }
    for (found, expected) in rates {
        assert!((found / expected - 1.0).abs() < 0.1, "decays by {found} per m, expected {expected}");
    }
}
