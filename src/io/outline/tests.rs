//! Drawings as other programs write them, and as nobody should.

use super::*;
use std::f64::consts::PI;

fn read_text(name: &str, text: &str, unit: Option<f64>) -> Result<Vec<DVec2>, OutlineFileError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    read(&path, unit, 2e-5)
}

/// Area in mm², and extents in mm.
fn figures(outline: &[DVec2]) -> (f64, [f64; 2]) {
    let area: f64 = (0..outline.len()).map(|k| outline[k].perp_dot(outline[(k + 1) % outline.len()])).sum();
    let (lo, hi) = bounds(outline);
    assert!((lo + hi).length() < 1e-12, "about the origin");
    (area / 2.0 * 1e6, ((hi - lo) * 1e3).to_array())
}

fn assert_figures(found: Result<Vec<DVec2>, OutlineFileError>, area: f64, size: [f64; 2], what: &str) {
    let outline = found.unwrap_or_else(|error| panic!("{what}: {error}"));
    let (found_area, found_size) = figures(&outline);
    assert!((found_area / area - 1.0).abs() < 0.01, "{what}: {found_area} mm2, drawn {area}");
    for (found, drawn) in found_size.into_iter().zip(size) {
        assert!((found / drawn - 1.0).abs() < 5e-3, "{what}: {found_size:?} mm, drawn {size:?}");
    }
}

/// A DXF of some entities, with its unit.
fn dxf(unit: i32, entities: &str) -> String {
    let entities = entities.replace(' ', "\n");
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}\n0\nENDSEC\n0\nEOF\n"
    )
}

const SQUARE: &str = "0 LWPOLYLINE 8 patch 90 4 70 1 10 0 20 0 10 8 20 0 10 8 20 4 10 0 20 4";

#[test]
fn polylines_circles_and_joined_lines_of_dxf_are_outlines() {
    let mm = |entities: &str| read_text("a.dxf", &dxf(4, entities), None);
    assert_figures(mm(SQUARE), 32.0, [8.0, 4.0], "polyline");
    assert_figures(mm("0 CIRCLE 10 3 20 -7 40 5"), 25.0 * PI, [10.0, 10.0], "circle");
    let slot = "0 LINE 10 0 20 0 11 10 21 0 0 ARC 10 10 20 2 40 2 50 270 51 90 0 LINE 10 10 20 4 11 0 21 4 0 ARC 10 0 20 2 40 2 50 90 51 270";
    assert_figures(mm(slot), 40.0 + 4.0 * PI, [14.0, 4.0], "lines and arcs, one of them backwards");
    let bulged = "0 LWPOLYLINE 70 1 10 0 20 0 42 1 10 6 20 0 42 1";
    assert_figures(mm(bulged), 9.0 * PI, [6.0, 6.0], "two half circles by bulge");
    let old = "0 POLYLINE 66 1 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 0 20 5 0 VERTEX 10 5 20 0 0 SEQEND";
    assert_figures(mm(old), 12.5, [5.0, 5.0], "a clockwise triangle");
    let inch = read_text("a.dxf", &dxf(1, SQUARE), None);
    assert_figures(inch, 32.0 * 25.4 * 25.4, [203.2, 101.6], "inches");
    assert_figures(read_text("A.DXF", &dxf(0, SQUARE), Some(1e-3)), 32.0, [8.0, 4.0], "the unit as given");
}

