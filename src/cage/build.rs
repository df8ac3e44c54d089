//! Builds the rest cage: a cuboid around the antenna, segmented in x and y, with diagonals that keep mirror symmetry.
//!
//! Diagonals that all run one way break the mirror symmetry of a bent antenna by up to 0.1 mm. Here each diagonal of
//! the top and bottom runs from the quad's corner nearest to the face's center to the opposite corner, and those of
//! the sides are mirrored about the middle; quads that lie across a mid-plane (odd segment counts) get a center vertex
//! and four triangles.

use crate::geometry::{DVec3, TriMesh, VertexId};
use crate::units::to_mm;
use std::collections::HashMap;

/// Padding and segmentation of the cage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CageParams {
    /// Distance from the antenna to the cage along x, y and z, m.
    pub padding: DVec3,
    /// Segments along x and y, at least 1.
    pub segments: [usize; 2],
}

/// Why no cage can be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CageError {
    /// A padding is not positive: the antenna would not be strictly inside.
    #[error("padding {axis} is {value_mm} mm, but the antenna must lie strictly inside its cage: choose more than 0")]
    Padding {
        /// Axis letter.
        axis: char,
        /// Its value, mm.
        value_mm: f64,
    },
    /// A segment count is out of range.
    #[error("the cage has {count} segments along {axis}: choose 1 to {MAX_SEGMENTS}")]
    Segments {
        /// Axis letter.
        axis: char,
        /// The count.
        count: usize,
    },
}

/// More segments than this make weights of hundreds of megabytes and handles too dense to grab.
pub const MAX_SEGMENTS: usize = 64;

/// A rest cage.
#[derive(Clone, Debug, PartialEq)]
pub struct Cage {
    /// Rest vertices (m) and faces, closed and outward; the first [`Self::n_handles`] vertices can be moved.
    pub mesh: TriMesh,
    /// Lattice place of each handle: station along x, along y, and 0 (bottom) or 1 (top).
    pub lattice: Vec<[usize; 3]>,
    /// Corners of the quad that each center vertex follows; center vertices come after the handles.
    pub centers: Vec<[VertexId; 4]>,
    /// Segments along x and y.
    pub segments: [usize; 2],
}

impl Cage {
    /// Builds the cuboid cage around the box from `lo` to `hi` (m).
    ///
    /// # Errors
    /// [`CageError`] if a padding is not positive or a segment count is out of range.
    pub fn around((lo, hi): (DVec3, DVec3), params: &CageParams) -> Result<Self, CageError> {
        for (axis, value) in ['x', 'y', 'z'].into_iter().zip(params.padding.to_array()) {
            if !(value.is_finite() && value > 0.0) {
                return Err(CageError::Padding { axis, value_mm: to_mm(value) });
            }
        }
        for (axis, count) in ['x', 'y'].into_iter().zip(params.segments) {
            if !(1..=MAX_SEGMENTS).contains(&count) {
                return Err(CageError::Segments { axis, count });
            }
        }
        let mut cage = Lattice::new(lo - params.padding, hi + params.padding, params.segments);
        cage.sides();
        cage.top_and_bottom();
        Ok(cage.finish())
    }

    /// Number of vertices that can be moved; the others are centers of quads.
    #[must_use]
    pub fn n_handles(&self) -> usize {
        self.lattice.len()
    }

    /// Extent along x, y and z, m.
    #[must_use]
    pub fn extent(&self) -> DVec3 {
        let (lo, hi) = self.mesh.bounds();
        hi - lo
    }

    /// Completes a pose: puts each center vertex into the mean of its four corners.
    ///
    /// * `handles`: positions of at least the handles, m; what follows them is replaced.
    #[must_use]
    pub fn with_centers(&self, mut handles: Vec<DVec3>) -> Vec<DVec3> {
        handles.truncate(self.n_handles());
        let mean = |quad: &[VertexId; 4]| quad.iter().map(|v| handles[v.index()]).sum::<DVec3>() / 4.0;
        let centers: Vec<DVec3> = self.centers.iter().map(mean).collect();
        handles.extend(centers);
        handles
    }

