//! From a project to the deformed antenna, stage by stage, with a worker for the window.
//!
//! ```text
//! Project -> Scene (cage, pose, cylinder) -> Compensated -> split surface -> guard -> figures, fields = Deformed
//! ```
//!
//! [`deform`] does the whole job once. The window asks a [`Worker`](worker::Worker) instead, which answers the newest
//! request only and, while the user drags, moves the last surface's vertices through the new pose without splitting or
//! compensating anew ([`live`]). Where a pose is refused, [`retreat()`] finds the furthest valid project on the way to
//! it. A [`MeshJob`](mesh_job::MeshJob) fills antenna and air with tetrahedra beside all that, and a
//! [`SolveJob`](solve_job::SolveJob) solves the field in them.

mod bodies;
mod bodies_edges;
pub mod compare_job;
mod error;
mod estimate;
mod fields;
pub mod job;
mod kept_fields;
pub mod live;
mod loads;
mod looks;
#[cfg(test)]
pub(crate) mod made_up;
mod marks;
mod mesh;
pub mod mesh_job;
mod retreat;
mod scene;
mod solve;
pub mod solve_job;
mod stages;
mod stored;
mod summary;
pub mod worker;

pub use error::PipelineError;
pub use estimate::{Estimate, estimate};
pub use fields::Fields;
pub use marks::{Mark, MarkKind};
pub use mesh::{Density, MeshSettings, Meshed, Shape, mesh};
pub use retreat::retreat;
pub use scene::Scene;
pub use solve::{Running, SolveSettings, Solved, StopRule, solve};
pub use stages::{Deformed, Stages, Template, apply_cage, deform, exact_cylinder, flat, run};
pub use stored::{Job, RunFigures, Stored, results_dir};
pub use summary::{FiguresReport, summary};
