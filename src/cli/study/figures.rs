//! The paper's figures from the sweep: what is plotted against what. rho is drawn in percent.

use super::bends::{
    COMPENSATED_PADDINGS_MM, Case, Found, Method, ORDERS, PADDINGS_MM, RADII_MM, RULES, SEGMENTS, Sweep, USUAL_SEGMENTS,
};
use crate::cage::BendRule;
use crate::plot::palette::{DISTINCT, ORDERED, REFERENCE};
use crate::plot::{Axis, Figure, Panel, Point, Series, Style};
use crate::units::to_mm;

/// Padding of figures that show one, mm.
const USUAL_PADDING_MM: f64 = 3.0;
/// Order of the fit where it is not what varies.
const USUAL_ORDER: usize = 5;
/// The parts, by their place in a pair of surface errors.
const PARTS: [(usize, &str); 2] = [(0, "patch"), (1, "substrate")];

/// All figures, in the paper's order.
pub(super) fn all(sweep: &Sweep) -> [Figure; 5] {
    [paddings(sweep), segments(sweep), raw_and_compensated(sweep), orders(sweep), width_and_length(sweep)]
}

fn radius_axis() -> Axis {
    Axis::log("bend radius R (mm)", &[4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 100.0])
}

fn rho_axis(part: &str) -> Axis {
    Axis::linear(&format!("surface error \u{3c1} of the {part} (%)"))
}

fn series(name: String, color: [u8; 3], y: impl Fn(f64) -> Result<f64, String>) -> Series {
    let points = RADII_MM.map(|x| Point { x, y: y(x) }).into();
    Series { name, color, style: Style::Marked, points }
}

impl Sweep {
    fn raw_percent(&self, case: Case, part: usize) -> Result<f64, String> {
        self.raw_rho(case).map(|rho| rho[part] * 100.0)
    }

    fn found(&self, case: Case, method: Method) -> Result<&Found, String> {
        let row = self.compensated.iter().find(|c| c.case == case && c.method == method);
        row.expect("the sweep holds every case plotted").found.as_ref().map_err(Clone::clone)
    }

    fn exact_cylinder(&self, part: usize) -> Series {
        let points = RADII_MM.iter().zip(&self.ideal).map(|(&x, rho)| Point { x, y: Ok(rho[part] * 100.0) }).collect();
        Series { name: "exact cylinder".to_owned(), color: REFERENCE, style: Style::Dashed, points }
    }
}

/// Panels for both parts, row by row, and both rules, column by column.
fn by_part_and_rule(sweep: &Sweep, lines: impl Fn(usize, BendRule) -> Vec<Series>) -> Vec<Panel> {
    let panel = |(part, part_name): (usize, &str), (rule, rule_name): (BendRule, &str)| {
        let mut series = lines(part, rule);
        series.push(sweep.exact_cylinder(part));
        Panel { title: format!("{part_name}, {rule_name} rule"), y: rho_axis(part_name), series }
    };
    PARTS.into_iter().flat_map(|part| RULES.map(|rule| panel(part, rule))).collect()
}

fn paddings(sweep: &Sweep) -> Figure {
    let lines = |part, rule| {
        let line = |(padding_mm, color): (f64, [u8; 3])| {
            series(format!("{padding_mm} mm"), color, |radius_mm| {
                sweep.raw_percent(Case { rule, padding_mm, segments: USUAL_SEGMENTS, radius_mm }, part)
            })
        };
        PADDINGS_MM.into_iter().zip(ORDERED).map(line).collect()
    };
    Figure {
        name: "figure_5_paddings",
        title: format!("Surface error without compensation, N = {USUAL_SEGMENTS}"),
        legend: "cage padding".to_owned(),
        panels: by_part_and_rule(sweep, lines),
        columns: 2,
        x: radius_axis(),
    }
}

fn segments(sweep: &Sweep) -> Figure {
    let lines = |part, rule| {
        let line = |(segments, color): (usize, [u8; 3])| {
            series(format!("N = {segments}"), color, |radius_mm| {
                sweep.raw_percent(Case { rule, padding_mm: USUAL_PADDING_MM, segments, radius_mm }, part)
            })
        };
        SEGMENTS.into_iter().zip(ORDERED).map(line).collect()
    };
    Figure {
        name: "figure_6_segments",
        title: format!("Surface error without compensation, padding {USUAL_PADDING_MM} mm"),
        legend: "cage segments".to_owned(),
        panels: by_part_and_rule(sweep, lines),
        columns: 2,
        x: radius_axis(),
    }
}

