//! Imported bodies: our own exports come back, are deformed, and stay closed.

use conformant::geometry::{DVec3, Plc, RegionRole};
use conformant::io::bodies::{Solid, name_plainly, read};
use conformant::io::{ExportOptions, export, verify};
use conformant::pipeline::{
    Density, MeshSettings, Shape, SolveSettings, Solved, StopRule, deform, estimate, flat, mesh, solve,
};
use conformant::project::{
    BendPlane, BodiesSpec, BodyKind, BodySpec, Edit, LooseBody, MaterialSpec, PresetEntry, PresetSpec, Project,
    RuleSpec, WELD_MM,
};
use conformant::task::Task;
use conformant::tet::Metal;
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

/// Bodies from a file of boxes: name, lower and upper corner in mm, and relative permittivity, 0 for metal.
fn boxes(parts: &[(&str, [f64; 3], [f64; 3], f64)]) -> BodiesSpec {
    let mut first = 1;
    let text: String = parts.iter().map(|(name, lo, hi, _)| block(name, name, *lo, *hi, 1, &mut first)).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("boxes.obj");
    std::fs::write(&path, text).expect("a file");
    let kind = |name: &str| match parts.iter().find(|p| p.0 == name).expect("a name of ours").3 {
        0.0 => BodyKind::Metal,
        eps_r => BodyKind::Dielectric(MaterialSpec { name: String::new(), eps_r, tan_delta: 0.0009 }),
    };
    let solids = read(&path, 1e-3).expect("closed bodies");
    let loose: Vec<LooseBody> = solids
        .into_iter()
        .map(|s| LooseBody { spec: BodySpec { kind: kind(&s.name), name: s.name }, surface: s.surface })
        .collect();
    BodiesSpec::weld(&loose, WELD_MM, &Task::default()).expect("they touch or are apart")
}

/// The paper's patch without its line, of copper foil.
fn patch() -> BodiesSpec {
    boxes(&[
        ("ground", [-10.0, -10.0, -1.61], [10.0, 10.0, -1.575], 0.0),
        ("base", [-10.0, -10.0, -1.575], [10.0, 10.0, 0.0], 2.2),
        ("patch", [-5.415, -4.0885, 0.0], [5.415, 4.0885, 0.035], 0.0),
    ])
}

fn project(bodies: BodiesSpec) -> Project {
    let mut project = Project::default();
    Edit::SetBodies(Some(Box::new(bodies))).apply(&mut project).expect("valid");
    project
}

fn solved_flat(project: &Project, band: [f64; 2]) -> Solved {
    let mesh = MeshSettings { density: Density::Coarse, ..MeshSettings::default() };
    let settings = SolveSettings {
        stop: StopRule::Decay { db: 40.0 },
        pattern_freqs: vec![(band[0] + band[1]) / 2.0],
        ..SolveSettings::new(mesh, band)
    };
    let solved = solve(project, Shape::Flat, &settings, None, &mut |_| (), &Task::default());
    let solved = solved.unwrap_or_else(|e| panic!("{e}"));
    let guess = estimate(project, Shape::Flat, &settings, 50e6).expect("it has a feed");
    let cells = guess.n_tets as f64 / solved.meshed.mesh.tets.len() as f64;
    let steps = guess.n_steps as f64 / solved.record.total.len() as f64;
    assert!((0.5..2.0).contains(&cells) && (0.33..3.0).contains(&steps), "{cells} of the cells, {steps} of the steps");
    solved
}

#[test]
fn bodies_with_a_feed_are_solved_like_the_patch_they_are() {
    let fed = patch().with_upright_feed([0.0, -2.3385], 50.0).expect("over the ground");
    let solved = solved_flat(&project(fed), [7e9, 14e9]);
    assert_eq!(solved.meshed.mesh.check(), Ok(()), "a mesh");
    // The template of the same density resonates at 10.62 GHz; its line has another reactance than the feed.
    let found = solved.sweep.resonance().expect("a resonance");
    assert!((found.freq / 10.62e9 - 1.0).abs() < 0.02, "{:e} Hz", found.freq);
    assert!(found.depth_db < -8.0, "matched: {} dB", found.depth_db);
    let field = &solved.far_fields[0];
    assert!((7.3..8.0).contains(&field.boresight()), "{} dBi", field.boresight());
    // What the source gives is what is radiated and lost: the port's voltage and current are those of the field.
    let balance = field.near_balance().expect("power goes in");
    assert!((balance - 1.0).abs() < 0.01, "near power balance {balance}");
}

#[test]
fn a_strip_dipole_has_the_gain_and_resonance_of_a_half_wave_one() {
    let arms = boxes(&[
        ("left", [-7.0, -0.5, 0.0], [-0.25, 0.5, 0.035], 0.0),
        ("right", [0.25, -0.5, 0.0], [7.0, 0.5, 0.035], 0.0),
    ]);
    let fed = arms.with_feed([[-0.25, 0.0, 0.035], [0.25, 0.0, 0.035]], 73.0).expect("across the gap");
    let solved = solved_flat(&project(fed), [6e9, 14e9]);
    let field = &solved.far_fields[0];
    // 1.64 of an isotropic source at half a wave, less when shorter; nothing along the arms.
    assert!((2.0..2.3).contains(&field.max_directivity().0), "{} dBi", field.max_directivity().0);
    let along = field.directivity_at(std::f64::consts::FRAC_PI_2, 0.0);
    assert!(along < -15.0, "{along} dBi along the arms");
    let balance = field.near_balance().expect("power goes in");
    assert!((balance - 1.0).abs() < 0.005, "near power balance {balance}");
    // A strip is like a wire a quarter as thick as it is wide; so thick a dipole resonates at 0.43 to 0.46 of a wave,
    // and the feed's inductance takes some percent.
    let found = solved.sweep.resonance().expect("a resonance");
    let waves = 14e-3 * found.freq / 299_792_458.0;
    assert!((0.41..0.46).contains(&waves), "{waves} of a wave");
    assert!(found.depth_db < -15.0, "near 73 ohm: {} dB", found.depth_db);
}

#[test]
fn bodies_are_meshed_bent_with_foils_as_sheets_or_as_they_are() {
    let mut project = project(patch());
    let bend = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 8.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    project.presets.push(PresetEntry { enabled: true, preset: bend });
    for metal in [Metal::Sheet, Metal::Solid] {
        let settings = MeshSettings { density: Density::Coarse, metal };
        let meshed = mesh(&project, Shape::Deformed, settings, &Task::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(meshed.mesh.check(), Ok(()), "{metal:?}");
        let base = volume(&deform(&project, &Task::default()).expect("it bends").surface(), "base");
        let region = meshed.mesh.regions.iter().position(|r| r.name == "base").expect("it is there");
        let found = meshed.mesh.volumes()[region];
        assert!((found / base - 1.0).abs() < 2e-3, "{metal:?}: {found:e} m3 for {base:e}");
        let least = if metal == Metal::Sheet { 10.0 } else { 3.0 };
        let angle = meshed.quality.whole.dihedral_min.to_degrees();
        assert!(angle > least, "{metal:?}: {angle} degrees");
    }
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