    /// The lattice edges (no diagonals), each once: what a designer sees as the cage.
    #[must_use]
    pub fn edges(&self) -> Vec<[VertexId; 2]> {
        let place: HashMap<[usize; 3], usize> = self.lattice.iter().enumerate().map(|(v, &p)| (p, v)).collect();
        let mut edges = Vec::new();
        for (v, &[i, j, k]) in self.lattice.iter().enumerate() {
            for next in [[i + 1, j, k], [i, j + 1, k], [i, j, k + 1]] {
                if let Some(&w) = place.get(&next) {
                    edges.push([VertexId::new(v), VertexId::new(w)]);
                }
            }
        }
        edges
    }
}

struct Lattice {
    lo: DVec3,
    hi: DVec3,
    segments: [usize; 2],
    ids: HashMap<[usize; 3], usize>,
    lattice: Vec<[usize; 3]>,
    /// Triangles among handles.
    faces: Vec<[usize; 3]>,
    /// Quads with a center vertex, counter-clockwise.
    quads: Vec<[usize; 4]>,
}

impl Lattice {
    fn new(lo: DVec3, hi: DVec3, segments: [usize; 2]) -> Self {
        let mut new =
            Self { lo, hi, segments, ids: HashMap::new(), lattice: Vec::new(), faces: Vec::new(), quads: Vec::new() };
        // All handles first, station by station: their numbers are what hand edits refer to. Every lattice place is
        // on the surface because there is one segment along z.
        for i in 0..=segments[0] {
            for j in 0..=segments[1] {
                for k in 0..2 {
                    new.ids.insert([i, j, k], new.lattice.len());
                    new.lattice.push([i, j, k]);
                }
            }
        }
        new
    }

    /// Adds a quad with corners counter-clockwise from outside; `side` tells on which side of the mid-planes of its
    /// two directions it lies (`None`: across), and thereby which diagonal it gets.
    fn quad(&mut self, corners: [[usize; 3]; 4], diagonal_from_first: Option<bool>) {
        let [a, b, c, d] = corners.map(|p| self.ids[&p]);
        match diagonal_from_first {
            Some(true) => self.faces.extend([[a, b, c], [a, c, d]]),
            Some(false) => self.faces.extend([[a, b, d], [b, c, d]]),
            None => self.quads.push([a, b, c, d]),
        }
    }

    fn top_and_bottom(&mut self) {
        let [nx, ny] = self.segments;
        for i in 0..nx {
            for j in 0..ny {
                let diagonal = before_middle(i, nx).zip(before_middle(j, ny)).map(|(x, y)| x == y);
                self.quad([[i, j, 1], [i + 1, j, 1], [i + 1, j + 1, 1], [i, j + 1, 1]], diagonal);
                self.quad([[i, j, 0], [i, j + 1, 0], [i + 1, j + 1, 0], [i + 1, j, 0]], diagonal);
            }
        }
    }

    fn sides(&mut self) {
        let [nx, ny] = self.segments;
        for i in 0..nx {
            let rising = before_middle(i, nx);
            self.quad([[i, 0, 0], [i + 1, 0, 0], [i + 1, 0, 1], [i, 0, 1]], rising);
            self.quad([[i, ny, 0], [i, ny, 1], [i + 1, ny, 1], [i + 1, ny, 0]], rising);
        }
        for j in 0..ny {
            let rising = before_middle(j, ny);
            self.quad([[nx, j, 0], [nx, j + 1, 0], [nx, j + 1, 1], [nx, j, 1]], rising);
            self.quad([[0, j, 0], [0, j, 1], [0, j + 1, 1], [0, j + 1, 0]], rising);
        }
    }

