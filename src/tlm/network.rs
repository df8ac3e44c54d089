//! From a mesh to the coefficients of all cells: fixed once built.

use super::TlmError;
use super::blocks::{A_INVERSE, ADMITTANCE, Block, Boundary, LANES, LOSS, OBSERVATION, SOURCE, triangle};
use super::cell::{Cell, EDGES, MARGIN, face_mass};
use super::port::PortMode;
use crate::geometry::{DVec3, VertexId};
use crate::task::Task;
use crate::tet::{FaceRole, TetMesh, face_key};
use crate::units::{C0, ETA0};
use nalgebra::{Matrix3, Matrix6};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkSettings {
    /// Frequency at which loss tangents become conductivities, Hz.
    pub loss_freq: f64,
    /// The time step.
    pub step: StepLimit,
}

/// All cells of a mesh with their coefficients.
#[derive(Clone, Debug)]
pub struct Network {
    pub(super) blocks: Vec<Block>,
    /// Terms of the last blocks, which hold all cells with boundary faces.
    pub(super) boundary: Vec<Boundary>,
    pub(super) n_edges: usize,
    /// For each edge where its ports' reflected currents are among those of all blocks, from `starts[e]` to `starts[e + 1]`.
    pub(super) starts: Vec<u32>,
    pub(super) places: Vec<u32>,
    /// `2 / sum Y` of each edge.
    pub(super) weights: Vec<f32>,
    /// Number of cells.
    pub n_tets: usize,
    /// Time step, s.
    pub dt: f64,
    /// Characteristic impedance of the port as meshed, ohm.
    pub port_impedance: f64,
    /// Cells whose stubs were clipped to allow the step.
    pub n_clipped: usize,
}

/// A mesh prepared for assembly: cells in their final order, vertices ascending.
struct Prepared<'a> {
    mesh: &'a TetMesh,
    /// Cells: corners ascending, and the number in the mesh.
    cells: Vec<([VertexId; 4], usize)>,
    /// Cells before this one have no boundary face.
    n_inner: usize,
    faces: BoundaryFaces,
}

/// What the marked faces mean.
struct BoundaryFaces {
    conducting: HashSet<[VertexId; 2]>,
    /// Edges of the port, and the region behind it, in which they are live.
    port_edges: HashSet<[VertexId; 2]>,
    port_region: usize,
    port: PortMode,
    /// By face: place in `port.faces`.
    port_faces: HashMap<[VertexId; 3], usize>,
    outer: HashSet<[VertexId; 3]>,
}

fn edges_of([a, b, c]: [VertexId; 3]) -> [[VertexId; 2]; 3] {
    [[a, b], [a, c], [b, c]]
}

impl BoundaryFaces {
    fn new(mesh: &TetMesh) -> Result<Self, TlmError> {
        let with_role = |role: FaceRole| {
            mesh.faces.iter().filter(move |f| mesh.groups[f.group].role == role).map(|f| face_key(f.vertices))
        };
        let conducting = with_role(FaceRole::Conductor).flat_map(edges_of).collect();
        let keys: Vec<[VertexId; 3]> = with_role(FaceRole::Port).collect();
        let (Some(first), Some(marked)) =
            (keys.first(), mesh.faces.iter().find(|f| mesh.groups[f.group].role == FaceRole::Port))
        else {
            return Err(TlmError::NoPort);
        };
        // The cell behind a face sees its corners as the mark lists them.
        let same = |f: [VertexId; 3]| (0..3).any(|k| f == [0, 1, 2].map(|i| marked.vertices[(i + k) % 3]));
        let behind = mesh.tets.iter().find(|t| (0..4).any(|i| face_key(t.face(i)) == *first && same(t.face(i))));
        let port_region = behind.ok_or(TlmError::NoPort)?.region.index();
        let root_eps = mesh.regions[port_region].eps_r.sqrt();
        let port = PortMode::new(&keys, &mesh.vertices, root_eps, &mesh.groups[marked.group].name)?;
        Ok(Self {
            conducting,
            port_edges: keys.iter().copied().flat_map(edges_of).collect(),
            port_region,
            port_faces: port.faces.iter().enumerate().map(|(k, f)| (f.vertices, k)).collect(),
            port,
            outer: with_role(FaceRole::Outer).collect(),
        })
    }

