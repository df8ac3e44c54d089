//! From a change to the picture: what stands between the pointer and the screen while something is dragged or turned.
//!
//! `cargo bench --bench drag`: pictures of 1280 x 800 points on the adapter at hand, waited for until they are done.
//! On a machine without a graphics card that is a software renderer (lavapipe); which one it is, is printed first.

#![allow(clippy::print_stdout, reason = "says on which adapter it measures")]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred tiles on a side")]

use conformant::pipeline::live::Live;
use conformant::pipeline::run;
use conformant::project::{BendPlane, Edit, PresetEntry, PresetSpec, Project, RuleSpec};
use conformant::render::{Array, Camera, Gpu, Paint, Part, Renderer, Scene, Surface, Vec3, View};
use conformant::task::Task;
use divan::{Bencher, black_box};

fn main() {
    match Gpu::headless() {
        Ok(gpu) => println!("adapter: {}", gpu.adapter),
        Err(error) => return println!("nothing to measure: {error}"),
    }
    divan::main();
}

/// Draws scenes and waits for them.
struct Screen {
    gpu: Gpu,
    renderer: Renderer,
    view: View,
}

impl Screen {
    fn new() -> Self {
        let gpu = Gpu::headless().expect("there is an adapter");
        let renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba8Unorm);
        let camera = Camera { distance: 60.0, ..Camera::default() };
        Self { gpu, renderer, view: View::new(camera, 1280.0, 800.0) }
    }

    fn show(&mut self, scene: &Scene) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.prepare(&self.gpu.device, &self.gpu.queue, &mut encoder, scene, &self.view);
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the adapter answers");
    }
}

/// A bent plate of so many thousand triangles.
fn plate(thousands: u32, rise: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let n = (f64::from(thousands) * 500.0).sqrt().round() as u32;
    let at = |k: u32| 20.0 * (k as f32 / n as f32 - 0.5);
    let places = (0..=n).flat_map(|j| (0..=n).map(move |i| (at(i), at(j))));
    let corners = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    (
        places.map(|(x, y)| Vec3::new(x, y, rise * x * x)).collect(),
        corners.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect(),
    )
}

fn scene(positions: Vec<Vec3>, triangles: Array<[u32; 3]>) -> Scene {
    let part = Part::new(triangles, Paint::Metal([200, 117, 70, 255]));
    let surface = Surface { positions: positions.into(), parts: vec![part], scalars: None };
    Scene { background: [20, 22, 26, 255], surfaces: vec![surface], ..Scene::default() }
}

/// Turning the view: nothing is uploaded.
#[divan::bench(args = [10, 100, 500], sample_count = 20)]
fn turn(bencher: Bencher<'_, '_>, thousands: u32) {
    let (positions, triangles) = plate(thousands, -0.02);
    let scene = scene(positions, triangles.into());
    let mut screen = Screen::new();
    bencher.bench_local(|| {
        screen.view.camera.yaw += 0.01;
        screen.show(black_box(&scene));
    });
}

/// Dragging: all positions are uploaded.
#[divan::bench(args = [10, 100, 500], sample_count = 20)]
fn upload_and_draw(bencher: Bencher<'_, '_>, thousands: u32) {
    let triangles: Array<[u32; 3]> = plate(thousands, 0.0).1.into();
    let mut screen = Screen::new();
    let mut rise = 0.0;
    bencher
        .with_inputs(|| {
            rise -= 0.001;
            scene(plate(thousands, rise).0, triangles.clone())
        })
        .bench_local_refs(|scene| screen.show(scene));
}

/// The whole way of the first antenna of the window: a cage vertex moves, the antenna follows, the picture is done.
#[divan::bench(sample_count = 40)]
fn cage_vertex_to_picture(bencher: Bencher<'_, '_>) {
    let bend = PresetSpec::Bend { plane: BendPlane::H, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
    let mut project = Project { presets: vec![PresetEntry { enabled: true, preset: bend }], ..Project::default() };
    project.cage.segments = [10, 4];
    let stages = run(&project, &Task::default()).expect("a valid project");
    let flat = &stages.deformed.flat;
    let triangles: Array<[u32; 3]> = flat.facets.iter().map(|f| f.vertices.map(|v| v.raw())).collect::<Vec<_>>().into();
    let mut live = Live::new(project.clone(), stages, &Task::default()).expect("a preview");
    let mut screen = Screen::new();
    let mut lift = 0.0;
    bencher.bench_local(|| {
        lift = (lift + 0.01) % 0.5;
        Edit::MoveVertices(vec![(3, [0.0, 0.0, lift])]).apply(&mut project).expect("a valid move");
        let deformed = live.preview(&project).expect("a possible pose");
        let positions = deformed.positions.iter().map(|p| (*p * 1e3).as_vec3()).collect();
        screen.show(&scene(positions, triangles.clone()));
    });
}
