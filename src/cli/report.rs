//! Text and JSON of what was computed. The JSON keys are the field names here and stay.

use crate::distortion::{CompensationStep, Figures};
use crate::io::Export;
use crate::units::to_mm;
use serde::Serialize;

/// One iteration as JSON: relative errors before it; the last one holds what remains.
#[derive(Clone, Debug, Serialize)]
pub(super) struct StepReport {
    width_error: f64,
    length_error: f64,
    thickness_error: f64,
    radius_error: f64,
    patch_strain: f64,
}

impl From<&CompensationStep> for StepReport {
    fn from(s: &CompensationStep) -> Self {
        Self {
            width_error: s.width_error,
            length_error: s.length_error,
            thickness_error: s.thickness_error,
            radius_error: s.radius_error,
            patch_strain: s.patch_strain,
        }
    }
}

/// An export as JSON.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ExportReport {
    /// The folder.
    dir: String,
    /// Names of the files in it.
    files: Vec<String>,
    /// Number of solids.
    solids: usize,
    /// Interface facets proved to be shared bit for bit.
    shared_facets: usize,
}

impl ExportReport {
    pub(super) fn new(dir: &std::path::Path, export: &Export) -> Self {
        let name = |path: &std::path::PathBuf| {
            path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        Self {
            dir: dir.display().to_string(),
            files: export.files.iter().map(name).collect(),
            solids: export.certificate.solids.len(),
            shared_facets: export.certificate.n_shared_facets(),
        }
    }

    pub(super) fn text(&self) -> String {
        format!(
            "exported      {} files to {}: {} solids, {} shared facets, certificate.json",
            self.files.len(),
            self.dir,
            self.solids,
            self.shared_facets
        )
    }
}

/// An error with its causes; a cause that the text before already tells is not told again.
pub(super) fn chain(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain() {
        let cause = cause.to_string();
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// Columns lined up: the first to the left, the others to the right, two blanks between them.
pub(super) fn table(rows: &[Vec<String>]) -> String {
    let width = |column: usize| rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.iter().map(Vec::len).max().unwrap_or(0)).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let text: Vec<String> =
            cells.map(|(i, (cell, &w))| if i == 0 { format!("{cell:<w$}") } else { format!("{cell:>w$}") }).collect();
        text.join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

pub(super) fn percent(fraction: f64) -> String {
    format!("{:+.3} %", fraction * 100.0)
}

fn mm(value: f64) -> String {
    format!("{:.4} mm", to_mm(value))
}

/// The figures with the exact cylinder's own beside them.
pub(super) fn figures_text(figures: &Figures, ideal: Option<&Figures>) -> String {
    let mut rows = vec![vec![String::new(), "deformed".to_owned(), "error".to_owned()]];
    if ideal.is_some() {
        rows[0].push("exact cylinder".to_owned());
    }
    let mut row = |name: &str, value: String, error: Option<f64>, exact: Option<String>| {
        let error = error.map(percent).unwrap_or_default();
        rows.push([name.to_owned(), value, error].into_iter().chain(exact).collect());
    };
    let exact = |pick: fn(&Figures) -> String| ideal.map(pick);
    row("rho patch", percent(figures.rho_patch), None, exact(|f| percent(f.rho_patch)));
    row("rho substrate", percent(figures.rho_substrate), None, exact(|f| percent(f.rho_substrate)));
    row("width W", mm(figures.width), Some(figures.width_error), exact(|f| mm(f.width)));
    row("length L", mm(figures.length), Some(figures.length_error), exact(|f| mm(f.length)));
    row("thickness", mm(figures.thickness), Some(figures.thickness_error), exact(|f| mm(f.thickness)));
    row("patch strain, largest", percent(figures.patch_strain), None, exact(|f| percent(f.patch_strain)));
    row("patch strain, rms", percent(figures.patch_strain_rms), None, exact(|f| percent(f.patch_strain_rms)));
    row("substrate strain, largest", percent(figures.substrate_strain), None, exact(|f| percent(f.substrate_strain)));
    if let Some(radius) = figures.radius {
        let wanted = ideal.and_then(|f| f.radius);
        row("radius", mm(radius), wanted.map(|r| radius / r - 1.0), wanted.map(mm));
    }
    if let Some(distance) = figures.cylinder_distance {
        row("distance, greatest", mm(distance.greatest), None, None);
        row("distance, rms", mm(distance.rms), None, None);
    }
    table(&rows)
}

/// The iterations of a compensation, one per row.
pub(super) fn steps_text(steps: &[CompensationStep]) -> String {
    type Column = (&'static str, fn(&CompensationStep) -> f64);
    // A column that a compensation does not work on is zero throughout and left out.
    let columns: [Column; 5] = [
        ("width error", |s| s.width_error),
        ("length error", |s| s.length_error),
        ("thickness error", |s| s.thickness_error),
        ("radius error", |s| s.radius_error),
        ("patch strain", |s| s.patch_strain),
    ];
    let used: Vec<_> = columns.iter().filter(|(_, pick)| steps.iter().any(|s| pick(s).abs() > 0.0)).collect();
    let header = std::iter::once("iteration".to_owned()).chain(used.iter().map(|(name, _)| (*name).to_owned()));
    let mut rows = vec![header.collect::<Vec<_>>()];
    for (i, step) in steps.iter().enumerate() {
        rows.push(std::iter::once(i.to_string()).chain(used.iter().map(|(_, pick)| percent(pick(step)))).collect());
    }
    table(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn causes_are_told_once() {
        let io = crate::io::write_atomic(std::path::Path::new("/nowhere/a"), b"").expect_err("no such folder");
        let text = chain(&anyhow::Error::new(io).context("saving"));
        assert!(text.starts_with("saving: cannot write /nowhere/a: "), "{text}");
        assert_eq!(text.matches("os error").count(), 1, "{text}");
        let outer = Err::<(), _>(anyhow::anyhow!("inner")).context("outer").expect_err("an error");
        assert_eq!(chain(&outer), "outer: inner", "both levels");
    }

    #[test]
    fn tables_line_up() {
        let rows = [vec!["a".to_owned(), "10".to_owned()], vec!["long".to_owned(), "5".to_owned()]];
        assert_eq!(table(&rows), "a     10\nlong   5", "left and right");
    }

    #[test]
    fn columns_without_a_value_are_left_out() {
        let step = CompensationStep { width_error: -0.1, ..CompensationStep::default() };
        let text = steps_text(&[step, CompensationStep::default()]);
        assert!(text.contains("width error") && !text.contains("radius error"), "{text}");
        assert!(text.ends_with("\n1             +0.000 %"), "{text}");
    }
}
