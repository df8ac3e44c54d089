//! Isometric compensation: restores the metric locally, then the radius and the substrate's thickness.
//!
//! Width-and-length scaling is right on average only. Here the flat plane is pre-warped by tensor polynomials
//! `(x, y) -> (a, b)` that minimise, over 15² Gauss points of the substrate and 15² of the patch (weighted more), the
//! weighted sum of `(E - 1)²/4 + F²/2 + (G - 1)²/4` of the composite map's first fundamental form, by Gauss-Newton
//! from the identity. Where the antenna is bent onto a cylinder, the cage's radius is divided by the relative error of
//! the fitted radius (keeping lengths does not keep the radius), and the heights by the relative error of the mean
//! substrate thickness; all three go together until nothing moves.
//!
//! The warp's free motions are fixed by `a(0) = b(0) = 0` and `a_y = b_x` at the center. The whole antenna goes
//! through one warp, so interfaces stay shared. Second derivatives of the Green map are differences of its analytic
//! Jacobian; they only steer the iteration.

use super::figures::mean_thickness;
use super::quadrature::{gauss_legendre, plane_points, uniform};
use super::strain::rectangle_strain;
use super::{Compensated, CompensationError, CompensationStep, Cylinder, Sheet, patch_size};
use crate::antenna::PatchParams;
use crate::deform::SmoothMap;
use crate::deform::{GreenMap, Warp};
use crate::geometry::{DMat3, DVec2, DVec3};
use crate::task::Task;
use nalgebra::{DMatrix, DVector};

/// What an isometric compensation starts from.
pub struct IsometricProblem<'a> {
    /// The antenna as drawn.
    pub params: &'a PatchParams,
    /// Polynomial degrees of the warp along x and y: (9, 5) for a bend along x, (9, 9) in general.
    pub degrees: [usize; 2],
    /// The cylinder aimed at, if the antenna is bent onto one.
    pub cylinder: Option<Cylinder>,
    /// The map of the cage posed with its bend radius multiplied by a factor (ignored without a cylinder).
    pub map_at: &'a dyn Fn(f64) -> Result<GreenMap, CompensationError>,
}

impl std::fmt::Debug for IsometricProblem<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("IsometricProblem").field("degrees", &self.degrees).finish_non_exhaustive()
    }
}

/// Gauss points along each side of substrate and patch: enough for degree 9 with room to see what it cannot fit.
const GAUSS_POINTS: usize = 15;
/// Weight of a patch point against a substrate point: less strains the patch, more the substrate's corners.
const PATCH_WEIGHT: f64 = 30.0;
/// Weight of the conditions that fix the warp's free motions; they do not compete with the metric, so any large one.
const GAUGE_WEIGHT: f64 = 100.0;
/// Damping of the coefficients' steps relative to the strain residual: keeps directions that hardly matter in place.
const DAMPING: f64 = 1e-6;
/// Iterations after which radius, thickness and warp must have settled; usual bends take 4 to 8.
const MAX_ITERATIONS: usize = 30;
/// Settled when radius and thickness are met to this (relative) and the residual falls by less than this part.
const SETTLED: f64 = 1e-4;
/// Samples along each side of the patch for the strain that is reported with each step.
const STEP_SAMPLES: usize = 11;
/// Curvatures of the map are computed anew while a step still lowers the residual by more than this part.
const STEEP: f64 = 0.3;
/// Halvings of a Gauss-Newton step that leaves the cage or makes things worse, before giving up.
const MAX_HALVINGS: usize = 6;

/// Runs the isometric compensation.
///
/// # Errors
/// [`CompensationError::LeavesCage`] if the warped antenna does not fit its cage, [`CompensationError::Cage`] if the
/// calibrated radius makes no valid cage, [`CompensationError::Diverged`] if it does not settle.
pub fn compensate_isometric(problem: &IsometricProblem<'_>, task: &Task) -> Result<Compensated, CompensationError> {
    let params = problem.params;
    let half = DVec2::new(params.ground_width, params.ground_length) / 2.0;
    let mut state = Fit::new(problem, Warp::scale_with_degrees(half, DVec2::ONE, problem.degrees))?;
    let mut steps = vec![state.step(0.0, 0.0)?];
    let phase = task.phase("compensating isometrically", MAX_ITERATIONS);
    for _ in 0..MAX_ITERATIONS {
        task.check()?;
        let before = state.residual;
        state.gauss_newton()?;
        let thickness_error = state.thickness_error()?;
        let radius_error = state.radius_error()?;
        steps.push(state.step(thickness_error, radius_error)?);
        let fell = (before - state.residual) / before.max(f64::MIN_POSITIVE);
        let settled = thickness_error.abs() < SETTLED && radius_error.abs() < SETTLED;
        if settled && (fell.abs() < 0.01 || state.residual < SETTLED) {
            let Fit { warp, map, radius_factor, .. } = state;
            return Ok(Compensated { warp, patch_scale: DVec2::ONE, radius_factor, map, steps });
        }
        state.correct(thickness_error, radius_error)?;
        phase.advance(1);
    }
    let last = steps[steps.len() - 1];
    Err(CompensationError::Diverged {
        iterations: MAX_ITERATIONS,
        width_percent: last.width_error * 100.0,
        length_percent: last.length_error * 100.0,
    })
}

