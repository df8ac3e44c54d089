//! How good the cells of a mesh are: angles, inscribed spheres, shape, and edge lengths against a wanted size.
//!
//! A [`TetMesh`] enters, a [`QualityReport`] leaves; nothing is changed. Per cell:
//!
//! * dihedral angles from the outward face normals, by `atan2`, which keeps the digits of very small angles;
//! * inradius `r = 3V/A` with the signed volume V and the surface area A: the time step is in proportion to the
//!   smallest one;
//! * circumradius `R = ||a|²(b x c) + |b|²(c x a) + |c|²(a x b)| / 12V` with the edges a, b, c from one corner;
//! * radius ratio `3r/R`: 1 for the regular tetrahedron, 0 for a flat one.
//!
//! Percentiles interpolate between the two nearest values, as most programs do. Sums run over sorted values, so that
//! the order of the cells leaves no trace. NOT handled: whether the mesh is valid ([`TetMesh::check`]); an inverted
//! cell shows as a negative inradius.

use super::{Tet, TetMesh, volume};
use crate::geometry::{DVec3, RegionId, VertexId};
use rayon::prelude::*;
use std::fmt;

/// Width of a bin of [`CellStatistics::histogram`], rad: five degrees.
pub const BIN_WIDTH: f64 = std::f64::consts::PI / 36.0;
/// Number of bins: the smallest angle of a tetrahedron is at most that of the regular one, 70.5 degrees.
pub const N_BINS: usize = 15;

/// The six edges by the numbers of their corners.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Figures of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetQuality {
    /// Smallest dihedral angle, rad.
    pub dihedral_min: f64,
    /// Largest dihedral angle, rad.
    pub dihedral_max: f64,
    /// Radius of the inscribed sphere, m; negative for an inverted cell.
    pub inradius: f64,
    /// Three times the inradius over the circumradius: 1 regular, 0 flat, negative inverted.
    pub radius_ratio: f64,
    /// Shortest edge, m.
    pub edge_min: f64,
    /// Longest edge, m.
    pub edge_max: f64,
}

impl TetQuality {
    /// Measures a tetrahedron by its corners, m. Without volume the ratio is 0; no figure is ever NaN for finite corners.
    #[must_use]
    pub fn of(corners: [DVec3; 4]) -> Self {
        let [p, q, s, t] = corners;
        let [a, b, c] = [q - p, s - p, t - p];
        let volume = volume(corners);
        let normals = [(s - q).cross(t - q), c.cross(b), a.cross(c), b.cross(a)];
        let area: f64 = normals.iter().map(|n| n.length()).sum::<f64>() / 2.0;
        let inradius = if area > 0.0 { 3.0 * volume / area } else { 0.0 };
        let around =
            a.length_squared() * b.cross(c) + b.length_squared() * c.cross(a) + c.length_squared() * a.cross(b);
        let circumradius_12v = around.length();
        let radius_ratio = if circumradius_12v > 0.0 { 36.0 * inradius * volume.abs() / circumradius_12v } else { 0.0 };
        let (mut dihedral_min, mut dihedral_max) = (std::f64::consts::PI, 0.0_f64);
        let (mut edge_min, mut edge_max) = (f64::INFINITY, 0.0_f64);
        for [i, j] in EDGES {
            let angle = normals[i].cross(normals[j]).length().atan2(-normals[i].dot(normals[j]));
            dihedral_min = dihedral_min.min(angle);
            dihedral_max = dihedral_max.max(angle);
            let length = corners[i].distance(corners[j]);
            edge_min = edge_min.min(length);
            edge_max = edge_max.max(length);
        }
        Self { dihedral_min, dihedral_max, inradius, radius_ratio, edge_min, edge_max }
    }
}

/// Edge lengths over the sizes wanted at the edges' middles, each edge once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeFit {
    /// Number of edges.
    pub n_edges: usize,
    /// Mean of length over size.
    pub mean: f64,
    /// 95th percentile of length over size.
    pub p95: f64,
}

