//! The surface error rho: total surface of a part's image over the flat part's, minus 1.

use crate::antenna::PatchParams;
use crate::deform::{DeformError, SmoothMap};
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec2, DVec3};

/// Grid segments along x, y and z of each part, even: the areas of the grid and of every second point are extrapolated
/// to none of the faceting error's leading term, which leaves less than 1e-5 at R = 4.2 mm.
const SEGMENTS: [usize; 3] = [32, 32, 2];

/// The surfaces of patch and substrate as fine grids, ready to be mapped.
#[derive(Clone, Debug)]
pub struct RhoGrid {
    patch: BoxGrid,
    substrate: BoxGrid,
    /// Total surfaces of the parts as drawn, m².
    flat_areas: [f64; 2],
}

impl RhoGrid {
    /// Grids over the antenna as drawn, bent along x or y alike.
    #[must_use]
    pub fn new(params: &PatchParams) -> Self {
        let slab = |size: DVec2, lo: f64, hi: f64| {
            let half = size / 2.0;
            (BoxGrid::new((-half).extend(lo), half.extend(hi)), 2.0 * (size.x * size.y + (size.x + size.y) * (hi - lo)))
        };
        let (patch, patch_area) = slab(DVec2::new(params.width, params.length), 0.0, params.patch_thickness);
        let ground = DVec2::new(params.ground_width, params.ground_length);
        let (substrate, substrate_area) = slab(ground, -params.height, 0.0);
        Self { patch, substrate, flat_areas: [patch_area, substrate_area] }
    }

    /// Flat points whose images [`Self::rho`] takes, m: the patch's, then the substrate's; the patch's are scaled.
    ///
    /// * `patch_scale`: factors on the patch's width and length (1 where it is not scaled).
    #[must_use]
    pub fn points(&self, patch_scale: DVec2) -> Vec<DVec3> {
        let scaled = self.patch.vertices.iter().map(|p| *p * patch_scale.extend(1.0));
        scaled.chain(self.substrate.vertices.iter().copied()).collect()
    }

    /// Surface errors rho (fractions) of patch and substrate from the images of [`Self::points`].
    ///
    /// # Panics
    /// If there is not one image per point.
    #[must_use]
    pub fn rho(&self, images: &[DVec3]) -> [f64; 2] {
        let n_patch = self.patch.vertices.len();
        assert_eq!(images.len(), n_patch + self.substrate.vertices.len(), "one image per point");
        let areas = [self.patch.area(&images[..n_patch]), self.substrate.area(&images[n_patch..])];
        [areas[0] / self.flat_areas[0] - 1.0, areas[1] / self.flat_areas[1] - 1.0]
    }

    /// Surface errors of patch and substrate under a map each.
    ///
    /// # Errors
    /// [`DeformError`] where a map is not defined.
    pub fn rho_of(&self, patch: &impl SmoothMap, substrate: &impl SmoothMap) -> Result<[f64; 2], DeformError> {
        let mut images = patch.positions(&self.patch.vertices)?;
        images.extend(substrate.positions(&self.substrate.vertices)?);
        Ok(self.rho(&images))
    }
}

/// The surface of a box as a grid of points, with triangles between neighbors and between every second ones.
#[derive(Clone, Debug)]
struct BoxGrid {
    /// Points of one face after the other; not shared across edges, since only areas are wanted.
    vertices: Vec<DVec3>,
    fine: Vec<[usize; 3]>,
    coarse: Vec<[usize; 3]>,
}

impl BoxGrid {
    fn new(lo: DVec3, hi: DVec3) -> Self {
        let mut grid = Self { vertices: Vec::new(), fine: Vec::new(), coarse: Vec::new() };
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let (nu, nv) = (SEGMENTS[u], SEGMENTS[v]);
            for side in [lo[axis], hi[axis]] {
                let first = grid.vertices.len();
                for (i, j) in (0..=nu).flat_map(|i| (0..=nv).map(move |j| (i, j))) {
                    let mut p = DVec3::ZERO;
                    p[axis] = side;
                    p[u] = lo[u] + (hi[u] - lo[u]) * i as f64 / nu as f64;
                    p[v] = lo[v] + (hi[v] - lo[v]) * j as f64 / nv as f64;
                    grid.vertices.push(p);
                }
                let id = |i: usize, j: usize| first + i * (nv + 1) + j;
                for (stride, triangles) in [(1, &mut grid.fine), (2, &mut grid.coarse)] {
                    for i in (0..nu).step_by(stride) {
                        for j in (0..nv).step_by(stride) {
                            let (k, l) = (i + stride, j + stride);
                            triangles.extend([[id(i, j), id(k, j), id(k, l)], [id(i, j), id(k, l), id(i, l)]]);
                        }
                    }
                }
            }
        }
        grid
    }

    /// Area through the images of the points, extrapolated from both triangulations.
    fn area(&self, images: &[DVec3]) -> f64 {
        let area = |triangles: &[[usize; 3]]| -> f64 {
            triangles.iter().map(|t| doubled_area_vector(t.map(|v| images[v])).length() / 2.0).sum()
        };
        (4.0 * area(&self.fine) - area(&self.coarse)) / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cylinder;
    use super::*;
    use crate::antenna::params::tests::paper;
    use crate::cage::Axis;

    #[test]
    fn a_scale_gives_its_square() {
        let grid = RhoGrid::new(&paper());
        let scaled: Vec<DVec3> = grid.points(DVec2::ONE).iter().map(|p| *p * 1.1).collect();
        for rho in grid.rho(&scaled) {
            assert!((rho - 0.21).abs() < 1e-12, "rho {rho}");
        }
    }

    #[test]
    fn the_exact_cylinder_has_the_closed_form_rho() {
        let params = paper();
        // Planes at height z and the walls along the bend grow by 1 + z/R (walls: at mid-height), the others stay.
        let closed = |width: f64, length: f64, lo: f64, hi: f64, radius: f64| {
            let growth = |z: f64| 1.0 + z / radius;
            let walls = (hi - lo) * (width * growth((lo + hi) / 2.0) + length);
            let bent = width * length * (growth(lo) + growth(hi)) + 2.0 * walls;
            bent / (2.0 * (width * length + (hi - lo) * (width + length))) - 1.0
        };
        for radius in [4.2e-3, 10e-3, 60e-3] {
            let cylinder = Cylinder { axis: Axis::X, radius, kept_plane: 0.0 };
            let found = RhoGrid::new(&params).rho_of(&cylinder, &cylinder).expect("defined everywhere");
            let patch = closed(params.width, params.length, 0.0, params.patch_thickness, radius);
            let substrate = closed(params.ground_width, params.ground_length, -params.height, 0.0, radius);
            let error = (found[0] - patch).abs().max((found[1] - substrate).abs());
            assert!(error < 1e-5, "R {radius}: {found:?} against {patch} and {substrate}");
        }
    }
}
