//! Jacobian of the map in closed form, for the points of a block.
//!
//! On one face the hat functions carry the foot of p on its plane to `X = Σ γ_i v'_i`, which is affine in p with the
//! gradient `A = Σ v'_i g_iᵀ`. With `W = Σ L_k m_k` and s the stretched normal, the face contributes
//!
//! ```text
//! 4π F = X Ω - h A W + s (Σ t_k L_k - h Ω)
//! 4π J = A Ω + X (∇Ω)ᵀ + (A W) nᵀ - h Σ A m_k (∇L_k)ᵀ + s (n Ω - W)ᵀ
//! ∇Ω = Σ_k (a_k × a_{k+1}) (r_k + r_{k+1}) / (r_k r_{k+1} S_k)    ∇L_k = l_k (a_k/r_k + a_{k+1}/r_{k+1}) / S_k
//! ```
//!
//! as ∇h = -n, ∇(∫ 1/r) = n Ω - W, `S = r_k r_{k+1} + a_k·a_{k+1}`, and ∇Ω is the Biot-Savart integral around the face.
//! The terms in ∇Ω grow like the inverse distance from an edge, but its two faces' nearly cancel: they run the edge in
//! opposite directions, and both X agree on it. So they are joined by edges: `X_f - X_g = (A_g - A_f) d` with d the
//! part perpendicular to the edge of the vector from the point to it, which leaves a logarithm.

use super::block::{Block, Lanes};
use super::cage::{Edge, Face};
use super::evaluator::{Evaluator, WIDTH};
use super::{DeformError, GreenCage, Pose};
use crate::geometry::{DMat3, DVec3};
use pulp::{Simd, WithSimd};
use std::f64::consts::PI;

/// What the Jacobian needs of a pose.
#[derive(Clone, Debug)]
pub(super) struct Gradient {
    faces: Vec<PosedFace>,
    edges: Vec<PosedEdge>,
}

#[derive(Clone, Debug)]
struct PosedFace {
    /// Gradient of the affine map of the face.
    affine: DMat3,
    /// Stretched normal.
    normal: DVec3,
}

#[derive(Clone, Debug)]
struct PosedEdge {
    /// Difference of the two faces' affine gradients.
    jump: DMat3,
    /// Images of the edge's normals in its two faces.
    normals: [DVec3; 2],
}

const SCALE: f64 = 0.25 / PI;
/// Distance from an edge or a vertex, relative to the cage's size, that is rounding only.
const ON_EDGE: f64 = 4e-16;

/// A matrix for each lane, by columns.
type Matrices<const W: usize> = [[Lanes<W>; 3]; 3];

impl Gradient {
    pub(super) fn new(cage: &GreenCage, pose: &Pose) -> Self {
        let posed = pose.vertices();
        let outer = |v: DVec3, g: DVec3| DMat3::from_cols(v * g.x, v * g.y, v * g.z);
        let affine = |face: &Face| {
            // Relative to a corner, so that a cage far from the origin loses no digits.
            let origin = posed[face.corners[0]];
            (1..3).map(|i| outer(posed[face.corners[i]] - origin, face.gradients[i])).fold(DMat3::ZERO, |a, b| a + b)
        };
        let faces: Vec<_> = cage
            .faces
            .iter()
            .zip(pose.stretched_normals())
            .map(|(face, &normal)| PosedFace { affine: affine(face), normal })
            .collect();
        let posed_edge = |edge: &Edge| {
            let [(f, k), (g, j)] = edge.faces;
            let image = |f: usize, k: usize| faces[f].affine * cage.faces[f].edge_normals[k];
            PosedEdge { jump: faces[f].affine - faces[g].affine, normals: [image(f, k), image(g, j)] }
        };
        let edges = cage.edges.iter().map(posed_edge).collect();
        Self { faces, edges }
    }
}

impl Evaluator<'_> {
    /// Jacobians of the points evaluated last.
    pub(super) fn jacobians(
        &self,
        gradient: &Gradient,
        points: &[DVec3],
        first: usize,
    ) -> Result<[DMat3; WIDTH], DeformError> {
        let (matrices, on_edge) = self.dispatch(JacobianPath { cage: self.cage(), gradient, block: self.lanes() });
        if let Some(w) = (0..points.len()).find(|&w| on_edge[w] > 0.0) {
            return Err(DeformError::SingularGradient { point: first + w, position: points[w] });
        }
        Ok(std::array::from_fn(|w| DMat3::from_cols_array_2d(&matrices.map(|column| column.map(|lanes| lanes[w])))))
    }
}

struct JacobianPath<'a> {
    cage: &'a GreenCage,
    gradient: &'a Gradient,
    block: &'a Block<WIDTH>,
}

impl WithSimd for JacobianPath<'_> {
    /// Jacobians, and 1 in the lanes of points on an edge.
    type Output = (Matrices<WIDTH>, Lanes<WIDTH>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> Self::Output {
        let mut sum = [[[0.0; WIDTH]; 3]; 3];
        let mut on_edge = [0.0; WIDTH];
        for (f, (face, posed)) in self.cage.faces.iter().zip(&self.gradient.faces).enumerate() {
            add_face(self.block, f, face, posed, &mut sum);
        }
        let tiny = ON_EDGE * self.cage.size();
        for (edge, posed) in self.cage.edges.iter().zip(&self.gradient.edges) {
            find_on_edge(self.block, edge, tiny, &mut on_edge);
            add_edge(self.block, edge, posed, &mut sum);
        }
        (sum, on_edge)
    }
}

