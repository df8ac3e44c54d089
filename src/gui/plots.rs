//! The plots on show as they are saved: which there are, and what they hold.

use super::app::App;
use super::dialogs::Dialog;
use super::heat::N_BINS;
use super::plot_export::PlotExport;
use super::polar;
use super::solve_session::FinishedRun;
use super::theme::Tokens;
use super::ui_state::{Curve, Polarization, ResultTab, RightTab, UiState};
use crate::plot::charts::{self, Cuts, Reflection};
use crate::plot::{Plot, charts::histogram};
use crate::tet::BIN_WIDTH;
use egui::Theme;

/// A plot that can be saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlotKind {
    Magnitude,
    Phase,
    Smith,
    Cuts,
    MeshAngles,
    Distortion,
}

impl PlotKind {
    /// All of them, in the order of the choice.
    pub(super) const ALL: [Self; 6] =
        [Self::Magnitude, Self::Phase, Self::Smith, Self::Cuts, Self::MeshAngles, Self::Distortion];

    /// Its name in the choice.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Magnitude => "|S11| over frequency",
            Self::Phase => "Phase of S11 over frequency",
            Self::Smith => "Smith chart",
            Self::Cuts => "Pattern in the E and H planes",
            Self::Distortion => "Histogram of the distortion",
            Self::MeshAngles => "Cells by dihedral angle",
        }
    }
}

/// A colour of the light theme, whatever the window's is: plots are for white paper.
fn on_paper(series: usize) -> [u8; 3] {
    let [r, g, b, _] = Tokens::of(Theme::Light).series[series].to_srgba_unmultiplied();
    [r, g, b]
}

impl App {
    /// Asks where to save a plot, beginning with the kind named or the one on show.
    pub(super) fn ask_plot(&mut self, kind: Option<PlotKind>) {
        let mut plots: Vec<(PlotKind, Plot)> = Vec::new();
        for kind in PlotKind::ALL {
            plots.extend(self.plot(kind).map(|plot| (kind, plot)));
        }
        let kind = kind.unwrap_or_else(|| on_show(&self.state));
        if let Some(dialog) = PlotExport::new(plots, kind, &self.folder(), &self.session.name()) {
            self.dialog = Dialog::PlotExport(Box::new(dialog));
        }
    }

    /// A plot of what is on show; `None` where there is nothing to plot.
    fn plot(&mut self, kind: PlotKind) -> Option<Plot> {
        let name = self.session.name();
        let runs: Vec<&FinishedRun> = self.solve.shown().collect();
        let reflections: Vec<Reflection<'_>> = runs
            .iter()
            .map(|run| Reflection { name: &run.name, color: on_paper(run.color), sweep: &run.result.sweep })
            .collect();
        let some = (!reflections.is_empty()).then_some(reflections.as_slice());
        match kind {
            PlotKind::Magnitude => some.map(|runs| charts::magnitude(&format!("Reflection, {name}"), runs)),
            PlotKind::Phase => some.map(|runs| charts::phase(&format!("Phase of the reflection, {name}"), runs)),
            PlotKind::Smith => some.map(|runs| charts::smith(&format!("Reflection, {name}"), runs)),
            PlotKind::Cuts => {
                let freq = polar::frequency(&self.solve, &self.state.solve)?;
                let found = runs.iter().filter_map(|run| Some((*run, polar::pattern(run, freq)?)));
                let cuts: Vec<Cuts<'_>> =
                    found.map(|(run, p)| (run.name.as_str(), on_paper(run.color), p.cuts())).collect();
                let chosen = &self.state.solve;
                let title = format!("Directivity at {}, {name}", polar::freq_text(freq));
                let in_parts = chosen.polarization == Polarization::Parts;
                (!cuts.is_empty()).then(|| charts::cuts(&title, &cuts, chosen.range_db, in_parts))
            }
            PlotKind::Distortion => {
                let on_show = self.compare.on_show_or(&self.session, self.state.preview);
                let (heat, part) = (self.state.heat, self.state.heat_part);
                let heated = self.viewport.heated(on_show, &self.state)?;
                let [lo, hi] = self.state.heat_range(heated.auto);
                let title = format!("{}, {}, {name}", heat.text(), part.text().to_lowercase());
                let step = f64::from(hi - lo) / N_BINS as f64;
                Some(histogram(
                    "distortion",
                    &title,
                    [heat.axis(), "area (%)"],
                    [f64::from(lo), step],
                    &heated.bins([lo, hi]),
                ))
            }
            PlotKind::MeshAngles => {
                let bins = self.mesh.shown()?.ready.meshed.quality.whole.histogram;
                let counts: Vec<f64> = bins.iter().map(|&n| n as f64).collect();
                let axes = ["smallest dihedral angle (\u{b0})", "cells"];
                Some(histogram("angles", &format!("Mesh, {name}"), axes, [0.0, BIN_WIDTH.to_degrees()], &counts))
            }
        }
    }
}

/// The plot that is looked at.
fn on_show(state: &UiState) -> PlotKind {
    let solve = &state.solve;
    match (solve.shows_results, solve.tab, solve.curve) {
        (true, ResultTab::Pattern, _) => PlotKind::Cuts,
        (true, ResultTab::Reflection, Curve::Phase) => PlotKind::Phase,
        (false, ..) if state.right_tab == RightTab::Mesh => PlotKind::MeshAngles,
        (false, ..) if state.right_tab == RightTab::Figures => PlotKind::Distortion,
        _ => PlotKind::Magnitude,
    }
}
