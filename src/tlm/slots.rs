//! Where everything is in memory: cells in lanes of blocks, blocks in chunks, edges by the chunk that they belong to.
//!
//! A chunk is what one thread works on at a time: it scatters in its blocks and at once connects the edges that no other
//! chunk has, while what its cells reflect is still in the cache. Edges of several chunks come last.

use super::TlmError;
use super::assembly::{Assembly, N_PARTS};
use super::blocks::{ADMITTANCE, Block, Boundary, LANES};
use super::cell::EDGES;
use super::network::{Gap, Lossy};
use super::real::Real;
use crate::geometry::VertexId;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Blocks in a chunk: more share fewer edges, fewer stay in the cache and keep many threads busy.
const CHUNK: usize = 512;

/// Neighboring blocks, and the edges that only they have.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    pub(super) blocks: Range<usize>,
    pub(super) edges: Range<usize>,
}

/// Which cell is in which lane of which block, and which edges its ports have.
pub(super) struct Slots {
    /// By lane over all blocks: number of the cell, `None` for filling.
    pub(super) cells: Vec<Option<usize>>,
    /// By lane: edges of the ports, `n_edges` for dropped ones.
    pub(super) edges: Vec<[u32; 6]>,
    pub(super) n_edges: usize,
    /// Ends of each edge, ascending.
    pub(super) edge_ends: Vec<[VertexId; 2]>,
    /// Blocks before the first of these have no boundary faces, those from the second on lie at the outer boundary.
    pub(super) ends: [usize; 2],
    pub(super) chunks: Vec<Chunk>,
}

/// Chunks of blocks, those of each part apart from the others; and the final number of each edge.
///
/// * `edges`: by lane, numbered by first touch.
fn chunks(edges: &[[u32; 6]], ends: [usize; 2], n_edges: usize) -> (Vec<Chunk>, Vec<u32>) {
    let n_blocks = edges.len() / LANES;
    let ranges = |from: usize, to: usize| (from..to).step_by(CHUNK).map(move |b| b..(b + CHUNK).min(to));
    let blocks: Vec<Range<usize>> = [(0, ends[0]), (ends[0], ends[1]), (ends[1], n_blocks)]
        .into_iter()
        .flat_map(|(from, to)| ranges(from, to))
        .collect();
    // The chunk of each edge; the number of chunks for those of several.
    let mut owner = vec![usize::MAX; n_edges];
    for (c, range) in blocks.iter().enumerate() {
        let lanes = &edges[range.start * LANES..range.end * LANES];
        for &edge in lanes.as_flattened().iter().filter(|e| **e != u32::MAX) {
            let owner = &mut owner[edge as usize];
            *owner = if *owner == usize::MAX || *owner == c { c } else { blocks.len() };
        }
    }
    let mut by_owner: Vec<usize> = (0..n_edges).collect();
    by_owner.sort_by_key(|&e| owner[e]);
    let mut order = vec![0; n_edges];
    by_owner.iter().enumerate().for_each(|(k, &e)| order[e] = VertexId::new(k).raw());
    let first = |c: usize| by_owner.partition_point(|&e| owner[e] < c);
    let chunk = |(c, blocks): (usize, Range<usize>)| Chunk { blocks, edges: first(c)..first(c + 1) };
    (blocks.into_iter().enumerate().map(chunk).collect(), order)
}

