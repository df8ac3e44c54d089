//! One tetrahedron as a TLM node: its matrices, the largest time step it allows, and its coefficients in flux form.
//!
//! Ports are the six edges, oriented from the lower to the higher vertex number; a port's voltage is the line integral
//! of E. `w_e = λ_i ∇λ_j - λ_j ∇λ_i` are the Whitney functions, `C_ab = ε ∫ w_a·w_b` the capacitance. The curl is
//! constant in a cell: `R = Q K` with the cell's edge vectors over 3 in Q and the circulations of the three faces at the
//! first vertex in K, so that nothing of R is stored. Lengths are metres, and c = ε0 = µ0 = 1: x, half a time step,
//! is a length, admittances are in units of the free-space one.
//!
//! With `d_e = (K^T L^-1 K)_ee`, `L^-1 = Q^T Q / (µ V)`, the line admittance of port e is `θ d_e / x`, θ the smallest
//! eigenvalue of `d^-1/2 C d^-1/2`; what is left of C and L are stubs, which must not be negative:
//! `C - θ d >= 0` always, `L - x² K diag(1/(θ d)) K^T >= 0` for x up to [`Cell::x_max`]. That is the whole proof of
//! stability, cell by cell.

use crate::geometry::DVec3;
use nalgebra::{Cholesky, DMatrix, Matrix3, Matrix6, SMatrix};

/// Ends of the six edges among the four vertices, which ascend by number.
pub(super) const EDGES: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

pub(super) type Curl = SMatrix<f64, 3, 6>;

/// Circulations of the faces 012, 013 and 023 (up to the sign that Q carries).
pub(super) fn circulations() -> Curl {
    Curl::from_row_slice(&[1., -1., 0., 1., 0., 0., -1., 0., 1., 0., -1., 0., 0., 1., -1., 0., 0., 1.])
}

/// Share of the largest admissible θ and x that is used: at 1 rounding in single precision makes the state grow.
pub(super) const MARGIN: f64 = 0.98;

/// Smallest eigenvalue, in the metric of L, that a clipped inductive stub keeps: none at all would grow.
const CLIP_FLOOR: f64 = 0.04;

/// The matrices of one cell.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Capacitance, rows and columns of dropped ports zero.
    pub(super) capacitance: Matrix6<f64>,
    /// Inductance in the flux variables.
    inductance: Matrix3<f64>,
    curl: Curl,
    /// Ports in use; the others lie on conductors.
    free: [bool; 6],
    /// Line capacitance `θ d` of each port.
    line: [f64; 6],
    /// `K diag(1/(θ d)) K^T`
    link: Matrix3<f64>,
    /// Largest half time step, m; infinite where all ports are dropped.
    pub(super) x_max: f64,
}

/// Coefficients of the update.
#[derive(Clone, Debug)]
pub(super) struct Coefficients {
    pub(super) d: Matrix6<f64>,
    pub(super) a_inverse: Matrix3<f64>,
    /// Line admittances; 0 for dropped ports.
    pub(super) y: [f64; 6],
}

/// `∫ w_a·w_b` over a tetrahedron, a 6 x 6 matrix in m.
fn whitney_mass(points: [DVec3; 4], volume: f64, gradients: [DVec3; 4]) -> Matrix6<f64> {
    debug_assert!(volume > 0.0, "a cell has a volume: {points:?}");
    let m = |i: usize, k: usize| if i == k { 0.1 } else { 0.05 };
    let g = |j: usize, l: usize| gradients[j].dot(gradients[l]);
    Matrix6::from_fn(|a, b| {
        let ((i, j), (k, l)) = (EDGES[a], EDGES[b]);
        volume * (m(i, k) * g(j, l) - m(i, l) * g(j, k) - m(j, k) * g(i, l) + m(j, l) * g(i, k))
    })
}

