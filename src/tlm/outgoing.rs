//! Waves that leave through the outer sphere: what the first-order boundary lacks, for the first spherical waves.
//!
//! Beyond a sphere of radius R around all sources the field is a sum of outgoing spherical waves. Each meets the wave
//! admittance of its degree l, a rational function of `p = jωR/c`; the first-order (Silver-Mueller) boundary gives all of
//! them 1, and so reflects about `l (l + 1) / (4 k² R²)`. Here the waves up to a degree meet their own one. \[CHU48\] gives
//! it as a ladder: with `F_l = 1/p + 1` and `F_k = a_k/p + 1/F_(k+1)`, `a = l, 2l-1, 2l-3, .., 3, 1`, the admittance is
//! `F_0` for waves with a magnetic field along the radius (TE) and `1/F_0` for those with an electric one (TM).
//!
//! The waves are modes of the boundary (see [`super::modes`]), orthonormal in its mass matrix G. Its admittance is
//! `G - Σ g g^T + Σ g F g^T`: the first two terms are not negative, since `Σ g g^T` projects, and F is passive and stays so
//! under the trapezoidal rule. So the proof of stability holds as before.
//!
//! Not handled: matter other than air at the sphere.
//!
//! Sources: \[CHU48\]; vector spherical waves as in \[HAR61\].

use super::cell::face_mass;
use super::modes::Modes;
use super::real::Real;
use crate::geometry::{DVec3, VertexId};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix3xX, Matrix4, RowDVector, Vector4};
use std::collections::HashMap;

/// Whether the electric or the magnetic field is across the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Tm,
    Te,
}

/// The admittance of a degree as a linear system, stepped by the trapezoidal rule: current `y v + out·state`, then
/// `state <- next state + drive v`.
#[derive(Clone, Debug)]
struct Ladder {
    y: f64,
    out: RowDVector<f64>,
    next: DMatrix<f64>,
    drive: DVector<f64>,
}

/// The ladder's equations `w' = A w + B v`, `i = C w + D v`; times are in units of R/c.
type StateSpace = (DMatrix<f64>, DVector<f64>, RowDVector<f64>, f64);

/// * `degree`: l, at least 1.
fn state_space(kind: Kind, degree: usize) -> StateSpace {
    let n = degree + 1;
    let rate = DVector::from_fn(n, |k, _| if k == 0 { degree as f64 } else { (2 * (degree - k) + 1) as f64 });
    // Inputs f_k of the F_k from w and v: f_(k-1) = w_k + f_(k+1), at the end f_(l-1) = w_l + f_l.
    let mut equations = DMatrix::zeros(n, n);
    let (mut of_w, mut of_v) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for k in 1..n {
        equations[(k, k - 1)] = 1.0;
        equations[(k, (k + 1).min(n - 1))] = -1.0;
        of_w[(k, k)] = 1.0;
    }
    // The voltage is F_0 f_0 = w_0 + f_1, or f_0 itself; the current is the other one.
    of_v[0] = 1.0;
    if kind == Kind::Tm {
        equations[(0, 1)] = 1.0;
        of_w[(0, 0)] = -1.0;
    } else {
        equations[(0, 0)] = 1.0;
    }
    let inverse = equations.try_inverse().expect("a ladder has one solution");
    let (from_w, from_v) = (&inverse * of_w, inverse * of_v);
    let a = DMatrix::from_fn(n, n, |i, j| rate[i] * from_w[(i, j)]);
    let b = DVector::from_fn(n, |i, _| rate[i] * from_v[i]);
    let row = usize::from(kind == Kind::Te);
    let mut c: RowDVector<f64> = from_w.row(row).into_owned();
    if kind == Kind::Te {
        c[0] += 1.0;
    }
    (a, b, c, from_v[row])
}

impl Ladder {
    /// * `step`: time step in units of R/c.
    fn new(kind: Kind, degree: usize, step: f64) -> Self {
        let (a, b, c, d) = state_space(kind, degree);
        let identity = DMatrix::identity(degree + 1, degree + 1);
        let half = step / 2.0;
        let implicit = (&identity - &a * half).try_inverse().expect("a passive system");
        let explicit = &identity + &a * half;
        let out = c * &implicit;
        let next = &explicit * &implicit;
        let drive = (&next * &b + &b) * half;
        Self { y: d + (&out * &b)[0] * half, out, next, drive }
    }
}

/// One spherical wave.
#[derive(Clone, Copy, Debug)]
struct Wave {
    kind: Kind,
    degree: usize,
    /// Below zero for the odd ones.
    order: isize,
}

fn waves(degrees: usize) -> Vec<Wave> {
    let orders = |degree: usize| {
        let most = degree.cast_signed();
        [Kind::Tm, Kind::Te]
            .into_iter()
            .flat_map(move |kind| (-most..=most).map(move |order| Wave { kind, degree, order }))
    };
    (1..=degrees).flat_map(orders).collect()
}

