//! The far field of the currents on a closed surface.
//!
//! ```text
//! N(r) = ∮ J exp(jk r·r') dS,  L(r) = -∮ n x E exp(jk r·r') dS,  E_far = -jk/(4 pi) [eta N - r x L]  across r
//! ```
//!
//! J is known weakly, so `N = sum_e J_e ∫_e exp(jk r·r') dl`, by Simpson's rule along the edge; n x E is interpolated by
//! the Whitney functions of each triangle and integrated by the rule of the three edge middles, exact for the second
//! degree. Both rules meet at the same places, vertices and middles of edges: there a current element of each kind is
//! summed up once for all directions. Simpson's rule errs by (kh)^4/2880 of an edge's part, a thousandth at six edges a
//! wavelength.
//!
//! A source within the distance a of the origin makes spherical waves up to a degree of about
//! `N = ka + 1.8 d^(2/3) (ka)^(1/3)` to d digits; the field is sampled on a grid that holds these, see [`FarField`].
//!
//! The surface's power and the far field's come from the same currents by different ways; they differ by what the mesh
//! makes of the wave outside.
//!
//! Sources: \[BAL16\] sections 12.2, 12.3 (N and L); \[CHE01\] (number of waves).

use super::far_field::{FarField, Powers};
use super::s_params::transform;
use crate::geometry::DVec3;
use crate::tlm::{ClosedSurface, Record, SurfaceField};
use crate::units::{C0, ETA0};
use nalgebra::{Complex, Vector3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Digits to which the sampled field holds all waves.
const DIGITS: f64 = 3.0;

/// A complex vector.
type Phasor = Vector3<Complex<f64>>;

/// An electric and a magnetic current element at a place.
struct Element {
    place: DVec3,
    electric: Phasor,
    magnetic: Phasor,
}

/// The far field of what a closed surface saw, on its scale, without a port's powers.
///
/// A field of Fourier integrals (V s) gives one too: its powers are energies per hertz then.
#[must_use]
pub fn far_field(surface: &ClosedSurface, field: &SurfaceField) -> FarField {
    let wavenumber = TAU * field.freq / C0;
    let elements = elements(surface, field);
    let reach = surface.points.iter().map(|p| p.length()).fold(0.0, f64::max) * wavenumber;
    let degree = reach + 1.8 * DIGITS.powf(2.0 / 3.0) * reach.cbrt() + 1.0;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ten, at most a few hundred")]
    let n = 2 * (degree.ceil().clamp(4.0, 180.0) as usize);
    let columns = 2 * n;
    let sample = |k: usize| {
        let (theta, phi) = (PI * (k / columns) as f64 / n as f64, PI * (k % columns) as f64 / n as f64);
        towards(&elements, wavenumber, theta, phi)
    };
    let e: Vec<[Complex<f64>; 2]> = (0..(n + 1) * columns).into_par_iter().map(sample).collect();
    let powers = Powers { lost: field.lost, crossing: field.power(), ..Powers::default() };
    FarField::new(field.freq, n, [0, 1].map(|c| e.iter().map(|e| e[c]).collect()), powers)
}

/// The far fields of an antenna, scaled to an incident wave of 1 W whose phase is zero at the port.
///
/// * `fields`: Fourier integrals over the whole run.
/// * `record`: the port's series of the same run.
/// * `impedance`: of the port as meshed, ohm.
#[must_use]
pub fn far_fields(surface: &ClosedSurface, fields: &[SurfaceField], record: &Record, impedance: f64) -> Vec<FarField> {
    let reflected: Vec<f64> = record.reflected().collect();
    let scaled = |field: &SurfaceField| {
        let spectrum = |series: &[f64]| transform(series, field.freq * record.dt) * record.dt;
        let (incident, reflected) = (spectrum(&record.incident), spectrum(&reflected));
        let unit = incident / (2.0 * impedance).sqrt();
        let mut found = far_field(surface, field).scaled(unit.inv());
        found.powers.incident = 1.0;
        found.powers.accepted = 1.0 - (reflected / incident).norm_sqr();
        found
    };
    fields.iter().map(scaled).collect()
}

/// The current elements at the surface's points, then at the middles of its edges.
fn elements(surface: &ClosedSurface, field: &SurfaceField) -> Vec<Element> {
    let n_points = surface.points.len();
    let middles = surface.edges.iter().map(|&[a, b]| surface.points[a].midpoint(surface.points[b]));
    let places = surface.points.iter().copied().chain(middles);
    let mut elements: Vec<Element> =
        places.map(|place| Element { place, electric: Phasor::zeros(), magnetic: Phasor::zeros() }).collect();
    for (e, (&[a, b], &current)) in surface.edges.iter().zip(&field.currents).enumerate() {
        let along = times(surface.points[b] - surface.points[a], current);
        for (place, share) in [(a, 1.0), (n_points + e, 4.0), (b, 1.0)] {
            elements[place].electric += along * Complex::from(share / 6.0);
        }
    }
    for (corners, edges) in surface.faces.iter().zip(&surface.edges_of) {
        let points = corners.map(|p| surface.points[p]);
        // Along the face's own sense of rotation.
        let voltages: [Complex<f64>; 3] = std::array::from_fn(|k| {
            let runs_with = surface.edges[edges[k]][0] == corners[k];
            field.voltages[edges[k]] * if runs_with { 1.0 } else { -1.0 }
        });
        for (&edge, magnetic) in edges.iter().zip(magnetic_elements(points, voltages)) {
            elements[n_points + edge].magnetic += magnetic;
        }
    }
    elements
}

/// `-n x E` times a third of the area, at the middles of a triangle's edges.
///
/// * `points`: corners, counter-clockwise seen from outside, m.
/// * `voltages`: from corner 0 to 1, 1 to 2 and 2 to 0, V.
fn magnetic_elements(points: [DVec3; 3], voltages: [Complex<f64>; 3]) -> [Phasor; 3] {
    let doubled = (points[1] - points[0]).cross(points[2] - points[0]);
    // n x grad lambda_i = (p_k - p_j) / (2 A) turned once more: n x (n x edge) = -edge.
    let opposite: [DVec3; 3] = std::array::from_fn(|i| points[(i + 2) % 3] - points[(i + 1) % 3]);
    std::array::from_fn(|m| {
        // At the middle of edge m the coordinates of its ends are one half.
        let weight = |i: usize| if i == (m + 2) % 3 { 0.0 } else { 0.5 };
        let mut sum = Phasor::zeros();
        for (k, &voltage) in voltages.iter().enumerate() {
            let (i, j) = (k, (k + 1) % 3);
            // n x w = lambda_i n x grad lambda_j - lambda_j n x grad lambda_i, with n x grad lambda_i = -opposite_i / (2A)
            let turned = -(opposite[j] * weight(i) - opposite[i] * weight(j)) / doubled.length();
            sum += times(turned, voltage);
        }
        sum * Complex::from(-doubled.length() / 6.0)
    })
}

fn times(vector: DVec3, by: Complex<f64>) -> Phasor {
    Phasor::new(by * vector.x, by * vector.y, by * vector.z)
}

fn dot(vector: DVec3, phasor: &Phasor) -> Complex<f64> {
    phasor[0] * vector.x + phasor[1] * vector.y + phasor[2] * vector.z
}

/// The components of the far field along theta and phi in one direction.
fn towards(elements: &[Element], wavenumber: f64, theta: f64, phi: f64) -> [Complex<f64>; 2] {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    let direction = DVec3::new(st * cp, st * sp, ct) * wavenumber;
    let (mut n, mut l) = (Phasor::zeros(), Phasor::zeros());
    for element in elements {
        let (sin, cos) = direction.dot(element.place).sin_cos();
        let phase = Complex::new(cos, sin);
        n += element.electric * phase;
        l += element.magnetic * phase;
    }
    let (along_theta, along_phi) = (DVec3::new(ct * cp, ct * sp, -st), DVec3::new(-sp, cp, 0.0));
    let factor = Complex::new(0.0, -wavenumber / (4.0 * PI));
    [
        factor * (dot(along_theta, &n) * ETA0 + dot(along_phi, &l)),
        factor * (dot(along_phi, &n) * ETA0 - dot(along_theta, &l)),
    ]
}

#[cfg(test)]
#[allow(clippy::print_stdout, reason = "a test")]
mod tests {
    use super::*;
    use crate::geometry::DQuat;

    const FREQ: f64 = 10e9;

    /// Exact E and H of a small dipole with moment `I l = moment` at the origin.
    fn dipole(moment: DVec3, at: DVec3) -> (Phasor, Phasor) {
        let k = TAU * FREQ / C0;
        let r = at.length();
        let radial = at / r;
        let kr = k * r;
        let j = Complex::i();
        let wave = Complex::from_polar(1.0, -kr) * k * k / (4.0 * PI);
        let h = times(moment.cross(radial), wave * (j / kr + (kr * kr).recip()));
        let across = moment - radial * radial.dot(moment);
        let beyond = radial * (3.0 * radial.dot(moment)) - moment;
        let far = times(across, -j / kr);
        let near = times(beyond, (kr * kr).recip() - j / (kr * kr * kr));
        ((far + near) * (wave * ETA0), h)
    }

    /// The sphere as a divided octahedron with n x n triangles a face, a little off center.
    fn sphere(n: usize, radius: f64) -> ClosedSurface {
        let mut number = std::collections::HashMap::new();
        let mut points = Vec::new();
        let mut faces = Vec::new();
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
        let shift = DVec3::new(1e-3, -2e-3, 1.5e-3);
        let whole = i32::try_from(n).unwrap();
        for signs in 0..8 {
            let sign = [0, 1, 2].map(|b| if signs >> b & 1 == 0 { 1 } else { -1 });
            let mut id = |i: i32, j: i32| {
                let place = [i * sign[0], j * sign[1], (whole - i - j) * sign[2]];
                *number.entry(place).or_insert_with(|| {
                    let p = DVec3::from_array(place.map(f64::from)).try_normalize().unwrap();
                    points.push(turn * p * radius + shift);
                    points.len() - 1
                })
            };
            for (i, j) in (0..whole).flat_map(|i| (0..whole - i).map(move |j| (i, j))) {
                let mut add = |[a, b, c]: [usize; 3]| {
                    faces.push(if sign[0] * sign[1] * sign[2] > 0 { [a, b, c] } else { [a, c, b] });
                };
                add([id(i, j), id(i + 1, j), id(i, j + 1)]);
                if i + j + 2 <= whole {
                    add([id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
                }
            }
        }
        ClosedSurface::new(points, faces)
    }

    /// What an exact field does on a surface: line integrals of E, and moments of n x H with the Whitney functions.
    fn seen(surface: &ClosedSurface, field: impl Fn(DVec3) -> (Phasor, Phasor)) -> SurfaceField {
        let gauss = [(0.5 - 0.15_f64.sqrt(), 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.15_f64.sqrt(), 5.0 / 18.0)];
        let voltage = |&[a, b]: &[usize; 2]| {
            let (a, b) = (surface.points[a], surface.points[b]);
            gauss.iter().map(|&(t, w)| dot(b - a, &field(a.lerp(b, t)).0) * w).sum::<Complex<f64>>()
        };
        let mut currents = vec![Complex::from(0.0); surface.edges.len()];
        for (corners, edges) in surface.faces.iter().zip(&surface.edges_of) {
            let p = corners.map(|c| surface.points[c]);
            let doubled = (p[1] - p[0]).cross(p[2] - p[0]);
            let normal = doubled / doubled.length();
            let gradient = |i: usize| normal.cross(p[(i + 2) % 3] - p[(i + 1) % 3]) / doubled.length();
            // Four points, exact for the third degree.
            let places = [([1.0 / 3.0; 3], -27.0 / 48.0), ([0.6, 0.2, 0.2], 25.0 / 48.0)];
            let turned = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|t| (t.map(|i: usize| places[1].0[i]), places[1].1));
            for (lambda, share) in [places[0]].into_iter().chain(turned) {
                let at = p[0] * lambda[0] + p[1] * lambda[1] + p[2] * lambda[2];
                let h = field(at).1;
                for k in 0..3 {
                    let (i, j) = (k, (k + 1) % 3);
                    let sign = if surface.edges[edges[k]][0] == corners[k] { 1.0 } else { -1.0 };
                    let whitney = (gradient(j) * lambda[i] - gradient(i) * lambda[j]) * sign;
                    // w · (n x H) = (w x n) · H
                    currents[edges[k]] += dot(whitney.cross(normal), &h) * (share * doubled.length() / 2.0);
                }
            }
        }
        SurfaceField { freq: FREQ, voltages: surface.edges.iter().map(voltage).collect(), currents, lost: 0.0 }
    }

    /// Greatest error of the far field relative to its greatest value, and the errors of both powers.
    fn errors(n: usize) -> [f64; 3] {
        // Off the origin, so that both integrals matter in every direction; half a wavelength away.
        let (moment, source) = (DVec3::new(0.3, 0.5, 0.8) * 1e-3, DVec3::new(2e-3, 1e-3, -1e-3));
        let surface = sphere(n, 15e-3);
        let found = far_field(&surface, &seen(&surface, |p| dipole(moment, p - source)));
        let k = TAU * FREQ / C0;
        let peak = ETA0 * k * moment.length() / (4.0 * PI);
        let mut worst = 0.0_f64;
        for (t, &theta) in found.theta.iter().enumerate() {
            for (p, &phi) in found.phi.iter().enumerate() {
                let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
                let direction = DVec3::new(st * cp, st * sp, ct);
                let factor =
                    Complex::new(0.0, -ETA0 * k / (4.0 * PI)) * Complex::from_polar(1.0, k * direction.dot(source));
                let place = t * found.phi.len() + p;
                let wanted =
                    [DVec3::new(ct * cp, ct * sp, -st), DVec3::new(-sp, cp, 0.0)].map(|u| factor * u.dot(moment));
                worst =
                    worst.max((found.e_theta[place] - wanted[0]).norm()).max((found.e_phi[place] - wanted[1]).norm());
            }
        }
        let power = ETA0 * (k * moment.length()).powi(2) / (12.0 * PI);
        [worst / peak, found.powers.radiated / power - 1.0, found.powers.crossing / power - 1.0]
    }

    #[test]
    fn a_dipoles_field_on_a_faceted_sphere_gives_its_far_field() {
        let (coarse, fine) = (errors(6), errors(12));
        // Edges of an eighth and a sixteenth of the wavelength: second order.
        for (c, f) in coarse.iter().zip(fine) {
            assert!(f.abs() < 0.35 * c.abs(), "{f} against {c}");
        }
        assert!(fine[0] < 0.01 && fine[1].abs() < 0.01, "{fine:?}");
    }
}
