//! Saves the report: one page on the project, with everything that is on show in the window.

use super::app::App;
use super::dialogs::Dialog;
use super::file_field::{FileField, Pressed};
use super::mesh_session::{ShownMesh, density_text, shape_text};
use super::outbox::Outbox;
use super::solve_session::FinishedRun;
use super::ui_state::UiState;
use crate::io::{ExportOptions, certify, write_atomic};
use crate::pipeline::{Deformed, summary};
use crate::project::Project;
use crate::report::{self, Contents, Image, MeshContents, RunContents};
use egui::{RichText, Ui};

/// What the report will be of.
#[derive(Clone, Debug)]
struct Subject {
    name: String,
    project: Project,
    deformed: Result<Box<Deformed>, String>,
    mesh: Option<ShownMesh>,
    runs: Vec<FinishedRun>,
}

/// The dialog.
#[derive(Debug)]
pub(super) struct ReportExport {
    subject: Subject,
    file: FileField,
}

impl App {
    /// Asks where to save the report.
    pub(super) fn ask_report(&mut self) {
        let session = &self.session;
        let deformed = match (session.finished(), session.refusal()) {
            (Some(deformed), _) => Ok(Box::new(deformed.clone())),
            (None, Some(why)) => Err(format!("it is refused: {why}")),
            (None, None) => Err("it has not been computed in full yet".to_owned()),
        };
        let subject = Subject {
            name: session.name(),
            project: session.project().clone(),
            deformed,
            mesh: self.mesh.shown().cloned(),
            runs: self.solve.shown().cloned().collect(),
        };
        let file = FileField::new(&self.folder().join(format!("{}-report.html", subject.name)));
        self.dialog = Dialog::Report(Box::new(ReportExport { subject, file }));
    }
}

impl ReportExport {
    /// Whether a thread is at work.
    pub(super) fn is_working(&self) -> bool {
        self.file.is_working()
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Save report");
        ui.add_space(6.0);
        if let Some(closes) = self.file.working(ui, "Writing…", state, out) {
            return closes;
        }
        let text = "One page for any browser and for print: dimensions, certificate, distortion, compensation, and the \
                    mesh and the runs on show. What is missing or out of date is marked.";
        ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
        ui.add_space(6.0);
        for line in self.subject.lines() {
            ui.label(format!("• {line}"));
        }
        ui.add_space(6.0);
        match self.file.ui(ui, "Save") {
            Pressed::Nothing => false,
            Pressed::Cancel => true,
            Pressed::Go(path) => {
                let subject = self.subject.clone();
                self.file.write(ui, path, move |path| {
                    write_atomic(path, subject.html()?.as_bytes())?;
                    Ok(vec![format!("Saved the report: {}", path.display())])
                });
                false
            }
        }
    }
}

impl Subject {
    /// What it will hold, in words.
    fn lines(&self) -> [String; 3] {
        let stale = |is_stale: bool| if is_stale { " (out of date)" } else { "" };
        let geometry = match &self.deformed {
            Ok(_) => "the deformed antenna with its certificate".to_owned(),
            Err(why) => format!("no deformed antenna: {why}"),
        };
        let mesh = match &self.mesh {
            Some(mesh) => format!("the mesh{}", stale(mesh.is_stale(&self.project))),
            None => "no mesh: none was made".to_owned(),
        };
        let names = |run: &FinishedRun| format!("{}{}", run.name, stale(run.is_stale(&self.project)));
        let runs = match &self.runs[..] {
            [] => "no results: none are on show".to_owned(),
            runs => format!("the results of {}", runs.iter().map(names).collect::<Vec<_>>().join("; ")),
        };
        [geometry, mesh, runs]
    }

    fn html(&self) -> anyhow::Result<String> {
        let deformed = self.deformed.as_ref().map(|d| &**d).map_err(Clone::clone);
        let certificate = match &self.deformed {
            Ok(deformed) => {
                let options = ExportOptions { summary: summary(&self.project, deformed), ..ExportOptions::default() };
                certify(&deformed.surface(), &options).map_err(|e| e.to_string())
            }
            Err(_) => Err("there is no deformed antenna".to_owned()),
        };
        let mesh = self.mesh.as_ref().map(|mesh| MeshContents {
            about: format!(
                "{}, density {}",
                shape_text(mesh.request.shape).0,
                density_text(mesh.request.settings.density).0.to_lowercase()
            ),
            meshed: &mesh.ready.meshed,
            is_stale: mesh.is_stale(&self.project),
        });
        let runs = self.runs.iter().map(|run| RunContents {
            name: run.name.clone(),
            result: &run.result,
            is_stale: run.is_stale(&self.project),
        });
        let mut pictures = Vec::new();
        if let Ok(deformed) = deformed
            && let Some(png) = super::picture(&self.project, deformed)?
        {
            pictures.push(Image { caption: "The deformed antenna in its cage".to_owned(), png });
        }
        Ok(report::html(&Contents {
            name: self.name.clone(),
            project: &self.project,
            deformed,
            certificate,
            mesh: mesh.ok_or_else(|| "none was made".to_owned()),
            runs: runs.collect(),
            pictures,
        })?)
    }
}
