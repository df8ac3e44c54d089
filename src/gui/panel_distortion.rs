//! The figures of the deformed antenna beside those of the exact cylinder, and what is painted on it.

use super::places;
use super::session::Session;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::distortion::Figures;
use crate::units::to_mm;
use egui::{Grid, RichText, Ui};

/// How far a relative error may go before it is marked, as a fraction: good below the first, bad above the second.
const MARKS: [f64; 2] = [0.005, 0.02];

/// Height of the rows of tables that hold text alone, points.
pub(super) const ROW_HEIGHT: f32 = 16.0;

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, session: &Session, state: &mut UiState) {
    if !session.places_mm().is_empty() {
        let text = "The refused shape fails at the marked places:";
        ui.add(egui::Label::new(RichText::new(text).color(Tokens::here(ui).error)).wrap());
        places::list(ui, session.places_mm(), state);
    }
    let Some(shown) = session.shown() else {
        let text =
            if session.is_busy() { "Computing the deformed antenna…" } else { "There is no deformed antenna yet." };
        ui.label(RichText::new(text).weak());
        return;
    };
    let deformed = &shown.deformed;
    let tokens = Tokens::here(ui);
    let is_current = session.finished().is_some();
    ui.horizontal(|ui| {
        if is_current {
            ui.label(RichText::new("Computed in full").color(tokens.good).small());
        } else {
            let tip = "Shown while dragging or computing: the surface is not split or compensated anew";
            ui.label(RichText::new("Preview").color(tokens.warning).small()).on_hover_text(tip);
        }
    });
    match &deformed.figures {
        Some(figures) => table(ui, figures, deformed.ideal.as_ref()),
        None => {
            let text = "Surface error, width, length and radius are figures of the patch's template; imported bodies have \
                        none. Area change and strains can be painted on them.";
            ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
        }
    }
}

/// One line of the table: name, tooltip, text from figures, and the relative error that decides the colour.
pub(super) struct Line {
    pub(super) name: &'static str,
    pub(super) tip: &'static str,
    pub(super) text: fn(&Figures) -> Option<String>,
    pub(super) error: fn(&Figures) -> Option<f64>,
}

pub(super) const LINES: [Line; 14] = [
    Line {
        name: "ρ patch",
        tip: "Surface of the patch over that of the flat one, minus 1",
        text: |f| Some(percent(f.rho_patch)),
        error: |f| Some(f.rho_patch),
    },
    Line {
        name: "ρ substrate",
        tip: "Surface of the substrate over that of the flat one, minus 1; a bend changes it even without any error",
        text: |f| Some(percent(f.rho_substrate)),
        error: |_| None,
    },
    Line {
        name: "Width W",
        tip: "Width of the patch along its surface, by the fitted polynomial",
        text: |f| Some(millimetres(f.width)),
        error: |_| None,
    },
    Line {
        name: "  error",
        tip: "Against the width as drawn",
        text: |f| Some(percent(f.width_error)),
        error: |f| Some(f.width_error),
    },
    Line {
        name: "Length L",
        tip: "Length of the patch along its surface: it sets the resonance",
        text: |f| Some(millimetres(f.length)),
        error: |_| None,
    },
    Line {
        name: "  error",
        tip: "Against the length as drawn",
        text: |f| Some(percent(f.length_error)),
        error: |f| Some(f.length_error),
    },
    Line {
        name: "Height h",
        tip: "Mean thickness of the substrate under the patch",
        text: |f| Some(millimetres(f.thickness)),
        error: |_| None,
    },
    Line {
        name: "  error",
        tip: "Against the height as drawn: a thinner substrate shifts the resonance too",
        text: |f| Some(percent(f.thickness_error)),
        error: |f| Some(f.thickness_error),
    },
    Line {
        name: "Radius R",
        tip: "Of the circle fitted to the patch's bottom",
        text: |f| f.radius.map(millimetres),
        error: |_| None,
    },
    Line {
        name: "Strain patch",
        tip: "Largest strain of the patch's bottom",
        text: |f| Some(plain_percent(f.patch_strain)),
        error: |f| Some(f.patch_strain),
    },
    Line {
        name: "  rms",
        tip: "Root mean square of the strain of the patch's bottom",
        text: |f| Some(plain_percent(f.patch_strain_rms)),
        error: |f| Some(f.patch_strain_rms),
    },
    Line {
        name: "Strain substr.",
        tip: "Largest strain of the substrate's top",
        text: |f| Some(plain_percent(f.substrate_strain)),
        error: |_| None,
    },
    Line {
        name: "Off cylinder",
        tip: "Greatest distance of the patch's bottom from the exact cylinder",
        text: |f| f.cylinder_distance.map(|d| small_length(d.greatest)),
        error: |_| None,
    },
    Line {
        name: "  rms",
        tip: "Root mean square of that distance",
        text: |f| f.cylinder_distance.map(|d| small_length(d.rms)),
        error: |_| None,
    },
];

/// Colours a figure by its relative error.
pub(super) fn mark(text: RichText, error: Option<f64>, tokens: &Tokens) -> RichText {
    let [good, bad] = MARKS;
    match error.map(f64::abs) {
        None => text,
        Some(error) if error <= good => text.color(tokens.good),
        Some(error) if error <= bad => text.color(tokens.warning),
        Some(_) => text.color(tokens.error),
    }
}

fn table(ui: &mut Ui, figures: &Figures, ideal: Option<&Figures>) {
    let tokens = Tokens::here(ui);
    let columns = if ideal.is_some() { 3 } else { 2 };
    Grid::new("figures").num_columns(columns).striped(true).spacing([10.0, 3.0]).min_row_height(ROW_HEIGHT).show(
        ui,
        |ui| {
            ui.label("");
            ui.label(RichText::new("This antenna").color(tokens.weak));
            if ideal.is_some() {
                let tip = "The same antenna bent onto the exact cylinder, without a cage: the best there is";
                ui.label(RichText::new("Exact cylinder").color(tokens.weak)).on_hover_text(tip);
            }
            ui.end_row();
            for line in &LINES {
                // A figure that this shape does not have keeps its row, so that nothing jumps during a drag.
                let text = (line.text)(figures).unwrap_or_else(|| "–".to_owned());
                ui.label(line.name).on_hover_text(line.tip);
                ui.label(mark(RichText::new(text), (line.error)(figures), tokens));
                if let Some(ideal) = ideal {
                    ui.label(RichText::new((line.text)(ideal).unwrap_or_default()).color(tokens.weak));
                }
                ui.end_row();
            }
        },
    );
}

/// A fraction as signed percent.
pub(super) fn percent(fraction: f64) -> String {
    // Adding zero after rounding keeps a minus sign from standing before nothing.
    format!("{:+.2} %", (1e4 * fraction).round() / 100.0 + 0.0)
}

fn plain_percent(fraction: f64) -> String {
    format!("{:.2} %", 100.0 * fraction)
}

fn millimetres(length: f64) -> String {
    format!("{:.3} mm", to_mm(length))
}

/// A small length in the unit that reads best.
fn small_length(length: f64) -> String {
    let mm = to_mm(length);
    if mm < 0.1 { format!("{:.1} µm", mm * 1e3) } else { format!("{mm:.3} mm") }
}