    fn is_boundary(&self, corners: [VertexId; 4], region: usize) -> bool {
        faces_of(corners)
            .into_iter()
            .any(|(_, f)| self.outer.contains(&f) || (region == self.port_region && self.port_faces.contains_key(&f)))
    }
}

/// The four faces of ascending corners with the places of their edges among the six.
fn faces_of(c: [VertexId; 4]) -> [([usize; 3], [VertexId; 3]); 4] {
    [
        ([3, 4, 5], [c[1], c[2], c[3]]),
        ([1, 2, 5], [c[0], c[2], c[3]]),
        ([0, 2, 4], [c[0], c[1], c[3]]),
        ([0, 1, 3], [c[0], c[1], c[2]]),
    ]
}

impl<'a> Prepared<'a> {
    fn new(mesh: &'a TetMesh) -> Result<Self, TlmError> {
        let faces = BoundaryFaces::new(mesh)?;
        let (lo, hi) =
            mesh.vertices.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let scale = 1023.0 / (hi - lo).max_element();
        let mut keyed: Vec<(bool, u32, usize)> = (0..mesh.tets.len())
            .into_par_iter()
            .map(|t| {
                let tet = &mesh.tets[t];
                let center = mesh.corners(t).iter().sum::<DVec3>() / 4.0;
                let is_boundary = faces.is_boundary(ascending(tet.vertices), tet.region.index());
                (is_boundary, morton((center - lo) * scale), t)
            })
            .collect();
        keyed.par_sort_unstable();
        let n_inner = keyed.iter().take_while(|k| !k.0).count();
        let cells = keyed.into_iter().map(|(_, _, t)| (ascending(mesh.tets[t].vertices), t)).collect();
        Ok(Self { mesh, cells, n_inner, faces })
    }

    fn region(&self, tet: usize) -> usize {
        self.mesh.tets[tet].region.index()
    }

    /// The ports of a cell that are in use.
    fn free(&self, corners: [VertexId; 4], tet: usize) -> [bool; 6] {
        let is_behind = self.region(tet) == self.faces.port_region;
        EDGES.map(|(i, j)| {
            let edge = [corners[i], corners[j]];
            !self.faces.conducting.contains(&edge) && (is_behind || !self.faces.port_edges.contains(&edge))
        })
    }

    fn cell(&self, k: usize) -> Cell {
        let (corners, tet) = self.cells[k];
        let points = corners.map(|v| self.mesh.vertices[v.index()]);
        Cell::new(points, self.mesh.regions[self.region(tet)].eps_r, self.free(corners, tet))
    }

