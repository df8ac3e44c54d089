//! `mesh`: tetrahedra for solvers, of a project's antenna in air or of any surface complex.

use super::args::MeshArgs;
use super::report::table;
use crate::geometry::bvh::Aabb;
use crate::geometry::{DVec3, RegionId};
use crate::io::vtu::CellField;
use crate::io::{msh, nastran, surface_json, vtu};
use crate::pipeline::{self, Density, MeshSettings};
use crate::project::file;
use crate::task::Task;
use crate::tet::{
    BIN_WIDTH, CellStatistics, QualityReport, RecoveryReport, RegionQuality, SizingSettings, TetMesh, WorstCell, fill,
    quality, tet_qualities,
};
use crate::units::to_mm;
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Smallest cells named.
const N_WORST: usize = 10;

/// A mesh by whichever way it was made.
struct Made {
    mesh: TetMesh,
    quality: QualityReport,
    recovery: RecoveryReport,
    /// Greatest distance from the smooth map, m, where there is one.
    map_distance: Option<f64>,
    seconds: f64,
}

pub(super) fn run(args: &MeshArgs, task: &Task) -> Result<()> {
    let made = match (&args.file, &args.surface) {
        (_, Some(path)) => mesh_surface(path, args.density.into(), task)?,
        (Some(path), None) => mesh_project(path, args, task)?,
        (None, None) => unreachable!("one of them is required"),
    };
    let files = args.out.as_deref().map(|dir| write(&made.mesh, dir)).transpose()?.unwrap_or_default();
    let report = Report::new(&made, &files);
    super::print(&if args.json { serde_json::to_string_pretty(&report)? } else { report.text() })
}

fn mesh_project(path: &Path, args: &MeshArgs, task: &Task) -> Result<Made> {
    let project = file::read(path)?;
    let settings = MeshSettings { density: args.density.into(), metal: args.metal.into() };
    let meshed = pipeline::mesh(&project, args.shape.into(), settings, task)
        .with_context(|| format!("meshing {}", path.display()))?;
    Ok(Made {
        mesh: meshed.mesh,
        quality: meshed.quality,
        recovery: meshed.recovery,
        map_distance: Some(meshed.map_distance),
        seconds: meshed.seconds,
    })
}

fn mesh_surface(path: &Path, density: Density, task: &Task) -> Result<Made> {
    let surface = surface_json::read_surface(path)?;
    let started = Instant::now();
    let filled = fill(&surface, &[], sizing(&surface.vertices, density), task)
        .with_context(|| format!("meshing {}", path.display()))?;
    Ok(Made {
        quality: quality(&filled.mesh, Some(&|p| filled.sizing.at(p).size), N_WORST),
        mesh: filled.mesh,
        recovery: filled.recovery,
        map_distance: None,
        seconds: started.elapsed().as_secs_f64(),
    })
}

/// Edges away from the surface: a part of the whole's extent, since a file of surfaces names no wavelength.
fn sizing(vertices: &[DVec3], density: Density) -> SizingSettings {
    let bounds = Aabb::around(vertices);
    let (parts, grading) = match density {
        Density::Coarse => (15.0, 0.5),
        Density::Default => (30.0, 0.35),
        Density::Fine => (50.0, 0.25),
    };
    SizingSettings { h_max: (bounds.hi - bounds.lo).max_element() / parts, grading }
}

/// Writes every format; returns the files.
fn write(mesh: &TetMesh, dir: &Path) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(dir).with_context(|| format!("making {}", dir.display()))?;
    let dihedral_deg: Vec<f64> = tet_qualities(mesh).iter().map(|q| q.dihedral_min.to_degrees()).collect();
    let fields = [CellField { name: "smallest_dihedral_deg", values: &dihedral_deg }];
    let files = ["mesh.msh", "mesh22.msh", "mesh.vtu", "mesh.nas"].map(|name| dir.join(name));
    msh::write(mesh, msh::MshVersion::V4_1, &files[0])?;
    msh::write(mesh, msh::MshVersion::V2_2, &files[1])?;
    vtu::write(mesh, &fields, &files[2])?;
    nastran::write(mesh, &files[3])?;
    Ok(files.into())
}