/// A real spherical harmonic of a direction, not normalised.
fn harmonic(degree: usize, order: isize, at: DVec3) -> f64 {
    let direction = at / at.length();
    let (z, phi, m) = (direction.z, direction.y.atan2(direction.x), order.unsigned_abs());
    let around = if order < 0 { (m as f64 * phi).sin() } else { (m as f64 * phi).cos() };
    // Associated Legendre functions by the recurrence in the degree.
    let mut below = 0.0;
    let mut legendre = (1..=m).map(|k| (2 * k - 1) as f64 * (1.0 - z * z).max(0.0).sqrt()).product::<f64>();
    for l in m + 1..=degree {
        let above = ((2 * l - 1) as f64 * z * legendre - (l + m - 1) as f64 * below) / (l - m) as f64;
        (below, legendre) = (legendre, above);
    }
    legendre * around
}

impl Wave {
    /// Integral of its tangential electric field along an edge of the sphere, not normalised.
    ///
    /// * `from`, `to`: relative to the center.
    fn along(&self, from: DVec3, to: DVec3) -> f64 {
        let value = |at: DVec3| harmonic(self.degree, self.order, at);
        if self.kind == Kind::Tm {
            // The gradient of the harmonic.
            return value(to) - value(from);
        }
        // The gradient turned by a right angle about the radius: what crosses the edge, by two points of Gauss.
        let across = (to - from).cross(from + to);
        let step = across * (1e-4 / across.length()) * from.length();
        let crossing = |share: f64| {
            let at = from.lerp(to, share);
            (value(at + step) - value(at - step)) / (2.0 * step.length())
        };
        let offset = 0.5 / 3.0_f64.sqrt();
        (crossing(0.5 - offset) + crossing(0.5 + offset)) / 2.0 * from.distance(to)
    }
}

/// The outer sphere of a mesh with its waves.
#[derive(Clone, Debug)]
pub(super) struct OuterSphere {
    radius: f64,
    waves: Vec<Wave>,
    /// `g` of all waves for the edges (01), (02), (12) of each face, vertices ascending: `[3, n_waves]`.
    forms: HashMap<[VertexId; 3], Matrix3xX<f64>>,
}

/// Greatest distance of a vertex from the sphere, relative to its radius: the middle of an edge that was split to recover
/// the surface lies a little inside.
const ROUND: f64 = 0.01;

impl OuterSphere {
    /// The sphere that outer faces lie on; `None` if they lie on no sphere, or if no waves are wanted.
    ///
    /// * `faces`: vertices ascending; `points`: all vertices, m; `degrees`: of the waves.
    pub(super) fn new(faces: &[[VertexId; 3]], points: &[DVec3], degrees: usize) -> Option<Self> {
        let waves = waves(degrees);
        let (center, radius) = sphere_through(faces, points).filter(|_| !waves.is_empty())?;
        let at = |v: VertexId| points[v.index()] - center;
        let field = |f: &[VertexId; 3]| {
            let edges = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| (at(f[i]), at(f[j])));
            Matrix3xX::from_fn(waves.len(), |e, m| waves[m].along(edges[e].0, edges[e].1))
        };
        let of_faces: Vec<(Matrix3<f64>, Matrix3xX<f64>)> =
            faces.iter().map(|f| (face_mass(f.map(|v| points[v.index()])).0, field(f))).collect();
        let gram = of_faces
            .iter()
            .fold(DMatrix::zeros(waves.len(), waves.len()), |sum, (mass, e)| sum + e.transpose() * mass * e);
        // To unit norm first, then orthogonal with the least change of each.
        let norms = DMatrix::from_diagonal(&gram.diagonal().map(|norm| norm.sqrt().recip()));
        let mut eigen = (&norms * gram * &norms).symmetric_eigen();
        eigen.eigenvalues.apply(|w| *w = w.sqrt().recip());
        let orthonormal = norms * eigen.recompose();
        let forms = faces.iter().zip(of_faces).map(|(f, (mass, e))| (*f, mass * e * &orthonormal)).collect();
        Some(Self { radius, waves, forms })
    }

    pub(super) fn n_waves(&self) -> usize {
        self.waves.len()
    }

    /// `g` of all waves for the edges (01), (02), (12) of a face: `[3, n_waves]`.
    pub(super) fn form(&self, face: &[VertexId; 3]) -> Option<&Matrix3xX<f64>> {
        self.forms.get(face)
    }
}

/// Center and radius of the sphere through all vertices of some faces.
fn sphere_through(faces: &[[VertexId; 3]], points: &[DVec3]) -> Option<(DVec3, f64)> {
    let places: Vec<DVec3> = faces.iter().flatten().map(|v| points[v.index()]).collect();
    let first = *places.first()?;
    // |p|² = 2 c·p + (r² - c²), by least squares, about the first place.
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for p in places.iter().map(|p| *p - first) {
        let row = Vector4::new(2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0);
        normal += row * row.transpose();
        right += row * p.length_squared();
    }
    let solution = normal.lu().solve(&right)?;
    let center = first + DVec3::new(solution.x, solution.y, solution.z);
    let radius = places.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
    let is_on_it = |p: &DVec3| (p.distance(center) - radius).abs() < ROUND * radius;
    (radius.is_finite() && places.iter().all(is_on_it)).then_some((center, radius))
}

