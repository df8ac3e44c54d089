//! The parts of the page, in their order.

use super::html::{Page, Status};
use super::{Contents, RunContents, key_and_unit};
use crate::distortion::{CompensationStep, Figures};
use crate::pipeline::solve_job::{Pattern, RunResult};
use crate::plot::charts::{self, Reflection};
use crate::plot::{PlotError, palette};
use crate::project::{BodySpec, CompensationMode, Project};
use crate::tet::BIN_WIDTH;
use crate::units::{GHZ, to_mm};
use serde_json::Value;

/// Frequencies this close are one, Hz.
const SAME: f64 = 1e5;
/// Decibels from the rim of a pattern to its middle.
const PATTERN_DEPTH: f64 = 30.0;

fn percent(fraction: f64) -> String {
    format!("{:+.2} %", (1e4 * fraction).round() / 100.0 + 0.0)
}

fn mm(length: f64) -> String {
    format!("{:.3} mm", to_mm(length))
}

fn ghz(freq: f64) -> String {
    format!("{:.4} GHz", freq / GHZ)
}

fn or_none(text: Option<String>) -> String {
    text.unwrap_or_else(|| "none".to_owned())
}

fn compensation_text(mode: CompensationMode) -> &'static str {
    match mode {
        CompensationMode::None => "none",
        CompensationMode::Wl => "width and length (WL)",
        CompensationMode::Isometric => "isometric",
    }
}

/// What matters most, and what is missing.
pub(super) fn summary(page: &mut Page, contents: &Contents<'_>) {
    let mut figures = Vec::new();
    if let Some(f) = contents.deformed.as_ref().ok().and_then(|deformed| deformed.figures.as_ref()) {
        figures.push((percent(f.rho_patch), "surface error \u{3c1} of the patch".to_owned()));
        figures.push((percent(f.length_error), "error of the length L".to_owned()));
        figures.push((format!("{:.2} %", 100.0 * f.patch_strain), "largest strain of the patch".to_owned()));
    }
    let newest = contents.runs.iter().rfind(|run| !run.is_stale);
    if let Some((run, found)) = newest.and_then(|run| Some((run, run.result.resonance?))) {
        figures.push((ghz(found.freq), format!("resonance: {}", run.name)));
        if let Some([lo, hi]) = found.band {
            figures.push((format!("{:.0} MHz", (hi - lo) / 1e6), format!("\u{2212}10 dB band: {}", run.name)));
        }
    }
    if !figures.is_empty() {
        page.key_figures(&figures);
    }
    let mode = compensation_text(contents.project.settings.compensation);
    page.paragraph(&format!("Compensation: {mode}."));
    if let Err(why) = &contents.deformed {
        page.paragraph(&format!("The deformed antenna is not part of this report: {why}."));
    }
    if contents.runs.is_empty() {
        page.paragraph("The field has not been solved yet.");
    } else if newest.is_none() {
        page.paragraph("All results of the field solver are out of date: the project has changed since.");
    }
}

/// A value of the project's file in writing.
fn value_text(value: &Value, unit: &str) -> String {
    let text = match value {
        Value::String(text) => text.replace('_', " "),
        Value::Array(items) => items.iter().map(|v| value_text(v, "")).collect::<Vec<_>>().join(", "),
        Value::Null => "none".to_owned(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
        Value::Number(number) => number.as_f64().unwrap_or(f64::NAN).to_string(),
        other => other.to_string(),
    };
    if unit.is_empty() { text } else { format!("{text} {unit}") }
}

/// Rows of an object of the project's file, with those within it behind its name.
fn rows_of(value: &Value, before: &str, rows: &mut Vec<(String, String)>) {
    let Value::Object(fields) = value else { return };
    // What kind of thing it is comes before its numbers.
    let (first, others): (Vec<_>, Vec<_>) = fields.iter().partition(|(key, _)| *key == "kind");
    for (key, value) in first.into_iter().chain(others) {
        let (name, unit) = key_and_unit(key);
        let name = if before.is_empty() { name } else { format!("{before}, {name}") };
        match value {
            Value::Object(_) => rows_of(value, &name, rows),
            _ => rows.push((name, value_text(value, unit))),
        }
    }
}

fn rows<T: serde::Serialize>(value: &T) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    // What has a project file has a JSON form.
    rows_of(&serde_json::to_value(value).unwrap_or_default(), "", &mut rows);
    rows
}

