//! Claims about whole exports: interfaces, round trips, and what the verifier finds.

use super::export::bundle;
use super::fixture::{stacked, stacked_on};
use super::proof::CLEARANCE_MM;
use super::stl::{Triangle, widen};
use super::{
    CERTIFICATE_FILE, Certificate, ExportOptions, Fault, GLTF_FILE, IoError, OBJ_FILE, Verification, export, import,
    stl, verify,
};
use crate::geometry::{DVec3, Facet, Plc, RegionId};
use crate::units::MM;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs;
use std::path::Path;

/// A facet by its corners and the names of the regions on both sides, however it was stored.
fn canonical(plc: &Plc, position: impl Fn(DVec3) -> DVec3) -> BTreeMap<[[u64; 3]; 3], [String; 2]> {
    let facet = |f: &Facet| {
        let [a, b, c] = f.vertices;
        let (vertices, sides) =
            if f.back < f.front { ([a, b, c], [f.back, f.front]) } else { ([a, c, b], [f.front, f.back]) };
        let mut key = vertices.map(|v| (position(plc.vertices[v.index()]) + DVec3::ZERO).to_array().map(f64::to_bits));
        let least = (0..3).min_by_key(|&k| key[k]).unwrap();
        key.rotate_left(least);
        (key, sides.map(|r| plc.regions[r.index()].name.clone()))
    };
    let map: BTreeMap<_, _> = plc.facets.iter().map(facet).collect();
    assert_eq!(map.len(), plc.facets.len(), "each facet is found once");
    map
}

fn same(found: &Plc, original: &Plc, position: impl Fn(DVec3) -> DVec3, what: &str) {
    assert_eq!(found.check(), Ok(()), "{what} is valid");
    assert_eq!(found.regions, original.regions, "{what}: regions and materials");
    assert_eq!(found.vertices.len(), original.vertices.len(), "{what}: vertices");
    assert!(canonical(found, |p| p) == canonical(original, position), "{what}: facets, positions and sides");
}

fn same_bits(a: [f32; 3], b: [f32; 3]) -> bool {
    a.map(f32::to_bits) == b.map(f32::to_bits)
}

fn corner_bits(t: &Triangle) -> BTreeSet<[u32; 3]> {
    t.corners.iter().map(|c| c.map(f32::to_bits)).collect()
}

#[test]
fn every_interface_facet_is_shared_bit_for_bit_in_200_random_antennas() {
    for seed in 0..200 {
        let plc = stacked(&mut fastrand::Rng::with_seed(seed));
        let (files, certificate) =
            bundle(&plc, &ExportOptions::default()).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        assert_eq!(certificate.n_shared_facets(), plc.n_shared_facets(), "seed {seed}: as many as in the complex");
        let facets = |region: &str| -> HashSet<BTreeSet<[u32; 3]>> {
            let (_, bytes) = files.iter().find(|(name, _)| *name == format!("{region}.stl")).unwrap();
            stl::parse(bytes).unwrap().iter().map(corner_bits).collect()
        };
        for (a, first) in plc.solids() {
            for (b, second) in plc.solids().filter(|&(b, _)| b > a) {
                let between = |f: &&Facet| [f.back, f.front] == [a, b] || [f.back, f.front] == [b, a];
                let expected = plc.facets.iter().filter(between).count();
                let shared = facets(&first.name).intersection(&facets(&second.name)).count();
                assert_eq!(shared, expected, "seed {seed}: {} and {}", first.name, second.name);
            }
        }
        for (id, record) in (1..).zip(&certificate.solids) {
            let volume = plc.boundary(RegionId::new(id)).volume() / MM.powi(3);
            let relative = record.shape.volume_mm3 / volume - 1.0;
            assert!(relative.abs() < 1e-3, "seed {seed}: volume of {} off by {relative:e}", record.material.material);
            let euler = [0, 0, 2, 2][id - 1];
            assert_eq!(record.shape.euler_characteristic, euler, "seed {seed}: the pin passes through two solids");
        }
    }
}

