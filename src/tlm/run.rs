//! The field in time: scatter, connect, drive and read the port.

use super::blocks::{LANES, Observe, Outside, Ports, Scatter, State};
use super::modes::Modes;
use super::network::Gap;
use super::outgoing::Outgoing;
use super::slots::Chunk;
use super::{FieldRecorder, Network, Pulse, Real, TlmError};
use crate::task::Task;
use crate::units::ETA0;
use rayon::prelude::*;
use std::time::Instant;

/// Edges of several chunks that one thread takes at a time.
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
pub struct Run<'a, T> {
    pub(super) network: &'a Network<T>,
    pub(super) pulse: Pulse,
    pub(super) states: Vec<State<T>>,
    pub(super) reflected: Vec<Ports<T>>,
    /// Edge voltages; one more than there are edges, always zero.
    pub(super) voltages: Vec<T>,
    /// Those of the next connection, while cells still read the last ones.
    next: Vec<T>,
    /// States of the circuits of the waves at the outer sphere.
    pub(super) waves: Vec<f64>,
    pub(super) record: Record,
    pub(super) fields: Option<FieldRecorder>,
    /// Edge along which a current is impressed, instead of a wave at the port.
    impressed: Option<u32>,
    pub(super) seconds: f64,
}

impl<'a, T: Real> Run<'a, T> {
    /// A run that begins with no field.
    #[must_use]
    pub fn new(network: &'a Network<T>, pulse: Pulse) -> Self {
        Self {
            network,
            pulse,
            states: vec![[[T::default(); LANES]; 9]; network.blocks.len()],
            reflected: vec![[[T::default(); LANES]; 6]; network.blocks.len()],
            voltages: vec![T::default(); network.n_edges + 1],
            next: vec![T::default(); network.n_edges + 1],
            waves: network.outgoing.as_ref().map(Outgoing::start).unwrap_or_default(),
            record: Record { dt: network.dt, ..Record::default() },
            fields: None,
            impressed: None,
            seconds: 0.0,
        }
    }

    /// The same run driven by a current along an edge of the mesh instead of a wave at the port.
    ///
    /// The current is the pulse in amperes, towards the vertex with the higher number, at `(n + 1/2) dt`.
    ///
    /// * `edge`: of [`Network::edge`].
    #[must_use]
    pub fn with_current(self, edge: u32) -> Self {
        Self { impressed: Some(edge), ..self }
    }

    /// The same run with the field gathered at some frequencies.
    #[must_use]
    pub fn with_fields(self, fields: FieldRecorder) -> Self {
        Self { fields: Some(fields), ..self }
    }

    /// The field gathered so far.
    #[must_use]
    pub fn fields(&self) -> Option<&FieldRecorder> {
        self.fields.as_ref()
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
        let started = Instant::now();
        // Once among the threads of the pool, which is much of the time of a step in a small mesh.
        let result = rayon::scope(|_| {
            for step in 0..n_steps {
                if step.is_multiple_of(STRIDE) {
                    task.check()?;
                }
                self.step();
            }
            Ok(())
        });
        self.seconds += started.elapsed().as_secs_f64();
        result
    }

    #[cfg(test)]
    pub(super) fn states_mut(&mut self) -> &mut [State<T>] {
        &mut self.states
    }

    #[cfg(test)]
    pub(super) fn reflected(&self) -> &[Ports<T>] {
        &self.reflected
    }

    #[cfg(test)]
    pub(super) fn voltages(&self) -> &[T] {
        &self.voltages
    }

    fn step(&mut self) {
        let step = self.record.total.len();
        let at = |step: f64| self.pulse.at(step * self.network.dt);
        let network = self.network;
        let gap = network.gap.as_ref().filter(|_| self.impressed.is_none());
        let is_line = self.impressed.is_none() && gap.is_none();
        let incident = if is_line { at(step as f64) } else { 0.0 };
        let later = at(step as f64 + 0.5);
        let arch = pulp::Arch::new();
        let (total, into_line) = self.meet_line(arch, incident);
        let leaving = self.leave(arch);
        self.scatter(arch, into_line, &leaving);
        self.connect_shared();
        std::mem::swap(&mut self.voltages, &mut self.next);
        if let Some(edge) = self.impressed {
            self.impress(edge, later);
        }
        // A lumped port's wave is that of its edges, half a step later than a line's.
        let (incident, total) = gap.map_or((incident, total), |gap| (later, self.drive(gap, later)));
        if let Some(fields) = &mut self.fields {
            fields.sample(step, &self.voltages, self.reflected.as_flattened().as_flattened());
        }
        self.record.incident.push(incident);
        self.record.total.push(total);
    }

    /// Adds a current along an edge, A, towards its vertex with the higher number.
    fn impress(&mut self, edge: u32, current: f64) {
        let edge = edge as usize;
        self.voltages[edge] -= T::new(0.5 * ETA0 * current) * self.network.weights[edge];
    }

