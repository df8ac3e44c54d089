//! The real binary, command by command: what it writes, what it says, how it ends.

#![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]

mod bench;
mod import;
mod solve;

use bench::Bench;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

#[test]
fn help_names_every_command_and_wrong_usage_ends_with_2() {
    let bench = Bench::new();
    let help = bench.ok("--help");
    for command in [
        "new",
        "import",
        "deform",
        "compensate",
        "export",
        "solve",
        "compare",
        "verify",
        "study",
        "info",
        "apply",
        "report",
    ] {
        assert!(help.contains(&format!("\n  {command} ")), "{command} in:\n{help}");
        assert!(bench.ok(&format!("{command} --help")).contains("Usage:"), "{command} --help");
    }
    assert!(help.contains("130 cancelled"), "exit codes are told");
    assert!(bench.ok("--version").starts_with("conformant "), "version");
    bench.fails("deform", 2, "<FILE>");
    bench.fails("deform a.json --compensate magic", 2, "isometric");
    bench.fails("new a.json --bend diagonal", 2, "possible values: h, e");
    bench.fails("compensate a.json --orders 3", 2, "--orders");
}

#[test]
fn new_writes_each_shape_and_info_reads_it_back() {
    let bench = Bench::new();
    for (flags, said) in [
        ("", "flat"),
        ("--bend h --radius 6.5 --rule arc", "H-plane, R 6.5 mm, arc rule"),
        ("--bend e --radius -12 --kept-plane -1.61", "E-plane, R -12 mm, tangent rule, kept plane z = -1.61 mm"),
        ("--preset convex", "convex, R 20 mm, A 10 mm"),
        ("--preset concave --radius 25 --amplitude 3", "concave, R 25 mm, A 3 mm"),
        ("--preset saddle --amplitude -2", "saddle, R 20 mm, A -2 mm"),
        ("--preset twist --amplitude 0 --rate 1.5", "twist, A 0 mm, 1.5 degrees per mm"),
        ("--preset crumple --waves 2,1 --amplitude 0.5", "crumple, A 0.5 mm, 2 waves along x, 1 along y"),
        ("--bend h --radius 30 --preset crumple", "bend in the H-plane, R 30 mm"),
    ] {
        assert!(bench.ok(&format!("new a.json --force {flags}")).contains(said), "{flags}");
        let info = bench.ok("info a.json");
        assert!(flags.is_empty() || info.contains(said), "{flags}: {info}");
        assert!(info.contains("can be posed"), "{flags}: {info}");
    }
    bench.ok("new b.json --padding 1,2,3.5 --segments 12,4");
    let info = bench.json("info b.json --json");
    assert_eq!(info["project"]["cage"]["padding_mm"].to_string(), "[1.0,2.0,3.5]", "padding");
    assert_eq!(info["project"]["cage"]["segments"].to_string(), "[12,4]", "segments");
    assert_eq!(info["cage_vertices"], 2 * 13 * 5, "counted");
    assert_eq!(info["refused"], Value::Null, "can be posed");
}

#[test]
fn new_takes_materials_by_name_or_number_and_resistors() {
    let bench = Bench::new();
    let help = bench.ok("new --help");
    assert!(help.contains("RT/duroid 5880") && help.contains("Copper-plated nylon ripstop"), "{help}");
    bench.ok(
        "new a.json --substrate felt --patch-metal ripstop --ground-metal 0.1 --resistor 3,2,50 --resistor -4,3,0.01",
    );
    let info = bench.ok("info a.json");
    for said in [
        "Felt, eps_r 1.38, tan delta 0.023",
        "Copper-plated nylon ripstop, 0.04 ohm per square",
        "ground metal  0.1 ohm per square",
        "0.01 ohm at (-4, 3) mm",
    ] {
        assert!(info.contains(said), "{said}: {info}");
    }
    bench.ok("new b.json --eps-r 4.4 --tan-delta 0.02");
    assert!(bench.ok("info b.json").contains("FR-4, eps_r 4.4"), "values of the library have their name");
    bench.fails("new c.json --substrate duroid", 1, "\"duroid\" names no substrate, or several");
    bench.fails("new c.json --patch-metal wool", 1, "\"wool\" names no metal, or several");
    bench.fails("new c.json --patch-metal -1", 1, "antenna.patch_metal is -1, but must lie between");
    bench.fails("new c.json --resistor 9,2,50", 1, "antenna.resistors[0] (resistor 1) at (9.0000, 2.0000) mm");
    bench.fails("new c.json --resistor 9,2", 1, "--resistor takes three numbers");
}

