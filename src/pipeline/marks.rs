//! Where the feed is and where resistors meet the deformed patch, to be marked in a picture.

use crate::antenna::PatchParams;
use crate::geometry::{DVec2, DVec3, Plc, VertexId};
use crate::project::BodiesSpec;

/// Vertices nearer to z = 0 than this lie in the patch's bottom plane, m: far below any thickness, above rounding.
const FLATNESS: f64 = 1e-12;

/// What a mark stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MarkKind {
    /// The inner conductor of the feed.
    Feed,
    /// The resistor of this number, of so many ohm.
    Resistor(usize, f64),
    /// A source of so many ohm across a gap between bodies.
    Source(f64),
}

/// A place on the deformed antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// What stands there.
    pub kind: MarkKind,
    /// On the patch's bottom, or in the middle of the gap, m.
    pub at: DVec3,
    /// The deformed patch's unit normal there, away from the ground; a gap has none.
    pub up: Option<DVec3>,
}

/// The mark of the bodies' feed, if they have one; the first of `positions`, m, are those of their vertices.
#[must_use]
pub(super) fn source_mark(bodies: &BodiesSpec, positions: &[DVec3]) -> Option<Mark> {
    let ohm = bodies.feed?.ohm;
    let [from, to] = bodies.gap().ok()??.ends.map(|v| positions[v.index()]);
    Some(Mark { kind: MarkKind::Source(ohm), at: from.midpoint(to), up: None })
}

/// The marks of an antenna whose flat surface is carried to `positions`, m; a place that no facet holds has none.
#[must_use]
pub(super) fn marks(built: &PatchParams, flat: &Plc, positions: &[DVec3]) -> Vec<Mark> {
    let is_bottom = |v: &VertexId| flat.vertices[v.index()].z.abs() < FLATNESS;
    let bottom: Vec<[VertexId; 3]> =
        flat.facets.iter().map(|facet| facet.vertices).filter(|corners| corners.iter().all(is_bottom)).collect();
    let resistors = built.resistors.iter().enumerate();
    let resistors = resistors.map(|(k, resistor)| (MarkKind::Resistor(k, resistor.resistance), resistor.at));
    let places = std::iter::once((MarkKind::Feed, built.feed())).chain(resistors);
    let found = places.filter_map(|(kind, place)| {
        bottom.iter().find_map(|corners| {
            let [a, b, c] = corners.map(|v| flat.vertices[v.index()].truncate());
            let weights = barycentric(place, [a, b, c])?;
            let [p, q, r] = corners.map(|v| positions[v.index()]);
            let at = weights[0] * p + weights[1] * q + weights[2] * r;
            // Whichever way the facet is wound, flat it faces up.
            let turn = (b - a).perp_dot(c - a).signum();
            let up = (turn * (q - p).cross(r - p)).try_normalize()?;
            Some(Mark { kind, at, up: Some(up) })
        })
    });
    found.collect()
}

/// Weights of a triangle's corners at a point; `None` outside.
fn barycentric(point: DVec2, [a, b, c]: [DVec2; 3]) -> Option<[f64; 3]> {
    let whole = (b - a).perp_dot(c - a);
    let weights = [(b - point).perp_dot(c - point), (c - point).perp_dot(a - point), (a - point).perp_dot(b - point)];
    let weights = weights.map(|w| w / whole);
    weights.iter().all(|w| *w >= -1e-9).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deform::SmoothMap;
    use crate::distortion::Sheet;
    use crate::pipeline::run;
    use crate::project::{
        BendPlane, CompensationMode, PresetEntry, PresetSpec, Project, ResistorSpec, RuleSpec, ScopeSpec, Settings,
    };
    use crate::task::Task;
    use crate::units::from_mm;

    #[test]
    fn marks_lie_where_the_smooth_map_carries_feed_and_resistors() {
        let mut project = Project::default();
        let bend =
            PresetSpec::Bend { plane: BendPlane::H, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        project.presets.push(PresetEntry { enabled: true, preset: bend });
        project.antenna.resistors.push(ResistorSpec { x_mm: -3.0, y_mm: 2.5, ohm: 75.0 });
        for compensation in [CompensationMode::None, CompensationMode::Wl] {
            // The patch alone is scaled by WL, and the places on it with it.
            project.settings = Settings { compensation, scope: ScopeSpec::Patch, ..project.settings };
            let stages = run(&project, &Task::default()).expect("it can be bent");
            let template = stages.template.as_ref().expect("no bodies of its own");
            let compensated = &template.compensated;
            let map = Sheet { scale: compensated.patch_scale, warp: &compensated.warp, map: &compensated.map };
            let params = &template.params;
            let places = [params.feed().extend(0.0), params.resistors[0].at.extend(0.0)];
            let images = map.jacobians(&places).expect("inside the cage");
            let marks = &stages.deformed.marks;
            assert_eq!(marks.len(), 2, "the feed and a resistor");
            assert_eq!(marks[1].kind, MarkKind::Resistor(0, 75.0), "with its value");
            for (mark, (at, jacobian)) in marks.iter().zip(images) {
                let far = mark.at.distance(at);
                assert!(far < from_mm(2.0 * project.settings.tolerance_mm), "{compensation:?}, {mark:?}: {far} m off");
                let normal = jacobian.x_axis.cross(jacobian.y_axis).normalize_or_zero();
                let up = mark.up.expect("the patch has two sides");
                assert!(up.dot(normal) > 0.98, "{compensation:?}: {up} and {normal}");
            }
        }
    }
}
