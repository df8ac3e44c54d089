//! The geometric proof behind the certificate, from the triangles of the STL files alone.
//!
//! Enters: each solid's loose triangles in millimetres. Leaves: what the certificate states, and every fault found.
//!
//! 1. Corners are welded where they agree bit for bit, over all solids, so that "shared" means "the same bytes".
//! 2. Each solid alone: closed, consistently outward, one fan of triangles around each vertex (a 2-manifold), stored
//!    normals along the winding; Euler characteristic, volume and area.
//! 3. Facets with the same corners in two solids are an interface; they must run in opposite directions, and no third
//!    solid may have them.
//! 4. No gap and no T-junction: a vertex of one solid that is not one of another's keeps a distance from its surface.
//! 5. No two triangles cross (only asked where all else holds).
//!
//! A gap opened by moving one solid's vertices leaves them near a surface that no longer has them, which 4 finds
//! without knowing the original; a facet count that no longer agrees with the certificate finds the rest.

use super::certificate::stl_name;
use super::stl::{Triangle, normal_of, widen};
use super::weld::{Weld, are_opposite, undirected};
use crate::geometry::bvh::{Aabb, Bvh};
use crate::geometry::intersect::crossings;
use crate::geometry::{DVec3, SurfaceError, TriMesh, VertexId};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt;

/// How far around a vertex another solid's surface is looked for, mm.
///
/// Twice the gap of a micrometre that has to be found, and below a tenth of the thinnest foil in use (35 micrometres):
/// a larger value would come upon honest neighbors, a smaller one miss gaps.
pub const CLEARANCE_MM: f64 = 2e-3;

/// A stored normal may differ from the winding's by this much (single precision and other writers' rounding).
const NORMAL_TOLERANCE: f64 = 1e-3;

/// What is proved of one solid; lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidShape {
    /// Every edge has two triangles, every vertex one fan, and all normals point outwards.
    pub closed_2_manifold: bool,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of different vertices.
    pub vertices: usize,
    /// Vertices minus edges plus triangles: 2 for a ball, 0 for a body with one hole.
    pub euler_characteristic: i64,
    /// Enclosed volume.
    pub volume_mm3: f64,
    /// Surface area.
    pub area_mm2: f64,
}

/// Two solids that touch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Interface {
    /// Names of the solids, in order of the regions.
    pub solids: [String; 2],
    /// Facets that both files hold, bit for bit, in opposite directions.
    pub shared_facets: usize,
}

/// One thing that is not as it should be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A file that the certificate names is not there or cannot be read.
    #[error("cannot be read: {reason}")]
    Unreadable {
        /// Why.
        reason: String,
    },
    /// A file in the folder that the certificate does not name.
    #[error("is not named by the certificate: left from another export? Delete it or move it away")]
    Stray,
    /// The bytes are not those that were certified.
    #[error("was changed after the export: its SHA-256 is not the certified one")]
    Changed,
    /// The surface of a solid is not closed and outward.
    #[error("{source}, near {place_mm}")]
    NotClosed {
        /// What is wrong.
        source: SurfaceError,
        /// Where.
        place_mm: PlaceMm,
    },
    /// Two parts of a solid touch in a single vertex.
    #[error("the surface touches itself in the vertex at {place_mm}")]
    Pinched {
        /// Where.
        place_mm: PlaceMm,
    },
    /// A stored normal contradicts the order of the corners.
    #[error("the stored normal of triangle {triangle} does not agree with its corners, near {place_mm}")]
    Normal {
        /// Index in the file.
        triangle: usize,
        /// Where.
        place_mm: PlaceMm,
    },
    /// Two solids lie on the same side of a facet.
    #[error("overlaps \"{other}\" at the facet near {place_mm}")]
    Overlap {
        /// The other solid.
        other: String,
        /// Where.
        place_mm: PlaceMm,
    },
    /// A vertex lies on or almost on another solid without being one of its vertices.
    #[error(
        "gap or T-junction: the vertex at {place_mm} is {distance_mm:.3e} mm from \"{other}\" and not a vertex of it"
    )]
    Gap {
        /// The other solid.
        other: String,
        /// How far apart.
        distance_mm: f64,
        /// Where.
        place_mm: PlaceMm,
    },
    /// Two triangles cross.
    #[error("crosses \"{other}\" near {place_mm}")]
    Crossing {
        /// The other solid, or the same.
        other: String,
        /// Where.
        place_mm: PlaceMm,
    },
    /// A quantity is not the certified one.
    #[error("{quantity} is {found}, but {certified} is certified")]
    Differs {
        /// What.
        quantity: &'static str,
        /// Its value now.
        found: String,
        /// Its value in the certificate.
        certified: String,
    },
    /// Another format's file does not hold the same triangles as the STL file.
    #[error("does not agree with {stl}: {what}")]
    Disagrees {
        /// The STL file.
        stl: String,
        /// In what.
        what: String,
    },
}

/// A place in the export, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceMm(pub [f64; 3]);

