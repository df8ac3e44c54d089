//! A surface complex to be filled with tetrahedra, as JSON: the way in for geometry made elsewhere.
//!
//! One object, millimetres, all numbers counted from 0; it may be compressed with gzip (told by its first bytes):
//!
//! | Key | Holds |
//! |---|---|
//! | `regions` | name by region number, without gaps: `{"0": "outside", "1": "substrate", ...}`; 0 is the outside |
//! | `role` (may be left out) | `air`, `dielectric` or `conductor` by region number |
//! | `eps_r`, `tan_delta` (may be left out) | relative permittivity (else 1) and loss tangent (else 0) by region number |
//! | `sheet` | name by tag: `{"0": "interface", "1": "PEC sheet", ...}`; 0 is no boundary condition |
//! | `sheet_role` (may be left out) | `conductor`, `port` or `outer` by tag |
//! | `V` | vertices `[x, y, z]`, mm |
//! | `F` | facets, three vertex numbers each |
//! | `region_pair` | per facet `[left, right]`; the normal (right-hand rule) points from the left region into the right one |
//! | `sheet_tag` | per facet |
//!
//! A region without a role is a conductor if its name has "metal" in it, air if it has "air", else a dielectric. A tag
//! without a role must be called `PEC sheet` (group `pec`), `port` (`port1`) or `sphere` (`outer`); with one, its name is
//! the group's. The wave of a port enters its left region. What bounds a conductor is one: such facets of tag 0 or of a
//! port are put into the group `pec`, since no wave enters metal. A key that is not listed, a number that does not
//! exist and a surface that cannot be filled ([`Surface::check`]) are refused with the place.

use super::certificate::Role;
use super::decimal::{MM_DIGITS, shifted_digits};
use super::error::{IoError, ParseError, Place, read};
use super::write_atomic_with;
use crate::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use crate::tet::{FaceGroup, FaceRole, Surface, SurfaceFacet};
use crate::units::from_mm;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};
use std::path::Path;

const GZIP: [u8; 2] = [0x1F, 0x8B];
/// Longest text that a compressed file may unfold to, bytes; ten million facets have about half of it.
const LONGEST_TEXT: u64 = 1 << 30;
/// Group of the conductors' surfaces where no tag names one.
const PEC: &str = "pec";

type ByNumber<T> = BTreeMap<u32, T>;

/// The file as it stands.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    regions: ByNumber<String>,
    #[serde(default)]
    role: ByNumber<Role>,
    #[serde(default)]
    eps_r: ByNumber<f64>,
    #[serde(default)]
    tan_delta: ByNumber<f64>,
    sheet: ByNumber<String>,
    #[serde(default)]
    sheet_role: ByNumber<SheetRole>,
    #[serde(rename = "V")]
    vertices: Vec<[f64; 3]>,
    #[serde(rename = "F")]
    facets: Vec<[u32; 3]>,
    region_pair: Vec<[u32; 2]>,
    sheet_tag: Vec<u32>,
}

/// [`FaceRole`] as the file spells it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SheetRole {
    Conductor,
    Port,
    Outer,
}

impl From<FaceRole> for SheetRole {
    fn from(role: FaceRole) -> Self {
        match role {
            FaceRole::Conductor => Self::Conductor,
            FaceRole::Port => Self::Port,
            FaceRole::Outer => Self::Outer,
        }
    }
}

impl From<SheetRole> for FaceRole {
    fn from(role: SheetRole) -> Self {
        match role {
            SheetRole::Conductor => Self::Conductor,
            SheetRole::Port => Self::Port,
            SheetRole::Outer => Self::Outer,
        }
    }
}

/// Reads a surface.
///
/// # Errors
/// [`IoError::Malformed`] with the key and the index; [`IoError::BadSurface`] for a surface that cannot be filled.
pub fn read_surface(path: &Path) -> Result<Surface, IoError> {
    let surface = parse(&read(path)?).map_err(|e| e.at(path))?;
    surface.check().map_err(|source| IoError::BadSurface { path: path.to_owned(), source })?;
    Ok(surface)
}

/// Writes a surface so that [`read_surface`] gives it back, but for the rounding of coordinates to mm and back.
///
/// # Errors
/// [`IoError::BadSurface`] for a surface that cannot be filled; [`IoError::System`].
pub fn write_surface(surface: &Surface, path: &Path) -> Result<(), IoError> {
    surface.check().map_err(|source| IoError::BadSurface { path: path.to_owned(), source })?;
    let document = Document::of(surface);
    write_atomic_with(path, |out| serde_json::to_writer(out, &document).map_err(io::Error::from))
}

