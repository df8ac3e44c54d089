//! `info`: what a project holds, and whether it can be posed.

use super::args::InfoArgs;
use super::report::table;
use crate::pipeline::Scene;
use crate::project::{
    AntennaSpec, BodiesSpec, FeedSpec, MaterialSpec, MetalSpec, PresetSpec, Project, ResistorSpec, file,
};
use anyhow::Result;
use serde::Serialize;

/// What `info --json` prints.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// The project as in its file.
    project: &'a Project,
    cage_vertices: usize,
    cage_faces: usize,
    /// Why the cage cannot be posed; null if it can.
    refused: Option<String>,
}

pub(super) fn run(args: &InfoArgs) -> Result<()> {
    let project = file::read(&args.file)?;
    let cage = project.rest_cage()?;
    let refused = Scene::new(&project).and_then(|scene| scene.checked_pose()).err().map(|error| error.to_string());
    let (cage_vertices, cage_faces) = (cage.mesh.vertices.len(), cage.mesh.faces.len());
    let report = Report { project: &project, cage_vertices, cage_faces, refused };
    if args.json {
        return super::print(&serde_json::to_string_pretty(&report)?);
    }
    super::print(&report.text())
}

impl Report<'_> {
    fn text(&self) -> String {
        let (cage, settings) = (self.project.cage, self.project.settings);
        let mut rows = match &self.project.bodies {
            Some(bodies) => body_rows(bodies),
            None => antenna_rows(&self.project.antenna),
        };
        let mut row = |name: &str, text: String| rows.push((name.to_owned(), text));
        let ([dx, dy, dz], [nx, ny]) = (cage.padding_mm, cage.segments);
        let counts = format!("{} vertices, {} faces", self.cage_vertices, self.cage_faces);
        row("cage", format!("padding {dx}, {dy}, {dz} mm, {nx} x {ny} segments: {counts}"));
        for (i, entry) in self.project.presets.iter().enumerate() {
            let off = if entry.enabled { "" } else { " (off)" };
            row(&format!("preset {}", i + 1), preset(entry.preset) + off);
        }
        row("hand edits", format!("{} vertices", self.project.hand_edits.len()));
        let mode = format!("{:?}", settings.compensation).to_lowercase();
        let scope = format!("{:?}", settings.scope).to_lowercase();
        let [p, q] = settings.fit_orders;
        row("compensation", format!("{mode}, scope {scope}, fit orders ({p}, {q})"));
        row("tolerance", format!("{} mm", settings.tolerance_mm));
        row("pose", self.refused.clone().map_or_else(|| "can be posed".to_owned(), |why| format!("refused: {why}")));
        // One padded column and free text: a table would push the text to the right.
        let names: Vec<_> = rows.iter().map(|(name, _)| vec![name.clone()]).collect();
        let width = table(&names).lines().map(|l| l.chars().count()).max().unwrap_or(0);
        rows.iter().map(|(name, text)| format!("{name:<width$}  {text}")).collect::<Vec<_>>().join("\n")
    }
}

/// What bodies are made of, and their feed.
fn body_rows(spec: &BodiesSpec) -> Vec<(String, String)> {
    let feed = spec.feed.map(|FeedSpec { from_mm: from, to_mm: to, ohm }| {
        let place = |[x, y, z]: [f64; 3]| format!("({x:.4}, {y:.4}, {z:.4})");
        ("feed".to_owned(), format!("{ohm} ohm from {} to {} mm", place(from), place(to)))
    });
    spec.bodies.iter().map(|b| (b.name.clone(), b.kind.to_string())).chain(feed).collect()
}

/// The template's dimensions and materials.
fn antenna_rows(antenna: &AntennaSpec) -> Vec<(String, String)> {
    let called = |name: &str| if name.is_empty() { String::new() } else { format!("{name}, ") };
    let material = |m: &MaterialSpec| format!("{}eps_r {}, tan delta {}", called(&m.name), m.eps_r, m.tan_delta);
    let outline = match antenna.outline_mm.len() {
        0 => String::new(),
        n => format!(", outline of {n} points"),
    };
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |name: &str, text: String| rows.push((name.to_owned(), text));
    row(
        "patch",
        format!(
            "W {} x L {} mm, {} mm thick{}",
            antenna.width_mm, antenna.length_mm, antenna.patch_thickness_mm, outline
        ),
    );
    row("substrate", format!("h {} mm, {}", antenna.height_mm, material(&antenna.substrate)));
    let (wide, long) = (antenna.ground_width_mm, antenna.ground_length_mm);
    row("ground", format!("{wide} x {long} mm, {} mm thick", antenna.ground_thickness_mm));
    row("feed", format!("inset {} mm, offset {} mm", antenna.inset_mm, antenna.feed_offset_mm));
    let (pin, outer) = (antenna.pin_radius_mm, antenna.coax_radius_mm);
    row(
        "coax",
        format!("pin {pin} mm, outer {outer} mm, {} mm long, {}", antenna.coax_length_mm, material(&antenna.sheath)),
    );
    for (name, metal) in [("patch metal", &antenna.patch_metal), ("ground metal", &antenna.ground_metal)] {
        if let MetalSpec::Sheet { name: material, ohm_per_square } = metal {
            row(name, format!("{}{ohm_per_square} ohm per square", called(material)));
        }
    }
    for (i, ResistorSpec { x_mm, y_mm, ohm }) in antenna.resistors.iter().enumerate() {
        row(&format!("resistor {}", i + 1), format!("{ohm} ohm at ({x_mm}, {y_mm}) mm, from ground to patch"));
    }
    rows
}

/// A preset in words.
pub(super) fn preset(preset: PresetSpec) -> String {
    match preset {
        PresetSpec::Bend { plane, radius_mm, rule, kept_plane_mm } => {
            let rule = format!("{rule:?}").to_lowercase();
            format!("bend in the {plane:?}-plane, R {radius_mm} mm, {rule} rule, kept plane z = {kept_plane_mm} mm")
        }
        PresetSpec::Convex { radius_mm, amplitude_mm } => format!("convex, R {radius_mm} mm, A {amplitude_mm} mm"),
        PresetSpec::Concave { radius_mm, amplitude_mm } => format!("concave, R {radius_mm} mm, A {amplitude_mm} mm"),
        PresetSpec::Saddle { radius_mm, amplitude_mm } => format!("saddle, R {radius_mm} mm, A {amplitude_mm} mm"),
        PresetSpec::Twist { amplitude_mm, rate_deg_per_mm } => {
            format!("twist, A {amplitude_mm} mm, {rate_deg_per_mm} degrees per mm")
        }
        PresetSpec::Crumple { amplitude_mm, waves: [x, y], phase_deg } => {
            format!("crumple, A {amplitude_mm} mm, {x} waves along x, {y} along y, phase {phase_deg} degrees")
        }
    }
}
