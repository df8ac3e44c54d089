//! Export of the geometry with its certificate, and its verification, on a thread of their own.

use super::dialogs::{PathField, Purpose};
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::geometry::Plc;
use crate::io::{ExportOptions, export, verify};
use crate::pipeline::{Deformed, exact_cylinder, flat, summary};
use crate::project::Project;
use crate::task::Task;
use anyhow::Context as _;
use egui::{RichText, Spinner, Ui};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Which geometry is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    Deformed,
    Flat,
    Cylinder,
}

impl Which {
    const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Deformed, "Deformed antenna", "As shown: carried by the cage, compensated, split"),
        (Self::Flat, "Flat antenna", "As drawn, without deformation and compensation"),
        (Self::Cylinder, "Exact cylinder", "The antenna as drawn, bent onto the exact cylinder: a reference"),
    ];
}

/// What became of an export or a verification, in lines to show.
pub(super) type Outcome = Result<Vec<String>, String>;

#[derive(Debug)]
enum Phase {
    Asking,
    Exporting(PathBuf, Receiver<Outcome>),
    Exported(PathBuf, Outcome, Verification),
}

#[derive(Debug)]
enum Verification {
    NotAsked,
    Running(Receiver<Outcome>),
    Done(Outcome),
}

/// The dialog.
#[derive(Debug)]
pub(super) struct ExportDialog {
    project: Project,
    deformed: Option<Box<Deformed>>,
    which: Which,
    options: ExportOptions,
    folder: PathField,
    phase: Phase,
}

impl ExportDialog {
    /// Offers to export a project; `deformed` is its geometry, if it has been computed in full.
    pub(super) fn new(project: Project, deformed: Option<&Deformed>, folder: &Path) -> Self {
        let options = ExportOptions::default();
        Self {
            project,
            deformed: deformed.cloned().map(Box::new),
            which: if deformed.is_some() { Which::Deformed } else { Which::Flat },
            options,
            folder: PathField::new(Purpose::Folder, folder.display().to_string()),
            phase: Phase::Asking,
        }
    }

    /// Whether a thread is at work.
    pub(super) fn is_working(&self) -> bool {
        matches!(self.phase, Phase::Exporting(..) | Phase::Exported(_, _, Verification::Running(_)))
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState) -> bool {
        ui.heading("Export geometry");
        ui.add_space(6.0);
        self.collect();
        match &self.phase {
            Phase::Asking => self.ask(ui, state),
            Phase::Exporting(..) => {
                busy(ui, "Writing and proving…");
                false
            }
            Phase::Exported(..) => self.report(ui),
        }
    }

    fn ask(&mut self, ui: &mut Ui, state: &mut UiState) -> bool {
        ui.label("Shape");
        for (which, text, tip) in Which::ALL {
            let possible = which != Which::Deformed || self.deformed.is_some();
            ui.add_enabled_ui(possible, |ui| {
                let button = ui.radio_value(&mut self.which, which, text).on_hover_text(tip);
                button.on_disabled_hover_text("Wait until it has been computed in full, or correct the project first");
            });
        }
        ui.add_space(6.0);
        ui.label("Files");
        ui.add_enabled_ui(false, |ui| ui.checkbox(&mut true, "STL per solid with certificate (always)"));
        ui.checkbox(&mut self.options.obj, "OBJ, one group per solid");
        ui.checkbox(&mut self.options.gltf, "glTF (binary), with materials");
        ui.add_space(6.0);
        self.folder.ui(ui, "Folder (made if it does not exist; files of the same names are replaced)");
        ui.add_space(8.0);
        let named = !self.folder.text.trim().is_empty();
        ui.horizontal(|ui| {
            if ui.add_enabled(named, egui::Button::new("Export")).clicked() {
                let folder = self.folder.path();
                state.last_folder = folder.parent().map(Path::to_owned);
                self.start(ui, folder);
            }
            ui.button("Cancel").clicked()
        })
        .inner
    }

    fn start(&mut self, ui: &Ui, folder: PathBuf) {
        let (project, deformed) = (self.project.clone(), self.deformed.clone());
        let (which, options, target) = (self.which, self.options.clone(), folder.clone());
        let job = move || write(&project, deformed.as_deref(), which, options, &target);
        self.phase = Phase::Exporting(folder, work(ui, job));
    }

    fn collect(&mut self) {
        match &mut self.phase {
            Phase::Exporting(folder, receiver) => {
                if let Some(outcome) = answer(receiver) {
                    self.phase = Phase::Exported(std::mem::take(folder), outcome, Verification::NotAsked);
                }
            }
            Phase::Exported(_, _, verification) => {
                if let Verification::Running(receiver) = verification
                    && let Some(outcome) = answer(receiver)
                {
                    *verification = Verification::Done(outcome);
                }
            }
            Phase::Asking => {}
        }
    }

