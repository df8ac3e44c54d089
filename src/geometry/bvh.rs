//! A bounding-volume hierarchy over triangles: which pairs may touch, and which triangles a segment's box meets.
//!
//! Built by splitting the longest axis of the centroids' box at its median; leaves hold a few
//! triangles. The order of what is reported depends on the input alone.

use super::DVec3;

/// Triangles per leaf: fewer doubles the tree's memory, more tests boxes that a split would have told apart.
const LEAF_SIZE: usize = 4;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub lo: DVec3,
    /// Greatest coordinates.
    pub hi: DVec3,
}

impl Aabb {
    const EMPTY: Self = Self { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    /// The smallest box around some points.
    #[must_use]
    pub fn around(points: &[DVec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, &p| Self { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    /// True if the closed boxes have a point in common.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.lo.cmple(other.hi).all() && other.lo.cmple(self.hi).all()
    }

    fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }
}

#[derive(Clone, Debug)]
enum Node {
    Leaf {
        bounds: Aabb,
        first: usize,
        count: usize,
    },
    /// The left child follows its parent; `right` is the index of the other.
    Inner {
        bounds: Aabb,
        right: usize,
    },
}

impl Node {
    fn bounds(&self) -> &Aabb {
        match self {
            Self::Leaf { bounds, .. } | Self::Inner { bounds, .. } => bounds,
        }
    }
}

/// The hierarchy; elements are numbered as in the slice it was built from.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    order: Vec<usize>,
    boxes: Vec<Aabb>,
}

impl Bvh {
    /// Builds the hierarchy over the boxes of triangles (or of anything else).
    #[must_use]
    pub fn new(boxes: Vec<Aabb>) -> Self {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        let mut nodes = Vec::with_capacity(boxes.len());
        if !boxes.is_empty() {
            let n = order.len();
            build(&boxes, &mut order, 0, n, &mut nodes);
        }
        Self { nodes, order, boxes }
    }

    /// Calls `visit` with every element whose box meets `query`.
    pub fn for_each_meeting(&self, query: &Aabb, mut visit: impl FnMut(usize)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = vec![0];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at];
            if !node.bounds().meets(query) {
                continue;
            }
            match node {
                Node::Inner { right, .. } => stack.extend([*right, at + 1]),
                Node::Leaf { first, count, .. } => {
                    for &element in &self.order[*first..first + count] {
                        if self.boxes[element].meets(query) {
                            visit(element);
                        }
                    }
                }
            }
        }
    }
}

fn build(boxes: &[Aabb], order: &mut [usize], first: usize, count: usize, nodes: &mut Vec<Node>) {
    let range = first..first + count;
    let bounds = order[range.clone()].iter().fold(Aabb::EMPTY, |b, &e| b.union(boxes[e]));
    if count <= LEAF_SIZE {
        nodes.push(Node::Leaf { bounds, first, count });
        return;
    }
    let center = |e: usize| boxes[e].lo + boxes[e].hi;
    let spread = order[range.clone()].iter().fold(Aabb::EMPTY, |b, &e| b.union(Aabb { lo: center(e), hi: center(e) }));
    let extent = spread.hi - spread.lo;
    let axis = if extent.x >= extent.y && extent.x >= extent.z { 0 } else { 1 + usize::from(extent.z > extent.y) };
    // Ties are broken by the element's number, so the tree depends on the input alone.
    let key = |e: &usize| (center(*e)[axis], *e);
    let middle = count / 2;
    order[range].select_nth_unstable_by(middle, |a, b| key(a).partial_cmp(&key(b)).unwrap_or(a.cmp(b)));
    let at = nodes.len();
    nodes.push(Node::Inner { bounds, right: 0 });
    build(boxes, order, first, middle, nodes);
    let right = nodes.len();
    nodes[at] = Node::Inner { bounds, right };
    build(boxes, order, first + middle, count - middle, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_find_what_brute_force_finds() {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut random_box = || {
            let p = DVec3::new(rng.f64(), rng.f64(), rng.f64());
            Aabb { lo: p, hi: p + DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 0.1 }
        };
        let boxes: Vec<_> = (0..500).map(|_| random_box()).collect();
        let bvh = Bvh::new(boxes.clone());
        for _ in 0..50 {
            let query = random_box();
            let mut found = Vec::new();
            bvh.for_each_meeting(&query, |e| found.push(e));
            found.sort_unstable();
            let brute: Vec<_> = (0..boxes.len()).filter(|&e| boxes[e].meets(&query)).collect();
            assert_eq!(found, brute, "same elements as a plain loop");
        }
    }
}
