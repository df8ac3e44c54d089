//! From parameters to the welded surface complex of the flat antenna.
//!
//! The footprint's triangulation is extruded through the layers (coaxial line, ground metal, substrate, patch metal).
//! Each prism belongs to one region; a facet stands wherever two neighboring prisms differ, once, with the regions on
//! both sides. Nothing has to be matched afterwards, so no gap can arise.

use super::footprint::{self, Cover, Footprint};
use super::params::{Dielectric, ParamError, PatchParams};
use super::{COAX, GROUND, PATCH, PIN, SUBSTRATE};
use crate::geometry::{DVec3, Facet, Plc, Region, RegionId, RegionRole, VertexId};
use std::collections::{BTreeMap, HashMap};

/// Why the flat antenna cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatchError {
    /// A parameter is wrong.
    #[error(transparent)]
    Param(#[from] ParamError),
    /// A coordinate is too small or too large for the exact predicates.
    #[error("the outline point ({x:e} m, {y:e} m) is out of the range that can be triangulated")]
    Coordinates {
        /// x, m.
        x: f64,
        /// y, m.
        y: f64,
    },
    /// The footprint's refinement did not end.
    #[error(
        "the antenna's outline could not be triangulated: two outlines nearly touch; move the feed or change coax_radius"
    )]
    Refinement,
}

const AIR_ID: usize = 0;
const SUBSTRATE_ID: usize = 1;
const PATCH_ID: usize = 2;
const GROUND_ID: usize = 3;
const PIN_ID: usize = 4;
const COAX_ID: usize = 5;

/// Builds the welded surface complex of the flat antenna.
///
/// Regions: air, [`SUBSTRATE`], [`PATCH`], [`GROUND`], [`PIN`], [`COAX`], in this order.
///
/// # Errors
/// [`PatchError`] if a parameter is not valid or the outlines cannot be triangulated.
pub fn flat_complex(params: &PatchParams) -> Result<Plc, PatchError> {
    params.validate()?;
    let footprint = footprint::triangulate(params)?;
    let planes = [params.port_plane(), params.ground_bottom(), -params.height, 0.0, params.patch_thickness];
    let mut build = Extrusion {
        footprint: &footprint,
        planes: &planes,
        columns: HashMap::new(),
        plc: Plc { vertices: Vec::new(), facets: Vec::new(), regions: regions(params) },
    };
    build.horizontal_facets();
    build.vertical_facets();
    Ok(build.plc)
}

fn regions(params: &PatchParams) -> Vec<Region> {
    let region = |name: &str, role, material: Dielectric| Region {
        name: name.to_owned(),
        role,
        eps_r: material.eps_r,
        tan_delta: material.tan_delta,
    };
    let vacuum = Dielectric { eps_r: 1.0, tan_delta: 0.0 };
    vec![
        region("air", RegionRole::Air, vacuum),
        region(SUBSTRATE, RegionRole::Dielectric, params.substrate),
        region(PATCH, RegionRole::Conductor, vacuum),
        region(GROUND, RegionRole::Conductor, vacuum),
        region(PIN, RegionRole::Conductor, vacuum),
        region(COAX, RegionRole::Dielectric, params.sheath),
    ]
}

/// The region of the prism over one footprint triangle, in the layer above plane `layer`.
fn region_of(layer: usize, cover: Cover) -> usize {
    match layer {
        0 | 1 if cover.pin => PIN_ID,
        0 | 1 if cover.sheath => COAX_ID,
        0 => AIR_ID,
        1 => GROUND_ID,
        2 if cover.pin => PIN_ID,
        2 => SUBSTRATE_ID,
        3 if cover.patch => PATCH_ID,
        _ => AIR_ID,
    }
}

struct Extrusion<'a> {
    footprint: &'a Footprint,
    planes: &'a [f64],
    /// Vertex of a footprint point on a plane, made when first used.
    columns: HashMap<(usize, usize), VertexId>,
    plc: Plc,
}

