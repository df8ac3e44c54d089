//! The figures of the runs on show, one column each.

use super::mesh_session::grouped;
use super::panel_distortion::ROW_HEIGHT;
use super::polar;
use super::solve_session::{FinishedRun, SolveSession};
use super::theme::Tokens;
use super::trace::{impedance, ohms};
use super::ui_state::{ResultTab, SolveUi};
use crate::pipeline::solve_job::{Pattern, RunResult};
use crate::units::GHZ;
use egui::{Grid, Label, RichText, Ui};

/// Width of the column of names and of each column of values, points.
const WIDTHS: [f32; 2] = [106.0, 132.0];

/// Room that the figures of a number of runs need, points.
pub(super) fn width(n_runs: usize) -> f32 {
    WIDTHS[0] + WIDTHS[1] * n_runs.max(1) as f32 + 10.0
}

/// Name, tooltip, and the value of a run in writing.
struct Line<T> {
    name: &'static str,
    tip: &'static str,
    text: fn(&T) -> Option<String>,
}

const REFLECTION: &[Line<RunResult>] = &[
    Line { name: "Resonance", tip: "Frequency of the smallest |S11|", text: |r| Some(gigahertz(r.resonance?.freq)) },
    Line {
        name: "  by fit",
        tip: "Frequency of the strongest damped oscillation in the late record",
        text: |r| Some(gigahertz(r.fitted?.freq)),
    },
    Line { name: "Q by fit", tip: "Quality, loaded by the line", text: |r| Some(format!("{:.1}", r.fitted?.q)) },
    Line { name: "|S11| there", tip: "The smallest |S11|", text: |r| Some(format!("{:.2} dB", r.resonance?.depth_db)) },
    Line { name: "Impedance there", tip: "At the ground's top", text: |r| Some(ohms(resonant_impedance(r)?)) },
    Line {
        name: "−10 dB band",
        tip: "Width of the band where |S11| is below -10 dB, around the resonance",
        text: |r| band(r).map(|[lo, hi]| format!("{:.0} MHz", (hi - lo) / 1e6)),
    },
    Line {
        name: "  relative",
        tip: "Width over its middle",
        text: |r| band(r).map(|[lo, hi]| format!("{:.2} %", 200.0 * (hi - lo) / (hi + lo))),
    },
    Line { name: "  from", tip: "Lower end of the band", text: |r| Some(gigahertz(band(r)?[0])) },
    Line { name: "  to", tip: "Upper end of the band", text: |r| Some(gigahertz(band(r)?[1])) },
    Line {
        name: "Port as meshed",
        tip: "Impedance of the coaxial line in the mesh: how well its circles are meshed",
        text: |r| Some(format!("{:.2} Ω", r.figures.port_impedance_ohm)),
    },
    Line {
        name: "Decay",
        tip: "How far the reflected voltage had fallen",
        text: |r| Some(format!("{:.1} dB", r.figures.residual_db)),
    },
    Line {
        name: "Stopped by",
        tip: "The stop rule chosen, or the longest time",
        text: |r| Some(if r.figures.is_settled { "its rule" } else { "the time limit" }.to_owned()),
    },
    Line { name: "Cells", tip: "Tetrahedra", text: |r| Some(grouped(r.figures.tets)) },
    Line {
        name: "Steps",
        tip: "Time steps, and the length of one",
        text: |r| Some(format!("{} × {:.0} fs", grouped(r.figures.steps), r.figures.dt_s * 1e15)),
    },
    Line {
        name: "Time",
        tip: "Time that meshing and solving took",
        text: |r| Some(format!("{:.1} s", r.figures.seconds)),
    },
];

