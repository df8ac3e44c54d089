//! The furthest valid project on the way from a good one to a refused one.

use super::scene::Scene;
use super::{PipelineError, run};
use crate::project::{PresetEntry, PresetSpec, Project};
use crate::task::{Cancelled, Task};

/// Halvings of the way: the last valid cage is found to a sixteenth of the edit.
const HALVINGS: usize = 4;

/// Bisects the edit between a valid project and one that is refused.
///
/// Only presets of the same kinds and hand edits are moved along; where anything else differs, the result is `good`.
///
/// # Errors
/// [`Cancelled`] if called off.
pub fn retreat(good: &Project, refused: &Project, task: &Task) -> Result<Project, Cancelled> {
    let posable = |project: &Project| Scene::new(project).and_then(|scene| scene.checked_pose()).map(|_| ());
    let computable = |project: &Project| run(project, task).map(|_| ());
    if posable(refused).is_ok() {
        return bisect(good, refused, computable);
    }
    // Most refusals are of the cage itself, which is quickly judged; what is left to check is then one full run.
    let candidate = bisect(good, refused, posable)?;
    match computable(&candidate) {
        Ok(()) => Ok(candidate),
        Err(PipelineError::Cancelled(cancelled)) => Err(cancelled),
        Err(_) => bisect(good, &candidate, computable),
    }
}

/// The furthest project that passes `check`, to a sixteenth of the way.
fn bisect(
    good: &Project,
    refused: &Project,
    check: impl Fn(&Project) -> Result<(), PipelineError>,
) -> Result<Project, Cancelled> {
    let (mut valid, mut part, mut step) = (good.clone(), 0.0, 0.5);
    for _ in 0..HALVINGS {
        let Some(candidate) = between(good, refused, part + step) else { break };
        match check(&candidate) {
            Ok(()) => (valid, part) = (candidate, part + step),
            Err(PipelineError::Cancelled(cancelled)) => return Err(cancelled),
            Err(_) => {}
        }
        step /= 2.0;
    }
    Ok(valid)
}

/// The project at part `t` of the way, or `None` if the two differ in more than numbers of presets and hand edits.
fn between(from: &Project, to: &Project, t: f64) -> Option<Project> {
    let same_rest = super::scene::same_rest(from, to) && from.presets.len() == to.presets.len();
    if !same_rest {
        return None;
    }
    let mix = |a: f64, b: f64| a + (b - a) * t;
    let presets = from.presets.iter().zip(&to.presets).map(|(a, b)| mix_presets(a, b, t)).collect::<Option<_>>()?;
    let mut hand_edits = std::collections::BTreeMap::new();
    for vertex in from.hand_edits.keys().chain(to.hand_edits.keys()) {
        let at = |project: &Project| project.hand_edits.get(vertex).copied().unwrap_or_default();
        let (a, b) = (at(from), at(to));
        hand_edits.insert(*vertex, [0, 1, 2].map(|k| mix(a[k], b[k])));
    }
    Some(Project { presets, hand_edits, ..to.clone() })
}

fn mix_presets(a: &PresetEntry, b: &PresetEntry, t: f64) -> Option<PresetEntry> {
    if a == b {
        return Some(*b);
    }
    if a.enabled != b.enabled {
        return None;
    }
    let mix = |a: f64, b: f64| a + (b - a) * t;
    let preset = match (a.preset, b.preset) {
        (
            PresetSpec::Bend { plane, radius_mm: r0, rule, kept_plane_mm: k0 },
            PresetSpec::Bend { plane: p1, radius_mm: r1, rule: rule1, kept_plane_mm: k1 },
        ) if plane == p1 && rule == rule1 => {
            PresetSpec::Bend { plane, radius_mm: mix(r0, r1), rule, kept_plane_mm: mix(k0, k1) }
        }
        (
            PresetSpec::Twist { amplitude_mm: a0, rate_deg_per_mm: r0 },
            PresetSpec::Twist { amplitude_mm: a1, rate_deg_per_mm: r1 },
        ) => PresetSpec::Twist { amplitude_mm: mix(a0, a1), rate_deg_per_mm: mix(r0, r1) },
        (
            PresetSpec::Crumple { amplitude_mm: a0, waves: w0, phase_deg: p0 },
            PresetSpec::Crumple { amplitude_mm: a1, waves: w1, phase_deg: p1 },
        ) => PresetSpec::Crumple {
            amplitude_mm: mix(a0, a1),
            waves: [mix(w0[0], w1[0]), mix(w0[1], w1[1])],
            phase_deg: mix(p0, p1),
        },
        (
            PresetSpec::Convex { radius_mm: r0, amplitude_mm: a0 },
            PresetSpec::Convex { radius_mm: r1, amplitude_mm: a1 },
        ) => PresetSpec::Convex { radius_mm: mix(r0, r1), amplitude_mm: mix(a0, a1) },
        (
            PresetSpec::Concave { radius_mm: r0, amplitude_mm: a0 },
            PresetSpec::Concave { radius_mm: r1, amplitude_mm: a1 },
        ) => PresetSpec::Concave { radius_mm: mix(r0, r1), amplitude_mm: mix(a0, a1) },
        (
            PresetSpec::Saddle { radius_mm: r0, amplitude_mm: a0 },
            PresetSpec::Saddle { radius_mm: r1, amplitude_mm: a1 },
        ) => PresetSpec::Saddle { radius_mm: mix(r0, r1), amplitude_mm: mix(a0, a1) },
        _ => return None,
    };
    Some(PresetEntry { enabled: b.enabled, preset })
}
