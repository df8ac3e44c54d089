//! Imported bodies in place of the antenna template: what each is made of, and their welded surface.
//!
//! The surface stands in the project file itself, as it was welded, so that a project can be moved and opens the same
//! wherever the files are that it came from. It is large and never changes by hand: all copies of a project share one.

use super::{MaterialSpec, materials};
use crate::antenna::bodies::{Gap, GapError, MAX_TRIANGLES, gap, upright, weld};
use crate::antenna::{Body, Dielectric, WeldError};
use crate::geometry::{DVec2, DVec3, Facet, Plc, PlcError, Region, RegionId, RegionRole, TriMesh, VertexId};
use crate::io::bodies::Solid;
use crate::io::{Material, Role};
use crate::task::Task;
use crate::units::{from_mm, to_mm};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Bodies of the user's own, welded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodiesSpec {
    /// The bodies, in the order of their regions.
    pub bodies: Vec<BodySpec>,
    /// Distance within which two places became one, mm.
    pub weld_mm: f64,
    /// Their surface.
    pub shape: Shape,
    /// Where they are fed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feed: Option<FeedSpec>,
}

/// A lumped port across a gap between metal: a source with a resistance along a straight line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeedSpec {
    /// One end, on metal, mm.
    pub from_mm: [f64; 3],
    /// The other end, mm.
    pub to_mm: [f64; 3],
    /// Resistance of the source, ohm.
    pub ohm: f64,
}

/// What one body is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySpec {
    /// Name of its region and of its files: `a` to `z`, digits, `-` and `_`.
    pub name: String,
    /// What it is made of.
    pub kind: BodyKind,
}

/// What a body is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyKind {
    /// A perfect conductor.
    Metal,
    /// A dielectric.
    Dielectric(MaterialSpec),
}

/// A body to be welded: its name, what it is made of, and its closed surface in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct LooseBody {
    /// Name and material.
    pub spec: BodySpec,
    /// Its surface, m.
    pub surface: TriMesh,
}

/// The welded surface of all bodies. Copies share it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Geometry", into = "Geometry")]
pub struct Shape(Arc<Checked>);

