//! Mirror symmetry of edits: what is done to a vertex is done, mirrored, to its partner on the other side.
//!
//! Enters: displacements of vertices, each with the weight of its share in the edit. Leaves: displacements that are
//! symmetric about the mid-planes asked for. Of a pair the vertex with the greater weight leads; where both weigh the
//! same, the one on the leading side. A vertex on a mid-plane stays on it.

use super::build::Cage;
use super::select::Selection;
use crate::geometry::DVec3;
use std::collections::{BTreeMap, HashMap};

/// The displacement of one vertex in an edit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The vertex.
    pub vertex: u32,
    /// 1 for a selected vertex, less for one that is carried along.
    pub weight: f64,
    /// How far it is moved, in any unit of length.
    pub by: DVec3,
}

/// The mid-planes about which edits are mirrored, and the side that leads where both sides are edited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mirror {
    /// About the planes x = 0 and y = 0.
    pub axes: [bool; 2],
    /// Whether the side of negative x or y leads.
    pub negative_leads: [bool; 2],
}

impl Mirror {
    /// Lets the side lead on which a vertex lies.
    #[must_use]
    pub fn led_by(mut self, cage: &Cage, vertex: u32) -> Self {
        if let Some(place) = cage.lattice.get(vertex as usize) {
            self.negative_leads = [0, 1].map(|axis| side(cage, *place, axis) < 0);
        }
        self
    }

    /// The vertices together with their partners.
    #[must_use]
    pub fn with_partners(self, cage: &Cage, chosen: &Selection) -> Selection {
        let number = numbers(cage);
        let mut all = chosen.clone();
        for axis in self.planes() {
            let partner = |v: &u32| partner(cage, &number, *v, axis);
            all = all.iter().copied().chain(all.iter().filter_map(partner)).collect();
        }
        all
    }

    /// Makes displacements symmetric.
    #[must_use]
    pub fn applied(self, cage: &Cage, shares: Vec<Share>) -> Vec<Share> {
        if self.axes == [false; 2] {
            return shares;
        }
        let number = numbers(cage);
        self.planes().fold(shares, |shares, axis| self.about(cage, &number, axis, &shares))
    }

    fn planes(self) -> impl Iterator<Item = usize> {
        (0..2).filter(move |&axis| self.axes[axis])
    }

    fn about(self, cage: &Cage, number: &HashMap<[usize; 3], u32>, axis: usize, shares: &[Share]) -> Vec<Share> {
        let weights: HashMap<u32, f64> = shares.iter().map(|s| (s.vertex, s.weight)).collect();
        let mut new = BTreeMap::new();
        for share in shares {
            let Some(place) = cage.lattice.get(share.vertex as usize) else { continue };
            let Some(partner) = partner(cage, number, share.vertex, axis) else { continue };
            let mut mirrored = share.by;
            mirrored[axis] = 0.0 - mirrored[axis];
            if partner == share.vertex {
                mirrored[axis] = 0.0;
                new.insert(partner, Share { by: mirrored, ..*share });
                continue;
            }
            let other = weights.get(&partner).copied().unwrap_or(0.0);
            let is_leading_side = (side(cage, *place, axis) < 0) == self.negative_leads[axis];
            if share.weight > other || (share.weight >= other && is_leading_side) {
                new.insert(share.vertex, *share);
                new.insert(partner, Share { vertex: partner, by: mirrored, ..*share });
            }
        }
        new.into_values().collect()
    }
}

fn numbers(cage: &Cage) -> HashMap<[usize; 3], u32> {
    cage.lattice.iter().copied().zip(0..).collect()
}

/// Negative on the side of negative coordinates, 0 on the mid-plane.
fn side(cage: &Cage, place: [usize; 3], axis: usize) -> i8 {
    match (2 * place[axis]).cmp(&cage.segments[axis]) {
        std::cmp::Ordering::Less => -1,
        std::cmp::Ordering::Equal => 0,
        std::cmp::Ordering::Greater => 1,
    }
}

