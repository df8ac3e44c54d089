//! Mesh files as other programs see them.
//!
//! The programs are meshio and Gmsh, in a Python of their own (`.ci/run` makes it): the one that `MESH_READER_PYTHON`
//! names, else `target/mesh-readers/bin/python`. Without it the test says so and passes, but fails where
//! `REQUIRE_MESH_READERS=1` is set.

#![allow(clippy::unwrap_used, reason = "a file that cannot be written or read fails the test")]
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use conformant::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use conformant::io::{IoError, msh, nastran, vtu};
use conformant::tet::{FaceGroup, FaceRole, MarkedFace, Tet, TetMesh, face_key, tet_qualities};
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Edge of a cell of the box, m; its digits do not end in binary or in 16 characters.
const STEP: DVec3 = DVec3::new(1.0e-3 / 3.0, 0.7e-3, 0.123_456_789_123e-3);
const ORIGIN: DVec3 = DVec3::new(-1.0e-3 / 7.0, 12.5e-3, -0.2e-3);

/// Two boxes of six cells each with a square in common: a substrate below and a coax above it. One triangle of the
/// square conducts, the top is a port, the rest of the hull is the outer boundary.
fn two_boxes() -> TetMesh {
    let corner = |x: usize, y: usize, z: usize| VertexId::new(x + 2 * y + 4 * z);
    let place = |v: usize| {
        #[allow(clippy::cast_precision_loss, reason = "0, 1 or 2")]
        let steps = [v % 2, v / 2 % 2, v / 4].map(|k| k as f64);
        ORIGIN + DVec3::from_array(steps) * STEP
    };
    let mut tets = Vec::new();
    for (z, region) in [(0, 1), (1, 3)] {
        // Each path along the axes from the lowest corner to the highest is a cell.
        for (axes, even) in [
            ([0, 1, 2], true),
            ([1, 2, 0], true),
            ([2, 0, 1], true),
            ([0, 2, 1], false),
            ([2, 1, 0], false),
            ([1, 0, 2], false),
        ] {
            let mut at = [0, 0, z];
            let mut path = [corner(0, 0, z); 4];
            for (k, axis) in axes.into_iter().enumerate() {
                at[axis] += 1;
                path[k + 1] = corner(at[0], at[1], at[2]);
            }
            if !even {
                path.swap(1, 2);
            }
            tets.push(Tet { vertices: path, region: RegionId::new(region) });
        }
    }
    let region = |name: &str, role| Region { name: name.to_owned(), role, eps_r: 1.0, tan_delta: 0.0 };
    let group = |name: &str, role| FaceGroup { name: name.to_owned(), role };
    let mut mesh = TetMesh {
        vertices: (0..12).map(place).collect(),
        faces: Vec::new(),
        regions: vec![
            region("outside", RegionRole::Air),
            region("substrate", RegionRole::Dielectric),
            region("pin metal", RegionRole::Conductor),
            region("coax dielectric", RegionRole::Dielectric),
        ],
        groups: vec![
            group("pec_patch", FaceRole::Conductor),
            group("pec_feed", FaceRole::Conductor),
            group("port1", FaceRole::Port),
            group("outer", FaceRole::Outer),
        ],
        tets,
    };
    mesh.faces = marked(&mesh);
    mesh
}

fn marked(mesh: &TetMesh) -> Vec<MarkedFace> {
    let faces = mesh.tets.iter().flat_map(|t| (0..4).map(|i| t.face(i)));
    let mut count: HashMap<_, usize> = HashMap::new();
    faces.clone().for_each(|f| *count.entry(face_key(f)).or_default() += 1);
    let level = |f: [VertexId; 3], z: usize| f.iter().all(|v| v.index() / 4 == z);
    let mut marked: Vec<MarkedFace> = faces
        .filter(|f| count[&face_key(*f)] == 1)
        .map(|vertices| MarkedFace { vertices, group: if level(vertices, 2) { 2 } else { 3 } })
        .collect();
    marked.push(MarkedFace { vertices: [4, 5, 7].map(VertexId::new), group: 0 });
    marked
}

/// What a reader should find: counts and volumes (mm³) by name, or by tag where the format has no names.
struct Expected {
    triangles: Value,
    tets: Value,
    volumes: [&'static str; 2],
}

const BY_NAME: [&str; 2] = ["substrate", "coax dielectric"];
const BY_TAG: [&str; 2] = ["1", "3"];

fn expected(format: &str) -> Expected {
    let volumes = if format.starts_with("msh") { BY_NAME } else { BY_TAG };
    let tets = json!({volumes[0]: 6, volumes[1]: 6});
    let triangles = match format {
        "vtu" => json!({}),
        "bdf" => json!({"4": 1, "6": 2, "7": 18}),
        _ => json!({"pec_patch": 1, "port1": 2, "outer": 18}),
    };
    Expected { triangles, tets, volumes }
}

/// Writes every format; the files by a word for the format.
fn write_all(mesh: &TetMesh, folder: &Path) -> BTreeMap<&'static str, PathBuf> {
    let inradii_mm: Vec<f64> = tet_qualities(mesh).iter().map(|q| q.inradius * 1e3).collect();
    let paths = [("msh2", "a2.msh"), ("msh4", "a4.msh"), ("bdf", "a.bdf"), ("vtu", "a.vtu")];
    let paths = BTreeMap::from(paths.map(|(format, name)| (format, folder.join(name))));
    msh::write(mesh, msh::MshVersion::V2_2, &paths["msh2"]).unwrap();
    msh::write(mesh, msh::MshVersion::V4_1, &paths["msh4"]).unwrap();
    nastran::write(mesh, &paths["bdf"]).unwrap();
    let field = vtu::CellField { name: "inradius_mm", values: &inradii_mm };
    vtu::write(mesh, &[field], &paths["vtu"]).unwrap();
    paths
}

