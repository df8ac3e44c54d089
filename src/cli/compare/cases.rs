//! What is compared: antennas, each in its variants.

use super::super::choices::PaperChoice;
use crate::pipeline::{Scene, Shape};
use crate::project::{BendPlane, CompensationMode, PresetEntry, PresetSpec, Project, RuleSpec};

/// One antenna as deformed, with what stands beside it.
pub(super) struct Group {
    /// Stem of the files.
    pub(super) name: &'static str,
    pub(super) title: String,
    pub(super) variants: Vec<Variant>,
}

/// One run.
pub(super) struct Variant {
    /// Part of file names.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) project: Project,
    pub(super) shape: Shape,
    /// Whether the others' errors are relative to this one.
    pub(super) is_reference: bool,
}

/// The paper's cage: padding 3 mm, ten segments along each direction that curves.
const SEGMENTS: usize = 10;

impl Group {
    /// The variants of a project's antenna.
    pub(super) fn of_project(project: &Project, file: &str) -> Self {
        Self::new("s11", format!("Reflection, {file}"), project)
    }

    /// The antennas of the paper's figures 10 to 13 (bends) and 14 to 16 (shapes of section VI).
    pub(super) fn of_paper(which: PaperChoice) -> Vec<Self> {
        let bends = [
            ("h_plane_r10", BendPlane::H, 10.0),
            ("h_plane_r6_5", BendPlane::H, 6.5),
            ("e_plane_r10", BendPlane::E, 10.0),
            ("e_plane_r6_5", BendPlane::E, 6.5),
        ];
        let bends = bends.map(|(name, plane, radius_mm)| {
            let preset = PresetSpec::Bend { plane, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
            let segments = if plane == BendPlane::H { [SEGMENTS, 1] } else { [1, SEGMENTS] };
            let title = format!("Bent in the {plane:?}-plane, R = {radius_mm} mm");
            Self::new(name, title, &with_preset(preset, segments))
        });
        let (radius_mm, amplitude_mm) = (20.0, 10.0);
        let shapes = [
            ("convex", PresetSpec::Convex { radius_mm, amplitude_mm }),
            ("concave", PresetSpec::Concave { radius_mm, amplitude_mm }),
            ("saddle", PresetSpec::Saddle { radius_mm, amplitude_mm }),
            ("twist", PresetSpec::Twist { amplitude_mm, rate_deg_per_mm: 0.573 }),
        ];
        let shapes = shapes
            .map(|(name, preset)| Self::new(name, format!("Section VI, {name}"), &with_preset(preset, [SEGMENTS; 2])));
        match which {
            PaperChoice::Bends => bends.into(),
            PaperChoice::Shapes => shapes.into(),
            PaperChoice::All => bends.into_iter().chain(shapes).collect(),
        }
    }

    fn new(name: &'static str, title: String, project: &Project) -> Self {
        let has_cylinder = Scene::new(project).is_ok_and(|scene| scene.cylinder().is_some());
        let variant = |name, title, shape, compensation: CompensationMode| {
            let mut project = project.clone();
            project.settings.compensation = compensation;
            Variant { name, title, project, shape, is_reference: shape == Shape::Cylinder }
        };
        use CompensationMode::{Isometric, None, Wl};
        let mut variants = vec![variant("flat", "flat", Shape::Flat, None)];
        if has_cylinder {
            variants.push(variant("cylinder", "exact cylinder", Shape::Cylinder, None));
        }
        variants.push(variant("raw", "uncompensated", Shape::Deformed, None));
        // Imported bodies are not compensated.
        if project.bodies.is_none() {
            variants.push(variant("wl", "WL", Shape::Deformed, Wl));
            variants.push(variant("isometric", "isometric", Shape::Deformed, Isometric));
        }
        Self { name, title, variants }
    }
}

/// The paper's antenna in a cage of so many segments.
fn with_preset(preset: PresetSpec, segments: [usize; 2]) -> Project {
    let mut project = Project { presets: vec![PresetEntry { enabled: true, preset }], ..Project::default() };
    project.cage.segments = segments;
    project
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antenna::bodies::tests::cuboid;
    use crate::project::{BodiesSpec, BodyKind, BodySpec, LooseBody, WELD_MM};
    use crate::task::Task;

    #[test]
    fn imported_bodies_are_compared_without_compensations() {
        let spec = BodySpec { name: "plate".to_owned(), kind: BodyKind::Metal };
        let surface = cuboid("plate", [-5.0, -5.0, 0.0], [5.0, 5.0, 1.0], [1, 1, 1]).surface;
        let bodies = BodiesSpec::weld(&[LooseBody { spec, surface }], WELD_MM, &Task::default()).expect("one body");
        let project = Project { bodies: Some(bodies), ..Project::default() };
        let group = Group::of_project(&project, "a plate");
        let names: Vec<&str> = group.variants.iter().map(|v| v.name).collect();
        assert_eq!(names, ["flat", "raw"]);
        assert!(group.variants.iter().all(|v| v.project.validate().is_ok()), "each can be solved");
    }

    #[test]
    fn the_papers_antennas_can_be_posed_and_only_bends_have_a_reference() {
        let groups = Group::of_paper(PaperChoice::All);
        assert_eq!(groups.len(), 8, "four bends and four shapes");
        for (k, group) in groups.iter().enumerate() {
            for variant in &group.variants {
                assert_eq!(variant.project.validate(), Ok(()), "{} {}", group.name, variant.name);
                assert!(Scene::new(&variant.project).unwrap().checked_pose().is_ok(), "{} can be posed", group.name);
            }
            let references = group.variants.iter().filter(|v| v.is_reference).count();
            assert_eq!((references, group.variants.len()), if k < 4 { (1, 5) } else { (0, 4) }, "{}", group.name);
        }
    }
}
