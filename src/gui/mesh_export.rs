//! Export of the mesh as one file for other programs, on a thread of its own.

use super::dialogs::{PathField, Purpose, problem_with};
use super::export_dialog::{Outcome, answer, busy, show, work};
use super::mesh_session::{ShownMesh, grouped};
use super::outbox::{Action, Outbox};
use super::status::Weight;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::io::msh::{self, MshVersion};
use crate::io::nastran;
use crate::io::vtu::{self, CellField};
use crate::pipeline::mesh_job::ReadyMesh;
use crate::units::to_mm;
use egui::{RichText, Ui};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

/// Form of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Msh4,
    Msh2,
    Vtu,
    Nastran,
}

impl Format {
    const ALL: [(Self, &'static str, &'static str); 4] = [
        (Self::Msh4, "Gmsh MSH 4.1", "With regions, conductors, port and outer boundary under their names"),
        (Self::Msh2, "Gmsh MSH 2.2", "The older form that several field solvers read"),
        (Self::Vtu, "VTK (VTU)", "For ParaView: regions and the quality of each cell, without the boundaries"),
        (Self::Nastran, "NASTRAN", "Bulk data: regions and boundaries by number, their names in comments"),
    ];

    fn ending(self) -> &'static str {
        match self {
            Self::Msh4 | Self::Msh2 => "msh",
            Self::Vtu => "vtu",
            Self::Nastran => "nas",
        }
    }

    fn write(self, ready: &ReadyMesh, path: &Path) -> anyhow::Result<()> {
        let mesh = &ready.meshed.mesh;
        match self {
            Self::Msh4 => msh::write(mesh, MshVersion::V4_1, path)?,
            Self::Msh2 => msh::write(mesh, MshVersion::V2_2, path)?,
            Self::Nastran => nastran::write(mesh, path)?,
            Self::Vtu => {
                let angles: Vec<f64> = ready.cells.iter().map(|c| c.dihedral_min.to_degrees()).collect();
                let inradii: Vec<f64> = ready.cells.iter().map(|c| to_mm(c.inradius)).collect();
                let fields = [
                    CellField { name: "dihedral_min_deg", values: &angles },
                    CellField { name: "inradius_mm", values: &inradii },
                ];
                vtu::write(mesh, &fields, path)?;
            }
        }
        Ok(())
    }
}

#[derive(Debug)]
enum Phase {
    Asking,
    Writing(PathBuf, Receiver<Outcome>),
    Failed(Outcome),
}

/// The dialog.
#[derive(Debug)]
pub(super) struct MeshExport {
    ready: Arc<ReadyMesh>,
    is_stale: bool,
    format: Format,
    field: PathField,
    overwrite: Option<PathBuf>,
    phase: Phase,
}

impl MeshExport {
    /// Offers to export a mesh to a file named `name` in `folder`.
    pub(super) fn new(mesh: &ShownMesh, is_stale: bool, folder: &Path, name: &str) -> Self {
        let format = Format::Msh4;
        let path = folder.join(name).with_extension(format.ending());
        Self {
            ready: Arc::clone(&mesh.ready),
            is_stale,
            format,
            field: PathField::new(Purpose::Data, path.display().to_string()),
            overwrite: None,
            phase: Phase::Asking,
        }
    }

    /// Whether a thread is at work.
    pub(super) fn is_working(&self) -> bool {
        matches!(self.phase, Phase::Writing(..))
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Export mesh");
        let (cells, vertices) = (&self.ready.meshed.mesh.tets, &self.ready.meshed.mesh.vertices);
        let size = format!("{} cells, {} vertices, in millimetres", grouped(cells.len()), grouped(vertices.len()));
        ui.label(RichText::new(size).weak());
        if self.is_stale {
            let text = "⚠ The geometry has changed since this mesh was made.";
            ui.colored_label(Tokens::here(ui).warning, text);
        }
        ui.add_space(6.0);
        if let Phase::Writing(path, receiver) = &self.phase
            && let Some(outcome) = answer(receiver)
        {
            match outcome {
                Ok(lines) => {
                    out.push(Action::Say(Weight::Good, lines.join(" ")));
                    state.last_folder = path.parent().map(Path::to_owned);
                    return true;
                }
                Err(error) => self.phase = Phase::Failed(Err(error)),
            }
        }
        match &self.phase {
            Phase::Asking => self.ask(ui),
            Phase::Writing(..) => {
                busy(ui, "Writing…");
                false
            }
            Phase::Failed(outcome) => {
                show(ui, outcome);
                ui.add_space(8.0);
                let (again, close) =
                    ui.horizontal(|ui| (ui.button("Try again").clicked(), ui.button("Close").clicked())).inner;
                if again {
                    self.phase = Phase::Asking;
                }
                close
            }
        }
    }

    fn ask(&mut self, ui: &mut Ui) -> bool {
        ui.label("Format");
        let before = self.format;
        for (format, text, tip) in Format::ALL {
            ui.radio_value(&mut self.format, format, text).on_hover_text(tip);
        }
        if self.format.ending() != before.ending() && self.field.path().file_name().is_some() {
            self.field.text = self.field.path().with_extension(self.format.ending()).display().to_string();
        }
        ui.add_space(6.0);
        let mut go = self.field.ui(ui, "Mesh file");
        let path = self.field.path();
        let problem = problem_with(&path, true);
        if let Some(problem) = problem {
            ui.label(RichText::new(problem).weak());
        } else if self.overwrite.as_ref() == Some(&path) {
            ui.colored_label(Tokens::here(ui).warning, "This file exists: press again to replace it.");
        }
        ui.add_space(8.0);
        let mut close = false;
        ui.horizontal(|ui| {
            go |= ui.add_enabled(problem.is_none(), egui::Button::new("Export")).clicked();
            close = ui.button("Cancel").clicked();
        });
        if go && problem.is_none() {
            if path.exists() && self.overwrite.as_ref() != Some(&path) {
                self.overwrite = Some(path);
            } else {
                self.start(ui, path);
            }
        }
        close
    }

    fn start(&mut self, ui: &Ui, path: PathBuf) {
        let (ready, format, target) = (Arc::clone(&self.ready), self.format, path.clone());
        let job = move || {
            format.write(&ready, &target)?;
            Ok(vec![format!("Exported the mesh: {}", target.display())])
        };
        self.phase = Phase::Writing(path, work(ui, job));
    }
}
