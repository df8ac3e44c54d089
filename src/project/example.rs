//! Projects to begin with: the paper's flat antenna and what can be made of it.

use super::{BendPlane, CompensationMode, PresetEntry, PresetSpec, Project, RuleSpec};

/// A project to begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// The paper's antenna as drawn.
    Flat,
    /// Bent to R = 10 mm in the H plane.
    BentH,
    /// Bent to R = 10 mm in the E plane.
    BentE,
    /// Curved in opposite ways along x and y.
    Saddle,
    /// A half wave that turns.
    Twist,
}

impl Example {
    /// All of them, the simplest first.
    pub const ALL: [Self; 5] = [Self::Flat, Self::BentH, Self::BentE, Self::Saddle, Self::Twist];

    /// The project, not compensated: its errors are what a compensation then removes.
    #[must_use]
    pub fn project(self) -> Project {
        let bend = |plane| PresetSpec::Bend { plane, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        // As few vertices as the shape needs: a hand can choose among them.
        let (preset, segments) = match self {
            Self::Flat => (None, [4, 4]),
            Self::BentH => (Some(bend(BendPlane::H)), [10, 4]),
            Self::BentE => (Some(bend(BendPlane::E)), [4, 10]),
            Self::Saddle => (Some(PresetSpec::Saddle { radius_mm: 20.0, amplitude_mm: 5.0 }), [10, 10]),
            Self::Twist => (Some(PresetSpec::Twist { amplitude_mm: 3.0, rate_deg_per_mm: 0.573 }), [10, 10]),
        };
        let presets = preset.map(|preset| PresetEntry { enabled: true, preset }).into_iter().collect();
        let mut project = Project { presets, ..Project::default() };
        project.settings.compensation = CompensationMode::None;
        project.cage.segments = segments;
        project
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_valid_and_differ() {
        for (k, example) in Example::ALL.into_iter().enumerate() {
            let project = example.project();
            assert!(project.validate().is_ok(), "{example:?}");
            assert!(Example::ALL[..k].iter().all(|other| other.project() != project), "{example:?}");
        }
    }
}
