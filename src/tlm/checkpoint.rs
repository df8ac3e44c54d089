//! A run's state as plain values: what it takes to go on later with the same bits.

use super::blocks::{LANES, Lane};
use super::run::{Record, Run};
use super::{Network, Pulse, TlmError};
use sha2::{Digest, Sha256};

/// All that a run has come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// SHA-256 of the network's coefficients and the pulse: the checkpoint continues no other run.
    pub fingerprint: [u8; 32],
    /// Time spent in steps, s.
    pub seconds: f64,
    /// What the port saw.
    pub record: Record,
    /// State of all cells, their reflected currents, and the voltages of all edges, in the network's order.
    pub field: Vec<f32>,
}

impl Network {
    /// SHA-256 of all that rules a run: coefficients, connections, boundary, time step and pulse.
    fn fingerprint(&self, pulse: &Pulse) -> [u8; 32] {
        let mut hash = Sha256::new();
        for value in [self.dt, pulse.center, pulse.half_width] {
            hash.update(value.to_le_bytes());
        }
        let mut lane = |lane: &Lane| hash.update(lane.map(f32::to_le_bytes).as_flattened());
        self.blocks.iter().flat_map(|b| &b.coefficients).for_each(&mut lane);
        self.boundary.iter().flat_map(|b| &b.terms).for_each(&mut lane);
        for edges in self.blocks.iter().flat_map(|b| &b.edges) {
            hash.update(edges.map(u32::to_le_bytes).as_flattened());
        }
        hash.finalize().into()
    }
}

impl<'a> Run<'a> {
    /// The state of this run.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        let cells = self.states.as_flattened().as_flattened().iter();
        let reflected = self.reflected.as_flattened().as_flattened().iter();
        Checkpoint {
            fingerprint: self.network.fingerprint(&self.pulse),
            seconds: self.seconds,
            record: self.record.clone(),
            field: cells.chain(reflected).chain(&self.voltages).copied().collect(),
        }
    }

    /// Goes on where a checkpoint was taken.
    ///
    /// # Errors
    /// [`TlmError::ForeignCheckpoint`] if it was taken of another mesh, band or material.
    pub fn resume(network: &'a Network, pulse: Pulse, checkpoint: &Checkpoint) -> Result<Self, TlmError> {
        let mut run = Self::new(network, pulse);
        let n_cells = run.states.len() * 9 * LANES;
        let n_reflected = run.reflected.len() * 6 * LANES;
        let n_field = n_cells + n_reflected + run.voltages.len();
        if checkpoint.fingerprint != network.fingerprint(&pulse) || checkpoint.field.len() != n_field {
            return Err(TlmError::ForeignCheckpoint);
        }
        let (cells, rest) = checkpoint.field.split_at(n_cells);
        let (reflected, voltages) = rest.split_at(n_reflected);
        run.states.as_flattened_mut().as_flattened_mut().copy_from_slice(cells);
        run.reflected.as_flattened_mut().as_flattened_mut().copy_from_slice(reflected);
        run.voltages.copy_from_slice(voltages);
        run.record = checkpoint.record.clone();
        run.seconds = checkpoint.seconds;
        Ok(run)
    }
}