    /// What boundary faces add to a cell: conductances of its ports, and how the port drives and reads them.
    fn boundary_terms(&self, corners: [VertexId; 4], tet: usize) -> (Matrix6<f64>, [f64; 6], [f64; 6]) {
        let (mut conductance, mut source, mut observation) = (Matrix6::zeros(), [0.0; 6], [0.0; 6]);
        let port = &self.faces.port;
        for (places, face) in faces_of(corners) {
            let mut add = |matrix: &Matrix3<f64>| {
                for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                    conductance[(places[a], places[b])] += matrix[(a, b)];
                }
            };
            if self.faces.outer.contains(&face) {
                let (mass, ..) = face_mass(face.map(|v| self.mesh.vertices[v.index()]));
                add(&(mass * self.mesh.regions[self.region(tet)].eps_r.sqrt()));
            } else if let Some(&f) = self.faces.port_faces.get(&face)
                && self.region(tet) == self.faces.port_region
            {
                add(&port.faces[f].conductance);
                for (a, &place) in places.iter().enumerate() {
                    source[place] += 2.0 * port.faces[f].mode[a];
                    observation[place] += port.faces[f].mode[a] / port.admittance;
                }
            }
        }
        (conductance, source, observation)
    }

    /// The numbers of a cell's lane: coefficients, and terms of boundary faces where its block has such.
    #[allow(clippy::cast_possible_truncation, reason = "the field runs in single precision")]
    fn terms(&self, k: usize, x: f64, loss_freq: f64, at_boundary: bool) -> ([f32; 34], [f32; 33]) {
        let (corners, tet) = self.cells[k];
        let cell = self.cell(k);
        // Conductivity over permittivity, as a share of C/x.
        let kappa = TAU * loss_freq / C0 * self.mesh.regions[self.region(tet)].tan_delta * x;
        let mut loss = cell.capacitance * (kappa / x);
        let (mut coefficients, mut terms) = ([0.0; 34], [0.0; 33]);
        let (faces, source, observation) = self.boundary_terms(corners, tet);
        if at_boundary {
            loss += faces;
        } else {
            coefficients[LOSS] = (kappa / (1.0 + kappa)) as f32;
        }
        let c = cell.coefficients(x, &loss);
        for a in 0..6 {
            coefficients[ADMITTANCE + a] = c.y[a] as f32;
            for b in 0..=a {
                coefficients[triangle(a, b)] = c.d[(a, b)] as f32;
                if at_boundary && c.y[a] > 0.0 && c.y[b] > 0.0 {
                    terms[triangle(a, b)] = loss[(a, b)] as f32;
                }
            }
            if at_boundary && c.y[a] > 0.0 {
                terms[SOURCE + a] = source[a] as f32;
                terms[OBSERVATION + a] = observation[a] as f32;
            }
        }
        for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            coefficients[A_INVERSE + triangle(i, j)] = c.a_inverse[(i, j)] as f32;
        }
        (coefficients, terms)
    }
}

fn ascending(mut corners: [VertexId; 4]) -> [VertexId; 4] {
    corners.sort_unstable();
    corners
}

