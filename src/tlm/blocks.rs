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
//! `G V = loss (J + K^T h)` costs one number per cell.

#![allow(
    clippy::needless_range_loop,
    reason = "loops over lanes of several arrays at once, which must become vector instructions"
)]

use super::modes::{BlockForms, FacePorts};
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

/// Where the parts of [`Block::coefficients`] begin: D (21), A^-1 (6), Y (6), loss (1).
pub(super) const A_INVERSE: usize = 21;
pub(super) const ADMITTANCE: usize = 27;
pub(super) const LOSS: usize = 33;

/// What does not change while the field runs.
#[derive(Clone, Debug)]
pub(super) struct Block<T> {
    pub(super) coefficients: [Lane<T>; 34],
    /// Edge of each port; one past the last edge for dropped ports.
    pub(super) edges: [[u32; LANES]; 6],
}

/// G of a block's cells with boundary faces, by rows of the lower triangle.
#[derive(Clone, Debug)]
pub(super) struct Boundary<T> {
    pub(super) conductance: [Lane<T>; 21],
}

/// Where z begins in a [`State`]: T (6), z (3).
pub(super) const FLUX: usize = 6;

/// The field of a block's cells, but for the reflected currents.
pub(super) type State<T> = [Lane<T>; 9];

/// A number for each port of a block's cells. The reflected currents p are such, apart from the rest of the field, since
/// connecting reads nothing else.
pub(super) type Ports<T> = [Lane<T>; 6];

/// What the outside does to neighboring blocks with boundary faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outside<'a, T> {
    pub(super) boundary: &'a [Boundary<T>],
    /// Forms of the modes, and the currents that flow out through them.
    pub(super) modes: Option<(&'a [BlockForms<T>], &'a [T])>,
}

impl<T: Real> Outside<'_, T> {
    /// The currents into the ports of a block.
    #[inline(always)]
    fn source<const FUSED: bool>(&self, block: usize) -> Ports<T> {
        let mut source = [[T::default(); LANES]; 6];
        let Some((forms, currents)) = self.modes else { return source };
        let BlockForms { ports, values } = &forms[block];
        match ports {
            FacePorts::Three(ports) => {
                let of_face = drawn::<T, 3, FUSED>(values, currents);
                (0..3).for_each(|k| source[ports[k]] = of_face[k]);
            }
            FacePorts::Six => source = drawn::<T, 6, FUSED>(values, currents),
        }
        source
    }
}

/// What modes draw from the ports of a block.
///
/// * `values`: of the forms, N for each mode.
#[inline(always)]
fn drawn<T: Real, const N: usize, const FUSED: bool>(values: &[Lane<T>], currents: &[T]) -> [Lane<T>; N] {
    let mut sum = [[T::default(); LANES]; N];
    for (form, current) in values.as_chunks::<N>().0.iter().zip(currents) {
        for e in 0..N {
            for w in 0..LANES {
                sum[e][w] = multiply_add::<T, FUSED>(-form[e][w], *current, sum[e][w]);
            }
        }
    }
    sum
}

/// Adds to each sum what a mode sees of voltages.
#[inline(always)]
fn add_seen<T: Real, const N: usize, const FUSED: bool>(values: &[Lane<T>], v: &[Lane<T>; N], sums: &mut [f64]) {
    for (form, sum) in values.as_chunks::<N>().0.iter().zip(sums) {
        let mut seen = [T::default(); LANES];
        for e in 0..N {
            for w in 0..LANES {
                seen[w] = multiply_add::<T, FUSED>(form[e][w], v[e][w], seen[w]);
            }
        }
        *sum += seen.iter().map(|x| x.to_f64()).sum::<f64>();
    }
}

/// One step of some neighboring blocks.
pub(super) struct Scatter<'a, T> {
    pub(super) blocks: &'a [Block<T>],
    pub(super) states: &'a mut [State<T>],
    pub(super) reflected: &'a mut [Ports<T>],
    /// Edge voltages, one more than there are edges: the last is zero.
    pub(super) voltages: &'a [T],
    /// For blocks with boundary faces.
    pub(super) outside: Option<Outside<'a, T>>,
}

impl<T: Real> WithSimd for Scatter<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        if fuses::<S>() {
            self.run::<true>();
        } else {
            self.run::<false>();
        }
    }
}

impl<T: Real> Scatter<'_, T> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let fields = self.states.iter_mut().zip(self.reflected);
        for (b, (block, (state, reflected))) in self.blocks.iter().zip(fields).enumerate() {
            let source = self.outside.map(|outside| outside.source::<FUSED>(b));
            let solved = solve::<T, FUSED>(block, state, reflected, self.voltages, source.as_ref());
            update::<T, FUSED>(block, state, reflected, &solved);
            if let (Some(outside), Some(source)) = (self.outside, source) {
                add_boundary(&outside.boundary[b].conductance, state, &solved.v, &source);
            }
        }
    }
}