#[derive(Debug)]
struct Checked {
    geometry: Geometry,
    /// What the check found, once it was asked for.
    verdict: OnceLock<Result<(), BodiesError>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Geometry {
    /// x, y and z of one vertex after the other, mm.
    vertices_mm: Vec<f64>,
    /// Three vertices, then the region that the normal points out of and the one it points into, of one facet after the
    /// other; region 0 is the air, the others are the bodies.
    facets: Vec<u32>,
}

/// Why bodies of a project are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BodiesError {
    /// A name cannot be one of a file.
    #[error(
        "bodies[{index}] is called \"{name}\": use a name of its own of a-z, 0-9, - and _, other than air and certificate"
    )]
    Name {
        /// Place in the list.
        index: usize,
        /// Its name.
        name: String,
    },
    /// A material's number is out of range.
    #[error("bodies[{index}] (\"{name}\") has {quantity} {value}, but it must lie between {lo} and {hi}")]
    Material {
        /// Place in the list.
        index: usize,
        /// Its name.
        name: String,
        /// Which number.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// Smallest allowed.
        lo: f64,
        /// Greatest allowed.
        hi: f64,
    },
    /// The list of numbers does not end where a vertex or a facet does, or names what does not exist.
    #[error("shape: {0}: the file was changed or cut off; import the bodies again")]
    Numbers(&'static str),
    /// The surface is no complex.
    #[error("shape: {0}; import the bodies again")]
    Complex(PlcError),
    /// The feed has no gap.
    #[error("feed: {0}")]
    Feed(#[from] GapError),
    /// The source's resistance is out of range.
    #[error("feed.ohm is {value}, but must lie between {lo} and {hi}")]
    Ohm {
        /// Its value, ohm.
        value: f64,
        /// Smallest allowed.
        lo: f64,
        /// Greatest allowed.
        hi: f64,
    },
    /// With the feed's ends the bodies cannot be welded.
    #[error(transparent)]
    Weld(#[from] WeldError),
    /// A compensation was asked for.
    #[error("imported bodies are deformed as drawn: compensation needs the patch's template; choose none")]
    Compensated,
}

/// Usual distance within which two places become one, mm: some hundred roundings of single precision, and a thirtieth of
/// a thin foil.
pub const WELD_MM: f64 = 0.001;
/// Names of materials that are metal.
const METALS: [&str; 9] = ["metal", "pec", "copper", "silver", "gold", "aluminium", "aluminum", "brass", "conductor"];
/// Range of a source's resistance, ohm.
const OHM: (f64, f64) = (0.1, 10_000.0);
/// Range of a coordinate, mm.
const REACH_MM: f64 = 1e5;

impl PartialEq for Shape {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0.geometry == other.0.geometry
    }
}

impl From<Geometry> for Shape {
    fn from(geometry: Geometry) -> Self {
        Self(Arc::new(Checked { geometry, verdict: OnceLock::new() }))
    }
}

impl From<Shape> for Geometry {
    fn from(shape: Shape) -> Self {
        shape.0.geometry.clone()
    }
}

impl Shape {
    fn of(plc: &Plc) -> Self {
        let facet = |f: &Facet| {
            let [a, b, c] = f.vertices.map(VertexId::raw);
            [a, b, c, f.back.raw(), f.front.raw()]
        };
        let vertices_mm = plc.vertices.iter().flat_map(|v| v.to_array().map(to_mm)).collect();
        Geometry { vertices_mm, facets: plc.facets.iter().flat_map(facet).collect() }.into()
    }

    /// Number of vertices and facets.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        let Geometry { vertices_mm, facets } = &self.0.geometry;
        [vertices_mm.len() / 3, facets.len() / 5]
    }

    fn vertices(&self) -> impl Iterator<Item = DVec3> + '_ {
        let (vertices, _) = self.0.geometry.vertices_mm.as_chunks::<3>();
        vertices.iter().map(|v| DVec3::from_array(v.map(from_mm)))
    }

    fn plc(&self, regions: Vec<Region>) -> Plc {
        let (facets, _) = self.0.geometry.facets.as_chunks::<5>();
        let facet = |&[a, b, c, back, front]: &[u32; 5]| Facet {
            vertices: [a, b, c].map(|v| VertexId::new(v as usize)),
            back: RegionId::new(back as usize),
            front: RegionId::new(front as usize),
        };
        Plc { vertices: self.vertices().collect(), facets: facets.iter().map(facet).collect(), regions }
    }

    fn check(&self, regions: Vec<Region>) -> Result<(), BodiesError> {
        let Geometry { vertices_mm, facets } = &self.0.geometry;
        let [n_vertices, n_facets] = self.counts();
        if vertices_mm.len() % 3 != 0 || facets.len() % 5 != 0 || n_facets == 0 || n_facets > MAX_TRIANGLES {
            return Err(BodiesError::Numbers("vertices have three numbers, facets five, of which there are some"));
        }
        // Not the other way round: NaN is in no range.
        if !vertices_mm.iter().all(|c| c.abs() <= REACH_MM) {
            return Err(BodiesError::Numbers("a coordinate is out of range"));
        }
        let (lists, _) = facets.as_chunks::<5>();
        let n_regions = regions.len();
        let exists = |[a, b, c, back, front]: &[u32; 5]| {
            [a, b, c].iter().all(|v| (**v as usize) < n_vertices)
                && [back, front].iter().all(|r| (**r as usize) < n_regions)
        };
        if !lists.iter().all(exists) {
            return Err(BodiesError::Numbers("a facet names a vertex or a body that does not exist"));
        }
        self.plc(regions).check().map_err(BodiesError::Complex)
    }
}

impl BodyKind {
    /// What a body is made of as its file says, if it does: one of our own exports, or a material by a known name.
    #[must_use]
    pub fn suggested(solid: &Solid) -> Option<Self> {
        if let Some(material) = &solid.material {
            let Material { role, eps_r, tan_delta, .. } = *material;
            let dielectric = || MaterialSpec { name: String::new(), eps_r, tan_delta }.recognized();
            return Some(if role == Role::Conductor { Self::Metal } else { Self::Dielectric(dielectric()) });
        }
        let name = solid.material_name.trim();
        let is_metal = METALS.iter().any(|metal| name.eq_ignore_ascii_case(metal));
        let known = || materials::DIELECTRICS.iter().find(|d| d.name.eq_ignore_ascii_case(name));
        if is_metal { Some(Self::Metal) } else { known().map(|d| Self::Dielectric(d.to_spec())) }
    }
}

impl fmt::Display for BodyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Metal => f.write_str("perfect conductor"),
            Self::Dielectric(m) => write!(f, "eps_r {}, tan delta {}", m.eps_r, m.tan_delta),
        }
    }
}

impl BodySpec {
    fn region(&self) -> Region {
        let (role, Dielectric { eps_r, tan_delta }) = self.made_of();
        Region { name: self.name.clone(), role, eps_r, tan_delta }
    }

    fn made_of(&self) -> (RegionRole, Dielectric) {
        match &self.kind {
            BodyKind::Metal => (RegionRole::Conductor, Dielectric { eps_r: 1.0, tan_delta: 0.0 }),
            BodyKind::Dielectric(material) => (RegionRole::Dielectric, material.to_dielectric()),
        }
    }
}

