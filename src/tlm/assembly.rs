//! A mesh as the field sees it: cells in their final order, which ports are live, materials, boundaries, loads.

use super::TlmError;
use super::blocks::{A_INVERSE, ADMITTANCE, LOSS, triangle};
use super::cell::{Cell, EDGES, face_mass};
use super::loads::{Loads, LumpedPort, Resistor};
use super::network::NetworkSettings;
use super::outgoing::OuterSphere;
use super::port::PortMode;
use super::sheet_edge;
use crate::geometry::{DVec3, VertexId};
use crate::tet::{FaceRole, TetMesh, face_key};
use crate::units::{C0, ETA0};
use nalgebra::{DMatrix, Matrix3, Matrix3xX, Matrix6};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

/// Parts that the cells fall into: without boundary faces, at the port, and at the outer boundary by the place of the outer
/// face among the four, or with several, so that neighbors in a block have the same edges there.
const WITHIN: u8 = 0;
const AT_PORT: u8 = 1;
const AT_OUTER: u8 = 2;
pub(super) const N_PARTS: usize = 7;

/// A mesh prepared for assembly: cells in their final order, vertices ascending.
pub(super) struct Assembly<'a> {
    mesh: &'a TetMesh,
    /// Cells: corners ascending, and the number in the mesh.
    pub(super) cells: Vec<([VertexId; 4], usize)>,
    /// Where the cells of each part end, by its number.
    pub(super) ends: [usize; N_PARTS],
    faces: BoundaryFaces,
    loads: Loads,
    /// Vertices at the edges of sheets, where the field is singular; empty without correction.
    rim: HashSet<VertexId>,
    loss_freq: f64,
}

/// What the marked faces mean.
struct BoundaryFaces {
    conducting: HashSet<[VertexId; 2]>,
    /// The port, if the mesh has one.
    port: Option<Port>,
    outer: HashSet<[VertexId; 3]>,
    /// Conductance of lossy sheets along each of their edges, in units of the free-space admittance.
    sheets: HashMap<[VertexId; 2], f64>,
}

struct Port {
    mode: PortMode,
    /// Its edges, and the region behind it, in which they are live.
    edges: HashSet<[VertexId; 2]>,
    region: usize,
    /// By face: place in `mode.faces`.
    faces: HashMap<[VertexId; 3], usize>,
}

fn edges_of([a, b, c]: [VertexId; 3]) -> [[VertexId; 2]; 3] {
    [[a, b], [a, c], [b, c]]
}

