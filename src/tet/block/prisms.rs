//! Prisms over the footprint's triangles, each split into three tetrahedra.
//!
//! A split is given by a diagonal on each side wall, and a wall's diagonal by a direction of its footprint edge: it
//! rises from the lower end of the start to the upper end of the goal. If the three directions around a triangle are
//! no cycle, they order its columns i, j, k, and the tetrahedra are (i, j, k, k'), (i, j, j', k'), (i, i', j', k').
//! Both prisms at a wall use its one diagonal, so they always match.
//!
//! In each layer the directions start from the columns' numbers and are changed triangle by triangle while that opens
//! the smallest dihedral angles there, as the map carried them: where it shears the sheet, the better diagonals follow.

use super::footprint::Footprint;
use super::layers::Layers;
use crate::geometry::{DVec3, RegionId, VertexId};
use crate::tet::{FACES, Tet, volume};
use std::collections::{BTreeMap, HashMap};

/// Sweeps over all triangles in choosing directions; it settles in a few.
const MAX_SWEEPS: usize = 40;
/// Exponent of a dihedral angle in the cost of a split: high enough that the smallest angles rule.
const POWER: i32 = 6;
/// Cost of a tetrahedron that the map turned over: above any other, but below a cycle's.
const TURNED_OVER: f64 = 1e60;

/// All prisms of the block.
#[derive(Debug, Default)]
pub(super) struct Prisms {
    /// Positions of their corners in the flat antenna, m.
    pub(super) flat: Vec<DVec3>,
    /// The plane of each corner.
    pub(super) plane: Vec<usize>,
    /// By layer.
    layers: Vec<Vec<Prism>>,
    /// For each resistor the corners above its place, from the ground up to the patch.
    pub(super) posts: Vec<Vec<VertexId>>,
}

/// The block over one triangle in one layer.
#[derive(Clone, Copy, Debug)]
struct Prism {
    /// The footprint's triangle.
    triangle: usize,
    region: RegionId,
    /// Corners 0, 1, 2 lie below 3, 4, 5.
    corners: [VertexId; 6],
}

/// Tetrahedra, and the footprint's triangle below each.
#[derive(Debug, Default)]
pub(super) struct Split {
    pub(super) tets: Vec<Tet>,
    pub(super) triangle: Vec<usize>,
}

impl Prisms {
    /// Extrudes the footprint through the layers.
    pub(super) fn new(print: &Footprint, layers: &Layers) -> Self {
        let mut prisms = Self::default();
        let mut columns: HashMap<(usize, usize), VertexId> = HashMap::new();
        for layer in 0..layers.planes.len() - 1 {
            let mut in_layer = Vec::new();
            for (t, triangle) in print.triangles.iter().enumerate() {
                let Some(region) = layers.region(layer, print.covers[t]) else { continue };
                let mut corner = |k: usize| {
                    let (point, plane) = (triangle[k % 3], layer + k / 3);
                    *columns.entry((point, plane)).or_insert_with(|| {
                        prisms.flat.push(print.points[point].extend(layers.planes[plane]));
                        prisms.plane.push(plane);
                        VertexId::new(prisms.flat.len() - 1)
                    })
                };
                let corners = [0, 1, 2, 3, 4, 5].map(&mut corner);
                in_layer.push(Prism { triangle: t, region, corners });
            }
            prisms.layers.push(in_layer);
        }
        let column = |post: &usize| (layers.ground_plane..=layers.patch_plane).map(|z| columns[&(*post, z)]).collect();
        prisms.posts = print.posts.iter().map(column).collect();
        prisms
    }

    /// Splits all prisms, their corners being at `positions`, m.
    pub(super) fn split(&self, print: &Footprint, positions: &[DVec3]) -> Split {
        let walls = Walls::new(print);
        let mut split = Split::default();
        for in_layer in &self.layers {
            let mut costs = vec![None; print.triangles.len()];
            for prism in in_layer {
                costs[prism.triangle] = Some(turn_costs(prism.corners.map(|v| positions[v.index()])));
            }
            let turns = walls.choose(print, &costs);
            for prism in in_layer {
                for corners in SPLITS[turns[prism.triangle]] {
                    split.tets.push(Tet { vertices: corners.map(|k| prism.corners[k]), region: prism.region });
                    split.triangle.push(prism.triangle);
                }
            }
        }
        split
    }
}

