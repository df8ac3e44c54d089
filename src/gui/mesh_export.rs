//! Export of the mesh as one file for other programs, on a thread of its own.

use super::file_field::{FileField, Pressed};
use super::mesh_session::{ShownMesh, grouped};
use super::outbox::Outbox;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::io::msh::{self, MshVersion};
use crate::io::nastran;
use crate::io::vtu::{self, CellField};
use crate::pipeline::mesh_job::ReadyMesh;
use crate::units::to_mm;
use egui::{RichText, Ui};
use std::path::Path;
use std::sync::Arc;

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

/// The dialog.
#[derive(Debug)]
pub(super) struct MeshExport {
    ready: Arc<ReadyMesh>,
    is_stale: bool,
    format: Format,
    file: FileField,
}

impl MeshExport {
    /// Offers to export a mesh to a file named `name` in `folder`.
    pub(super) fn new(mesh: &ShownMesh, is_stale: bool, folder: &Path, name: &str) -> Self {
        let format = Format::Msh4;
        let path = folder.join(name).with_extension(format.ending());
        Self { ready: Arc::clone(&mesh.ready), is_stale, format, file: FileField::new(&path) }
    }

    /// Whether a thread is at work.
    pub(super) fn is_working(&self) -> bool {
        self.file.is_working()
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
        if let Some(closes) = self.file.working(ui, "Writing…", state, out) {
            return closes;
        }
        ui.label("Format");
        let before = self.format;
        for (format, text, tip) in Format::ALL {
            ui.radio_value(&mut self.format, format, text).on_hover_text(tip);
        }
        if self.format.ending() != before.ending() {
            self.file.rename("", "", self.format.ending());
        }
        ui.add_space(6.0);
        match self.file.ui(ui, "Export") {
            Pressed::Nothing => false,
            Pressed::Cancel => true,
            Pressed::Go(path) => {
                let (ready, format) = (Arc::clone(&self.ready), self.format);
                self.file.write(ui, path, move |path| {
                    format.write(&ready, path)?;
                    Ok(vec![format!("Exported the mesh: {}", path.display())])
                });
                false
            }
        }
    }
}
