//! The field in time: scatter, connect, drive and read the port.

use super::blocks::{LANES, Reflected, Scatter, State};
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

    /// Its first steps.
    #[must_use]
    pub fn until(&self, n_steps: usize) -> Self {
        Self { dt: self.dt, incident: self.incident[..n_steps].to_vec(), total: self.total[..n_steps].to_vec() }
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
    pub(super) network: &'a Network,
    pub(super) pulse: Pulse,
    pub(super) states: Vec<State>,
    pub(super) reflected: Vec<Reflected>,
    /// Edge voltages; one more than there are edges, always zero.
    pub(super) voltages: Vec<f32>,
    pub(super) record: Record,
    pub(super) seconds: f64,
}

impl<'a> Run<'a> {
    /// A run that begins with no field.
    #[must_use]
    pub fn new(network: &'a Network, pulse: Pulse) -> Self {
        Self {
            network,
            pulse,
            states: vec![[[0.0; LANES]; 9]; network.blocks.len()],
            reflected: vec![[[0.0; LANES]; 6]; network.blocks.len()],
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

    /// Number of cells.
    #[must_use]
    pub fn n_tets(&self) -> usize {
        self.network.n_tets
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
        let observed = self.scatter(incident as f32);
        self.connect();
        self.record.incident.push(incident);
        self.record.total.push(observed);
    }

    /// All cells; returns the total voltage at the port.
    fn scatter(&mut self, signal: f32) -> f64 {
        let arch = pulp::Arch::new();
        let voltages = &self.voltages[..];
        let n_inner = self.network.blocks.len() - self.network.boundary.len();
        let (inner_blocks, outer_blocks) = self.network.blocks.split_at(n_inner);
        let (inner_states, outer_states) = self.states.split_at_mut(n_inner);
        let (inner_reflected, outer_reflected) = self.reflected.split_at_mut(n_inner);
        let inner = || {
            let fields = inner_states.par_chunks_mut(CHUNK).zip(inner_reflected.par_chunks_mut(CHUNK));
            inner_blocks.par_chunks(CHUNK).zip(fields).for_each(|(blocks, (states, reflected))| {
                arch.dispatch(Scatter { blocks, states, reflected, voltages, boundary: None });
            });
        };
        let outer = || -> Vec<f64> {
            let fields = outer_states.par_chunks_mut(CHUNK).zip(outer_reflected.par_chunks_mut(CHUNK));
            let fixed = outer_blocks.par_chunks(CHUNK).zip(self.network.boundary.par_chunks(CHUNK));
            let seen = fixed.zip(fields).map(|((blocks, terms), (states, reflected))| {
                arch.dispatch(Scatter { blocks, states, reflected, voltages, boundary: Some((terms, signal)) })
            });
            seen.collect()
        };
        // Summed in the order of the blocks, whichever thread was first.
        rayon::join(inner, outer).1.iter().sum()
    }

    /// The voltage of every edge, from what its cells reflect.
    fn connect(&mut self) {
        let network = self.network;
        let reflected = self.reflected.as_flattened().as_flattened();
        let edges = &mut self.voltages[..network.n_edges];
        edges.par_chunks_mut(EDGE_CHUNK).enumerate().for_each(|(chunk, voltages)| {
            let first = chunk * EDGE_CHUNK;
            let starts = &network.starts[first..=first + voltages.len()];
            for ((voltage, bounds), weight) in voltages.iter_mut().zip(starts.windows(2)).zip(&network.weights[first..])
            {
                let ports = &network.places[bounds[0] as usize..bounds[1] as usize];
                *voltage = weight * ports.iter().map(|&p| reflected[p as usize]).sum::<f32>();
            }
        });
    }
}