#[test]
fn every_format_brings_the_antenna_back() {
    let dir = tempfile::tempdir().unwrap();
    for seed in 0..6 {
        let mut plc = stacked(&mut fastrand::Rng::with_seed(seed));
        // Every second antenna lies wholly at negative coordinates, so that its STL files are shifted.
        let offset = if seed % 2 == 1 { -0.06 } else { 0.06 };
        plc.vertices.iter_mut().for_each(|v| *v += DVec3::splat(offset));
        let written = export(&plc, dir.path(), &ExportOptions::default()).unwrap();
        let shift = DVec3::from_array(written.certificate.shift_mm);
        assert_eq!(shift != DVec3::ZERO, seed % 2 == 1, "seed {seed}: shifted where needed, by {shift}");
        let found = verify(dir.path()).unwrap();
        assert!(found.is_valid(), "seed {seed}: {:?}", found.findings);
        assert_eq!(found.certificate, written.certificate, "the certificate reads as written");
        same(&import(&dir.path().join(OBJ_FILE)).unwrap(), &plc, |p| p, "OBJ");
        let single = |p: DVec3| widen(super::rounding::to_single(p));
        same(&import(&dir.path().join(GLTF_FILE)).unwrap(), &plc, single, "glTF");
        let rounded = |p: DVec3| (widen(super::rounding::stl_vertex(p, shift)) - shift) * MM;
        same(&import(dir.path()).unwrap(), &plc, rounded, "STL");
    }
}

#[test]
fn no_solid_lies_wholly_below_zero_after_one_common_whole_shift() {
    let base = stacked(&mut fastrand::Rng::with_seed(3));
    for (offset_mm, needs) in [(-100.5, true), (100.0, false)] {
        let moved = base.vertices.iter().map(|&v| v + DVec3::splat(offset_mm * MM)).collect();
        let (files, certificate) = bundle(&base.with_vertices(moved), &ExportOptions::default()).unwrap();
        let shift = DVec3::from_array(certificate.shift_mm);
        assert!(shift.fract() == DVec3::ZERO && (shift != DVec3::ZERO) == needs, "whole millimetres: {shift}");
        assert!(shift.abs().max_element() < 2.0 * f64::abs(offset_mm), "no farther than needed: {shift}");
        for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".stl")) {
            let triangles = stl::parse(bytes).unwrap();
            let highest = triangles.iter().flat_map(|t| t.corners.map(widen)).reduce(DVec3::max).unwrap();
            assert!(highest.max_element() > 0.0, "{name} reaches {highest}");
        }
    }
}

#[test]
fn what_single_precision_cannot_hold_is_refused_with_its_place() {
    let mut plc = stacked(&mut fastrand::Rng::with_seed(1));
    let far = plc.vertices.iter().map(|&v| v + DVec3::splat(1e3)).collect();
    let error = bundle(&plc.with_vertices(far), &ExportOptions::default()).unwrap_err();
    assert!(matches!(error, IoError::Merged { format: "STL", .. }), "a kilometre away: {error}");
    assert!(error.to_string().contains("larger splitting tolerance"), "{error}");
    plc.regions[2].name = "../x".to_owned();
    assert!(matches!(bundle(&plc, &ExportOptions::default()), Err(IoError::BadName { .. })), "no path in a name");
    plc.regions[2].name = "certificate".to_owned();
    assert!(matches!(bundle(&plc, &ExportOptions::default()), Err(IoError::BadName { .. })), "the name is taken");
}

#[test]
fn a_glb_loads_elsewhere_with_names_and_metres() {
    let plc = stacked(&mut fastrand::Rng::with_seed(9));
    let (files, _) = bundle(&plc, &ExportOptions::default()).unwrap();
    let (_, bytes) = files.iter().find(|(name, _)| name == GLTF_FILE).unwrap();
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(bytes).unwrap();
    let names: Vec<_> = document.meshes().map(|m| m.name().unwrap().to_owned()).collect();
    assert_eq!(names, ["ground", "substrate", "patch", "pin"], "a mesh per solid");
    for (mesh, (id, region)) in document.meshes().zip(plc.solids()) {
        let primitive = mesh.primitives().next().unwrap();
        assert_eq!(primitive.material().name(), Some(region.name.as_str()), "named as the region");
        let reader = primitive.reader(|_| blob.as_deref());
        assert_eq!(reader.read_indices().unwrap().into_u32().count(), 3 * plc.boundary_faces(id).len(), "triangles");
        let y_up = |v: DVec3| DVec3::new(v.x, v.z, -v.y);
        let own = plc.boundary(id).vertices;
        let found: Vec<_> = reader.read_positions().unwrap().map(widen).collect();
        assert_eq!(found.len(), own.len(), "vertices");
        let farthest = found.iter().zip(own).map(|(&p, v)| (p - y_up(v)).length()).fold(0.0, f64::max);
        assert!(farthest < 1e-8, "metres, y up: {farthest:e}");
    }
}