#[test]
fn an_outline_from_a_drawing_is_bent_and_certified() {
    let bench = Bench::new();
    // An E of 10.8 x 8.2 mm with two slots.
    let e = "M0 8.2 V0 H10.8 V8.2 H8 V3 H7.4 V8.2 H3.4 V3 H2.8 V8.2 Z";
    fs::write(bench.path("e.svg"), format!("<svg viewBox='0 0 20 20'><path d='{e}'/></svg>")).unwrap();
    bench.fails("new a.json --outline e.svg", 1, "does not say its unit");
    let said = bench.ok("new a.json --outline e.svg --unit mm --feed 0,2 --bend h --radius 12");
    assert!(said.contains("patch 10.8 x 8.2 mm"), "{said}");
    assert!(bench.ok("info a.json").contains("outline of 12 points"), "told");
    bench.ok("deform a.json --compensate isometric --out e");
    bench.ok("verify e");
    bench.fails("new b.json --outline e.svg --unit mm --feed 2.3,-2", 1, "inside the patch's outline");
    bench.fails("new b.json --outline e.svg --unit furlong", 1, "--unit takes one of mm, cm");
}

#[test]
fn new_sizes_the_patch_for_a_frequency() {
    let bench = Bench::new();
    bench.ok("new a.json --freq 10 --height 1.588 --eps-r 2.2");
    let antenna = bench.json("info a.json --json")["project"]["antenna"].clone();
    // [BAL16] example 14.1: W 11.86 mm, L 9.06 mm.
    assert!((antenna["width_mm"].as_f64().unwrap() - 11.86).abs() < 0.01, "{antenna}");
    assert!((antenna["length_mm"].as_f64().unwrap() - 9.06).abs() < 0.01, "{antenna}");
    bench.ok("new b.json --freq 2.45");
    let antenna = bench.json("info b.json --json")["project"]["antenna"].clone();
    assert!(antenna["ground_width_mm"].as_f64() > antenna["width_mm"].as_f64(), "the ground grows along: {antenna}");
    bench.fails("new c.json --freq 60", 1, "too thick");
}

#[test]
fn new_refuses_what_cannot_be_and_writes_nothing() {
    let bench = Bench::new();
    bench.fails("new a.json --bend h --radius 4.5", 1, "choose more than 4.6100 mm");
    bench.fails("new a.json --padding 0", 1, "cage.padding_mm is 0");
    bench.fails("new a.json --segments 65", 1, "65 segments");
    bench.fails("new a.json --radius 10", 1, "--radius needs a shape");
    bench.fails("new a.json --padding 1,2", 1, "one number or three");
    assert!(!bench.path("a.json").exists(), "nothing was written");
    bench.fails("new none/a.json", 1, "cannot write");
    bench.ok("new a.json");
    let before = fs::read(bench.path("a.json")).unwrap();
    bench.fails("new a.json --bend h", 1, "--force");
    assert_eq!(fs::read(bench.path("a.json")).unwrap(), before, "the old file stays");
}