impl fmt::Display for PlaceMm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "({x:.6}, {y:.6}, {z:.6}) mm")
    }
}

impl From<DVec3> for PlaceMm {
    fn from(p: DVec3) -> Self {
        Self(p.to_array())
    }
}

/// A fault and the file it is in.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Name of the file in the export's folder.
    pub file: String,
    /// What is wrong with it.
    pub fault: Fault,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.fault)
    }
}

/// One solid as its STL file has it.
#[derive(Debug)]
pub(super) struct Solid {
    pub(super) region: String,
    pub(super) triangles: Vec<Triangle>,
}

/// All that was proved, and what could not be.
#[derive(Debug)]
pub(super) struct Proof {
    pub(super) solids: Vec<SolidShape>,
    pub(super) interfaces: Vec<Interface>,
    pub(super) clearance_mm: f64,
    pub(super) findings: Vec<Finding>,
}

/// Proves what can be proved of the solids.
///
/// * `clearance_mm`: a vertex closer than this to another solid that it does not belong to is a fault.
pub(super) fn prove(solids: &[Solid], clearance_mm: f64) -> Proof {
    let mut proof =
        Proof { solids: Vec::new(), interfaces: Vec::new(), clearance_mm: CLEARANCE_MM, findings: Vec::new() };
    let mut weld = Weld::default();
    let mut faces = Vec::with_capacity(solids.len());
    for solid in solids {
        let shape = proof.shape(solid);
        proof.solids.push(shape);
        faces.push(solid.triangles.iter().map(|t| t.corners.map(|c| weld.vertex(widen(c)))).collect());
    }
    let complex = Complex { solids, vertices: weld.vertices, faces };
    proof.interfaces(&complex);
    proof.clearances(&complex, clearance_mm);
    if proof.findings.is_empty() {
        proof.crossings(&complex);
    }
    proof
}

/// All solids over common vertices, `faces[solid][triangle]`.
struct Complex<'a> {
    solids: &'a [Solid],
    vertices: Vec<DVec3>,
    faces: Vec<Vec<[VertexId; 3]>>,
}

impl Complex<'_> {
    fn corners(&self, face: [VertexId; 3]) -> [DVec3; 3] {
        face.map(|v| self.vertices[v.index()])
    }
}

impl Proof {
    fn find(&mut self, solid: &Solid, fault: Fault) {
        self.findings.push(Finding { file: stl_name(&solid.region), fault });
    }

    fn shape(&mut self, solid: &Solid) -> SolidShape {
        let mut weld = Weld::default();
        let faces: Vec<_> = solid.triangles.iter().map(|t| t.corners.map(|c| weld.vertex(widen(c)))).collect();
        let mesh = TriMesh { vertices: weld.vertices, faces };
        let fault = mesh.check().map_or_else(
            |source| Some(Fault::NotClosed { place_mm: place(&mesh, &source).into(), source }),
            |()| pinch(&mesh).map(|v| Fault::Pinched { place_mm: mesh.vertices[v.index()].into() }),
        );
        let closed_2_manifold = fault.is_none();
        if let Some(fault) = fault {
            self.find(solid, fault);
        }
        let against = |t: &Triangle| {
            let stored = widen(t.normal);
            stored != DVec3::ZERO && (stored - normal_of(&t.corners)).length() > NORMAL_TOLERANCE
        };
        if let Some(triangle) = solid.triangles.iter().position(against) {
            self.find(solid, Fault::Normal { triangle, place_mm: mesh.corners(triangle)[0].into() });
        }
        let edges: HashSet<_> = mesh.faces.iter().flat_map(directed_edges).map(|(a, b)| (a.min(b), a.max(b))).collect();
        let signed = |n: usize| i64::try_from(n).expect("counts of a file fit in 63 bits");
        SolidShape {
            closed_2_manifold,
            triangles: mesh.faces.len(),
            vertices: mesh.vertices.len(),
            euler_characteristic: signed(mesh.vertices.len()) - signed(edges.len()) + signed(mesh.faces.len()),
            volume_mm3: mesh.volume(),
            area_mm2: mesh.area(),
        }
    }

    fn interfaces(&mut self, complex: &Complex<'_>) {
        let mut known: HashMap<[VertexId; 3], (usize, [VertexId; 3], bool)> = HashMap::new();
        let mut counts: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for (s, faces) in complex.faces.iter().enumerate() {
            for &face in faces {
                let Some((first, other, shared)) = known.get_mut(&undirected(face)) else {
                    known.insert(undirected(face), (s, face, false));
                    continue;
                };
                if *first == s {
                    continue; // Doubled within one solid: already found not to be closed.
                }
                if *shared || !are_opposite(*other, face) {
                    let other = complex.solids[*first].region.clone();
                    let place_mm = complex.corners(face)[0].into();
                    self.find(&complex.solids[s], Fault::Overlap { other, place_mm });
                    continue;
                }
                *shared = true;
                *counts.entry([*first, s]).or_default() += 1;
            }
        }
        let named = |pair: [usize; 2]| pair.map(|s| complex.solids[s].region.clone());
        self.interfaces =
            counts.into_iter().map(|(pair, shared_facets)| Interface { solids: named(pair), shared_facets }).collect();
    }

