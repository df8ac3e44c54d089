//! What runs and numbers are called.

use crate::pipeline::{Density, Job, Shape};
use crate::project::{BendPlane, CompensationMode, PresetSpec};

/// What a run is called: its shape, and the density where it is not the usual one.
#[must_use]
pub fn job_name(job: &Job) -> String {
    let project = job.project();
    let active: Vec<&PresetSpec> = project.presets.iter().filter(|p| p.enabled).map(|p| &p.preset).collect();
    let bend = match active[..] {
        [PresetSpec::Bend { plane, radius_mm, .. }] if project.hand_edits.is_empty() => {
            let plane = if *plane == BendPlane::E { "E" } else { "H" };
            Some(format!("R {radius_mm} {plane}"))
        }
        _ => None,
    };
    let shape = match (job.shape(), bend) {
        (Shape::Flat, _) => "Flat".to_owned(),
        (Shape::Cylinder, bend) => format!("Cylinder {}", bend.unwrap_or_default()),
        (Shape::Deformed, bend) => {
            let how = match project.settings.compensation {
                CompensationMode::None => "raw",
                CompensationMode::Wl => "WL",
                CompensationMode::Isometric => "isometric",
            };
            format!("{}, {how}", bend.unwrap_or_else(|| "Deformed".to_owned()))
        }
    };
    match job.settings().mesh.density {
        Density::Default => shape,
        Density::Coarse => format!("{shape}, coarse"),
        Density::Fine => format!("{shape}, fine"),
    }
}

/// Units at the end of a key of the project's file, longest first.
const UNITS: [(&str, &str); 6] = [
    ("_deg_per_mm", "\u{b0}/mm"),
    ("_mm", "mm"),
    ("_deg", "\u{b0}"),
    ("_ghz", "GHz"),
    ("_ohm", "\u{3a9}"),
    ("_percent", "%"),
];

/// A key of the project's file in words, and its unit: `width_mm` is "width" and "mm".
#[must_use]
pub fn key_and_unit(key: &str) -> (String, &'static str) {
    let found = UNITS.iter().find_map(|(ending, unit)| Some((key.strip_suffix(ending)?, *unit)));
    let (name, unit) = found.unwrap_or((key, ""));
    (name.replace('_', " "), unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_split_into_words_and_unit() {
        assert_eq!(key_and_unit("ground_width_mm"), ("ground width".to_owned(), "mm"), "length");
        assert_eq!(key_and_unit("rate_deg_per_mm"), ("rate".to_owned(), "\u{b0}/mm"), "rate");
        assert_eq!(key_and_unit("pin_segments"), ("pin segments".to_owned(), ""), "count");
    }
}