#[test]
fn files_that_are_no_projects_are_named() {
    let bench = Bench::new();
    bench.fails("info a.json", 1, "cannot read a.json");
    fs::write(bench.path("a.json"), "{\"format\": \"conformant-project\",").unwrap();
    bench.fails("info a.json", 1, "line 1, column");
    fs::write(bench.path("a.json"), r#"{"format": "conformant-project", "version": 9, "project": {}}"#).unwrap();
    bench.fails("deform a.json", 1, "newer Conformant, version 9");
    bench.fails("study --out a.json", 1, "cannot create the folder a.json");
}

#[test]
fn deform_exports_what_verify_proves_and_a_damaged_file_is_found() {
    let bench = Bench::new();
    bench.ok("new a.json --bend h --radius 10 --segments 10,1");
    let report = bench.json("deform a.json --compensate isometric --out ex --json");
    let figures = &report["figures"];
    let number = |v: &Value, key: &str| v[key].as_f64().unwrap_or_else(|| panic!("{key} in {v}"));
    assert!(number(figures, "patch_strain") < 0.005, "{figures}");
    assert!(number(figures, "cylinder_distance_mm") < 0.05, "{figures}");
    assert!(number(figures, "thickness_error").abs() < 1e-3, "{figures}");
    assert!((number(figures, "radius_mm") - 10.0).abs() < 0.05, "{figures}");
    assert!((number(&report["exact_cylinder"], "rho_patch") - 0.00174315).abs() < 1e-4, "{report}");
    assert_eq!(report["compensation"]["mode"], "isometric", "{report}");
    let steps = report["compensation"]["steps"].as_array().unwrap();
    assert_eq!(report["compensation"]["iterations"], steps.len() - 1, "iterations");
    assert!(number(&report["export"], "shared_facets") > 500.0, "{report}");
    assert!(number(&report, "seconds") > 0.0, "{report}");

    assert!(bench.ok("verify ex").contains("proved"), "as exported");
    assert_eq!(bench.json("verify ex --json")["valid"], true, "as JSON");
    let certificate: Value = serde_json::from_slice(&fs::read(bench.path("ex/certificate.json")).unwrap()).unwrap();
    assert!(certificate.to_string().contains("\"rho_patch\""), "the certificate tells the figures");

    let stl = bench.path("ex/patch.stl");
    let mut bytes = fs::read(&stl).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&stl, bytes).unwrap();
    let damaged = bench.run("verify ex");
    assert_eq!(damaged.code, 3, "{}", damaged.out);
    assert!(damaged.out.contains("patch.stl") && damaged.out.contains("SHA-256"), "{}", damaged.out);
    let damaged = bench.run("verify ex --json");
    assert_eq!(damaged.code, 3, "the same code with JSON");
    let report: Value = serde_json::from_str(&damaged.out).unwrap();
    assert!(report["valid"] == false && !report["findings"].as_array().unwrap().is_empty(), "{report}");
    bench.fails("verify none", 1, "none");
}

#[test]
fn deform_without_export_prints_aligned_figures() {
    let bench = Bench::new();
    bench.ok("new a.json --bend h --radius 10 --segments 10,1");
    let text = bench.ok("deform a.json --compensate none");
    for part in ["compensation  none", "rho patch", "-10.8", "exact cylinder", "substrate strain", "vertices"] {
        assert!(text.contains(part), "{part} in:\n{text}");
    }
    assert!(!text.contains("exported"), "{text}");
}

#[test]
fn compensate_prints_iterations_and_names_what_fails() {
    let bench = Bench::new();
    bench.ok("new a.json --bend h --radius 8 --padding 1 --segments 10,1");
    let report = bench.json("compensate a.json --mode wl --scope patch --orders 3 3 --json");
    // golden/green/rho_wl.csv: tangent, padding 1, N 10, orders (3,3), R 8.
    assert!((report["figures"]["rho_patch"].as_f64().unwrap() - 0.00112442).abs() < 1e-3, "{report}");
    assert_eq!(report["compensation"]["fit_orders"].to_string(), "[3,3]", "{report}");
    assert!(report["compensation"]["iterations"].as_u64().unwrap() <= 5, "{report}");
    let text = bench.ok("compensate a.json --mode wl --scope patch");
    assert!(text.contains("iteration  width error  length error\n0 "), "{text}");
    bench.ok("new tight.json --bend h --radius 4.2 --padding 1 --segments 10,1");
    bench.fails("compensate tight.json --mode wl --scope patch --orders 1 1", 1, "leaves its cage");
    bench.fails("compensate tight.json --mode wl --scope whole", 1, "increase the padding");
    bench.fails("compensate a.json --mode wl --orders 0 3", 1, "settings.fit_orders is 0");
    bench.fails("compensate a.json --mode none", 1, "--mode wl");
}