impl BodiesSpec {
    /// Welds bodies.
    ///
    /// * `weld_mm`: distance within which two places become one, mm.
    ///
    /// # Errors
    /// Everything that is wrong, with the places; or that it was called off.
    pub fn weld(loose: &[LooseBody], weld_mm: f64, task: &Task) -> Result<Self, WeldError> {
        let body = |LooseBody { spec, surface }: &LooseBody| {
            let (role, material) = spec.made_of();
            Body { name: spec.name.clone(), role, material, surface: surface.clone() }
        };
        let plc = weld(&loose.iter().map(body).collect::<Vec<_>>(), &[], from_mm(weld_mm), task)?;
        let bodies = loose.iter().map(|b| b.spec.clone()).collect();
        Ok(Self { bodies, weld_mm, shape: Shape::of(&plc), feed: None })
    }

    /// The same bodies fed across a gap between two places on metal, mm, which become vertices of the shape.
    ///
    /// # Errors
    /// [`BodiesError`] saying what is wrong with the feed.
    pub fn with_feed(&self, ends_mm: [[f64; 3]; 2], ohm: f64) -> Result<Self, BodiesError> {
        let ends = ends_mm.map(|end| DVec3::from_array(end.map(from_mm)));
        let (plc, tolerance) = (self.to_plc(), from_mm(self.weld_mm));
        let body = |(id, region): (RegionId, &Region)| Body {
            name: region.name.clone(),
            role: region.role,
            material: Dielectric { eps_r: region.eps_r, tan_delta: region.tan_delta },
            surface: plc.boundary(id),
        };
        let bodies: Vec<Body> = plc.solids().map(body).collect();
        let plc = weld(&bodies, &ends, tolerance, &Task::default())?;
        let gap = gap(&plc, ends, tolerance)?;
        let [from_mm, to_mm] = gap.ends.map(|v| plc.vertices[v.index()].to_array().map(to_mm));
        let fed = Self { shape: Shape::of(&plc), feed: Some(FeedSpec { from_mm, to_mm, ohm }), ..self.clone() };
        fed.validate()?;
        Ok(fed)
    }

    /// The same bodies fed across the lowest gap between metal above each other at a place, mm.
    ///
    /// # Errors
    /// As [`BodiesSpec::with_feed`].
    pub fn with_upright_feed(&self, [x_mm, y_mm]: [f64; 2], ohm: f64) -> Result<Self, BodiesError> {
        let ends = upright(&self.to_plc(), DVec2::new(from_mm(x_mm), from_mm(y_mm)))?;
        self.with_feed(ends.map(|end| end.to_array().map(to_mm)), ohm)
    }

    /// The feed's gap in the complex, if there is a feed.
    ///
    /// # Errors
    /// [`GapError`] if the feed does not belong to the shape.
    pub fn gap(&self) -> Result<Option<Gap>, GapError> {
        let ends = |feed: FeedSpec| [feed.from_mm, feed.to_mm].map(|end| DVec3::from_array(end.map(from_mm)));
        self.feed.map(|feed| gap(&self.to_plc(), ends(feed), from_mm(self.weld_mm))).transpose()
    }

    fn regions(&self) -> Vec<Region> {
        let air = Region { name: "air".to_owned(), role: RegionRole::Air, eps_r: 1.0, tan_delta: 0.0 };
        std::iter::once(air).chain(self.bodies.iter().map(BodySpec::region)).collect()
    }

    /// The welded complex, m.
    #[must_use]
    pub fn to_plc(&self) -> Plc {
        self.shape.plc(self.regions())
    }