/// An exported antenna whose files a test changes.
struct Tampered {
    dir: tempfile::TempDir,
}

impl Tampered {
    fn new(seed: u64) -> Self {
        let dir = tempfile::tempdir().unwrap();
        export(&stacked(&mut fastrand::Rng::with_seed(seed)), dir.path(), &ExportOptions::default()).unwrap();
        assert!(verify(dir.path()).unwrap().is_valid(), "valid before it is touched");
        Self { dir }
    }

    fn path(&self) -> &Path {
        self.dir.path()
    }

    fn triangles(&self, region: &str) -> Vec<[[f32; 3]; 3]> {
        let bytes = fs::read(self.path().join(format!("{region}.stl"))).unwrap();
        stl::parse(&bytes).unwrap().iter().map(|t| t.corners).collect()
    }

    fn write(&self, region: &str, triangles: &[[[f32; 3]; 3]]) {
        let bytes = stl::encode(&format!("Conformant binary STL, unit mm, region {region}"), triangles);
        fs::write(self.path().join(format!("{region}.stl")), bytes).unwrap();
    }

    /// Makes every recorded hash and length that of the file as it is now.
    fn rehash(&self) {
        let read = |name: &str| fs::read(self.path().join(name)).unwrap();
        let json = |name: &str| serde_json::from_slice::<serde_json::Value>(&read(name)).unwrap();
        let mut certificate = json(CERTIFICATE_FILE);
        for name in ["ground", "substrate", "patch", "pin"] {
            let mut sidecar = json(&format!("{name}.json"));
            sidecar["sha256"] = super::certificate::sha256(&read(&format!("{name}.stl"))).into();
            fs::write(self.path().join(format!("{name}.json")), super::certificate::to_json(&sidecar)).unwrap();
        }
        for record in certificate["files"].as_array_mut().unwrap() {
            let bytes = read(record["name"].as_str().unwrap());
            record["sha256"] = super::certificate::sha256(&bytes).into();
            record["bytes"] = bytes.len().into();
        }
        fs::write(self.path().join(CERTIFICATE_FILE), super::certificate::to_json(&certificate)).unwrap();
    }

    /// Asserts that the change is found by its hash, and without the hashes by what it did to the geometry.
    fn is_caught(&self, what: &str, by: impl Fn(&Fault) -> bool) {
        let has = |v: &Verification, by: &dyn Fn(&Fault) -> bool| v.findings.iter().any(|f| by(&f.fault));
        let found = verify(self.path()).unwrap();
        assert!(has(&found, &|f| *f == Fault::Changed), "{what}: by the hash: {:?}", found.findings);
        self.rehash();
        let found = verify(self.path()).unwrap();
        assert!(!has(&found, &|f| *f == Fault::Changed), "{what}: the hashes are mended");
        assert!(has(&found, &by), "{what}: by the geometry: {:?}", found.findings);
        assert!(!found.is_valid(), "{what}");
    }
}

/// A corner of the substrate's file that the patch has, too.
fn shared_corner(of: &Tampered) -> [f32; 3] {
    let patch: HashSet<_> = of.triangles("patch").into_iter().flatten().map(|c| c.map(f32::to_bits)).collect();
    let substrate = of.triangles("substrate");
    *substrate.iter().flatten().find(|c| patch.contains(&c.map(f32::to_bits))).unwrap()
}

#[test]
fn a_removed_triangle_is_caught() {
    for region in ["ground", "substrate", "patch", "pin"] {
        let tampered = Tampered::new(11);
        let mut triangles = tampered.triangles(region);
        triangles.remove(triangles.len() / 2);
        tampered.write(region, &triangles);
        tampered.is_caught(region, |f| matches!(f, Fault::NotClosed { .. }));
    }
}

