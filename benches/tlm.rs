//! The field in time: million tet-steps per second, beside what memory allows.
//!
//! `cargo bench --bench tlm`; items are cells times steps, bytes what a step must move at least. Before the timings it
//! prints the share of the bandwidth of copying a buffer larger than the caches. One thread with `RAYON_NUM_THREADS=1`.
#![allow(clippy::print_stdout, reason = "the summary is what it is run for")]

use conformant::pipeline::{Density, MeshSettings, Shape, mesh};
use conformant::project::Project;
use conformant::task::Task;
use conformant::tet::{Metal, TetMesh};
use conformant::tlm::{Network, NetworkSettings, Pulse, Run, StepLimit};
use divan::counter::{BytesCount, ItemsCount};
use divan::{Bencher, black_box};
use rayon::prelude::*;
use std::time::Instant;

const STEPS: usize = 64;
const DENSITIES: [Density; 3] = [Density::Coarse, Density::Default, Density::Fine];

fn main() {
    let bandwidth = best_of(5, copy, 2.0 * (COPIED * size_of::<f32>()) as f64);
    println!("copying: {:.1} GB/s with {} threads", bandwidth / 1e9, rayon::current_num_threads());
    for density in DENSITIES {
        let network = network(density);
        let mut run = run(&network);
        let n = (network.n_tets * STEPS) as f64;
        let speed = best_of(5, || advance(&mut run), n);
        println!(
            "{density:?}: {} cells, {:.1} million tet-steps/s, {:.0} bytes each, {:.0} % of the bandwidth",
            network.n_tets,
            speed / 1e6,
            network.traffic(),
            100.0 * speed * network.traffic() / bandwidth
        );
    }
    divan::main();
}

/// Largest amount per second over some calls.
fn best_of(n: usize, mut work: impl FnMut(), amount: f64) -> f64 {
    let mut second = || {
        let started = Instant::now();
        work();
        amount / started.elapsed().as_secs_f64()
    };
    (0..n).map(|_| second()).fold(0.0, f64::max)
}

const COPIED: usize = 1 << 27;

fn copy() {
    thread_local! {
        static BUFFERS: std::cell::RefCell<(Vec<f32>, Vec<f32>)> =
            std::cell::RefCell::new((vec![1.0; COPIED], vec![2.0; COPIED]));
    }
    BUFFERS.with_borrow_mut(|(from, to)| {
        to.par_chunks_mut(1 << 20).zip(from.par_chunks(1 << 20)).for_each(|(to, from)| to.copy_from_slice(from));
        black_box(to);
    });
}

fn flat(density: Density) -> TetMesh {
    let settings = MeshSettings { density, metal: Metal::Sheet };
    mesh(&Project::default(), Shape::Flat, settings, &Task::default()).expect("the paper's antenna").mesh
}

fn network(density: Density) -> Network<f32> {
    let settings = NetworkSettings { step: StepLimit::Clip(0.003), ..NetworkSettings::new(10.5e9) };
    Network::new(&flat(density), &settings, &Task::default()).expect("a coaxial port")
}

fn run(network: &Network<f32>) -> Run<'_, f32> {
    let mut run = Run::new(network, Pulse::new(7e9, 14e9).expect("a band"));
    // Into the pulse, so that there is a field.
    run.advance(1000, &Task::default()).expect("not cancelled");
    run
}

fn advance(run: &mut Run<'_, f32>) {
    run.advance(STEPS, &Task::default()).expect("not cancelled");
}

/// Steps of the flat antenna's field.
#[divan::bench(args = DENSITIES, sample_count = 20)]
fn steps(bencher: Bencher<'_, '_>, density: Density) {
    let network = network(density);
    let mut run = run(&network);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of bytes")]
    let bytes = (network.traffic() * (network.n_tets * STEPS) as f64) as usize;
    let n_items = network.n_tets * STEPS;
    bencher.counter(ItemsCount::new(n_items)).counter(BytesCount::new(bytes)).bench_local(|| advance(&mut run));
}

/// From mesh to coefficients.
#[divan::bench(args = DENSITIES, sample_count = 3)]
fn preparing(bencher: Bencher<'_, '_>, density: Density) {
    let mesh = flat(density);
    let settings = NetworkSettings { step: StepLimit::Clip(0.003), ..NetworkSettings::new(10.5e9) };
    let work = || Network::<f32>::new(black_box(&mesh), &settings, &Task::default()).expect("a coaxial port").n_tets;
    bencher.counter(ItemsCount::new(mesh.tets.len())).bench(work);
}
