//! The surface complex that is filled with tetrahedra: any number of regions, non-manifold where they meet.

use super::{FaceGroup, face_key};
use crate::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use std::collections::HashMap;

/// A triangle between two regions; its normal points from `back` into `front`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceFacet {
    /// Corners, counter-clockwise seen from `front`.
    pub vertices: [VertexId; 3],
    /// The region behind.
    pub back: RegionId,
    /// The region before; the same one for a sheet inside a region.
    pub front: RegionId,
    /// Index into [`Surface::groups`] where the facet carries a boundary condition.
    pub group: Option<usize>,
}

/// What is to be filled.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Positions, m.
    pub vertices: Vec<DVec3>,
    /// Facets, each once.
    pub facets: Vec<SurfaceFacet>,
    /// Regions by number; 0 is the outside. Neither it nor conductors are filled.
    pub regions: Vec<Region>,
    /// Groups of facets with a boundary condition.
    pub groups: Vec<FaceGroup>,
}

/// Why a surface cannot be filled. Facets and vertices are counted from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceFault {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A facet names a vertex that does not exist.
    #[error("facet {facet} names vertex {vertex}, but there are only {n_vertices}")]
    BadVertex {
        /// The facet.
        facet: usize,
        /// The vertex it names.
        vertex: VertexId,
        /// How many there are.
        n_vertices: usize,
    },
    /// A facet names a region that does not exist.
    #[error("facet {facet} names region {region}, but there are only {n_regions}")]
    BadRegion {
        /// The facet.
        facet: usize,
        /// The region it names.
        region: RegionId,
        /// How many there are, the outside included.
        n_regions: usize,
    },
    /// A facet names a group that does not exist.
    #[error("facet {facet} names group {group}, but there are only {n_groups}")]
    BadGroup {
        /// The facet.
        facet: usize,
        /// The group it names.
        group: usize,
        /// How many there are.
        n_groups: usize,
    },
    /// A vertex that no facet uses.
    #[error("vertex {vertex} is in no facet: leave it out")]
    LooseVertex {
        /// The vertex.
        vertex: usize,
    },
    /// Two vertices at one place.
    #[error("vertices {first} and {second} are at the same place: make them one, so that the facets there are joined")]
    SamePlace {
        /// One vertex.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A facet without area.
    #[error("facet {facet} has no area")]
    Degenerate {
        /// The facet.
        facet: usize,
    },
    /// Two facets with the same corners.
    #[error("facets {first} and {second} have the same corners")]
    Doubled {
        /// One facet.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A filled region ends at the outside or at a conductor without a boundary condition.
    #[error("facet {facet} bounds what is filled, but carries no boundary condition: put it in a group")]
    Unmarked {
        /// The facet.
        facet: usize,
    },
    /// A region's boundary has a hole, or a facet of it is turned around.
    #[error(
        "the boundary of region \"{region}\" is not closed at the edge from vertex {from} to {to} near ({x_mm:.4}, {y_mm:.4}, {z_mm:.4}) mm (facet {facet}): a facet is missing, turned around or names the wrong regions",
        x_mm = at.x * 1e3, y_mm = at.y * 1e3, z_mm = at.z * 1e3
    )]
    Open {
        /// Name of the region.
        region: String,
        /// One end of the edge.
        from: VertexId,
        /// The other end.
        to: VertexId,
        /// A facet at it.
        facet: usize,
        /// Middle of the edge, m.
        at: DVec3,
    },
    /// A region's facets face inwards.
    #[error("region \"{region}\" is inside out (volume {volume:e} m³): exchange back and front of its facets")]
    InsideOut {
        /// Name of the region.
        region: String,
        /// Its signed volume, m³.
        volume: f64,
    },
}

impl Surface {
    /// The three corners of a facet, m.
    #[must_use]
    pub fn corners(&self, facet: usize) -> [DVec3; 3] {
        self.facets[facet].vertices.map(|v| self.vertices[v.index()])
    }

    /// Volume of each region by the divergence theorem, m³, by region number; the outside's is minus their sum.
    #[must_use]
    pub fn volumes(&self) -> Vec<f64> {
        // About a vertex of each region's own: a small region far away would lose digits about another point.
        let mut origins: Vec<Option<DVec3>> = vec![None; self.regions.len()];
        let mut volumes = vec![0.0; self.regions.len()];
        for (f, facet) in self.facets.iter().enumerate() {
            let corners = self.corners(f);
            for (region, sign) in [(facet.back, 1.0), (facet.front, -1.0)] {
                let origin = *origins[region.index()].get_or_insert(corners[0]);
                let [a, b, c] = corners.map(|p| p - origin);
                volumes[region.index()] += sign * a.dot(b.cross(c)) / 6.0;
            }
        }
        volumes
    }