#[test]
fn export_writes_each_shape_and_only_the_formats_asked_for() {
    let bench = Bench::new();
    bench.ok("new a.json --bend e --radius 15");
    for shape in ["flat", "cylinder"] {
        assert!(bench.ok(&format!("export a.json --out {shape} --shape {shape}")).contains("5 solids"), "{shape}");
        bench.ok(&format!("verify {shape}"));
    }
    let report = bench.json("export a.json --out stl --shape flat --format stl --json");
    assert!(report["files"].to_string().contains("patch.stl"), "{report}");
    assert!(!bench.path("stl/antenna.obj").exists() && !bench.path("stl/antenna.glb").exists(), "STL alone");
    bench.ok("new b.json --preset saddle --amplitude 2");
    bench.fails("export b.json --out c --shape cylinder", 1, "only a single bend");
    assert!(!bench.path("c").exists(), "nothing was written");
}

/// Writes one of the golden cages as OBJ.
fn golden_cage(case: &Path, vertices: &str, to: &Path) {
    let read = |name: &str| fs::read_to_string(case.join(name)).unwrap();
    let mut text: String = read(vertices).lines().map(|row| format!("v {}\n", row.replace(',', " "))).collect();
    for row in read("cage_faces.csv").lines() {
        let corners: Vec<String> = row.split(',').map(|v| (v.parse::<usize>().unwrap() + 1).to_string()).collect();
        text.push_str(&format!("f {}\n", corners.join(" ")));
    }
    fs::write(to, text).unwrap();
}

