//! `solve`: the antenna's reflection and radiation by transmission line modelling.

use super::args::SolveArgs;
use super::pattern::{self, PatternReport};
use super::plot_files;
use super::runs::{self, Keep, Resume};
use crate::io::{csv, touchstone};
use crate::pipeline::{Solved, results_dir};
use crate::plot::{Axis, Figure, Format, Panel, Point, Series, Style, palette};
use crate::project::file;
use crate::results::{FarField, Resonance};
use crate::task::Task;
use crate::units::GHZ;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

pub(super) fn run(args: &SolveArgs, task: &Task) -> Result<()> {
    let project = file::read(&args.file)?;
    let mut settings = runs::settings(&project, &args.run);
    settings.edge_correction = !args.no_edge_correction;
    if !args.pattern_ghz.is_empty() {
        settings.pattern_freqs = pattern_freqs(&args.pattern_ghz, settings.band)?;
    }
    let name = args.file.display();
    let dir = results_dir(&args.file);
    let resume = if args.resume { Resume::Must } else { Resume::Never };
    let keep = Keep { dir: &dir, resume, every: Duration::from_secs(args.checkpoint_every) };
    let (solved, stored) =
        runs::solve(&project, args.shape.into(), &settings, keep, task).with_context(|| format!("solving {name}"))?;
    let written: Vec<&FarField> = match args.pattern_ghz.is_empty() {
        true => solved.at_resonance().into_iter().collect(),
        false => solved.far_fields.iter().collect(),
    };
    let mut files = vec![stored.job().result_path(&dir).display().to_string()];
    if let Some(dir) = args.out.as_deref() {
        files.extend(write(&solved, &name.to_string(), dir)?);
        files.extend(pattern::write(&solved, &written, &name.to_string(), dir)?);
    }
    let report = Report::new(&solved, files);
    super::print(&if args.json { serde_json::to_string_pretty(&report)? } else { report.text() })
}

/// The frequencies of patterns in Hz, ascending: the pulse holds those of the band only.
fn pattern_freqs(given_ghz: &[f64], [lo, hi]: [f64; 2]) -> Result<Vec<f64>> {
    let mut freqs: Vec<f64> = given_ghz.iter().map(|f| f * GHZ).collect();
    freqs.sort_by(f64::total_cmp);
    match freqs.iter().find(|f| !(lo..=hi).contains(*f)) {
        None => Ok(freqs),
        Some(f) => {
            bail!("no pattern at {} GHz: it lies outside the band from {} to {} GHz", f / GHZ, lo / GHZ, hi / GHZ)
        }
    }
}

/// Writes table, Touchstone file and plot; returns their names.
fn write(solved: &Solved, name: &str, dir: &Path) -> Result<Vec<String>> {
    std::fs::create_dir_all(dir).with_context(|| format!("making {}", dir.display()))?;
    let sweep = &solved.sweep;
    let db = sweep.db();
    let impedance = sweep.impedance();
    let rows = (0..db.len()).map(|k| {
        let (s, z) = (sweep.s11[k], impedance[k]);
        [sweep.freqs[k] / GHZ, s.re, s.im, db[k], s.arg().to_degrees(), z.re, z.im]
    });
    let header = ["freq_ghz", "s11_re", "s11_im", "s11_db", "s11_phase_deg", "z_re_ohm", "z_im_ohm"];
    csv::write_table(&dir.join("s11.csv"), &header, rows)?;
    let remarks = vec![
        format!("Conformant, {name}"),
        "reference plane: the ground's top; fields exp(+jwt)".to_owned(),
        format!(
            "port impedance as meshed {:.3} ohm, {} tetrahedra",
            solved.port_impedance,
            solved.meshed.mesh.tets.len()
        ),
    ];
    touchstone::write(sweep, &remarks, &dir.join("s11.s1p"))?;
    let points = sweep.freqs.iter().zip(&db).map(|(f, &y)| Point { x: f / GHZ, y: Ok(y) }).collect();
    let series = Series { name: "|S11|".to_owned(), color: palette::DISTINCT[0], style: Style::Plain, points };
    let figure = Figure {
        name: "s11_plot",
        title: format!("Reflection, {name}"),
        legend: "50 ohm".to_owned(),
        panels: vec![Panel {
            title: "At the ground's top".to_owned(),
            y: Axis::linear("|S11| (dB)"),
            series: vec![series],
        }],
        columns: 1,
        x: Axis::linear("frequency (GHz)"),
    };
    plot_files::write(&figure.into(), dir, &Format::ALL)?;
    let names = ["s11.csv", "s11.s1p", "s11_plot.svg", "s11_plot.png", "s11_plot.csv"];
    Ok(names.map(|n| dir.join(n).display().to_string()).into())
}

