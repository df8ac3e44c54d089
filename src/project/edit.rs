//! Every way a project changes. The window, the command line and the tests all go through [`Edit::apply`].
//!
//! Enters: a valid project and one edit. Leaves: the changed project, valid again, or an error with the project whole.
//! An edit carries whole new values (a specification, a preset, offsets), never differences, so that applying it twice
//! changes nothing more. Not handled here: whether the changed cage can be posed; the pipeline tells.

use super::{
    AntennaSpec, BodiesSpec, CageSpec, CompensationMode, MaterialSpec, PresetEntry, Project, ProjectError, Settings,
};

/// One change of a project.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "made once per change")]
pub enum Edit {
    /// Sets all dimensions and materials of the antenna.
    SetAntenna(AntennaSpec),
    /// Sets padding and segments; new segments renumber the vertices and so clear the hand edits.
    SetCage(CageSpec),
    /// Replaces the whole stack of presets.
    SetPresets(Vec<PresetEntry>),
    /// Replaces the preset at `index`.
    SetPreset {
        /// Place in the stack.
        index: usize,
        /// The new preset.
        entry: PresetEntry,
    },
    /// Inserts a preset before the one at `index` (or at the end).
    InsertPreset {
        /// Place in the stack, at most its length.
        index: usize,
        /// The preset.
        entry: PresetEntry,
    },
    /// Removes the preset at `index`.
    RemovePreset {
        /// Place in the stack.
        index: usize,
    },
    /// Takes the preset at `from` out of the stack and puts it back so that it stands at `to`.
    ReorderPreset {
        /// Present place.
        from: usize,
        /// New place.
        to: usize,
    },
    /// Sets the offsets of single cage vertices on top of the presets, mm; an offset of zero removes the hand edit.
    MoveVertices(Vec<(u32, [f64; 3])>),
    /// Removes all hand edits.
    ClearHandEdits,
    /// Sets how the deformed antenna is computed.
    SetSettings(Settings),
    /// Replaces the list of the user's own materials.
    SetMaterials(Vec<MaterialSpec>),
    /// Puts bodies in place of the antenna's template, or takes them away; bodies are not compensated, and those of
    /// another extent begin flat.
    SetBodies(Option<Box<BodiesSpec>>),
    /// Puts another whole project in its place.
    Restore(Box<Project>),
}

/// Why an edit is refused; the project stays as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The stack has no such place.
    #[error("there is no preset {index}: the stack has {count}")]
    NoPreset {
        /// The place asked for.
        index: usize,
        /// How many presets there are.
        count: usize,
    },
    /// The changed project would not be valid.
    #[error(transparent)]
    Invalid(#[from] ProjectError),
}

impl Edit {
    /// Applies the edit.
    ///
    /// # Errors
    /// [`EditError`] if the edit names a preset that is not there or the result would not be valid; `project` is then
    /// unchanged.
    pub fn apply(self, project: &mut Project) -> Result<(), EditError> {
        let mut changed = project.clone();
        self.change(&mut changed)?;
        changed.validate()?;
        *project = changed;
        Ok(())
    }

