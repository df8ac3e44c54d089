//! Any surface complex is filled, or refused with places: random nested boxes and ellipsoids, shared walls, sheets.
//!
//! Ten complexes in a plain test run; all hundred with
//! `CAMPAIGN=full cargo test --release --test fill -- --nocapture`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use conformant::geometry::{DMat3, DQuat, DVec3, Region, RegionId, RegionRole, VertexId};
use conformant::task::Task;
use conformant::tet::{
    FaceGroup, FaceRole, Filled, SizingSettings, Surface, SurfaceFacet, TetError, face_key, fill, quality,
};
use std::collections::{HashMap, HashSet};

const SETTINGS: SizingSettings = SizingSettings { h_max: 5e-3, grading: 0.4 };

fn is_full_campaign() -> bool {
    std::env::var("CAMPAIGN").is_ok_and(|c| c == "full")
}

/// A closed outward surface.
#[derive(Clone)]
struct Shell {
    points: Vec<DVec3>,
    faces: Vec<[usize; 3]>,
}

impl Shell {
    /// The box from -1 to 1 with n x n quads a side.
    fn cube(n: usize) -> Self {
        let mut names = HashMap::new();
        let mut shell = Self { points: Vec::new(), faces: Vec::new() };
        for axis in 0..3 {
            for side in [0, n] {
                let mut id = |i: usize, j: usize| {
                    let mut place = [0; 3];
                    (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (side, i, j);
                    *names.entry(place).or_insert_with(|| {
                        shell.points.push(DVec3::from_array(place.map(|k| 2.0 * k as f64 / n as f64 - 1.0)));
                        shell.points.len() - 1
                    })
                };
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let quad = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
                    let halves = [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]];
                    shell.faces.extend(halves.map(|[a, b, c]| if side == 0 { [a, c, b] } else { [a, b, c] }));
                }
            }
        }
        shell
    }

    /// The unit ball's surface.
    fn ball(n: usize) -> Self {
        let mut shell = Self::cube(n);
        // Evenly spaced angles make triangles of nearly equal size.
        let even = |x: f64| (x * std::f64::consts::FRAC_PI_4).tan();
        shell.points.iter_mut().for_each(|p| *p = p.map(even).try_normalize().unwrap());
        shell
    }

    fn moved(mut self, matrix: DMat3, shift: DVec3) -> Self {
        self.points.iter_mut().for_each(|p| *p = matrix * *p + shift);
        self
    }
}

fn region(name: &str) -> Region {
    Region { name: name.to_owned(), role: RegionRole::Dielectric, eps_r: 2.0, tan_delta: 0.0 }
}

/// Shells inside each other or apart, each with the region outside and inside of it.
fn surface(shells: &[(Shell, usize, usize)], n_regions: usize) -> Surface {
    let mut vertices = Vec::new();
    let mut facets = Vec::new();
    for (shell, outside, inside) in shells {
        let first = vertices.len();
        vertices.extend(&shell.points);
        facets.extend(shell.faces.iter().map(|f| SurfaceFacet {
            vertices: f.map(|v| VertexId::new(first + v)),
            back: RegionId::new(*inside),
            front: RegionId::new(*outside),
            group: (*outside == 0).then_some(0),
        }));
    }
    let names = (0..n_regions).map(|r| region(&format!("region {r}")));
    let groups = vec![FaceGroup { name: "outer".to_owned(), role: FaceRole::Outer }];
    Surface { vertices, facets, regions: names.collect(), groups }
}

/// Checks everything that a filled surface promises.
fn assert_filled(surface: &Surface, filled: &Filled, what: &str) {
    assert_eq!(filled.mesh.check(), Ok(()), "{what}");
    let faces: HashSet<_> = filled.mesh.tets.iter().flat_map(|t| (0..4).map(|i| face_key(t.face(i)))).collect();
    let n_present = filled.facets.iter().filter(|f| faces.contains(&face_key(f.vertices))).count();
    assert_eq!(n_present, filled.facets.len(), "{what}: every facet is a face");
    assert!(filled.facets.len() >= surface.facets.len(), "{what}: no facet is dropped");
    let is_filled = |r: usize| r > 0 && surface.regions[r].role != RegionRole::Conductor && surface.volumes()[r] > 0.0;
    for (r, (found, wanted)) in filled.mesh.volumes().iter().zip(surface.volumes()).enumerate() {
        if !is_filled(r) {
            assert!(*found <= 0.0, "{what}: region {r} has cells");
            continue;
        }
        assert!((found / wanted - 1.0).abs() < 1e-12, "{what}: region {r} has {found:e} m3 instead of {wanted:e}");
    }
}

