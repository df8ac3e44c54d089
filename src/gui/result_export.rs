//! Export of a run's curves as one file for other programs.

use super::field::Choices;
use super::file_field::{FileField, Pressed};
use super::outbox::{Action, Outbox};
use super::solve_session::{FinishedRun, SolveSession};
use super::status::Weight;
use super::ui_state::UiState;
use crate::io::{csv, touchstone};
use crate::pipeline::solve_job::RunResult;
use crate::units::GHZ;
use egui::{ComboBox, Ui};
use std::path::Path;

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Touchstone,
    Reflection,
    Cuts,
}

impl Format {
    const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Touchstone, "Touchstone (.s1p)", "S11 for circuit simulators, 50 ohm, real and imaginary part"),
        (Self::Reflection, "Reflection (.csv)", "S11 in decibels and degrees, and the input impedance"),
        (Self::Cuts, "Pattern cuts (.csv)", "Directivity in the E and H plane, total, co and cross, at each frequency"),
    ];

    fn ending(self) -> &'static str {
        match self {
            Self::Touchstone => "s1p",
            Self::Reflection | Self::Cuts => "csv",
        }
    }

    fn write(self, run: &FinishedRun, path: &Path) -> anyhow::Result<()> {
        let result = &run.result;
        match self {
            Self::Touchstone => {
                let remarks = [
                    format!("Conformant, {}", run.name),
                    "reference plane: the ground's top; fields exp(+jwt)".to_owned(),
                    format!(
                        "port impedance as meshed {:.3} ohm, {} cells",
                        result.figures.port_impedance_ohm, result.figures.tets
                    ),
                ];
                touchstone::write(&result.sweep, &remarks, path)?;
            }
            Self::Reflection => {
                let header = ["freq_ghz", "s11_re", "s11_im", "s11_db", "s11_phase_deg", "z_re_ohm", "z_im_ohm"];
                let (db, impedance) = (result.sweep.db(), result.sweep.impedance());
                let rows = (0..db.len()).map(|k| {
                    let (s, z) = (result.sweep.s11[k], impedance[k]);
                    [result.sweep.freqs[k] / GHZ, s.re, s.im, db[k], s.arg().to_degrees(), z.re, z.im]
                });
                csv::write_table(path, &header, rows)?;
            }
            Self::Cuts => write_cuts(result, path)?,
        }
        Ok(())
    }
}

/// One row per frequency and degree from broadside.
fn write_cuts(result: &RunResult, path: &Path) -> anyhow::Result<()> {
    let header =
        ["freq_ghz", "psi_deg", "e_total_dbi", "e_co_dbi", "e_cross_dbi", "h_total_dbi", "h_co_dbi", "h_cross_dbi"];
    let rows = result.patterns.iter().flat_map(|pattern| {
        let [e, h] = pattern.cuts();
        let freq = pattern.field.freq / GHZ;
        (0..e.psi.len()).map(move |k| {
            let psi = e.psi[k].to_degrees();
            [freq, psi, e.total[k], e.co[k], e.cross[k], h.total[k], h.co[k], h.cross[k]]
        })
    });
    Ok(csv::write_table(path, &header, rows)?)
}

/// The dialog.
#[derive(Debug)]
pub(super) struct ResultExport {
    runs: Vec<FinishedRun>,
    chosen: usize,
    format: Format,
    file: FileField,
}

impl ResultExport {
    /// Offers to export a run, the newest at first, to a file in `folder` named after the project; `None` without runs.
    pub(super) fn new(solve: &SolveSession, folder: &Path, name: &str) -> Option<Self> {
        let runs = solve.runs().to_vec();
        let format = Format::Touchstone;
        let path = folder.join(name).with_extension(format.ending());
        Some(Self { chosen: runs.len().checked_sub(1)?, runs, format, file: FileField::new(&path) })
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Export results");
        ui.add_space(6.0);
        let label = ui.label("Run");
        let combo = ComboBox::from_id_salt("run").width(240.0).selected_text(&self.runs[self.chosen].name);
        let combo = combo.show_list(ui, |ui| {
            for (k, run) in self.runs.iter().enumerate() {
                ui.selectable_value(&mut self.chosen, k, &run.name);
            }
        });
        combo.response.labelled_by(label.id);
        ui.add_space(6.0);
        ui.label("Format");
        let before = self.format;
        let has_patterns = !self.runs[self.chosen].result.patterns.is_empty();
        for (format, text, tip) in Format::ALL {
            let button = egui::RadioButton::new(self.format == format, text);
            let is_possible = format != Format::Cuts || has_patterns;
            let response = ui.add_enabled(is_possible, button).on_hover_text(tip);
            if response.on_disabled_hover_text("This run has no far field").clicked() {
                self.format = format;
            }
        }
        if self.format == Format::Cuts && !has_patterns {
            self.format = Format::Touchstone;
        }
        if self.format.ending() != before.ending() {
            self.file.rename("", "", self.format.ending());
        }
        ui.add_space(6.0);
        match self.file.ui(ui, "Export") {
            Pressed::Nothing => false,
            Pressed::Cancel => true,
            Pressed::Go(path) => self.export(&path, state, out),
        }
    }

    fn export(&mut self, path: &Path, state: &mut UiState, out: &mut Outbox) -> bool {
        match self.format.write(&self.runs[self.chosen], path) {
            Ok(()) => {
                out.push(Action::Say(Weight::Good, format!("Exported the results: {}", path.display())));
                state.last_folder = path.parent().map(Path::to_owned);
                true
            }
            Err(error) => {
                self.file.failed = Some(format!("{error:#}"));
                false
            }
        }
    }
}