impl Slots {
    pub(super) fn new(assembly: &Assembly<'_>) -> Self {
        let n = assembly.cells.len();
        let mut cells: Vec<Option<usize>> = Vec::with_capacity(n + N_PARTS * LANES);
        let mut from = 0;
        let of_parts = assembly.ends.map(|to| {
            cells.extend((from..to).map(Some));
            cells.resize(cells.len().next_multiple_of(LANES), None);
            from = to;
            cells.len() / LANES
        });
        let ends = [of_parts[0], of_parts[1]];
        // Edges by first touch: what a block needs lies close together.
        let mut number: HashMap<[VertexId; 2], u32> = HashMap::with_capacity(2 * n);
        let mut edges = Vec::with_capacity(cells.len());
        for cell in &cells {
            let Some(k) = *cell else {
                edges.push([u32::MAX; 6]);
                continue;
            };
            let (corners, tet) = assembly.cells[k];
            let free = assembly.free(corners, tet);
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
        let (chunks, order) = chunks(&edges, ends, n_edges);
        let mut edge_ends: Vec<[VertexId; 2]> = vec![[VertexId::new(0); 2]; n_edges];
        number.into_iter().for_each(|(edge, k)| edge_ends[order[k as usize] as usize] = edge);
        let none = VertexId::new(n_edges).raw();
        edges.iter_mut().flatten().for_each(|e| *e = order.get(*e as usize).copied().unwrap_or(none));
        Self { cells, edges, n_edges, edge_ends, ends, chunks }
    }

    pub(super) fn tets(&self, assembly: &Assembly<'_>) -> Vec<u32> {
        self.cells.iter().map(|k| k.map_or(u32::MAX, |k| VertexId::new(assembly.cells[k].1).raw())).collect()
    }

    pub(super) fn lossy(&self, assembly: &Assembly<'_>) -> Vec<Lossy> {
        let lanes = self.cells.par_iter().enumerate();
        let lossy = lanes.filter_map(|(lane, k)| {
            let matrix = assembly.dissipation((*k)?)?;
            let mut conductance = [0.0; 21];
            let places = (0..6).flat_map(|a| (0..=a).map(move |b| (a, b)));
            conductance.iter_mut().zip(places).for_each(|(g, place)| *g = matrix[place]);
            Some(Lossy { lane, conductance })
        });
        lossy.collect()
    }

    pub(super) fn resistors(&self, assembly: &Assembly<'_>) -> Vec<(u32, f64)> {
        let edges = (0..).zip(&self.edge_ends).map(|(k, &edge)| (k, assembly.conductance(edge)));
        edges.filter(|(_, conductance)| *conductance > 0.0).collect()
    }

    /// The edges of the lumped port, if there is one.
    ///
    /// # Errors
    /// [`TlmError::NoGap`]
    pub(super) fn gap(&self, assembly: &Assembly<'_>) -> Result<Option<Gap>, TlmError> {
        let Some(port) = assembly.lumped_port() else { return Ok(None) };
        let edge = |pair: &[VertexId]| {
            let ends = [pair[0].min(pair[1]), pair[0].max(pair[1])];
            let number = (0..).zip(&self.edge_ends).find(|(_, e)| **e == ends)?.0;
            Some((number, if pair[0] < pair[1] { 1.0 } else { -1.0 }))
        };
        let edges: Option<Vec<_>> = port.chain.windows(2).map(edge).collect();
        let edges = edges.filter(|e| !e.is_empty()).ok_or(TlmError::NoGap)?;
        Ok(Some(Gap { edges, resistance: port.resistance }))
    }

    pub(super) fn fill<T: Real>(&self, assembly: &Assembly<'_>, x: f64) -> (Vec<Block<T>>, Vec<Boundary<T>>) {
        let lanes = self.cells.par_chunks(LANES).zip(self.edges.par_chunks(LANES)).enumerate();
        let blocks = lanes.map(|(b, (cells, edges))| {
            let mut block = Block { coefficients: [[T::default(); LANES]; 34], edges: [[0; LANES]; 6] };
            let mut boundary = (b >= self.ends[0]).then(|| Boundary { conductance: [[T::default(); LANES]; 21] });
            for (w, (cell, ports)) in cells.iter().zip(edges).enumerate() {
                (0..6).for_each(|e| block.edges[e][w] = ports[e]);
                if let Some(k) = *cell {
                    let terms = assembly.terms(k, x, boundary.is_some());
                    block.coefficients.iter_mut().zip(terms.coefficients).for_each(|(lane, c)| lane[w] = T::new(c));
                    let lanes = boundary.iter_mut().flat_map(|b| &mut b.conductance);
                    lanes.zip(terms.conductance).for_each(|(lane, c)| lane[w] = T::new(c));
                }
            }
            (block, boundary)
        });
        let (blocks, boundary): (Vec<Block<T>>, Vec<Option<Boundary<T>>>) = blocks.unzip();
        (blocks, boundary.into_iter().flatten().collect())
    }

    /// For each edge its ports' places in the state, and `2 / (sum Y + conductance of resistors)`.
    pub(super) fn connect<T: Real>(
        &self,
        blocks: &[Block<T>],
        assembly: &Assembly<'_>,
    ) -> (Vec<u32>, Vec<u32>, Vec<T>) {
        let mut starts = vec![0_u32; self.n_edges + 1];
        let live = |edge: u32| (edge as usize) < self.n_edges;
        self.edges.iter().flatten().filter(|e| live(**e)).for_each(|&e| starts[e as usize + 1] += 1);
        (0..self.n_edges).for_each(|e| starts[e + 1] += starts[e]);
        let mut next = starts.clone();
        let mut places = vec![0_u32; starts[self.n_edges] as usize];
        let source = assembly.source();
        let at_edge = |edge| assembly.conductance(edge) + source.get(&edge).copied().unwrap_or(0.0);
        let mut sums: Vec<f64> = self.edge_ends.iter().map(|&edge| at_edge(edge)).collect();
        for (lane, ports) in self.edges.iter().enumerate() {
            let (b, w) = (lane / LANES, lane % LANES);
            for (e, &edge) in ports.iter().enumerate().filter(|(_, edge)| live(**edge)) {
                let place = (b * 6 + e) * LANES + w;
                places[next[edge as usize] as usize] = VertexId::new(place).raw();
                next[edge as usize] += 1;
                sums[edge as usize] += blocks[b].coefficients[ADMITTANCE + e][w].to_f64();
            }
        }
        let weights = sums.iter().map(|s| T::new(2.0 / s)).collect();
        (starts, places, weights)
    }
}
