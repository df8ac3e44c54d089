//! Local distortion at the vertices of a surface, for heatmaps.

use crate::distortion::facet_strain;
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec3, Plc};

/// Local distortion at each vertex, area-weighted over the facets of the sheet around it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// Area over flat area, dimensionless.
    pub area_ratio: Vec<f64>,
    /// Greater principal stretch.
    pub stretch_max: Vec<f64>,
    /// Smaller principal stretch.
    pub stretch_min: Vec<f64>,
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
        Self { area_ratio, stretch_max, stretch_min }
    }
}
