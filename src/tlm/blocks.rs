//! The update of a few cells at a time, in flux form.
//!
//! State per cell: T (6), the reflected port currents p (6), z (3). With the edge voltages `V_e` of the last connection:
//!
//! ```text
//! i = Y V_e - 2 p    p' = p + i    T += i    J = 2 T + J_src    W = D J    h = A^-1 (2 z - K W)    V = W + D K^T h
//! p = Y V - p'       T += K^T h + J_src - G V                    z -= K V
//! ```
//!
//! G holds boundary faces and lossy material. Away from the boundary it is a share of `C/x + G = D^-1`, so that
//! `G V = loss (J + K^T h)` costs one number per cell; likewise magnetic loss, a share of A, takes another share of
//! `A h = 2 z - K W` from z.

#![allow(
    clippy::needless_range_loop,
    reason = "loops over lanes of several arrays at once, which must become vector instructions"
)]

use super::real::Real;
use pulp::{Simd, WithSimd};

/// Cells in a block: one vector register of single precision, so that the six ports of all of them fit in registers.
pub(super) const LANES: usize = 8;
/// One number for each cell of a block.
pub(super) type Lane<T> = [T; LANES];

/// Place of element (a, b), a >= b, of a symmetric matrix stored by rows.
pub(super) const fn triangle(a: usize, b: usize) -> usize {
    if a >= b { a * (a + 1) / 2 + b } else { b * (b + 1) / 2 + a }
}

/// Where the parts of [`Block::coefficients`] begin: D (21), A^-1 (6), Y (6), losses (2).
pub(super) const A_INVERSE: usize = 21;
pub(super) const ADMITTANCE: usize = 27;
pub(super) const LOSS: usize = 33;
pub(super) const MAGNETIC_LOSS: usize = 34;

/// What does not change while the field runs.
#[derive(Clone, Debug)]
pub(super) struct Block<T> {
    pub(super) coefficients: [Lane<T>; 35],
    /// Edge of each port; one past the last edge for dropped ports.
    pub(super) edges: [[u32; LANES]; 6],
}

/// Where the parts of [`Boundary::terms`] begin: G (21), source (6), observation (6).
pub(super) const SOURCE: usize = 21;
pub(super) const OBSERVATION: usize = 27;

/// Boundary faces of a block's cells.
#[derive(Clone, Debug)]
pub(super) struct Boundary<T> {
    pub(super) terms: [Lane<T>; 33],
}

/// Where z begins in a [`State`]: T (6), z (3).
pub(super) const FLUX: usize = 6;

/// The field of a block's cells, but for the reflected currents.
pub(super) type State<T> = [Lane<T>; 9];

/// Reflected port currents p of a block's cells: apart from the rest, since connecting reads nothing else.
pub(super) type Reflected<T> = [Lane<T>; 6];

/// One step of some neighboring blocks.
pub(super) struct Scatter<'a, T> {
    pub(super) blocks: &'a [Block<T>],
    pub(super) states: &'a mut [State<T>],
    pub(super) reflected: &'a mut [Reflected<T>],
    /// Edge voltages, one more than there are edges: the last is zero.
    pub(super) voltages: &'a [T],
    /// For blocks with boundary faces: their terms, and the driving signal.
    pub(super) boundary: Option<(&'a [Boundary<T>], T)>,
}

impl<T: Real> WithSimd for Scatter<'_, T> {
    /// What the port's observation sees of these blocks.
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> f64 {
        // Vector units multiply and add in one; without one that would be a call for every number.
        if size_of::<S::f32s>() > size_of::<f32>() { self.run::<true>() } else { self.run::<false>() }
    }
}

impl<T: Real> Scatter<'_, T> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let mut observed = 0.0;
        let fields = self.states.iter_mut().zip(self.reflected);
        for (b, (block, (state, reflected))) in self.blocks.iter().zip(fields).enumerate() {
            let boundary = self.boundary.map(|(terms, signal)| (&terms[b], signal));
            observed += scatter::<T, FUSED>(block, state, reflected, self.voltages, boundary);
        }
        observed
    }
}

/// `a b + c`
#[inline(always)]
fn multiply_add<T: Real, const FUSED: bool>(a: T, b: T, c: T) -> T {
    if FUSED { a.fused(b, c) } else { a * b + c }
}

/// `out += D in`
#[inline(always)]
fn add_product<T: Real, const FUSED: bool>(d: &[Lane<T>; 35], input: &[Lane<T>; 6], out: &mut [Lane<T>; 6]) {
    for a in 0..6 {
        for b in 0..6 {
            let (element, input) = (&d[triangle(a, b)], &input[b]);
            for w in 0..LANES {
                out[a][w] = multiply_add::<T, FUSED>(element[w], input[w], out[a][w]);
            }
        }
    }
}

