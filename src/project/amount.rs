//! A deformation in part: how a project looks on the way from flat to fully deformed. For looking only.

use super::{PresetEntry, PresetSpec, Project};

/// Below this part a deformation is flat: radii on the way there would leave their range.
const LEAST: f64 = 1e-3;

impl Project {
    /// The project with a part of its deformation: 0 is flat, 1 is as designed.
    ///
    /// Curvatures 1/R, amplitudes, rates and hand edits grow evenly; waves, phases and everything else stay.
    #[must_use]
    pub fn at_amount(&self, amount: f64) -> Self {
        let mut project = self.clone();
        if amount >= 1.0 {
            return project;
        }
        if amount < LEAST {
            project.presets.clear();
            project.hand_edits.clear();
            return project;
        }
        for PresetEntry { preset, .. } in &mut project.presets {
            preset.scale(amount);
        }
        for offset in project.hand_edits.values_mut() {
            *offset = offset.map(|d| d * amount);
        }
        project
    }
}

impl PresetSpec {
    fn scale(&mut self, amount: f64) {
        match self {
            Self::Bend { radius_mm, .. } => *radius_mm /= amount,
            Self::Convex { radius_mm, amplitude_mm }
            | Self::Concave { radius_mm, amplitude_mm }
            | Self::Saddle { radius_mm, amplitude_mm } => {
                *radius_mm /= amount;
                *amplitude_mm *= amount;
            }
            Self::Twist { amplitude_mm, rate_deg_per_mm } => {
                *amplitude_mm *= amount;
                *rate_deg_per_mm *= amount;
            }
            Self::Crumple { amplitude_mm, .. } => *amplitude_mm *= amount,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BendPlane, RuleSpec};
    use super::*;
    use crate::cage::pose;

    fn bent() -> Project {
        let bend = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 12.0, rule: RuleSpec::Arc, kept_plane_mm: 0.0 };
        let all = [
            bend,
            PresetSpec::Twist { amplitude_mm: 1.0, rate_deg_per_mm: 0.4 },
            PresetSpec::Crumple { amplitude_mm: 0.5, waves: [1.0, 2.0], phase_deg: 30.0 },
        ];
        let presets = all.map(|preset| PresetEntry { enabled: true, preset }).to_vec();
        Project { presets, hand_edits: [(3, [0.1, 0.2, 0.3])].into(), ..Project::default() }
    }

    #[test]
    fn the_ends_are_the_flat_and_the_whole_project() {
        let project = bent();
        assert_eq!(project.at_amount(1.0), project, "bit for bit");
        let flat = project.at_amount(0.0);
        let cage = flat.rest_cage().expect("valid");
        assert_eq!(pose(&cage, &flat.active_presets()).expect("valid"), cage.mesh.vertices, "the rest cage");
        assert!(flat.hand_edits.is_empty(), "no offsets");
    }

    #[test]
    fn every_part_is_valid_and_the_cage_moves_evenly() {
        let project = bent();
        let cage = project.rest_cage().expect("valid");
        let at = |amount: f64| {
            let part = project.at_amount(amount);
            assert_eq!(part.validate(), Ok(()), "at {amount}");
            pose(&cage, &part.active_presets()).expect("valid")
        };
        let poses: Vec<_> = (0..=100).map(|k| at(f64::from(k) / 100.0)).collect();
        let steps = poses.windows(2).map(|w| w[0].iter().zip(&w[1]).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max));
        // The farthest corner goes about 20 mm altogether; no step is a jump.
        assert!(steps.fold(0.0, f64::max) < 0.5e-3, "no jump");
    }

    #[test]
    fn half_an_amount_is_half_the_curvature() {
        let PresetSpec::Bend { radius_mm, .. } = bent().at_amount(0.5).presets[0].preset else { panic!("a bend") };
        assert!((radius_mm - 24.0).abs() < 1e-12, "twice the radius");
    }
}