/// Figures of many cells.
#[derive(Clone, Debug, PartialEq)]
pub struct CellStatistics {
    /// Number of cells.
    pub n_tets: usize,
    /// Smallest dihedral angle, rad.
    pub dihedral_min: f64,
    /// First percentile of the cells' smallest dihedral angles, rad.
    pub dihedral_p1: f64,
    /// Largest dihedral angle, rad.
    pub dihedral_max: f64,
    /// Smallest inradius, m.
    pub inradius_min: f64,
    /// 0.1th percentile of the inradii, m.
    pub inradius_p01: f64,
    /// First percentile of the inradii, m.
    pub inradius_p1: f64,
    /// Smallest radius ratio.
    pub radius_ratio_min: f64,
    /// Mean radius ratio.
    pub radius_ratio_mean: f64,
    /// Cells by their smallest dihedral angle, in bins of [`BIN_WIDTH`] from 0.
    pub histogram: [usize; N_BINS],
    /// Edge lengths against the wanted size, where one was given.
    pub edges: Option<EdgeFit>,
}

/// Figures of the cells of one region.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionQuality {
    /// The region.
    pub region: RegionId,
    /// Its name.
    pub name: String,
    /// Its cells.
    pub cells: CellStatistics,
}

/// A cell that rules the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstCell {
    /// Its number.
    pub tet: usize,
    /// Its region.
    pub region: RegionId,
    /// Its center, m.
    pub at: DVec3,
    /// Its figures.
    pub quality: TetQuality,
}

/// Figures of a mesh. Its text is a table in degrees and millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityReport {
    /// Number of cells.
    pub n_tets: usize,
    /// Number of vertices.
    pub n_vertices: usize,
    /// All cells together.
    pub whole: CellStatistics,
    /// Each region that has cells, by number.
    pub regions: Vec<RegionQuality>,
    /// The cells with the smallest inradius, the smallest first.
    pub worst: Vec<WorstCell>,
}

/// Wanted edge length, m, at a place, m.
pub type SizeFn<'a> = &'a (dyn Fn(DVec3) -> f64 + Sync);

/// Figures of each cell, in the mesh's order.
#[must_use]
pub fn tet_qualities(mesh: &TetMesh) -> Vec<TetQuality> {
    (0..mesh.tets.len()).into_par_iter().map(|t| TetQuality::of(mesh.corners(t))).collect()
}

/// Measures a mesh.
///
/// * `size`: wanted edge length, m, to be compared with, where there is one.
/// * `n_worst`: how many of the smallest cells to name.
///
/// # Panics
/// If the mesh has no cells.
#[must_use]
pub fn quality(mesh: &TetMesh, size: Option<SizeFn<'_>>, n_worst: usize) -> QualityReport {
    assert!(!mesh.tets.is_empty(), "a mesh to be measured has cells");
    let qualities = tet_qualities(mesh);
    let all: Vec<usize> = (0..mesh.tets.len()).collect();
    let statistics = |cells: &[usize]| {
        let edges = size.map(|size| edge_fit(mesh, cells, size));
        CellStatistics { edges, ..cell_statistics(cells.iter().map(|&t| qualities[t])) }
    };
    let mut by_region = vec![Vec::new(); mesh.regions.len()];
    for (t, tet) in mesh.tets.iter().enumerate() {
        by_region[tet.region.index()].push(t);
    }
    let regions = by_region.iter().enumerate().filter(|(_, cells)| !cells.is_empty()).map(|(r, cells)| RegionQuality {
        region: RegionId::new(r),
        name: mesh.regions[r].name.clone(),
        cells: statistics(cells),
    });
    let regions = regions.collect();
    let mut smallest = all.clone();
    smallest.sort_by(|&s, &t| qualities[s].inradius.total_cmp(&qualities[t].inradius));
    let worst = |&tet: &usize| WorstCell {
        tet,
        region: mesh.tets[tet].region,
        at: mesh.corners(tet).iter().sum::<DVec3>() / 4.0,
        quality: qualities[tet],
    };
    QualityReport {
        n_tets: mesh.tets.len(),
        n_vertices: mesh.vertices.len(),
        whole: statistics(&all),
        regions,
        worst: smallest.iter().take(n_worst).map(worst).collect(),
    }
}