/// `K v`
#[inline(always)]
fn circulation<T: Real>(v: &[Lane<T>; 6]) -> [Lane<T>; 3] {
    let mut k = [[T::default(); LANES]; 3];
    for w in 0..LANES {
        k[0][w] = v[0][w] + v[3][w] - v[1][w];
        k[1][w] = v[2][w] - v[0][w] - v[4][w];
        k[2][w] = v[1][w] - v[2][w] + v[5][w];
    }
    k
}

/// `K^T h`
#[inline(always)]
fn transposed_circulation<T: Real>(h: &[Lane<T>; 3]) -> [Lane<T>; 6] {
    let mut q = [[T::default(); LANES]; 6];
    for w in 0..LANES {
        let (h0, h1, h2) = (h[0][w], h[1][w], h[2][w]);
        (q[0][w], q[1][w], q[2][w]) = (h0 - h1, h2 - h0, h1 - h2);
        (q[3][w], q[4][w], q[5][w]) = (h0, -h1, h2);
    }
    q
}

#[inline(always)]
fn scatter<T: Real, const FUSED: bool>(
    block: &Block<T>,
    state: &mut State<T>,
    reflected: &mut Reflected<T>,
    voltages: &[T],
    boundary: Option<(&Boundary<T>, T)>,
) -> f64 {
    let c = &block.coefficients;
    let zero = T::default();
    let two = T::new(2.0);
    let mut current = [[zero; LANES]; 6];
    let mut drive = [[zero; LANES]; 6];
    for e in 0..6 {
        let y = &c[ADMITTANCE + e];
        // Gathered by itself, so that the rest runs on whole lanes.
        let mut across = [zero; LANES];
        for w in 0..LANES {
            across[w] = voltages[block.edges[e][w] as usize];
        }
        for w in 0..LANES {
            let p = reflected[e][w];
            current[e][w] = y[w] * across[w] - p;
            state[e][w] += current[e][w] - p;
            drive[e][w] = two * state[e][w];
        }
    }
    if let Some((boundary, signal)) = boundary {
        for e in 0..6 {
            for w in 0..LANES {
                drive[e][w] += boundary.terms[SOURCE + e][w] * signal;
            }
        }
    }
    let mut v = [[zero; LANES]; 6];
    add_product::<T, FUSED>(c, &drive, &mut v);
    let mut across = circulation(&v);
    for i in 0..3 {
        for w in 0..LANES {
            across[i][w] = two * state[FLUX + i][w] - across[i][w];
        }
    }
    let mut h = [[zero; LANES]; 3];
    for i in 0..3 {
        for j in 0..3 {
            let element = &c[A_INVERSE + triangle(i, j)];
            for w in 0..LANES {
                h[i][w] = multiply_add::<T, FUSED>(element[w], across[j][w], h[i][w]);
            }
        }
    }
    let q = transposed_circulation(&h);
    add_product::<T, FUSED>(c, &q, &mut v);
    for e in 0..6 {
        let (y, loss) = (&c[ADMITTANCE + e], &c[LOSS]);
        for w in 0..LANES {
            reflected[e][w] = multiply_add::<T, FUSED>(y[w], v[e][w], -current[e][w]);
            // Dropped ports have no admittance, and nothing must gather there.
            let flux = state[e][w] + q[e][w] - loss[w] * (drive[e][w] + q[e][w]);
            state[e][w] = if y[w] > zero { flux } else { zero };
        }
    }
    let k = circulation(&v);
    for i in 0..3 {
        for w in 0..LANES {
            state[FLUX + i][w] -= k[i][w] + c[MAGNETIC_LOSS][w] * across[i][w];
        }
    }
    boundary.map_or(0.0, |(boundary, signal)| add_boundary(&boundary.terms, state, &v, signal))
}

/// Adds `J_src - G V` to T; returns the observation of V.
#[inline(always)]
fn add_boundary<T: Real>(terms: &[Lane<T>; 33], state: &mut State<T>, v: &[Lane<T>; 6], signal: T) -> f64 {
    let mut seen = [T::default(); LANES];
    for a in 0..6 {
        let mut sum = [T::default(); LANES];
        for b in 0..6 {
            for w in 0..LANES {
                sum[w] += terms[triangle(a, b)][w] * v[b][w];
            }
        }
        for w in 0..LANES {
            state[a][w] += terms[SOURCE + a][w] * signal - sum[w];
            seen[w] += terms[OBSERVATION + a][w] * v[a][w];
        }
    }
    seen.iter().map(|x| x.to_f64()).sum()
}
