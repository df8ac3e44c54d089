//! `report`: one page on a project, with the results that are kept beside it.
//!
//! The shape is computed, which takes a fraction of a second; the field is not: what `solve` or the window kept is told,
//! and what is out of date is marked.

use super::args::PageArgs;
use super::example::Draw;
use crate::io::{ExportOptions, certify, write_atomic};
use crate::pipeline::solve_job::RunResult;
use crate::pipeline::{self, MeshSettings, Meshed, PipelineError, Shape, Stored, results_dir, summary};
use crate::project::file;
use crate::report::{self, Contents, Image, MeshContents, RunContents, job_name};
use crate::task::Task;
use crate::tet::Metal;
use anyhow::Result;

/// Most kept results that are told, the newest ones.
const MAX_RUNS: usize = 8;

pub(super) fn run(args: &PageArgs, draw: Draw<'_>, task: &Task) -> Result<()> {
    let project = file::read(&args.file)?;
    let deformed = match pipeline::deform(&project, task) {
        Err(cancelled @ PipelineError::Cancelled(_)) => return Err(cancelled.into()),
        other => other.map_err(|e| e.to_string()),
    };
    let certificate = match &deformed {
        Ok(deformed) => {
            let options = ExportOptions { summary: summary(&project, deformed), ..ExportOptions::default() };
            certify(&deformed.surface(), &options).map_err(|e| e.to_string())
        }
        Err(_) => Err("there is no deformed antenna".to_owned()),
    };
    let meshed: Option<Meshed> = match args.mesh {
        Some(density) if deformed.is_ok() => {
            let settings = MeshSettings { density: density.into(), metal: Metal::Sheet };
            Some(pipeline::mesh(&project, Shape::Deformed, settings, task)?)
        }
        _ => None,
    };
    let (stored, unread): (Vec<_>, Vec<_>) =
        Stored::newest(&results_dir(&args.file), MAX_RUNS).into_iter().partition(Result::is_ok);
    let stored: Vec<Stored> = stored.into_iter().flatten().collect();
    let results: Vec<RunResult> = stored.iter().map(RunResult::from).collect();
    let runs = stored.iter().zip(&results).map(|(stored, result)| RunContents {
        name: job_name(stored.job()),
        result,
        is_stale: stored.job().is_stale(&project),
    });
    let mut pictures = Vec::new();
    if let Ok(deformed) = &deformed
        && let Some(png) = draw(&project, deformed)?
    {
        pictures.push(Image { caption: "The deformed antenna in its cage".to_owned(), png });
    }
    let name = args.file.file_stem().map_or_else(|| "antenna".to_owned(), |s| s.to_string_lossy().into_owned());
    let n_stale = stored.iter().filter(|s| s.job().is_stale(&project)).count();
    let mesh = meshed.as_ref().map(|meshed| MeshContents {
        about: "Deformed antenna with the air around it, sheets".to_owned(),
        meshed,
        is_stale: false,
    });
    let contents = Contents {
        name,
        project: &project,
        deformed: deformed.as_ref().map_err(Clone::clone),
        certificate,
        mesh: mesh.ok_or_else(|| "none was asked for (--mesh makes one)".to_owned()),
        runs: runs.collect(),
        pictures,
    };
    write_atomic(&args.out, report::html(&contents)?.as_bytes())?;
    let missing = deformed.err().map(|why| format!("\nthe deformed antenna is missing: {why}")).unwrap_or_default();
    let results = match (stored.len(), n_stale) {
        (0, _) => "no kept results".to_owned(),
        (n, 0) => format!("{n} kept results"),
        (n, stale) => format!("{n} kept results, {stale} of them out of date"),
    };
    let unread = unread.into_iter().filter_map(Result::err).map(|e| format!("\na kept result cannot be read: {e}"));
    let unread: String = unread.collect();
    super::print(&format!("wrote {}: {results}{missing}{unread}", args.out.display()))
}
