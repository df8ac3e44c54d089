//! The sweep: the paper's antenna in cages of many paddings and segment counts, bent to many radii by both rules.
//!
//! Weights depend on the cage alone, so each cage is prepared once and posed for every radius and rule.

use crate::antenna::PatchParams;
use crate::cage::{Axis, BendRule, Cage, CageParams, Preset, PresetError, check_pose, pose};
use crate::deform::{DeformError, GreenCage, GreenMap, Pose, Warp};
use crate::distortion::{
    Compensated, CompensationError, Cylinder, IsometricProblem, RhoGrid, Scope, Sheet, WlProblem, compensate_isometric,
    compensate_wl,
};
use crate::geometry::{DVec2, DVec3};
use crate::project::AntennaSpec;
use crate::task::{Cancelled, Task};
use crate::units::{from_mm, to_mm};
use anyhow::Result;
use std::sync::Arc;

/// Bend radii, mm.
pub(super) const RADII_MM: [f64; 20] =
    [4.2, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0, 9.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0];
/// Paddings, mm.
pub(super) const PADDINGS_MM: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
/// Segments along the curve.
pub(super) const SEGMENTS: [usize; 6] = [2, 4, 6, 8, 10, 12];
/// Paddings that are compensated, mm.
pub(super) const COMPENSATED_PADDINGS_MM: [f64; 2] = [1.0, 3.0];
/// Degrees of the fit across width and length alike.
pub(super) const ORDERS: [usize; 3] = [2, 3, 5];
/// Segments where their number is not what varies.
pub(super) const USUAL_SEGMENTS: usize = 10;
/// Radii of the isometric compensation at the last of these paddings, mm: it takes ten times as long as WL, and its
/// curve is smooth.
pub(super) const ISOMETRIC_RADII_MM: [f64; 9] = [5.0, 6.0, 7.0, 8.0, 10.0, 15.0, 20.0, 40.0, 100.0];
/// Polynomial degrees of the isometric warp for a bend along x.
const WARP_DEGREES: [usize; 2] = [9, 5];

/// The rules, with their names.
pub(super) const RULES: [(BendRule, &str); 2] = [(BendRule::Tangent, "tangent"), (BendRule::Arc, "arc")];

/// One point of the sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Case {
    pub(super) rule: BendRule,
    pub(super) padding_mm: f64,
    pub(super) segments: usize,
    pub(super) radius_mm: f64,
}

/// Surface errors of patch and substrate without compensation, or why the cage is refused.
pub(super) struct Raw {
    pub(super) case: Case,
    pub(super) rho: Result<[f64; 2], String>,
}

/// How an antenna was compensated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// WL of the patch alone, with these polynomial degrees.
    Wl(usize),
    Isometric,
}

impl Method {
    /// Whether a case is computed by this method.
    pub(super) fn covers(self, case: Case) -> bool {
        let is = |a: f64, b: f64| a.total_cmp(&b).is_eq();
        match self {
            Self::Wl(_) => true,
            Self::Isometric => {
                is(case.padding_mm, COMPENSATED_PADDINGS_MM[1])
                    && ISOMETRIC_RADII_MM.iter().any(|&r| is(r, case.radius_mm))
            }
        }
    }
}

/// A compensated antenna, or why there is none.
pub(super) struct Compensation {
    pub(super) case: Case,
    pub(super) method: Method,
    pub(super) found: Result<Found, String>,
}

/// What a compensation comes to.
pub(super) struct Found {
    pub(super) rescalings: usize,
    /// Width and length of the flat patch, as compensated, mm.
    pub(super) flat_mm: DVec2,
    /// Width and length of the deformed patch without compensation, mm.
    pub(super) raw_mm: DVec2,
    pub(super) rho: [f64; 2],
}

/// The whole sweep.
pub(super) struct Sweep {
    pub(super) params: PatchParams,
    /// The exact cylinder's own surface errors, by [`RADII_MM`].
    pub(super) ideal: Vec<[f64; 2]>,
    pub(super) raw: Vec<Raw>,
    pub(super) compensated: Vec<Compensation>,
}

impl Sweep {
    pub(super) fn compute(task: &Task) -> Result<Self> {
        let params = AntennaSpec::default().to_params();
        let grid = RhoGrid::new(&params);
        let ideal = |radius_mm| grid.rho_of(&cylinder(radius_mm), &cylinder(radius_mm));
        let ideal = RADII_MM.into_iter().map(ideal).collect::<Result<_, _>>()?;
        let mut sweep = Self { params, ideal, raw: Vec::new(), compensated: Vec::new() };
        let phase = task.phase("surface error over radius", PADDINGS_MM.len() * SEGMENTS.len());
        for padding_mm in PADDINGS_MM {
            for segments in SEGMENTS {
                let bench = Bench::new(&sweep.params, &grid, padding_mm, segments)?;
                bench.raw(&mut sweep.raw, task)?;
                phase.advance(1);
            }
        }
        sweep.compensate(&grid, task)?;
        Ok(sweep)
    }

    fn compensate(&mut self, grid: &RhoGrid, task: &Task) -> Result<()> {
        let params = self.params.clone();
        let phase = task.phase("compensations over radius", COMPENSATED_PADDINGS_MM.len() * (ORDERS.len() + 1));
        for padding_mm in COMPENSATED_PADDINGS_MM {
            let bench = Bench::new(&params, grid, padding_mm, USUAL_SEGMENTS)?;
            for method in ORDERS.map(Method::Wl).into_iter().chain([Method::Isometric]) {
                for case in bench.cases().filter(|&case| method.covers(case)) {
                    let found = bench.compensated(case, method, self.raw_rho(case), task)?;
                    self.compensated.push(Compensation { case, method, found });
                }
                phase.advance(1);
            }
        }
        Ok(())
    }