/// What modes of the boundary see before their own currents flow.
pub(super) struct Observe<'a, T> {
    pub(super) blocks: &'a [Block<T>],
    pub(super) states: &'a [State<T>],
    pub(super) reflected: &'a [Ports<T>],
    pub(super) voltages: &'a [T],
    pub(super) forms: &'a [BlockForms<T>],
    pub(super) n_modes: usize,
}

impl<T: Real> WithSimd for Observe<'_, T> {
    /// By mode.
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> Vec<f64> {
        if fuses::<S>() { self.run::<true>() } else { self.run::<false>() }
    }
}

impl<T: Real> Observe<'_, T> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<f64> {
        let mut sums = vec![0.0; self.n_modes];
        let fields = self.states.iter().zip(self.reflected);
        for ((block, (state, reflected)), forms) in self.blocks.iter().zip(fields).zip(self.forms) {
            let v = solve::<T, FUSED>(block, state, reflected, self.voltages, None).v;
            match forms.ports {
                FacePorts::Three(ports) => {
                    add_seen::<T, 3, FUSED>(&forms.values, &ports.map(|e| v[e]), &mut sums);
                }
                FacePorts::Six => add_seen::<T, 6, FUSED>(&forms.values, &v, &mut sums),
            }
        }
        sums
    }
}

/// Whether numbers are multiplied and added in one: vector units do; without one that would be a call for every number.
#[inline(always)]
fn fuses<S: Simd>() -> bool {
    size_of::<S::f32s>() > size_of::<f32>()
}

/// `a b + c`
#[inline(always)]
fn multiply_add<T: Real, const FUSED: bool>(a: T, b: T, c: T) -> T {
    if FUSED { a.fused(b, c) } else { a * b + c }
}

/// `out += D in`
#[inline(always)]
fn add_product<T: Real, const FUSED: bool>(d: &[Lane<T>; 34], input: &Ports<T>, out: &mut Ports<T>) {
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
fn circulation<T: Real>(v: &Ports<T>) -> [Lane<T>; 3] {
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
fn transposed_circulation<T: Real>(h: &[Lane<T>; 3]) -> Ports<T> {
    let mut q = [[T::default(); LANES]; 6];
    for w in 0..LANES {
        let (h0, h1, h2) = (h[0][w], h[1][w], h[2][w]);
        (q[0][w], q[1][w], q[2][w]) = (h0 - h1, h2 - h0, h1 - h2);
        (q[3][w], q[4][w], q[5][w]) = (h0, -h1, h2);
    }
    q
}

/// The fields of a block's cells in the middle of a step.
struct Solved<T> {
    /// `i + p`, and T after it.
    current: Ports<T>,
    flux: Ports<T>,
    /// J, V, and `K^T h`.
    drive: Ports<T>,
    v: Ports<T>,
    q: Ports<T>,
}

#[inline(always)]
fn solve<T: Real, const FUSED: bool>(
    block: &Block<T>,
    state: &State<T>,
    reflected: &Ports<T>,
    voltages: &[T],
    source: Option<&Ports<T>>,
) -> Solved<T> {
    let c = &block.coefficients;
    let zero = T::default();
    let two = T::new(2.0);
    let (mut current, mut flux, mut drive) = ([[zero; LANES]; 6], [[zero; LANES]; 6], [[zero; LANES]; 6]);
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
            flux[e][w] = state[e][w] + (current[e][w] - p);
            drive[e][w] = two * flux[e][w];
        }
    }
    if let Some(source) = source {
        for e in 0..6 {
            for w in 0..LANES {
                drive[e][w] += source[e][w];
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
    Solved { current, flux, drive, v, q }
}

/// Takes over the fields, but for what the boundary adds.
#[inline(always)]
fn update<T: Real, const FUSED: bool>(
    block: &Block<T>,
    state: &mut State<T>,
    reflected: &mut Ports<T>,
    solved: &Solved<T>,
) {
    let c = &block.coefficients;
    let Solved { current, flux, drive, v, q } = solved;
    for e in 0..6 {
        let (y, loss) = (&c[ADMITTANCE + e], &c[LOSS]);
        for w in 0..LANES {
            reflected[e][w] = multiply_add::<T, FUSED>(y[w], v[e][w], -current[e][w]);
            // Dropped ports have no admittance, and nothing must gather there.
            let flux = flux[e][w] + q[e][w] - loss[w] * (drive[e][w] + q[e][w]);
            state[e][w] = if y[w] > T::default() { flux } else { T::default() };
        }
    }
    let k = circulation(v);
    for i in 0..3 {
        for w in 0..LANES {
            state[FLUX + i][w] -= k[i][w];
        }
    }
}

/// Adds `J_src - G V` to T.
#[inline(always)]
fn add_boundary<T: Real>(conductance: &[Lane<T>; 21], state: &mut State<T>, v: &Ports<T>, source: &Ports<T>) {
    for a in 0..6 {
        let mut sum = [T::default(); LANES];
        for b in 0..6 {
            for w in 0..LANES {
                sum[w] += conductance[triangle(a, b)][w] * v[b][w];
            }
        }
        for w in 0..LANES {
            state[a][w] += source[a][w] - sum[w];
        }
    }
}
