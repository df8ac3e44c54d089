//! What a step did, in a few words: "Substrate height", "Bend radius", "Move 3 vertices".
//!
//! Told by comparing the projects before and after field by field in the form of the file, so that no edit can forget
//! its name and a new field has one at once: its path, with spaces and without its unit.

use super::{BodiesSpec, Project};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Fields that are called otherwise than their path says.
const NAMES: &[(&str, &str)] = &[
    ("antenna.width_mm", "Patch width"),
    ("antenna.length_mm", "Patch length"),
    ("antenna.height_mm", "Substrate height"),
    ("antenna.ground_width_mm", "Substrate width"),
    ("antenna.ground_length_mm", "Substrate length"),
    ("antenna.inset_mm", "Feed inset"),
    ("antenna.substrate.eps_r", "Substrate permittivity"),
    ("antenna.sheath.eps_r", "Sheath permittivity"),
    ("antenna.substrate.tan_delta", "Substrate loss tangent"),
    ("antenna.sheath.tan_delta", "Sheath loss tangent"),
    ("antenna", "Antenna dimensions"),
    ("cage", "Cage"),
    ("cage.padding_mm", "Cage padding"),
    ("cage.segments", "Cage segments"),
    ("settings.tolerance_mm", "Split tolerance"),
    ("antenna.substrate", "Substrate material"),
    ("antenna.sheath", "Sheath material"),
    ("materials", "Own materials"),
];

/// Names the difference between two projects.
pub(super) fn step_name(before: &Project, after: &Project) -> String {
    if before.bodies != after.bodies {
        return bodies_name(before.bodies.as_ref(), after.bodies.as_ref());
    }
    // The surface of bodies is large, and the same in both.
    let value = |project: &Project| {
        serde_json::to_value(Project { bodies: None, ..project.clone() }).expect("a project has text keys")
    };
    let (mut before_fields, mut after_fields) = (value(before), value(after));
    // Presets and hand edits are lists, and have words of their own.
    for list in ["presets", "hand_edits"] {
        (before_fields[list], after_fields[list]) = (Value::Null, Value::Null);
    }
    let mut changed = Vec::new();
    compare(&before_fields, &after_fields, "", &mut changed);
    // A material's name goes with its values.
    if changed.iter().any(|(path, _)| !path.ends_with(".name")) {
        changed.retain(|(path, _)| !path.ends_with(".name"));
    }
    if let [(path, value), others @ ..] = changed.as_slice() {
        if others.is_empty() {
            return field_name(path, value);
        }
        return match others.iter().fold(path.as_str(), |part, (other, _)| common(part, other)) {
            "" => "Whole project".to_owned(),
            part => field_name(part, &Value::Null),
        };
    }
    if before.presets == after.presets {
        vertices_name(&before.hand_edits, &after.hand_edits)
    } else {
        let entries = |project: &Project| project.presets.iter().map(value_of).collect::<Vec<Value>>();
        presets_name(&entries(before), &entries(after))
    }
}

fn bodies_name(before: Option<&BodiesSpec>, after: Option<&BodiesSpec>) -> String {
    let name = match (before, after) {
        (_, None) => "Back to the patch template",
        (Some(before), Some(after)) if before.feed != after.feed => "Feed of bodies",
        (Some(before), Some(after)) if before.shape == after.shape => "Materials of bodies",
        _ => "Import bodies",
    };
    name.to_owned()
}

fn value_of(entry: &super::PresetEntry) -> Value {
    serde_json::to_value(entry).expect("a preset has text keys")
}

/// The paths of the fields that differ, with their new values.
fn compare(before: &Value, after: &Value, path: &str, changed: &mut Vec<(String, Value)>) {
    match (before, after) {
        (Value::Object(old), Value::Object(new)) => {
            let keys: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
            for key in keys {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                compare(&before[key], &after[key], &path, changed);
            }
        }
        _ if before != after => changed.push((path.to_owned(), after.clone())),
        _ => {}
    }
}