fn cell_statistics(cells: impl Iterator<Item = TetQuality> + Clone) -> CellStatistics {
    let sorted = |figure: fn(TetQuality) -> f64| {
        let mut values: Vec<f64> = cells.clone().map(figure).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let dihedrals = sorted(|q| q.dihedral_min);
    let inradii = sorted(|q| q.inradius);
    let ratios = sorted(|q| q.radius_ratio);
    let mut histogram = [0; N_BINS];
    for &angle in &dihedrals {
        histogram[bin(angle)] += 1;
    }
    CellStatistics {
        n_tets: dihedrals.len(),
        dihedral_min: dihedrals[0],
        dihedral_p1: percentile(&dihedrals, 0.01),
        dihedral_max: cells.map(|q| q.dihedral_max).fold(0.0, f64::max),
        inradius_min: inradii[0],
        inradius_p01: percentile(&inradii, 0.001),
        inradius_p1: percentile(&inradii, 0.01),
        radius_ratio_min: ratios[0],
        radius_ratio_mean: mean(&ratios),
        histogram,
        edges: None,
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an angle of 0 to pi is in bin 0 to 36")]
fn bin(angle: f64) -> usize {
    ((angle / BIN_WIDTH) as usize).min(N_BINS - 1)
}

fn edge_fit(mesh: &TetMesh, cells: &[usize], size: SizeFn<'_>) -> EdgeFit {
    let ends = |tet: &Tet| EDGES.map(|e| e.map(|k| tet.vertices[k])).map(|[a, b]| (a.min(b), a.max(b)));
    let mut edges: Vec<(VertexId, VertexId)> = cells.iter().flat_map(|&t| ends(&mesh.tets[t])).collect();
    edges.par_sort_unstable();
    edges.dedup();
    let ratio = |&(a, b): &(VertexId, VertexId)| {
        let (a, b) = (mesh.vertices[a.index()], mesh.vertices[b.index()]);
        a.distance(b) / size(a.midpoint(b))
    };
    let mut ratios: Vec<f64> = edges.par_iter().map(ratio).collect();
    ratios.par_sort_unstable_by(f64::total_cmp);
    EdgeFit { n_edges: edges.len(), mean: mean(&ratios), p95: percentile(&ratios, 0.95) }
}

#[allow(clippy::cast_precision_loss, reason = "counts below 2^53")]
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The value below which the part `p` of the sorted values lies, linear between neighbors.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place in an array of fewer than 2^53 elements"
)]
fn percentile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let below = place as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

impl fmt::Display for QualityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} tetrahedra, {} vertices", self.n_tets, self.n_vertices)?;
        writeln!(f, "dihedral angles in degrees (least, 1 %, most), inradius in mm (least, 0.1 %, 1 %), radius ratio")?;
        let rows = std::iter::once(("all", &self.whole)).chain(self.regions.iter().map(|r| (&*r.name, &r.cells)));
        for (name, s) in rows {
            let [least, p1, most] = [s.dihedral_min, s.dihedral_p1, s.dihedral_max].map(f64::to_degrees);
            let [r, r01, r1] = [s.inradius_min, s.inradius_p01, s.inradius_p1].map(|r| r * 1e3);
            write!(f, "{name:<16} {:>8}  {least:6.2} {p1:6.2} {most:6.2}  {r:.4} {r01:.4} {r1:.4}", s.n_tets)?;
            write!(f, "  {:.3} least {:.3} mean", s.radius_ratio_min, s.radius_ratio_mean)?;
            if let Some(e) = s.edges {
                write!(f, "  edge / wanted {:.3} mean {:.3} 95 %", e.mean, e.p95)?;
            }
            writeln!(f)?;
        }
        for cell in &self.worst {
            let (at, q) = (cell.at * 1e3, cell.quality);
            let [least, most] = [q.dihedral_min, q.dihedral_max].map(f64::to_degrees);
            write!(f, "cell {} in region {} at ({:.4}, {:.4}, {:.4}) mm:", cell.tet, cell.region, at.x, at.y, at.z)?;
            writeln!(f, " inradius {:.4} mm, dihedral angles {least:.2} to {most:.2}", q.inradius * 1e3)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Region, RegionRole};

    /// Edge length sqrt 8.
    const REGULAR: [DVec3; 4] = [
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ];
    const CORNER: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];

    fn close(found: f64, expected: f64, what: &str) {
        assert!((found - expected).abs() < 1e-14 * expected.abs().max(1.0), "{what}: {found} is not {expected}");
    }

    fn random_tet(rng: &mut fastrand::Rng) -> [DVec3; 4] {
        let corners = [(); 4].map(|()| DVec3::new(rng.f64(), rng.f64(), rng.f64()));
        let [a, b, c, d] = corners;
        if volume(corners) > 0.0 { corners } else { [b, a, c, d] }
    }

    fn mesh(cells: &[([DVec3; 4], usize)]) -> TetMesh {
        let region = |name: &str| Region { name: name.into(), role: RegionRole::Air, eps_r: 1.0, tan_delta: 0.0 };
        let tet = |(t, (_, region)): (usize, &([DVec3; 4], usize))| Tet {
            vertices: [0, 1, 2, 3].map(|k| VertexId::new(4 * t + k)),
            region: RegionId::new(*region),
        };
        TetMesh {
            vertices: cells.iter().flat_map(|c| c.0).collect(),
            tets: cells.iter().enumerate().map(tet).collect(),
            faces: Vec::new(),
            regions: ["outside", "a", "b", "c"].map(region).to_vec(),
            groups: Vec::new(),
        }
    }

    #[test]
    fn the_regular_tetrahedron_has_its_closed_forms() {
        let q = TetQuality::of(REGULAR);
        let edge = 8.0_f64.sqrt();
        close(q.dihedral_min, (1.0_f64 / 3.0).acos(), "smallest angle");
        close(q.dihedral_max, (1.0_f64 / 3.0).acos(), "largest angle");
        close(q.inradius, edge * 6.0_f64.sqrt() / 12.0, "inradius");
        close(q.radius_ratio, 1.0, "ratio");
        close(q.edge_min, edge, "shortest edge");
        close(q.edge_max, edge, "longest edge");
    }

    #[test]
    fn the_corner_of_a_cube_has_its_closed_forms() {
        let q = TetQuality::of(CORNER);
        let inradius = 1.0 / (3.0 + 3.0_f64.sqrt());
        close(q.dihedral_min, (1.0 / 3.0_f64.sqrt()).acos(), "at the slanted face");
        close(q.dihedral_max, std::f64::consts::FRAC_PI_2, "at the three edges of the corner");
        close(q.inradius, inradius, "inradius");
        close(q.radius_ratio, 3.0 * inradius / (3.0_f64.sqrt() / 2.0), "circumradius sqrt 3 / 2");
        close(q.edge_max, 2.0_f64.sqrt(), "longest edge");
    }

    #[test]
    fn slivers_tend_to_zero_and_flat_cells_are_zero() {
        let sliver = |h: f64| [DVec3::X, DVec3::Y + h * DVec3::Z, -DVec3::X, h * DVec3::Z - DVec3::Y];
        let mut last = TetQuality::of(REGULAR);
        for k in 1..14 {
            let h = 10_f64.powi(-k);
            let q = TetQuality::of(sliver(h));
            assert!(q.radius_ratio.abs() < last.radius_ratio.abs(), "ratio falls at height {h}");
            assert!(q.dihedral_min < last.dihedral_min && q.dihedral_max > last.dihedral_max, "angles at height {h}");
            last = q;
        }
        assert!(last.radius_ratio.abs() < 1e-12 && last.dihedral_min < 1e-12, "{last:?}");
        let point = [DVec3::X; 4];
        let line = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X, 3.0 * DVec3::X];
        for flat in [sliver(0.0), line, point] {
            let q = TetQuality::of(flat);
            assert!(q.inradius.abs() <= 0.0 && q.radius_ratio.abs() <= 0.0, "no volume, no radius: {q:?}");
            assert!(!q.dihedral_min.is_nan() && !q.dihedral_max.is_nan(), "never NaN: {q:?}");
        }
    }

    #[test]
    fn the_order_of_the_corners_and_the_place_do_not_matter() {
        let mut rng = fastrand::Rng::with_seed(11);
        for case in 0..2000 {
            let corners = random_tet(&mut rng);
            let q = TetQuality::of(corners);
            let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, rng.f64(), rng.f64(), rng.f64());
            let scale = 1e-3;
            let [a, b, c, d] = corners.map(|p| turn * p * scale);
            // Rounding in the volume comes back in the angles of flat cells divided by their ratio.
            let tolerance = 1e-13 / q.radius_ratio;
            for moved in [[a, b, c, d], [b, c, a, d], [b, a, d, c], [d, c, b, a]] {
                let m = TetQuality::of(moved);
                let pairs = [
                    (m.dihedral_min, q.dihedral_min),
                    (m.dihedral_max, q.dihedral_max),
                    (m.inradius / scale, q.inradius),
                    (m.radius_ratio, q.radius_ratio),
                    (m.edge_min / scale, q.edge_min),
                    (m.edge_max / scale, q.edge_max),
                ];
                for (found, expected) in pairs {
                    assert!((found - expected).abs() < tolerance, "case {case}: {found} is not {expected}");
                }
            }
            let mirrored = TetQuality::of([b, a, c, d]);
            assert!(mirrored.inradius < 0.0 && mirrored.radius_ratio < 0.0, "case {case}: inverted shows");
            assert!((0.0..1.0 + 1e-12).contains(&q.radius_ratio), "case {case}: ratio {}", q.radius_ratio);
        }
    }

    #[test]
    fn the_order_of_the_cells_does_not_matter() {
        let mut rng = fastrand::Rng::with_seed(12);
        let mut cells: Vec<_> = (0..500).map(|i| (random_tet(&mut rng), 1 + 2 * (i % 2))).collect();
        let size = |p: DVec3| 0.5 + p.x;
        let report = quality(&mesh(&cells), Some(&size), 7);
        rng.shuffle(&mut cells);
        let shuffled = quality(&mesh(&cells), Some(&size), 7);
        assert_eq!(report.whole, shuffled.whole, "bit for bit");
        assert_eq!(report.regions, shuffled.regions, "bit for bit");
        assert_eq!(report.regions.iter().map(|r| &*r.name).collect::<Vec<_>>(), ["a", "c"], "those with cells");
        let figures = |r: &QualityReport| r.worst.iter().map(|w| (w.at, w.quality)).collect::<Vec<_>>();
        assert_eq!(figures(&report), figures(&shuffled), "the same worst cells");
    }

    #[test]
    fn a_report_counts_what_is_there() {
        let small = CORNER.map(|p| p * 0.5 + DVec3::Z);
        let mesh = mesh(&[(REGULAR, 1), (small, 2), (CORNER, 2)]);
        let report = quality(&mesh, Some(&|_| 2.0), 2);
        assert_eq!((report.n_tets, report.n_vertices), (3, 12), "counts");
        assert_eq!(report.whole.histogram.iter().sum::<usize>(), 3, "each cell in a bin");
        assert_eq!((report.whole.histogram[14], report.whole.histogram[10]), (1, 2), "70.5 and 54.7 degrees");
        assert_eq!(report.worst.iter().map(|w| w.tet).collect::<Vec<_>>(), [1, 2], "smallest inradius first");
        close(report.worst[0].at.z, 1.125, "center of the smallest");
        let fit = report.regions[0].cells.edges.unwrap();
        assert_eq!(fit.n_edges, 6, "each edge once");
        close(fit.mean, 2.0_f64.sqrt(), "edges of sqrt 8 where 2 is wanted");
        let text = report.to_string();
        assert!(text.contains("54.74") && text.contains("70.53"), "degrees in the text:\n{text}");
    }

    #[test]
    fn percentiles_interpolate() {
        close(percentile(&[1.0, 2.0, 4.0], 0.75), 3.0, "between the last two");
        close(percentile(&[7.0], 0.01), 7.0, "of one value");
    }
}
