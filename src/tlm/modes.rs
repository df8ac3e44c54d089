//! Fields at a boundary that meet circuits of their own, instead of a conductance at every face there.
//!
//! Such a field, a mode, has the edge voltages e; with the mass matrix G of the boundary's faces its form is `g = G e`. A
//! circuit sees the voltage `g^T V` of its mode, and a current i that it draws flows out of the ports as `g i`.
//!
//! All circuits see the voltages of one time level, so the currents of all depend on each other. With M the cells'
//! response `V = M J` and `S = g^T M g`, currents i change the voltages of the modes by `-S i`: one small system. A step
//! first finds the voltages without these currents, then scatters with them.

use super::blocks::{A_INVERSE, Block, LANES, Lane, triangle};
use super::cell::circulations;
use super::real::Real;
use super::slots::Slots;
use nalgebra::{DMatrix, Matrix3, Matrix6, Vector6};
use rayon::prelude::*;
use std::ops::Range;

/// The forms of all modes in one block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BlockForms<T> {
    /// Ports at which any form is other than zero: the three of a face, or all.
    pub(super) ports: FacePorts,
    /// For each mode one number for each of these ports.
    pub(super) values: Vec<Lane<T>>,
}

/// Ports of a block that lie on boundary faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FacePorts {
    /// Those of the same face in all cells.
    Three([usize; 3]),
    /// Those of different faces, or of several.
    Six,
}

impl<T: Real> BlockForms<T> {
    /// * `of_cells`: `[6, n_modes]` by lane; lanes without a cell have none.
    fn new(of_cells: &[Option<DMatrix<f64>>], n_modes: usize) -> Self {
        let is_used = |e: usize| of_cells.iter().flatten().any(|forms| forms.row(e).iter().any(|x| *x != 0.0));
        let used: Vec<usize> = (0..6).filter(|&e| is_used(e)).collect();
        let (ports, list) = match <[usize; 3]>::try_from(used) {
            Ok(three) => (FacePorts::Three(three), three.to_vec()),
            Err(_) => (FacePorts::Six, (0..6).collect()),
        };
        let lane = |m: usize, e: usize| -> Lane<T> {
            std::array::from_fn(|w| {
                of_cells.get(w).and_then(Option::as_ref).map_or(T::default(), |f| T::new(f[(e, m)]))
            })
        };
        let values = (0..n_modes).flat_map(|m| list.iter().map(move |&e| (m, e))).map(|(m, e)| lane(m, e)).collect();
        Self { ports, values }
    }

    /// A lane's form of a mode.
    fn form(&self, mode: usize, w: usize) -> Vector6<f64> {
        let mut form = Vector6::zeros();
        match self.ports {
            FacePorts::Three(ports) => (0..3).for_each(|k| form[ports[k]] = self.values[3 * mode + k][w].to_f64()),
            FacePorts::Six => (0..6).for_each(|e| form[e] = self.values[6 * mode + e][w].to_f64()),
        }
        form
    }
}

/// The modes of a boundary: fixed once built.
#[derive(Clone, Debug)]
pub(super) struct Modes<T> {
    /// The blocks at the boundary.
    pub(super) blocks: Range<usize>,
    /// By block.
    pub(super) forms: Vec<BlockForms<T>>,
    pub(super) n_modes: usize,
    /// `S = g^T M g`
    pub(super) coupling: DMatrix<f64>,
}

impl<T: Real> Modes<T> {
    /// * `all`: all blocks; `blocks`: those at the boundary.
    /// * `of_cell`: the forms at a cell's ports, `[6, n_modes]`.
    pub(super) fn new(
        all: &[Block<T>],
        slots: &Slots,
        blocks: Range<usize>,
        n_modes: usize,
        of_cell: impl Fn(usize) -> DMatrix<f64> + Sync,
    ) -> Self {
        let lanes = &slots.cells[blocks.start * LANES..blocks.end * LANES];
        let of_block = |cells: &[Option<usize>]| {
            BlockForms::new(&cells.iter().map(|k| k.map(&of_cell)).collect::<Vec<_>>(), n_modes)
        };
        let forms: Vec<BlockForms<T>> = lanes.par_chunks(LANES).map(of_block).collect();
        let mut coupling = DMatrix::<f64>::zeros(n_modes, n_modes);
        for (block, forms) in all[blocks.clone()].iter().zip(&forms) {
            for w in 0..LANES {
                let columns: Vec<Vector6<f64>> = (0..n_modes).map(|m| forms.form(m, w)).collect();
                let response = response(block, w);
                for (j, column) in columns.iter().enumerate() {
                    let seen = response * column;
                    columns.iter().enumerate().for_each(|(i, row)| coupling[(i, j)] += row.dot(&seen));
                }
            }
        }
        Self { blocks, forms, n_modes, coupling }
    }

    /// Forms for some neighboring blocks; `None` if they are not at the boundary.
    pub(super) fn at(&self, blocks: &Range<usize>) -> Option<&[BlockForms<T>]> {
        let first = blocks.start.checked_sub(self.blocks.start)?;
        self.forms.get(first..first + blocks.len())
    }

    /// Memory of the forms, bytes.
    pub(super) fn size(&self) -> usize {
        self.forms.iter().map(|forms| size_of_val(&forms.values[..])).sum()
    }
}

/// `M = D - D K^T A^-1 K D` of a lane: the voltages of its ports for currents into them.
fn response<T: Real>(block: &Block<T>, w: usize) -> Matrix6<f64> {
    let at = |place: usize| block.coefficients[place][w].to_f64();
    let d = Matrix6::from_fn(|i, j| at(triangle(i, j)));
    let a_inverse = Matrix3::from_fn(|i, j| at(A_INVERSE + triangle(i, j)));
    let kd = circulations() * d;
    d - kd.transpose() * a_inverse * kd
}