/// The positive tetrahedra of a prism for each turn. Bit k of a turn: the edge from corner k to corner k + 1 is directed
/// that way; 0 and 7 are cycles and stand empty.
const SPLITS: [[[usize; 4]; 3]; 8] = {
    let mut splits = [[[0; 4]; 3]; 8];
    let mut turn = 1;
    while turn < 7 {
        // The start of the order has both its edges directed away from it.
        let start = match turn {
            1 | 3 => 0,
            2 | 6 => 1,
            _ => 2,
        };
        let (a, b) = ((start + 1) % 3, (start + 2) % 3);
        let straight = (turn >> a) & 1 == 1;
        let (i, j, k) = if straight { (start, a, b) } else { (start, b, a) };
        splits[turn] = if straight {
            [[i, j, k, k + 3], [j, i, j + 3, k + 3], [i, i + 3, j + 3, k + 3]]
        } else {
            [[j, i, k, k + 3], [i, j, j + 3, k + 3], [i + 3, i, j + 3, k + 3]]
        };
        turn += 1;
    }
    splits
};

/// The footprint's edges: one wall each in every layer.
struct Walls {
    /// The edge from corner k to corner k + 1 of each triangle.
    of_triangle: Vec<[usize; 3]>,
    /// The triangles on both sides of each edge.
    sides: Vec<Vec<usize>>,
    /// The ends of each edge, by number.
    ends: Vec<(usize, usize)>,
}

impl Walls {
    fn new(print: &Footprint) -> Self {
        let mut numbers: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut walls = Self { of_triangle: Vec::new(), sides: Vec::new(), ends: Vec::new() };
        for (t, triangle) in print.triangles.iter().enumerate() {
            let of_triangle = [0, 1, 2].map(|k| {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                let wall = *numbers.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    walls.sides.push(Vec::new());
                    walls.ends.push((a.min(b), a.max(b)));
                    walls.sides.len() - 1
                });
                walls.sides[wall].push(t);
                wall
            });
            walls.of_triangle.push(of_triangle);
        }
        walls
    }

    /// The turn of each triangle, given the costs of all turns of those with a prism.
    fn choose(&self, print: &Footprint, costs: &[Option<[f64; 8]>]) -> Vec<usize> {
        let mut forward = vec![true; self.ends.len()];
        for _ in 0..MAX_SWEEPS {
            let mut changed = false;
            for t in (0..costs.len()).filter(|&t| costs[t].is_some()) {
                changed |= self.improve(print, costs, t, &mut forward);
            }
            if !changed {
                break;
            }
        }
        (0..costs.len()).map(|t| self.turn(print, t, &forward)).collect()
    }

    /// The turn of a triangle; `forward` directs an edge from its lower to its higher end.
    fn turn(&self, print: &Footprint, t: usize, forward: &[bool]) -> usize {
        let triangle = print.triangles[t];
        (0..3)
            .map(|k| {
                let wall = self.of_triangle[t][k];
                usize::from(forward[wall] == (self.ends[wall].0 == triangle[k])) << k
            })
            .sum()
    }

    /// Gives a triangle the turn that costs it and its neighbors least; true if that changes it.
    fn improve(&self, print: &Footprint, costs: &[Option<[f64; 8]>], t: usize, forward: &mut [bool]) -> bool {
        let walls = self.of_triangle[t];
        let around = |forward: &[bool]| -> f64 {
            let cost = |s: usize| costs[s].map_or(0.0, |turns| turns[self.turn(print, s, forward)]);
            let neighbors = walls.iter().flat_map(|&w| &self.sides[w]).filter(|&&s| s != t);
            cost(t) + neighbors.map(|&s| cost(s)).sum::<f64>()
        };
        let kept = walls.map(|w| forward[w]);
        let mut best = (around(forward), kept);
        for choice in 0..8_u8 {
            for (k, &wall) in walls.iter().enumerate() {
                forward[wall] = (choice >> k) & 1 == 1;
            }
            let cost = around(forward);
            // Beyond rounding, so that two equal choices cannot alternate.
            if cost < best.0 * (1.0 - 1e-9) {
                best = (cost, walls.map(|w| forward[w]));
            }
        }
        walls.iter().zip(best.1).for_each(|(&w, f)| forward[w] = f);
        best.1 != kept
    }
}

/// Cost of each turn of a prism: high for small dihedral angles, infinite for cycles.
fn turn_costs(prism: [DVec3; 6]) -> [f64; 8] {
    let cost = |tet: &[usize; 4]| {
        let corners = tet.map(|k| prism[k]);
        if volume(corners) > 0.0 { smallest_dihedral(corners).powi(-POWER).min(TURNED_OVER) } else { TURNED_OVER }
    };
    let mut costs = [f64::INFINITY; 8];
    for turn in 1..7 {
        costs[turn] = SPLITS[turn].iter().map(cost).sum();
    }
    costs
}

/// Smallest angle between two faces of a tetrahedron, radians.
pub(super) fn smallest_dihedral(corners: [DVec3; 4]) -> f64 {
    let normal = FACES.map(|face| {
        let [a, b, c] = face.map(|k| corners[k]);
        (b - a).cross(c - a).normalize_or_zero()
    });
    let pairs = (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j)));
    let largest_cosine = pairs.map(|(i, j)| -normal[i].dot(normal[j])).fold(-1.0, f64::max);
    largest_cosine.min(1.0).acos()
}
