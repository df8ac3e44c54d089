//! The update of sixteen cells at a time, in flux form.
//!
//! State per cell: T (6), the reflected port currents p (6), z (3). With the edge voltages `V_e` of the last connection:
//!
//! ```text
//! i = Y V_e - 2 p    p' = p + i    T += i    J = 2 T + J_src    W = D J    h = A^-1 (2 z - K W)    V = W + D K^T h
//! p = Y V - p'       T += K^T h + J_src - G V                    z -= K V
//! ```
//!
//! G holds boundary faces and lossy material. Away from the boundary it is a share of `C/x + G = D^-1`, so that
//! `G V = loss (J + K^T h)` costs one number per cell.

#![allow(
    clippy::needless_range_loop,
    reason = "loops over lanes of several arrays at once, which must become vector instructions"
)]

use pulp::{Simd, WithSimd};

/// Cells in a block.
pub(super) const LANES: usize = 16;
/// One number for each cell of a block.
pub(super) type Lane = [f32; LANES];

/// Place of element (a, b), a >= b, of a symmetric matrix stored by rows.
pub(super) const fn triangle(a: usize, b: usize) -> usize {
    if a >= b { a * (a + 1) / 2 + b } else { b * (b + 1) / 2 + a }
}

/// Where the parts of [`Block::coefficients`] begin: D (21), A^-1 (6), Y (6), loss (1).
pub(super) const A_INVERSE: usize = 21;
pub(super) const ADMITTANCE: usize = 27;
pub(super) const LOSS: usize = 33;

/// What does not change while the field runs.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) coefficients: [Lane; 34],
    /// Edge of each port; one past the last edge for dropped ports.
    pub(super) edges: [[u32; LANES]; 6],
}

/// Where the parts of [`Boundary::terms`] begin: G (21), source (6), observation (6).
pub(super) const SOURCE: usize = 21;
pub(super) const OBSERVATION: usize = 27;

/// Boundary faces of a block's cells.
#[derive(Clone, Debug)]
pub(super) struct Boundary {
    pub(super) terms: [Lane; 33],
}

/// Where z begins in a [`State`]: T (6), z (3).
const FLUX: usize = 6;

/// The field of a block's cells, but for the reflected currents.
pub(super) type State = [Lane; 9];

/// Reflected port currents p of a block's cells: apart from the rest, since connecting reads nothing else.
pub(super) type Reflected = [Lane; 6];

/// One step of some neighboring blocks.
pub(super) struct Scatter<'a> {
    pub(super) blocks: &'a [Block],
    pub(super) states: &'a mut [State],
    pub(super) reflected: &'a mut [Reflected],
    /// Edge voltages, one more than there are edges: the last is zero.
    pub(super) voltages: &'a [f32],
    /// For blocks with boundary faces: their terms, and the driving signal.
    pub(super) boundary: Option<(&'a [Boundary], f32)>,
}

impl WithSimd for Scatter<'_> {
    /// What the port's observation sees of these blocks.
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> f64 {
        let mut observed = 0.0;
        let fields = self.states.iter_mut().zip(self.reflected);
        for (b, (block, (state, reflected))) in self.blocks.iter().zip(fields).enumerate() {
            let boundary = self.boundary.map(|(terms, signal)| (&terms[b], signal));
            observed += scatter(block, state, reflected, self.voltages, boundary);
        }
        observed
    }
}

/// `out += D in`
#[inline(always)]
fn add_product(d: &[Lane; 34], input: &[Lane; 6], out: &mut [Lane; 6]) {
    for a in 0..6 {
        for b in 0..6 {
            let (element, input) = (&d[triangle(a, b)], &input[b]);
            for w in 0..LANES {
                out[a][w] += element[w] * input[w];
            }
        }
    }
}

/// `K v`
#[inline(always)]
fn circulation(v: &[Lane; 6]) -> [Lane; 3] {
    let mut k = [[0.0; LANES]; 3];
    for w in 0..LANES {
        k[0][w] = v[0][w] + v[3][w] - v[1][w];
        k[1][w] = v[2][w] - v[0][w] - v[4][w];
        k[2][w] = v[1][w] - v[2][w] + v[5][w];
    }
    k
}

/// `K^T h`
#[inline(always)]
fn transposed_circulation(h: &[Lane; 3]) -> [Lane; 6] {
    let mut q = [[0.0; LANES]; 6];
    for w in 0..LANES {
        let (h0, h1, h2) = (h[0][w], h[1][w], h[2][w]);
        (q[0][w], q[1][w], q[2][w]) = (h0 - h1, h2 - h0, h1 - h2);
        (q[3][w], q[4][w], q[5][w]) = (h0, -h1, h2);
    }
    q
}

#[inline(always)]
fn scatter(
    block: &Block,
    state: &mut State,
    reflected: &mut Reflected,
    voltages: &[f32],
    boundary: Option<(&Boundary, f32)>,
) -> f64 {
    let c = &block.coefficients;
    let mut current = [[0.0; LANES]; 6];
    let mut drive = [[0.0; LANES]; 6];
    for e in 0..6 {
        let y = &c[ADMITTANCE + e];
        // Gathered by itself, so that the rest runs on whole lanes.
        let mut across = [0.0; LANES];
        for w in 0..LANES {
            across[w] = voltages[block.edges[e][w] as usize];
        }
        for w in 0..LANES {
            let incident = y[w] * across[w] - 2.0 * reflected[e][w];
            current[e][w] = reflected[e][w] + incident;
            state[e][w] += incident;
            drive[e][w] = 2.0 * state[e][w];
        }
    }
    if let Some((boundary, signal)) = boundary {
        for e in 0..6 {
            for w in 0..LANES {
                drive[e][w] += boundary.terms[SOURCE + e][w] * signal;
            }
        }
    }
    let mut v = [[0.0; LANES]; 6];
    add_product(c, &drive, &mut v);
    let k = circulation(&v);
    let mut h = [[0.0; LANES]; 3];
    for i in 0..3 {
        for j in 0..3 {
            let element = &c[A_INVERSE + triangle(i, j)];
            for w in 0..LANES {
                h[i][w] += element[w] * (2.0 * state[FLUX + j][w] - k[j][w]);
            }
        }
    }
    let q = transposed_circulation(&h);
    add_product(c, &q, &mut v);
    for e in 0..6 {
        let (y, loss) = (&c[ADMITTANCE + e], &c[LOSS]);
        for w in 0..LANES {
            reflected[e][w] = y[w] * v[e][w] - current[e][w];
            // Dropped ports have no admittance, and nothing must gather there.
            let kept = if y[w] > 0.0 { 1.0 } else { 0.0 };
            state[e][w] = kept * (state[e][w] + q[e][w] - loss[w] * (drive[e][w] + q[e][w]));
        }
    }
    let k = circulation(&v);
    for i in 0..3 {
        for w in 0..LANES {
            state[FLUX + i][w] -= k[i][w];
        }
    }
    boundary.map_or(0.0, |(boundary, signal)| add_boundary(&boundary.terms, state, &v, signal))
}

/// Adds `J_src - G V` to T; returns the observation of V.
#[inline(always)]
fn add_boundary(terms: &[Lane; 33], state: &mut State, v: &[Lane; 6], signal: f32) -> f64 {
    let mut seen = [0.0_f32; LANES];
    for a in 0..6 {
        let mut sum = [0.0; LANES];
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
    seen.iter().map(|&x| f64::from(x)).sum()
}