    /// Surface errors of a case without compensation, or why its cage is refused.
    pub(super) fn raw_rho(&self, case: Case) -> Result<[f64; 2], String> {
        let row = self.raw.iter().find(|r| r.case == case);
        row.expect("every compensated and plotted case is part of the sweep without compensation").rho.clone()
    }
}

/// One cage, ready to be posed.
struct Bench<'a> {
    params: &'a PatchParams,
    grid: &'a RhoGrid,
    padding_mm: f64,
    segments: usize,
    cage: Cage,
    green: Arc<GreenCage>,
}

impl<'a> Bench<'a> {
    fn new(params: &'a PatchParams, grid: &'a RhoGrid, padding_mm: f64, segments: usize) -> Result<Self> {
        let padding = DVec3::splat(from_mm(padding_mm));
        let cage = Cage::around(params.bounds(), &CageParams { padding, segments: [segments, 1] })?;
        let green = Arc::new(GreenCage::new(cage.mesh.clone())?);
        Ok(Self { params, grid, padding_mm, segments, cage, green })
    }

    fn cases(&self) -> impl Iterator<Item = Case> + use<> {
        let (padding_mm, segments) = (self.padding_mm, self.segments);
        RULES
            .into_iter()
            .flat_map(move |(rule, _)| RADII_MM.map(|radius_mm| Case { rule, padding_mm, segments, radius_mm }))
    }

    /// Posed vertices with the bend radius multiplied by a factor.
    fn posed(&self, case: Case, factor: f64) -> Result<Vec<DVec3>, PresetError> {
        let radius = from_mm(case.radius_mm) * factor;
        let bend = Preset::Bend { axis: Axis::X, radius, rule: case.rule, kept_plane: 0.0 };
        pose(&self.cage, &[bend]).map_err(|(_, error)| error)
    }

    fn map(&self, case: Case, factor: f64) -> Result<GreenMap, CompensationError> {
        let posed = Pose::new(&self.green, &self.posed(case, factor)?)?;
        Ok(GreenMap::new(Arc::clone(&self.green), posed))
    }

    /// The pose of a case, or why its cage is refused.
    fn pose(&self, case: Case) -> Result<Pose, String> {
        let posed = self.posed(case, 1.0).map_err(|error| error.to_string())?;
        check_pose(&self.cage, &posed).map_err(|error| error.to_string())?;
        Pose::new(&self.green, &posed).map_err(|error| error.to_string())
    }

    fn raw(&self, rows: &mut Vec<Raw>, task: &Task) -> Result<()> {
        let weights = self.green.weights(&self.grid.points(DVec2::ONE), task)?;
        for case in self.cases() {
            task.check()?;
            let rho = self.pose(case).map(|pose| self.grid.rho(&weights.apply(&pose)));
            rows.push(Raw { case, rho });
        }
        Ok(())
    }

    fn compensated(
        &self,
        case: Case,
        method: Method,
        raw: Result<[f64; 2], String>,
        task: &Task,
    ) -> Result<Result<Found, String>, Cancelled> {
        let raw = match raw {
            Ok(raw) => raw,
            Err(reason) => return Ok(Err(reason)),
        };
        match self.solve(case, method, task).and_then(|solved| Ok(self.found(&solved, case, method, raw)?)) {
            Ok(found) => Ok(Ok(found)),
            Err(CompensationError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => Ok(Err(error.to_string())),
        }
    }

    fn solve(&self, case: Case, method: Method, task: &Task) -> Result<Compensated, CompensationError> {
        match method {
            Method::Wl(order) => {
                let map = self.map(case, 1.0)?;
                let orders = [order; 2];
                compensate_wl(&WlProblem { params: self.params, map: &map, scope: Scope::Patch, orders }, task)
            }
            Method::Isometric => {
                let map_at = |factor| self.map(case, factor);
                let problem = IsometricProblem {
                    params: self.params,
                    degrees: WARP_DEGREES,
                    cylinder: Some(cylinder(case.radius_mm)),
                    map_at: &map_at,
                };
                compensate_isometric(&problem, task)
            }
        }
    }

    fn found(&self, solved: &Compensated, case: Case, method: Method, raw: [f64; 2]) -> Result<Found, DeformError> {
        let sheet = |scale| Sheet { scale, warp: &solved.warp, map: &solved.map };
        let patch = sheet(solved.patch_scale);
        let rho = match method {
            // WL of the patch alone leaves the substrate as it is: no need to map it again.
            Method::Wl(_) => [self.grid.rho_of(&patch, &cylinder(case.radius_mm))?[0], raw[1]],
            Method::Isometric => self.grid.rho_of(&patch, &sheet(DVec2::ONE))?,
        };
        let size = DVec2::new(to_mm(self.params.width), to_mm(self.params.length));
        let start = solved.steps.first().copied().unwrap_or_default();
        Ok(Found {
            rescalings: solved.steps.len().saturating_sub(1),
            flat_mm: flat_size(&solved.warp, size * solved.patch_scale),
            raw_mm: size * (DVec2::ONE + DVec2::new(start.width_error, start.length_error)),
            rho,
        })
    }
}

/// The exact cylinder of a radius in mm.
fn cylinder(radius_mm: f64) -> Cylinder {
    Cylinder { axis: Axis::X, radius: from_mm(radius_mm), kept_plane: 0.0 }
}

/// Width and length of the patch's outline after the warp, along its center lines.
fn flat_size(warp: &Warp, size_mm: DVec2) -> DVec2 {
    let half = size_mm * from_mm(0.5);
    let at = |p: DVec2| warp.plane(p).0;
    let span = |axis: DVec2| to_mm(at(half * axis).distance(at(-half * axis)));
    DVec2::new(span(DVec2::X), span(DVec2::Y))
}
