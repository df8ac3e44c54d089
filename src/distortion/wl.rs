//! Width-and-length (WL) compensation: the paper's scaling of the flat antenna.
//!
//! Measure the deformed patch's width and length by a fitted polynomial, divide the flat ones by the relative errors,
//! repeat until both are met. The paper prints `W -> W'/s_W`; what makes sense, and is done here, is `W -> W/s_W`
//! with `s_W = W'/W_0`. Scales the whole flat antenna, or the patch and its feed place alone.

use super::{Compensated, CompensationError, CompensationStep, Sheet, patch_size};
use crate::antenna::PatchParams;
use crate::deform::{GreenMap, Warp};
use crate::geometry::DVec2;
use crate::task::Task;

/// What the compensation scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// The whole flat antenna: patch, substrate, ground and feed place.
    Whole,
    /// The patch and its feed place.
    Patch,
}

/// What a WL compensation starts from.
#[derive(Clone, Copy, Debug)]
pub struct WlProblem<'a> {
    /// The antenna as drawn: its width and length are the aim.
    pub params: &'a PatchParams,
    /// The map of the posed cage.
    pub map: &'a GreenMap,
    /// What is scaled.
    pub scope: Scope,
    /// Polynomial degrees across width and length.
    pub orders: [usize; 2],
}

/// Both relative errors must be below this: a tenth of what shifts a resonance visibly.
pub const TOLERANCE: f64 = 3e-4;
/// A converging case takes 2 to 5.
const MAX_ITERATIONS: usize = 30;
/// Scales beyond this are a runaway, not a compensation.
const MAX_SCALE: f64 = 6.0;
/// Rescalings after which the error must have fallen below its start.
const PATIENCE: usize = 6;

/// Runs the WL compensation.
///
/// # Errors
/// [`CompensationError::Diverged`] if it runs away or does not settle, [`CompensationError::LeavesCage`] if the scaled
/// antenna does not fit its cage.
pub fn compensate_wl(problem: &WlProblem<'_>, task: &Task) -> Result<Compensated, CompensationError> {
    let params = problem.params;
    let half = DVec2::new(params.ground_width, params.ground_length) / 2.0;
    let patch = DVec2::new(params.width, params.length);
    let identity = Warp::identity(half);
    let mut scale = DVec2::ONE;
    let mut steps: Vec<CompensationStep> = Vec::new();
    let phase = task.phase("compensating width and length", MAX_ITERATIONS);
    loop {
        task.check()?;
        let sheet = Sheet { scale, warp: &identity, map: problem.map };
        let error = patch_size(&sheet, patch / 2.0, problem.orders)? / patch - 1.0;
        steps.push(CompensationStep { width_error: error.x, length_error: error.y, ..CompensationStep::default() });
        if error.abs().max_element() < TOLERANCE {
            break;
        }
        let started = DVec2::new(steps[0].width_error, steps[0].length_error).abs().max_element();
        let stuck = steps.len() > PATIENCE && error.abs().max_element() >= started.min(0.1);
        scale /= 1.0 + error;
        let runaway = !scale.is_finite() || scale.max_element() > MAX_SCALE || scale.min_element() < 1.0 / MAX_SCALE;
        if stuck || runaway || steps.len() > MAX_ITERATIONS {
            return Err(diverged(steps.len(), error));
        }
        phase.advance(1);
    }
    let (warp, patch_scale) = match problem.scope {
        Scope::Whole => (Warp::scale(half, scale), DVec2::ONE),
        Scope::Patch => (identity, scale),
    };
    Ok(Compensated { warp, patch_scale, radius_factor: 1.0, map: problem.map.clone(), steps })
}

fn diverged(iterations: usize, error: DVec2) -> CompensationError {
    CompensationError::Diverged { iterations, width_percent: error.x * 100.0, length_percent: error.y * 100.0 }
}
