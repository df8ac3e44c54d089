//! The field at chosen frequencies on a closed surface, and the power lost within it, gathered while the field runs.
//!
//! A running Fourier transform `X(f) = sum x(t) exp(-j 2 pi f t) dt` of the voltages and weak currents of the surface's
//! edges (see [`Huygens`]) and of the voltages of the edges of lossy cells, sheets and resistors. Voltages and currents at edges are
//! taken at `(n + 1/2) dt`, with that time in the kernel. The pulse is band-limited, so only one of several steps counts,
//! [`SAMPLES`] in a period of the highest frequency: what lies beyond the band is folded back from eleven times it.
//!
//! Lost power is that of the conductances themselves, `1/2 V^H G V` over cells, with the voltages of the edges for those
//! of the cell's middle, which differ by second order in the cell's size over the wavelength. It owes nothing to the
//! other powers, so that their balance is a check. Sums are in double precision, each in the order of time: the same
//! bits for any number of threads.

use super::TlmError;
use super::assembly::ascending;
use super::blocks::{ADMITTANCE, LANES};
use super::cell::EDGES;
use super::huygens::Huygens;
use super::network::Network;
use super::real::Real;
use crate::geometry::VertexId;
use crate::tet::TetMesh;
use crate::units::ETA0;
use nalgebra::Complex;
use rayon::prelude::*;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Samples in a period of the highest frequency.
const SAMPLES: f64 = 12.0;
/// Values that one thread takes at a time.
const CHUNK: usize = 512;

/// What the surface saw at one frequency: Fourier integrals of a pulse, or phasors after scaling.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceField {
    /// Frequency, Hz.
    pub freq: f64,
    /// `∫ E·dl` of the surface's edges, V s.
    pub voltages: Vec<Complex<f64>>,
    /// `∮ w·(n x H) dS` of the surface's edges, A s.
    pub currents: Vec<Complex<f64>>,
    /// Lost within the surface, W s².
    pub lost: f64,
}

impl SurfaceField {
    /// Mean power through the surface, outward, W s².
    #[must_use]
    pub fn power(&self) -> f64 {
        -0.5 * self.voltages.iter().zip(&self.currents).map(|(v, j)| (v * j.conj()).re).sum::<f64>()
    }
}

/// A cell, or an edge of a sheet or with a resistor, that loses power: its edges among the recorded ones, and `G` by rows of the lower triangle, 1/ohm.
#[derive(Clone, Debug)]
struct LossyCell {
    edges: [Option<u32>; 6],
    conductance: [f64; 21],
}

/// The running transform.
#[derive(Clone, Debug)]
pub struct FieldRecorder {
    pub(super) freqs: Vec<f64>,
    dt: f64,
    /// Steps between two samples.
    stride: usize,
    /// Edges of the surface, then of lossy cells, by their number in the network.
    edges: Vec<u32>,
    n_surface: usize,
    /// For each edge of the surface the ports of its inside cells, from `starts[e]` to `starts[e + 1]`: place among the
    /// reflected currents, and admittance.
    starts: Vec<usize>,
    ports: Vec<(u32, f64)>,
    lossy: Vec<LossyCell>,
    /// `[voltages of edges, currents of the surface's edges][frequency]`
    pub(super) sums: Vec<Complex<f64>>,
}

