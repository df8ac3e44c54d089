//! Imported bodies: our own exports come back, are deformed, and stay closed.

use conformant::geometry::{DVec3, Plc, RegionRole};
use conformant::io::bodies::{Solid, name_plainly, read};
use conformant::io::{ExportOptions, export, verify};
use conformant::pipeline::{deform, flat};
use conformant::project::{
    BendPlane, BodiesSpec, BodyKind, BodySpec, Edit, LooseBody, PresetEntry, PresetSpec, Project, RuleSpec, WELD_MM,
};
use conformant::task::Task;
use std::path::Path;

fn loose(mut solids: Vec<Solid>) -> Vec<LooseBody> {
    name_plainly(&mut solids);
    let body = |solid: Solid| {
        let kind = BodyKind::suggested(&solid).expect("our own exports say what they are");
        LooseBody { spec: BodySpec { name: solid.name, kind }, surface: solid.surface }
    };
    solids.into_iter().map(body).collect()
}

fn imported(files: &[&Path]) -> Project {
    let solids = files.iter().flat_map(|path| read(path, 1e-3).unwrap_or_else(|e| panic!("{e}"))).collect();
    let bodies =
        BodiesSpec::weld(&loose(solids), WELD_MM, &Task::default()).unwrap_or_else(|faults| panic!("{faults:?}"));
    let mut project = Project::default();
    Edit::SetBodies(Some(Box::new(bodies))).apply(&mut project).expect("valid");
    project
}

fn volume(plc: &Plc, name: &str) -> f64 {
    plc.boundary(plc.region(name).expect("a region")).volume()
}

#[test]
fn each_format_of_an_export_comes_back_with_the_same_regions_and_interfaces() {
    let drawn = flat(&Project::default()).expect("the paper's antenna");
    let folder = tempfile::tempdir().expect("a folder");
    export(&drawn, folder.path(), &ExportOptions::default()).expect("it is gap-free");
    let stl: Vec<_> = drawn.solids().map(|(_, r)| folder.path().join(format!("{}.stl", r.name))).collect();
    let stl: Vec<&Path> = stl.iter().map(|p| &**p).collect();
    let (obj, glb) = (folder.path().join("antenna.obj"), folder.path().join("antenna.glb"));
    for files in [&stl[..], &[&obj], &[&glb]] {
        let project = imported(files);
        let plc = flat(&project).expect("bodies");
        assert_eq!(plc.check(), Ok(()), "{files:?}");
        assert_eq!(plc.facets.len(), drawn.facets.len(), "{files:?}");
        assert_eq!(plc.n_shared_facets(), drawn.n_shared_facets(), "{files:?}");
        for (_, region) in drawn.solids() {
            let found = &plc.regions[plc.region(&region.name).expect("its name").index()];
            assert_eq!((found.role, found.eps_r, found.tan_delta), (region.role, region.eps_r, region.tan_delta));
            let ratio = volume(&plc, &region.name) / volume(&drawn, &region.name);
            assert!((ratio - 1.0).abs() < 1e-4, "{}: {ratio}", region.name);
        }
        let (lo, hi) = project.bounds();
        assert!((hi - DVec3::new(10e-3, 10e-3, 0.035e-3)).length() < 1e-8, "where it was: {lo} to {hi}");
    }
}

#[test]
fn bent_bodies_stay_closed_share_their_interface_and_are_certified() {
    // A metal strip on a finer plate, which share an interface of different triangles.
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("two.obj");
    std::fs::write(&path, two_plates()).expect("a file");
    let mut solids = read(&path, 1e-3).expect("two bodies");
    name_plainly(&mut solids);
    let kinds: Vec<_> = solids.iter().map(BodyKind::suggested).collect();
    assert!(matches!(&kinds[..], [Some(BodyKind::Dielectric(m)), Some(BodyKind::Metal)] if m.eps_r > 4.0), "{kinds:?}");
    let mut project = imported(&[&path]);
    let bend = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 15.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    Edit::SetPresets(vec![PresetEntry { enabled: true, preset: bend }]).apply(&mut project).expect("valid");
    let deformed = deform(&project, &Task::default()).unwrap_or_else(|e| panic!("{e}"));
    let (surface, drawn) = (deformed.surface(), flat(&project).expect("bodies"));
    assert_eq!(surface.check(), Ok(()), "closed");
    assert!(surface.facets.len() > 2 * drawn.facets.len(), "split where it curves");
    assert!(deformed.figures.is_none(), "figures are the template's");
    let metal = surface.regions.iter().filter(|r| r.role == RegionRole::Conductor).count();
    assert_eq!((metal, surface.regions.len()), (1, 3), "air, plate, strip");
    for name in ["plate", "strip"] {
        let ratio = volume(&surface, name) / volume(&drawn, name);
        assert!((0.7..1.3).contains(&ratio), "{name}: {ratio}");
    }
    let written = export(&surface, &folder.path().join("out"), &ExportOptions::default()).expect("gap-free");
    assert!(written.certificate.n_shared_facets() > 20, "the interface is shared");
    assert!(verify(&folder.path().join("out")).expect("readable").is_valid(), "and proved anew");
}

/// A plate of 20 x 12 x 1.5 mm of FR-4 in two by two squares a side, and a copper strip of 13 x 3 x 0.5 mm upon it.
fn two_plates() -> String {
    let mut text = String::new();
    let mut first = 1;
    for (name, material, lo, hi, n) in [
        ("plate", "FR-4", [-10.0, -6.0, -1.5], [10.0, 6.0, 0.0], 2),
        ("strip", "Copper", [-6.0, -1.0, 0.0], [7.0, 2.0, 0.5], 1),
    ] {
        text += &format!("o {name}\nusemtl {material}\n");
        for axis in 0..3 {
            for side in [lo[axis], hi[axis]] {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                for k in 0..(n + 1) * (n + 1) {
                    let mut p = [side; 3];
                    p[u] = lo[u] + (hi[u] - lo[u]) * f64::from(k / (n + 1)) / f64::from(n);
                    p[v] = lo[v] + (hi[v] - lo[v]) * f64::from(k % (n + 1)) / f64::from(n);
                    text += &format!("v {} {} {}\n", p[0], p[1], p[2]);
                }
                let id = |i: i32, j: i32| first + i * (n + 1) + j;
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let quad = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
                    let [a, b, c, d] = if side > lo[axis] { quad } else { [quad[3], quad[2], quad[1], quad[0]] };
                    text += &format!("f {a} {b} {c} {d}\n");
                }
                first += (n + 1) * (n + 1);
            }
        }
    }
    text
}