/// Reads a surface from bytes; whether it can be filled is not yet checked.
///
/// # Errors
/// [`ParseError`] with the key and the index.
pub fn parse(bytes: &[u8]) -> Result<Surface, ParseError> {
    let text = unfold(bytes)?;
    let mut json = serde_json::Deserializer::from_slice(&text);
    let document: Document = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let what = format!("{}: not what belongs here: {}", error.path(), error.inner());
        ParseError::new(Place::Line(error.inner().line()), what)
    })?;
    json.end().map_err(|error| ParseError::json(&error))?;
    document.into_surface()
}

fn unfold(bytes: &[u8]) -> Result<Cow<'_, [u8]>, ParseError> {
    if !bytes.starts_with(&GZIP) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut text = Vec::new();
    let unfolded = flate2::read::MultiGzDecoder::new(bytes).take(LONGEST_TEXT + 1).read_to_end(&mut text);
    unfolded.map_err(|e| ParseError::new(Place::File, format!("cannot be decompressed: {e}")))?;
    if text.len() as u64 > LONGEST_TEXT {
        return Err(ParseError::new(Place::File, "is longer than 1 GiB once decompressed"));
    }
    Ok(Cow::Owned(text))
}

impl Document {
    fn into_surface(self) -> Result<Surface, ParseError> {
        let regions = self.regions()?;
        let n_facets = self.facets.len();
        for (key, length) in [("region_pair", self.region_pair.len()), ("sheet_tag", self.sheet_tag.len())] {
            if length != n_facets {
                let what = format!("{key} has {length} entries, but F has {n_facets}: one per facet is needed");
                return Err(ParseError::new(Place::File, what));
            }
        }
        let sheets = self.sheets()?;
        let mut facets = Vec::with_capacity(n_facets);
        for (f, (&[a, b, c], &[left, right])) in self.facets.iter().zip(&self.region_pair).enumerate() {
            let corners = [a, b, c].map(|v| v as usize);
            if let Some(v) = corners.iter().find(|&&v| v >= self.vertices.len()) {
                let what = format!("names vertex {v}, but V has {} entries", self.vertices.len());
                return Err(ParseError::new(Place::Element("F", f), what));
            }
            let sides = [left, right].map(|r| r as usize);
            if let Some(r) = sides.iter().find(|&&r| r >= regions.len()) {
                let what = format!("names region {r}, which is not in \"regions\"");
                return Err(ParseError::new(Place::Element("region_pair", f), what));
            }
            let Some(&named) = sheets.by_tag.get(&self.sheet_tag[f]) else {
                let what = format!("names tag {}, which is not in \"sheet\"", self.sheet_tag[f]);
                return Err(ParseError::new(Place::Element("sheet_tag", f), what));
            };
            let [is_metal, other_is_metal] = sides.map(|r| regions[r].role == RegionRole::Conductor);
            let bounds_metal = is_metal != other_is_metal && !sides.contains(&0);
            let gives_way = named.is_none_or(|g| sheets.groups[g].role == FaceRole::Port);
            let group = if bounds_metal && gives_way { Some(sheets.pec) } else { named };
            let [back, front] = sides.map(RegionId::new);
            facets.push(SurfaceFacet { vertices: corners.map(VertexId::new), back, front, group });
        }
        let vertices = self.vertices.iter().map(|v| DVec3::from_array(v.map(from_mm))).collect();
        let groups = keep_used(sheets.groups, &mut facets);
        Ok(Surface { vertices, facets, regions, groups })
    }

    /// The groups that tags stand for, in the order of the tags.
    fn sheets(&self) -> Result<Sheets, ParseError> {
        let mut groups: Vec<FaceGroup> = Vec::new();
        let mut by_tag = BTreeMap::new();
        for (&tag, name) in &self.sheet {
            let (name, role) = match (tag, name.as_str(), self.sheet_role.get(&tag)) {
                (0, _, _) => {
                    by_tag.insert(0, None);
                    continue;
                }
                (_, name, Some(&role)) => (name, role.into()),
                (_, "PEC sheet", None) => (PEC, FaceRole::Conductor),
                (_, "port", None) => ("port1", FaceRole::Port),
                (_, "sphere", None) => ("outer", FaceRole::Outer),
                _ => {
                    let what = format!(
                        "\"{name}\" is not known: call it \"PEC sheet\", \"port\" or \"sphere\", or give its role in \"sheet_role\""
                    );
                    return Err(ParseError::new(Place::Element("sheet", tag as usize), what));
                }
            };
            let group = number_of(&mut groups, FaceGroup { name: name.to_owned(), role });
            by_tag.insert(tag, Some(group));
        }
        let pec = number_of(&mut groups, FaceGroup { name: PEC.to_owned(), role: FaceRole::Conductor });
        let names: BTreeSet<&str> = groups.iter().map(|g| g.name.as_str()).collect();
        if names.len() < groups.len() {
            let what = "\"sheet\" has a name with two roles, or a \"pec\" that is no conductor";
            return Err(ParseError::new(Place::File, what));
        }
        Ok(Sheets { groups, by_tag, pec })
    }

