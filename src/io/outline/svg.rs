//! Lines of an SVG drawing: paths, polygons, polylines, rectangles, circles and ellipses, through their transforms.
//!
//! The unit is that of the drawing's width, if it has one and a viewBox. Source: SVG 1.1, chapters 7 to 9.

use super::{Drawing, arc};
use crate::geometry::DVec2;
use kurbo::{Affine, BezPath, PathEl, Point, Rect, Shape};
use roxmltree::{Document, Node, ParsingOptions};
use std::f64::consts::TAU;

/// What is not drawn where it stands.
const NOT_DRAWN: [&str; 8] = ["defs", "symbol", "clipPath", "mask", "marker", "pattern", "metadata", "style"];
/// Metres of the units of lengths.
const UNITS: [(&str, f64); 6] =
    [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("pt", 0.0254 / 72.0), ("pc", 0.0254 / 6.0), ("px", 0.0254 / 96.0)];
/// Error of the curves that stand for ellipses and rounded corners, over the tolerance.
const CURVE: f64 = 0.1;
/// Largest shape, in tolerances: its curves have some ten thousand chords.
const LARGEST: f64 = 1e7;

/// Reads a drawing; `tolerance` in its own unit.
pub(super) fn parse(text: &str, tolerance: f64) -> Result<Drawing, String> {
    // Drawing programs write a document type; what it could name is bounded by the parser.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| format!("not SVG: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(format!("not SVG: it begins with <{}>", root.tag_name().name()));
    }
    let mut drawing = Drawing { unit: unit(root), ..Drawing::default() };
    draw(root, Affine::FLIP_Y, tolerance, &mut drawing)?;
    Ok(drawing)
}

/// Length of the drawing's unit, m.
fn unit(root: Node<'_, '_>) -> Option<f64> {
    let width = root.attribute("width")?.trim();
    let (name, metres) = UNITS.iter().find(|(name, _)| width.ends_with(name))?;
    let length: f64 = width.strip_suffix(name)?.trim().parse().ok()?;
    let view = numbers(root.attribute("viewBox")?);
    let &[_, _, extent, _] = &view[..] else { return None };
    (length > 0.0 && extent > 0.0).then_some(length * metres / extent)
}

/// The numbers of a list.
fn numbers(text: &str) -> Vec<f64> {
    let parts = text.split(|c: char| c.is_whitespace() || c == ',').filter(|part| !part.is_empty());
    parts.map_while(|part| part.parse().ok().filter(|n: &f64| n.is_finite())).collect()
}

fn draw(node: Node<'_, '_>, outer: Affine, tolerance: f64, drawing: &mut Drawing) -> Result<(), String> {
    let name = node.tag_name().name();
    let is_hidden = node.attribute("display") == Some("none");
    if !node.is_element() || is_hidden || NOT_DRAWN.contains(&name) {
        return Ok(());
    }
    let place = || node.document().text_pos_at(node.range().start).row;
    let affine = match node.attribute("transform") {
        Some(text) => {
            outer
                * transform(text)
                    .ok_or_else(|| format!("line {}: the transform \"{text:.40}\" is not read", place()))?
        }
        None => outer,
    };
    // A tolerance in the drawing's unit is one in the element's after its transform.
    let scale = affine.determinant().abs().sqrt().max(f64::MIN_POSITIVE);
    let within = tolerance / scale;
    let number = |key: &str| node.attribute(key).and_then(|v| numbers(v).first().copied()).unwrap_or(0.0);
    let mut add = |path: &BezPath| {
        let too_large = || format!("line {}: a shape is too large for its tolerance", place());
        flatten(&(affine * path), tolerance, drawing).ok_or_else(too_large)
    };
    match name {
        "path" => {
            let data = node.attribute("d").unwrap_or_default();
            let path =
                BezPath::from_svg(data).map_err(|error| format!("line {}: the path is broken: {error}", place()))?;
            add(&path)?;
        }
        "polygon" | "polyline" => {
            let points = numbers(node.attribute("points").unwrap_or_default());
            let mut path = polyline(points.as_chunks().0.iter().map(|&[x, y]| Point::new(x, y)));
            if name == "polygon" && !path.is_empty() {
                path.close_path();
            }
            add(&path)?;
        }
        "rect" => {
            let (x, y) = (number("x"), number("y"));
            let rect = Rect::new(x, y, x + number("width"), y + number("height"));
            let (rx, ry) = (number("rx"), number("ry"));
            let radius = if rx > 0.0 { rx } else { ry };
            if radius > 0.0 {
                add(&rect.to_rounded_rect(radius).to_path(CURVE * within.min(1e6)))?;
            } else {
                add(&rect.to_path(1.0))?;
            }
        }
        "circle" | "ellipse" => {
            let radii = if name == "circle" { [number("r"); 2] } else { [number("rx"), number("ry")] };
            let most = radii[0].max(radii[1]);
            if radii[0] > 0.0 && radii[1] > 0.0 {
                let at = |p: DVec2| Point::new(number("cx") + p.x * radii[0], number("cy") + p.y * radii[1]);
                let mut path = polyline(arc(DVec2::ZERO, 1.0, 0.0, TAU, within / most).into_iter().map(at));
                path.close_path();
                add(&path)?;
            }
        }
        _ => {}
    }
    node.children().try_for_each(|child| draw(child, affine, tolerance, drawing))
}

fn polyline(points: impl Iterator<Item = Point>) -> BezPath {
    points.enumerate().map(|(k, p)| if k == 0 { PathEl::MoveTo(p) } else { PathEl::LineTo(p) }).collect()
}

/// Adds the pieces of a path with chords for its curves; `None` if that would be more of them than anyone can use.
fn flatten(path: &BezPath, tolerance: f64, drawing: &mut Drawing) -> Option<()> {
    let size = path.control_box().size();
    if !path.is_finite() || size.max_side() > LARGEST * tolerance {
        return None;
    }
    let mut line: Vec<DVec2> = Vec::new();
    // Where only the unit is asked for, any chord will do.
    kurbo::flatten(path, tolerance.min(1e9), |element| match element {
        PathEl::MoveTo(p) => {
            drawing.add(std::mem::take(&mut line), false);
            line.push(DVec2::new(p.x, p.y));
        }
        PathEl::LineTo(p) => line.push(DVec2::new(p.x, p.y)),
        PathEl::ClosePath => {
            let start = line.first().copied();
            drawing.add(std::mem::take(&mut line), true);
            line.extend(start);
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    drawing.add(line, false);
    Some(())
}

/// The map of a list of transforms.
fn transform(text: &str) -> Option<Affine> {
    let mut affine = Affine::IDENTITY;
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (name, after) = rest.split_once('(')?;
        let (arguments, after) = after.split_once(')')?;
        let n = numbers(arguments);
        affine *= match (name.trim(), &n[..]) {
            ("translate", &[x]) => Affine::translate((x, 0.0)),
            ("translate", &[x, y]) => Affine::translate((x, y)),
            ("scale", &[s]) => Affine::scale(s),
            ("scale", &[x, y]) => Affine::scale_non_uniform(x, y),
            ("rotate", &[a]) => Affine::rotate(a.to_radians()),
            ("rotate", &[a, x, y]) => Affine::rotate_about(a.to_radians(), Point::new(x, y)),
            ("skewX", &[a]) => Affine::skew(a.to_radians().tan(), 0.0),
            ("skewY", &[a]) => Affine::skew(0.0, a.to_radians().tan()),
            ("matrix", &[a, b, c, d, e, f]) => Affine::new([a, b, c, d, e, f]),
            _ => return None,
        };
        rest = after.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
    }
    Some(affine)
}
