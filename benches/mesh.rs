//! Tetrahedra: filling the air around the golden flat antenna from fifty thousand to two million cells, and whole meshes.
//!
//! `cargo bench --bench mesh`; items are tetrahedra. One thread with `RAYON_NUM_THREADS=1`.

use conformant::io::surface_json::read_surface;
use conformant::pipeline::{Density, MeshSettings, Shape, mesh};
use conformant::project::Project;
use conformant::task::Task;
use conformant::tet::{Metal, SizingSettings, fill};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::path::Path;

fn main() {
    divan::main();
}

/// All regions of one surface with ever shorter edges in the air: (longest edge in mm, grading).
#[divan::bench(args = [(3.0, 0.9), (1.6, 0.3), (0.9, 0.25), (0.62, 0.2)], sample_count = 3)]
fn fill_all_regions(bencher: Bencher<'_, '_>, (h_max_mm, grading): (f64, f64)) {
    let surface = read_surface(Path::new("tests/golden/mesh/flat_A.json.gz")).expect("the golden surface");
    let settings = SizingSettings { h_max: h_max_mm * 1e-3, grading };
    let run = || fill(black_box(&surface), &[], settings, &Task::default()).expect("it can be filled");
    let n_tets = run().mesh.tets.len();
    bencher.counter(ItemsCount::new(n_tets)).bench(run);
}

/// The paper's flat antenna in air, from the project.
#[divan::bench(args = [Density::Coarse, Density::Default, Density::Fine], sample_count = 3)]
fn whole_antenna(bencher: Bencher<'_, '_>, density: Density) {
    let settings = MeshSettings { density, metal: Metal::Sheet };
    let run = || mesh(&Project::default(), Shape::Flat, settings, &Task::default()).expect("the paper's antenna");
    bencher.counter(ItemsCount::new(run().mesh.tets.len())).bench(run);
}
