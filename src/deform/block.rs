//! The fast path: Green coordinates of a few points at once, one lane each.
//!
//! Every loop over the lanes is plain arithmetic on arrays without branches, which the compiler turns into vector
//! code; lanes never mix, so a lane's bits do not depend on the others. Distances are taken once per vertex, logarithms
//! once per edge, and one arctangent per face.
//!
//! With `a_i = v_i - p`, `r_i = |a_i|`, h the height of the face's plane over p, hat function gradients `g_i`, edge
//! normals `m_k` and `S = r_k r_{k+1} + a_k·a_{k+1}`:
//!
//! ```text
//! Ω   = 2 atan2(2A h, r0 r1 r2 + (a0·a1) r2 + (a1·a2) r0 + (a2·a0) r1)      L_k = ln((r_k + r_{k+1} + l_k)² / 2S)
//! 4π psi = Σ_k (m_k·a_k) L_k - h Ω                    4π phi_i += -(g_i·a_{i+1}) Ω - h Σ_k (g_i·m_k) L_k
//! ```
//!
//! Where `a_k·a_{k+1} < 0`, S is taken from `|a_k × a_{k+1}|²`, which does not cancel. On the segment itself L is
//! infinite but only enters times a distance from it: the limit of that is 0, and so L is set to 0 there.

use super::cage::{AMBIGUOUS_ANGLE, AMBIGUOUS_HEIGHT, Edge, Face, GreenCage};
use super::elementary::{atan2, ln_ratio};
use crate::geometry::DVec3;
use std::f64::consts::PI;

/// One number per lane.
pub(super) type Lanes<const W: usize> = [f64; W];

/// Everything about `W` points in a cage.
#[derive(Debug)]
pub(super) struct Block<const W: usize> {
    /// Per vertex: from the point to it, m.
    pub(super) spokes: Vec<[Lanes<W>; 3]>,
    /// Per vertex: distance, m.
    pub(super) radii: Vec<Lanes<W>>,
    /// Per edge: scalar product of the spokes of its ends, m².
    pub(super) products: Vec<Lanes<W>>,
    /// Per edge: line integral of 1/r.
    pub(super) logs: Vec<Lanes<W>>,
    /// Per face: height of its plane over the point, positive inside, m.
    pub(super) heights: Vec<Lanes<W>>,
    /// Per face: signed solid angle.
    pub(super) angles: Vec<Lanes<W>>,
    /// Per vertex: its weight.
    pub(super) phi: Vec<Lanes<W>>,
    /// Per face: its weight, m.
    pub(super) psi: Vec<Lanes<W>>,
    /// Sum of phi, which is the winding number.
    pub(super) sum: Lanes<W>,
    /// 1 where a face is so close that rounding might decide the side, else 0.
    pub(super) ambiguous: Lanes<W>,
}

impl<const W: usize> Block<W> {
    pub(super) fn new(cage: &GreenCage) -> Self {
        let (n_vertices, n_edges, n_faces) = (cage.n_vertices(), cage.edges.len(), cage.n_faces());
        let zero = [0.0; W];
        Self {
            spokes: vec![[zero; 3]; n_vertices],
            radii: vec![zero; n_vertices],
            products: vec![zero; n_edges],
            logs: vec![zero; n_edges],
            heights: vec![zero; n_faces],
            angles: vec![zero; n_faces],
            phi: vec![zero; n_vertices],
            psi: vec![zero; n_faces],
            sum: zero,
            ambiguous: zero,
        }
    }

    /// Spokes, radii and logarithms, which both paths share.
    #[inline(always)]
    pub(super) fn measure(&mut self, cage: &GreenCage, points: &[DVec3; W]) {
        for (v, vertex) in cage.rest().vertices.iter().enumerate() {
            let mut spoke = [[0.0; W]; 3];
            let mut radius = [0.0; W];
            for w in 0..W {
                let (x, y, z) = (vertex.x - points[w].x, vertex.y - points[w].y, vertex.z - points[w].z);
                spoke[0][w] = x;
                spoke[1][w] = y;
                spoke[2][w] = z;
                radius[w] = (x * x + y * y + z * z).sqrt();
            }
            self.spokes[v] = spoke;
            self.radii[v] = radius;
        }
        for (e, edge) in cage.edges.iter().enumerate() {
            let (product, log) = self.edge(edge);
            self.products[e] = product;
            self.logs[e] = log;
        }
    }

