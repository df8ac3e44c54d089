//! `study`: the surface error over bend radius for many cages, raw and compensated, by both bend rules.
//!
//! Reproduces the paper's figures 5 (paddings), 6 (segments), 7 (raw against compensated), 8 (polynomial orders) and 9
//! (width and length) for its antenna bent in the H-plane with z = 0 kept. Leaves tables of everything computed
//! (`rho_raw.csv`, `rho_wl.csv`, `rho_isometric.csv`, `ideal_cylinder_rho.csv`; rho as fractions) and for each figure
//! its CSV, SVG and PNG. A point is missing only where the cage is refused or a compensation has no result; the tables
//! say why.

mod bends;
mod figures;

use super::args::StudyArgs;
use super::plot_files;
use crate::io::write_atomic;
use crate::plot::{Format, quoted};
use crate::task::Task;
use anyhow::{Context, Result};
use bends::{Compensation, Found, Method, RADII_MM, RULES, Raw, Sweep};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// What `study --json` prints.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// The folder.
    dir: String,
    /// Cages posed without compensation.
    raw_points: usize,
    /// Those of them that were refused.
    raw_refused: usize,
    /// Compensations tried.
    compensated_points: usize,
    /// Those of them without a result: the cage is refused, or the antenna does not fit or converge.
    compensated_refused: usize,
    /// Names of the files.
    files: Vec<String>,
    seconds: f64,
}

pub(super) fn run(args: &StudyArgs, task: &Task) -> Result<()> {
    let report = write(&args.out, task)?;
    if args.json {
        return super::print(&serde_json::to_string_pretty(&report)?);
    }
    super::print(&format!(
        "{} points without compensation ({} refused), {} compensations ({} refused) in {:.1} s\nwrote to {}: {}",
        report.raw_points,
        report.raw_refused,
        report.compensated_points,
        report.compensated_refused,
        report.seconds,
        report.dir,
        report.files.join(", ")
    ))
}

/// Computes the study and writes it into a folder, which is made where it is missing.
pub(super) fn write(out: &Path, task: &Task) -> Result<Report> {
    let started = Instant::now();
    std::fs::create_dir_all(out).with_context(|| format!("cannot create the folder {}", out.display()))?;
    let sweep = Sweep::compute(task)?;
    let tables = [
        ("rho_raw.csv", raw_table(&sweep.raw)),
        ("rho_wl.csv", compensation_table(&sweep.compensated, false)),
        ("rho_isometric.csv", compensation_table(&sweep.compensated, true)),
        ("ideal_cylinder_rho.csv", ideal_table(&sweep.ideal)),
    ];
    let mut files = Vec::new();
    for (name, text) in tables {
        write_atomic(&out.join(name), text.as_bytes())?;
        files.push(name.to_owned());
    }
    for figure in figures::all(&sweep) {
        task.check()?;
        files.extend(["csv", "svg", "png"].map(|extension| format!("{}.{extension}", figure.name)));
        plot_files::write(&figure.into(), out, &Format::ALL)?;
    }
    Ok(Report {
        dir: out.display().to_string(),
        raw_points: sweep.raw.len(),
        raw_refused: sweep.raw.iter().filter(|r| r.rho.is_err()).count(),
        compensated_points: sweep.compensated.len(),
        compensated_refused: sweep.compensated.iter().filter(|c| c.found.is_err()).count(),
        files,
        seconds: started.elapsed().as_secs_f64(),
    })
}

fn rule_name(rule: crate::cage::BendRule) -> &'static str {
    RULES.into_iter().find(|(r, _)| *r == rule).map_or("", |(_, name)| name)
}

fn raw_table(rows: &[Raw]) -> String {
    let mut text = "rule,padding_mm,N,R_mm,rho_patch,rho_substrate,refused\n".to_owned();
    for Raw { case, rho } in rows {
        let start = format!("{},{},{},{}", rule_name(case.rule), case.padding_mm, case.segments, case.radius_mm);
        let _ = match rho {
            Ok([patch, substrate]) => writeln!(text, "{start},{patch},{substrate},"),
            Err(reason) => writeln!(text, "{start},,,{}", quoted(reason)),
        };
    }
    text
}

/// The table of WL or of the isometric compensation, which has no orders.
fn compensation_table(rows: &[Compensation], isometric: bool) -> String {
    let orders = if isometric { "" } else { "order_w,order_l," };
    let mut text =
        format!("rule,padding_mm,N,{orders}R_mm,rescalings,width_mm,length_mm,rho_patch,rho_substrate,refused\n");
    for Compensation { case, method, found } in rows {
        let order = match (method, isometric) {
            (Method::Wl(order), false) => format!("{order},{order},"),
            (Method::Isometric, true) => String::new(),
            _ => continue,
        };
        let (rule, padding, segments) = (rule_name(case.rule), case.padding_mm, case.segments);
        let start = format!("{rule},{padding},{segments},{order}{}", case.radius_mm);
        let _ = match found {
            Ok(Found { rescalings, flat_mm, rho: [patch, substrate], .. }) => {
                writeln!(text, "{start},{rescalings},{},{},{patch},{substrate},", flat_mm.x, flat_mm.y)
            }
            Err(reason) => writeln!(text, "{start},,,,,,{}", quoted(reason)),
        };
    }
    text
}

fn ideal_table(rows: &[[f64; 2]]) -> String {
    let mut text = "R_mm,rho_patch,rho_substrate\n".to_owned();
    for (radius_mm, [patch, substrate]) in RADII_MM.iter().zip(rows) {
        let _ = writeln!(text, "{radius_mm},{patch},{substrate}");
    }
    text
}
