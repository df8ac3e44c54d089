//! `deform` and `compensate`: the whole job, its figures, and the export.

use super::args::{CompensateArgs, DeformArgs};
use super::choices::{Mode, ScopeChoice};
use super::report::{self, ExportReport, StepReport};
use crate::io::{self, ExportOptions};
use crate::pipeline::{self, Deformed, FiguresReport};
use crate::project::{CompensationMode, Edit, Project, ScopeSpec, file};
use crate::task::Task;
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::Path;

/// What `deform --json` and `compensate --json` print.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// The project file.
    project: String,
    compensation: CompensationReport,
    figures: Option<FiguresReport>,
    /// The same figures of the exact cylinder that the bend aims at; null for other shapes.
    exact_cylinder: Option<FiguresReport>,
    surface: SurfaceReport,
    /// Null without `--out`.
    export: Option<&'a ExportReport>,
    /// Time of the computation without the export.
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct CompensationReport {
    mode: CompensationMode,
    scope: ScopeSpec,
    fit_orders: [usize; 2],
    /// Number of corrections made.
    iterations: usize,
    /// Errors before each correction, and at last those that remain.
    steps: Vec<StepReport>,
}

#[derive(Debug, Serialize)]
struct SurfaceReport {
    vertices: usize,
    triangles: usize,
}

pub(super) fn deform(args: &DeformArgs, task: &Task) -> Result<()> {
    let project = load(&args.file, args.compensate, args.scope, None)?;
    let deformed = pipeline::deform(&project, task).with_context(|| format!("deforming {}", args.file.display()))?;
    let export = match &args.out {
        Some(dir) => {
            let options = ExportOptions { summary: pipeline::summary(&project, &deformed), ..ExportOptions::default() };
            Some(ExportReport::new(dir, &io::export(&deformed.surface(), dir, &options)?))
        }
        None => None,
    };
    show(&args.file, &project, &deformed, export.as_ref(), args.json)
}

pub(super) fn compensate(args: &CompensateArgs, task: &Task) -> Result<()> {
    let project = load(&args.file, args.mode, args.scope, args.orders.as_deref())?;
    let name = args.file.display();
    anyhow::ensure!(
        project.settings.compensation != CompensationMode::None,
        "{name} asks for no compensation: choose one with --mode wl or --mode isometric"
    );
    let deformed = pipeline::deform(&project, task).with_context(|| format!("compensating {name}"))?;
    show(&args.file, &project, &deformed, None, args.json)
}

/// Reads a project and lays the choices of the command line over its settings.
fn load(path: &Path, mode: Option<Mode>, scope: Option<ScopeChoice>, orders: Option<&[usize]>) -> Result<Project> {
    let mut project = file::read(path)?;
    let mut settings = project.settings;
    settings.compensation = mode.map_or(settings.compensation, Into::into);
    settings.scope = scope.map_or(settings.scope, Into::into);
    if let Some(&[p, q]) = orders {
        settings.fit_orders = [p, q];
    }
    Edit::SetSettings(settings).apply(&mut project)?;
    Ok(project)
}

fn show(path: &Path, project: &Project, deformed: &Deformed, export: Option<&ExportReport>, json: bool) -> Result<()> {
    if json {
        let report = report_of(path, project, deformed, export);
        return super::print(&serde_json::to_string_pretty(&report)?);
    }
    super::print(&text(project, deformed, export))
}

fn report_of<'a>(path: &Path, project: &Project, deformed: &Deformed, export: Option<&'a ExportReport>) -> Report<'a> {
    let settings = project.settings;
    Report {
        project: path.display().to_string(),
        compensation: CompensationReport {
            mode: settings.compensation,
            scope: settings.scope,
            fit_orders: settings.fit_orders,
            iterations: deformed.compensation.len().saturating_sub(1),
            steps: deformed.compensation.iter().map(Into::into).collect(),
        },
        figures: deformed.figures.as_ref().map(Into::into),
        exact_cylinder: deformed.ideal.as_ref().map(Into::into),
        surface: SurfaceReport { vertices: deformed.flat.vertices.len(), triangles: deformed.flat.facets.len() },
        export,
        seconds: deformed.seconds,
    }
}

/// Iterations, figures, surface and export for people.
pub(super) fn text(project: &Project, deformed: &Deformed, export: Option<&ExportReport>) -> String {
    let mut parts = Vec::new();
    let settings = project.settings;
    let scope = if settings.scope == ScopeSpec::Whole { "whole antenna" } else { "patch alone" };
    parts.push(match settings.compensation {
        CompensationMode::None => "compensation  none".to_owned(),
        CompensationMode::Wl => {
            format!("compensation  WL, {scope}, fit orders ({}, {})", settings.fit_orders[0], settings.fit_orders[1])
        }
        CompensationMode::Isometric => "compensation  isometric".to_owned(),
    });
    if !deformed.compensation.is_empty() {
        parts.push(format!("\n{}", report::steps_text(&deformed.compensation)));
    }
    parts.push(match &deformed.figures {
        Some(figures) => format!("\n{}\n", report::figures_text(figures, deformed.ideal.as_ref())),
        None => "figures       none: they are the patch template's, and these are imported bodies".to_owned(),
    });
    parts.push(format!(
        "surface       {} vertices, {} triangles, in {:.2} s",
        deformed.flat.vertices.len(),
        deformed.flat.facets.len(),
        deformed.seconds
    ));
    parts.extend(export.map(ExportReport::text));
    parts.join("\n")
}