fn random_matrix(rng: &mut fastrand::Rng) -> DMat3 {
    let axis = DVec3::new(rng.f64() - 0.5, rng.f64() - 0.5, rng.f64() - 0.5).try_normalize().unwrap_or(DVec3::X);
    let turn = DMat3::from_quat(DQuat::from_axis_angle(axis, rng.f64() * 3.0));
    turn * DMat3::from_diagonal(DVec3::new(0.6 + rng.f64(), 0.6 + rng.f64(), 0.6 + rng.f64()))
}

/// Two to four shells within each other, boxes and ellipsoids in turn, each turned and off center.
fn nested(seed: u64) -> Surface {
    let mut rng = fastrand::Rng::with_seed(seed);
    let n_shells = rng.usize(2..5);
    let mut shells = Vec::new();
    let mut size = 15e-3;
    let mut center = DVec3::ZERO;
    for s in 0..n_shells {
        let shell = if rng.bool() { Shell::cube(rng.usize(3..9)) } else { Shell::ball(rng.usize(3..8)) };
        shells.push((shell.moved(random_matrix(&mut rng) * size, center), s, s + 1));
        // The least half axis of the next outer one is 0.6, the greatest of a box's corners 1.6 sqrt(3).
        size *= 0.6 / 2.8 * (0.9 - 0.5 * rng.f64());
        center += DVec3::new(rng.f64() - 0.5, rng.f64() - 0.5, rng.f64() - 0.5) * (0.1 * size);
    }
    surface(&shells, n_shells + 1)
}

#[test]
fn nested_boxes_and_ellipsoids_are_filled() {
    let n = if is_full_campaign() { 100 } else { 10 };
    let mut worst = f64::INFINITY;
    for seed in 0..n {
        let surface = nested(seed);
        let filled = fill(&surface, &[], SETTINGS, &Task::default());
        let filled = filled.unwrap_or_else(|error| panic!("complex {seed}: {error}"));
        assert_filled(&surface, &filled, &format!("complex {seed}"));
        let report = quality(&filled.mesh, None, 1);
        worst = worst.min(report.whole.dihedral_min.to_degrees());
    }
    println!("{n} complexes, smallest dihedral angle {worst:.2} degrees");
    assert!(worst > 1.0, "smallest dihedral angle {worst} degrees");
}

/// Two cubes that share a wall, in a ball, with a conducting sheet in the air beside them.
fn neighbors_and_sheet() -> Surface {
    let n = 4;
    let left = Shell::cube(n).moved(DMat3::from_diagonal(DVec3::splat(2e-3)), DVec3::new(-2e-3, 0.0, 0.0));
    let right = Shell::cube(n).moved(DMat3::from_diagonal(DVec3::splat(2e-3)), DVec3::new(2e-3, 0.0, 0.0));
    let ball = Shell::ball(6).moved(DMat3::from_diagonal(DVec3::splat(12e-3)), DVec3::ZERO);
    let mut whole = surface(&[(ball, 0, 1), (left, 1, 2), (right, 1, 3)], 4);
    // Weld the wall: coinciding points become one, the doubled facets one between both cubes.
    #[allow(clippy::cast_possible_truncation, reason = "a few million nanometres")]
    let key = |p: DVec3| p.to_array().map(|x| (x * 1e9).round() as i64);
    let mut first = HashMap::new();
    let number: Vec<usize> =
        whole.vertices.iter().enumerate().map(|(v, &p)| *first.entry(key(p)).or_insert(v)).collect();
    let mut seen: HashMap<[VertexId; 3], usize> = HashMap::new();
    let mut facets: Vec<SurfaceFacet> = Vec::new();
    for facet in &whole.facets {
        let welded = SurfaceFacet { vertices: facet.vertices.map(|v| VertexId::new(number[v.index()])), ..*facet };
        match seen.get(&face_key(welded.vertices)) {
            Some(&other) => facets[other].front = welded.back,
            None => {
                seen.insert(face_key(welded.vertices), facets.len());
                facets.push(welded);
            }
        }
    }
    // A square of conductor that hangs in the air.
    let sheet = whole.groups.len();
    whole.groups.push(FaceGroup { name: "pec".to_owned(), role: FaceRole::Conductor });
    let corner = whole.vertices.len();
    whole
        .vertices
        .extend([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 3.0) * 1e-3));
    for triple in [[0, 1, 2], [0, 2, 3]] {
        let air = RegionId::new(1);
        let vertices = triple.map(|k| VertexId::new(corner + k));
        facets.push(SurfaceFacet { vertices, back: air, front: air, group: Some(sheet) });
    }
    whole.facets = facets;
    whole
}