/// Panels of the patch for one padding and both rules; `remark` follows in their titles.
fn by_rule(
    sweep: &Sweep,
    padding_mm: f64,
    remark: &str,
    lines: impl Fn(&dyn Fn(f64) -> Case) -> Vec<Series>,
) -> [Panel; 2] {
    RULES.map(|(rule, rule_name)| {
        let case = move |radius_mm| Case { rule, padding_mm, segments: USUAL_SEGMENTS, radius_mm };
        let mut series = lines(&case);
        series.push(sweep.exact_cylinder(0));
        Panel { title: format!("padding {padding_mm} mm, {rule_name} rule{remark}"), y: rho_axis("patch"), series }
    })
}

fn raw_and_compensated(sweep: &Sweep) -> Figure {
    let raw = |case: &dyn Fn(f64) -> Case| series("none".to_owned(), DISTINCT[1], |r| sweep.raw_percent(case(r), 0));
    let compensated = |case: &dyn Fn(f64) -> Case| {
        let lines =
            [("WL, patch alone", DISTINCT[0], Method::Wl(USUAL_ORDER)), ("isometric", DISTINCT[2], Method::Isometric)];
        let line = |(name, color, method): (&str, [u8; 3], Method)| {
            let covered = RADII_MM.into_iter().filter(|&radius_mm| method.covers(case(radius_mm)));
            let rho = |r| sweep.found(case(r), method).map(|found| found.rho[0] * 100.0);
            let points: Vec<Point> = covered.map(|x| Point { x, y: rho(x) }).collect();
            Series { name: name.to_owned(), color, style: Style::Marked, points }
        };
        lines.into_iter().map(line).filter(|series| !series.points.is_empty()).collect::<Vec<_>>()
    };
    let mut panels = Vec::new();
    for padding_mm in COMPENSATED_PADDINGS_MM {
        let all = |case: &dyn Fn(f64) -> Case| std::iter::once(raw(case)).chain(compensated(case)).collect();
        panels.extend(by_rule(sweep, padding_mm, "", all));
        // What compensation leaves is too little to be seen beside what it takes away.
        panels.extend(by_rule(sweep, padding_mm, ", enlarged", compensated));
    }
    Figure {
        name: "figure_7_compensation",
        title: format!("Surface error raw and compensated, N = {USUAL_SEGMENTS}"),
        legend: "compensation".to_owned(),
        panels,
        columns: 2,
        x: radius_axis(),
    }
}

fn orders(sweep: &Sweep) -> Figure {
    let lines = |case: &dyn Fn(f64) -> Case| {
        let line = |(order, color): (usize, [u8; 3])| {
            series(format!("({order}, {order})"), color, |r| {
                sweep.found(case(r), Method::Wl(order)).map(|found| found.rho[0] * 100.0)
            })
        };
        ORDERS.into_iter().zip(DISTINCT).map(line).collect()
    };
    Figure {
        name: "figure_8_orders",
        title: format!("Surface error after WL of the patch alone, by fit orders, N = {USUAL_SEGMENTS}"),
        legend: "fit orders".to_owned(),
        panels: COMPENSATED_PADDINGS_MM.into_iter().flat_map(|padding| by_rule(sweep, padding, "", lines)).collect(),
        columns: 2,
        x: radius_axis(),
    }
}

fn width_and_length(sweep: &Sweep) -> Figure {
    let padding_mm = COMPENSATED_PADDINGS_MM[0];
    let sizes = [to_mm(sweep.params.width), to_mm(sweep.params.length)];
    let panel = |(axis, name): (usize, &str), (rule, rule_name): (BendRule, &str)| {
        let found = |radius_mm| {
            let case = Case { rule, padding_mm, segments: USUAL_SEGMENTS, radius_mm };
            sweep.found(case, Method::Wl(USUAL_ORDER))
        };
        let mut drawn = series("flat, as drawn".to_owned(), REFERENCE, |_| Ok(sizes[axis]));
        drawn.style = Style::Dashed;
        Panel {
            title: format!("{name}, {rule_name} rule"),
            y: Axis::linear(&format!("{name} (mm)")),
            series: vec![
                series("bent, not compensated".to_owned(), DISTINCT[1], |r| found(r).map(|f| f.raw_mm[axis])),
                series("flat, compensated".to_owned(), DISTINCT[0], |r| found(r).map(|f| f.flat_mm[axis])),
                drawn,
            ],
        }
    };
    let dimensions = [(0, "width W"), (1, "length L")];
    Figure {
        name: "figure_9_width_length",
        title: format!("Width and length of the patch under WL, padding {padding_mm} mm, N = {USUAL_SEGMENTS}"),
        legend: "patch".to_owned(),
        panels: dimensions.into_iter().flat_map(|d| RULES.map(|rule| panel(d, rule))).collect(),
        columns: 2,
        x: radius_axis(),
    }
}