impl Extrusion<'_> {
    fn vertex(&mut self, point: usize, plane: usize) -> VertexId {
        let position: DVec3 = self.footprint.points[point].extend(self.planes[plane]);
        let vertices = &mut self.plc.vertices;
        *self.columns.entry((point, plane)).or_insert_with(|| {
            vertices.push(position);
            VertexId::new(vertices.len() - 1)
        })
    }

    fn push(&mut self, vertices: [VertexId; 3], back: usize, front: usize) {
        self.plc.facets.push(Facet { vertices, back: RegionId::new(back), front: RegionId::new(front) });
    }

    fn horizontal_facets(&mut self) {
        for plane in 0..self.planes.len() {
            for (triangle, &cover) in self.footprint.triangles.iter().zip(&self.footprint.covers) {
                let below = if plane == 0 { AIR_ID } else { region_of(plane - 1, cover) };
                let above = region_of(plane, cover);
                if below != above {
                    let vertices = triangle.map(|point| self.vertex(point, plane));
                    self.push(vertices, below, above);
                }
            }
        }
    }

    fn vertical_facets(&mut self) {
        // Each edge with the triangles on its left and right; ordered, so that the result does not depend on hashing.
        let mut edges: BTreeMap<(usize, usize), [Option<usize>; 2]> = BTreeMap::new();
        for (t, triangle) in self.footprint.triangles.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                edges.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] = Some(t);
            }
        }
        for ((a, b), sides) in edges {
            for layer in 0..self.planes.len() - 1 {
                let [left, right] = sides.map(|t| t.map_or(AIR_ID, |t| region_of(layer, self.footprint.covers[t])));
                if left == right {
                    continue;
                }
                let [a0, b0, a1, b1] =
                    [(a, layer), (b, layer), (a, layer + 1), (b, layer + 1)].map(|(p, z)| self.vertex(p, z));
                // From a to b with z up, the right-hand normal points to the right.
                self.push([a0, b0, b1], left, right);
                self.push([a0, b1, a1], left, right);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::doubled_area;
    use super::super::outline::tests::{disc, e_shape};
    use super::super::params::tests::paper;
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_complex_is_valid_and_every_region_has_its_volume() {
        let params = paper();
        let plc = flat_complex(&params).expect("the paper's antenna");
        assert_eq!(plc.check(), Ok(()), "closed regions, each facet once");
        let polygon = |r: f64, n: usize| n as f64 / 2.0 * r * r * (TAU / n as f64).sin();
        let pin = polygon(params.pin_radius, params.pin_segments);
        let coax = polygon(params.coax_radius, params.coax_segments);
        let ground = params.ground_width * params.ground_length;
        let depth = params.ground_thickness + params.coax_length;
        let volumes = [
            (SUBSTRATE, (ground - pin) * params.height),
            (PATCH, params.width * params.length * params.patch_thickness),
            (GROUND, (ground - coax) * params.ground_thickness),
            (PIN, pin * (params.height + depth)),
            (COAX, (coax - pin) * depth),
        ];
        for (name, expected) in volumes {
            let volume = plc.boundary(plc.region(name).expect("named region")).volume();
            assert!((volume / expected - 1.0).abs() < 1e-9, "{name}: {volume:e} against {expected:e}");
        }
    }

    #[test]
    fn patches_of_any_outline_give_valid_complexes_with_their_volume() {
        for params in [disc(), e_shape()] {
            let plc = flat_complex(&params).expect("an outline");
            assert_eq!(plc.check(), Ok(()), "closed regions, each facet once");
            let volume = plc.boundary(plc.region(PATCH).expect("a patch")).volume();
            let expected = doubled_area(&params.outline) / 2.0 * params.patch_thickness;
            assert!((volume / expected - 1.0).abs() < 1e-9, "{volume:e} against {expected:e}");
        }
    }

    #[test]
    fn random_valid_parameters_give_valid_complexes() {
        let mut rng = fastrand::Rng::with_seed(11);
        let mut built = 0;
        for _ in 0..40 {
            let mut params = paper();
            let mut scale = |value: &mut f64| *value *= 0.6 + 0.8 * rng.f64();
            for value in [&mut params.width, &mut params.length, &mut params.inset, &mut params.coax_radius] {
                scale(value);
            }
            if params.validate().is_ok() {
                let plc = flat_complex(&params).expect("valid parameters");
                assert_eq!(plc.check(), Ok(()), "{params:?}");
                built += 1;
            }
        }
        assert!(built > 20, "only {built} of 40 were valid");
    }
}