    #[inline(always)]
    fn edge(&self, edge: &Edge) -> (Lanes<W>, Lanes<W>) {
        let [i, j] = edge.ends;
        let (a, b) = (&self.spokes[i], &self.spokes[j]);
        let (ra, rb) = (&self.radii[i], &self.radii[j]);
        let mut product = [0.0; W];
        let mut log = [0.0; W];
        for w in 0..W {
            let dot = a[0][w] * b[0][w] + a[1][w] * b[1][w] + a[2][w] * b[2][w];
            let x = a[1][w] * b[2][w] - a[2][w] * b[1][w];
            let y = a[2][w] * b[0][w] - a[0][w] * b[2][w];
            let z = a[0][w] * b[1][w] - a[1][w] * b[0][w];
            let radii = ra[w] * rb[w];
            let sum = ra[w] + rb[w] + edge.length;
            let between = dot < 0.0;
            let numerator = sum * sum * if between { radii - dot } else { 1.0 };
            let denominator = if between { 2.0 * (x * x + y * y + z * z) } else { 2.0 * (radii + dot) };
            let on_edge = denominator < f64::MIN_POSITIVE;
            product[w] = dot;
            log[w] = ln_ratio(numerator, if on_edge { numerator } else { denominator });
        }
        (product, log)
    }

    /// Weights by the fast path, after [`Self::measure`].
    #[inline(always)]
    pub(super) fn weigh(&mut self, cage: &GreenCage) {
        self.phi.fill([0.0; W]);
        self.ambiguous = [0.0; W];
        let ambiguous_height = AMBIGUOUS_HEIGHT * cage.size();
        for (f, face) in cage.faces.iter().enumerate() {
            let (height, angle) = self.angle(face);
            for w in 0..W {
                let close = height[w].abs() <= ambiguous_height && angle[w].abs() > AMBIGUOUS_ANGLE;
                self.ambiguous[w] = if close { 1.0 } else { self.ambiguous[w] };
            }
            let (phi, psi) = self.face(face, &height, &angle);
            for (phi, &corner) in phi.iter().zip(&face.corners) {
                let total = &mut self.phi[corner];
                for w in 0..W {
                    total[w] += phi[w];
                }
            }
            self.heights[f] = height;
            self.angles[f] = angle;
            self.psi[f] = psi;
        }
        let mut sum = [0.0; W];
        for phi in &self.phi {
            for w in 0..W {
                sum[w] += phi[w];
            }
        }
        self.sum = sum;
    }

    /// Height and solid angle of a face.
    #[inline(always)]
    fn angle(&self, face: &Face) -> (Lanes<W>, Lanes<W>) {
        let n = face.normal;
        let a = &self.spokes[face.corners[0]];
        let [ra, rb, rc] = face.corners.map(|v| &self.radii[v]);
        let [ab, bc, ca] = face.edges.map(|e| &self.products[e]);
        let mut height = [0.0; W];
        let mut angle = [0.0; W];
        for w in 0..W {
            let h = n.x * a[0][w] + n.y * a[1][w] + n.z * a[2][w];
            let denominator = ra[w] * (rb[w] * rc[w] + bc[w]) + ab[w] * rc[w] + ca[w] * rb[w];
            height[w] = h;
            angle[w] = 2.0 * atan2(face.double_area * h, denominator);
        }
        (height, angle)
    }

    /// What a face adds to the phi of its corners, and its psi.
    #[inline(always)]
    fn face(&self, face: &Face, height: &Lanes<W>, angle: &Lanes<W>) -> ([Lanes<W>; 3], Lanes<W>) {
        const SCALE: f64 = 0.25 / PI;
        let [a, b, c] = face.corners.map(|v| &self.spokes[v]);
        let [la, lb, lc] = face.edges.map(|e| &self.logs[e]);
        let ([ma, mb, mc], [ga, gb, gc], s) = (face.edge_normals, face.gradients, &face.slopes);
        let mut phi = [[0.0; W]; 3];
        let mut psi = [0.0; W];
        for w in 0..W {
            let dot = |n: DVec3, a: &[Lanes<W>; 3]| n.x * a[0][w] + n.y * a[1][w] + n.z * a[2][w];
            let (h, omega) = (height[w], angle[w]);
            let line = |s: &[f64; 3]| s[0] * la[w] + s[1] * lb[w] + s[2] * lc[w];
            psi[w] = SCALE * (dot(ma, a) * la[w] + dot(mb, b) * lb[w] + dot(mc, c) * lc[w] - h * omega);
            phi[0][w] = SCALE * (-dot(ga, b) * omega - h * line(&s[0]));
            phi[1][w] = SCALE * (-dot(gb, c) * omega - h * line(&s[1]));
            phi[2][w] = SCALE * (-dot(gc, a) * omega - h * line(&s[2]));
        }
        (phi, psi)
    }
}