/// Conductances along the edges 01, 02 and 12 of a triangle that is a sheet of unit conductance per square: half the
/// cotangents of the angles opposite to them, which lose what the sheet does in any constant field.
///
/// They stand at the edges of the mesh, where the currents of all cells around meet, like resistors: shared out among
/// the cells they would be fed by each cell's own current, whose parts that cancel at the edge would be lost too.
fn edge_shares([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let half_cotangent = |at: DVec3, p: DVec3, q: DVec3| {
        let (u, v) = (p - at, q - at);
        0.5 * u.dot(v) / u.cross(v).length()
    };
    [half_cotangent(c, a, b), half_cotangent(b, a, c), half_cotangent(a, b, c)]
}

/// The faces of a role, corners ascending.
fn faces_with(mesh: &TetMesh, role: FaceRole) -> impl Iterator<Item = [VertexId; 3]> {
    mesh.faces.iter().filter(move |f| mesh.groups[f.group].role == role).map(|f| face_key(f.vertices))
}

impl BoundaryFaces {
    fn new(mesh: &TetMesh, loads: &Loads) -> Result<Self, TlmError> {
        let resistance = |group: usize| loads.sheet_resistance(&mesh.groups[group].name);
        let conductors = || mesh.faces.iter().filter(|f| mesh.groups[f.group].role == FaceRole::Conductor);
        let perfect = conductors().filter(|f| resistance(f.group).is_none());
        let lossy = conductors().filter_map(|f| Some((face_key(f.vertices), ETA0 / resistance(f.group)?)));
        let mut sheets: HashMap<[VertexId; 2], f64> = HashMap::new();
        for (face, conductance) in lossy {
            for (edge, share) in edges_of(face).into_iter().zip(edge_shares(face.map(|v| mesh.vertices[v.index()]))) {
                *sheets.entry(edge).or_default() += share * conductance;
            }
        }
        // Negative where the triangles at an edge have wide angles opposite to it: nothing passive.
        sheets.retain(|_, conductance| *conductance > 0.0);
        Ok(Self {
            conducting: perfect.flat_map(|f| edges_of(face_key(f.vertices))).collect(),
            port: Port::new(mesh, loads)?,
            outer: faces_with(mesh, FaceRole::Outer).collect(),
            sheets,
        })
    }

    /// The part that a cell belongs to.
    fn part(&self, corners: [VertexId; 4], region: usize) -> u8 {
        let faces = faces_of(corners).map(|(_, face)| face);
        if faces.iter().any(|f| self.port_face(*f, region).is_some()) {
            return AT_PORT;
        }
        let mut outer = (AT_OUTER..).zip(&faces).filter(|(_, f)| self.outer.contains(*f)).map(|(part, _)| part);
        match (outer.next(), outer.next()) {
            (None, _) => WITHIN,
            (Some(part), None) => part,
            (Some(_), Some(_)) => AT_OUTER + 4,
        }
    }

    /// The port with the place of a face in it, if the face is one of its and the region lies behind it.
    fn port_face(&self, face: [VertexId; 3], region: usize) -> Option<(&PortMode, usize)> {
        let port = self.port.as_ref().filter(|p| p.region == region)?;
        Some((&port.mode, *port.faces.get(&face)?))
    }
}

impl Port {
    fn new(mesh: &TetMesh, loads: &Loads) -> Result<Option<Self>, TlmError> {
        let keys: Vec<[VertexId; 3]> = faces_with(mesh, FaceRole::Port).collect();
        let (Some(first), Some(marked)) =
            (keys.first(), mesh.faces.iter().find(|f| mesh.groups[f.group].role == FaceRole::Port))
        else {
            return Ok(None);
        };
        // The cell behind a face sees its corners as the mark lists them.
        let same = |f: [VertexId; 3]| (0..3).any(|k| f == [0, 1, 2].map(|i| marked.vertices[(i + k) % 3]));
        let behind = mesh.tets.iter().find(|t| (0..4).any(|i| face_key(t.face(i)) == *first && same(t.face(i))));
        let region = behind.ok_or(TlmError::NoPort)?.region;
        let admittance = (mesh.regions[region.index()].eps_r / loads.mu_r(region)).sqrt();
        let mode = PortMode::new(&keys, &mesh.vertices, admittance, &mesh.groups[marked.group].name)?;
        Ok(Some(Self {
            edges: keys.iter().copied().flat_map(edges_of).collect(),
            region: region.index(),
            faces: mode.faces.iter().enumerate().map(|(k, f)| (f.vertices, k)).collect(),
            mode,
        }))
    }
}

/// Adds a face's matrix to that of its cell's ports.
///
/// * `places`: of the face's edges among the ports.
fn add_face(to: &mut Matrix6<f64>, places: [usize; 3], matrix: &Matrix3<f64>) {
    for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
        to[(places[a], places[b])] += matrix[(a, b)];
    }
}

/// The four faces of ascending corners with the places of their edges among the six.
fn faces_of(c: [VertexId; 4]) -> [([usize; 3], [VertexId; 3]); 4] {
    [
        ([3, 4, 5], [c[1], c[2], c[3]]),
        ([1, 2, 5], [c[0], c[2], c[3]]),
        ([0, 2, 4], [c[0], c[1], c[3]]),
        ([0, 1, 3], [c[0], c[1], c[2]]),
    ]
}

/// The numbers of a cell's lane: coefficients, and conductances where its block has boundary faces.
pub(super) struct LaneTerms {
    pub(super) coefficients: [f64; 34],
    pub(super) conductance: [f64; 21],
}

impl<'a> Assembly<'a> {
    pub(super) fn new(mesh: &'a TetMesh, settings: &NetworkSettings) -> Result<Self, TlmError> {
        let NetworkSettings { loads, edge_correction, loss_freq, .. } = settings;
        let faces = BoundaryFaces::new(mesh, loads)?;
        let (lo, hi) =
            mesh.vertices.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let scale = 1023.0 / (hi - lo).max_element();
        let mut keyed: Vec<(u8, u32, usize)> = (0..mesh.tets.len())
            .into_par_iter()
            .map(|t| {
                let tet = &mesh.tets[t];
                let part = faces.part(ascending(tet.vertices), tet.region.index());
                (part, morton((center(mesh, t) - lo) * scale), t)
            })
            .collect();
        keyed.par_sort_unstable();
        let ends = std::array::from_fn(|part| keyed.partition_point(|k| usize::from(k.0) <= part));
        let cells: Vec<([VertexId; 4], usize)> =
            keyed.into_iter().map(|(_, _, t)| (ascending(mesh.tets[t].vertices), t)).collect();
        let rim = if *edge_correction { sheet_edge::rim(mesh) } else { HashSet::new() };
        Ok(Self { mesh, cells, ends, faces, loads: loads.clone(), rim, loss_freq: *loss_freq })
    }