#[test]
fn a_flipped_facet_is_caught() {
    let tampered = Tampered::new(12);
    let mut triangles = tampered.triangles("substrate");
    triangles[7].swap(1, 2);
    tampered.write("substrate", &triangles);
    tampered.is_caught("corners", |f| matches!(f, Fault::NotClosed { .. }));

    let tampered = Tampered::new(12);
    let path = tampered.path().join("patch.stl");
    let mut bytes = fs::read(&path).unwrap();
    for k in 0..3 {
        bytes[84 + 50 * 4 + 4 * k + 3] ^= 0x80;
    }
    fs::write(path, bytes).unwrap();
    tampered.is_caught("normal alone", |f| matches!(f, Fault::Normal { triangle: 4, .. }));

    let tampered = Tampered::new(12);
    let mut triangles = tampered.triangles("pin");
    triangles.iter_mut().for_each(|t| t.swap(0, 1));
    tampered.write("pin", &triangles);
    tampered.is_caught("inside out", |f| matches!(f, Fault::NotClosed { .. }));
}

#[test]
fn a_gap_of_one_micrometre_is_caught() {
    for (seed, direction) in (20..).zip([DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]) {
        let tampered = Tampered::new(seed);
        let moved = |c: [f32; 3]| super::rounding::to_single(widen(c) + direction * 1e-3);
        let corner = shared_corner(&tampered);
        let mut triangles = tampered.triangles("substrate");
        triangles.iter_mut().flatten().filter(|c| same_bits(**c, corner)).for_each(|c| *c = moved(*c));
        tampered.write("substrate", &triangles);
        tampered.is_caught("one vertex", |f| matches!(f, Fault::Gap { distance_mm, .. } if *distance_mm < 1.1e-3));

        let tampered = Tampered::new(seed);
        let triangles: Vec<_> = tampered.triangles("patch").iter().map(|t| t.map(moved)).collect();
        tampered.write("patch", &triangles);
        tampered.is_caught("a whole solid", |f| matches!(f, Fault::Gap { .. }));
    }
}

#[test]
fn a_vertex_on_one_side_of_an_interface_alone_is_caught() {
    let tampered = Tampered::new(31);
    let patch: HashSet<_> = tampered.triangles("patch").into_iter().flatten().map(|c| c.map(f32::to_bits)).collect();
    let on_patch = |t: &[[f32; 3]; 3]| t.iter().all(|c| patch.contains(&c.map(f32::to_bits)));
    let triangles = tampered.triangles("substrate");
    let &[a, b, _] = triangles.iter().find(|t| on_patch(t)).unwrap();
    let middle = super::rounding::to_single((widen(a) + widen(b)) / 2.0);
    let mut split = Vec::new();
    for t in &triangles {
        match (0..3).find(|&k| {
            let (from, to) = (t[k], t[(k + 1) % 3]);
            (same_bits(from, a) && same_bits(to, b)) || (same_bits(from, b) && same_bits(to, a))
        }) {
            Some(k) => {
                let [from, to, apex] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
                split.extend([[from, middle, apex], [middle, to, apex]]);
            }
            None => split.push(*t),
        }
    }
    assert_eq!(split.len(), triangles.len() + 2, "two triangles were halved");
    tampered.write("substrate", &split);
    tampered.is_caught("T-junction", |f| matches!(f, Fault::Gap { .. }));
}

#[test]
fn an_edited_file_is_caught_whatever_it_is() {
    let tampered = Tampered::new(41);
    let Certificate { files, .. } = Certificate::read(tampered.path()).unwrap();
    assert_eq!(files.len(), 10, "four solids, their sidecars, OBJ and glTF");
    for record in files {
        let path = tampered.path().join(&record.name);
        let old = fs::read(&path).unwrap();
        let mut new = old.clone();
        new[40] ^= 1;
        fs::write(&path, new).unwrap();
        let found = verify(tampered.path()).unwrap();
        assert!(found.findings.iter().any(|f| f.file == record.name && f.fault == Fault::Changed), "{}", record.name);
        fs::remove_file(&path).unwrap();
        let found = verify(tampered.path()).unwrap();
        let missing = |f: &super::Finding| f.file == record.name && matches!(f.fault, Fault::Unreadable { .. });
        assert!(found.findings.iter().any(missing), "{} is gone", record.name);
        fs::write(&path, old).unwrap();
    }
    assert!(verify(tampered.path()).unwrap().is_valid(), "as it was");
    fs::write(tampered.path().join("old.stl"), b"").unwrap();
    let found = verify(tampered.path()).unwrap();
    assert_eq!(found.findings[0].to_string().split(':').next(), Some("old.stl"), "a stray file is named");
}

