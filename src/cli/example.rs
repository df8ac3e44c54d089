//! The built-in example, run where no window can open: the paper's antenna bent to R = 10 mm and compensated.
//!
//! Everything lands under out/: the project, the export with certificate, the convergence plot, the study, and a
//! picture of the viewport where there is a graphics adapter.

use super::plot_files;
use super::report::ExportReport;
use crate::io::{self, ExportOptions};
use crate::pipeline::{self, Deformed};
use crate::plot::{Axis, Figure, Format, Panel, Point, Series, Style, palette};
use crate::project::{BendPlane, CageSpec, PresetEntry, PresetSpec, Project, RuleSpec, file};
use crate::task::Task;
use anyhow::{Context, Result};
use std::path::Path;

/// Where the example writes.
const OUT: &str = "out";

/// Draws the view of a computed project as a PNG; `None` where nothing can draw.
pub type Draw<'a> = &'a dyn Fn(&Project, &Deformed) -> Result<Option<Vec<u8>>>;

pub(super) fn run(draw: Draw<'_>, task: &Task) -> Result<()> {
    let out = Path::new(OUT);
    std::fs::create_dir_all(out).with_context(|| format!("cannot create the folder {OUT}"))?;
    let project = example();
    file::write(&out.join("example.json"), &project)?;
    let deformed = pipeline::deform(&project, task)?;
    let options = ExportOptions { summary: pipeline::summary(&project, &deformed), ..ExportOptions::default() };
    let dir = out.join("export");
    let export = ExportReport::new(&dir, &io::export(&deformed.surface(), &dir, &options)?);
    super::print(&super::deform::text(&project, &deformed, Some(&export)))?;
    plot_files::write(&convergence(&deformed).into(), out, &Format::ALL)?;
    let picture = out.join("viewport.png");
    let mut written = vec!["example.json", "export/", "convergence.svg, .png and .csv"];
    match draw(&project, &deformed)? {
        Some(png) => {
            io::write_atomic(&picture, &png)?;
            written.push("viewport.png");
        }
        None => super::print("no graphics adapter: no picture of the view")?,
    }
    let study = out.join("study");
    super::study::write(&study, task)?;
    written.push("study/");
    super::print(&format!("\nunder {OUT}/: {}", written.join(", ")))
}

/// The paper's antenna bent in the H-plane to R = 10 mm, with isometric compensation.
fn example() -> Project {
    let preset = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    let cage = CageSpec { segments: [10, 1], ..CageSpec::default() };
    Project { presets: vec![PresetEntry { enabled: true, preset }], cage, ..Project::default() }
}

/// The errors that a compensation works on, iteration by iteration.
fn convergence(deformed: &Deformed) -> Figure {
    let steps = &deformed.compensation;
    let line = |name: &str, color: [u8; 3], pick: fn(&crate::distortion::CompensationStep) -> f64| Series {
        name: name.to_owned(),
        color,
        style: Style::Marked,
        points: steps
            .iter()
            .enumerate()
            .map(|(i, step)| (i as f64, pick(step).abs() * 100.0))
            // An error that is not worked on is exactly zero and has no place on a logarithmic axis.
            .filter(|(_, percent)| *percent > 0.0)
            .map(|(x, percent)| Point { x, y: Ok(percent) })
            .collect(),
    };
    let [width, length, thickness, radius, strain] = palette::DISTINCT;
    Figure {
        name: "convergence",
        title: "Isometric compensation, H-plane bend to R = 10 mm".to_owned(),
        legend: "error or strain".to_owned(),
        panels: vec![Panel {
            title: "Before each iteration".to_owned(),
            y: Axis::log("magnitude (%)", &[]),
            series: vec![
                line("width W", width, |s| s.width_error),
                line("length L", length, |s| s.length_error),
                line("substrate thickness", thickness, |s| s.thickness_error),
                line("radius", radius, |s| s.radius_error),
                line("largest patch strain", strain, |s| s.patch_strain),
            ],
        }],
        columns: 1,
        x: Axis::linear("iteration"),
    }
}