    /// The outer boundary with the waves that leave there; `None` if it is no sphere in air, or no waves are wanted.
    ///
    /// * `degrees`: of the waves.
    pub(super) fn outer_sphere(&self, degrees: usize) -> Option<OuterSphere> {
        let is_air = |&(_, tet): &(_, usize)| {
            let region = self.mesh.tets[tet].region;
            (self.mesh.regions[region.index()].eps_r, self.loads.mu_r(region)) == (1.0, 1.0)
        };
        if !self.cells[self.ends[usize::from(AT_PORT)]..].iter().all(is_air) {
            return None;
        }
        let faces: Vec<[VertexId; 3]> = faces_with(self.mesh, FaceRole::Outer).collect();
        OuterSphere::new(&faces, &self.mesh.vertices, degrees)
    }

    /// The mode of the port, if there is one.
    pub(super) fn port(&self) -> Option<&PortMode> {
        self.faces.port.as_ref().map(|p| &p.mode)
    }

    /// Conductance of the resistors and lossy sheets at an edge, in units of the free-space admittance.
    pub(super) fn conductance(&self, edge: [VertexId; 2]) -> f64 {
        let resistors = self.loads.resistors.iter().filter(|r| r.edge == edge).map(|r| ETA0 / r.resistance);
        resistors.sum::<f64>() + self.faces.sheets.get(&edge).copied().unwrap_or(0.0)
    }

    /// Conductance of the lumped port's source at its edges, in units of the free-space admittance.
    pub(super) fn source(&self) -> HashMap<[VertexId; 2], f64> {
        let port = self.loads.port.iter();
        let shares = port.flat_map(|port| Resistor::along(self.mesh, &port.chain, port.resistance));
        shares.map(|share| (share.edge, ETA0 / share.resistance)).collect()
    }

    /// The lumped port, if there is one.
    pub(super) fn lumped_port(&self) -> Option<&LumpedPort> {
        self.loads.port.as_ref()
    }

    fn region(&self, tet: usize) -> usize {
        self.mesh.tets[tet].region.index()
    }

    /// The ports of a cell that are in use.
    pub(super) fn free(&self, corners: [VertexId; 4], tet: usize) -> [bool; 6] {
        let shorted = self.faces.port.as_ref().filter(|port| port.region != self.region(tet));
        EDGES.map(|(i, j)| {
            let edge = [corners[i], corners[j]];
            !self.faces.conducting.contains(&edge) && shorted.is_none_or(|port| !port.edges.contains(&edge))
        })
    }

    pub(super) fn cell(&self, k: usize) -> Cell {
        let (corners, tet) = self.cells[k];
        let points = corners.map(|v| self.mesh.vertices[v.index()]);
        let region = self.mesh.tets[tet].region;
        let (mut eps_r, mut mu_r) = (self.mesh.regions[region.index()].eps_r, self.loads.mu_r(region));
        if corners.iter().any(|v| self.rim.contains(v)) {
            (eps_r, mu_r) = (eps_r * sheet_edge::PERMITTIVITY, mu_r / sheet_edge::RELUCTIVITY);
        }
        Cell::new(points, eps_r, mu_r, self.free(corners, tet))
    }

    fn face_mass(&self, face: [VertexId; 3]) -> Matrix3<f64> {
        face_mass(face.map(|v| self.mesh.vertices[v.index()])).0
    }

    /// Conductivity over permittivity of a cell's material, 1/m.
    fn conductivity(&self, tet: usize) -> f64 {
        TAU * self.loss_freq / C0 * self.mesh.regions[self.region(tet)].tan_delta
    }