#[test]
fn other_formats_must_agree_with_the_stl() {
    let edit = |name: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let tampered = Tampered::new(51);
        let path = tampered.path().join(name);
        let mut bytes = fs::read(&path).unwrap();
        change(&mut bytes);
        fs::write(path, bytes).unwrap();
        tampered.is_caught(name, |f| matches!(f, Fault::Disagrees { .. } | Fault::Differs { .. }));
    };
    edit(OBJ_FILE, &|bytes| {
        let text = String::from_utf8(bytes.clone()).unwrap();
        let at = text.find("v ").unwrap() + 2;
        bytes.splice(at..at, if bytes[at] == b'-' { *b"-1" } else { *b"10" });
        if bytes[at] == b'-' {
            bytes.remove(at + 2);
        }
    });
    edit(OBJ_FILE, &|bytes| {
        let text = String::from_utf8(bytes.clone()).unwrap().replace("2.33", "2.34");
        *bytes = text.into_bytes();
    });
    edit(GLTF_FILE, &|bytes| {
        let json = usize::try_from(u32::from_le_bytes(bytes[12..16].try_into().unwrap())).unwrap();
        bytes[28 + json + 2] ^= 1; // a part in 256 of the first coordinate
    });
}

#[test]
fn a_thin_but_honest_foil_is_certified_with_its_clearance() {
    let plc = stacked(&mut fastrand::Rng::with_seed(61));
    let (_, certificate) = bundle(&plc, &ExportOptions::default()).unwrap();
    assert!(certificate.clearance_mm >= CLEARANCE_MM, "nothing comes near: {}", certificate.clearance_mm);
    let dir = tempfile::tempdir().unwrap();
    let thin = stacked_on(1.5e-3, &mut fastrand::Rng::with_seed(61));
    let written = export(&thin, dir.path(), &ExportOptions::default()).unwrap();
    let clearance = written.certificate.clearance_mm;
    assert!((clearance - 1.5e-3).abs() < 2e-5, "the foil's own thickness: {clearance}");
    let tampered = Tampered { dir };
    assert!(verify(tampered.path()).unwrap().is_valid(), "certified");
    let corner = shared_corner(&tampered);
    let mut triangles = tampered.triangles("patch");
    let moved = super::rounding::to_single(widen(corner) + DVec3::Z * 1e-3);
    triangles.iter_mut().flatten().filter(|c| same_bits(**c, corner)).for_each(|c| *c = moved);
    tampered.write("patch", &triangles);
    tampered.is_caught("a gap all the same", |f| matches!(f, Fault::Gap { .. }));
}

#[test]
fn a_vertex_on_an_edge_that_does_not_have_it_is_no_export() {
    // A tetrahedron stands with its tip in the middle of another's edge.
    let id = crate::geometry::VertexId::new;
    let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]].map(DVec3::from_array);
    let tip = DVec3::new(2.0, 0.0, 0.0);
    let second =
        [tip, tip + DVec3::new(2.0, -4.0, 0.0), tip + DVec3::new(2.0, -4.0, 4.0), tip + DVec3::new(-1.0, -4.0, 1.0)];
    let mut plc = Plc {
        vertices: corners.into_iter().chain(second).map(|p| p * MM).collect(),
        facets: Vec::new(),
        regions: stacked(&mut fastrand::Rng::with_seed(0)).regions[..3].to_vec(),
    };
    for (region, first) in [(1, 0), (2, 4)] {
        for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            let facet =
                Facet { vertices: face.map(|v| id(first + v)), back: RegionId::new(region), front: RegionId::AIR };
            plc.facets.push(facet);
        }
    }
    if plc.boundary(RegionId::new(2)).volume() < 0.0 {
        plc.facets[4..].iter_mut().for_each(|f| f.vertices.swap(1, 2));
    }
    let error = bundle(&plc, &ExportOptions::default()).unwrap_err();
    assert!(matches!(error, IoError::Unsound { fault: Fault::Gap { .. }, .. }), "{error}");
}