/// The flat antenna as drawn.
pub(super) fn antenna(page: &mut Page, project: &Project) {
    page.section("Flat antenna", None);
    match &project.bodies {
        Some(spec) => {
            let row = |body: &BodySpec| (body.name.clone(), body.kind.to_string());
            page.pairs(&spec.bodies.iter().map(row).collect::<Vec<_>>());
        }
        None => page.pairs(&rows(&project.antenna)),
    }
}

/// Cage, presets, hand edits and settings.
pub(super) fn deformation(page: &mut Page, project: &Project) {
    page.section("Cage and deformation", None);
    page.pairs(&rows(&project.cage));
    if project.presets.is_empty() {
        page.paragraph("No preset: the cage is as its hand edits have it.");
    }
    for (k, entry) in project.presets.iter().enumerate() {
        let off = if entry.enabled { "" } else { " (switched off)" };
        page.heading(&format!("Preset {}{off}", k + 1));
        page.pairs(&rows(&entry.preset));
    }
    if project.hand_edits.is_empty() {
        page.paragraph("No vertex of the cage was moved by hand.");
    } else {
        page.heading("Vertices moved by hand");
        let moved = |(vertex, offset): (&u32, &[f64; 3])| {
            let cells = offset.iter().map(|d| format!("{d:+.3}"));
            std::iter::once(vertex.to_string()).chain(cells).collect()
        };
        let rows: Vec<Vec<String>> = project.hand_edits.iter().map(moved).collect();
        page.table(&["Vertex", "x (mm)", "y (mm)", "z (mm)"], &rows);
    }
    page.heading("Settings");
    page.pairs(&rows(&project.settings));
}

/// What is proved of the surfaces.
pub(super) fn certificate(page: &mut Page, contents: &Contents<'_>) {
    let found = match &contents.certificate {
        Ok(found) => found,
        Err(why) => {
            page.section("Geometry", Some(Status::Missing));
            return page.paragraph(&format!("No certificate: {why}."));
        }
    };
    page.section("Geometry", Some(Status::Current));
    page.paragraph(
        "Each solid is closed and its faces look outward; parts that touch share their facets bit for bit. This is \
         proved of the surfaces as they are exported.",
    );
    let solid = |s: &crate::io::SolidRecord| {
        vec![
            s.material.material.clone(),
            s.shape.triangles.to_string(),
            s.shape.vertices.to_string(),
            format!("{:.4}", s.shape.volume_mm3),
            format!("{:.4}", s.shape.area_mm2),
            s.material.eps_r.to_string(),
            s.material.tan_delta.to_string(),
        ]
    };
    let rows: Vec<Vec<String>> = found.solids.iter().map(solid).collect();
    let head = ["Solid", "triangles", "vertices", "volume (mm\u{b3})", "area (mm\u{b2})", "\u{3b5}r", "tan \u{3b4}"];
    page.table(&head, &rows);
    page.pairs(&[
        ("Facets shared by two solids".to_owned(), found.n_shared_facets().to_string()),
        ("T-junctions".to_owned(), found.t_junctions.to_string()),
        ("Crossing triangles".to_owned(), found.crossing_triangles.to_string()),
        ("Distance of parts that do not touch".to_owned(), format!("{:.4} mm or more", found.clearance_mm)),
    ]);
}

