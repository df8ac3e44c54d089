//! Sets of cage vertices by their place in the lattice: stations, rows, columns, layers, neighbors, the rest.
//!
//! Enters: a cage and the vertices chosen so far. Leaves: the new choice, in ascending order. A vertex that the cage
//! does not have is left out.

use super::build::Cage;
use super::preset::Axis;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Cage vertices, by number.
pub type Selection = BTreeSet<u32>;

/// What the vertices that are added have in common with one that is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Like {
    /// The place along an axis: a station, all around the sheet.
    Station(Axis),
    /// The place along y and the layer: a line of vertices along x.
    Row,
    /// The place along x and the layer: a line of vertices along y.
    Column,
}

/// The top or the bottom of a cage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Below the antenna.
    Bottom,
    /// Above it.
    Top,
}

impl Cage {
    /// The vertices that are like a chosen one, and those themselves.
    #[must_use]
    pub fn select_like(&self, chosen: &Selection, like: Like) -> Selection {
        let key = |[i, j, k]: [usize; 3]| match like {
            Like::Station(Axis::X) => [i, 0],
            Like::Station(Axis::Y) => [j, 0],
            Like::Row => [j, k],
            Like::Column => [i, k],
        };
        let keys: HashSet<[usize; 2]> = self.places(chosen).map(key).collect();
        self.where_place(|place| keys.contains(&key(place)))
    }

    /// All vertices of a layer.
    #[must_use]
    pub fn select_layer(&self, layer: Layer) -> Selection {
        self.where_place(|[_, _, k]| (k == 1) == (layer == Layer::Top))
    }

    /// All vertices.
    #[must_use]
    pub fn select_all(&self) -> Selection {
        self.where_place(|_| true)
    }

    /// The vertices that are not chosen.
    #[must_use]
    pub fn select_inverse(&self, chosen: &Selection) -> Selection {
        self.select_all().difference(chosen).copied().collect()
    }

    /// Adds the neighbors along the edges on the cage's surface.
    #[must_use]
    pub fn select_more(&self, chosen: &Selection) -> Selection {
        let beside = self.surface_neighbors().into_iter().filter(|[a, _]| chosen.contains(a)).map(|[_, b]| b);
        let own = chosen.iter().copied().filter(|&v| (v as usize) < self.n_handles());
        own.chain(beside).collect()
    }

    /// Takes away the vertices with a neighbor that is not chosen.
    #[must_use]
    pub fn select_less(&self, chosen: &Selection) -> Selection {
        let edges = self.surface_neighbors();
        let rim: HashSet<u32> = edges.iter().filter(|[_, b]| !chosen.contains(b)).map(|[a, _]| *a).collect();
        let own = chosen.iter().copied().filter(|&v| (v as usize) < self.n_handles());
        own.filter(|v| !rim.contains(v)).collect()
    }

    fn where_place(&self, keep: impl Fn([usize; 3]) -> bool) -> Selection {
        (0..).zip(&self.lattice).filter(|(_, place)| keep(**place)).map(|(v, _)| v).collect()
    }

    fn places(&self, chosen: &Selection) -> impl Iterator<Item = [usize; 3]> {
        chosen.iter().filter_map(|&v| self.lattice.get(v as usize).copied())
    }

    /// Both directions of every edge on the surface: one from bottom to top runs inside unless it is at the rim.
    fn surface_neighbors(&self) -> Vec<[u32; 2]> {
        let number: HashMap<[usize; 3], u32> = self.lattice.iter().copied().zip(0..).collect();
        let mut edges = Vec::new();
        for (&[i, j, k], &from) in &number {
            let is_rim = i == 0 || j == 0 || i == self.segments[0] || j == self.segments[1];
            let up = is_rim.then_some([i, j, k + 1]);
            for next in [Some([i + 1, j, k]), Some([i, j + 1, k]), up].into_iter().flatten() {
                if let Some(&to) = number.get(&next) {
                    edges.extend([[from, to], [to, from]]);
                }
            }
        }
        edges
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::paper_cage;
    use super::*;

    fn at(cage: &Cage, place: [usize; 3]) -> u32 {
        (0..).zip(&cage.lattice).find(|(_, p)| **p == place).expect("a place of the lattice").0
    }

    #[test]
    fn stations_rows_columns_and_layers_have_their_sizes_and_hold_what_was_chosen() {
        let cage = paper_cage(3.0, [10, 4]);
        let chosen: Selection = [at(&cage, [3, 1, 1])].into();
        let cases =
            [(Like::Station(Axis::X), 2 * 5), (Like::Station(Axis::Y), 2 * 11), (Like::Row, 11), (Like::Column, 5)];
        for (like, count) in cases {
            let found = cage.select_like(&chosen, like);
            assert_eq!(found.len(), count, "{like:?}");
            assert!(found.is_superset(&chosen), "{like:?} keeps the chosen vertex");
            assert_eq!(cage.select_like(&found, like), found, "{like:?} twice is the same as once");
        }
        assert_eq!(cage.select_layer(Layer::Top).len(), 55, "half of all");
        assert!(cage.select_layer(Layer::Top).is_disjoint(&cage.select_layer(Layer::Bottom)), "and the other half");
    }

    #[test]
    fn the_inverse_of_the_inverse_is_the_choice() {
        let cage = paper_cage(3.0, [4, 4]);
        let chosen: Selection = [0, 7, 20].into();
        let inverse = cage.select_inverse(&chosen);
        assert_eq!(inverse.len() + chosen.len(), cage.n_handles(), "together all");
        assert_eq!(cage.select_inverse(&inverse), chosen, "back again");
    }

    #[test]
    fn growing_adds_the_neighbors_and_shrinking_takes_them_away() {
        let cage = paper_cage(3.0, [8, 8]);
        let middle: Selection = [at(&cage, [4, 4, 1])].into();
        let grown = cage.select_more(&middle);
        assert_eq!(grown.len(), 5, "four neighbors in the layer and none through the antenna");
        assert_eq!(cage.select_less(&grown), middle, "away from the rim they are opposites");
        let corner: Selection = [at(&cage, [0, 0, 0])].into();
        assert_eq!(cage.select_more(&corner).len(), 4, "a corner has three, one of them above");
        assert_eq!(cage.select_less(&cage.select_all()), cage.select_all(), "all has no rim");
    }

    #[test]
    fn vertices_that_are_not_there_are_left_out() {
        let cage = paper_cage(3.0, [1, 1]);
        let strange: Selection = [99].into();
        for found in [cage.select_more(&strange), cage.select_less(&strange), cage.select_like(&strange, Like::Row)] {
            assert!(found.is_empty(), "{found:?}");
        }
    }
}