/// The vertex on the other side of a mid-plane; a vertex on the plane is its own partner.
fn partner(cage: &Cage, number: &HashMap<[usize; 3], u32>, vertex: u32, axis: usize) -> Option<u32> {
    let mut place = *cage.lattice.get(vertex as usize)?;
    place[axis] = cage.segments[axis] - place[axis];
    number.get(&place).copied()
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::paper_cage;
    use super::*;

    const BOTH: Mirror = Mirror { axes: [true; 2], negative_leads: [false; 2] };

    fn at(cage: &Cage, place: [usize; 3]) -> u32 {
        numbers(cage)[&place]
    }

    fn displaced(cage: &Cage, shares: &[Share]) -> Vec<DVec3> {
        let mut vertices = cage.mesh.vertices[..cage.n_handles()].to_vec();
        shares.iter().for_each(|s| vertices[s.vertex as usize] += s.by);
        vertices
    }

    /// Greatest distance of a vertex from the mirror image of its partner.
    fn asymmetry(cage: &Cage, vertices: &[DVec3], axis: usize) -> f64 {
        let number = numbers(cage);
        let gap = |v: u32| {
            let mut image = vertices[partner(cage, &number, v, axis).expect("a partner") as usize];
            image[axis] *= -1.0;
            vertices[v as usize].distance(image)
        };
        (0..).take(vertices.len()).map(gap).fold(0.0, f64::max)
    }

    #[test]
    fn mirrored_edits_leave_the_cage_symmetric() {
        let mut rng = fastrand::Rng::with_seed(3);
        for segments in [[10, 4], [3, 5], [4, 1]] {
            let cage = paper_cage(3.0, segments);
            let count = u32::try_from(cage.n_handles()).expect("few");
            let mut random = || DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 1e-3;
            let shares: Vec<Share> = (0..count)
                .step_by(3)
                .map(|vertex| Share { vertex, weight: f64::from(vertex % 5) / 4.0, by: random() })
                .collect();
            let symmetric = displaced(&cage, &BOTH.applied(&cage, shares.clone()));
            assert!((0..2).all(|axis| asymmetry(&cage, &symmetric, axis) < 1e-15), "{segments:?}");
            assert_eq!(Mirror::default().applied(&cage, shares.clone()), shares, "off: as it was");
        }
    }

    #[test]
    fn one_vertex_takes_its_three_partners_along() {
        let cage = paper_cage(3.0, [10, 4]);
        let by = DVec3::new(0.1, 0.2, 0.3);
        let share = Share { vertex: at(&cage, [1, 1, 1]), weight: 1.0, by };
        let found = BOTH.applied(&cage, vec![share]);
        assert_eq!(found.len(), 4, "{found:?}");
        let opposite = found.iter().find(|s| s.vertex == at(&cage, [9, 3, 1])).expect("across both planes");
        assert_eq!(opposite.by, DVec3::new(-0.1, -0.2, 0.3), "mirrored twice");
        let partners = BOTH.with_partners(&cage, &[share.vertex].into());
        assert_eq!(partners, found.iter().map(|s| s.vertex).collect(), "the same four");
    }

    #[test]
    fn the_grabbed_side_leads_where_both_are_selected() {
        let cage = paper_cage(3.0, [10, 4]);
        let [left, right] = [at(&cage, [1, 2, 1]), at(&cage, [9, 2, 1])];
        let x = Mirror { axes: [true, false], ..Mirror::default() };
        let shares = || [left, right].map(|vertex| Share { vertex, weight: 1.0, by: DVec3::X }).to_vec();
        for grabbed in [left, right] {
            let found = x.led_by(&cage, grabbed).applied(&cage, shares());
            for share in found {
                let sign = if share.vertex == grabbed { 1.0 } else { -1.0 };
                assert_eq!(share.by, sign * DVec3::X, "grabbed {grabbed}, vertex {}", share.vertex);
            }
        }
    }

    #[test]
    fn a_vertex_on_the_plane_stays_on_it() {
        let cage = paper_cage(3.0, [10, 4]);
        let x = Mirror { axes: [true, false], ..Mirror::default() };
        let vertex = at(&cage, [5, 0, 0]);
        let found = x.applied(&cage, vec![Share { vertex, weight: 1.0, by: DVec3::ONE }]);
        assert_eq!(found, [Share { vertex, weight: 1.0, by: DVec3::new(0.0, 1.0, 1.0) }], "no motion across");
    }
}
