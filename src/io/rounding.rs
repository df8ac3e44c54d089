//! The one place where positions become single precision: once per vertex, so that solids keep fitting.

use super::IoError;
use super::stl::normal_of;
use crate::geometry::{DVec3, Facet, Plc};
use crate::units::{MM, to_mm};
use std::collections::HashMap;

/// Every solid reaches at least this far above zero along one axis at least, mm.
///
/// Some readers look for a point outside by scaling the greatest coordinates up and so drop a solid that lies wholly at
/// coordinates <= 0; below a micrometre, rounding could make one of these.
const LEAST_MAXIMUM_MM: f64 = 1e-3;

/// Rounds to single precision; zero is always positive zero.
#[allow(clippy::cast_possible_truncation, reason = "the purpose: numbers too large become infinite and are refused")]
pub(super) fn to_single(p: DVec3) -> [f32; 3] {
    p.to_array().map(|x| x as f32 + 0.0)
}

/// The common shift in whole millimetres, along the axis that needs least, after which no solid lies wholly at
/// coordinates <= 0; zero where none does.
pub(super) fn shift_mm(plc: &Plc) -> DVec3 {
    let highest = plc.solids().map(|(region, _)| plc.boundary(region).bounds().1 / MM);
    let too_low = highest.filter(|h| h.max_element() < LEAST_MAXIMUM_MM);
    let needed = too_low.fold(DVec3::ZERO, |n, h| n.max((DVec3::splat(LEAST_MAXIMUM_MM) - h).ceil()));
    let along = |axis: DVec3| axis * needed.dot(axis);
    DVec3::AXES.map(along).into_iter().min_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or_default()
}

/// A vertex (m) as the STL files of an export hold it: shifted millimetres in single precision.
pub(super) fn stl_vertex(vertex: DVec3, shift_mm: DVec3) -> [f32; 3] {
    to_single(DVec3::from_array(vertex.to_array().map(to_mm)) + shift_mm)
}

/// A vertex (m, z up) as glTF has it: metres, y up, single precision.
pub(super) fn gltf_vertex(vertex: DVec3) -> [f32; 3] {
    to_single(DVec3::new(vertex.x, vertex.z, -vertex.y))
}

/// Refuses two vertices that a rounding made one, or a triangle that it robbed of its area.
pub(super) fn check_distinct(plc: &Plc, rounded: &[[f32; 3]], format: &'static str) -> Result<(), IoError> {
    let mut seen = HashMap::with_capacity(rounded.len());
    let merged = |v: usize| IoError::Merged { format, place_mm: (plc.vertices[v] / MM).to_array() };
    for (v, corner) in rounded.iter().enumerate() {
        if seen.insert(corner.map(f32::to_bits), v).is_some() {
            return Err(merged(v));
        }
    }
    let flat = |f: &&Facet| normal_of(&f.vertices.map(|v| rounded[v.index()])) == DVec3::ZERO;
    plc.facets.iter().find(flat).map_or(Ok(()), |f| Err(merged(f.vertices[0].index())))
}
