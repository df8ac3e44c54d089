//! A coaxial line's end: its static mode, and what drives and reads it.
//!
//! The mode is the gradient of the potential that is 1 on the inner conductor and 0 on the outer one (two-dimensional
//! Laplace on the port's triangles). With its edge values e0 and the face mass G, `1/Z0 = e0^T (Y G) e0`; it is a mode of
//! the port (see [`super::modes`]) with the form `g = Y G e0`, and `v = g^T V Z0` reads it.
//!
//! The line goes on behind the port for this mode alone: what flows into it is `g (2 v_inc - v)`. All other fields meet an
//! open end there. In the line they do not propagate, so they take no power with them, as they would take none in truth; a
//! resistance for all fields would take some.

use super::TlmError;
use super::cell::face_mass;
use super::modes::Modes;
use super::real::Real;
use crate::geometry::{DVec3, VertexId};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// One face of the port with what it adds to its cell; edges (01), (02), (12) of its ascending vertices.
#[derive(Clone, Debug)]
pub(super) struct PortFace {
    pub(super) vertices: [VertexId; 3],
    /// `Y G e0`, in units of the free-space admittance.
    pub(super) form: [f64; 3],
}

/// A port ready to be driven.
#[derive(Clone, Debug)]
pub(super) struct PortMode {
    pub(super) faces: Vec<PortFace>,
    /// `e0^T (Y G) e0`: the admittance of the mode in units of the free-space one.
    pub(super) admittance: f64,
}

impl PortMode {
    /// * `faces`: the port's triangles, vertices ascending; `index_eps`: square root of the permittivity behind it.
    pub(super) fn new(faces: &[[VertexId; 3]], points: &[DVec3], root_eps: f64, name: &str) -> Result<Self, TlmError> {
        let not_coaxial = || TlmError::NotCoaxial { port: name.to_owned() };
        let nodes: BTreeSet<VertexId> = faces.iter().flatten().copied().collect();
        let number: BTreeMap<VertexId, usize> = nodes.iter().enumerate().map(|(k, v)| (*v, k)).collect();
        let inner = inner_conductor(faces, points).ok_or_else(not_coaxial)?;
        let rim: BTreeSet<VertexId> = rim_edges(faces).into_iter().flatten().collect();
        let mut stiffness = DMatrix::zeros(nodes.len(), nodes.len());
        let masses: Vec<_> = faces.iter().map(|f| face_mass(f.map(|v| points[v.index()]))).collect();
        for (face, (_, gradients, area)) in faces.iter().zip(&masses) {
            for i in 0..3 {
                for j in 0..3 {
                    stiffness[(number[&face[i]], number[&face[j]])] += area * gradients[i].dot(gradients[j]);
                }
            }
        }
        let free: Vec<usize> = nodes.iter().filter(|v| !rim.contains(v)).map(|v| number[v]).collect();
        let mut potential = DVector::zeros(nodes.len());
        inner.iter().for_each(|v| potential[number[v]] = 1.0);
        if !free.is_empty() {
            let reduced = DMatrix::from_fn(free.len(), free.len(), |i, j| stiffness[(free[i], free[j])]);
            let right = DVector::from_fn(free.len(), |i, _| -stiffness.row(free[i]).transpose().dot(&potential));
            let solved = reduced.cholesky().ok_or_else(not_coaxial)?.solve(&right);
            free.iter().zip(solved.iter()).for_each(|(&node, &value)| potential[node] = value);
        }
        let mut port = Self { faces: Vec::with_capacity(faces.len()), admittance: 0.0 };
        for (face, (mass, ..)) in faces.iter().zip(&masses) {
            let at = |v: VertexId| potential[number[&v]];
            let e0 = nalgebra::Vector3::from([(0, 1), (0, 2), (1, 2)].map(|(i, j)| at(face[i]) - at(face[j])));
            let form = mass * e0 * root_eps;
            port.admittance += e0.dot(&form);
            port.faces.push(PortFace { vertices: *face, form: form.into() });
        }
        Ok(port)
    }
}

/// The line behind the port: fixed once built.
#[derive(Clone, Debug)]
pub(super) struct LineEnd<T> {
    pub(super) modes: Modes<T>,
    /// Of the mode, in units of the free-space admittance.
    pub(super) admittance: f64,
}

impl<T: Real> LineEnd<T> {
    /// The total voltage of the mode, and the current that flows out of the cells.
    ///
    /// * `seen`: `g^T V` without this current; `incident`: voltage of the wave that arrives.
    pub(super) fn step(&self, seen: f64, incident: f64) -> (f64, f64) {
        let s = self.modes.coupling[(0, 0)];
        let total = (seen + 2.0 * s * incident) / (self.admittance + s);
        (total, total - 2.0 * incident)
    }
}

/// Edges with one face.
fn rim_edges(faces: &[[VertexId; 3]]) -> Vec<[VertexId; 2]> {
    let mut count: BTreeMap<[VertexId; 2], usize> = BTreeMap::new();
    for [a, b, c] in faces {
        for edge in [[*a, *b], [*a, *c], [*b, *c]] {
            *count.entry(edge).or_default() += 1;
        }
    }
    count.into_iter().filter(|(_, n)| *n == 1).map(|(edge, _)| edge).collect()
}

/// Vertices of the inner one of the two loops around the port.
fn inner_conductor(faces: &[[VertexId; 3]], points: &[DVec3]) -> Option<BTreeSet<VertexId>> {
    let mut open = rim_edges(faces);
    let mut loops: Vec<BTreeSet<VertexId>> = Vec::new();
    while let Some(edge) = open.pop() {
        let mut group = BTreeSet::from(edge);
        loop {
            let before = group.len();
            open.retain(|e| {
                let joins = e.iter().any(|v| group.contains(v));
                if joins {
                    group.extend(e);
                }
                !joins
            });
            if group.len() == before {
                break;
            }
        }
        loops.push(group);
    }
    let extent = |l: &BTreeSet<VertexId>| {
        let center = l.iter().map(|v| points[v.index()]).sum::<DVec3>() / l.len() as f64;
        l.iter().map(|v| points[v.index()].distance(center)).fold(0.0, f64::max)
    };
    if loops.len() != 2 {
        return None;
    }
    loops.into_iter().min_by(|p, q| extent(p).total_cmp(&extent(q)))
}