fn numbers(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    text.lines().map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn apply_carries_the_golden_points_and_writes_their_weights() {
    let bench = Bench::new();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/green");
    for case in ["antenna_bend_R10", "ico_irregular"] {
        let case = golden.join(case);
        golden_cage(&case, "cage_rest.csv", &bench.path("rest.obj"));
        golden_cage(&case, "cage_deformed.csv", &bench.path("posed.obj"));
        fs::copy(case.join("points.csv"), bench.path("in.csv")).unwrap();
        bench.ok("apply --cage rest.obj --posed posed.obj --points in.csv --out out.csv --weights w.csv");
        let greatest = |found: &[Vec<f64>], expected: &[Vec<f64>]| {
            assert_eq!(found.len(), expected.len(), "one row per point");
            let pairs = found.iter().flatten().zip(expected.iter().flatten());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let carried = greatest(&numbers(&bench.path("out.csv")), &numbers(&case.join("deformed_stretch_urago.csv")));
        assert!(carried < 1e-11, "{}: {carried:e}", case.display());
        let join = |(mut phi, psi): (Vec<f64>, Vec<f64>)| {
            phi.extend(psi);
            phi
        };
        let (phi, psi) = (numbers(&case.join("phi_urago.csv")), numbers(&case.join("psi_urago.csv")));
        let expected: Vec<_> = phi.into_iter().zip(psi).map(join).collect();
        let weights = greatest(&numbers(&bench.path("w.csv")), &expected);
        assert!(weights < 1e-11, "{}: {weights:e}", case.display());
    }
}

#[test]
fn apply_names_what_does_not_fit() {
    let bench = Bench::new();
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/green/ico_irregular");
    golden_cage(&case, "cage_rest.csv", &bench.path("rest.obj"));
    let text = fs::read_to_string(bench.path("rest.obj")).unwrap();
    fs::write(bench.path("in.csv"), "0,0,0\n1e6,0,0\n").unwrap();
    let apply = "apply --cage rest.obj --posed posed.obj --points in.csv --out out.csv";
    fs::write(bench.path("posed.obj"), &text).unwrap();
    bench.fails(apply, 1, "point 1 at");
    fs::write(bench.path("posed.obj"), text.lines().skip(1).collect::<Vec<_>>().join("\n")).unwrap();
    bench.fails(apply, 1, "posed.obj");
    fs::write(bench.path("posed.obj"), format!("v 0 0 0\n{text}")).unwrap();
    bench.fails(apply, 1, "but the cage at rest has");
    let mut rows: Vec<&str> = text.lines().collect();
    let last = rows.len() - 1;
    rows.swap(last, last - 1);
    fs::write(bench.path("posed.obj"), rows.join("\n")).unwrap();
    bench.fails(apply, 1, "is not that of the cage at rest");
    fs::write(bench.path("posed.obj"), &text).unwrap();
    fs::write(bench.path("in.csv"), "0,0,0\n1,two,3\n").unwrap();
    bench.fails(apply, 1, "line 2");
    assert!(!bench.path("out.csv").exists(), "nothing was written");
}

/// Rows of a table with header by the cells that identify them.
fn table(path: &Path, keys: usize, columns: &[&str]) -> Vec<(String, Vec<Option<f64>>)> {
    let text = fs::read_to_string(path).unwrap();
    let mut rows = text.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let places: Vec<usize> = columns.iter().map(|c| header.iter().position(|h| h == c).unwrap()).collect();
    let row = |row: &str| {
        let cells: Vec<&str> = row.split(',').collect();
        (cells[..keys].join(","), places.iter().map(|&p| cells[p].parse().ok()).collect())
    };
    rows.map(row).collect()
}

/// Compares a table with its golden one; returns the greatest difference.
fn compare(found: &Path, golden: &Path, keys: usize, columns: &[&str]) -> f64 {
    let found: std::collections::HashMap<_, _> = table(found, keys, columns).into_iter().collect();
    let mut greatest = 0.0_f64;
    for (key, expected) in table(golden, keys, columns) {
        let row = found.get(&key).unwrap_or_else(|| panic!("{key} is missing in {}", golden.display()));
        for (value, expected) in row.iter().zip(expected) {
            let value = value.unwrap_or_else(|| panic!("{key} is refused, but not in {}", golden.display()));
            greatest = greatest.max((value - expected.unwrap()).abs());
        }
    }
    greatest
}

#[test]
fn without_a_window_the_example_runs_and_its_study_meets_the_golden_tables() {
    let bench = Bench::new();
    let ran = bench.run("");
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.err.contains("The editor cannot open"), "it says so: {}", ran.err);
    bench.ok("verify out/export");
    bench.ok("info out/example.json");
    for plot in ["convergence", "study/figure_5_paddings", "study/figure_7_compensation", "study/figure_9_width_length"]
    {
        for extension in ["csv", "svg", "png"] {
            assert!(bench.path(&format!("out/{plot}.{extension}")).is_file(), "{plot}.{extension}");
        }
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/green");
    let study = bench.path("out/study");
    let both = ["rho_patch", "rho_substrate"];
    // A tenth of a percentage point; both sides map a grid of their own.
    let raw = compare(&study.join("rho_raw.csv"), &golden.join("rho_raw.csv"), 4, &both);
    assert!(raw < 1e-3, "raw: {raw:e}");
    let wl = compare(&study.join("rho_wl.csv"), &golden.join("rho_wl.csv"), 6, &["rho_patch"]);
    assert!(wl < 1e-3, "WL: {wl:e}");
    let ideal = compare(&study.join("ideal_cylinder_rho.csv"), &golden.join("ideal_cylinder_rho.csv"), 1, &both);
    assert!(ideal < 1e-3, "exact cylinder: {ideal:e}");
    // Points are missing where the cage is refused, and nowhere else; each says why.
    let text = fs::read_to_string(study.join("rho_raw.csv")).unwrap();
    let missing: Vec<&str> = text.lines().filter(|row| row.contains(",,,")).collect();
    assert_eq!(text.lines().count() - 1 - missing.len(), 1212, "as many points as the golden table has");
    assert!(missing.iter().all(|row| row.contains("choose more than")), "each with its reason");
    let wl = fs::read_to_string(study.join("rho_wl.csv")).unwrap();
    assert!(wl.lines().filter(|row| row.contains(",,,")).all(|row| row.contains("inside out")), "{wl}");
}

#[test]
fn a_project_cannot_be_edited_without_a_window_and_the_message_says_what_can() {
    let bench = Bench::new();
    bench.ok("new a.json");
    bench.fails("a.json", 1, "conformant deform a.json");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_study_with_130_and_no_table() {
    let bench = Bench::new();
    let mut child = bench.command("study --out st").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    // The folder is made first, when the handler already stands.
    while !bench.path("st").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    // The shell's own kill: a bare system has no program of that name.
    let killed = Command::new("sh").args(["-c", "kill -INT $0", &child.id().to_string()]).status().unwrap();
    assert!(killed.success(), "the signal was sent");
    assert_eq!(child.wait().unwrap().code(), Some(130), "cancelled");
    assert_eq!(fs::read_dir(bench.path("st")).unwrap().count(), 0, "nothing half-done is left");
}

#[test]
fn a_reader_that_leaves_early_is_no_failure() {
    let bench = Bench::new();
    let mut child = bench.command("--help").stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().code().is_some(), "no crash");
    bench.ok("new a.json");
    let mut child = bench.command("info a.json").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn mesh_reports_its_quality_and_writes_every_format() {
    let bench = Bench::new();
    bench.ok("new a.json --bend h --radius 10 --segments 10");
    let report = bench.json("mesh a.json --density coarse --out m --json");
    assert!(report["tets"].as_u64().unwrap() > 20_000, "{report}");
    assert!(report["whole"]["dihedral_min_deg"].as_f64().unwrap() > 8.0, "{report}");
    assert!(report["map_distance_mm"].as_f64().unwrap() < 0.05, "{report}");
    let names: Vec<_> = report["regions"].as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["air", "substrate", "coax"], "regions with cells");
    for file in ["mesh.msh", "mesh22.msh", "mesh.vtu", "mesh.nas"] {
        assert!(bench.path("m").join(file).metadata().unwrap().len() > 1_000_000, "{file}");
    }
    let text = bench.ok("mesh a.json --density coarse --shape flat");
    assert!(text.contains("tetrahedra") && text.contains("smallest cells"), "{text}");
}

#[test]
fn mesh_fills_a_surface_complex_and_refuses_what_is_none() {
    let bench = Bench::new();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/mesh/R6.5_C.json.gz");
    let report = bench.json(&format!("mesh --surface {} --density coarse --json", golden.display()));
    assert!(report["map_distance_mm"].is_null() && report["tets"].as_u64().unwrap() > 50_000, "{report}");
    fs::write(bench.path("b.json"), "{\"V\": []}").unwrap();
    bench.fails("mesh --surface b.json", 1, "b.json");
    bench.fails("mesh a.json --surface b.json", 2, "cannot be used with");
    bench.fails("mesh", 2, "required");
}

#[test]
fn report_is_one_page_with_the_kept_results_and_says_what_is_missing() {
    let bench = Bench::new();
    bench.ok("new a.json --bend h --radius 11 --segments 10");
    let said = bench.ok("report a.json --out r.html");
    assert!(said.contains("no kept results"), "{said}");
    let html = fs::read_to_string(bench.path("r.html")).unwrap();
    assert!(html.starts_with("<!DOCTYPE html>") && html.trim_end().ends_with("</html>"), "a page");
    for text in ["<h1>a</h1>", "11 mm", "Crossing triangles", "not computed</span>", "Iteration"] {
        assert!(html.contains(text), "{text}");
    }
    for outside in ["http:", "https:", "<script", "<link"] {
        assert!(!html.contains(outside), "nothing of the outside: {outside}");
    }
    bench.fails("report missing.json --out r.html", 1, "missing.json");
    bench.fails("report a.json", 2, "--out");
}