    fn clearances(&mut self, complex: &Complex<'_>, least_mm: f64) {
        let used: Vec<HashSet<VertexId>> =
            complex.faces.iter().map(|faces| faces.iter().flatten().copied().collect()).collect();
        for (b, faces) in complex.faces.iter().enumerate() {
            let bvh = Bvh::new(faces.iter().map(|&f| Aabb::around(&complex.corners(f))).collect());
            for (a, solid) in complex.solids.iter().enumerate().filter(|&(a, _)| a != b) {
                let mut strangers: Vec<VertexId> = used[a].difference(&used[b]).copied().collect();
                strangers.sort_unstable();
                let mut nearest = (CLEARANCE_MM, None);
                for v in strangers {
                    let p = complex.vertices[v.index()];
                    let around = Aabb { lo: p - DVec3::splat(CLEARANCE_MM), hi: p + DVec3::splat(CLEARANCE_MM) };
                    bvh.for_each_meeting(&around, |f| {
                        let distance = distance(p, complex.corners(faces[f]));
                        if distance < nearest.0 {
                            nearest = (distance, Some(p));
                        }
                    });
                }
                let (distance_mm, place) = nearest;
                self.clearance_mm = self.clearance_mm.min(distance_mm);
                if let Some(place) = place.filter(|_| distance_mm < least_mm) {
                    let other = complex.solids[b].region.clone();
                    self.find(solid, Fault::Gap { other, distance_mm, place_mm: place.into() });
                }
            }
        }
    }

    fn crossings(&mut self, complex: &Complex<'_>) {
        let mut seen = HashSet::new();
        let mut owners = Vec::new();
        let mut faces = Vec::new();
        for (s, face) in complex.faces.iter().enumerate().flat_map(|(s, fs)| fs.iter().map(move |&f| (s, f))) {
            if seen.insert(undirected(face)) {
                owners.push(s);
                faces.push(face);
            }
        }
        let mut told = HashSet::new();
        for crossing in crossings(&complex.vertices, &faces) {
            let [first, second] = [crossing.first, crossing.second].map(|f| owners[f.index()]);
            if told.insert((first, second)) {
                let other = complex.solids[second].region.clone();
                let place_mm = complex.corners(faces[crossing.first.index()])[0].into();
                self.find(&complex.solids[first], Fault::Crossing { other, place_mm });
            }
        }
    }
}

fn directed_edges([a, b, c]: &[VertexId; 3]) -> [(VertexId, VertexId); 3] {
    [(*a, *b), (*b, *c), (*c, *a)]
}

/// Where a surface is not closed.
fn place(mesh: &TriMesh, error: &SurfaceError) -> DVec3 {
    let vertex = match *error {
        SurfaceError::OpenEdge { from, .. } | SurfaceError::DoubledEdge { from, .. } => Some(from),
        SurfaceError::NotFinite { vertex } | SurfaceError::BadIndex { vertex, .. } => Some(vertex),
        SurfaceError::Degenerate { face } => Some(mesh.faces[face.index()][0]),
        SurfaceError::Empty | SurfaceError::InsideOut { .. } => None,
    };
    vertex.and_then(|v| mesh.vertices.get(v.index())).or_else(|| mesh.vertices.first()).copied().unwrap_or_default()
}

/// A vertex of a closed surface around which the triangles form more than one fan.
fn pinch(mesh: &TriMesh) -> Option<VertexId> {
    // next[(v, a)] = b for each triangle v a b: one step around v.
    let mut next = HashMap::with_capacity(3 * mesh.faces.len());
    let mut fans: Vec<(usize, Option<VertexId>)> = vec![(0, None); mesh.vertices.len()];
    for &[a, b, c] in &mesh.faces {
        for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            next.insert((v, from), to);
            fans[v.index()].0 += 1;
            fans[v.index()].1 = Some(from);
        }
    }
    (0..fans.len()).map(VertexId::new).find(|&v| {
        let (count, Some(start)) = fans[v.index()] else { return false };
        let mut at = start;
        let mut steps = 0;
        while let Some(&to) = next.get(&(v, at)) {
            steps += 1;
            at = to;
            if at == start || steps > count {
                break;
            }
        }
        steps != count
    })
}

/// Distance between a point and a triangle.
fn distance(p: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    let inside = edges.iter().all(|&(from, to)| (to - from).cross(p - from).dot(normal) >= 0.0);
    if inside && normal != DVec3::ZERO {
        return ((p - a).dot(normal) / normal.length()).abs();
    }
    let to_segment = |&(from, to): &(DVec3, DVec3)| {
        let along = to - from;
        let t = ((p - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (p - from - along * t).length()
    };
    edges.iter().map(to_segment).fold(f64::INFINITY, f64::min)
}
