//! `import`: bodies become a project, or are refused with what is wrong and where.

use super::bench::Bench;
use std::fs;

/// A tetrahedron of 10 mm, with some of its faces.
fn tetrahedron(name: &str, at: f64, n_faces: usize) -> String {
    let corners = [[at, 0.0, 0.0], [at + 10.0, 0.0, 0.0], [at, 10.0, 0.0], [at, 0.0, 10.0]];
    let mut text = format!("solid {name}\n");
    for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].iter().take(n_faces) {
        text += "facet normal 0 0 0\nouter loop\n";
        for &k in face {
            let [x, y, z]: [f64; 3] = corners[k];
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid\n"
}

#[test]
fn an_export_is_imported_bent_and_proved_again() {
    let bench = Bench::new();
    bench.ok("new a.json");
    bench.ok("export a.json --shape flat --out flat");
    let said = bench.ok("import flat/antenna.glb --out own.json");
    assert!(
        said.contains("substrate") && said.contains("perfect conductor") && said.contains("wrote own.json"),
        "{said}"
    );
    assert!(bench.ok("info own.json").contains("eps_r 2.2"), "what they are made of");
    let bent = bench.json("deform own.json --out bent --json");
    assert!(bent["figures"].is_null() && bent["export"]["files"].as_array().is_some(), "no figures: {bent}");
    bench.ok("verify bent");
    bench.fails("import flat/antenna.glb --feed 9,9", 1, "no gap between two metal bodies");
    bench.fails("import flat/antenna.glb --feed 3,2,1", 1, "--feed takes two numbers");
    bench.ok("import flat/antenna.glb --feed 3,2 --out fed.json");
    let said = bench.ok("info fed.json");
    assert!(said.contains("50 ohm from (3.0000, 2.0000, -1.5750) to (3.0000, 2.0000, 0.0000) mm"), "{said}");
    bench.fails("solve own.json --band 7 14", 1, "the imported bodies have no feed");
    bench.fails("import flat/antenna.glb --out own.json", 1, "--force");
    bench.fails("deform own.json --compensate wl", 1, "compensation needs the patch's template");
}

#[test]
fn what_is_missing_open_or_overlaps_is_told() {
    let bench = Bench::new();
    let write = |name: &str, text: String| fs::write(bench.path(name), text).unwrap();
    write("good.stl", tetrahedron("Peak", 0.0, 4));
    write("open.stl", tetrahedron("rest", 40.0, 3));
    write("near.stl", tetrahedron("near", 2.0, 4));
    bench.fails("import good.stl", 1, "say what these bodies are made of");
    bench.fails("import good.stl --metal pea", 1, "no body is called \"pea\"");
    bench.fails("import good.stl --dielectric peak=x", 1, "NAME=EPS_R");
    bench.fails("import good.stl --dielectric peak=0.5", 1, "eps_r 0.5");
    bench.fails("import good.stl --metal peak --unit feet", 1, "--unit takes one of mm");
    let report = bench.json("import good.stl --metal peak --json");
    assert!((report["bodies"][0]["volume_mm3"].as_f64().unwrap() - 1e3 / 6.0).abs() < 1e-6, "{report}");
    bench.fails("import good.stl open.stl --metal peak --metal rest", 1, "\"rest\" is open at 3 edges");
    bench.fails("import good.stl near.stl --metal peak --metal near", 1, "\"peak\" and \"near\" overlap at");
    let ran = bench.run("import good.stl open.stl --metal peak --metal rest --json");
    let report: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!((ran.code, report["faults"][0]["places_mm"].as_array().unwrap().len()), (1, 3), "{report}");
}