/// What `mesh --json` prints: angles in degrees, lengths in millimetres.
#[derive(Debug, Serialize)]
struct Report {
    tets: usize,
    vertices: usize,
    marked_faces: usize,
    seconds: f64,
    /// Greatest distance of the antenna's edges from the smooth map; null for a surface complex.
    map_distance_mm: Option<f64>,
    recovery: Recovery,
    whole: Cells,
    regions: Vec<Region>,
    /// Cells by their smallest dihedral angle, in bins of `histogram_bin_deg`.
    histogram_bin_deg: f64,
    histogram: Vec<usize>,
    worst: Vec<Worst>,
    files: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Recovery {
    missing_edges: usize,
    missing_facets: usize,
    helper_points: usize,
    halved_edges: usize,
}

#[derive(Debug, Serialize)]
struct Cells {
    tets: usize,
    dihedral_min_deg: f64,
    dihedral_1_percent_deg: f64,
    dihedral_max_deg: f64,
    inradius_min_mm: f64,
    inradius_1_percent_mm: f64,
    radius_ratio_min: f64,
    radius_ratio_mean: f64,
    /// Edge lengths over the wanted ones, mean and 95th percentile.
    edge_over_wanted_mean: Option<f64>,
    edge_over_wanted_95_percent: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Region {
    name: String,
    volume_mm3: f64,
    #[serde(flatten)]
    cells: Cells,
}

/// A cell that rules the time step.
#[derive(Debug, Serialize)]
struct Worst {
    tet: usize,
    region: String,
    at_mm: [f64; 3],
    inradius_mm: f64,
    dihedral_min_deg: f64,
    dihedral_max_deg: f64,
}

impl From<&CellStatistics> for Cells {
    fn from(c: &CellStatistics) -> Self {
        Self {
            tets: c.n_tets,
            dihedral_min_deg: c.dihedral_min.to_degrees(),
            dihedral_1_percent_deg: c.dihedral_p1.to_degrees(),
            dihedral_max_deg: c.dihedral_max.to_degrees(),
            inradius_min_mm: to_mm(c.inradius_min),
            inradius_1_percent_mm: to_mm(c.inradius_p1),
            radius_ratio_min: c.radius_ratio_min,
            radius_ratio_mean: c.radius_ratio_mean,
            edge_over_wanted_mean: c.edges.map(|e| e.mean),
            edge_over_wanted_95_percent: c.edges.map(|e| e.p95),
        }
    }
}

impl Report {
    fn new(made: &Made, files: &[PathBuf]) -> Self {
        let volumes = made.mesh.volumes();
        let name = |region: RegionId| made.mesh.regions[region.index()].name.clone();
        let worst = |w: &WorstCell| Worst {
            tet: w.tet,
            region: name(w.region),
            at_mm: w.at.to_array().map(to_mm),
            inradius_mm: to_mm(w.quality.inradius),
            dihedral_min_deg: w.quality.dihedral_min.to_degrees(),
            dihedral_max_deg: w.quality.dihedral_max.to_degrees(),
        };
        let region = |r: &RegionQuality| Region {
            name: r.name.clone(),
            volume_mm3: volumes[r.region.index()] * 1e9,
            cells: (&r.cells).into(),
        };
        Self {
            tets: made.mesh.tets.len(),
            vertices: made.mesh.vertices.len(),
            marked_faces: made.mesh.faces.len(),
            seconds: made.seconds,
            map_distance_mm: made.map_distance.map(to_mm),
            recovery: Recovery {
                missing_edges: made.recovery.n_missing_edges,
                missing_facets: made.recovery.n_missing_facets,
                helper_points: made.recovery.n_helpers,
                halved_edges: made.recovery.splits.len(),
            },
            whole: (&made.quality.whole).into(),
            regions: made.quality.regions.iter().map(region).collect(),
            histogram_bin_deg: BIN_WIDTH.to_degrees(),
            histogram: made.quality.whole.histogram.to_vec(),
            worst: made.quality.worst.iter().map(worst).collect(),
            files: files.iter().map(|f| f.display().to_string()).collect(),
        }
    }

    fn text(&self) -> String {
        let head = ["", "tets", "dihedral", "1 %", "largest", "inradius", "1 %", "volume"].map(str::to_owned).to_vec();
        let cells = |name: &str, c: &Cells, volume: Option<f64>| {
            vec![
                name.to_owned(),
                c.tets.to_string(),
                format!("{:.2} deg", c.dihedral_min_deg),
                format!("{:.2} deg", c.dihedral_1_percent_deg),
                format!("{:.2} deg", c.dihedral_max_deg),
                format!("{:.4} mm", c.inradius_min_mm),
                format!("{:.4} mm", c.inradius_1_percent_mm),
                volume.map(|v| format!("{v:.3} mm3")).unwrap_or_default(),
            ]
        };
        let regions = self.regions.iter().map(|r| cells(&r.name, &r.cells, Some(r.volume_mm3)));
        let rows: Vec<_> = [head, cells("all", &self.whole, None)].into_iter().chain(regions).collect();
        let recovery = &self.recovery;
        let mut lines = vec![
            table(&rows),
            String::new(),
            format!(
                "{} tetrahedra, {} vertices, {} marked faces, in {:.2} s",
                self.tets, self.vertices, self.marked_faces, self.seconds
            ),
            format!(
                "recovered     {} edges and {} facets, {} helper points, {} edges halved",
                recovery.missing_edges, recovery.missing_facets, recovery.helper_points, recovery.halved_edges
            ),
        ];
        let edges = self.whole.edge_over_wanted_mean.zip(self.whole.edge_over_wanted_95_percent);
        lines.extend(
            edges.map(|(mean, p95)| {
                format!("edge lengths  {mean:.2} of the wanted ones in the mean, 95 % below {p95:.2}")
            }),
        );
        lines.extend(self.map_distance_mm.map(|d| format!("smooth map    edges within {d:.4} mm of it")));
        lines.push("smallest cells, which rule the time step:".to_owned());
        lines.extend(self.worst.iter().take(5).map(|w| {
            let [x, y, z] = w.at_mm;
            format!(
                "  {} at ({x:.3}, {y:.3}, {z:.3}) mm: inradius {:.4} mm, dihedral angles {:.1} to {:.1} deg",
                w.region, w.inradius_mm, w.dihedral_min_deg, w.dihedral_max_deg
            )
        }));
        if !self.files.is_empty() {
            lines.push(format!("wrote         {}", self.files.join(", ")));
        }
        lines.join("\n")
    }
}