    fn report(&mut self, ui: &mut Ui) -> bool {
        let Phase::Exported(folder, outcome, verification) = &mut self.phase else { return false };
        ui.label(format!("Folder: {}", folder.display()));
        show(ui, outcome);
        match verification {
            Verification::NotAsked => {}
            Verification::Running(_) => busy(ui, "Verifying…"),
            Verification::Done(outcome) => {
                ui.separator();
                show(ui, outcome);
            }
        }
        ui.add_space(8.0);
        let (mut again, mut close) = (false, false);
        ui.horizontal(|ui| {
            if outcome.is_ok() && matches!(verification, Verification::NotAsked) {
                let tip = "Read the files again and prove the certificate from their bytes";
                if ui.button("Verify").on_hover_text(tip).clicked() {
                    let folder = folder.clone();
                    *verification = Verification::Running(work(ui, move || proved(&folder)));
                }
            }
            again = outcome.is_err() && ui.button("Try again").clicked();
            close = ui.button("Close").clicked();
        });
        if again {
            self.phase = Phase::Asking;
        }
        close
    }
}

/// Runs a job on a thread of its own and wakes the window at its end.
pub(super) fn work<T: Send + 'static>(
    ui: &Ui,
    job: impl FnOnce() -> anyhow::Result<T> + Send + 'static,
) -> Receiver<Result<T, String>> {
    let (sender, receiver) = channel();
    let ctx = ui.ctx().clone();
    let run = move || {
        // The dialog may be gone by now.
        let _ = sender.send(job().map_err(|e| format!("{e:#}")));
        ctx.request_repaint();
    };
    // Without a thread the sender is dropped, and `answer` says so.
    let _ = std::thread::Builder::new().name("dialog".to_owned()).spawn(run);
    receiver
}

/// What came of a job; `None` as long as it is at work.
pub(super) fn answer<T>(receiver: &Receiver<Result<T, String>>) -> Option<Result<T, String>> {
    match receiver.try_recv() {
        Ok(outcome) => Some(outcome),
        Err(TryRecvError::Empty) => None,
        Err(TryRecvError::Disconnected) => Some(Err("the work ended without an answer: try again".to_owned())),
    }
}

pub(super) fn busy(ui: &mut Ui, what: &str) {
    ui.horizontal(|ui| {
        ui.add(Spinner::new());
        ui.label(what);
    });
}

pub(super) fn show(ui: &mut Ui, outcome: &Outcome) {
    let tokens = Tokens::here(ui);
    match outcome {
        Ok(lines) => {
            for (number, line) in lines.iter().enumerate() {
                let color = if number == 0 { tokens.good } else { tokens.text };
                ui.label(RichText::new(line).color(color));
            }
        }
        Err(message) => {
            ui.add(egui::Label::new(RichText::new(message).color(tokens.error)).wrap());
        }
    }
}

fn write(
    project: &Project,
    deformed: Option<&Deformed>,
    which: Which,
    mut options: ExportOptions,
    folder: &Path,
) -> anyhow::Result<Vec<String>> {
    let plc: Plc = match which {
        Which::Deformed => {
            let deformed = deformed.context("the deformed antenna has not been computed yet")?;
            options.summary = summary(project, deformed);
            deformed.surface()
        }
        Which::Flat => flat(project).context("the flat antenna cannot be built")?,
        Which::Cylinder => exact_cylinder(project, &Task::default())?.context(
            "this project is not bent onto one cylinder: leave one bend preset switched on and no hand edits",
        )?,
    };
    let written = export(&plc, folder, &options)?;
    let certificate = &written.certificate;
    Ok(vec![
        "Exported, free of gaps and crossings".to_owned(),
        format!(
            "{} files, {} solids, {} shared facets",
            written.files.len(),
            certificate.solids.len(),
            certificate.n_shared_facets()
        ),
        format!("T-junctions {}, crossing triangles {}", certificate.t_junctions, certificate.crossing_triangles),
        format!("Distance of parts that do not touch: {:.4} mm or more", certificate.clearance_mm),
    ])
}

fn proved(folder: &Path) -> anyhow::Result<Vec<String>> {
    let verification = verify(folder)?;
    if verification.is_valid() {
        let count = verification.certificate.files.len();
        return Ok(vec![
            "Verified: every claim of the certificate holds".to_owned(),
            format!("{count} files read again"),
        ]);
    }
    let first: Vec<String> = verification.findings.iter().take(5).map(ToString::to_string).collect();
    anyhow::bail!("{} faults found: {}", verification.findings.len(), first.join("; "))
}
