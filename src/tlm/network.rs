//! From a mesh to the coefficients of all cells: fixed once built.

use super::TlmError;
use super::assembly::{Assembly, ascending};
use super::blocks::{Block, Boundary, LANES, Ports, State};
use super::cell::{Cell, EDGES, MARGIN};
use super::loads::Loads;
use super::modes::Modes;
use super::outgoing::{OuterSphere, Outgoing};
use super::port::{LineEnd, PortMode};
use super::real::Real;
use super::slots::{Chunk, Slots};
use crate::geometry::VertexId;
use crate::task::Task;
use crate::tet::TetMesh;
use crate::units::{C0, ETA0};
use rayon::prelude::*;

/// How the time step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepLimit {
    /// The largest step that every cell allows.
    Exact,
    /// The largest step that all but this share of the cells allow; the inductive stubs of those are clipped, which
    /// slows light in them a little: at 0.003 no resonance moves visibly, and the step doubles.
    Clip(f64),
}

/// How a mesh is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkSettings {
    /// Frequency at which loss tangents become conductivities, Hz.
    pub loss_freq: f64,
    /// The time step.
    pub step: StepLimit,
    /// Whether cells at the edges of sheets hold the energy of the singular field: without it resonances of patches
    /// are too low in proportion to the edge length there.
    pub edge_correction: bool,
    /// Spherical waves up to this degree leave a spherical outer boundary as they would go on in free space; all others,
    /// or all at 0 or where the boundary is no sphere, meet a first-order condition, which reflects some percent of them.
    pub wave_degrees: usize,
    /// What else there is.
    pub loads: Loads,
}

/// Waves of an antenna of the size of a wavelength: those of higher degrees hardly leave it.
const WAVE_DEGREES: usize = 3;

impl NetworkSettings {
    /// The usual ones: exact step, corrected sheet edges, free waves of the first degrees, no loads.
    ///
    /// * `loss_freq`: frequency at which loss tangents become conductivities, Hz.
    #[must_use]
    pub fn new(loss_freq: f64) -> Self {
        Self {
            loss_freq,
            step: StepLimit::Exact,
            edge_correction: true,
            wave_degrees: WAVE_DEGREES,
            loads: Loads::default(),
        }
    }
}

/// All cells of a mesh with their coefficients.
#[derive(Clone, Debug)]
pub struct Network<T> {
    pub(super) blocks: Vec<Block<T>>,
    /// Terms of the last blocks, which hold all cells with boundary faces.
    pub(super) boundary: Vec<Boundary<T>>,
    pub(super) chunks: Vec<Chunk>,
    /// The waves that leave at the outer sphere.
    pub(super) outgoing: Option<Outgoing<T>>,
    /// The line behind the port.
    pub(super) line: Option<LineEnd<T>>,
    pub(super) n_edges: usize,
    /// For each edge where its ports' reflected currents are among those of all blocks, from `starts[e]` to `starts[e + 1]`.
    pub(super) starts: Vec<u32>,
    pub(super) places: Vec<u32>,
    /// `2 / (sum Y + conductance of resistors)` of each edge.
    pub(super) weights: Vec<T>,
    /// By lane over all blocks: number of the cell in the mesh, `u32::MAX` for filling.
    tets: Vec<u32>,
    /// Cells of lossy material.
    pub(super) lossy: Vec<Lossy>,
    /// The lumped port.
    pub(super) gap: Option<Gap>,
    /// Edges with resistors or on lossy sheets, and their conductance in units of the free-space admittance.
    pub(super) resistors: Vec<(u32, f64)>,
    /// Number of cells.
    pub n_tets: usize,
    /// Time step, s.
    pub dt: f64,
    /// Characteristic impedance of the port as meshed, or the resistance of the lumped one, ohm; `None` without a port.
    pub port_impedance: Option<f64>,
    /// Cells whose stubs were clipped to allow the step.
    pub n_clipped: usize,
}

/// The edges of a lumped port. They hold the source's resistance, each a part of it by length, so that one current
/// through all of them makes one source: `2 v_inc / R`.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    /// Edges from one side to the other, and 1 where the chain runs towards the vertex with the higher number, else -1.
    pub(super) edges: Vec<(u32, f64)>,
    /// Of the source, ohm.
    pub(super) resistance: f64,
}

/// What a cell loses: `V^T G V`, without what stands for the outside (outer boundary, port).
#[derive(Clone, Debug)]
pub(super) struct Lossy {
    pub(super) lane: usize,
    /// G by rows of the lower triangle, in units of the free-space admittance.
    pub(super) conductance: [f64; 21],
}

