//! The numbers of each preset: names, units, sliders and the values they start with.

use super::field::{Choices, Number, Refused, rows};
use super::outbox::Outbox;
use crate::project::{BendPlane, Edit, PresetEntry, PresetSpec, RuleSpec};
use egui::{ComboBox, Ui};

/// Name of a preset.
pub(super) fn name(preset: &PresetSpec) -> &'static str {
    match preset {
        PresetSpec::Bend { plane: BendPlane::H, .. } => "Bend, H-plane",
        PresetSpec::Bend { plane: BendPlane::E, .. } => "Bend, E-plane",
        PresetSpec::Convex { .. } => "Convex",
        PresetSpec::Concave { .. } => "Concave",
        PresetSpec::Saddle { .. } => "Saddle",
        PresetSpec::Twist { .. } => "Twist",
        PresetSpec::Crumple { .. } => "Crumple",
    }
}

/// Presets to choose from: name, tooltip, first values.
pub(super) fn choices() -> [(&'static str, &'static str, PresetSpec); 7] {
    let bend = |plane| PresetSpec::Bend { plane, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    let (radius_mm, amplitude_mm) = (20.0, 10.0);
    let all = [
        ("Onto a cylinder along y: the width curves", bend(BendPlane::H)),
        ("Onto a cylinder along x: the resonant length curves", bend(BendPlane::E)),
        ("Curved the same way along x and y", PresetSpec::Convex { radius_mm, amplitude_mm }),
        ("Convex, towards the other side", PresetSpec::Concave { radius_mm, amplitude_mm }),
        ("Curved in opposite ways along x and y", PresetSpec::Saddle { radius_mm, amplitude_mm }),
        ("Half a wave along x, turning along y", PresetSpec::Twist { amplitude_mm, rate_deg_per_mm: 0.573 }),
        ("Waves along x, y or both", PresetSpec::Crumple { amplitude_mm: 1.0, waves: [1.0, 0.0], phase_deg: 0.0 }),
    ];
    all.map(|(tip, preset)| (name(&preset), tip, preset))
}

/// Draws the inputs of a preset.
pub(super) fn ui(ui: &mut Ui, index: usize, entry: PresetEntry, refused: Refused<'_>, out: &mut Outbox) {
    if let PresetSpec::Bend { .. } = entry.preset {
        bend_choices(ui, index, entry, out);
    }
    rows(ui, "preset", |ui| {
        for (number, value, set) in numbers(entry.preset) {
            number.row(ui, value, refused, out, |v| {
                let mut preset = entry.preset;
                set(&mut preset, v);
                Edit::SetPreset { index, entry: PresetEntry { preset, ..entry } }
            });
        }
    });
}

fn bend_choices(ui: &mut Ui, index: usize, entry: PresetEntry, out: &mut Outbox) {
    let PresetSpec::Bend { mut plane, radius_mm, mut rule, kept_plane_mm } = entry.preset else { return };
    rows(ui, "bend", |ui| {
        let before = (plane, rule);
        let label = ui.label("Plane");
        let text = if plane == BendPlane::H { "H (width curves)" } else { "E (length curves)" };
        let combo = ComboBox::from_id_salt("plane").selected_text(text).show_list(ui, |ui| {
            ui.selectable_value(&mut plane, BendPlane::H, "H (width curves)");
            ui.selectable_value(&mut plane, BendPlane::E, "E (length curves)");
        });
        combo.response.labelled_by(label.id).on_hover_text("Which direction of the antenna curves");
        ui.end_row();
        let label = ui.label("Cage rule");
        let text = if rule == RuleSpec::Tangent { "Tangent" } else { "Arc" };
        let combo = ComboBox::from_id_salt("rule").selected_text(text).show_list(ui, |ui| {
            let tip = "Cage segments touch the cylinder: nearly independent of their number";
            ui.selectable_value(&mut rule, RuleSpec::Tangent, "Tangent").on_hover_text(tip);
            ui.selectable_value(&mut rule, RuleSpec::Arc, "Arc").on_hover_text("Cage vertices lie on the cylinder");
        });
        combo.response.labelled_by(label.id).on_hover_text("How the cage follows the cylinder");
        ui.end_row();
        if (plane, rule) != before {
            let preset = PresetSpec::Bend { plane, radius_mm, rule, kept_plane_mm };
            out.edit("presets", Edit::SetPreset { index, entry: PresetEntry { preset, ..entry } });
        }
    });
}

type Set = fn(&mut PresetSpec, f64);

/// The numbers of a preset with their values and how each is set.
fn numbers(preset: PresetSpec) -> Vec<(Number, f64, Set)> {
    let radius = |tip| Number::new("radius", "Radius R", "mm", 0.05).tip(tip).slider(4.0..=60.0);
    let amplitude = |end: f64| Number::new("amplitude", "Amplitude A", "mm", 0.02).slider(-end..=end);
    match preset {
        PresetSpec::Bend { radius_mm, kept_plane_mm, .. } => vec![
            (radius("Of the patch's bottom plane; negative bends the other way"), radius_mm, |p, v| {
                if let PresetSpec::Bend { radius_mm, .. } = p {
                    *radius_mm = v;
                }
            }),
            (
                Number::new("kept_plane", "Kept plane z", "mm", 0.01)
                    .tip("The height whose length the cage keeps: 0 is the patch's bottom")
                    .slider(-2.0..=1.0),
                kept_plane_mm,
                |p, v| {
                    if let PresetSpec::Bend { kept_plane_mm, .. } = p {
                        *kept_plane_mm = v;
                    }
                },
            ),
        ],
        PresetSpec::Convex { radius_mm, amplitude_mm }
        | PresetSpec::Concave { radius_mm, amplitude_mm }
        | PresetSpec::Saddle { radius_mm, amplitude_mm } => vec![
            (radius("Of the bend along x"), radius_mm, |p, v| {
                if let PresetSpec::Convex { radius_mm, .. }
                | PresetSpec::Concave { radius_mm, .. }
                | PresetSpec::Saddle { radius_mm, .. } = p
                {
                    *radius_mm = v;
                }
            }),
            (amplitude(15.0).tip("Of the wave along y"), amplitude_mm, set_amplitude),
        ],
        PresetSpec::Twist { amplitude_mm, rate_deg_per_mm } => vec![
            (amplitude(15.0).tip("Of the half wave along x"), amplitude_mm, set_amplitude),
            (
                Number::new("rate", "Twist", "°/mm", 0.01).tip("Angle per length along y").slider(-3.0..=3.0),
                rate_deg_per_mm,
                |p, v| {
                    if let PresetSpec::Twist { rate_deg_per_mm, .. } = p {
                        *rate_deg_per_mm = v;
                    }
                },
            ),
        ],
        PresetSpec::Crumple { amplitude_mm, waves, phase_deg } => crumple(amplitude_mm, waves, phase_deg),
    }
}

fn crumple(amplitude_mm: f64, waves: [f64; 2], phase_deg: f64) -> Vec<(Number, f64, Set)> {
    let tip = "Waves over the cage's extent; 0 for none";
    let along = |place, label| Number::new(place, label, "", 0.01).tip(tip).slider(0.0..=4.0);
    vec![
        (
            Number::new("amplitude", "Amplitude A", "mm", 0.02).tip("Height of the waves").slider(-4.0..=4.0),
            amplitude_mm,
            set_amplitude,
        ),
        (along("waves x", "Waves along x"), waves[0], |p, v| {
            if let PresetSpec::Crumple { waves, .. } = p {
                waves[0] = v;
            }
        }),
        (along("waves y", "Waves along y"), waves[1], |p, v| {
            if let PresetSpec::Crumple { waves, .. } = p {
                waves[1] = v;
            }
        }),
        (
            Number::new("phase", "Phase", "°", 0.5).tip("Where the waves begin").slider(-180.0..=180.0),
            phase_deg,
            |p, v| {
                if let PresetSpec::Crumple { phase_deg, .. } = p {
                    *phase_deg = v;
                }
            },
        ),
    ]
}

fn set_amplitude(preset: &mut PresetSpec, value: f64) {
    match preset {
        PresetSpec::Convex { amplitude_mm, .. }
        | PresetSpec::Concave { amplitude_mm, .. }
        | PresetSpec::Saddle { amplitude_mm, .. }
        | PresetSpec::Twist { amplitude_mm, .. }
        | PresetSpec::Crumple { amplitude_mm, .. } => *amplitude_mm = value,
        PresetSpec::Bend { .. } => {}
    }
}