impl Cell {
    /// * `points`: corners in the order of their numbers, either orientation, m.
    /// * `eps_r`, `mu_r`: relative permittivity and permeability.
    pub(super) fn new(points: [DVec3; 4], eps_r: f64, mu_r: f64, free: [bool; 6]) -> Self {
        let [e1, e2, e3] = [1, 2, 3].map(|k| points[k] - points[0]);
        let determinant = e1.cross(e2).dot(e3);
        let volume = determinant.abs() / 6.0;
        let [g1, g2, g3] = [e2.cross(e3), e3.cross(e1), e1.cross(e2)].map(|n| n / determinant);
        let mass = whitney_mass(points, volume, [-(g1 + g2 + g3), g1, g2, g3]);
        let kept = |a: usize, b: usize| free[a] && free[b];
        let capacitance = Matrix6::from_fn(|a, b| if kept(a, b) { eps_r * mass[(a, b)] } else { 0.0 });
        let columns = [e3, e2, e1].map(|e| e * (determinant.signum() / 3.0));
        let inverse = Matrix3::from_fn(|i, j| columns[i].dot(columns[j]) / (mu_r * volume));
        let full = circulations();
        let curl = Curl::from_fn(|i, e| if free[e] { full[(i, e)] } else { 0.0 });
        let d: [f64; 6] =
            std::array::from_fn(
                |e| if free[e] { (curl.column(e).transpose() * inverse * curl.column(e))[0] } else { 1.0 },
            );
        // Dropped ports must not be the smallest eigenvalue.
        let mut scaled = Matrix6::from_fn(|a, b| capacitance[(a, b)] / (d[a] * d[b]).sqrt());
        let large = 10.0 * (scaled.trace() + f64::MIN_POSITIVE);
        (0..6).filter(|&e| !free[e]).for_each(|e| scaled[(e, e)] = large);
        let theta = MARGIN * scaled.symmetric_eigenvalues().min();
        let line: [f64; 6] = std::array::from_fn(|e| if free[e] { theta * d[e] } else { 0.0 });
        let over =
            Matrix6::from_diagonal(&nalgebra::Vector6::from_fn(|e, _| if free[e] { 1.0 / line[e] } else { 0.0 }));
        let link = curl * over * curl.transpose();
        // The Gram matrix of three independent edges.
        let root = Cholesky::new(inverse).expect("a cell has a volume").l();
        let largest = (root.transpose() * link * root).symmetric_eigenvalues().max();
        let x_max = if largest > 0.0 { largest.sqrt().recip() } else { f64::INFINITY };
        let inductance = inverse.try_inverse().expect("a cell has a volume");
        Self { capacitance, inductance, curl, free, line, link, x_max }
    }

    /// The inductive stub `(L - x² K diag(1/(θ d)) K^T) / x`, clipped where x is too large for the cell.
    pub(super) fn stub(&self, x: f64) -> Matrix3<f64> {
        if x <= self.x_max {
            return (self.inductance - self.link * (x * x)) / x;
        }
        let root = Cholesky::new(self.inductance).expect("positive definite").l();
        let inverse = root.try_inverse().expect("positive definite");
        let relative = Matrix3::identity() - inverse * self.link * inverse.transpose() * (x * x);
        let mut eigen = relative.symmetric_eigen();
        eigen.eigenvalues.apply(|w| *w = w.max(CLIP_FLOOR));
        root * eigen.recompose() * root.transpose() / x
    }

    /// The coefficients for half a time step x.
    ///
    /// * `loss`: conductance matrix of lossy material and boundary faces.
    pub(super) fn coefficients(&self, x: f64, loss: &Matrix6<f64>) -> Coefficients {
        let kept = |a: usize, b: usize| self.free[a] && self.free[b];
        let full = Matrix6::from_fn(|a, b| match kept(a, b) {
            true => self.capacitance[(a, b)] / x + loss[(a, b)],
            false => f64::from(u8::from(a == b)),
        });
        let inverse = full.try_inverse().expect("positive definite");
        let d = Matrix6::from_fn(|a, b| if kept(a, b) { inverse[(a, b)] } else { 0.0 });
        let a = self.stub(x) + self.curl * d * self.curl.transpose();
        let a_inverse = a.try_inverse().expect("positive definite");
        Coefficients { d, a_inverse, y: self.line.map(|line| line / x) }
    }
}

/// Square root of a matrix that is positive semidefinite up to rounding; `None` if it is not.
fn root<const N: usize>(m: SMatrix<f64, N, N>) -> Option<DMatrix<f64>> {
    let mut eigen = DMatrix::from_fn(N, N, |i, j| m[(i, j)]).symmetric_eigen();
    let scale = eigen.eigenvalues.amax();
    if eigen.eigenvalues.min() < -1e-10 * scale {
        return None;
    }
    eigen.eigenvalues.apply(|w| *w = w.max(0.0).sqrt());
    Some(eigen.recompose())
}