impl<T: Real> Network<T> {
    /// Computes the coefficients of a mesh with at most one port.
    ///
    /// # Errors
    /// [`TlmError::NotCoaxial`], [`TlmError::NoSheet`], [`TlmError::NoGap`], [`TlmError::NotPositive`],
    /// [`TlmError::Cancelled`].
    pub fn new(mesh: &TetMesh, settings: &NetworkSettings, task: &Task) -> Result<Self, TlmError> {
        let phase = task.phase("preparing cells", 3);
        settings.loads.check(mesh)?;
        let assembly = Assembly::new(mesh, settings)?;
        phase.advance(1);
        task.check()?;
        let limits: Vec<f64> = (0..assembly.cells.len()).into_par_iter().map(|k| assembly.cell(k).x_max).collect();
        let x = MARGIN * limit(&limits, settings.step);
        let n_clipped = limits.iter().filter(|&&l| x > l).count();
        phase.advance(1);
        task.check()?;
        let slots = Slots::new(&assembly);
        let filled = slots.fill(&assembly, x);
        let (starts, places, weights) = slots.connect(&filled.0, &assembly);
        let [first, last] = slots.ends;
        let outgoing = |sphere: OuterSphere| {
            let of_cell = |k| assembly.wave_forms(&sphere, k);
            let modes = Modes::new(&filled.0, &slots, last..filled.0.len(), sphere.n_waves(), of_cell);
            Outgoing::new(&sphere, modes, x)
        };
        let outgoing = assembly.outer_sphere(settings.wave_degrees).map(outgoing);
        let line = |mode: &PortMode| LineEnd {
            modes: Modes::new(&filled.0, &slots, first..last, 1, |k| assembly.port_form(k)),
            admittance: mode.admittance,
        };
        let line = assembly.port().map(line);
        let gap = slots.gap(&assembly)?;
        phase.advance(1);
        Ok(Self {
            outgoing,
            blocks: filled.0,
            boundary: filled.1,
            chunks: slots.chunks.clone(),
            n_edges: slots.n_edges,
            starts,
            places,
            weights,
            port_impedance: match &gap {
                Some(gap) => Some(gap.resistance),
                None => line.as_ref().map(|line| ETA0 / line.admittance),
            },
            gap,
            tets: slots.tets(&assembly),
            lossy: slots.lossy(&assembly),
            resistors: slots.resistors(&assembly),
            n_tets: mesh.tets.len(),
            dt: 2.0 * x / C0,
            n_clipped,
            line,
        })
    }

    /// Number of the edge between two vertices of the mesh that the network was made from; `None` where there is none, or
    /// it lies on a conductor.
    #[must_use]
    pub fn edge(&self, mesh: &TetMesh, ends: [VertexId; 2]) -> Option<u32> {
        let at_edge: Vec<bool> = mesh.tets.iter().map(|t| ends.iter().all(|v| t.vertices.contains(v))).collect();
        let (lane, tet) = self.lanes_of(&at_edge).next()?;
        let corners = ascending(mesh.tets[tet].vertices);
        let is_it = |&(i, j): &(usize, usize)| ends.contains(&corners[i]) && ends.contains(&corners[j]);
        self.live_edges(lane)[EDGES.iter().position(is_it)?]
    }

    /// Memory that a step reads and writes if every number moves once each way, bytes per cell: coefficients, state,
    /// reflected currents, edge voltages, and the lists that connect them.
    #[must_use]
    pub fn traffic(&self) -> f64 {
        let block = size_of::<Block<T>>() + 2 * size_of::<State<T>>() + 2 * size_of::<Ports<T>>();
        let list = size_of_val(&self.places[..]) + size_of_val(&self.starts[..]) + size_of_val(&self.weights[..]);
        let waves = self.outgoing.as_ref().map_or(0, |outgoing| 2 * outgoing.modes.size());
        let total = waves
            + block * self.blocks.len()
            + size_of_val(&self.boundary[..])
            + list
            + 2 * size_of::<T>() * self.n_edges;
        total as f64 / self.n_tets as f64
    }

    /// Lanes of some of the mesh's cells, with the cell.
    pub(super) fn lanes_of<'a>(&'a self, is_chosen: &'a [bool]) -> impl Iterator<Item = (usize, usize)> + 'a {
        let lanes = self.tets.iter().enumerate().filter(|(_, t)| **t != u32::MAX);
        lanes.map(|(lane, t)| (lane, *t as usize)).filter(|(_, t)| is_chosen[*t])
    }

    /// Number of a lane's cell in the mesh.
    pub(super) fn tet(&self, lane: usize) -> usize {
        self.tets[lane] as usize
    }

    /// Edges of a lane's ports; none where they are dropped.
    pub(super) fn live_edges(&self, lane: usize) -> [Option<u32>; 6] {
        let block = &self.blocks[lane / LANES];
        std::array::from_fn(|e| Some(block.edges[e][lane % LANES]).filter(|&edge| (edge as usize) < self.n_edges))
    }
}

/// How far the scattering of a mesh's cells without losses is from orthogonal, at the worst: infinitely if a stub is
/// negative. What is lossless keeps its energy up to this, at the step that the settings give.
///
/// # Errors
/// [`TlmError::NotCoaxial`], [`TlmError::NoSheet`].
pub fn orthogonality_error(mesh: &TetMesh, settings: &NetworkSettings) -> Result<f64, TlmError> {
    let assembly = Assembly::new(mesh, settings)?;
    let cells: Vec<Cell> = (0..assembly.cells.len()).into_par_iter().map(|k| assembly.cell(k)).collect();
    let x = MARGIN * limit(&cells.iter().map(|cell| cell.x_max).collect::<Vec<_>>(), settings.step);
    Ok(cells.par_iter().map(|cell| cell.orthogonality_error(x)).reduce(|| 0.0, f64::max))
}

/// The half step that a share of the cells allows.
fn limit(limits: &[f64], step: StepLimit) -> f64 {
    let share = match step {
        StepLimit::Exact => 0.0,
        StepLimit::Clip(share) => share.clamp(0.0, 0.05),
    };
    let mut sorted = limits.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a part of the length")]
    let place = (share * sorted.len() as f64) as usize;
    sorted[place.min(sorted.len() - 1)]
}