const PATTERN: &[Line<Pattern>] = &[
    Line { name: "Directivity", tip: "Greatest of all directions", text: |p| Some(format!("{:.2} dBi", p.max().0)) },
    Line {
        name: "  towards θ, φ",
        tip: "Direction of the greatest directivity: θ from +z, φ from +x",
        text: |p| Some(p.max().1.map(|a| format!("{:.0}°", a.to_degrees().round() % 360.0)).join(", ")),
    },
    Line {
        name: "Towards +z",
        tip: "Directivity straight up",
        text: |p| Some(format!("{:.2} dBi", p.field.boresight())),
    },
    Line {
        name: "Gain",
        tip: "Greatest directivity less the losses",
        text: |p| Some(format!("{:.2} dBi", p.max().0 + 10.0 * p.field.efficiency().log10())),
    },
    Line {
        name: "Width in E plane",
        tip: "Between the half-power directions",
        text: |p| degrees(p.cuts()[0].half_power_width()),
    },
    Line {
        name: "Width in H plane",
        tip: "Between the half-power directions",
        text: |p| degrees(p.cuts()[1].half_power_width()),
    },
    Line {
        name: "Front to back",
        tip: "Directivity towards +z over -z",
        text: |p| Some(format!("{:.1} dB", p.field.front_to_back())),
    },
    Line {
        name: "Efficiency",
        tip: "Radiated over radiated and lost power",
        text: |p| percent(Some(p.field.efficiency())),
    },
    Line {
        name: "  with mismatch",
        tip: "Radiated over incident power",
        text: |p| percent(p.field.total_efficiency()),
    },
    Line {
        name: "Power balance",
        tip: "Radiated and lost power over the one that the port takes in: a check, ideally 100 %",
        text: |p| percent(p.field.balance()),
    },
];

fn gigahertz(freq: f64) -> String {
    format!("{:.4} GHz", freq / GHZ)
}

fn degrees(angle: Option<f64>) -> Option<String> {
    angle.map(|a| format!("{:.1}°", a.to_degrees()))
}

fn percent(part: Option<f64>) -> Option<String> {
    part.map(|p| format!("{:.1} %", 100.0 * p))
}

fn band(result: &RunResult) -> Option<[f64; 2]> {
    result.resonance?.band
}

/// The impedance at the smallest |S11|.
fn resonant_impedance(result: &RunResult) -> Option<nalgebra::Complex<f64>> {
    let freq = result.resonance?.freq;
    let freqs = &result.sweep.freqs;
    let nearest = (0..freqs.len()).min_by(|&a, &b| (freqs[a] - freq).abs().total_cmp(&(freqs[b] - freq).abs()))?;
    Some(impedance(result.sweep.s11[nearest], result.sweep.reference))
}

/// Draws the table.
pub(super) fn ui(ui: &mut Ui, solve: &SolveSession, chosen: &SolveUi) {
    let runs: Vec<&FinishedRun> = solve.shown().collect();
    match chosen.tab {
        ResultTab::Reflection => table(ui, &runs, REFLECTION, |run| Some(&run.result)),
        ResultTab::Pattern => {
            let freq = polar::frequency(solve, chosen);
            table(ui, &runs, PATTERN, |run| polar::pattern(run, freq?));
        }
    }
}

fn table<'a, T: 'a>(
    ui: &mut Ui,
    runs: &[&'a FinishedRun],
    lines: &[Line<T>],
    of: impl Fn(&'a FinishedRun) -> Option<&'a T>,
) {
    let tokens = Tokens::here(ui);
    let grid = Grid::new("figures").num_columns(runs.len() + 1).striped(true).min_row_height(ROW_HEIGHT);
    grid.spacing([10.0, 2.0]).show(ui, |ui| {
        ui.label("");
        for run in runs {
            let name = RichText::new(&run.name).color(tokens.series[run.color]).strong();
            ui.scope(|ui| {
                ui.set_width(WIDTHS[1] - 10.0);
                ui.add(Label::new(name).truncate()).on_hover_text(&run.name);
            });
        }
        ui.end_row();
        for line in lines {
            ui.label(RichText::new(line.name).color(tokens.weak)).on_hover_text(line.tip);
            for run in runs {
                let text = of(run).and_then(line.text).unwrap_or_else(|| "none".to_owned());
                ui.label(text).on_hover_text(line.tip);
            }
            ui.end_row();
        }
    });
}