    /// Adds the current of a lumped port's incident wave; the voltage across the gap.
    fn drive(&mut self, gap: &Gap, incident: f64) -> f64 {
        let current = 2.0 * incident / gap.resistance;
        let mut across = 0.0;
        for &(edge, sign) in &gap.edges {
            self.impress(edge, sign * current);
            // The current piles up charge where it goes, so the field points back.
            across -= sign * self.voltages[edge as usize].to_f64();
        }
        across
    }

    /// All cells, and the edges that only one chunk has.
    ///
    /// * `into_line`: current into the line behind the port; `leaving`: currents of the waves at the outer sphere.
    fn scatter(&mut self, arch: pulp::Arch, into_line: T, leaving: &[T]) {
        let network = self.network;
        let n_inner = network.blocks.len() - network.boundary.len();
        let voltages = &self.voltages[..];
        let (mut states, mut reflected, mut next) = (&mut self.states[..], &mut self.reflected[..], &mut self.next[..]);
        let mut parts = Vec::with_capacity(network.chunks.len());
        for chunk in &network.chunks {
            parts.push((
                chunk,
                states.split_off_mut(..chunk.blocks.len()).expect("chunks are all blocks"),
                reflected.split_off_mut(..chunk.blocks.len()).expect("chunks are all blocks"),
                next.split_off_mut(..chunk.edges.len()).expect("edges of chunks come first"),
            ));
        }
        let into_line = [into_line];
        parts.into_par_iter().for_each(|(chunk, states, reflected, next)| {
            let blocks = &network.blocks[chunk.blocks.clone()];
            let waves =
                network.outgoing.as_ref().and_then(|outgoing| Some((outgoing.modes.at(&chunk.blocks)?, leaving)));
            let port = || Some((network.line.as_ref()?.modes.at(&chunk.blocks)?, &into_line[..]));
            let outside = (chunk.blocks.start >= n_inner).then(|| Outside {
                boundary: &network.boundary[chunk.blocks.start - n_inner..chunk.blocks.end - n_inner],
                modes: waves.or_else(port),
            });
            arch.dispatch(Scatter { blocks, states, reflected, voltages, outside });
            let reflected = reflected.as_flattened().as_flattened();
            network.connect(chunk.edges.start, next, reflected, chunk.blocks.start * 6 * LANES);
        });
    }

    /// The currents of the waves at the outer sphere, whose circuits go on by a step.
    fn leave(&mut self, arch: pulp::Arch) -> Vec<T> {
        let network = self.network;
        let Some(outgoing) = &network.outgoing else { return Vec::new() };
        let seen = self.seen(arch, &outgoing.modes);
        outgoing.step(&seen, &mut self.waves).into_iter().map(T::new).collect()
    }

    /// The total voltage at the port, and the current into the line behind it.
    fn meet_line(&self, arch: pulp::Arch, incident: f64) -> (f64, T) {
        let Some(line) = &self.network.line else { return (0.0, T::default()) };
        let (total, current) = line.step(self.seen(arch, &line.modes)[0], incident);
        (total, T::new(current))
    }

    /// Voltages of modes before their own currents flow.
    fn seen(&self, arch: pulp::Arch, modes: &Modes<T>) -> Vec<f64> {
        let network = self.network;
        let of_chunk = |chunk: &Chunk| {
            let range = chunk.blocks.clone();
            Some(arch.dispatch(Observe {
                forms: modes.at(&range)?,
                blocks: &network.blocks[range.clone()],
                states: &self.states[range.clone()],
                reflected: &self.reflected[range],
                voltages: &self.voltages,
                n_modes: modes.n_modes,
            }))
        };
        // Summed in the order of the chunks, whichever thread was first.
        let mut sums = vec![0.0; modes.n_modes];
        for seen in network.chunks.par_iter().filter_map(of_chunk).collect::<Vec<_>>() {
            sums.iter_mut().zip(seen).for_each(|(sum, seen)| *sum += seen);
        }
        sums
    }

    /// The edges of several chunks.
    fn connect_shared(&mut self) {
        let network = self.network;
        let reflected = self.reflected.as_flattened().as_flattened();
        let first = network.chunks.last().map_or(0, |chunk| chunk.edges.end);
        let shared = self.next[first..network.n_edges].par_chunks_mut(EDGE_CHUNK).enumerate();
        shared.for_each(|(k, next)| network.connect(first + k * EDGE_CHUNK, next, reflected, 0));
    }
}

impl<T: Real> Network<T> {
    /// Voltages of some edges, from what their cells reflect.
    ///
    /// * `first`: number of the first edge; `offset`: place of the first of the reflected currents among all.
    fn connect(&self, first: usize, voltages: &mut [T], reflected: &[T], offset: usize) {
        let starts = &self.starts[first..=first + voltages.len()];
        for ((voltage, bounds), weight) in voltages.iter_mut().zip(starts.windows(2)).zip(&self.weights[first..]) {
            let ports = &self.places[bounds[0] as usize..bounds[1] as usize];
            *voltage = *weight * ports.iter().map(|&p| reflected[p as usize - offset]).sum::<T>();
        }
    }
}