/// The part of two paths that they have in common.
fn common<'a>(path: &'a str, other: &str) -> &'a str {
    let mut end = 0;
    for (part, same) in path.split('.').zip(other.split('.')) {
        if part != same {
            break;
        }
        end += part.len() + 1;
    }
    &path[..end.saturating_sub(1)]
}

/// A field in words; a choice is told with what was chosen.
fn field_name(path: &str, value: &Value) -> String {
    let known = NAMES.iter().find(|(p, _)| *p == path).map(|(_, name)| (*name).to_owned());
    let name = known.unwrap_or_else(|| {
        let within = path.split_once('.').map_or(path, |(_, within)| within);
        capitalised(&in_words(within))
    });
    match value.as_str() {
        Some(choice) => format!("{name}: {}", in_words(choice)),
        None => name,
    }
}

/// A path with spaces, without the unit of its last part.
fn in_words(path: &str) -> String {
    if path == "wl" {
        return "WL".to_owned();
    }
    let units = ["_deg_per_mm", "_mm", "_deg", "_ghz", "_ohm", "_ph", "_pf"];
    let bare = units.iter().find_map(|unit| path.strip_suffix(unit)).unwrap_or(path);
    bare.replace(['.', '_'], " ")
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

fn presets_name(before: &[Value], after: &[Value]) -> String {
    let kind = |entry: &Value| entry["preset"]["kind"].as_str().unwrap_or("preset").to_owned();
    let differs = |(old, new): &(&Value, &Value)| old != new;
    match after.len().cmp(&before.len()) {
        std::cmp::Ordering::Greater if after.len() == before.len() + 1 => {
            let at = before.iter().zip(after).position(|pair| differs(&pair)).unwrap_or(before.len());
            format!("Add {}", kind(&after[at]))
        }
        std::cmp::Ordering::Less if after.len() + 1 == before.len() => {
            let at = before.iter().zip(after).position(|pair| differs(&pair)).unwrap_or(after.len());
            format!("Remove {}", kind(&before[at]))
        }
        std::cmp::Ordering::Equal => {
            let changed: Vec<(&Value, &Value)> = before.iter().zip(after).filter(differs).collect();
            match changed[..] {
                [(old, new)] => preset_name(old, new, &kind(old), &kind(new)),
                _ if before.iter().all(|entry| after.contains(entry)) => "Reorder presets".to_owned(),
                _ => "Presets".to_owned(),
            }
        }
        _ => "Presets".to_owned(),
    }
}

fn preset_name(old: &Value, new: &Value, old_kind: &str, new_kind: &str) -> String {
    if old_kind != new_kind {
        return format!("Change {old_kind} to {new_kind}");
    }
    let kind = capitalised(new_kind);
    let mut changed = Vec::new();
    compare(old, new, "", &mut changed);
    match &changed[..] {
        [(path, value)] if path == "enabled" => format!("{kind} {}", if *value == true { "on" } else { "off" }),
        [(path, value)] => {
            let field = in_words(path.strip_prefix("preset.").unwrap_or(path));
            match value.as_str() {
                Some(choice) => format!("{kind} {field}: {}", in_words(choice)),
                None => format!("{kind} {field}"),
            }
        }
        _ => kind,
    }
}

fn vertices_name(before: &BTreeMap<u32, [f64; 3]>, after: &BTreeMap<u32, [f64; 3]>) -> String {
    let all: BTreeSet<&u32> = before.keys().chain(after.keys()).collect();
    let changed: Vec<&u32> = all.into_iter().filter(|v| before.get(v) != after.get(v)).collect();
    let vertices = match changed.len() {
        1 => format!("vertex {}", changed[0]),
        count => format!("{count} vertices"),
    };
    match changed.iter().any(|v| after.contains_key(v)) {
        true => format!("Move {vertices}"),
        false if after.is_empty() && changed.len() > 1 => "Reset all vertices".to_owned(),
        false => format!("Reset {vertices}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::materials::{METALS, dielectric_named};
    use super::super::{BendPlane, CompensationMode, Edit, PresetEntry, PresetSpec, RuleSpec, Settings};
    use super::*;

    fn bend(radius_mm: f64) -> PresetEntry {
        let preset = PresetSpec::Bend { plane: BendPlane::H, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        PresetEntry { enabled: true, preset }
    }

    /// The name of an edit after others.
    fn name(before: &[Edit], edit: Edit) -> String {
        let mut project = Project::default();
        for edit in before {
            edit.clone().apply(&mut project).expect("valid");
        }
        let old = project.clone();
        edit.apply(&mut project).expect("valid");
        step_name(&old, &project)
    }

    #[test]
    fn steps_are_named_by_what_they_change() {
        let base = Project::default();
        let antenna = |change: fn(&mut super::super::AntennaSpec)| {
            let mut antenna = base.antenna.clone();
            change(&mut antenna);
            Edit::SetAntenna(antenna)
        };
        assert_eq!(name(&[], antenna(|a| a.height_mm = 1.0)), "Substrate height");
        assert_eq!(
            name(&[], antenna(|a| a.substrate = dielectric_named("FR-4").expect("known"))),
            "Substrate material"
        );
        assert_eq!(
            name(&[], antenna(|a| (a.substrate.eps_r, a.substrate.name) = (3.0, String::new()))),
            "Substrate permittivity"
        );
        assert_eq!(name(&[], antenna(|a| a.patch_metal = METALS[0].to_spec())), "Patch metal");
        assert_eq!(name(&[], antenna(|a| a.pin_radius_mm = 0.5)), "Pin radius");
        assert_eq!(name(&[], antenna(|a| (a.width_mm, a.length_mm) = (9.0, 7.0))), "Antenna dimensions");
        let padded = super::super::CageSpec { padding_mm: [2.0; 3], ..base.cage };
        assert_eq!(name(&[], Edit::SetCage(padded)), "Cage padding");
        let isometric = Settings { compensation: CompensationMode::Wl, ..base.settings };
        assert_eq!(name(&[], Edit::SetSettings(isometric)), "Compensation: WL");
    }

    #[test]
    fn changes_of_presets_are_named_by_their_kind() {
        let add = Edit::InsertPreset { index: 0, entry: bend(10.0) };
        let set = |entry| Edit::SetPreset { index: 0, entry };
        let one = std::slice::from_ref(&add);
        assert_eq!(name(&[], add.clone()), "Add bend");
        assert_eq!(name(one, set(bend(12.0))), "Bend radius");
        assert_eq!(name(one, set(PresetEntry { enabled: false, ..bend(10.0) })), "Bend off");
        let saddle = PresetSpec::Saddle { radius_mm: 20.0, amplitude_mm: 1.0 };
        let saddle = PresetEntry { enabled: true, preset: saddle };
        assert_eq!(name(one, set(saddle)), "Change bend to saddle");
        assert_eq!(name(one, Edit::RemovePreset { index: 0 }), "Remove bend");
        let second = Edit::InsertPreset { index: 1, entry: bend(20.0) };
        assert_eq!(name(&[add.clone(), second], Edit::ReorderPreset { from: 0, to: 1 }), "Reorder presets");
    }

    #[test]
    fn moved_vertices_are_counted() {
        let lift =
            |vertices: &[u32], mm: f64| Edit::MoveVertices(vertices.iter().map(|&v| (v, [0.0, 0.0, mm])).collect());
        assert_eq!(name(&[], lift(&[7], 1.0)), "Move vertex 7");
        assert_eq!(name(&[], lift(&[7, 8, 9], 1.0)), "Move 3 vertices");
        assert_eq!(name(&[lift(&[7, 8, 9], 1.0)], lift(&[8], 0.0)), "Reset vertex 8");
        assert_eq!(name(&[lift(&[7, 8, 9], 1.0)], Edit::ClearHandEdits), "Reset all vertices");
    }
}