    /// Checks all that can be known of each facet and edge: numbers that exist, finite places, no two vertices at one,
    /// facets with area that stand once and carry a boundary condition where what is filled ends, and regions whose
    /// boundaries are closed and not inside out. Whether facets cross each other is not looked at here.
    ///
    /// # Errors
    /// The first [`SurfaceFault`].
    pub fn check(&self) -> Result<(), SurfaceFault> {
        self.check_numbers()?;
        self.check_vertices()?;
        let mut seen = HashMap::with_capacity(self.facets.len());
        for (f, facet) in self.facets.iter().enumerate() {
            let [a, b, c] = self.corners(f);
            if (b - a).cross(c - a) == DVec3::ZERO {
                return Err(SurfaceFault::Degenerate { facet: f });
            }
            if let Some(first) = seen.insert(face_key(facet.vertices), f) {
                return Err(SurfaceFault::Doubled { first, second: f });
            }
            if facet.group.is_none() && self.is_filled(facet.back) != self.is_filled(facet.front) {
                return Err(SurfaceFault::Unmarked { facet: f });
            }
        }
        self.check_closed()?;
        let bounded: Vec<bool> = self.are_bounded();
        let volumes = self.volumes();
        let inverted = (1..self.regions.len()).find(|&r| bounded[r] && !(volumes[r] > 0.0 && volumes[r].is_finite()));
        inverted.map_or(Ok(()), |r| {
            Err(SurfaceFault::InsideOut { region: self.regions[r].name.clone(), volume: volumes[r] })
        })
    }

    fn is_filled(&self, region: RegionId) -> bool {
        region.index() != 0 && self.regions[region.index()].role != RegionRole::Conductor
    }

    /// Which regions have a boundary; a number may stand in the list of regions without being used.
    fn are_bounded(&self) -> Vec<bool> {
        let mut bounded = vec![false; self.regions.len()];
        for facet in self.facets.iter().filter(|f| f.back != f.front) {
            bounded[facet.back.index()] = true;
            bounded[facet.front.index()] = true;
        }
        bounded
    }

    fn check_numbers(&self) -> Result<(), SurfaceFault> {
        let [n_vertices, n_regions, n_groups] = [self.vertices.len(), self.regions.len(), self.groups.len()];
        for (f, facet) in self.facets.iter().enumerate() {
            if let Some(&vertex) = facet.vertices.iter().find(|v| v.index() >= n_vertices) {
                return Err(SurfaceFault::BadVertex { facet: f, vertex, n_vertices });
            }
            if let Some(region) = [facet.back, facet.front].into_iter().find(|r| r.index() >= n_regions) {
                return Err(SurfaceFault::BadRegion { facet: f, region, n_regions });
            }
            if let Some(group) = facet.group.filter(|&g| g >= n_groups) {
                return Err(SurfaceFault::BadGroup { facet: f, group, n_groups });
            }
        }
        Ok(())
    }

    fn check_vertices(&self) -> Result<(), SurfaceFault> {
        let mut used = vec![false; self.vertices.len()];
        self.facets.iter().flat_map(|f| f.vertices).for_each(|v| used[v.index()] = true);
        let mut seen = HashMap::with_capacity(self.vertices.len());
        for (v, place) in self.vertices.iter().enumerate() {
            if !place.is_finite() {
                return Err(SurfaceFault::NotFinite { vertex: v });
            }
            if !used[v] {
                return Err(SurfaceFault::LooseVertex { vertex: v });
            }
            // Adding zero makes negative zero positive, so that equal places have equal bits.
            let bits = (*place + DVec3::ZERO).to_array().map(f64::to_bits);
            if let Some(first) = seen.insert(bits, v) {
                return Err(SurfaceFault::SamePlace { first, second: v });
            }
        }
        Ok(())
    }