#[test]
fn the_mesh_of_these_tests_is_valid() {
    let mesh = two_boxes();
    assert_eq!(mesh.check(), Ok(()), "every invariant");
    assert_eq!((mesh.tets.len(), mesh.faces.len()), (12, 21), "cells and marked faces");
}

#[test]
fn files_hold_every_vertex_and_element_once() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_boxes();
    let paths = write_all(&mesh, folder.path());
    let text = std::fs::read_to_string(&paths["msh2"]).unwrap();
    let section = |name: &str| -> Vec<Vec<f64>> {
        let body = text.split(&format!("${name}\n")).nth(1).unwrap().split(&format!("$End{name}")).next().unwrap();
        body.lines().skip(1).map(|l| l.split(' ').map(|w| w.parse().unwrap()).collect()).collect()
    };
    let nodes = section("Nodes");
    assert_eq!(nodes.len(), 12, "vertices");
    for (node, vertex) in nodes.iter().zip(&mesh.vertices) {
        let at = DVec3::from_slice(&node[1..]) * 1e-3;
        assert!(at.distance(*vertex) <= 2.0 * f64::EPSILON * vertex.length(), "{at} is not {vertex}");
    }
    let elements = section("Elements");
    let numbers: Vec<f64> = elements.iter().map(|e| e[0]).collect();
    assert_eq!(numbers, (1..=33).map(f64::from).collect::<Vec<_>>(), "numbered from 1");
    assert!(elements.iter().all(|e| e[3] > 0.0 && e[5..].iter().all(|n| (1.0..=12.0).contains(n))), "in range");

    let cards = std::fs::read_to_string(&paths["bdf"]).unwrap();
    let n_cards = |word: &str| cards.lines().filter(|l| l.starts_with(word)).count();
    let counts = ["GRID*   ", "*       ", "CTETRA  ", "CTRIA3  ", "BEGIN BULK", "ENDDATA"].map(n_cards);
    assert_eq!(counts, [12, 12, 12, 21, 1, 1], "cards");
    assert!(cards.lines().all(|l| l.len() <= 80), "no line is longer than a card");
}

#[test]
fn a_part_without_a_good_name_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.msh");
    let write = |change: fn(&mut TetMesh)| {
        let mut mesh = two_boxes();
        change(&mut mesh);
        msh::write(&mesh, msh::MshVersion::V4_1, &path)
    };
    for change in [
        |m: &mut TetMesh| m.regions[1].name = "a \"b\"".to_owned(),
        |m: &mut TetMesh| m.regions[1].name = "a\nb".to_owned(),
        |m: &mut TetMesh| m.regions[1].name = String::new(),
        |m: &mut TetMesh| m.regions[1].name = "port1".to_owned(),
    ] {
        assert!(matches!(write(change), Err(IoError::BadPartName { .. })), "refused");
        assert!(!path.exists(), "nothing is written");
    }
    write(|m| m.regions[2].name = "port1".to_owned()).expect("a region without cells has no part");
}

fn reader_python() -> Option<PathBuf> {
    let named = std::env::var_os("MESH_READER_PYTHON").map(PathBuf::from);
    let usual = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/mesh-readers/bin/python");
    named.or_else(|| usual.exists().then_some(usual))
}

#[test]
fn other_programs_see_the_same_mesh() {
    let Some(python) = reader_python() else {
        assert!(std::env::var_os("REQUIRE_MESH_READERS").is_none_or(|v| v != "1"), "no Python with meshio and gmsh");
        eprintln!("skipped: no Python with meshio and gmsh (MESH_READER_PYTHON)");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_boxes();
    let paths = write_all(&mesh, folder.path());
    // Gmsh does not read VTU.
    let readers = paths.keys().flat_map(|&format| [("meshio", format), ("gmsh", format)]);
    let runs: Vec<_> = readers.filter(|run| *run != ("gmsh", "vtu")).collect();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/read_mesh.py");
    let mut command = Command::new(&python);
    command.arg(script);
    command.args(runs.iter().flat_map(|(reader, format)| [Path::new(reader), paths[format].as_path()]));
    let output = command.output().unwrap_or_else(|e| panic!("{} does not run: {e}", python.display()));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // meshio may print hints before the answer.
    let text = String::from_utf8_lossy(&output.stdout);
    let seen: Vec<Value> = serde_json::from_str(text.lines().last().unwrap_or_default()).expect("one list");
    assert_eq!(seen.len(), runs.len(), "an answer for each file");
    for ((reader, format), seen) in runs.iter().zip(&seen) {
        let what = format!("{format} in {reader}");
        let expected = expected(format);
        assert_eq!(seen["points"], json!(12), "{what}: vertices");
        assert_eq!(seen["tets"], expected.tets, "{what}: cells by region");
        assert_eq!(seen["triangles"], expected.triangles, "{what}: faces by group");
        for name in expected.volumes {
            let (found, mm3) = (seen["volumes"][name].as_f64().unwrap(), STEP.element_product() * 1e9);
            assert!((found / mm3 - 1.0).abs() < 1e-10, "{what}: {name} has {found} mm³, not {mm3}");
        }
        if *format == "vtu" {
            let inradii: Vec<f64> = serde_json::from_value(seen["fields"]["inradius_mm"].clone()).unwrap();
            let same =
                tet_qualities(&mesh).iter().zip(&inradii).all(|(q, r)| (q.inradius * 1e3).to_bits() == r.to_bits());
            assert!(same && inradii.len() == 12, "{what}: the field bit for bit");
        }
    }
}
