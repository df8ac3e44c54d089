//! From displacements of cage vertices to the edit of the project: offsets on top of the presets, whole micrometres.

use super::session::Pose;
use crate::cage::{Mirror, Share};
use crate::geometry::DVec3;
use crate::project::{Edit, Project};
use crate::units::to_mm;
use std::collections::BTreeMap;

/// Offsets of vertices by number, mm.
pub(super) type Offsets = BTreeMap<u32, [f64; 3]>;

/// Rounds to a micrometre: what a pointer can mean, and numbers that read well in the file. Never gives -0.
pub(super) fn micrometres(value_mm: f64) -> f64 {
    (value_mm * 1e3).round() / 1e3 + 0.0
}

/// Offsets after displacements (mm) from offsets noted earlier; what is not displaced keeps its offset to the bit.
pub(super) fn displaced(start: &Offsets, shares: &[Share]) -> Offsets {
    let moved = |share: &Share| {
        let offset = start.get(&share.vertex).copied().unwrap_or_default();
        let by = share.by.to_array();
        let along = |a: usize| if by[a].abs() > 0.0 { micrometres(offset[a] + by[a]) } else { offset[a] };
        (share.vertex, [0, 1, 2].map(along))
    };
    shares.iter().map(moved).collect()
}

/// The edit that sets one coordinate of vertices to `target_mm`, and that of their partners as the mirror has it.
pub(super) fn place_edit(
    project: &Project,
    pose: &Pose,
    mirror: Mirror,
    vertices: &[u32],
    (axis, target_mm): (usize, f64),
) -> Edit {
    coordinate_edit(project, pose, mirror, vertices, axis, |vertex| {
        Some(target_mm - to_mm(pose.vertices.get(vertex as usize)?[axis]))
    })
}

/// The edit that sets one coordinate of the offsets of vertices, and that of their partners as the mirror has it.
pub(super) fn offset_edit(
    project: &Project,
    pose: &Pose,
    mirror: Mirror,
    vertices: &[u32],
    (axis, target_mm): (usize, f64),
) -> Edit {
    coordinate_edit(project, pose, mirror, vertices, axis, |vertex| {
        Some(target_mm - project.hand_edits.get(&vertex).map_or(0.0, |offset| offset[axis]))
    })
}

/// The edit that moves vertices along an axis, and their partners as the mirror has it.
///
/// * `by_mm`: how far, for a vertex; `None` leaves it out.
fn coordinate_edit(
    project: &Project,
    pose: &Pose,
    mirror: Mirror,
    vertices: &[u32],
    axis: usize,
    by_mm: impl Fn(u32) -> Option<f64>,
) -> Edit {
    let share = |&vertex: &u32| {
        let mut by = DVec3::ZERO;
        by[axis] = by_mm(vertex)?;
        Some(Share { vertex, weight: 1.0, by })
    };
    let shares = mirror.applied(&pose.cage, vertices.iter().filter_map(share).collect());
    Edit::MoveVertices(displaced(&project.hand_edits, &shares).into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moved_offsets_are_whole_micrometres_and_never_minus_zero() {
        let share = Share { vertex: 7, weight: 1.0, by: DVec3::new(0.000_4, -0.000_2, 1.234_56) };
        let moved = displaced(&[(7, [1.0, 0.0, 0.0])].into(), &[share]);
        assert_eq!(moved, [(7, [1.0, 0.0, 1.235])].into(), "rounded");
        assert!(moved[&7][1].is_sign_positive(), "plain zero");
        let fine: Offsets = [(7, [0.123_456, 0.1, 0.0])].into();
        let moved = displaced(&fine, &[Share { vertex: 7, weight: 1.0, by: DVec3::Y }]);
        assert_eq!(moved, [(7, [0.123_456, 1.1, 0.0])].into(), "other coordinates keep every digit");
    }
}