fn morton(cell: DVec3) -> u32 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "scaled to ten bits")]
    let spread = |x: f64| {
        let mut x = (x as u32).min(1023);
        for (shift, mask) in [(16, 0x0300_00ff), (8, 0x0300_f00f), (4, 0x030c_30c3), (2, 0x0924_9249)] {
            x = (x | x << shift) & mask;
        }
        x
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

impl Network {
    /// Computes the coefficients of a mesh with one port.
    ///
    /// # Errors
    /// [`TlmError::NoPort`], [`TlmError::NotCoaxial`], [`TlmError::Cancelled`].
    pub fn new(mesh: &TetMesh, settings: &NetworkSettings, task: &Task) -> Result<Self, TlmError> {
        let phase = task.phase("preparing cells", 3);
        let prepared = Prepared::new(mesh)?;
        phase.advance(1);
        task.check()?;
        let limits: Vec<f64> = (0..prepared.cells.len()).into_par_iter().map(|k| prepared.cell(k).x_max).collect();
        let x = MARGIN * limit(&limits, settings.step);
        let n_clipped = limits.iter().filter(|&&l| x > l).count();
        phase.advance(1);
        task.check()?;
        let slots = Slots::new(&prepared);
        let filled = slots.fill(&prepared, x, settings.loss_freq);
        let (starts, places, weights) = slots.connect(&filled.0);
        phase.advance(1);
        Ok(Self {
            blocks: filled.0,
            boundary: filled.1,
            n_edges: slots.n_edges,
            starts,
            places,
            weights,
            n_tets: mesh.tets.len(),
            dt: 2.0 * x / C0,
            port_impedance: ETA0 / prepared.faces.port.admittance,
            n_clipped,
        })
    }
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

/// Which cell is in which lane of which block, and which edges its ports have.
struct Slots {
    /// By lane over all blocks: number of the cell, `None` for filling.
    cells: Vec<Option<usize>>,
    /// By lane: edges of the ports, `n_edges` for dropped ones.
    edges: Vec<[u32; 6]>,
    n_edges: usize,
    /// Blocks before this one have no boundary faces.
    n_inner_blocks: usize,
}

impl Slots {
    fn new(prepared: &Prepared<'_>) -> Self {
        let n = prepared.cells.len();
        let pad = |count: usize| count.div_ceil(LANES) * LANES;
        let n_inner_lanes = pad(prepared.n_inner);
        let inner = (0..n_inner_lanes).map(|k| (k < prepared.n_inner).then_some(k));
        let rest = (0..pad(n - prepared.n_inner)).map(|k| Some(prepared.n_inner + k).filter(|&k| k < n));
        let cells: Vec<Option<usize>> = inner.chain(rest).collect();
        // Edges by first touch: what a block needs lies close together.
        let mut number: HashMap<[VertexId; 2], u32> = HashMap::with_capacity(2 * n);
        let mut edges = Vec::with_capacity(cells.len());
        for cell in &cells {
            let Some(k) = *cell else {
                edges.push([u32::MAX; 6]);
                continue;
            };
            let (corners, tet) = prepared.cells[k];
            let free = prepared.free(corners, tet);
            edges.push(std::array::from_fn(|e| {
                if !free[e] {
                    return u32::MAX;
                }
                let (i, j) = EDGES[e];
                let next = VertexId::new(number.len()).raw();
                *number.entry([corners[i], corners[j]]).or_insert(next)
            }));
        }
        let n_edges = number.len();
        let none = VertexId::new(n_edges).raw();
        edges.iter_mut().flatten().filter(|e| **e == u32::MAX).for_each(|e| *e = none);
        Self { cells, edges, n_edges, n_inner_blocks: n_inner_lanes / LANES }
    }

    fn fill(&self, prepared: &Prepared<'_>, x: f64, loss_freq: f64) -> (Vec<Block>, Vec<Boundary>) {
        let lanes = self.cells.par_chunks(LANES).zip(self.edges.par_chunks(LANES)).enumerate();
        let blocks = lanes.map(|(b, (cells, edges))| {
            let mut block = Block { coefficients: [[0.0; LANES]; 34], edges: [[0; LANES]; 6] };
            let mut boundary = Boundary { terms: [[0.0; LANES]; 33] };
            for (w, (cell, ports)) in cells.iter().zip(edges).enumerate() {
                (0..6).for_each(|e| block.edges[e][w] = ports[e]);
                if let Some(k) = *cell {
                    let (coefficients, terms) = prepared.terms(k, x, loss_freq, b >= self.n_inner_blocks);
                    block.coefficients.iter_mut().zip(coefficients).for_each(|(lane, value)| lane[w] = value);
                    boundary.terms.iter_mut().zip(terms).for_each(|(lane, value)| lane[w] = value);
                }
            }
            (block, boundary)
        });
        let all: Vec<(Block, Boundary)> = blocks.collect();
        let boundary = all[self.n_inner_blocks..].iter().map(|(_, boundary)| boundary.clone()).collect();
        (all.into_iter().map(|(block, _)| block).collect(), boundary)
    }

    /// For each edge its ports' places in the state, and `2 / sum Y`.
    fn connect(&self, blocks: &[Block]) -> (Vec<u32>, Vec<u32>, Vec<f32>) {
        let mut starts = vec![0_u32; self.n_edges + 1];
        let live = |edge: u32| (edge as usize) < self.n_edges;
        self.edges.iter().flatten().filter(|e| live(**e)).for_each(|&e| starts[e as usize + 1] += 1);
        (0..self.n_edges).for_each(|e| starts[e + 1] += starts[e]);
        let mut next = starts.clone();
        let mut places = vec![0_u32; starts[self.n_edges] as usize];
        let mut sums = vec![0.0_f64; self.n_edges];
        for (lane, ports) in self.edges.iter().enumerate() {
            let (b, w) = (lane / LANES, lane % LANES);
            for (e, &edge) in ports.iter().enumerate().filter(|(_, edge)| live(**edge)) {
                let place = (b * 6 + e) * LANES + w;
                places[next[edge as usize] as usize] = VertexId::new(place).raw();
                next[edge as usize] += 1;
                sums[edge as usize] += f64::from(blocks[b].coefficients[ADMITTANCE + e][w]);
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "the field runs in single precision")]
        let weights = sums.iter().map(|s| (2.0 / s) as f32).collect();
        (starts, places, weights)
    }
}
