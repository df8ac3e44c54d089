//! What `solve` says and writes of the far field.

use super::plot_files;
use crate::io::{csv, ffs};
use crate::pipeline::Solved;
use crate::plot::{Curve, Dial, Format, Polar, palette};
use crate::results::{Cut, CutPlane, FarField};
use crate::units::GHZ;
use anyhow::Result;
use serde::Serialize;
use std::path::Path;

/// Intervals of theta in a far-field source file: 5 degrees.
const FILE_GRID: usize = 36;

/// The radiation at one frequency, as JSON.
#[derive(Debug, Serialize)]
pub(super) struct PatternReport {
    /// The gathered frequency that is nearest to the resonance, or to the middle of the band where there is none.
    freq_ghz: f64,
    directivity_dbi: f64,
    /// Direction of the greatest directivity.
    directivity_theta_deg: f64,
    directivity_phi_deg: f64,
    /// Towards +z.
    boresight_directivity_dbi: f64,
    boresight_gain_dbi: f64,
    /// Null where the pattern does not fall by half on both sides.
    half_power_width_e_deg: Option<f64>,
    half_power_width_h_deg: Option<f64>,
    front_to_back_db: f64,
    /// Radiated over radiated and lost power.
    efficiency: f64,
    /// The same times accepted over incident power.
    total_efficiency: Option<f64>,
    /// Radiated (far field) and lost power over the accepted one.
    power_balance: Option<f64>,
    /// The same with the power through a surface around the antenna for the one in the far field.
    near_power_balance: Option<f64>,
}

impl PatternReport {
    pub(super) fn new(field: &FarField) -> Self {
        let (directivity, [theta, phi]) = field.max_directivity();
        let width = |plane| field.cut(plane).half_power_width().map(f64::to_degrees);
        let boresight = field.boresight();
        Self {
            freq_ghz: field.freq / GHZ,
            directivity_dbi: directivity,
            directivity_theta_deg: theta.to_degrees(),
            directivity_phi_deg: phi.to_degrees(),
            boresight_directivity_dbi: boresight,
            boresight_gain_dbi: boresight + 10.0 * field.efficiency().log10(),
            half_power_width_e_deg: width(CutPlane::E),
            half_power_width_h_deg: width(CutPlane::H),
            front_to_back_db: field.front_to_back(),
            efficiency: field.efficiency(),
            total_efficiency: field.total_efficiency(),
            power_balance: field.balance(),
            near_power_balance: field.near_balance(),
        }
    }

    pub(super) fn text(&self) -> Vec<String> {
        let width = |w: Option<f64>| w.map_or_else(|| "none".to_owned(), |w| format!("{w:.1}"));
        let balance = self.power_balance.map_or_else(String::new, |b| format!(", power balance {b:.4}"));
        vec![
            format!(
                "pattern       {:.4} GHz: {:.2} dBi at theta {:.1}, phi {:.1} degrees; {:.2} dBi at boresight",
                self.freq_ghz,
                self.directivity_dbi,
                self.directivity_theta_deg,
                self.directivity_phi_deg,
                self.boresight_directivity_dbi
            ),
            format!(
                "beam          {} (E) and {} (H) degrees at half power, front to back {:.1} dB",
                width(self.half_power_width_e_deg),
                width(self.half_power_width_h_deg),
                self.front_to_back_db
            ),
            format!(
                "radiation     {:.2} dBi gain, efficiency {:.4}{balance}",
                self.boresight_gain_dbi, self.efficiency
            ),
        ]
    }
}

/// Writes tables, the far-field source and the polar plot; returns their names.
///
/// * `fields`: those whose patterns are written.
pub(super) fn write(solved: &Solved, fields: &[&FarField], name: &str, dir: &Path) -> Result<Vec<String>> {
    let rows = solved.far_fields.iter().map(|f| {
        let or_nan = |x: Option<f64>| x.unwrap_or(f64::NAN);
        let (boresight, efficiency) = (f.boresight(), f.efficiency());
        [
            f.freq / GHZ,
            f.max_directivity().0,
            boresight,
            boresight + 10.0 * efficiency.log10(),
            efficiency,
            or_nan(f.total_efficiency()),
            f.front_to_back(),
            or_nan(f.balance()),
            or_nan(f.near_balance()),
        ]
    });
    let header = [
        "freq_ghz",
        "directivity_dbi",
        "boresight_directivity_dbi",
        "boresight_gain_dbi",
        "efficiency",
        "total_efficiency",
        "front_to_back_db",
        "power_balance",
        "near_power_balance",
    ];
    csv::write_table(&dir.join("radiation.csv"), &header, rows)?;
    let cuts: Vec<(f64, Cut, Cut)> = fields.iter().map(|f| (f.freq, f.cut(CutPlane::E), f.cut(CutPlane::H))).collect();
    let rows = cuts.iter().flat_map(|(freq, e, h)| {
        (0..e.psi.len()).map(move |k| {
            let values = [e, h].map(|c| [c.total[k], c.co[k], c.cross[k]]);
            [[freq / GHZ, e.psi[k].to_degrees()].as_slice(), &values.concat()].concat()
        })
    });
    let header = [
        "freq_ghz",
        "psi_deg",
        "e_plane_total_dbi",
        "e_plane_co_dbi",
        "e_plane_cross_dbi",
        "h_plane_total_dbi",
        "h_plane_co_dbi",
        "h_plane_cross_dbi",
    ];
    csv::write_table(&dir.join("pattern.csv"), &header, rows)?;
    let sampled: Vec<FarField> = fields.iter().map(|f| f.resampled(FILE_GRID)).collect();
    ffs::write(&sampled, &dir.join("pattern.ffs"))?;
    let dials = cuts.iter().flat_map(|(freq, e, h)| [("E", e), ("H", h)].map(|(plane, cut)| dial(*freq, plane, cut)));
    let polar = Polar {
        name: "pattern_plot",
        title: format!("Directivity, {name}"),
        unit: "dBi",
        depth: 40.0,
        dials: dials.collect(),
    };
    plot_files::write(&polar.into(), dir, &[Format::Svg, Format::Png])?;
    let names = ["radiation.csv", "pattern.csv", "pattern.ffs", "pattern_plot.svg", "pattern_plot.png"];
    Ok(names.map(|n| dir.join(n).display().to_string()).into())
}

fn dial(freq: f64, plane: &str, cut: &Cut) -> Dial {
    let curve = |name: &str, color: usize, dashed, values: &[f64]| Curve {
        name: name.to_owned(),
        color: palette::DISTINCT[color],
        dashed,
        points: cut.psi.iter().copied().zip(values.iter().copied()).collect(),
    };
    let curves = vec![
        curve("cross-polar", 1, false, &cut.cross),
        curve("total", 0, false, &cut.total),
        curve("co-polar", 2, true, &cut.co),
    ];
    Dial { title: format!("{plane} plane, {:.3} GHz", freq / GHZ), curves }
}