/// Leaves out vertices that no facet uses.
fn compact(surface: Surface) -> Surface {
    let mut used: Vec<VertexId> = surface.facets.iter().flat_map(|f| f.vertices).collect();
    used.sort_unstable();
    used.dedup();
    let number: HashMap<_, _> = used.iter().enumerate().map(|(k, v)| (*v, VertexId::new(k))).collect();
    let facets = surface.facets.iter().map(|f| SurfaceFacet { vertices: f.vertices.map(|v| number[&v]), ..*f });
    Surface {
        vertices: used.iter().map(|v| surface.vertices[v.index()]).collect(),
        facets: facets.collect(),
        ..surface
    }
}

#[test]
fn regions_share_their_wall_and_sheets_hang_in_one_region() {
    let surface = compact(neighbors_and_sheet());
    let filled = fill(&surface, &[], SETTINGS, &Task::default()).unwrap();
    assert_filled(&surface, &filled, "two cubes and a sheet");
    let on_sheet = filled.mesh.faces.iter().filter(|f| f.group == 1).count();
    assert!(on_sheet >= 2, "the sheet is marked, {on_sheet} faces");
}

/// Smallest dihedral angle (degrees), cells, and smallest inradius (mm) that gmsh's HXT reached on a golden surface.
fn peer(name: &str) -> (f64, f64, f64) {
    let table = std::fs::read_to_string("tests/golden/mesh/peers.csv").unwrap();
    let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |key: &str| head.iter().position(|h| *h == key).unwrap();
    let row = table.lines().find(|l| l.starts_with(&format!("gmsh_hxt,{name},"))).unwrap();
    let value = |key: &str| row.split(',').nth(column(key)).unwrap().parse::<f64>().unwrap();
    (value("mindih"), value("ntet"), value("minrin"))
}

#[test]
fn the_golden_surfaces_are_meshed_better_than_by_their_best_peer() {
    let settings = SizingSettings { h_max: 2e-3, grading: 0.35 };
    for (name, cells_allowed) in [("flat_A", 1.5), ("R10_A", 1.5), ("R6.5_C", 1.3)] {
        let path = format!("tests/golden/mesh/{name}.json.gz");
        let surface = conformant::io::surface_json::read_surface(std::path::Path::new(&path)).unwrap();
        let filled = fill(&surface, &[], settings, &Task::default()).unwrap();
        assert_filled(&surface, &filled, name);
        let whole = quality(&filled.mesh, None, 1).whole;
        let (dihedral_deg, n_tets, inradius_mm) = peer(name);
        let cost = whole.n_tets as f64 / (whole.inradius_min * 1e3);
        let found_deg = whole.dihedral_min.to_degrees();
        println!("{name}: {found_deg:.2} degrees against {dihedral_deg:.2}, cost {:.2}", cost / (n_tets / inradius_mm));
        assert!(found_deg > dihedral_deg, "{name}: {found_deg} degrees, the peer {dihedral_deg}");
        assert!(cost < cells_allowed * n_tets / inradius_mm, "{name}: {} cells at {cost}", whole.n_tets);
    }
}

#[test]
fn crossing_surfaces_are_refused_with_places() {
    let ball = Shell::ball(5).moved(DMat3::from_diagonal(DVec3::splat(10e-3)), DVec3::ZERO);
    let inner = Shell::ball(4).moved(DMat3::from_diagonal(DVec3::splat(3e-3)), DVec3::X * 8e-3);
    let error = fill(&surface(&[(ball, 0, 1), (inner, 1, 2)], 3), &[], SETTINGS, &Task::default()).unwrap_err();
    assert!(matches!(error, TetError::Crossing { .. }) && !error.places().is_empty(), "{error}");
}

#[test]
fn a_hole_in_a_surface_is_refused_with_its_place() {
    let ball = Shell::ball(5).moved(DMat3::from_diagonal(DVec3::splat(10e-3)), DVec3::ZERO);
    let mut inner = Shell::ball(4).moved(DMat3::from_diagonal(DVec3::splat(3e-3)), DVec3::ZERO);
    inner.faces.remove(7);
    let error = fill(&surface(&[(ball, 0, 1), (inner, 1, 2)], 3), &[], SETTINGS, &Task::default()).unwrap_err();
    assert!(matches!(error, TetError::Leak { .. }) && !error.places().is_empty(), "{error}");
}

#[test]
fn the_same_surface_gives_the_same_bits_on_any_number_of_threads() {
    let surface = nested(3);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&surface, &[], SETTINGS, &Task::default()).unwrap())
    };
    assert_eq!(run(1), run(3), "one and three threads");
}

#[test]
fn a_cancelled_task_ends_soon() {
    let task = Task::default();
    task.cancel();
    let error = fill(&nested(1), &[], SETTINGS, &task).unwrap_err();
    assert!(matches!(error, TetError::Cancelled(_)), "{error}");
}