/// The waves' circuits at a mesh's outer sphere: fixed once built.
#[derive(Clone, Debug)]
pub(super) struct Outgoing<T> {
    pub(super) modes: Modes<T>,
    /// One for each wave.
    ladders: Vec<Ladder>,
    /// From the voltages without the waves' currents, less `S` times what the circuits still give, to the true ones.
    solve: DMatrix<f64>,
}

impl<T: Real> Outgoing<T> {
    /// * `modes`: of the sphere's waves; `x`: half a time step, m.
    pub(super) fn new(sphere: &OuterSphere, modes: Modes<T>, x: f64) -> Self {
        let step = 2.0 * x / sphere.radius;
        let n = sphere.n_waves();
        let ladders: Vec<Ladder> = sphere.waves.iter().map(|wave| Ladder::new(wave.kind, wave.degree, step)).collect();
        let more = DMatrix::<f64>::from_diagonal(&DVector::from_iterator(n, ladders.iter().map(|l| l.y - 1.0)));
        let solve = (DMatrix::<f64>::identity(n, n) + &modes.coupling * more).try_inverse().expect("a passive system");
        Self { modes, ladders, solve }
    }

    /// The states of all circuits before any field.
    pub(super) fn start(&self) -> Vec<f64> {
        vec![0.0; self.ladders.iter().map(|ladder| ladder.drive.len()).sum()]
    }

    /// One step of all circuits: their currents beyond those of the first-order boundary.
    ///
    /// * `seen`: the waves' voltages without these currents; `states`: of all circuits, brought up to date.
    pub(super) fn step(&self, seen: &[f64], states: &mut [f64]) -> Vec<f64> {
        let mut rest = &mut states[..];
        let of_each: Vec<&mut [f64]> = self
            .ladders
            .iter()
            .map(|ladder| rest.split_off_mut(..ladder.drive.len()).expect("the states of all circuits"))
            .collect();
        let given = self.ladders.iter().zip(&of_each).map(|(ladder, state)| dot(ladder.out.iter(), state));
        let given = DVector::from_iterator(seen.len(), given);
        let voltages = &self.solve * (DVector::from_column_slice(seen) - &self.modes.coupling * &given);
        for ((ladder, state), v) in self.ladders.iter().zip(of_each).zip(voltages.iter()) {
            let next: Vec<f64> =
                (0..state.len()).map(|k| dot(ladder.next.row(k).iter(), state) + ladder.drive[k] * v).collect();
            state.copy_from_slice(&next);
        }
        self.ladders
            .iter()
            .zip(&voltages)
            .zip(&given)
            .map(|((ladder, v), given)| (ladder.y - 1.0) * v + given)
            .collect()
    }
}

fn dot<'a>(a: impl Iterator<Item = &'a f64>, b: &[f64]) -> f64 {
    a.zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    /// Wave admittance by the spherical Hankel function h of the second kind: for TM `-j u / u'`, for TE `j u' / u`,
    /// with `u = x h(x)`.
    fn exact(kind: Kind, degree: usize, x: f64) -> Complex<f64> {
        let j = Complex::<f64>::i();
        let end = Complex::from_polar(1.0, -x);
        // x h_0 = j exp(-jx), and the recurrence in the degree.
        let (mut below, mut u) = (end, j * end);
        for l in 0..degree {
            (below, u) = (u, u * ((2 * l + 1) as f64 / x) - below);
        }
        let slope = below - u * (degree as f64 / x);
        if kind == Kind::Tm { -j * u / slope } else { j * slope / u }
    }

    #[test]
    fn ladders_are_the_admittances_of_spherical_waves() {
        for (kind, degree) in
            [Kind::Tm, Kind::Te].into_iter().flat_map(|kind| (1..=4).map(move |degree| (kind, degree)))
        {
            let (a, b, c, d) = state_space(kind, degree);
            for x in [0.5, 2.0, 7.0] {
                let system = DMatrix::identity(degree + 1, degree + 1) * Complex::new(0.0, x) - a.map(Complex::from);
                let w = system.lu().solve(&b.map(Complex::from)).expect("not at a resonance");
                let y = (c.map(Complex::from) * w)[0] + d;
                let expected = exact(kind, degree, x);
                assert!((y - expected).norm() < 1e-9 * expected.norm(), "{kind:?} {degree} at {x}: {y}, {expected}");
            }
        }
    }

    #[test]
    fn a_ladder_gives_no_power_at_any_step() {
        let mut rng = fastrand::Rng::with_seed(5);
        for (kind, step) in [(Kind::Tm, 0.01), (Kind::Te, 0.01), (Kind::Tm, 3.0), (Kind::Te, 3.0)] {
            for degree in 1..=4 {
                let ladder = Ladder::new(kind, degree, step);
                let (mut state, mut energy) = (DVector::zeros(degree + 1), 0.0_f64);
                for _ in 0..5000 {
                    let v = rng.f64() - 0.5;
                    energy += v * (ladder.y * v + (&ladder.out * &state)[0]);
                    state = &ladder.next * state + &ladder.drive * v;
                    assert!(energy > -1e-12, "{kind:?} {degree}, step {step}: {energy}");
                }
            }
        }
    }
}
