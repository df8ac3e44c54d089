//! The radiation pattern as a surface around the antenna: radius and colour by directivity.

use super::polar;
use super::solve_session::{FinishedRun, SolveSession};
use super::ui_state::SolveUi;
use crate::pipeline::solve_job::Pattern;
use crate::render::{Array, ColorMap, Paint, Part, Scalars, Surface, Vec3};

/// Steps of theta from pole to pole; phi has twice as many.
const N_THETA: usize = 60;
/// Radius of the greatest directivity over half the diagonal of the antenna: its lobe stands clear of the antenna.
const REACH: f32 = 1.3;
/// Lets the antenna and the lobes behind be seen through.
const OPACITY: f32 = 0.6;

/// What decides the surface: number of the run, frequency, range, and the antenna's box.
type Key = (u64, u64, u64, [Vec3; 2]);

/// Makes the surface and keeps it while it does not change.
#[derive(Debug, Default)]
pub(super) struct PatternScene {
    made: Option<(Key, Surface)>,
}

impl PatternScene {
    /// The pattern of the newest run on show that has one, around an antenna in the box from `lo` to `hi`, mm.
    pub(super) fn surface(&mut self, solve: &SolveSession, chosen: &SolveUi, [lo, hi]: [Vec3; 2]) -> Option<Surface> {
        let (run, pattern) = pattern(solve, chosen)?;
        let key = (run.serial, pattern.field.freq.to_bits(), chosen.range_db.to_bits(), [lo, hi]);
        if self.made.as_ref().is_none_or(|(made, _)| *made != key) {
            let radius = REACH * (hi - lo).length() / 2.0;
            self.made = Some((key, around((lo + hi) / 2.0, radius, pattern, chosen.range_db)));
        }
        self.made.as_ref().map(|(_, surface)| surface.clone())
    }
}

/// The newest run on show that has a pattern at the frequency on show, with it.
pub(super) fn pattern<'a>(solve: &'a SolveSession, chosen: &SolveUi) -> Option<(&'a FinishedRun, &'a Pattern)> {
    let freq = polar::frequency(solve, chosen)?;
    solve.shown().filter_map(|run| Some((run, polar::pattern(run, freq)?))).max_by_key(|(run, _)| run.serial)
}

/// Ends of the scale of colours, dBi.
pub(super) fn range(pattern: &Pattern, range_db: f64) -> [f32; 2] {
    let rim = pattern.max().0;
    [(rim - range_db) as f32, rim as f32]
}

/// * `radius`: of the greatest directivity, mm; directivity at the low end of the range is in the center.
fn around(center: Vec3, radius: f32, pattern: &Pattern, range_db: f64) -> Surface {
    let field = pattern.field.resampled(N_THETA);
    let values: Vec<f32> = field.directivity().into_iter().map(|dbi| dbi as f32).collect();
    let [lo, hi] = range(pattern, range_db);
    let n_phi = field.phi.len();
    let positions = (0..values.len()).map(|k| {
        let (sin_theta, cos_theta) = field.theta[k / n_phi].sin_cos();
        let (sin_phi, cos_phi) = field.phi[k % n_phi].sin_cos();
        let direction = Vec3::new((sin_theta * cos_phi) as f32, (sin_theta * sin_phi) as f32, cos_theta as f32);
        center + direction * radius * ((values[k] - lo) / (hi - lo)).clamp(0.0, 1.0)
    });
    let positions: Vec<Vec3> = positions.collect();
    let triangles = (0..field.theta.len() - 1).flat_map(|row| (0..n_phi).map(move |column| [row, column]));
    let triangles = triangles.flat_map(|[row, column]| {
        let at = |r: usize, c: usize| (r * n_phi + c % n_phi) as u32;
        let [a, b, c, d] = [at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1)];
        [[a, b, c], [a, c, d]]
    });
    let triangles: Vec<[u32; 3]> = triangles.collect();
    let part = Part { opacity: OPACITY, ..Part::new(Array::new(triangles), Paint::Heat) };
    Surface {
        positions: Array::new(positions),
        parts: vec![part],
        scalars: Some(Scalars { values: Array::new(values), range: [lo, hi], map: ColorMap::Viridis }),
    }
}
