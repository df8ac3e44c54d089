//! The solver's launcher: what is solved, how, what it will cost, and how far it is.

use super::command::{Command, Facts};
use super::field::{Number, rows, symbol_button};
use super::mesh_session::grouped;
use super::outbox::{Action, Outbox};
use super::panel_mesh::{choice, heading, shape_and_density};
use super::places;
use super::solve_session::SolveSession;
use super::theme::Tokens;
use super::ui_state::{SolveUi, Stop, UiState};
use crate::pipeline::{Estimate, SolveSettings};
use crate::project::Project;
use crate::units::GHZ;
use egui::{ProgressBar, RichText, Spinner, Ui};

const LOWER: Number = Number::new("band from", "Band from", "GHz", 0.05)
    .tip("Lower end of the band; at first a third below the antenna's resonance");
const UPPER: Number = Number::new("band to", "Band to", "GHz", 0.05)
    .tip("Upper end of the band; at first a third above the antenna's resonance");
const DECAY: Number = Number::new("decay", "Decay", "dB", 0.5)
    .tip("How far the reflected voltage is to fall; less leaves ripples on the curve");
const LONGEST: Number =
    Number::new("longest", "At most", "ns", 0.1).tip("It stops after this time in the antenna in any case");
/// What the numbers may be: the solver's own limits are wider.
const BAND_GHZ: [f64; 2] = [0.05, 300.0];
const DECAY_DB: [f64; 2] = [10.0, 100.0];
const LONGEST_NS: [f64; 2] = [0.1, 1000.0];
/// Narrowest band, as a part of its upper end: a narrower one makes a pulse of endless length.
const NARROWEST: f64 = 0.02;

/// Draws the panel.
pub(super) fn ui(
    ui: &mut Ui,
    project: &Project,
    solve: &mut SolveSession,
    facts: &Facts,
    state: &mut UiState,
    out: &mut Outbox,
) {
    choices(ui, project, &mut state.solve);
    ui.add_space(4.0);
    if solve.is_busy() {
        busy(ui, solve, out);
    } else {
        cost(ui, &solve.estimate(project, &state.solve));
        ui.horizontal(|ui| {
            for command in [Command::Solve, Command::ShowResults] {
                if command.tool_button(ui, facts) {
                    out.push(Action::Run(command));
                }
            }
            if let Some(name) = solve.interrupted() {
                let tip = format!("Go on with the run that was called off: {name}");
                if ui.button("Resume").on_hover_text(tip).clicked() {
                    out.push(Action::ResumeSolve);
                }
            }
        });
    }
    let tokens = Tokens::here(ui);
    if let Some(error) = solve.error() {
        let text = RichText::new(format!("No result: {}", error.text)).color(tokens.error);
        ui.add(egui::Label::new(text).wrap());
        places::list(ui, error.places_mm(project), state);
    }
    if solve.runs().is_empty() {
        if !solve.is_busy() && solve.error().is_none() {
            let text = "There are no results yet. Press Solve: a pulse is sent into the coaxial line, and what comes \
                        back says how the antenna is matched over the band. You can go on meanwhile.";
            ui.label(RichText::new(text).weak());
        }
        return;
    }
    if solve.shown().next_back().is_some_and(|run| run.is_stale(project)) {
        let text = "⚠ The geometry has changed since the last run.";
        ui.add(egui::Label::new(RichText::new(text).color(tokens.warning)).wrap());
        if !solve.is_busy() && ui.button("Solve again").on_hover_text("Solve the geometry as it is now").clicked() {
            out.push(Action::Run(Command::Solve));
        }
    }
    heading(ui, "Runs");
    super::panel_results::run_list(ui, project, solve, out);
}

