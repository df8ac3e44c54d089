//! Points by place, to find those near one.

use crate::geometry::DVec3;
use std::collections::HashMap;

/// Points in the cells of a cubic lattice.
pub(super) struct Near {
    cell: f64,
    points: HashMap<[i64; 3], Vec<DVec3>>,
}

impl Near {
    /// * `reach`: how far points are looked for, m.
    pub(super) fn new(reach: f64) -> Self {
        Self { cell: reach, points: HashMap::new() }
    }

    pub(super) fn add(&mut self, p: DVec3) {
        self.points.entry(self.name(p)).or_default().push(p);
    }

    /// All points within a box that is grown by the reach; some of those around it, too.
    pub(super) fn around(&self, lo: DVec3, hi: DVec3) -> Vec<DVec3> {
        let [lo, hi] = [self.name(lo).map(|k| k - 1), self.name(hi).map(|k| k + 1)];
        let n_cells: f64 = (0..3).map(|k| (hi[k] - lo[k] + 1) as f64).product();
        if n_cells > self.points.len() as f64 {
            let is_in = |name: &[i64; 3]| (0..3).all(|k| (lo[k]..=hi[k]).contains(&name[k]));
            let mut names: Vec<_> = self.points.keys().filter(|name| is_in(name)).collect();
            // A map's own order changes from run to run.
            names.sort_unstable();
            return names.into_iter().flat_map(|name| &self.points[name]).copied().collect();
        }
        let columns = (lo[0]..=hi[0]).flat_map(|x| (lo[1]..=hi[1]).map(move |y| (x, y)));
        let names = columns.flat_map(|(x, y)| (lo[2]..=hi[2]).map(move |z| [x, y, z]));
        names.filter_map(|name| self.points.get(&name)).flatten().copied().collect()
    }

    /// The cell of a point; places too far away to number are in the last cells.
    #[allow(clippy::cast_possible_truncation, reason = "saturates")]
    fn name(&self, p: DVec3) -> [i64; 3] {
        (p / self.cell).to_array().map(|x| x.floor() as i64)
    }
}