/// The secant method on a factor's logarithm: the error answers to it with a slope near 1, learnt from the last step.
#[derive(Default)]
struct Secant {
    /// Logarithm of the factor and error at the last step.
    last: Option<(f64, f64)>,
}

impl Secant {
    /// Slopes outside this are a matter of the other quantities that moved, not of the factor.
    const SLOPES: std::ops::RangeInclusive<f64> = 0.5..=2.0;

    /// The factor that should bring the error to zero.
    fn next(&mut self, factor: f64, error: f64) -> f64 {
        let at = factor.ln();
        let slope = self.last.map(|(x, e)| (error - e) / (at - x)).filter(|s| Self::SLOPES.contains(s)).unwrap_or(1.0);
        self.last = Some((at, error));
        (at - error / slope).exp()
    }
}

/// The state of the iteration.
struct Fit<'a> {
    problem: &'a IsometricProblem<'a>,
    warp: Warp,
    map: GreenMap,
    radius_factor: f64,
    /// How heights and radius answered to their last corrections.
    height: Secant,
    radius: Secant,
    /// Flat points where the metric is asked for, with the roots of their weights.
    samples: Vec<(DVec2, f64)>,
    /// Jacobians of the Green map at the warped samples.
    jacobians: Vec<DMat3>,
    /// Second derivatives aa, ab, bb of the Green map there, perhaps of an earlier step: they only steer.
    curvatures: Vec<[DVec3; 3]>,
    /// Root of the weighted mean square of the metric's deviation.
    residual: f64,
}

impl<'a> Fit<'a> {
    fn new(problem: &'a IsometricProblem<'a>, warp: Warp) -> Result<Self, CompensationError> {
        let params = problem.params;
        let nodes: Vec<f64> = gauss_legendre(GAUSS_POINTS).iter().map(|g| g.0).collect();
        let rectangle = |width: f64, length: f64| plane_points(&nodes, &nodes, DVec2::new(width, length) / 2.0, 0.0);
        let substrate = rectangle(params.ground_width, params.ground_length);
        let patch = rectangle(params.width, params.length);
        let weigh = |points: Vec<DVec3>, weight: f64| points.into_iter().map(move |p| (p.truncate(), weight.sqrt()));
        let samples = weigh(substrate, 1.0).chain(weigh(patch, PATCH_WEIGHT)).collect();
        let map = (problem.map_at)(1.0)?;
        let (jacobians, curvatures) = (Vec::new(), Vec::new());
        let mut fit = Self {
            problem,
            warp,
            map,
            radius_factor: 1.0,
            height: Secant::default(),
            radius: Secant::default(),
            samples,
            jacobians,
            curvatures,
            residual: 0.0,
        };
        fit.refresh()?;
        fit.curvatures = fit.second_derivatives()?;
        Ok(fit)
    }

