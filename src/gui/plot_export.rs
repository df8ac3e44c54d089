//! Saves a plot as SVG, PNG or CSV.

use super::field::Choices;
use super::file_field::{FileField, Pressed};
use super::outbox::{Action, Outbox};
use super::plots::PlotKind;
use super::status::Weight;
use super::ui_state::UiState;
use crate::io::write_atomic;
use crate::plot::{Format, Plot};
use anyhow::Context as _;
use egui::{ComboBox, Ui};
use std::path::Path;

/// The dialog.
#[derive(Debug)]
pub(super) struct PlotExport {
    plots: Vec<(PlotKind, Plot)>,
    chosen: usize,
    format: Format,
    file: FileField,
}

impl PlotExport {
    /// Offers to save one of some plots, `kind` at first; `None` where there are none.
    pub(super) fn new(plots: Vec<(PlotKind, Plot)>, kind: PlotKind, folder: &Path, name: &str) -> Option<Self> {
        let chosen = plots.iter().position(|(k, _)| *k == kind).unwrap_or(0);
        let stem = plots.get(chosen)?.1.name();
        let format = Format::Svg;
        let file = FileField::new(&folder.join(format!("{name}-{stem}.{}", format.ending())));
        Some(Self { plots, chosen, format, file })
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Save plot");
        ui.add_space(6.0);
        let before = (self.chosen, self.format);
        let label = ui.label("Plot");
        let text = |k: usize| self.plots[k].0.text();
        let combo = ComboBox::from_id_salt("plot").width(260.0).selected_text(text(self.chosen));
        let combo = combo.show_list(ui, |ui| {
            for (k, (kind, _)) in self.plots.iter().enumerate() {
                ui.selectable_value(&mut self.chosen, k, kind.text());
            }
        });
        combo.response.labelled_by(label.id).on_hover_text("With all runs on show, for white paper");
        ui.add_space(6.0);
        ui.label("Format");
        let formats = [
            (Format::Svg, "SVG", "Vectors: for papers and slides, sharp at any size"),
            (Format::Png, "PNG", "Pixels: for mails and documents that take no vectors"),
            (Format::Csv, "CSV", "The numbers behind the plot, a row per point"),
        ];
        for (format, text, tip) in formats {
            ui.radio_value(&mut self.format, format, text).on_hover_text(tip);
        }
        if before != (self.chosen, self.format) {
            let name = |k: usize| self.plots[k].1.name();
            self.file.rename(name(before.0), name(self.chosen), self.format.ending());
        }
        ui.add_space(6.0);
        match self.file.ui(ui, "Save") {
            Pressed::Nothing => false,
            Pressed::Cancel => true,
            Pressed::Go(path) => self.save(&path, state, out),
        }
    }

    fn save(&mut self, path: &Path, state: &mut UiState, out: &mut Outbox) -> bool {
        let (kind, plot) = &self.plots[self.chosen];
        let written = plot.bytes(self.format).map_err(anyhow::Error::from);
        let written = written.and_then(|bytes| Ok(write_atomic(path, &bytes)?));
        match written.with_context(|| format!("saving \"{}\"", kind.text())) {
            Ok(()) => {
                out.push(Action::Say(Weight::Good, format!("Saved the plot: {}", path.display())));
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

/// Adds the menu that saves a plot to where it is drawn.
pub(super) fn menu(response: &egui::Response, kind: PlotKind, out: &mut Outbox) {
    response.context_menu(|ui| {
        if ui.button("Save plot…").on_hover_text("Save it as SVG, PNG or CSV").clicked() {
            out.push(Action::SavePlot(Some(kind)));
            ui.close();
        }
    });
}
