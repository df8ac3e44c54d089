//! Lines of a DXF drawing: pairs of a code and a value, a line of text each.
//!
//! Read are LWPOLYLINE and POLYLINE with bulges, LINE, ARC and CIRCLE of the section ENTITIES, and the unit from the
//! header. Not handled: drawings mirrored by their extrusion. Source: the group codes as published for DXF R12 to 2018.

use super::{Drawing, arc};
use crate::geometry::DVec2;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Metres of a unit by the number that the header has for it.
const UNITS: [(i32, f64); 8] =
    [(1, 0.0254), (2, 0.3048), (4, 1e-3), (5, 1e-2), (6, 1.0), (8, 25.4e-9), (9, 25.4e-6), (13, 1e-6)];
/// What has a shape but is not read.
const UNREAD: [&str; 6] = ["SPLINE", "ELLIPSE", "INSERT", "REGION", "HATCH", "MLINE"];

/// One entity: its kind, and its codes with their values in order.
#[derive(Debug, Default)]
struct Entity {
    kind: String,
    numbers: Vec<(i32, f64)>,
    line: usize,
}

impl Entity {
    fn number(&self, code: i32) -> Option<f64> {
        self.numbers.iter().find(|(c, _)| *c == code).map(|(_, v)| *v)
    }

    fn need(&self, code: i32) -> Result<f64, String> {
        self.number(code).ok_or_else(|| format!("the {} at line {} lacks its code {code}", self.kind, self.line))
    }

    fn point(&self, x: i32, y: i32) -> Result<DVec2, String> {
        Ok(DVec2::new(self.need(x)?, self.need(y)?))
    }

    fn is_closed(&self) -> bool {
        self.number(70).is_some_and(|flags| (flags / 2.0).fract() > 0.25)
    }
}

/// Reads a drawing; `tolerance` in its own unit.
pub(super) fn parse(text: &str, tolerance: f64) -> Result<Drawing, String> {
    let mut lines = text.lines().map(str::trim).enumerate();
    let (mut section, mut variable) = (String::new(), String::new());
    let (mut entities, mut unit): (Vec<Entity>, _) = (Vec::new(), None);
    let mut names_section = false;
    while let Some((n, code)) = lines.next() {
        let Some((_, value)) = lines.next() else { break };
        let code: i32 =
            code.parse().map_err(|_reason| format!("line {}: \"{code:.20}\" is no DXF group code", n + 1))?;
        match code {
            0 => {
                names_section = value == "SECTION";
                if value == "ENDSEC" {
                    section.clear();
                }
                if value == "EOF" {
                    break;
                }
                if section == "ENTITIES" {
                    entities.push(Entity { kind: value.to_owned(), numbers: Vec::new(), line: n + 2 });
                }
            }
            2 if names_section => {
                value.clone_into(&mut section);
                names_section = false;
            }
            9 => value.clone_into(&mut variable),
            70 if section == "HEADER" && variable == "$INSUNITS" => {
                let number: i32 = value.parse().unwrap_or(0);
                unit = UNITS.iter().find(|(n, _)| *n == number).map(|(_, metres)| *metres);
            }
            _ if section == "ENTITIES" => {
                if let (Some(entity), Ok(number)) = (entities.last_mut(), value.parse::<f64>()) {
                    if !number.is_finite() {
                        return Err(format!("line {}: {value:.20} is no coordinate", n + 2));
                    }
                    entity.numbers.push((code, number));
                }
            }
            _ => {}
        }
    }
    let mut drawing = draw(&entities, tolerance)?;
    drawing.unit = unit;
    Ok(drawing)
}

fn draw(entities: &[Entity], tolerance: f64) -> Result<Drawing, String> {
    let mut drawing = Drawing::default();
    let mut unread: HashMap<&str, usize> = HashMap::new();
    let mut rest = entities.iter().peekable();
    while let Some(entity) = rest.next() {
        match entity.kind.as_str() {
            "LINE" => drawing.add(vec![entity.point(10, 20)?, entity.point(11, 21)?], false),
            "CIRCLE" => {
                let circle = arc(entity.point(10, 20)?, radius(entity)?, 0.0, TAU, tolerance);
                drawing.add(circle, true);
            }
            "ARC" => {
                let (from, to) = (entity.need(50)?.to_radians(), entity.need(51)?.to_radians());
                let sweep = (to - from).rem_euclid(TAU);
                drawing.add(arc(entity.point(10, 20)?, radius(entity)?, from, sweep, tolerance), false);
            }
            "LWPOLYLINE" => {
                // A vertex begins with its x; its y and bulge follow.
                let mut vertices: Vec<(DVec2, f64)> = Vec::new();
                for &(code, value) in &entity.numbers {
                    match (code, vertices.last_mut()) {
                        (10, _) => vertices.push((DVec2::new(value, 0.0), 0.0)),
                        (20, Some((p, _))) => p.y = value,
                        (42, Some((_, bulge))) => *bulge = value,
                        _ => {}
                    }
                }
                drawing.add(bulged(&vertices, entity.is_closed(), tolerance), entity.is_closed());
            }
            "POLYLINE" => {
                let mut vertices = Vec::new();
                while let Some(vertex) = rest.next_if(|e| e.kind == "VERTEX") {
                    vertices.push((vertex.point(10, 20)?, vertex.number(42).unwrap_or(0.0)));
                }
                drawing.add(bulged(&vertices, entity.is_closed(), tolerance), entity.is_closed());
            }
            kind => {
                if let Some(kind) = UNREAD.iter().find(|u| **u == kind) {
                    *unread.entry(kind).or_default() += 1;
                }
            }
        }
    }
    if drawing.closed.is_empty() && !unread.is_empty() {
        let mut kinds: Vec<_> = unread.into_iter().map(|(kind, n)| format!("{n} {kind}")).collect();
        kinds.sort();
        return Err(format!("it has {}, which are not read: convert them to polylines", kinds.join(", ")));
    }
    Ok(drawing)
}

fn radius(entity: &Entity) -> Result<f64, String> {
    let radius = entity.need(40)?;
    if radius > 0.0 { Ok(radius) } else { Err(format!("the {} at line {} has no radius", entity.kind, entity.line)) }
}

/// A polyline whose pieces are arcs where they have a bulge: the tangent of a quarter of the arc's angle.
fn bulged(vertices: &[(DVec2, f64)], is_closed: bool, tolerance: f64) -> Vec<DVec2> {
    let n = vertices.len();
    let mut line: Vec<DVec2> = vertices.first().map(|v| v.0).into_iter().collect();
    for k in 0..if is_closed { n } else { n.saturating_sub(1) } {
        let ((a, bulge), (b, _)) = (vertices[k], vertices[(k + 1) % n]);
        let chord = b - a;
        if bulge.abs() > 1e-9 && chord.length() > 0.0 {
            let to_center = chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
            let center = a.midpoint(b) + to_center;
            let sweep = 4.0 * bulge.atan();
            let places = arc(center, center.distance(a), (a - center).to_angle(), sweep, tolerance);
            line.extend(&places[1..places.len() - 1]);
        }
        line.push(b);
    }
    line
}
