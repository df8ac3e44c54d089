//! `compare`: the deformed antenna flat, on the exact cylinder, uncompensated, WL and isometric, in one go.
//!
//! Each run is kept as `solve` keeps its own and skipped when its result is there, so that an interrupted comparison
//! goes on and a repeated one only draws. Leaves a table (CSV; JSON with `--json`), Touchstone files and a plot for each
//! antenna. Errors are relative to the exact cylinder, where there is one.
//!
//! A shape that cannot be computed (a compensation without result) is a row that says why, and no failure.

mod cases;
mod report;

use super::args::CompareArgs;
use super::plot_files;
use super::runs::{self, Keep, Resume};
use crate::io::{touchstone, write_atomic};
use crate::pipeline::{Job, PipelineError, Stored, results_dir};
use crate::plot::{Axis, Figure, Format, Panel, Point, Series, Style, palette};
use crate::project::file;
use crate::task::Task;
use crate::units::GHZ;
use anyhow::{Context, Result};
use cases::{Group, Variant};
use report::{Report, Row};
use std::path::Path;
use std::time::Duration;

pub(super) fn run(args: &CompareArgs, task: &Task) -> Result<()> {
    let (groups, dir) = match (&args.file, args.paper) {
        (Some(path), _) => {
            (vec![Group::of_project(&file::read(path)?, &path.display().to_string())], results_dir(path))
        }
        (None, Some(which)) => (Group::of_paper(which), args.out.join("results")),
        (None, None) => unreachable!("one of them is required"),
    };
    std::fs::create_dir_all(&args.out).with_context(|| format!("making {}", args.out.display()))?;
    let mut report = Report::default();
    for group in &groups {
        let mut solved = Vec::new();
        for variant in &group.variants {
            solved.push(found_or_solved(group, variant, args, &dir, task)?);
        }
        let runs: Vec<(&Variant, Result<Stored, String>)> = group.variants.iter().zip(solved).collect();
        report.rows.extend(Row::of_group(group, &runs));
        report.files.extend(write(group, &runs, &args.out)?);
        // Written anew after each antenna: an interrupted comparison leaves what it has.
        write_atomic(&args.out.join("compare.csv"), report.csv().as_bytes())?;
    }
    report.files.push("compare.csv".to_owned());
    super::print(&if args.json { serde_json::to_string_pretty(&report)? } else { report.text(&args.out) })
}

/// The result that is kept, or that of a new run; why there is none, if the shape cannot be computed.
fn found_or_solved(
    group: &Group,
    variant: &Variant,
    args: &CompareArgs,
    dir: &Path,
    task: &Task,
) -> Result<Result<Stored, String>> {
    let settings = runs::settings(&variant.project, &args.run);
    if let Some(stored) = Stored::find(&Job::new(&variant.project, variant.shape, &settings), dir)? {
        return Ok(Ok(stored));
    }
    let keep = Keep { dir, resume: Resume::IfThere, every: Duration::from_secs(60) };
    match runs::solve(&variant.project, variant.shape, &settings, keep, task) {
        Ok((_, stored)) => Ok(Ok(stored)),
        Err(error) => match error.downcast_ref::<PipelineError>() {
            Some(PipelineError::Cancelled(_) | PipelineError::Solver(_)) | None => {
                Err(error.context(format!("{}, {}", group.name, variant.name)))
            }
            Some(refused) => Ok(Err(refused.to_string())),
        },
    }
}

/// Writes Touchstone files and the plot; returns their names.
fn write(group: &Group, runs: &[(&Variant, Result<Stored, String>)], out: &Path) -> Result<Vec<String>> {
    let mut files = Vec::new();
    let mut series = Vec::new();
    let mut colors = palette::DISTINCT.into_iter().cycle();
    for (variant, stored) in runs {
        let Ok(stored) = stored else { continue };
        let sweep = stored.sweep();
        let name = format!("{}_{}.s1p", group.name, variant.name);
        let remarks = [
            format!("Conformant, {}, {}", group.title, variant.title),
            "reference plane: the ground's top; fields exp(+jwt)".to_owned(),
        ];
        touchstone::write(&sweep, &remarks, &out.join(&name))?;
        files.push(name);
        let points = sweep.freqs.iter().zip(sweep.db()).map(|(f, y)| Point { x: f / GHZ, y: Ok(y) }).collect();
        let (style, color) = if variant.is_reference {
            (Style::Dashed, palette::REFERENCE)
        } else {
            (Style::Plain, colors.next().unwrap_or(palette::REFERENCE))
        };
        series.push(Series { name: variant.title.to_owned(), color, style, points });
    }
    if series.is_empty() {
        return Ok(files);
    }
    let figure = Figure {
        name: group.name,
        title: group.title.clone(),
        legend: "antenna".to_owned(),
        panels: vec![Panel { title: "At the ground's top, 50 ohm".to_owned(), y: Axis::linear("|S11| (dB)"), series }],
        columns: 1,
        x: Axis::linear("frequency (GHz)"),
    };
    plot_files::write(&figure.into(), out, &Format::ALL)?;
    files.extend(["svg", "png", "csv"].map(|extension| format!("{}.{extension}", group.name)));
    Ok(files)
}