    fn change(self, project: &mut Project) -> Result<(), EditError> {
        let presets = &mut project.presets;
        let count = presets.len();
        let place = |index: usize, limit: usize| {
            if index < limit { Ok(index) } else { Err(EditError::NoPreset { index, count }) }
        };
        match self {
            Self::SetAntenna(antenna) => project.antenna = antenna,
            Self::SetCage(cage) => {
                if cage.segments != project.cage.segments {
                    project.hand_edits.clear();
                }
                project.cage = cage;
            }
            Self::SetPresets(stack) => *presets = stack,
            Self::SetPreset { index, entry } => presets[place(index, count)?] = entry,
            Self::InsertPreset { index, entry } => presets.insert(place(index, count + 1)?, entry),
            Self::RemovePreset { index } => {
                presets.remove(place(index, count)?);
            }
            Self::ReorderPreset { from, to } => {
                let (from, to) = (place(from, count)?, place(to, count)?);
                let entry = presets.remove(from);
                presets.insert(to, entry);
            }
            Self::MoveVertices(offsets) => {
                for (vertex, offset) in offsets {
                    if offset.iter().all(|d| d.abs() <= 0.0) {
                        project.hand_edits.remove(&vertex);
                    } else {
                        project.hand_edits.insert(vertex, offset);
                    }
                }
            }
            Self::ClearHandEdits => project.hand_edits.clear(),
            Self::SetSettings(settings) => project.settings = settings,
            Self::SetMaterials(materials) => project.materials = materials,
            Self::SetBodies(bodies) => {
                let bodies = bodies.map(|b| *b);
                let extent = |b: &Option<BodiesSpec>| b.as_ref().map(BodiesSpec::bounds);
                if extent(&project.bodies) != extent(&bodies) {
                    project.hand_edits.clear();
                    project.presets.clear();
                }
                if bodies.is_some() {
                    project.settings.compensation = CompensationMode::None;
                }
                project.bodies = bodies;
            }
            Self::Restore(other) => *project = *other,
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BendPlane, PresetSpec, RuleSpec};
    use super::*;

    fn bend(radius_mm: f64) -> PresetEntry {
        let preset = PresetSpec::Bend { plane: BendPlane::H, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        PresetEntry { enabled: true, preset }
    }

    fn radii(project: &Project) -> Vec<f64> {
        let radius = |e: &PresetEntry| match e.preset {
            PresetSpec::Bend { radius_mm, .. } => radius_mm,
            _ => f64::NAN,
        };
        project.presets.iter().map(radius).collect()
    }

    #[test]
    fn presets_are_inserted_reordered_and_removed() {
        let mut project = Project::default();
        for (index, radius) in [(0, 10.0), (1, 20.0), (0, 30.0)] {
            Edit::InsertPreset { index, entry: bend(radius) }.apply(&mut project).expect("in range");
        }
        assert_eq!(radii(&project), [30.0, 10.0, 20.0], "inserted");
        Edit::ReorderPreset { from: 0, to: 2 }.apply(&mut project).expect("in range");
        assert_eq!(radii(&project), [10.0, 20.0, 30.0], "moved to the end");
        Edit::RemovePreset { index: 1 }.apply(&mut project).expect("in range");
        assert_eq!(radii(&project), [10.0, 30.0], "removed");
        Edit::SetPreset { index: 1, entry: bend(40.0) }.apply(&mut project).expect("in range");
        assert_eq!(radii(&project), [10.0, 40.0], "set");
    }

    #[test]
    fn a_refused_edit_leaves_the_project_whole() {
        let mut project = Project { presets: vec![bend(10.0)], ..Project::default() };
        project.hand_edits.insert(3, [1.0, 0.0, 0.0]);
        let before = project.clone();
        let mut thin = project.antenna.clone();
        thin.height_mm = -1.0;
        let wrong_settings = Settings { tolerance_mm: f64::NAN, ..project.settings };
        let refused = [
            Edit::SetAntenna(thin),
            Edit::SetCage(CageSpec { segments: [0, 10], ..project.cage }),
            Edit::InsertPreset { index: 2, entry: bend(5.0) },
            Edit::SetPreset { index: 1, entry: bend(5.0) },
            Edit::SetPreset { index: 0, entry: bend(f64::NAN) },
            Edit::RemovePreset { index: 1 },
            Edit::ReorderPreset { from: 0, to: 1 },
            Edit::MoveVertices(vec![(3, [0.0; 3]), (242, [1.0; 3])]),
            Edit::SetSettings(wrong_settings),
        ];
        for edit in refused {
            let label = format!("{edit:?}");
            assert!(edit.apply(&mut project).is_err(), "{label}");
            assert_eq!(project, before, "whole after {label}");
        }
    }

    #[test]
    fn new_segments_clear_hand_edits_and_new_padding_keeps_them() {
        let mut project = Project::default();
        Edit::MoveVertices(vec![(3, [0.0, 0.0, 1.5])]).apply(&mut project).expect("valid vertex");
        Edit::SetCage(CageSpec { padding_mm: [2.0; 3], ..project.cage }).apply(&mut project).expect("valid");
        assert_eq!(project.hand_edits.len(), 1, "the same vertices");
        Edit::SetCage(CageSpec { segments: [10, 8], ..project.cage }).apply(&mut project).expect("valid");
        assert!(project.hand_edits.is_empty(), "other vertices");
    }

    #[test]
    fn an_offset_of_zero_removes_the_hand_edit() {
        let mut project = Project::default();
        Edit::MoveVertices(vec![(3, [0.0, 0.0, 1.5]), (4, [1.0; 3])]).apply(&mut project).expect("valid vertices");
        Edit::MoveVertices(vec![(3, [0.0; 3])]).apply(&mut project).expect("valid vertex");
        assert_eq!(project.hand_edits.keys().copied().collect::<Vec<_>>(), [4], "one left");
        Edit::ClearHandEdits.apply(&mut project).expect("always");
        assert_eq!(project, Project::default(), "none left");
    }
}
