//! Imported bodies: our own exports come back, are deformed, and stay closed.

use conformant::geometry::{DVec3, Plc, RegionRole};
use conformant::io::bodies::{Solid, name_plainly, read};
use conformant::io::{ExportOptions, export, verify};
use conformant::pipeline::{Density, MeshSettings, Shape, SolveSettings, StopRule, deform, flat, solve};
use conformant::project::{
    BendPlane, BodiesSpec, BodyKind, BodySpec, Edit, LooseBody, MaterialSpec, PresetEntry, PresetSpec, Project,
    RuleSpec, WELD_MM,
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
    let bodies = BodiesSpec::weld(&loose(solids), WELD_MM).unwrap_or_else(|faults| panic!("{faults:?}"));
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

#[test]
fn bodies_with_a_feed_are_meshed_and_solved_like_the_patch_they_are() {
    // The paper's patch without its line, of thicker metal: it resonates where the coarse template does, 10.6 GHz.
    let plate = |name: &str, lo: [f64; 3], hi: [f64; 3]| (name.to_owned(), lo, hi);
    let parts = [
        plate("ground", [-10.0, -10.0, -1.975], [10.0, 10.0, -1.575]),
        plate("base", [-10.0, -10.0, -1.575], [10.0, 10.0, 0.0]),
        plate("patch", [-5.415, -4.0885, 0.0], [5.415, 4.0885, 0.4]),
    ];
    let mut first = 1;
    let text: String = parts.iter().map(|(name, lo, hi)| block(name, name, *lo, *hi, 1, &mut first)).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("patch.obj");
    std::fs::write(&path, text).expect("a file");
    let solids = read(&path, 1e-3).expect("three bodies");
    let substrate = MaterialSpec { name: String::new(), eps_r: 2.2, tan_delta: 0.0009 };
    let kind = |name: &str| if name == "base" { BodyKind::Dielectric(substrate.clone()) } else { BodyKind::Metal };
    let loose: Vec<LooseBody> = solids
        .into_iter()
        .map(|s| LooseBody { spec: BodySpec { kind: kind(&s.name), name: s.name }, surface: s.surface })
        .collect();
    let bodies = BodiesSpec::weld(&loose, WELD_MM).expect("they touch");
    let fed = bodies.with_upright_feed([0.0, -2.3385], 50.0).expect("over the ground");
    let mut project = Project::default();
    Edit::SetBodies(Some(Box::new(fed))).apply(&mut project).expect("valid");
    let mesh = MeshSettings { density: Density::Coarse, ..MeshSettings::default() };
    let usual = SolveSettings::new(mesh, [7e9, 14e9]);
    let settings = SolveSettings { stop: StopRule::Decay { db: 20.0 }, pattern_freqs: vec![10.2e9], ..usual };
    let solved = solve(&project, Shape::Flat, &settings, None, &mut |_| (), &Task::default());
    let solved = solved.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(solved.meshed.mesh.check(), Ok(()), "a mesh");
    let found = solved.sweep.resonance().expect("a resonance");
    assert!((found.freq / 10.2e9 - 1.0).abs() < 0.06, "{:e} Hz", found.freq);
    assert!(found.depth_db < -6.0, "matched in part: {} dB", found.depth_db);
    // What the source gives is what is radiated: the port's voltage and current are those of the field.
    let balance = solved.far_fields[0].near_balance().expect("power goes in");
    assert!((balance - 1.0).abs() < 0.05, "near power balance {balance}");
}

/// A plate of 20 x 12 x 1.5 mm of FR-4 in two by two squares a side, and a copper strip of 13 x 3 x 0.5 mm upon it.
fn two_plates() -> String {
    let mut first = 1;
    block("plate", "FR-4", [-10.0, -6.0, -1.5], [10.0, 6.0, 0.0], 2, &mut first)
        + &block("strip", "Copper", [-6.0, -1.0, 0.0], [7.0, 2.0, 0.5], 1, &mut first)
}

/// A box as OBJ with each side cut into `n` by `n`; `first` is the number of its first vertex, then of the next one.
fn block(name: &str, material: &str, lo: [f64; 3], hi: [f64; 3], n: usize, first: &mut usize) -> String {
    let mut text = format!("o {name}\nusemtl {material}\n");
    for axis in 0..3 {
        for side in [lo[axis], hi[axis]] {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for k in 0..(n + 1) * (n + 1) {
                let mut p = [side; 3];
                p[u] = lo[u] + (hi[u] - lo[u]) * (k / (n + 1)) as f64 / n as f64;
                p[v] = lo[v] + (hi[v] - lo[v]) * (k % (n + 1)) as f64 / n as f64;
                text += &format!("v {} {} {}\n", p[0], p[1], p[2]);
            }
            let id = |i: usize, j: usize| *first + i * (n + 1) + j;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let quad = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
                let [a, b, c, d] = if side > lo[axis] { quad } else { [quad[3], quad[2], quad[1], quad[0]] };
                text += &format!("f {a} {b} {c} {d}\n");
            }
            *first += (n + 1) * (n + 1);
        }
    }
    text
}