fn choices(ui: &mut Ui, project: &Project, chosen: &mut SolveUi) {
    rows(ui, "solve choices", |ui| {
        shape_and_density(ui, project, &mut chosen.shape, &mut chosen.density);
        let usual = SolveSettings::usual_band(project).map(|f| (f / GHZ * 100.0).round() / 100.0);
        let mut band = chosen.band_ghz.unwrap_or(usual);
        for (k, number) in [LOWER, UPPER].into_iter().enumerate() {
            let (_, new) = number.show(ui, band[k]);
            if k == 1
                && chosen.band_ghz.is_some()
                && symbol_button(ui, "↺", "Band around the antenna's resonance", true)
            {
                chosen.band_ghz = None;
            }
            ui.end_row();
            if let Some(new) = new {
                let [lo, hi] = BAND_GHZ;
                band[k] = new.clamp(lo, hi);
                // The other end gives way.
                if k == 0 {
                    band[1] = band[1].max(band[0] / (1.0 - NARROWEST));
                } else {
                    band[0] = band[0].min(band[1] * (1.0 - NARROWEST));
                }
                chosen.band_ghz = Some(band);
            }
        }
        let stops = [Stop::Decayed, Stop::Settled];
        choice(ui, ("Stop", "When the run ends"), &mut chosen.stop, &stops, stop_text, |_| Ok(()));
        let decay = (chosen.stop == Stop::Decayed).then_some((DECAY, &mut chosen.decay_db, DECAY_DB));
        let longest = (LONGEST, &mut chosen.longest_ns, LONGEST_NS);
        for (number, value, [lo, hi]) in decay.into_iter().chain([longest]) {
            let (_, new) = number.show(ui, *value);
            ui.end_row();
            if let Some(new) = new {
                *value = new.clamp(lo, hi);
            }
        }
    });
}

/// Name and tooltip of a stop rule.
fn stop_text(stop: Stop) -> (&'static str, &'static str) {
    match stop {
        Stop::Decayed => ("When decayed", "The reflected voltage has fallen far enough: S11 is that of the run itself"),
        Stop::Settled => {
            ("When settled", "The resonance stays where it is: S11 is continued by the fitted modes; often sooner")
        }
    }
}

/// What the run would take.
fn cost(ui: &mut Ui, estimate: &Result<Estimate, String>) {
    let tokens = Tokens::here(ui);
    let text = match estimate {
        Ok(e) => {
            let round = |n: usize| grouped((n as f64 / 100.0).round() as usize * 100);
            let (cells, steps) = (round(e.n_tets), round(e.n_steps));
            let megabytes = (e.bytes as f64 / 1e6).ceil();
            let text = format!("About {cells} cells, {steps} steps,\n{megabytes:.0} MB and {}", time(e.seconds));
            RichText::new(text).color(tokens.weak)
        }
        Err(error) => RichText::new(format!("This cannot be solved: {error}")).color(tokens.warning),
    };
    let tip = "Estimated before meshing: cells within a fifth, time within a half";
    ui.add(egui::Label::new(text).wrap()).on_hover_text(tip);
}

fn busy(ui: &mut Ui, solve: &SolveSession, out: &mut Outbox) {
    let live = solve.live();
    ui.horizontal(|ui| {
        match live {
            Some(run) => {
                let left = run.seconds_left * run.speed / run.n_tets.max(1) as f64;
                let part = run.n_done as f32 / (run.n_done as f32 + left as f32).max(1.0);
                let bar = ProgressBar::new(part).desired_width(190.0).desired_height(14.0);
                ui.add(bar).on_hover_text("By the decay so far");
            }
            None => {
                ui.add(Spinner::new().size(16.0));
            }
        }
        if ui.button("Cancel").on_hover_text("Stop solving; earlier results stay").clicked() {
            out.push(Action::CancelSolve);
        }
    });
    let text = match live {
        Some(run) => {
            let decay = run.decay_db.map_or("the pulse comes in".to_owned(), |db| format!("decayed to {db:.0} dB"));
            let most = if run.decay_db.is_none() { "at most " } else { "" };
            format!(
                "{most}{} left · step {} · {decay}\n{} cells, {:.1} million updates per second",
                time(run.seconds_left),
                grouped(run.n_done),
                grouped(run.n_tets),
                run.speed / 1e6
            )
        }
        None => {
            let phase = solve.progress().map_or("beginning", |p| p.phase);
            format!("{phase}… ({} so far)", time(solve.elapsed()))
        }
    };
    ui.label(RichText::new(text).weak());
}

/// A time in words: seconds, or minutes and seconds.
pub(super) fn time(seconds: f64) -> String {
    let whole = seconds.clamp(0.0, 1e7).ceil() as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s} s"),
        (h, m, _) => format!("{h} h {m} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_said_in_the_units_they_need() {
        for (seconds, text) in [(0.2, "1 s"), (59.0, "59 s"), (60.5, "1 min 1 s"), (3700.0, "1 h 1 min")] {
            assert_eq!(time(seconds), text, "{seconds}");
        }
    }
}