/// What `solve --json` prints.
#[derive(Debug, Serialize)]
struct Report {
    /// Frequency of the smallest |S11|; null where the band holds none.
    resonance_ghz: Option<f64>,
    s11_min_db: Option<f64>,
    /// Ends of the stretch below -10 dB; null where |S11| does not fall so far, or it reaches beyond the band.
    band_10_db_ghz: Option<[f64; 2]>,
    bandwidth_10_db_mhz: Option<f64>,
    /// Frequency of the strongest resonance by fit, and how far fits to parts of the record differ.
    fitted_resonance_ghz: Option<f64>,
    fitted_resonance_error_ghz: Option<f64>,
    /// Its quality factor, loaded by the line.
    q: Option<f64>,
    q_error: Option<f64>,
    port_impedance_ohm: f64,
    tets: usize,
    clipped_cells: usize,
    dt_ps: f64,
    steps: usize,
    residual_db: f64,
    /// Whether the stop rule was met.
    is_settled: bool,
    tet_steps_per_second: f64,
    seconds: f64,
    /// Null where no pattern was gathered.
    pattern: Option<PatternReport>,
    files: Vec<String>,
}

impl Report {
    fn new(solved: &Solved, files: Vec<String>) -> Self {
        let found: Option<Resonance> = solved.sweep.resonance();
        let band = found.and_then(|r| r.band);
        Self {
            resonance_ghz: found.map(|r| r.freq / GHZ),
            s11_min_db: found.map(|r| r.depth_db),
            band_10_db_ghz: band.map(|b| b.map(|f| f / GHZ)),
            bandwidth_10_db_mhz: band.map(|[lo, hi]| (hi - lo) / 1e6),
            fitted_resonance_ghz: solved.fitted.map(|f| f.freq / GHZ),
            fitted_resonance_error_ghz: solved.fitted.map(|f| f.freq_error / GHZ),
            q: solved.fitted.map(|f| f.q),
            q_error: solved.fitted.map(|f| f.q_error),
            port_impedance_ohm: solved.port_impedance,
            tets: solved.meshed.mesh.tets.len(),
            clipped_cells: solved.n_clipped,
            dt_ps: solved.record.dt * 1e12,
            steps: solved.record.total.len(),
            residual_db: solved.residual_db,
            is_settled: solved.is_settled,
            tet_steps_per_second: solved.speed,
            seconds: solved.seconds,
            pattern: solved.at_resonance().map(PatternReport::new),
            files,
        }
    }

    fn text(&self) -> String {
        let or = |text: Option<String>| text.unwrap_or_else(|| "none in the band".to_owned());
        let band = self.band_10_db_ghz.zip(self.bandwidth_10_db_mhz);
        let warning = if self.is_settled { "" } else { ": stopped before its rule was met" };
        let mut lines = vec![
            format!("resonance     {}", or(self.resonance_ghz.map(|f| format!("{f:.4} GHz (smallest |S11|)")))),
            format!("|S11|         {}", or(self.s11_min_db.map(|db| format!("{db:.2} dB")))),
            format!("-10 dB band   {}", or(band.map(|([lo, hi], w)| format!("{w:.0} MHz, {lo:.4} to {hi:.4} GHz")))),
            format!("by fit        {}", self.fitted_text()),
            format!("port          {:.3} ohm as meshed", self.port_impedance_ohm),
            format!(
                "field         {} tetrahedra, {} steps of {:.4} ps, {} cells clipped, decayed to {:.1} dB{warning}",
                self.tets, self.steps, self.dt_ps, self.clipped_cells, self.residual_db
            ),
            format!("time          {:.1} s, {:.1} million tet-steps/s", self.seconds, self.tet_steps_per_second / 1e6),
        ];
        lines.extend(self.pattern.iter().flat_map(PatternReport::text));
        if !self.files.is_empty() {
            lines.push(format!("wrote         {}", self.files.join(", ")));
        }
        lines.join("\n")
    }

    fn fitted_text(&self) -> String {
        let freq = self.fitted_resonance_ghz.zip(self.fitted_resonance_error_ghz);
        freq.zip(self.q.zip(self.q_error)).map_or_else(
            || "none in the band".to_owned(),
            |((freq, freq_error), (q, q_error))| {
                format!(
                    "{freq:.4} +- {freq_error:.4} GHz, Q {q:.2} +- {q_error:.2} (strongest mode, loaded by the line)"
                )
            },
        )
    }
}