    /// Conductances of a cell's outer faces.
    fn outer_conductance(&self, corners: [VertexId; 4], tet: usize) -> Matrix6<f64> {
        let region = self.mesh.tets[tet].region;
        let admittance = (self.mesh.regions[region.index()].eps_r / self.loads.mu_r(region)).sqrt();
        let mut conductance = Matrix6::zeros();
        for (places, face) in faces_of(corners).into_iter().filter(|(_, face)| self.faces.outer.contains(face)) {
            add_face(&mut conductance, places, &(self.face_mass(face) * admittance));
        }
        conductance
    }

    /// Forms of the waves at the outer sphere for a cell's ports: `[6, n_waves]`.
    pub(super) fn wave_forms(&self, sphere: &OuterSphere, k: usize) -> DMatrix<f64> {
        self.forms(k, sphere.n_waves(), |face, add| {
            for (a, row) in sphere.form(&face).into_iter().flat_map(Matrix3xX::row_iter).enumerate() {
                row.iter().enumerate().for_each(|(m, value)| add(a, m, *value));
            }
        })
    }

    /// Form of the port's mode for a cell's ports: `[6, 1]`.
    pub(super) fn port_form(&self, k: usize) -> DMatrix<f64> {
        let region = self.region(self.cells[k].1);
        self.forms(k, 1, |face, add| {
            if let Some((port, f)) = self.faces.port_face(face, region) {
                port.faces[f].form.iter().enumerate().for_each(|(a, value)| add(a, 0, *value));
            }
        })
    }

    /// Forms of modes for a cell's ports: `[6, n_modes]`.
    ///
    /// * `of_face`: adds, for a face, the values of its edges (01), (02), (12) and of each mode.
    fn forms(
        &self,
        k: usize,
        n_modes: usize,
        of_face: impl Fn([VertexId; 3], &mut dyn FnMut(usize, usize, f64)),
    ) -> DMatrix<f64> {
        let (corners, tet) = self.cells[k];
        let free = self.free(corners, tet);
        let mut forms = DMatrix::zeros(6, n_modes);
        for (places, face) in faces_of(corners) {
            of_face(face, &mut |a, m, value| {
                if free[places[a]] {
                    forms[(places[a], m)] += value;
                }
            });
        }
        forms
    }

    /// Conductances of lossy material in a cell; `None` where nothing is lost.
    pub(super) fn dissipation(&self, k: usize) -> Option<Matrix6<f64>> {
        let conductivity = self.conductivity(self.cells[k].1);
        (conductivity > 0.0).then(|| self.cell(k).capacitance * conductivity)
    }

    /// * `x`: half a time step, m.
    pub(super) fn terms(&self, k: usize, x: f64, at_boundary: bool) -> LaneTerms {
        let (corners, tet) = self.cells[k];
        let cell = self.cell(k);
        // As a share of C/x.
        let kappa = self.conductivity(tet) * x;
        let mut loss = cell.capacitance * (kappa / x);
        let mut lane = LaneTerms { coefficients: [0.0; 34], conductance: [0.0; 21] };
        if at_boundary {
            loss += self.outer_conductance(corners, tet);
        } else {
            lane.coefficients[LOSS] = kappa / (1.0 + kappa);
        }
        let c = cell.coefficients(x, &loss);
        for a in 0..6 {
            lane.coefficients[ADMITTANCE + a] = c.y[a];
            for b in 0..=a {
                lane.coefficients[triangle(a, b)] = c.d[(a, b)];
                if at_boundary && c.y[a] > 0.0 && c.y[b] > 0.0 {
                    lane.conductance[triangle(a, b)] = loss[(a, b)];
                }
            }
        }
        for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            lane.coefficients[A_INVERSE + triangle(i, j)] = c.a_inverse[(i, j)];
        }
        lane
    }
}

fn center(mesh: &TetMesh, tet: usize) -> DVec3 {
    mesh.corners(tet).iter().sum::<DVec3>() / 4.0
}

pub(super) fn ascending(mut corners: [VertexId; 4]) -> [VertexId; 4] {
    corners.sort_unstable();
    corners
}

fn morton(cell: DVec3) -> u32 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "scaled to ten bits")]
    let spread = |x: f64| {
        let mut x = (x as u32).min(1023);
        for (shift, mask) in [(16, 0x0300_00ff), (8, 0x0300_f00f), (4, 0x030c_30c3), (2, 0x0924_9249)] {
            x = (x | x << shift) & mask;
        }
        x
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}
