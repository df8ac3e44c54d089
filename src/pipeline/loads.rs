//! What a project's metal and resistors are in the mesh: surface resistances by conductor, resistors along chains of edges.

use super::mesh::Meshed;
use crate::antenna::{Conductor, PatchParams};
use crate::tet::Metal;
use crate::tlm::{Loads, Resistor};

/// The loads of an antenna in its mesh.
///
/// A sheet's resistance is that of both its sides together; a body of metal has two that carry current apart from each
/// other, each with twice the resistance. A resistor is shared by the edges of its chain in proportion to their length.
pub(super) fn loads(params: &PatchParams, meshed: &Meshed, metal: Metal) -> Loads {
    let sides = if metal == Metal::Solid { 2.0 } else { 1.0 };
    let sheets = [("pec_patch", params.patch_metal), ("pec_ground", params.ground_metal)];
    let sheets = sheets.into_iter().filter_map(|(name, metal)| match metal {
        Conductor::Perfect => None,
        Conductor::Sheet(resistance) => Some((name.to_owned(), sides * resistance)),
    });
    let posts = meshed.posts.iter().zip(&params.resistors);
    let resistors =
        posts.flat_map(|(chain, resistor)| Resistor::along(&meshed.mesh, chain, resistor.resistance)).collect();
    Loads { sheets: sheets.collect(), resistors, ..Loads::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Density, MeshSettings, Shape, SolveSettings, StopRule, mesh, solve};
    use crate::project::{BendPlane, MetalSpec, PresetEntry, PresetSpec, Project, ResistorSpec, RuleSpec};
    use crate::task::Task;
    use crate::units::{EPS0, MU0, from_mm};
    use std::collections::HashSet;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn a_resistor_is_a_chain_of_mesh_edges_from_ground_to_patch_flat_or_bent() {
        let mut project = Project::default();
        let bend =
            PresetSpec::Bend { plane: BendPlane::H, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        project.presets.push(PresetEntry { enabled: true, preset: bend });
        project.antenna.resistors =
            vec![ResistorSpec { x_mm: 3.0, y_mm: 2.0, ohm: 50.0 }, ResistorSpec { x_mm: -5.2, y_mm: 3.9, ohm: 0.01 }];
        project.antenna.ground_metal = MetalSpec::Sheet { name: String::new(), ohm_per_square: 0.05 };
        let settings = MeshSettings { density: Density::Coarse, metal: Metal::Sheet };
        for shape in [Shape::Flat, Shape::Cylinder] {
            let meshed = mesh(&project, shape, settings, &Task::default()).expect("a mesh");
            let loads = loads(&project.antenna.to_params(), &meshed, settings.metal);
            assert_eq!(loads.sheets, [("pec_ground".to_owned(), 0.05)], "the ground alone is lossy");
            let edges: HashSet<_> = meshed
                .mesh
                .tets
                .iter()
                .flat_map(|t| t.vertices.into_iter().flat_map(|a| t.vertices.map(|b| [a.min(b), a.max(b)])))
                .collect();
            assert!(loads.resistors.iter().all(|r| edges.contains(&r.edge)), "{shape:?}: along edges of the mesh");
            for (k, resistor) in project.antenna.resistors.iter().enumerate() {
                let chain = &meshed.posts[k];
                let sum: f64 = loads.resistors[2 * k..2 * k + 2].iter().map(|r| r.resistance).sum();
                assert!((sum / resistor.ohm - 1.0).abs() < 1e-12, "{sum} ohm in series");
                let touches = |v, group: &str| {
                    let of_group = |f: &&crate::tet::MarkedFace| meshed.mesh.groups[f.group].name == group;
                    meshed.mesh.faces.iter().filter(of_group).any(|f| f.vertices.contains(v))
                };
                assert!(touches(&chain[0], "pec_ground") && touches(&chain[2], "pec_patch"), "{shape:?}: at both ends");
            }
            assert!(meshed.quality.whole.dihedral_min > 0.1, "{shape:?}: cells stay well shaped");
        }
    }

    /// Lost power over radiated power by perturbation of the cavity under the patch: field cos(pi y / L), no fringes.
    fn perturbation(params: &PatchParams, ohm_per_square: f64, y: f64, ohm: f64) -> f64 {
        // The unloaded quality factor of the paper's antenna, nearly all of it radiation.
        const Q: f64 = 8.0;
        let omega = TAU * 10.6e9;
        // Current and voltage share the energy; the current crosses two sheets.
        let of_sheets = 2.0 * ohm_per_square / (omega * MU0 * params.height);
        let capacitance = EPS0 * params.substrate.eps_r * params.width * params.length / params.height;
        let of_resistor = 2.0 * (PI * y / params.length).sin().powi(2) / (omega * capacitance * ohm);
        Q * (of_sheets + of_resistor + params.substrate.tan_delta)
    }

    #[test]
    fn what_sheets_and_a_resistor_take_is_about_what_perturbation_says_and_powers_add_up() {
        let (ohm_per_square, y_mm, ohm) = (0.5, 3.0, 2000.0);
        let mut project = Project::default();
        let expected = perturbation(&project.antenna.to_params(), ohm_per_square, from_mm(y_mm), ohm);
        let fabric = MetalSpec::Sheet { name: String::new(), ohm_per_square };
        (project.antenna.patch_metal, project.antenna.ground_metal) = (fabric.clone(), fabric);
        project.antenna.resistors.push(ResistorSpec { x_mm: 2.0, y_mm, ohm });
        let mesh = MeshSettings { density: Density::Coarse, metal: Metal::Sheet };
        let usual = SolveSettings::new(mesh, [7e9, 14e9]);
        let settings = SolveSettings { stop: StopRule::Decay { db: 40.0 }, pattern_freqs: vec![10.6e9], ..usual };
        let solved = solve(&project, Shape::Flat, &settings, None, &mut |_| (), &Task::default()).expect("it runs");
        let field = &solved.far_fields[0];
        let found = 1.0 / field.efficiency() - 1.0;
        // The current crowds at the patch's edges, which costs up to half as much again in the sheets.
        assert!((0.9..1.5).contains(&(found / expected)), "{found} against {expected}");
        let balance = field.near_balance().expect("power goes in");
        assert!((balance - 1.0).abs() < 0.005, "near power balance {balance}");
    }
}
