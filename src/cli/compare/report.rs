//! The table of a comparison.

use super::super::report::{percent, table};
use super::cases::{Group, Variant};
use crate::pipeline::Stored;
use crate::plot::quoted;
use crate::units::GHZ;
use serde::Serialize;
use std::path::Path;

/// What `compare --json` prints.
#[derive(Debug, Default, Serialize)]
pub(super) struct Report {
    pub(super) rows: Vec<Row>,
    /// Names of the files in the folder.
    pub(super) files: Vec<String>,
}

/// One run; errors are fractions, relative to the exact cylinder.
#[derive(Debug, Default, Serialize)]
pub(super) struct Row {
    antenna: String,
    shape: String,
    /// Frequency of the smallest |S11|.
    resonance_ghz: Option<f64>,
    resonance_error: Option<f64>,
    bandwidth_10_db_mhz: Option<f64>,
    bandwidth_error: Option<f64>,
    s11_min_db: Option<f64>,
    fitted_resonance_ghz: Option<f64>,
    fitted_resonance_error: Option<f64>,
    q: Option<f64>,
    tets: Option<usize>,
    steps: Option<usize>,
    /// Time that the run took, now or when it was kept.
    seconds: Option<f64>,
    /// Why there is no result.
    refused: Option<String>,
}

impl Row {
    /// The rows of one antenna.
    pub(super) fn of_group(group: &Group, runs: &[(&Variant, Result<Stored, String>)]) -> Vec<Self> {
        let row = |(variant, stored): &(&Variant, Result<Stored, String>)| {
            let named = Self { antenna: group.name.to_owned(), shape: variant.name.to_owned(), ..Self::default() };
            match stored {
                Ok(stored) => named.filled(stored),
                Err(reason) => Self { refused: Some(reason.clone()), ..named },
            }
        };
        let mut rows: Vec<Self> = runs.iter().map(row).collect();
        let Some(reference) = runs.iter().position(|(variant, _)| variant.is_reference) else { return rows };
        let of = |value: fn(&Self) -> Option<f64>, rows: &[Self]| value(&rows[reference]);
        let (freq, width) = (of(|r| r.resonance_ghz, &rows), of(|r| r.bandwidth_10_db_mhz, &rows));
        let fitted = of(|r| r.fitted_resonance_ghz, &rows);
        let error = |value: Option<f64>, exact: Option<f64>| value.zip(exact).map(|(value, exact)| value / exact - 1.0);
        for row in &mut rows {
            row.resonance_error = error(row.resonance_ghz, freq);
            row.bandwidth_error = error(row.bandwidth_10_db_mhz, width);
            row.fitted_resonance_error = error(row.fitted_resonance_ghz, fitted);
        }
        rows
    }

    fn filled(self, stored: &Stored) -> Self {
        let found = stored.sweep().resonance();
        let figures = &stored.figures;
        Self {
            resonance_ghz: found.map(|r| r.freq / GHZ),
            bandwidth_10_db_mhz: found.and_then(|r| r.band).map(|[lo, hi]| (hi - lo) / 1e6),
            s11_min_db: found.map(|r| r.depth_db),
            fitted_resonance_ghz: stored.fitted.map(|f| f.freq / GHZ),
            q: stored.fitted.map(|f| f.q),
            tets: Some(figures.tets),
            steps: Some(figures.steps),
            seconds: Some(figures.seconds),
            ..self
        }
    }
}

impl Report {
    pub(super) fn csv(&self) -> String {
        let mut text = "antenna,shape,resonance_ghz,resonance_error,bandwidth_10_db_mhz,bandwidth_error,s11_min_db,\
            fitted_resonance_ghz,fitted_resonance_error,q,tets,steps,seconds,refused\n"
            .to_owned();
        for r in &self.rows {
            let number = |value: Option<f64>| value.map(|v| v.to_string()).unwrap_or_default();
            let count = |value: Option<usize>| value.map(|v| v.to_string()).unwrap_or_default();
            let cells = [
                r.antenna.clone(),
                r.shape.clone(),
                number(r.resonance_ghz),
                number(r.resonance_error),
                number(r.bandwidth_10_db_mhz),
                number(r.bandwidth_error),
                number(r.s11_min_db),
                number(r.fitted_resonance_ghz),
                number(r.fitted_resonance_error),
                number(r.q),
                count(r.tets),
                count(r.steps),
                number(r.seconds),
                quoted(r.refused.as_deref().unwrap_or_default()),
            ];
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }

    pub(super) fn text(&self, out: &Path) -> String {
        let head = ["antenna", "shape", "resonance", "error", "-10 dB band", "error", "|S11|", "by fit", "error", "Q"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let mut lines = Vec::new();
        for r in &self.rows {
            let or = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
            rows.push(vec![
                r.antenna.clone(),
                r.shape.clone(),
                or(r.resonance_ghz.map(|f| format!("{f:.4} GHz"))),
                or(r.resonance_error.map(percent)),
                or(r.bandwidth_10_db_mhz.map(|w| format!("{w:.1} MHz"))),
                or(r.bandwidth_error.map(percent)),
                or(r.s11_min_db.map(|db| format!("{db:.2} dB"))),
                or(r.fitted_resonance_ghz.map(|f| format!("{f:.4} GHz"))),
                or(r.fitted_resonance_error.map(percent)),
                or(r.q.map(|q| format!("{q:.2}"))),
            ]);
            lines.extend(r.refused.as_ref().map(|why| format!("{}, {}: {why}", r.antenna, r.shape)));
        }
        let seconds: f64 = self.rows.iter().filter_map(|r| r.seconds).sum();
        let last = format!(
            "errors relative to the exact cylinder; {seconds:.1} s of solving\nwrote to {}: {}",
            out.display(),
            self.files.join(", ")
        );
        [table(&rows)].into_iter().chain(lines).chain([last]).collect::<Vec<_>>().join("\n")
    }
}