    /// The box around all bodies, m.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.shape.vertices().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
    }

    pub(super) fn validate(&self) -> Result<(), BodiesError> {
        for (index, BodySpec { name, kind }) in self.bodies.iter().enumerate() {
            let is_plain = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, b'-' | b'_');
            let is_taken = self.bodies[..index].iter().any(|b| b.name == *name);
            if name.is_empty() || !name.bytes().all(is_plain) || is_taken || ["air", "certificate"].contains(&&name[..])
            {
                return Err(BodiesError::Name { index, name: name.clone() });
            }
            let BodyKind::Dielectric(material) = kind else { continue };
            for (quantity, value, lo, hi) in
                [("eps_r", material.eps_r, 1.0, 1000.0), ("tan_delta", material.tan_delta, 0.0, 1.0)]
            {
                if !(lo..=hi).contains(&value) {
                    return Err(BodiesError::Material { index, name: name.clone(), quantity, value, lo, hi });
                }
            }
        }
        if let Some(FeedSpec { from_mm, to_mm, ohm }) = self.feed {
            let (lo, hi) = OHM;
            if !(lo..=hi).contains(&ohm) {
                return Err(BodiesError::Ohm { value: ohm, lo, hi });
            }
            if !from_mm.iter().chain(&to_mm).all(|c| c.abs() <= REACH_MM) {
                return Err(BodiesError::Numbers("an end of the feed is out of range"));
            }
        }
        // Of the regions only their number and names count, and a list of another length is another list.
        let n_regions = self.bodies.len() + 1;
        let checked = &self.shape.0;
        let highest = checked.geometry.facets.as_chunks::<5>().0.iter().map(|f| f[3].max(f[4])).max().unwrap_or(0);
        if highest as usize + 1 != n_regions {
            return Err(BodiesError::Numbers("there are more or fewer bodies than the shape has"));
        }
        checked.verdict.get_or_init(|| self.shape.check(self.regions())).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CompensationMode, Edit, History, Project, file};
    use super::*;
    use crate::antenna::bodies::tests::cuboid;

    pub(crate) fn loose(name: &str, kind: BodyKind, body: &Body) -> LooseBody {
        LooseBody { spec: BodySpec { name: name.to_owned(), kind }, surface: body.surface.clone() }
    }

    /// A metal plate on a dielectric one.
    pub(crate) fn plates() -> BodiesSpec {
        let material = MaterialSpec { name: String::new(), eps_r: 2.2, tan_delta: 0.001 };
        let below = cuboid("", [-8.0, -6.0, -1.0], [8.0, 6.0, 0.0], [3, 2, 1]);
        let above = cuboid("", [-3.3, -2.1, 0.0], [4.1, 2.3, 0.1], [1, 1, 1]);
        let bodies = [loose("base", BodyKind::Dielectric(material), &below), loose("top", BodyKind::Metal, &above)];
        BodiesSpec::weld(&bodies, 0.001, &Task::default()).expect("they touch")
    }

    #[test]
    fn bodies_come_back_from_the_file_bit_for_bit_and_undo_takes_them_away() {
        let mut history = History::new(Project::default());
        let before = history.project().clone();
        history.apply(Edit::SetBodies(Some(Box::new(plates())))).expect("valid");
        let project = history.project().clone();
        assert_eq!(project.settings.compensation, CompensationMode::None, "as drawn");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        file::write(&path, &project).expect("valid");
        let back = file::read(&path).expect("just written");
        assert_eq!(back, project, "the same");
        assert_eq!(back.bodies.expect("bodies").to_plc(), plates().to_plc(), "the same surface");
        assert!(history.undo(), "one step");
        assert_eq!(*history.project(), before, "undone");
    }

    #[test]
    fn spoiled_bodies_are_refused_by_name() {
        type Spoil = fn(&mut Project);
        let bodies = |p: &mut Project| p.bodies.take().expect("bodies");
        let faults: [(&str, Spoil); 5] = [
            ("bodies: bodies[1] is called \"base\"", |p| {
                p.bodies.as_mut().expect("bodies").bodies[1].name = "base".to_owned();
            }),
            ("bodies: bodies[0] is called \"Base\"", |p| {
                p.bodies.as_mut().expect("bodies").bodies[0].name = "Base".to_owned();
            }),
            ("bodies: shape: there are more or fewer bodies", |p| {
                p.bodies.as_mut().expect("bodies").bodies.truncate(1);
            }),
            ("bodies: imported bodies are deformed as drawn", |p| {
                p.settings.compensation = CompensationMode::Wl;
            }),
            ("bodies: bodies[0] (\"base\") has eps_r 0.5", |p| {
                let material = MaterialSpec { name: String::new(), eps_r: 0.5, tan_delta: 0.0 };
                p.bodies.as_mut().expect("bodies").bodies[0].kind = BodyKind::Dielectric(material);
            }),
        ];
        let mut good = Project::default();
        Edit::SetBodies(Some(Box::new(plates()))).apply(&mut good).expect("valid");
        for (start, spoil) in faults {
            let mut project = good.clone();
            spoil(&mut project);
            let message = project.validate().expect_err("spoiled").to_string();
            assert!(message.starts_with(start), "{start}: {message}");
        }
        let open = {
            let mut project = good;
            let spec = bodies(&mut project);
            let mut geometry = spec.shape.0.geometry.clone();
            geometry.facets.truncate(geometry.facets.len() - 5);
            project.bodies = Some(BodiesSpec { shape: geometry.into(), ..spec });
            project
        };
        let message = open.validate().expect_err("a facet is missing").to_string();
        assert!(message.contains("is open at the edge"), "{message}");
    }
}
