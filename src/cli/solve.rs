//! `solve`: the antenna's reflection by transmission line modelling.

use super::args::SolveArgs;
use super::plot::{Axis, Figure, Panel, Point, Series, Style};
use super::study::palette;
use crate::io::{csv, touchstone};
use crate::pipeline::{self, MeshSettings, SolveSettings, Solved};
use crate::project::{Project, file};
use crate::results::Resonance;
use crate::task::Task;
use crate::tet::Metal;
use crate::units::{C0, GHZ};
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::Path;

pub(super) fn run(args: &SolveArgs, task: &Task) -> Result<()> {
    let project = file::read(&args.file)?;
    let mesh = MeshSettings { density: args.density.into(), metal: Metal::Sheet };
    let settings = SolveSettings::new(mesh, band(args.band.as_deref(), &project));
    let name = args.file.display();
    let solved = pipeline::solve(&project, args.shape.into(), &settings, &mut |_| (), task)
        .with_context(|| format!("solving {name}"))?;
    let files = args.out.as_deref().map(|dir| write(&solved, &name.to_string(), dir)).transpose()?;
    let report = Report::new(&solved, files.unwrap_or_default());
    super::print(&if args.json { serde_json::to_string_pretty(&report)? } else { report.text() })
}

/// The band in Hz: as given, or around the resonance of an ideal cavity under the patch.
fn band(given_ghz: Option<&[f64]>, project: &Project) -> [f64; 2] {
    if let Some(&[lo, hi]) = given_ghz {
        return [lo * GHZ, hi * GHZ];
    }
    let params = project.antenna.to_params();
    let cavity = C0 / (2.0 * params.length * params.substrate.eps_r.sqrt());
    [cavity * 2.0 / 3.0, cavity * 4.0 / 3.0]
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
    figure.write(dir)?;
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
    port_impedance_ohm: f64,
    tets: usize,
    clipped_cells: usize,
    dt_ps: f64,
    steps: usize,
    residual_db: f64,
    tet_steps_per_second: f64,
    seconds: f64,
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
            port_impedance_ohm: solved.port_impedance,
            tets: solved.meshed.mesh.tets.len(),
            clipped_cells: solved.n_clipped,
            dt_ps: solved.record.dt * 1e12,
            steps: solved.record.total.len(),
            residual_db: solved.residual_db,
            tet_steps_per_second: solved.speed,
            seconds: solved.seconds,
            files,
        }
    }

    fn text(&self) -> String {
        let or = |text: Option<String>| text.unwrap_or_else(|| "none in the band".to_owned());
        let band = self.band_10_db_ghz.zip(self.bandwidth_10_db_mhz);
        let mut lines = vec![
            format!("resonance     {}", or(self.resonance_ghz.map(|f| format!("{f:.4} GHz (smallest |S11|)")))),
            format!("|S11|         {}", or(self.s11_min_db.map(|db| format!("{db:.2} dB")))),
            format!("-10 dB band   {}", or(band.map(|([lo, hi], w)| format!("{w:.0} MHz, {lo:.4} to {hi:.4} GHz")))),
            format!("port          {:.3} ohm as meshed", self.port_impedance_ohm),
            format!(
                "field         {} tetrahedra, {} steps of {:.4} ps, {} cells clipped, decayed to {:.1} dB",
                self.tets, self.steps, self.dt_ps, self.clipped_cells, self.residual_db
            ),
            format!("time          {:.1} s, {:.1} million tet-steps/s", self.seconds, self.tet_steps_per_second / 1e6),
        ];
        if !self.files.is_empty() {
            lines.push(format!("wrote         {}", self.files.join(", ")));
        }
        lines.join("\n")
    }
}