#[test]
fn shapes_of_svg_are_outlines_through_their_transforms() {
    let svg = |body: &str| {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='40mm' height='40mm' viewBox='0 0 80 80'>{body}</svg>"
        );
        read_text("a.svg", &text, None)
    };
    // Two units to a millimetre.
    assert_figures(svg("<rect x='3' y='4' width='16' height='8'/>"), 32.0, [8.0, 4.0], "rectangle");
    assert_figures(svg("<path d='M10 10 h16 v8 h-16 z'/>"), 32.0, [8.0, 4.0], "path");
    assert_figures(svg("<path d='M10 10 a10 10 0 1 0 20 0 a10 10 0 1 0 -20 0'/>"), 25.0 * PI, [10.0, 10.0], "arcs");
    assert_figures(
        svg("<g transform='translate(9,9) rotate(90)'><polygon points='0,0 16,0 16,8 0,8'/></g>"),
        32.0,
        [4.0, 8.0],
        "turned",
    );
    assert_figures(svg("<ellipse rx='10' ry='6' transform='scale(2 1)'/>"), 30.0 * PI, [20.0, 6.0], "ellipse");
    assert_figures(svg("<rect width='20' height='20' rx='4'/>"), 100.0 - (4.0 - PI) * 4.0, [10.0, 10.0], "rounded");
    let hidden = "<defs><circle r='9'/></defs><circle r='8' display='none'/><circle cx='9' r='10'/>";
    assert_figures(svg(hidden), 25.0 * PI, [10.0, 10.0], "what is not drawn does not count");
    let outline = svg("<path d='M0 0 L16 0 L8 16 Z'/>").unwrap();
    assert!(outline.iter().filter(|p| p.y > 0.0).count() == 2, "y points down in the file, up here: {outline:?}");
}

#[test]
fn what_is_no_single_outline_is_refused_with_a_reason() {
    let refused = |name: &str, text: &str| read_text(name, text, None).unwrap_err().to_string();
    let two = refused("a.dxf", &dxf(4, &format!("{SQUARE} 0 CIRCLE 10 0 20 0 40 1")));
    assert!(two.contains("2 closed outlines, of 8.000 x 4.000, 2.000 x 2.000 mm: leave the patch's alone"), "{two}");
    let open = refused("a.dxf", &dxf(4, "0 LINE 10 0 20 0 11 1 21 1"));
    assert!(open.contains("no closed outline, but 1 open lines: close the patch's"), "{open}");
    assert!(refused("a.dxf", &dxf(0, SQUARE)).contains("does not say its unit"), "no unit");
    assert!(refused("a.dxf", &dxf(4, "0 SPLINE 10 0 20 0")).contains("1 SPLINE, which are not read"), "spline");
    assert!(refused("a.dxf", "not\na drawing\n").contains("line 1: \"not\" is no DXF group code"), "no DXF");
    assert!(
        refused("a.dxf", &dxf(4, "0 CIRCLE 10 0 20 0")).contains("CIRCLE at line 16 lacks its code 40"),
        "no radius"
    );
    assert!(refused("a.dxf", &dxf(4, "0 CIRCLE 10 nan 20 0 40 1")).contains("nan is no coordinate"), "no number");
    assert!(refused("a.svg", "<svg><rect width='3' height='3'/></svg>").contains("does not say its unit"), "pixels");
    assert!(refused("a.svg", "<svg>").contains("not SVG: "), "broken");
    assert!(refused("a.svg", "<html></html>").contains("it begins with <html>"), "no drawing");
    let broken = read_text("a.svg", "<svg>\n<path d='M 0 zero'/></svg>", Some(1e-3)).unwrap_err().to_string();
    assert!(broken.contains("line 2: the path is broken"), "{broken}");
    assert!(refused("a.png", "").contains("neither .dxf nor .svg"), "another kind");
}

#[test]
fn broken_drawings_never_panic() {
    let good = [
        ("a.dxf", dxf(4, &format!("{SQUARE} 0 ARC 10 0 20 0 40 1 50 0 51 90"))),
        ("a.svg", "<svg width='4mm' viewBox='0 0 8 8'><g transform='matrix(1 0 0 1 2 3)'><path d='M1 1C2 2 3 3 4 1z'/></g></svg>".to_owned()),
    ];
    let mut rng = fastrand::Rng::with_seed(3);
    for (name, text) in good {
        for _ in 0..200 {
            let mut bytes = text.clone().into_bytes();
            for _ in 0..rng.usize(1..4) {
                let at = rng.usize(0..bytes.len());
                bytes[at] = b"0123456789-.e<>'(),z \n"[rng.usize(0..22)];
            }
            let _ = read_text(name, &String::from_utf8_lossy(&bytes), Some(1e-3));
        }
    }
}