    fn regions(&self) -> Result<Vec<Region>, ParseError> {
        let mut regions: Vec<Region> = Vec::with_capacity(self.regions.len());
        for ((&number, name), expected) in self.regions.iter().zip(0_u32..) {
            let fault = |what| Err(ParseError::new(Place::Element("regions", number as usize), what));
            if number != expected {
                return fault(format!("stands where {expected} is expected: regions are numbered from 0 without gaps"));
            }
            if name.is_empty() || regions.iter().any(|r| r.name == *name) {
                return fault(format!("\"{name}\" is empty or the name of another region"));
            }
            let lower = name.to_lowercase();
            let role = match self.role.get(&number) {
                Some(&role) => role.into(),
                None if number == 0 || lower.contains("air") => RegionRole::Air,
                None if lower.contains("metal") => RegionRole::Conductor,
                None => RegionRole::Dielectric,
            };
            let eps_r = self.eps_r.get(&number).copied().unwrap_or(1.0);
            let tan_delta = self.tan_delta.get(&number).copied().unwrap_or(0.0);
            regions.push(Region { name: name.clone(), role, eps_r, tan_delta });
        }
        self.check_materials(&regions)?;
        Ok(regions)
    }

    /// Materials belong to dielectrics that exist, and are such as matter has.
    fn check_materials(&self, regions: &[Region]) -> Result<(), ParseError> {
        let role = self.role.keys().map(|&r| ("role", r, true));
        let eps_r = self.eps_r.iter().map(|(&r, &eps_r)| ("eps_r", r, eps_r > 0.0 && eps_r.is_finite()));
        let loss = self.tan_delta.iter().map(|(&r, &tan)| ("tan_delta", r, tan >= 0.0 && tan.is_finite()));
        for (key, number, good) in role.chain(eps_r).chain(loss) {
            let what = match regions.get(number as usize) {
                None => "there is no such region",
                Some(r) if key != "role" && r.role != RegionRole::Dielectric => "this region is no dielectric",
                _ if !good => "eps_r must be above 0, and tan_delta 0 or above",
                _ => continue,
            };
            return Err(ParseError::new(Place::Element(key, number as usize), what));
        }
        Ok(())
    }

    fn of(surface: &Surface) -> Self {
        let by_number = |value: fn(&Region) -> f64| {
            let regions = (0_u32..).zip(&surface.regions);
            regions.filter(|(_, r)| r.role == RegionRole::Dielectric).map(|(n, r)| (n, value(r))).collect()
        };
        let mm = |c: f64| shifted_digits(c, MM_DIGITS).parse().expect("digits of a finite number");
        let interface = std::iter::once((0, "interface".to_owned()));
        let tag = |group: Option<usize>| group.map_or(0, |g| RegionId::new(g + 1).raw());
        Self {
            regions: (0..).zip(surface.regions.iter().map(|r| r.name.clone())).collect(),
            role: (0..).zip(surface.regions.iter().map(|r| Role::from(r.role))).collect(),
            eps_r: by_number(|r| r.eps_r),
            tan_delta: by_number(|r| r.tan_delta),
            sheet: interface.chain((1..).zip(surface.groups.iter().map(|g| g.name.clone()))).collect(),
            sheet_role: (1..).zip(surface.groups.iter().map(|g| g.role.into())).collect(),
            vertices: surface.vertices.iter().map(|v| v.to_array().map(mm)).collect(),
            facets: surface.facets.iter().map(|f| f.vertices.map(VertexId::raw)).collect(),
            region_pair: surface.facets.iter().map(|f| [f.back, f.front].map(RegionId::raw)).collect(),
            sheet_tag: surface.facets.iter().map(|f| tag(f.group)).collect(),
        }
    }
}