/// Adds `(A Ω + (A W) nᵀ + s (n Ω - W)ᵀ) / 4π`.
#[inline(always)]
fn add_face<const W: usize>(block: &Block<W>, f: usize, face: &Face, posed: &PosedFace, sum: &mut Matrices<W>) {
    let [la, lb, lc] = face.edges.map(|e| &block.logs[e]);
    let [ma, mb, mc] = face.edge_normals;
    let angle = &block.angles[f];
    let affine = posed.affine.to_cols_array_2d();
    let (n, s) = (face.normal.to_array(), posed.normal.to_array());
    let mut omega = [0.0; W];
    let mut line = [[0.0; W]; 3];
    let mut image = [[0.0; W]; 3];
    for w in 0..W {
        omega[w] = angle[w] * SCALE;
        let (la, lb, lc) = (la[w] * SCALE, lb[w] * SCALE, lc[w] * SCALE);
        let (x, y, z) =
            (ma.x * la + mb.x * lb + mc.x * lc, ma.y * la + mb.y * lb + mc.y * lc, ma.z * la + mb.z * lb + mc.z * lc);
        (line[0][w], line[1][w], line[2][w]) = (x, y, z);
        image[0][w] = affine[0][0] * x + affine[1][0] * y + affine[2][0] * z;
        image[1][w] = affine[0][1] * x + affine[1][1] * y + affine[2][1] * z;
        image[2][w] = affine[0][2] * x + affine[1][2] * y + affine[2][2] * z;
    }
    for (col, (sum, line)) in sum.iter_mut().zip(&line).enumerate() {
        for (row, (sum, image)) in sum.iter_mut().zip(&image).enumerate() {
            let solid = affine[col][row] + s[row] * n[col];
            for w in 0..W {
                sum[w] += solid * omega[w] + image[w] * n[col] - s[row] * line[w];
            }
        }
    }
}

/// Writes 1 into the lanes of points that are no farther than `tiny` from the edge.
#[inline(always)]
fn find_on_edge<const W: usize>(block: &Block<W>, edge: &Edge, tiny: f64, on_edge: &mut Lanes<W>) {
    let [a, b] = edge.ends.map(|v| &block.spokes[v]);
    let [ra, rb] = edge.ends.map(|v| &block.radii[v]);
    let t = edge.tangent;
    let mut found = *on_edge;
    for w in 0..W {
        let x = a[1][w] * t.z - a[2][w] * t.y;
        let y = a[2][w] * t.x - a[0][w] * t.z;
        let z = a[0][w] * t.y - a[1][w] * t.x;
        let between = a[0][w] * b[0][w] + a[1][w] * b[1][w] + a[2][w] * b[2][w] < 0.0;
        let on_line = between && x * x + y * y + z * z <= tiny * tiny;
        found[w] = if on_line || ra[w] <= tiny || rb[w] <= tiny { 1.0 } else { found[w] };
    }
    *on_edge = found;
}

/// Adds `(X_f - X_g) (∇Ω of the edge)ᵀ - (h_f A_f m_f + h_g A_g m_g) (∇L)ᵀ`, over 4π.
#[inline(always)]
fn add_edge<const W: usize>(block: &Block<W>, edge: &Edge, posed: &PosedEdge, sum: &mut Matrices<W>) {
    let [a, b] = edge.ends.map(|v| &block.spokes[v]);
    let [ra, rb] = edge.ends.map(|v| &block.radii[v]);
    let [hf, hg] = edge.faces.map(|(f, _)| &block.heights[f]);
    let jump = posed.jump.to_cols_array_2d();
    let [mf, mg] = posed.normals;
    let t = edge.tangent / edge.length;
    let mut cross = [[0.0; W]; 3];
    let mut slope = [[0.0; W]; 3];
    let mut gap = [[0.0; W]; 3];
    let mut shear = [[0.0; W]; 3];
    for w in 0..W {
        let (ax, ay, az) = (a[0][w], a[1][w], a[2][w]);
        let (bx, by, bz) = (b[0][w], b[1][w], b[2][w]);
        let (ra, rb) = (ra[w], rb[w]);
        let (x, y, z) = (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
        let dot = ax * bx + ay * by + az * bz;
        let radii = ra * rb;
        // 1 / (r_k r_{k+1} S)
        let between = dot < 0.0;
        let over = if between { radii - dot } else { 1.0 };
        let under = radii * if between { x * x + y * y + z * z } else { radii + dot };
        let inverse = SCALE * over / if under < f64::MIN_POSITIVE { 1.0 } else { under };
        let turn = (ra + rb) * inverse;
        let stretch = edge.length * inverse;
        let foot = (turn * (t.y * z - t.z * y), turn * (t.z * x - t.x * z), turn * (t.x * y - t.y * x));
        let (hf, hg) = (hf[w] * stretch, hg[w] * stretch);
        (cross[0][w], cross[1][w], cross[2][w]) = (x, y, z);
        (slope[0][w], slope[1][w], slope[2][w]) = (ax * rb + bx * ra, ay * rb + by * ra, az * rb + bz * ra);
        gap[0][w] = jump[0][0] * foot.0 + jump[1][0] * foot.1 + jump[2][0] * foot.2;
        gap[1][w] = jump[0][1] * foot.0 + jump[1][1] * foot.1 + jump[2][1] * foot.2;
        gap[2][w] = jump[0][2] * foot.0 + jump[1][2] * foot.1 + jump[2][2] * foot.2;
        shear[0][w] = hf * mf.x + hg * mg.x;
        shear[1][w] = hf * mf.y + hg * mg.y;
        shear[2][w] = hf * mf.z + hg * mg.z;
    }
    for (sum, (cross, slope)) in sum.iter_mut().zip(cross.iter().zip(&slope)) {
        for (sum, (gap, shear)) in sum.iter_mut().zip(gap.iter().zip(&shear)) {
            for w in 0..W {
                sum[w] -= gap[w] * cross[w] + shear[w] * slope[w];
            }
        }
    }
}
