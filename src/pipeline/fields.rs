//! Local distortion at the vertices of a surface, for heatmaps.

use crate::distortion::{Cylinder, facet_strain};
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec3, Plc};
use std::collections::HashMap;

/// Local distortion at each vertex, area-weighted over the facets of the sheet around it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// Area over flat area, dimensionless.
    pub area_ratio: Vec<f64>,
    /// Greater principal stretch.
    pub stretch_max: Vec<f64>,
    /// Smaller principal stretch.
    pub stretch_min: Vec<f64>,
    /// Thickness of the substrate at the vertex's flat place over the one drawn; empty where it was not measured.
    pub thickness: Vec<f64>,
    /// Place of each vertex on the exact cylinder, shifted along z to lie nearest, m; empty where there is none.
    pub on_cylinder: Vec<DVec3>,
}

impl Fields {
    /// Distortion of the facets carried from `reference` to `positions`, m.
    ///
    /// Only facets that lie in the sheet count where a vertex has any: the thin side walls are strained by the bend
    /// itself, and would hide what the sheet does at its rim.
    #[must_use]
    pub fn new(surface: &Plc, reference: &[DVec3], positions: &[DVec3]) -> Self {
        // Weight, weighted greater and smaller stretch, of facets in the sheet and of the others.
        let mut sums = vec![[[0.0_f64; 3]; 2]; positions.len()];
        for facet in &surface.facets {
            let at = |points: &[DVec3]| facet.vertices.map(|v| points[v.index()]);
            let flat = at(reference);
            let normal = doubled_area_vector(flat);
            let weight = normal.length();
            let kind = usize::from(normal.z.abs() < weight / 2.0);
            let [greater, smaller] = facet_strain(flat, at(positions));
            for v in facet.vertices {
                let sum = &mut sums[v.index()][kind];
                *sum = [sum[0] + weight, sum[1] + weight * greater, sum[2] + weight * smaller];
            }
        }
        let mean = |k: usize| {
            sums.iter().map(move |kinds| {
                let sum = if kinds[0][0] > 0.0 { kinds[0] } else { kinds[1] };
                if sum[0] > 0.0 { sum[k] / sum[0] } else { 1.0 }
            })
        };
        let stretch_max: Vec<f64> = mean(1).collect();
        let stretch_min: Vec<f64> = mean(2).collect();
        let area_ratio = stretch_max.iter().zip(&stretch_min).map(|(a, b)| a * b).collect();
        Self { area_ratio, stretch_max, stretch_min, ..Self::default() }
    }

    /// Adds where the vertices, at `reference` as drawn, would lie on the exact cylinder.
    ///
    /// * `shift`: of the antenna above the cylinder along z, m.
    #[must_use]
    pub(super) fn with_cylinder(mut self, cylinder: &Cylinder, shift: f64, reference: &[DVec3]) -> Self {
        self.on_cylinder = reference.iter().map(|&p| cylinder.position(p) + DVec3::Z * shift).collect();
        self
    }
}

/// Flat places at which the substrate's thickness is measured: one for all vertices above each other.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    /// On the substrate's top, then in the same order on its bottom, m.
    pub(super) points: Vec<DVec3>,
    /// Which place each vertex belongs to.
    of_vertex: Vec<usize>,
    height: f64,
}

impl Columns {
    /// The places of vertices at `reference` as drawn.
    pub(super) fn new(reference: &[DVec3], height: f64) -> Self {
        let mut known: HashMap<[u64; 2], usize> = HashMap::new();
        let mut points = Vec::new();
        let mut place = |p: &DVec3| {
            *known.entry([p.x.to_bits(), p.y.to_bits()]).or_insert_with(|| {
                points.push(p.with_z(0.0));
                points.len() - 1
            })
        };
        let of_vertex = reference.iter().map(&mut place).collect();
        let bottom: Vec<DVec3> = points.iter().map(|p| p.with_z(-height)).collect();
        points.extend(bottom);
        Self { points, of_vertex, height }
    }

    /// The thickness at each vertex over the one drawn, from the images of the points.
    pub(super) fn ratios(&self, images: &[DVec3]) -> Vec<f64> {
        let (top, bottom) = images.split_at(images.len() / 2);
        let thick: Vec<f64> = top.iter().zip(bottom).map(|(t, b)| t.distance(*b) / self.height).collect();
        self.of_vertex.iter().map(|&place| thick[place]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cage::Axis;

    #[test]
    fn thickness_is_measured_between_the_planes_and_once_for_all_vertices_above_each_other() {
        let reference = [(0.0, 0.0, 0.0), (0.0, 0.0, -2.0), (1.0, 0.0, 0.5), (0.0, 0.0, 0.5)].map(DVec3::from);
        let columns = Columns::new(&reference, 2.0);
        assert_eq!(columns.points.len(), 4, "two places, two planes");
        // Half as thick at x = 0, as drawn at x = 1; then turned.
        let image = |p: &DVec3| DVec3::new(p.z * (1.0 + p.x) / 2.0, p.x, 0.0);
        let images: Vec<DVec3> = columns.points.iter().map(image).collect();
        assert_eq!(columns.ratios(&images), [0.5, 0.5, 1.0, 0.5], "ratios");
    }

    #[test]
    fn an_antenna_on_its_cylinder_has_no_distance_from_it() {
        let cylinder = Cylinder { axis: Axis::X, radius: 10e-3, kept_plane: 0.0 };
        let reference = [DVec3::new(1e-3, 2e-3, 0.0), DVec3::new(-3e-3, 0.0, -1e-3)];
        let fields = Fields::default().with_cylinder(&cylinder, 1e-4, &reference);
        for (place, p) in fields.on_cylinder.iter().zip(reference) {
            assert!(place.distance(cylinder.position(p) + DVec3::Z * 1e-4) < 1e-15, "shifted along z");
        }
    }
}