impl FieldRecorder {
    /// A recorder that has seen nothing.
    ///
    /// * `mesh`, `network`: what runs, and the surface in it.
    /// * `freqs`: frequencies, Hz.
    ///
    /// # Errors
    /// [`TlmError::NoRoom`] if a conductor touches the surface.
    pub fn new<T: Real>(
        mesh: &TetMesh,
        network: &Network<T>,
        huygens: &Huygens,
        freqs: &[f64],
    ) -> Result<Self, TlmError> {
        let n_surface = huygens.surface.edges.len();
        let number: HashMap<[VertexId; 2], usize> = (0..n_surface).map(|e| (huygens.ends(e), e)).collect();
        let mut edges = vec![u32::MAX; n_surface];
        let mut ports: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n_surface];
        for (lane, tet) in network.lanes_of(&huygens.inside) {
            let corners = ascending(mesh.tets[tet].vertices);
            let live = network.live_edges(lane);
            for (e, (i, j)) in EDGES.into_iter().enumerate() {
                if let (Some(edge), Some(&k)) = (live[e], number.get(&[corners[i], corners[j]])) {
                    edges[k] = edge;
                    let (b, w) = (lane / LANES, lane % LANES);
                    let place = VertexId::new((b * 6 + e) * LANES + w).raw();
                    ports[k].push((place, network.blocks[b].coefficients[ADMITTANCE + e][w].to_f64()));
                }
            }
        }
        let mut of_lossy: HashMap<u32, u32> = HashMap::new();
        let mut place = |edge: u32| {
            let next = VertexId::new(n_surface + of_lossy.len()).raw();
            *of_lossy.entry(edge).or_insert(next)
        };
        let within = network.lossy.iter().filter(|cell| huygens.inside[network.tet(cell.lane)]);
        let mut lossy: Vec<LossyCell> = within
            .map(|cell| LossyCell {
                edges: network.live_edges(cell.lane).map(|edge| edge.map(&mut place)),
                conductance: cell.conductance.map(|g| g / ETA0),
            })
            .collect();
        for &(edge, conductance) in &network.resistors {
            let mut cell = LossyCell { edges: [None; 6], conductance: [0.0; 21] };
            (cell.edges[0], cell.conductance[0]) = (Some(place(edge)), conductance / ETA0);
            lossy.push(cell);
        }
        if edges.contains(&u32::MAX) {
            return Err(TlmError::NoRoom { room: 0.0 });
        }
        edges.resize(n_surface + of_lossy.len(), 0);
        of_lossy.iter().for_each(|(edge, place)| edges[*place as usize] = *edge);
        let mut starts = vec![0; n_surface + 1];
        (0..n_surface).for_each(|e| starts[e + 1] = starts[e] + ports[e].len());
        let highest = freqs.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred steps")]
        let stride = (1.0 / (highest * SAMPLES * network.dt)).floor().clamp(1.0, 1e6) as usize;
        let sums = vec![Complex::default(); (edges.len() + n_surface) * freqs.len()];
        let ports = ports.concat();
        Ok(Self { freqs: freqs.to_vec(), dt: network.dt, stride, edges, n_surface, starts, ports, lossy, sums })
    }

    /// Takes the field after a step's connection, if it is this step's turn.
    ///
    /// * `voltages`: of the network's edges; `reflected`: currents of all ports.
    pub(super) fn sample<T: Real>(&mut self, step: usize, voltages: &[T], reflected: &[T]) {
        if !step.is_multiple_of(self.stride) {
            return;
        }
        let time = (step as f64 + 0.5) * self.dt;
        let weight = self.stride as f64 * self.dt;
        let turns: Vec<Complex<f64>> =
            self.freqs.iter().map(|f| Complex::from_polar(weight, -TAU * (f * time).fract())).collect();
        let (edges, starts, ports) = (&self.edges, &self.starts, &self.ports);
        let value = |k: usize| {
            if let Some(&edge) = edges.get(k) {
                return voltages[edge as usize].to_f64();
            }
            let e = k - edges.len();
            let v = voltages[edges[e] as usize].to_f64();
            let into = |&(place, y): &(u32, f64)| y * v - 2.0 * reflected[place as usize].to_f64();
            ports[starts[e]..starts[e + 1]].iter().map(into).sum::<f64>() / ETA0
        };
        let n = self.freqs.len();
        self.sums.par_chunks_mut(CHUNK * n).enumerate().for_each(|(chunk, sums)| {
            for (k, sums) in sums.chunks_exact_mut(n).enumerate() {
                let x = value(chunk * CHUNK + k);
                sums.iter_mut().zip(&turns).for_each(|(sum, turn)| *sum += turn * x);
            }
        });
    }

    /// What the surface has seen so far, by frequency.
    #[must_use]
    pub fn fields(&self) -> Vec<SurfaceField> {
        let n = self.freqs.len();
        let field = |f: usize| {
            let spectrum = |k: usize| self.sums[k * n + f];
            SurfaceField {
                freq: self.freqs[f],
                voltages: (0..self.n_surface).map(spectrum).collect(),
                currents: (self.edges.len()..self.edges.len() + self.n_surface).map(spectrum).collect(),
                lost: self.lossy.iter().map(|cell| cell.power(spectrum)).sum(),
            }
        };
        (0..n).into_par_iter().map(field).collect()
    }
}

impl LossyCell {
    /// `1/2 V^H G V`
    fn power(&self, voltage: impl Fn(usize) -> Complex<f64>) -> f64 {
        let v = self.edges.map(|e| e.map_or(Complex::default(), |e| voltage(e as usize)));
        let places = (0..6).flat_map(|a| (0..=a).map(move |b| (a, b)));
        let terms = self.conductance.iter().zip(places).map(|(g, (a, b))| {
            let share = if a == b { 0.5 } else { 1.0 };
            share * g * (v[a].conj() * v[b]).re
        });
        terms.sum()
    }
}
