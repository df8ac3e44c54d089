//! A matrix of weights, one row per point and one column per vertex or face, laid out for products with a pose.
//!
//! Points are cut into blocks; within a block the matrix is stored by columns. A product then streams through memory
//! once whether it needs all columns or, after a small change of the pose, a few; and threads share nothing.

use crate::geometry::DVec3;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSlice, ParallelSliceMut};
use std::ops::{Add, Mul};

/// Points to a block: three sums of one block fit the first cache, and one column of it is a page, so that skipping
/// columns skips pages. A multiple of eight but not of 512, whose columns would compete for the same cache lines.
pub(super) const BLOCK: usize = 520;

/// `f32` or `f64`.
pub(super) trait Number: Copy + Default + Send + Sync + Add<Output = Self> + Mul<Output = Self> {}
impl Number for f32 {}
impl Number for f64 {}

/// The matrix.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Columns<T> {
    n_points: usize,
    n_columns: usize,
    values: Vec<T>,
}

impl<T: Number> Columns<T> {
    pub(super) fn zero(n_points: usize, n_columns: usize) -> Self {
        Self { n_points, n_columns, values: vec![T::default(); n_points * n_columns] }
    }

    pub(super) fn n_points(&self) -> usize {
        self.n_points
    }

    pub(super) fn n_columns(&self) -> usize {
        self.n_columns
    }

    pub(super) fn map<U: Number>(&self, convert: impl Fn(T) -> U) -> Columns<U> {
        let values = self.values.iter().map(|&v| convert(v)).collect();
        Columns { n_points: self.n_points, n_columns: self.n_columns, values }
    }

    pub(super) fn get(&self, point: usize, column: usize) -> T {
        assert!(point < self.n_points && column < self.n_columns, "no weight ({point}, {column})");
        let start = point / BLOCK * BLOCK;
        let length = BLOCK.min(self.n_points - start);
        self.values[start * self.n_columns + column * length + (point - start)]
    }

    /// The blocks in the order of the points; each holds its columns one after another.
    pub(super) fn blocks_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [T]> {
        self.values.par_chunks_mut(BLOCK * self.n_columns.max(1))
    }

    /// Adds `Σ column · factor` to the positions, in the order of the terms.
    pub(super) fn add<P>(&self, terms: &[(usize, [T; 3])], positions: &mut [P])
    where
        P: Copy + Send + From<[T; 3]> + Into<[T; 3]>,
    {
        assert_eq!(positions.len(), self.n_points, "one position for each point");
        let arch = Arch::new();
        let blocks = self.values.par_chunks(BLOCK * self.n_columns.max(1));
        positions.par_chunks_mut(BLOCK).zip(blocks).for_each(|(positions, block)| {
            let mut sums = [[T::default(); BLOCK]; 3];
            for (i, &position) in positions.iter().enumerate() {
                for (sum, coordinate) in sums.iter_mut().zip(position.into()) {
                    sum[i] = coordinate;
                }
            }
            arch.dispatch(Accumulate { block, length: positions.len(), terms, sums: &mut sums });
            for (i, position) in positions.iter_mut().enumerate() {
                *position = P::from([0, 1, 2].map(|axis| sums[axis][i]));
            }
        });
    }
}

/// The terms of a pose's change: the columns whose factor differs, with the difference.
pub(super) fn changes(from: &[DVec3], to: &[DVec3]) -> Vec<(usize, DVec3)> {
    assert_eq!(from.len(), to.len(), "poses of the same cage");
    let differences = from.iter().zip(to).map(|(from, to)| *to - *from).enumerate();
    differences.filter(|(_, change)| change.cmpne(DVec3::ZERO).any()).collect()
}

struct Accumulate<'a, T> {
    block: &'a [T],
    length: usize,
    terms: &'a [(usize, [T; 3])],
    sums: &'a mut [[T; BLOCK]; 3],
}

impl<T: Number> WithSimd for Accumulate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let n = self.length;
        let column = |c: usize| &self.block[c * n..(c + 1) * n];
        // Four columns at a time: the sums are loaded and stored a quarter as often, and added to in the same order.
        let mut quads = self.terms.chunks_exact(4);
        for quad in quads.by_ref() {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| column(quad[k].0));
            for (axis, sum) in self.sums.iter_mut().enumerate() {
                let [fa, fb, fc, fd] = [0, 1, 2, 3].map(|k| quad[k].1[axis]);
                for ((((sum, &a), &b), &c), &d) in sum.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                    *sum = *sum + a * fa + b * fb + c * fc + d * fd;
                }
            }
        }
        for &(c, factor) in quads.remainder() {
            for (sum, f) in self.sums.iter_mut().zip(factor) {
                for (sum, &weight) in sum.iter_mut().zip(column(c)) {
                    *sum = *sum + weight * f;
                }
            }
        }
    }
}