    fn finish(self) -> Cage {
        let counts = [self.segments[0], self.segments[1], 1];
        let position = |p: &[usize; 3]| {
            let t = DVec3::from_array([0, 1, 2].map(|a| p[a] as f64 / counts[a] as f64));
            // Written so that both ends are met exactly.
            self.lo * (DVec3::ONE - t) + self.hi * t
        };
        let handles: Vec<DVec3> = self.lattice.iter().map(position).collect();
        let mut faces = self.faces;
        for (m, &[a, b, c, d]) in self.quads.iter().enumerate() {
            let center = handles.len() + m;
            faces.extend([[a, b, center], [b, c, center], [c, d, center], [d, a, center]]);
        }
        let mut cage = Cage {
            mesh: TriMesh { vertices: Vec::new(), faces: faces.iter().map(|f| f.map(VertexId::new)).collect() },
            lattice: self.lattice,
            centers: self.quads.iter().map(|q| q.map(VertexId::new)).collect(),
            segments: self.segments,
        };
        cage.mesh.vertices = cage.with_centers(handles);
        cage
    }
}

/// Whether a segment lies before the middle of its row; `None` if it lies across.
fn before_middle(segment: usize, count: usize) -> Option<bool> {
    match (2 * segment + 1).cmp(&count) {
        std::cmp::Ordering::Less => Some(true),
        std::cmp::Ordering::Equal => None,
        std::cmp::Ordering::Greater => Some(false),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::units::from_mm;
    use std::collections::HashSet;

    /// The cage around the paper's antenna with equal padding, mm.
    pub(crate) fn paper_cage(padding_mm: f64, segments: [usize; 2]) -> Cage {
        let bounds = (DVec3::new(-10.0, -10.0, -1.61) * 1e-3, DVec3::new(10.0, 10.0, 0.035) * 1e-3);
        Cage::around(bounds, &CageParams { padding: DVec3::splat(from_mm(padding_mm)), segments }).expect("valid")
    }

    #[test]
    fn every_segmentation_is_closed_and_a_full_box() {
        for nx in 1..8 {
            for ny in 1..5 {
                let cage = paper_cage(1.0, [nx, ny]);
                assert_eq!(cage.mesh.check(), Ok(()), "{nx} x {ny}");
                let e = cage.extent();
                assert!((cage.mesh.volume() / (e.x * e.y * e.z) - 1.0).abs() < 1e-12, "{nx} x {ny} volume");
                let used: HashSet<_> = cage.mesh.faces.iter().flatten().collect();
                assert_eq!(used.len(), cage.mesh.vertices.len(), "{nx} x {ny}: every vertex is used");
            }
        }
    }

    #[test]
    fn the_triangulation_is_mirror_symmetric_about_both_mid_planes() {
        for segments in [[1, 1], [2, 1], [3, 2], [10, 1], [10, 10], [5, 4]] {
            let cage = paper_cage(3.0, segments);
            let key = |p: DVec3| (p * 1e9).round().as_i64vec3();
            let sets = |mirror: DVec3| -> HashSet<_> {
                let corners = |f| {
                    let mut k = cage.mesh.corners(f).map(|p| key(p * mirror)).map(|k| k.to_array());
                    k.sort_unstable();
                    k
                };
                (0..cage.mesh.faces.len()).map(corners).collect()
            };
            let plain = sets(DVec3::ONE);
            assert_eq!(plain, sets(DVec3::new(-1.0, 1.0, 1.0)), "{segments:?} about x");
            assert_eq!(plain, sets(DVec3::new(1.0, -1.0, 1.0)), "{segments:?} about y");
        }
    }

    #[test]
    fn bad_numbers_are_refused_by_name() {
        let bounds = (DVec3::ZERO, DVec3::ONE);
        let flat = Cage::around(bounds, &CageParams { padding: DVec3::new(1.0, 1.0, 0.0), segments: [1, 1] });
        assert!(matches!(flat, Err(CageError::Padding { axis: 'z', .. })), "{flat:?}");
        let none = Cage::around(bounds, &CageParams { padding: DVec3::ONE, segments: [1, 0] });
        assert!(matches!(none, Err(CageError::Segments { axis: 'y', count: 0 })), "{none:?}");
    }
}