    /// Around each region, every edge is run as often forwards as backwards.
    fn check_closed(&self) -> Result<(), SurfaceFault> {
        let mut runs: HashMap<(RegionId, VertexId, VertexId), (i32, usize)> = HashMap::new();
        for (f, facet) in self.facets.iter().enumerate() {
            for k in 0..3 {
                let (from, to) = (facet.vertices[k], facet.vertices[(k + 1) % 3]);
                let forwards = if from < to { 1 } else { -1 };
                for (region, sign) in [(facet.back, forwards), (facet.front, -forwards)] {
                    runs.entry((region, from.min(to), from.max(to))).or_insert((0, f)).0 += sign;
                }
            }
        }
        let open = runs.iter().filter(|(_, (balance, _))| *balance != 0);
        // The outside is open where a region is; the region is the better name for it.
        let first =
            open.min_by_key(|((region, from, to), (_, facet))| (region.index() == 0, *facet, *region, *from, *to));
        first.map_or(Ok(()), |(&(region, from, to), &(_, facet))| {
            let at = self.vertices[from.index()].midpoint(self.vertices[to.index()]);
            Err(SurfaceFault::Open { region: self.regions[region.index()].name.clone(), from, to, facet, at })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tet::FaceRole;

    /// Two tetrahedra with a face in common: a dielectric above, air below.
    fn pair() -> Surface {
        let region = |name: &str, role| Region { name: name.into(), role, eps_r: 1.0, tan_delta: 0.0 };
        let facet = |corners: [usize; 3], back, front| SurfaceFacet {
            vertices: corners.map(VertexId::new),
            back: RegionId::new(back),
            front: RegionId::new(front),
            group: (front == 0).then_some(0),
        };
        let vertices = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.25, 0.0], [0.1, 0.1, 1.0], [0.3, 0.2, -1.7]];
        Surface {
            vertices: vertices.map(|v| DVec3::from_array(v) * 1e-3).to_vec(),
            facets: vec![
                facet([0, 2, 1], 1, 2),
                facet([0, 1, 3], 1, 0),
                facet([1, 2, 3], 1, 0),
                facet([2, 0, 3], 1, 0),
                facet([0, 4, 1], 2, 0),
                facet([1, 4, 2], 2, 0),
                facet([2, 4, 0], 2, 0),
            ],
            regions: vec![
                region("outside", RegionRole::Air),
                region("substrate", RegionRole::Dielectric),
                region("air", RegionRole::Air),
                region("pin", RegionRole::Conductor),
            ],
            groups: vec![FaceGroup { name: "outer".into(), role: FaceRole::Outer }],
        }
    }

    fn fault(change: impl FnOnce(&mut Surface)) -> SurfaceFault {
        let mut surface = pair();
        change(&mut surface);
        surface.check().unwrap_err()
    }

    #[test]
    fn a_valid_surface_has_the_volumes_of_its_regions() {
        let surface = pair();
        assert_eq!(surface.check(), Ok(()), "valid");
        let volumes = surface.volumes();
        let base = 1.5 * 2.25 / 6.0 * 1e-9;
        for (found, expected) in volumes.iter().zip([-2.7 * base, base, 1.7 * base, 0.0]) {
            assert!((found - expected).abs() < 1e-24, "{found} is not {expected}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let id = VertexId::new;
        assert_eq!(
            fault(|s| s.facets[2].vertices[1] = id(9)),
            SurfaceFault::BadVertex { facet: 2, vertex: id(9), n_vertices: 5 },
            "vertex"
        );
        let region = RegionId::new(7);
        let bad = SurfaceFault::BadRegion { facet: 3, region, n_regions: 4 };
        assert_eq!(fault(|s| s.facets[3].front = region), bad, "region");
        let bad = SurfaceFault::BadGroup { facet: 0, group: 1, n_groups: 1 };
        assert_eq!(fault(|s| s.facets[0].group = Some(1)), bad, "group");
    }

    #[test]
    fn vertices_that_cannot_be_meant_are_named() {
        assert_eq!(fault(|s| s.vertices[1].y = f64::NAN), SurfaceFault::NotFinite { vertex: 1 }, "NaN");
        assert_eq!(fault(|s| s.vertices.push(DVec3::X)), SurfaceFault::LooseVertex { vertex: 5 }, "in no facet");
        let welded = fault(|s| {
            s.vertices.push(DVec3::new(-0.0, 0.0, 0.0));
            s.facets[3].vertices[1] = VertexId::new(5);
        });
        assert_eq!(welded, SurfaceFault::SamePlace { first: 0, second: 5 }, "not joined");
    }

    #[test]
    fn facets_that_cannot_be_meant_are_named() {
        let flat = fault(|s| s.facets[2].vertices[0] = VertexId::new(2));
        assert_eq!(flat, SurfaceFault::Degenerate { facet: 2 }, "no area");
        let twice = fault(|s| s.facets.push(s.facets[4]));
        assert_eq!(twice, SurfaceFault::Doubled { first: 4, second: 7 }, "twice");
        assert_eq!(fault(|s| s.facets[5].group = None), SurfaceFault::Unmarked { facet: 5 }, "at the outside");
        let metal = fault(|s| s.facets[0].front = RegionId::new(3));
        assert_eq!(metal, SurfaceFault::Unmarked { facet: 0 }, "at a conductor");
    }

    #[test]
    fn a_region_that_is_open_or_inside_out_is_named() {
        let open = |s: SurfaceFault| match s {
            SurfaceFault::Open { region, facet, .. } => (region, facet),
            other => panic!("{other}"),
        };
        assert_eq!(open(fault(|s| s.facets.truncate(6))), ("air".into(), 0), "a facet is missing");
        assert_eq!(open(fault(|s| s.facets[1].vertices.swap(0, 1))), ("substrate".into(), 0), "one is turned around");
        assert_eq!(open(fault(|s| s.facets[1].back = RegionId::new(2))).1, 0, "one names the wrong region");
        let inverted = fault(|s| s.facets.iter_mut().for_each(|f| f.vertices.swap(0, 1)));
        assert!(matches!(inverted, SurfaceFault::InsideOut { ref region, .. } if region == "substrate"), "{inverted}");
    }

    #[test]
    fn a_sheet_inside_a_region_needs_no_closing() {
        let mut surface = pair();
        let v = surface.vertices.len();
        surface
            .vertices
            .extend([[0.1, 0.2, 0.1], [0.2, 0.2, 0.1], [0.1, 0.3, 0.1]].map(|p| DVec3::from_array(p) * 1e-3));
        let vertices = [v, v + 1, v + 2].map(VertexId::new);
        let inside = RegionId::new(1);
        surface.facets.push(SurfaceFacet { vertices, back: inside, front: inside, group: Some(0) });
        assert_eq!(surface.check(), Ok(()), "both its sides are in the substrate");
    }
}
