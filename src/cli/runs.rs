//! Runs of the solver as the command line does them: with checkpoints, and results kept beside the project.

use super::args::RunArgs;
use super::choices::StopChoice;
use crate::io::{IoError, checkpoint};
use crate::pipeline::{
    self, Job, MeshSettings, PipelineError, RunFigures, Running, Shape, SolveSettings, Solved, StopRule, Stored,
};
use crate::project::Project;
use crate::task::Task;
use crate::tet::Metal;
use crate::units::GHZ;
use anyhow::{Context, Result};
use std::path::Path;
use std::time::{Duration, Instant};

/// Where runs are kept, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keep<'a> {
    /// Folder of results and checkpoints.
    pub(super) dir: &'a Path,
    pub(super) resume: Resume,
    /// Time between checkpoints: what a power cut costs at most.
    pub(super) every: Duration,
}

/// Whether a run goes on from a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resume {
    Never,
    /// If there is one that fits.
    IfThere,
    /// There must be one.
    Must,
}

/// Settings from what was typed.
pub(super) fn settings(project: &Project, args: &RunArgs) -> SolveSettings {
    let band = match args.band.as_deref() {
        Some(&[lo, hi]) => [lo * GHZ, hi * GHZ],
        _ => SolveSettings::usual_band(project),
    };
    let mut settings = SolveSettings::new(MeshSettings { density: args.density.into(), metal: Metal::Sheet }, band);
    if args.stop == StopChoice::Settled {
        settings.stop = StopRule::SETTLED;
    }
    settings
}

/// Solves a shape and keeps the result in a folder; a run that is called off leaves its checkpoint there.
pub(super) fn solve(
    project: &Project,
    shape: Shape,
    settings: &SolveSettings,
    keep: Keep<'_>,
    task: &Task,
) -> Result<(Solved, Stored)> {
    let Keep { dir, resume, every } = keep;
    let job = Job::new(project, shape, settings);
    let path = job.checkpoint_path(dir);
    let before = match resume {
        Resume::Must if !path.exists() => anyhow::bail!(
            "there is no checkpoint of this run in {}: it was finished, never interrupted, or differs; solve without --resume",
            dir.display()
        ),
        Resume::Must => Some(checkpoint::read(&path)?),
        // One that is damaged is as good as none.
        Resume::IfThere => path.exists().then(|| checkpoint::read(&path).ok()).flatten(),
        Resume::Never => None,
    };
    let mut keeper = Keeper { path: &path, written: Instant::now(), every, task, result: Ok(false) };
    let mut run = |from| pipeline::solve(project, shape, settings, from, &mut |running| keeper.watch(running), task);
    let solved = match (run(before.as_ref()), resume) {
        (Err(PipelineError::Solver(_)), Resume::IfThere) if before.is_some() => run(None),
        (solved, _) => solved,
    };
    let is_kept = keeper.result?;
    let solved = match solved {
        Err(PipelineError::Cancelled(cancelled)) if is_kept => {
            let how = if resume == Resume::IfThere { "the same command goes on" } else { "add --resume to go on" };
            eprintln!("kept {}: {how}", path.display());
            return Err(cancelled.into());
        }
        solved => solved?,
    };
    let stored = Stored::new(job, &solved.sweep, solved.fitted, RunFigures::of(&solved), &solved.far_fields);
    stored.save(dir)?;
    if path.exists() {
        std::fs::remove_file(&path).with_context(|| format!("removing {}", path.display()))?;
    }
    Ok((solved, stored))
}

/// Writes checkpoints while a run goes on.
struct Keeper<'a> {
    path: &'a Path,
    written: Instant,
    every: Duration,
    task: &'a Task,
    /// Whether the last state was kept, or why one could not be.
    result: Result<bool, IoError>,
}

impl Keeper<'_> {
    fn watch(&mut self, running: &Running<'_>) {
        let is_called_off = !running.goes_on && self.task.is_cancelled();
        if self.result.is_err() || !(is_called_off || running.goes_on && self.written.elapsed() >= self.every) {
            return;
        }
        if let Some(folder) = self.path.parent()
            && let Err(source) = std::fs::create_dir_all(folder)
        {
            self.result = Err(IoError::System { action: "create", path: folder.to_owned(), source });
            return;
        }
        self.result = checkpoint::write(&running.checkpoint(), self.path).map(|()| is_called_off);
        self.written = Instant::now();
    }
}