/// What the tags stand for.
struct Sheets {
    groups: Vec<FaceGroup>,
    /// Index into `groups`; none for tag 0.
    by_tag: ByNumber<Option<usize>>,
    /// Index of the group of conductors.
    pec: usize,
}

/// The number of a group in the list, where it is put if it is new.
fn number_of(groups: &mut Vec<FaceGroup>, group: FaceGroup) -> usize {
    groups.iter().position(|g| *g == group).unwrap_or_else(|| {
        groups.push(group);
        groups.len() - 1
    })
}

/// The groups that a facet carries; the facets' numbers follow.
fn keep_used(groups: Vec<FaceGroup>, facets: &mut [SurfaceFacet]) -> Vec<FaceGroup> {
    let used: BTreeSet<usize> = facets.iter().filter_map(|f| f.group).collect();
    for facet in facets {
        facet.group = facet.group.map(|group| used.range(..group).count());
    }
    groups.into_iter().enumerate().filter(|(g, _)| used.contains(g)).map(|(_, group)| group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tet::SurfaceFault;
    use serde_json::{Value, json};
    use std::path::PathBuf;

    fn golden(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/mesh").join(format!("{name}.json.gz"))
    }

    fn count(surface: &Surface, name: &str) -> usize {
        let group = surface.groups.iter().position(|g| g.name == name);
        surface.facets.iter().filter(|f| f.group.is_some() && f.group == group).count()
    }

    /// Two tetrahedra with a face in common: a substrate above, metal below.
    fn pair() -> Value {
        json!({
            "regions": {"0": "outside", "1": "substrate", "2": "pin metal"},
            "sheet": {"0": "interface", "1": "PEC sheet", "2": "port", "3": "sphere"},
            "V": [[0, 0, 0], [1.5, 0, 0], [0, 2.25, 0], [0.1, 0.1, 1], [0.3, 0.2, -1.7]],
            "F": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 4, 1], [1, 4, 2], [2, 4, 0]],
            "region_pair": [[1, 2], [1, 0], [1, 0], [1, 0], [2, 0], [2, 0], [2, 0]],
            "sheet_tag": [0, 3, 3, 1, 0, 0, 0]
        })
    }

    fn changed(change: impl FnOnce(&mut Value)) -> Result<Surface, ParseError> {
        let mut document = pair();
        change(&mut document);
        parse(document.to_string().as_bytes())
    }

    /// Volumes of what is filled, mm³, as four other mesh programs found them on the same surfaces.
    #[test]
    fn golden_surfaces_have_the_volumes_that_other_programs_filled() {
        for (name, volume_mm3) in [("flat_A", 112_847.699_41), ("R10_A", 112_847.705_75), ("R6.5_C", 112_852.951_60)] {
            let surface = read_surface(&golden(name)).unwrap();
            let filled = (1..surface.regions.len()).filter(|&r| surface.regions[r].role != RegionRole::Conductor);
            let volumes = surface.volumes();
            let found = filled.map(|r| volumes[r]).sum::<f64>() * 1e9;
            assert!((found - volume_mm3).abs() < 1e-5, "{name}: {found} mm³ is not {volume_mm3}");
        }
    }

    #[test]
    fn golden_surfaces_have_their_groups() {
        let names = |s: &Surface| s.groups.iter().map(|g| g.name.clone()).collect::<Vec<_>>();
        for name in ["flat_A", "R10_A"] {
            let surface = read_surface(&golden(name)).unwrap();
            assert_eq!((surface.vertices.len(), surface.facets.len()), (5989, 12036), "{name}");
            assert_eq!(names(&surface), ["pec", "port1", "outer"], "{name}");
            // 3309 + 432 sheets, 120 + 80 facets of the pin that have no tag, and its two ends.
            let counts = ["pec", "port1", "outer"].map(|g| count(&surface, g));
            assert_eq!(counts, [3309 + 432 + 120 + 80 + 18 + 18, 232, 5120], "{name}");
            let port = surface.facets.iter().filter(|f| f.group == Some(1));
            assert!(
                port.into_iter().all(|f| (f.back.index(), f.front.index()) == (2, 3)),
                "{name}: coax behind, air before"
            );
        }
        let surface = read_surface(&golden("R6.5_C")).unwrap();
        assert_eq!(names(&surface), ["pec", "outer"], "no port without a coax");
        let roles: Vec<_> = surface.regions.iter().map(|r| r.role).collect();
        let [air, dielectric, metal] = [RegionRole::Air, RegionRole::Dielectric, RegionRole::Conductor];
        assert_eq!(roles, [air, dielectric, dielectric, air, metal, metal, metal], "by name");
    }

    #[test]
    fn what_is_written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("surface.json");
        let mut surface = read_surface(&golden("flat_A")).unwrap();
        surface.groups[0].name = "pec_patch".to_owned();
        surface.regions[1].eps_r = 2.33;
        surface.regions[1].tan_delta = 0.0012;
        surface.regions[4].name = "patch".to_owned();
        write_surface(&surface, &path).unwrap();
        let back = read_surface(&path).unwrap();
        assert_eq!(back.regions, surface.regions, "names, roles and materials");
        assert_eq!(back.groups, surface.groups, "groups");
        assert_eq!(back.facets, surface.facets, "facets");
        for (found, expected) in back.vertices.iter().zip(&surface.vertices) {
            assert!(found.distance(*expected) <= 4.0 * f64::EPSILON * expected.length(), "{found} is not {expected}");
        }
    }

    #[test]
    fn what_bounds_metal_conducts() {
        let surface = changed(|d| d["sheet_tag"][0] = json!(2)).unwrap();
        assert_eq!(surface.check(), Ok(()), "valid");
        assert_eq!(surface.groups[surface.facets[0].group.unwrap()].name, "pec", "no port at metal");
        assert_eq!(surface.facets[4].group, None, "nothing between metal and the outside");
        assert_eq!(changed(|_| ()).unwrap().facets[0].group, surface.facets[0].group, "nor without a tag");
    }

    #[test]
    fn faults_name_the_key_and_the_index() {
        let place = |change: fn(&mut Value)| changed(change).unwrap_err().place;
        let element = Place::Element;
        assert_eq!(place(|d| d["F"][3][1] = json!(5)), element("F", 3), "vertex");
        assert_eq!(place(|d| d["region_pair"][2][0] = json!(3)), element("region_pair", 2), "region");
        assert_eq!(place(|d| d["sheet_tag"][6] = json!(4)), element("sheet_tag", 6), "tag");
        assert_eq!(place(|d| d["sheet"]["2"] = json!("lid")), element("sheet", 2), "unknown name");
        assert_eq!(place(|d| d["regions"] = json!({"0": "outside", "2": "a"})), element("regions", 2), "gap");
        assert_eq!(place(|d| d["regions"]["2"] = json!("substrate")), element("regions", 2), "name twice");
        assert_eq!(place(|d| d["eps_r"] = json!({"2": 3})), element("eps_r", 2), "metal has none");
        assert_eq!(place(|d| d["eps_r"] = json!({"1": -3})), element("eps_r", 1), "no such matter");
        assert_eq!(place(|d| d["tan_delta"] = json!({"9": 0})), element("tan_delta", 9), "no such region");
    }

    #[test]
    fn what_does_not_follow_the_format_is_named() {
        let message = |change: fn(&mut Value)| changed(change).unwrap_err().to_string();
        let has = |text: String, part: &str| assert!(text.contains(part), "\"{part}\" is not in: {text}");
        has(message(|d| d["sheet_tag"] = json!([0, 3])), "sheet_tag has 2 entries, but F has 7");
        has(message(|d| d["V"][1] = json!([0, 0])), "V[1]");
        has(message(|d| d["V"][1][2] = json!(null)), "V[1][2]");
        has(message(|d| d["F"][1][2] = json!(-1)), "F[1][2]");
        has(message(|d| d["eps_R"] = json!({})), "eps_R");
        has(message(|d| d["sheet_role"] = json!({"1": "lid"})), "sheet_role");
        has(message(|d| (d["sheet"]["1"], d["sheet_role"]) = (json!("outer"), json!({"1": "port"}))), "two roles");
    }

    #[test]
    fn a_surface_that_cannot_be_filled_is_refused_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("open.json");
        let mut document = pair();
        document["region_pair"][0] = json!([1, 1]);
        std::fs::write(&path, document.to_string()).unwrap();
        let error = read_surface(&path).unwrap_err();
        assert!(matches!(error, IoError::BadSurface { source: SurfaceFault::Open { .. }, .. }), "{error}");
        assert!(error.to_string().contains("open.json"), "{error}");
    }

    #[test]
    fn compressed_text_that_is_cut_off_is_refused() {
        let bytes = std::fs::read(golden("flat_A")).unwrap();
        let error = parse(&bytes[..bytes.len() / 2]).unwrap_err();
        assert!(error.what.contains("decompressed"), "{error}");
    }
}
