//! A run's state as plain values: what it takes to go on later with the same bits.

use super::blocks::{LANES, Lane};
use super::run::{Record, Run};
use super::{FieldRecorder, Network, Pulse, TlmError};
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
    /// States of the circuits at the outer sphere.
    pub waves: Vec<f64>,
    /// Sums of the transforms gathered so far, real and imaginary part.
    pub sums: Vec<[f64; 2]>,
}

impl Network<f32> {
    /// SHA-256 of all that rules a run: coefficients, connections, boundary, time step, pulse and what is gathered.
    fn fingerprint(&self, pulse: &Pulse, fields: Option<&FieldRecorder>) -> [u8; 32] {
        let mut hash = Sha256::new();
        for value in [self.dt, pulse.center, pulse.half_width] {
            hash.update(value.to_le_bytes());
        }
        for freq in fields.into_iter().flat_map(|fields| &fields.freqs) {
            hash.update(freq.to_le_bytes());
        }
        let mut lane = |lane: &Lane<f32>| hash.update(lane.map(f32::to_le_bytes).as_flattened());
        self.blocks.iter().flat_map(|b| &b.coefficients).for_each(&mut lane);
        self.boundary.iter().flat_map(|b| &b.conductance).for_each(&mut lane);
        let modes =
            self.outgoing.iter().map(|outgoing| &outgoing.modes).chain(self.line.iter().map(|line| &line.modes));
        modes.flat_map(|modes| &modes.forms).flat_map(|forms| &forms.values).for_each(&mut lane);
        self.weights.iter().for_each(|weight| hash.update(weight.to_le_bytes()));
        for edges in self.blocks.iter().flat_map(|b| &b.edges) {
            hash.update(edges.map(u32::to_le_bytes).as_flattened());
        }
        hash.finalize().into()
    }
}

impl Run<'_, f32> {
    fn fingerprint(&self) -> [u8; 32] {
        self.network.fingerprint(&self.pulse, self.fields.as_ref())
    }

    /// The state of this run.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        let cells = self.states.as_flattened().as_flattened().iter();
        let reflected = self.reflected.as_flattened().as_flattened().iter();
        Checkpoint {
            fingerprint: self.fingerprint(),
            seconds: self.seconds,
            record: self.record.clone(),
            field: cells.chain(reflected).chain(&self.voltages).copied().collect(),
            waves: self.waves.clone(),
            sums: self.fields.iter().flat_map(|fields| &fields.sums).map(|sum| [sum.re, sum.im]).collect(),
        }
    }

    /// The same run where a checkpoint of it was taken; with the same fields gathered.
    ///
    /// # Errors
    /// [`TlmError::ForeignCheckpoint`] if it was taken of another mesh, band or material.
    pub fn resumed(mut self, checkpoint: &Checkpoint) -> Result<Self, TlmError> {
        let n_cells = self.states.len() * 9 * LANES;
        let n_reflected = self.reflected.len() * 6 * LANES;
        let n_field = n_cells + n_reflected + self.voltages.len();
        let n_sums = self.fields.as_ref().map_or(0, |fields| fields.sums.len());
        let fits = checkpoint.field.len() == n_field && checkpoint.sums.len() == n_sums;
        let fits = fits && checkpoint.waves.len() == self.waves.len();
        if checkpoint.fingerprint != self.fingerprint() || !fits {
            return Err(TlmError::ForeignCheckpoint);
        }
        let (cells, rest) = checkpoint.field.split_at(n_cells);
        let (reflected, voltages) = rest.split_at(n_reflected);
        self.states.as_flattened_mut().as_flattened_mut().copy_from_slice(cells);
        self.reflected.as_flattened_mut().as_flattened_mut().copy_from_slice(reflected);
        self.voltages.copy_from_slice(voltages);
        self.waves.copy_from_slice(&checkpoint.waves);
        let sums = self.fields.iter_mut().flat_map(|fields| &mut fields.sums);
        sums.zip(&checkpoint.sums).for_each(|(sum, [re, im])| (sum.re, sum.im) = (*re, *im));
        self.record = checkpoint.record.clone();
        self.seconds = checkpoint.seconds;
        Ok(self)
    }
}