    fn sheet(&self) -> Sheet<'_> {
        Sheet { scale: DVec2::ONE, warp: &self.warp, map: &self.map }
    }

    fn patch_half(&self) -> DVec2 {
        DVec2::new(self.problem.params.width, self.problem.params.length) / 2.0
    }

    /// Jacobians of the Green map at the samples under a warp, and the residual there.
    fn residual_of(&self, warp: &Warp) -> Result<(Vec<DMat3>, f64), CompensationError> {
        let rest: Vec<DVec3> = self.samples.iter().map(|s| warp.map(s.0.extend(0.0))).collect();
        let jacobians: Vec<DMat3> = self.map.jacobians(&rest)?.into_iter().map(|(_, j)| j).collect();
        let (mut sum, mut weights) = (0.0, 0.0);
        for (jacobian, (p, root)) in jacobians.iter().zip(&self.samples) {
            let plane = warp.plane(*p).1;
            let [ru, rv] = [0, 1].map(|k| *jacobian * plane.col(k).extend(0.0));
            sum += root * root * metric_deviation(ru, rv).length_squared();
            weights += root * root;
        }
        Ok((jacobians, (sum / weights).sqrt()))
    }

    /// Brings Jacobians and residual up to date with the warp and the map.
    fn refresh(&mut self) -> Result<(), CompensationError> {
        (self.jacobians, self.residual) = self.residual_of(&self.warp)?;
        Ok(())
    }

    /// One Gauss-Newton step of the warp, shortened until it stays in the cage and does not make things worse.
    fn gauss_newton(&mut self) -> Result<(), CompensationError> {
        let step = self.newton_step();
        let mut part = 1.0;
        let mut refused = None;
        for _ in 0..=MAX_HALVINGS {
            let mut warp = self.warp.clone();
            warp.add(&step.iter().map(|s| *s * part).collect::<Vec<_>>());
            match self.residual_of(&warp) {
                Ok((jacobians, residual)) if residual <= self.residual * 1.000_001 => {
                    let steep = residual < (1.0 - STEEP) * self.residual;
                    (self.warp, self.jacobians, self.residual) = (warp, jacobians, residual);
                    if steep {
                        self.curvatures = self.second_derivatives()?;
                    }
                    return Ok(());
                }
                Ok(_) => {}
                Err(error @ CompensationError::LeavesCage { .. }) => refused = Some(error),
                Err(error) => return Err(error),
            }
            part *= 0.5;
        }
        // No part of the step helps: the warp is as good as it gets, unless the cage is what stops it.
        refused.map_or(Ok(()), Err)
    }

    /// The full step, m per coefficient, from the linearised metric at all samples.
    fn newton_step(&self) -> Vec<DVec2> {
        let n_terms = self.warp.n_terms();
        let scale = self.patch_half().max_element();
        let n_rows = 3 * self.samples.len();
        let mut matrix = DMatrix::<f64>::zeros(n_rows + 3, 2 * n_terms);
        let mut right = DVector::<f64>::zeros(n_rows + 3);
        for (s, (p, root)) in self.samples.iter().enumerate() {
            let plane = self.warp.plane(*p).1;
            let (au, bu, av, bv) = (plane.col(0).x, plane.col(0).y, plane.col(1).x, plane.col(1).y);
            let [ra, rb] = [0, 1].map(|k| self.jacobians[s].col(k));
            let [raa, rab, rbb] = self.curvatures[s];
            let (ru, rv) = (ra * au + rb * bu, ra * av + rb * bv);
            let deviation = metric_deviation(ru, rv);
            // How ru and rv turn when a or b moves by itself (curvature), beside the change of their slopes.
            let curve = [[raa * au + rab * bu, raa * av + rab * bv], [rab * au + rbb * bu, rab * av + rbb * bv]];
            for (k, [value, du, dv]) in self.warp.basis(*p).enumerate() {
                for (c, r) in [ra, rb].into_iter().enumerate() {
                    let change_u = r * du + curve[c][0] * value;
                    let change_v = r * dv + curve[c][1] * value;
                    let rows = [
                        ru.dot(change_u),
                        (ru.dot(change_v) + rv.dot(change_u)) * std::f64::consts::FRAC_1_SQRT_2,
                        rv.dot(change_v),
                    ];
                    for (i, row) in rows.into_iter().enumerate() {
                        matrix[(3 * s + i, c * n_terms + k)] = row * root * scale;
                    }
                }
            }
            for i in 0..3 {
                right[3 * s + i] = -deviation[i] * root;
            }
        }
        self.add_gauge(&mut matrix, &mut right, n_rows, scale);
        let transposed = matrix.transpose();
        let mut normal = &transposed * &matrix;
        let damping = DAMPING * normal.diagonal().mean();
        (0..2 * n_terms).for_each(|i| normal[(i, i)] += damping);
        // Positive definite because of the damping.
        let solved = normal.cholesky().map(|c| c.solve(&(&transposed * &right)));
        let step = solved.unwrap_or_else(|| DVector::zeros(2 * n_terms)) * scale;
        (0..n_terms).map(|k| DVec2::new(step[k], step[n_terms + k])).collect()
    }

    /// Rows that hold the center in place and forbid rotation there.
    fn add_gauge(&self, matrix: &mut DMatrix<f64>, right: &mut DVector<f64>, first: usize, scale: f64) {
        let n_terms = self.warp.n_terms();
        let (center, slopes) = self.warp.plane(DVec2::ZERO);
        for (k, [value, dx, dy]) in self.warp.basis(DVec2::ZERO).enumerate() {
            matrix[(first, k)] = GAUGE_WEIGHT * value;
            matrix[(first + 1, n_terms + k)] = GAUGE_WEIGHT * value;
            matrix[(first + 2, k)] = GAUGE_WEIGHT * dy * scale;
            matrix[(first + 2, n_terms + k)] = -GAUGE_WEIGHT * dx * scale;
        }
        right[first] = -GAUGE_WEIGHT * center.x / scale;
        right[first + 1] = -GAUGE_WEIGHT * center.y / scale;
        right[first + 2] = -GAUGE_WEIGHT * (slopes.col(1).x - slopes.col(0).y);
    }

    /// Second derivatives aa, ab, bb of the Green map at the warped samples, by differences of its Jacobian.
    fn second_derivatives(&self) -> Result<Vec<[DVec3; 3]>, CompensationError> {
        let offset = 1e-4 * self.patch_half().max_element();
        let center: Vec<DVec3> = self.samples.iter().map(|s| self.warp.map(s.0.extend(0.0))).collect();
        // Differences towards the middle, so that no point leaves the cage.
        let toward = |p: DVec3, axis: usize| -offset.copysign(p[axis]);
        let slopes = |axis: usize| -> Result<Vec<DMat3>, CompensationError> {
            let shifted: Vec<DVec3> = center.iter().map(|&p| p + DVec3::AXES[axis] * toward(p, axis)).collect();
            let moved = self.map.jacobians(&shifted)?;
            let slope = |s: usize| (moved[s].1 - self.jacobians[s]) * (1.0 / toward(center[s], axis));
            Ok((0..center.len()).map(slope).collect())
        };
        let (along_a, along_b) = (slopes(0)?, slopes(1)?);
        let at = |(a, b): (DMat3, DMat3)| [a.col(0), (a.col(1) + b.col(0)) / 2.0, b.col(1)];
        Ok(along_a.into_iter().zip(along_b).map(at).collect())
    }

    fn thickness_error(&self) -> Result<f64, CompensationError> {
        Ok(mean_thickness(&self.sheet(), self.patch_half(), self.problem.params.height)? / self.problem.params.height
            - 1.0)
    }

    fn radius_error(&self) -> Result<f64, CompensationError> {
        let Some(cylinder) = self.problem.cylinder else { return Ok(0.0) };
        let samples = uniform(GAUSS_POINTS);
        let images = self.sheet().positions(&plane_points(&samples, &samples, self.patch_half(), 0.0))?;
        Ok(cylinder.fitted_radius(&images) / cylinder.radius.abs() - 1.0)
    }

    /// Changes heights and radius against their errors.
    fn correct(&mut self, thickness_error: f64, radius_error: f64) -> Result<(), CompensationError> {
        self.warp.z_scale = self.height.next(self.warp.z_scale, thickness_error);
        if radius_error.abs() >= SETTLED {
            self.radius_factor = self.radius.next(self.radius_factor, radius_error);
            self.map = (self.problem.map_at)(self.radius_factor)?;
        }
        self.refresh()
    }

    fn step(&self, thickness_error: f64, radius_error: f64) -> Result<CompensationStep, CompensationError> {
        let half = self.patch_half();
        let error = patch_size(&self.sheet(), half, [5, 5])? / (2.0 * half) - 1.0;
        let patch_strain = rectangle_strain(&self.sheet(), half, 0.0, STEP_SAMPLES)?.largest;
        Ok(CompensationStep {
            width_error: error.x,
            length_error: error.y,
            thickness_error,
            radius_error,
            patch_strain,
        })
    }
}

/// `((E - 1)/2, F/√2, (G - 1)/2)`: its squared length is what is minimised.
fn metric_deviation(ru: DVec3, rv: DVec3) -> DVec3 {
    let (e, f, g) = (ru.length_squared(), ru.dot(rv), rv.length_squared());
    DVec3::new((e - 1.0) / 2.0, f * std::f64::consts::FRAC_1_SQRT_2, (g - 1.0) / 2.0)
}
