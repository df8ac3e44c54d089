//! From project to deformed antenna: splitting, compensation and the whole job, over cage sizes and tolerances.
//!
//! `cargo bench --bench pipeline`; one thread with `RAYON_NUM_THREADS=1`.

use conformant::deform::{SplitSettings, split};
use conformant::pipeline::live::Live;
use conformant::pipeline::{Stages, run};
use conformant::project::{BendPlane, CompensationMode, PresetEntry, PresetSpec, Project, RuleSpec};
use conformant::task::Task;
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// The paper's antenna bent to a radius in the H plane, in a cage of N x `along_y` segments.
fn bent(radius_mm: f64, along_y: usize, mode: CompensationMode) -> Project {
    let preset = PresetSpec::Bend { plane: BendPlane::H, radius_mm, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    let mut project = Project { presets: vec![PresetEntry { enabled: true, preset }], ..Project::default() };
    project.cage.segments = [10, along_y];
    project.settings.compensation = mode;
    project
}

fn stages(project: &Project) -> Stages {
    run(project, &Task::default()).expect("a valid project")
}

/// The whole job with isometric compensation; items are vertices of the deformed surface.
#[divan::bench(args = [1, 10], sample_count = 10)]
fn whole_with_compensation(bencher: Bencher<'_, '_>, along_y: usize) {
    let project = bent(10.0, along_y, CompensationMode::Isometric);
    let vertices = stages(&project).deformed.positions.len();
    bencher.counter(ItemsCount::new(vertices)).bench(|| stages(black_box(&project)));
}

/// The whole job at the tolerance that gives about five thousand vertices; items are vertices.
#[divan::bench(args = [0.01, 0.005, 0.0025], sample_count = 10)]
fn whole_at_tolerance(bencher: Bencher<'_, '_>, tolerance_mm: f64) {
    let mut project = bent(10.0, 1, CompensationMode::Isometric);
    project.settings.tolerance_mm = tolerance_mm;
    let vertices = stages(&project).deformed.positions.len();
    bencher.counter(ItemsCount::new(vertices)).bench(|| stages(black_box(&project)));
}

/// Compensation and figures beside a job without compensation.
#[divan::bench(args = [CompensationMode::None, CompensationMode::Wl, CompensationMode::Isometric], sample_count = 10)]
fn whole_by_mode(bencher: Bencher<'_, '_>, mode: CompensationMode) {
    let project = bent(10.0, 1, mode);
    bencher.bench(|| stages(black_box(&project)));
}

/// Edge splitting alone, of a closed-form wave; items are vertices made.
#[divan::bench(args = [20e-6, 5e-6, 1e-6], sample_count = 10)]
fn splitting(bencher: Bencher<'_, '_>, tolerance: f64) {
    let flat = conformant::antenna::flat_complex(&Project::default().antenna.to_params()).expect("valid");
    let wave = |points: &[conformant::geometry::DVec3]| {
        Ok(points.iter().map(|p| p.with_z(p.z + 1e-3 * (p.x * 500.0).sin() * (p.y * 300.0).cos())).collect())
    };
    let settings = SplitSettings::with_tolerance(tolerance);
    let vertices = split(flat.clone(), wave, settings, &Task::default()).expect("smooth").images.len();
    bencher
        .counter(ItemsCount::new(vertices))
        .with_inputs(|| flat.clone())
        .bench_values(|flat| split(flat, wave, settings, &Task::default()));
}

/// One preview of a dragged cage vertex; items are vertices of the surface.
#[divan::bench(args = [1, 10], sample_count = 50)]
fn preview(bencher: Bencher<'_, '_>, along_y: usize) {
    let project = bent(10.0, along_y, CompensationMode::Isometric);
    let start = stages(&project);
    let vertices = start.deformed.positions.len();
    let mut live = Live::new(project.clone(), start, &Task::default()).expect("inside");
    let mut dragged = project;
    let mut step = 0.0;
    bencher.counter(ItemsCount::new(vertices)).bench_local(|| {
        step += 0.001;
        dragged.hand_edits.insert(5, [0.0, 0.0, step]);
        live.preview(&dragged)
    });
}
