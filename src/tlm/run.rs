//! The field in time: scatter, connect, drive and read the port.

use super::blocks::{Block, Boundary, LANES, Scatter, State};
use super::{Network, Pulse, TlmError};
use crate::task::Task;
use rayon::prelude::*;
use std::time::Instant;

/// Blocks that one thread takes at a time.
const CHUNK: usize = 128;
/// Edges that one thread takes at a time.
const EDGE_CHUNK: usize = 8192;
/// Steps between two looks at the task.
const STRIDE: usize = 64;

/// What the port saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Time step, s.
    pub dt: f64,
    /// Incident voltage at the port, by step.
    pub incident: Vec<f64>,
    /// Total voltage at the port, by step.
    pub total: Vec<f64>,
}

impl Record {
    /// Reflected voltage by step.
    pub fn reflected(&self) -> impl Iterator<Item = f64> + '_ {
        self.total.iter().zip(&self.incident).map(|(total, incident)| total - incident)
    }

    /// How far the reflected voltage has fallen: greatest magnitude over the last `window` seconds relative to the
    /// greatest of all.
    #[must_use]
    pub fn residual(&self, window: f64) -> f64 {
        let reflected: Vec<f64> = self.reflected().map(f64::abs).collect();
        let peak = reflected.iter().copied().fold(0.0, f64::max);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of steps")]
        let n = ((window / self.dt).ceil() as usize).min(reflected.len());
        let last = reflected[reflected.len() - n..].iter().copied().fold(0.0, f64::max);
        if peak > 0.0 { last / peak } else { 1.0 }
    }
}

/// A run of the field in a network.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    network: &'a Network,
    pulse: Pulse,
    states: Vec<State>,
    /// Edge voltages; one more than there are edges, always zero.
    voltages: Vec<f32>,
    record: Record,
    seconds: f64,
}

impl<'a> Run<'a> {
    /// A run that begins with no field.
    #[must_use]
    pub fn new(network: &'a Network, pulse: Pulse) -> Self {
        Self {
            network,
            pulse,
            states: vec![[[0.0; LANES]; 15]; network.blocks.len()],
            voltages: vec![0.0; network.n_edges + 1],
            record: Record { dt: network.dt, ..Record::default() },
            seconds: 0.0,
        }
    }

    /// What the port saw so far.
    #[must_use]
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Cells times steps per second so far.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.network.n_tets as f64 * self.record.total.len() as f64 / self.seconds.max(f64::MIN_POSITIVE)
    }

    /// Runs some more steps.
    ///
    /// # Errors
    /// [`TlmError::Cancelled`]; what was computed stays.
    pub fn advance(&mut self, n_steps: usize, task: &Task) -> Result<(), TlmError> {
        for step in 0..n_steps {
            if step.is_multiple_of(STRIDE) {
                task.check()?;
            }
            let started = Instant::now();
            self.step();
            self.seconds += started.elapsed().as_secs_f64();
        }
        Ok(())
    }

    fn step(&mut self) {
        let incident = self.pulse.at(self.record.total.len() as f64 * self.network.dt);
        #[allow(clippy::cast_possible_truncation, reason = "the field runs in single precision")]
        let observed = scatter(self.network, &mut self.states, &self.voltages, incident as f32);
        connect(self.network, &self.states, &mut self.voltages);
        self.record.incident.push(incident);
        self.record.total.push(observed);
    }
}

fn scatter(network: &Network, states: &mut [State], voltages: &[f32], signal: f32) -> f64 {
    let arch = pulp::Arch::new();
    let n_inner = network.blocks.len() - network.boundary.len();
    let (inner, rest) = states.split_at_mut(n_inner);
    let inside = || {
        inner.par_chunks_mut(CHUNK).zip(network.blocks.par_chunks(CHUNK)).for_each(|(states, blocks)| {
            arch.dispatch(Scatter { blocks, states, voltages, boundary: None });
        });
    };
    let terms: (&[Block], &[Boundary]) = (&network.blocks[n_inner..], &network.boundary);
    let outside = || -> Vec<f64> {
        let chunks = rest.par_chunks_mut(CHUNK).zip(terms.0.par_chunks(CHUNK).zip(terms.1.par_chunks(CHUNK)));
        let seen = chunks.map(|(states, (blocks, boundary))| {
            arch.dispatch(Scatter { blocks, states, voltages, boundary: Some((boundary, signal)) })
        });
        seen.collect()
    };
    // Summed in the order of the blocks, whichever thread was first.
    rayon::join(inside, outside).1.iter().sum()
}

fn connect(network: &Network, states: &[State], voltages: &mut [f32]) {
    let reflected = states.as_flattened().as_flattened();
    let edges = &mut voltages[..network.n_edges];
    edges.par_chunks_mut(EDGE_CHUNK).enumerate().for_each(|(chunk, voltages)| {
        for (k, voltage) in voltages.iter_mut().enumerate() {
            let e = chunk * EDGE_CHUNK + k;
            let ports = &network.places[network.starts[e] as usize..network.starts[e + 1] as usize];
            *voltage = network.weights[e] * ports.iter().map(|&p| reflected[p as usize]).sum::<f32>();
        }
    });
}