type FigureLine = (&'static str, fn(&Figures) -> Option<String>);

const FIGURES: [FigureLine; 14] = [
    ("Surface error \u{3c1}, patch", |f| Some(percent(f.rho_patch))),
    ("Surface error \u{3c1}, substrate", |f| Some(percent(f.rho_substrate))),
    ("Width W", |f| Some(mm(f.width))),
    ("Error of the width", |f| Some(percent(f.width_error))),
    ("Length L", |f| Some(mm(f.length))),
    ("Error of the length", |f| Some(percent(f.length_error))),
    ("Height h under the patch", |f| Some(mm(f.thickness))),
    ("Error of the height", |f| Some(percent(f.thickness_error))),
    ("Radius R reached", |f| f.radius.map(mm)),
    ("Largest strain, patch", |f| Some(format!("{:.3} %", 100.0 * f.patch_strain))),
    ("Strain rms, patch", |f| Some(format!("{:.3} %", 100.0 * f.patch_strain_rms))),
    ("Largest strain, substrate", |f| Some(format!("{:.3} %", 100.0 * f.substrate_strain))),
    ("Greatest distance from the cylinder", |f| f.cylinder_distance.map(|d| format!("{:.4} mm", to_mm(d.greatest)))),
    ("Distance from the cylinder, rms", |f| f.cylinder_distance.map(|d| format!("{:.4} mm", to_mm(d.rms)))),
];

/// The figures beside those of the exact cylinder.
pub(super) fn distortion(page: &mut Page, contents: &Contents<'_>) {
    let Ok(deformed) = &contents.deformed else { return page.section("Distortion", Some(Status::Missing)) };
    page.section("Distortion", Some(Status::Current));
    let Some(figures) = &deformed.figures else {
        return page.paragraph("The figures are those of the patch's template; imported bodies have none.");
    };
    let ideal = deformed.ideal.as_ref();
    let rows: Vec<Vec<String>> = FIGURES
        .iter()
        .filter_map(|(name, text)| {
            let own = text(figures)?;
            let ideal = ideal.map(|f| text(f).unwrap_or_default());
            Some([(*name).to_owned(), own].into_iter().chain(ideal).collect())
        })
        .collect();
    let head: &[&str] = if ideal.is_some() { &["", "this antenna", "exact cylinder"] } else { &["", "this antenna"] };
    page.table(head, &rows);
}

/// The iterations.
pub(super) fn compensation(page: &mut Page, contents: &Contents<'_>) {
    let mode = contents.project.settings.compensation;
    if mode == CompensationMode::None {
        page.section("Compensation", None);
        return page.paragraph("None: the antenna is deformed as drawn.");
    }
    let Ok(deformed) = &contents.deformed else { return page.section("Compensation", Some(Status::Missing)) };
    page.section("Compensation", Some(Status::Current));
    if deformed.compensation.is_empty() {
        return page.paragraph("There is nothing to compensate: the antenna is flat.");
    }
    let text = compensation_text(mode);
    page.paragraph(&format!("Way: {text}. Errors before each iteration; the last row is what remains."));
    let row = |(k, s): (usize, &CompensationStep)| {
        let errors = [s.width_error, s.length_error, s.thickness_error, s.radius_error, s.patch_strain];
        // Exactly zero stands for "not measured in this step".
        let text = |e: f64| if e.abs() > 0.0 { format!("{:+.4} %", 100.0 * e) } else { "\u{2013}".to_owned() };
        std::iter::once(k.to_string()).chain(errors.map(text)).collect()
    };
    let rows: Vec<Vec<String>> = deformed.compensation.iter().enumerate().map(row).collect();
    page.table(&["Iteration", "width W", "length L", "height h", "radius R", "largest strain"], &rows);
}

/// How good the mesh is.
pub(super) fn mesh(page: &mut Page, contents: &Contents<'_>) -> Result<(), PlotError> {
    let mesh = match &contents.mesh {
        Ok(mesh) => mesh,
        Err(why) => {
            page.section("Mesh", Some(Status::Missing));
            page.paragraph(&format!("No mesh: {why}."));
            return Ok(());
        }
    };
    page.section("Mesh", Some(if mesh.is_stale { Status::Stale } else { Status::Current }));
    page.paragraph(&format!("{}.", mesh.about));
    let (meshed, whole) = (mesh.meshed, &mesh.meshed.quality.whole);
    let degrees = |a: f64| format!("{:.2}\u{b0}", a.to_degrees());
    page.pairs(&[
        ("Tetrahedra".to_owned(), meshed.mesh.tets.len().to_string()),
        ("Vertices".to_owned(), meshed.mesh.vertices.len().to_string()),
        ("Smallest dihedral angle".to_owned(), degrees(whole.dihedral_min)),
        ("One cell in a hundred is below".to_owned(), degrees(whole.dihedral_p1)),
        ("Largest dihedral angle".to_owned(), degrees(whole.dihedral_max)),
        ("Smallest inradius".to_owned(), format!("{:.4} mm", to_mm(whole.inradius_min))),
        ("Greatest distance from the smooth map".to_owned(), format!("{:.4} mm", to_mm(meshed.map_distance))),
        ("Time".to_owned(), format!("{:.1} s", meshed.seconds)),
    ]);
    let counts: Vec<f64> = whole.histogram.iter().map(|&n| n as f64).collect();
    let axes = ["smallest dihedral angle (\u{b0})", "cells"];
    let bins = [0.0, BIN_WIDTH.to_degrees()];
    let plot = charts::histogram("angles", "Cells by their smallest dihedral angle", axes, bins, &counts);
    page.plot(&plot, "Flat cells have small angles; the field solver's time step follows the smallest inradius.")
}

type RunLine = (&'static str, fn(&RunResult) -> Option<String>);

const RUN: [RunLine; 12] = [
    ("Resonance (smallest |S11|)", |r| Some(ghz(r.resonance?.freq))),
    ("Resonance by fit", |r| Some(format!("{} \u{b1} {:.4} GHz", ghz(r.fitted?.freq), r.fitted?.freq_error / GHZ))),
    ("Q by fit, loaded", |r| Some(format!("{:.2} \u{b1} {:.2}", r.fitted?.q, r.fitted?.q_error))),
    ("|S11| there", |r| Some(format!("{:.2} dB", r.resonance?.depth_db))),
    ("\u{2212}10 dB band", |r| r.resonance?.band.map(|[lo, hi]| format!("{:.0} MHz", (hi - lo) / 1e6))),
    ("  from", |r| r.resonance?.band.map(|b| ghz(b[0]))),
    ("  to", |r| r.resonance?.band.map(|b| ghz(b[1]))),
    ("Port as meshed", |r| Some(format!("{:.3} \u{3a9}", r.figures.port_impedance_ohm))),
    ("Cells", |r| Some(r.figures.tets.to_string())),
    ("Steps", |r| Some(format!("{} of {:.1} fs", r.figures.steps, r.figures.dt_s * 1e15))),
    ("Decay of the reflected voltage", |r| {
        let early = if r.figures.is_settled { "" } else { ", stopped before its rule was met" };
        Some(format!("{:.1} dB{early}", r.figures.residual_db))
    }),
    ("Time", |r| Some(format!("{:.1} s", r.figures.seconds))),
];

fn color(k: usize) -> [u8; 3] {
    palette::DISTINCT[k % palette::DISTINCT.len()]
}

fn run_status(runs: &[RunContents<'_>]) -> Status {
    match runs {
        [] => Status::Missing,
        runs if runs.iter().all(|run| run.is_stale) => Status::Stale,
        _ => Status::Current,
    }
}

fn run_name(run: &RunContents<'_>) -> String {
    if run.is_stale { format!("{} (out of date)", run.name) } else { run.name.clone() }
}

/// S11 of all runs.
pub(super) fn reflection(page: &mut Page, contents: &Contents<'_>) -> Result<(), PlotError> {
    let runs = &contents.runs;
    page.section("Reflection", Some(run_status(runs)));
    if runs.is_empty() {
        page.paragraph("The field has not been solved yet: \"conformant solve\" does, or Solve in the window.");
        return Ok(());
    }
    let names: Vec<String> = runs.iter().map(run_name).collect();
    let head: Vec<&str> = std::iter::once("").chain(names.iter().map(String::as_str)).collect();
    let row = |(name, text): &RunLine| {
        std::iter::once((*name).to_owned()).chain(runs.iter().map(|run| or_none(text(run.result)))).collect()
    };
    page.table(&head, &RUN.iter().map(row).collect::<Vec<_>>());
    let curves: Vec<Reflection<'_>> = runs
        .iter()
        .zip(&names)
        .enumerate()
        .map(|(k, (run, name))| Reflection { name, color: color(k), sweep: &run.result.sweep })
        .collect();
    page.plot(&charts::magnitude("Reflection", &curves), "|S11| at the ground's top, 50 \u{3a9}.")?;
    page.plot(&charts::smith("Smith chart", &curves), "The smallest |S11| is marked.")
}

type PatternLine = (&'static str, fn(&Pattern) -> Option<String>);

const PATTERN: [PatternLine; 9] = [
    ("Frequency", |p| Some(ghz(p.field.freq))),
    ("Directivity", |p| Some(format!("{:.2} dBi", p.max().0))),
    ("  towards \u{3b8}, \u{3c6}", |p| Some(p.max().1.map(|a| format!("{:.0}\u{b0}", a.to_degrees())).join(", "))),
    ("Gain", |p| Some(format!("{:.2} dBi", p.max().0 + 10.0 * p.field.efficiency().log10()))),
    ("Half-power width, E plane", |p| p.cuts()[0].half_power_width().map(|a| format!("{:.1}\u{b0}", a.to_degrees()))),
    ("Half-power width, H plane", |p| p.cuts()[1].half_power_width().map(|a| format!("{:.1}\u{b0}", a.to_degrees()))),
    ("Front to back", |p| Some(format!("{:.1} dB", p.field.front_to_back()))),
    ("Efficiency", |p| Some(format!("{:.1} %", 100.0 * p.field.efficiency()))),
    ("Power balance", |p| p.field.balance().map(|b| format!("{:.1} %", 100.0 * b))),
];

/// The pattern of a run nearest to its resonance.
fn resonant(result: &RunResult) -> Option<&Pattern> {
    let wanted = result.resonance.map(|r| r.freq);
    let middle = result.patterns.get(result.patterns.len() / 2);
    let near = |p: &&Pattern| wanted.map_or(0.0, |f| (p.field.freq - f).abs());
    match wanted {
        Some(_) => result.patterns.iter().min_by(|a, b| near(a).total_cmp(&near(b))),
        None => middle,
    }
}

/// The far field of all runs that have one, each at its own resonance.
pub(super) fn patterns(page: &mut Page, contents: &Contents<'_>) -> Result<(), PlotError> {
    let found: Vec<(usize, &RunContents<'_>, &Pattern)> =
        contents.runs.iter().enumerate().filter_map(|(k, run)| Some((k, run, resonant(run.result)?))).collect();
    if found.is_empty() {
        page.section("Radiation", Some(Status::Missing));
        page.paragraph(
            "No far field is at hand: it is not kept with the results. Solve in the window and make the report there.",
        );
        return Ok(());
    }
    let all_stale = found.iter().all(|(_, run, _)| run.is_stale);
    page.section("Radiation", Some(if all_stale { Status::Stale } else { Status::Current }));
    let names: Vec<String> = found.iter().map(|(_, run, _)| run_name(run)).collect();
    let head: Vec<&str> = std::iter::once("").chain(names.iter().map(String::as_str)).collect();
    let row = |(name, text): &PatternLine| {
        std::iter::once((*name).to_owned()).chain(found.iter().map(|(_, _, p)| or_none(text(p)))).collect()
    };
    page.table(&head, &PATTERN.iter().map(row).collect::<Vec<_>>());
    let cuts: Vec<charts::Cuts<'_>> =
        found.iter().zip(&names).map(|((k, _, p), name)| (name.as_str(), color(*k), p.cuts())).collect();
    let freqs: Vec<f64> = found.iter().map(|(_, _, p)| p.field.freq).collect();
    let same = freqs.iter().all(|f| (f - freqs[0]).abs() < SAME);
    let caption =
        if same { format!("Directivity at {}.", ghz(freqs[0])) } else { "Each at its own resonance.".to_owned() };
    page.plot(&charts::cuts("Directivity", &cuts, PATTERN_DEPTH, false), &caption)
}