impl Cell {
    /// The scattering matrix of the energy-normalised states without losses, 15 x 15: ports, capacitive and inductive
    /// stubs; `None` if a stub is negative.
    fn scattering(&self, x: f64) -> Option<DMatrix<f64>> {
        let c = self.coefficients(x, &Matrix6::zeros());
        let stub = self.capacitance / x - Matrix6::from_diagonal(&nalgebra::Vector6::from_fn(|e, _| c.y[e]));
        let (capacitive, inductive) = (root(stub)?, root(self.stub(x))?);
        let d = DMatrix::from_fn(6, 6, |i, j| c.d[(i, j)]);
        let a_inverse = DMatrix::from_fn(3, 3, |i, j| c.a_inverse[(i, j)]);
        let curl = DMatrix::from_fn(3, 6, |i, j| self.curl[(i, j)]);
        let mut j = DMatrix::zeros(6, 15);
        for e in 0..6 {
            j[(e, e)] = 2.0 * c.y[e].sqrt();
        }
        j.view_mut((0, 6), (6, 6)).copy_from(&(2.0 * &capacitive));
        let mut h = -(&a_inverse * &curl * &d * &j);
        let mut stub_part = h.view_mut((0, 12), (3, 3));
        stub_part += 2.0 * &a_inverse * &inductive;
        let v = &d * (&j + curl.transpose() * &h);
        let mut s = DMatrix::zeros(15, 15);
        for e in 0..6 {
            s.row_mut(e).copy_from(&(v.row(e) * c.y[e].sqrt()));
        }
        s.view_mut((6, 0), (6, 15)).copy_from(&(capacitive * &v));
        s.view_mut((12, 0), (3, 15)).copy_from(&(inductive * &h));
        Some(s - DMatrix::identity(15, 15))
    }

    /// How far the scattering of the cell without losses is from orthogonal: infinitely if a stub is negative.
    pub(super) fn orthogonality_error(&self, x: f64) -> f64 {
        self.scattering(x).map_or(f64::INFINITY, |s| (&s * s.transpose() - DMatrix::identity(15, 15)).amax())
    }
}

/// `∫ w·w` over a triangle for its edges (01), (02), (12), m^0, and the area, m².
pub(super) fn face_mass(points: [DVec3; 3]) -> (Matrix3<f64>, [DVec3; 3], f64) {
    let doubled = (points[1] - points[0]).cross(points[2] - points[0]);
    let area = doubled.length() / 2.0;
    let normal = doubled / (2.0 * area);
    let gradients: [DVec3; 3] =
        std::array::from_fn(|i| normal.cross(points[(i + 2) % 3] - points[(i + 1) % 3]) / (2.0 * area));
    let ends = [(0, 1), (0, 2), (1, 2)];
    let m = |i: usize, k: usize| if i == k { 2.0 / 12.0 } else { 1.0 / 12.0 };
    let g = |j: usize, l: usize| gradients[j].dot(gradients[l]);
    let mass = Matrix3::from_fn(|a, b| {
        let ((i, j), (k, l)) = (ends[a], ends[b]);
        area * (m(i, k) * g(j, l) - m(i, l) * g(j, k) - m(j, k) * g(i, l) + m(j, l) * g(i, k))
    });
    (mass, gradients, area)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_cell(rng: &mut fastrand::Rng, free: [bool; 6]) -> Cell {
        loop {
            let points: [DVec3; 4] = std::array::from_fn(|_| DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 1e-3);
            let volume = (points[1] - points[0]).cross(points[2] - points[0]).dot(points[3] - points[0]).abs();
            // Flat cells lose digits in the inverses, in proportion to how flat they are.
            if volume > 2e-10 {
                return Cell::new(points, 1.0 + 3.0 * rng.f64(), 1.0 + rng.f64(), free);
            }
        }
    }

    #[test]
    fn scattering_of_a_lossless_cell_is_orthogonal() {
        let mut rng = fastrand::Rng::with_seed(8);
        for n in 0..200 {
            let cell = random_cell(&mut rng, [true; 6]);
            let error = cell.orthogonality_error(cell.x_max * if n % 2 == 0 { 0.98 } else { 0.4 });
            assert!(error < 1e-12, "cell {n}: {error:e}");
        }
    }

    #[test]
    fn a_clipped_cell_is_still_orthogonal() {
        let mut rng = fastrand::Rng::with_seed(9);
        for _ in 0..50 {
            let cell = random_cell(&mut rng, [true; 6]);
            let error = cell.orthogonality_error(2.0 * cell.x_max);
            assert!(error < 1e-10, "{error:e}");
        }
    }

    #[test]
    fn a_dropped_port_never_shortens_the_time_step() {
        let mut rng = fastrand::Rng::with_seed(10);
        let points: [DVec3; 4] = std::array::from_fn(|_| DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 1e-3);
        let all = Cell::new(points, 2.0, 1.0, [true; 6]);
        let some = Cell::new(points, 2.0, 1.0, [false, true, true, false, true, true]);
        let none = Cell::new(points, 2.0, 1.0, [false; 6]);
        assert!(some.x_max >= all.x_max * 0.999, "{} against {}", some.x_max, all.x_max);
        assert!(none.x_max.is_infinite(), "nothing happens in a conductor's corner");
    }
}
