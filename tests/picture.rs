//! Pictures drawn on a real adapter. Without one they say so and pass, unless `REQUIRE_GPU=1` is set.

#![cfg(feature = "gui")]
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use conformant::render::{
    Array, Camera, ColorMap, Counts, Gizmo, GizmoPart, Gpu, Grid, HandleState, Handles, Lines, Paint, Part, Picture,
    Projection, Renderer, Rgba, Scalars, Scene, StandardView, Surface, Vec3, View, colormap, picture,
};

const NIGHT: Rgba = [20, 22, 26, 255];

fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(e) if std::env::var("REQUIRE_GPU").is_ok_and(|v| v == "1") => panic!("an adapter is required: {e}"),
        Err(e) => {
            eprintln!("skipped: {e}");
            None
        }
    }
}

fn from_above(projection: Projection) -> View {
    let mut camera = Camera { distance: 100.0, projection, ..Camera::default() };
    camera.look_from(StandardView::Top);
    View::new(camera, 200.0, 150.0)
}

fn square(half: f32, z: f32) -> [Vec3; 4] {
    [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| Vec3::new(x, y, z))
}

/// A plate of 20 mm whose field runs from 0 at its left to 1 at its right side.
fn plate(paint: Paint, map: ColorMap) -> Surface {
    let positions: Array<Vec3> = square(10.0, 0.0).to_vec().into();
    let scalars = Scalars { values: vec![0.0, 1.0, 1.0, 0.0].into(), range: [0.25, 0.75], map };
    let part = Part::new(vec![[0, 1, 2], [0, 2, 3]].into(), paint);
    Surface { positions, parts: vec![part], scalars: Some(scalars) }
}

fn scene(surface: Surface) -> Scene {
    Scene { background: NIGHT, surfaces: vec![surface], ..Scene::default() }
}

#[track_caller]
fn assert_near(found: Rgba, expected: Rgba, most: u8, what: &str) {
    let off = (0..4).map(|c| found[c].abs_diff(expected[c])).max().expect("four channels");
    assert!(off <= most, "{what}: {found:?} instead of {expected:?}");
}

fn opaque([r, g, b]: [u8; 3]) -> Rgba {
    [r, g, b, 255]
}

/// Color where a point of the scene lands.
fn at(picture: &Picture, view: &View, point: Vec3) -> Rgba {
    let place = view.project(point).expect("in front of the eye").at.as_uvec2();
    picture.at(place.x, place.y)
}

#[test]
fn an_empty_scene_is_its_background() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { background: NIGHT, ..Scene::default() };
    let picture = picture(&gpu, &scene, &from_above(Projection::Perspective)).unwrap();
    assert_eq!((picture.width, picture.height, picture.pixels.len()), (200, 150, 30_000), "size");
    assert!(picture.pixels.iter().all(|&p| p == NIGHT), "one colour");
    assert!(picture.png().unwrap().starts_with(b"\x89PNG"), "a PNG file");
}

#[test]
fn a_field_facing_the_eye_has_the_colors_of_its_legend() {
    let Some(gpu) = gpu() else { return };
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for map in ColorMap::ALL {
            let view = from_above(projection);
            let picture = picture(&gpu, &scene(plate(Paint::Heat, map)), &view).unwrap();
            let legend = |t| opaque(colormap::color(map, t));
            let seen = |x| at(&picture, &view, Vec3::new(x, 1.0, 0.0));
            assert_near(seen(-8.0), legend(0.0), 1, "low end, clamped");
            assert_near(seen(8.0), legend(1.0), 1, "high end, clamped");
            assert_near(seen(0.0), legend(0.5), 6, "the middle, within a texel's step");
            assert_eq!(at(&picture, &view, Vec3::new(14.0, 0.0, 0.0)), NIGHT, "beside the plate");
        }
    }
}

#[test]
fn both_sides_are_seen_unless_back_faces_are_left_out() {
    let Some(gpu) = gpu() else { return };
    let mut view = from_above(Projection::Perspective);
    view.camera.look_from(StandardView::Bottom);
    let mut surface = plate(Paint::Matt([90, 160, 120, 255]), ColorMap::Viridis);
    let below = |surface: &Surface| at(&picture(&gpu, &scene(surface.clone()), &view).unwrap(), &view, Vec3::X);
    assert_ne!(below(&surface), NIGHT, "two-sided");
    surface.parts[0].cull_back = true;
    assert_eq!(below(&surface), NIGHT, "front faces only");
}

#[test]
fn a_sheet_of_copper_hides_the_substrate_right_below_it() {
    let Some(gpu) = gpu() else { return };
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let view = from_above(projection);
        let copper = plate(Paint::Metal([200, 117, 70, 255]), ColorMap::Viridis);
        let mut substrate = plate(Paint::Matt([60, 200, 220, 255]), ColorMap::Viridis);
        substrate.positions = square(12.0, -0.035).to_vec().into();
        let both = Scene { background: NIGHT, surfaces: vec![substrate, copper.clone()], ..Scene::default() };
        let [alone, both] = [scene(copper), both].map(|s| picture(&gpu, &s, &view).unwrap());
        for x in [-9.0, -3.0, 4.0, 9.0] {
            let place = Vec3::new(x, 2.0, 0.0);
            assert_eq!(at(&both, &view, place), at(&alone, &view, place), "{projection:?} at x = {x}");
        }
    }
}

#[test]
fn a_ghost_lets_through_what_is_behind() {
    let Some(gpu) = gpu() else { return };
    let view = from_above(Projection::Orthographic);
    let mut ghost = plate(Paint::Matt([255, 255, 255, 255]), ColorMap::Viridis);
    ghost.parts[0].opacity = 0.25;
    ghost.parts[0].cull_back = true;
    let picture = picture(&gpu, &scene(ghost), &view).unwrap();
    let [r, ..] = at(&picture, &view, Vec3::X);
    assert!(r > NIGHT[0] + 30 && r < 110, "between the ghost and the background: {r}");
}

#[test]
fn handles_and_lines_lie_on_top_and_are_dimmed_when_hidden() {
    let Some(gpu) = gpu() else { return };
    let view = from_above(Projection::Perspective);
    let mut scene = scene(plate(Paint::Matt([70, 70, 70, 255]), ColorMap::Viridis));
    let positions: Array<Vec3> =
        vec![Vec3::new(-6.0, 5.0, 0.0), Vec3::new(6.0, 5.0, 0.0), Vec3::new(0.0, -5.0, -3.0)].into();
    let red = [230, 40, 40, 255];
    let handles = Handles {
        positions: positions.clone(),
        states: vec![HandleState::Selected].into(),
        fills: [[240, 240, 240, 255], [0; 4], red, [0; 4]],
        outline: [0, 0, 0, 255],
        radius: 4.0,
        hidden: 0.25,
    };
    let line = Lines {
        positions: positions.clone(),
        edges: vec![[0, 1]].into(),
        color: [0, 90, 255, 255],
        width: 3.0,
        hidden: 0.0,
    };
    scene.handles = Some(handles);
    scene.lines = vec![line];
    let picture = picture(&gpu, &scene, &view).unwrap();
    assert_near(at(&picture, &view, positions[0]), red, 1, "a selected handle on the plate");
    assert_near(at(&picture, &view, positions[1]), [240, 240, 240, 255], 1, "one at rest");
    assert_near(at(&picture, &view, Vec3::new(0.0, 5.0, 0.0)), [0, 90, 255, 255], 1, "a line in the plate's plane");
    let [plate, ..] = at(&picture, &view, Vec3::new(4.0, -5.0, 0.0));
    let [hidden, ..] = at(&picture, &view, positions[2]);
    assert!(hidden > plate + 20 && hidden < 180, "a hidden handle shows faintly: {hidden} over {plate}");
}

#[test]
fn the_gizmo_is_on_top_and_the_grid_is_behind() {
    let Some(gpu) = gpu() else { return };
    let mut view = from_above(Projection::Orthographic);
    view.size *= 2.0;
    let mut scene = scene(plate(Paint::Matt([70, 70, 70, 255]), ColorMap::Viridis));
    let green = [0, 200, 0, 255];
    scene.grid = Some(Grid { z: 0.0, spacing: 5.0, color: [255, 255, 255, 255], axes: [[255, 0, 0, 255], green] });
    let before = picture(&gpu, &scene, &view).unwrap();
    let [r, g, b, _] = at(&before, &view, Vec3::new(0.0, 18.0, 0.0));
    assert!(g > 150 && r < 80 && b < 80, "the smoothed y axis outside of the plate: {r} {g} {b}");
    let inside = at(&before, &view, Vec3::new(0.0, 7.0, 0.0));
    assert!(inside[1].abs_diff(inside[0]) < 10, "no grid through the plate: {inside:?}");
    let blue = [40, 80, 250, 255];
    let yellow = [250, 220, 40, 255];
    scene.gizmo = Some(Gizmo {
        center: Vec3::ZERO,
        is_whole: true,
        colors: [blue; 4],
        hot: Some(GizmoPart::Center),
        hot_color: yellow,
    });
    let after = picture(&gpu, &scene, &view).unwrap();
    let shaft = view.project(Vec3::ZERO).unwrap().at.as_uvec2();
    assert_near(after.at(shaft.x + 35, shaft.y), blue, 1, "the arrow along x");
    assert_near(after.at(shaft.x + 92, shaft.y), blue, 1, "the knob beyond its tip");
    assert_near(after.at(shaft.x - 36, shaft.y + 35), blue, 1, "the ring about z");
    assert_near(after.at(shaft.x + 1, shaft.y + 1), yellow, 1, "the center under the pointer");
}

#[test]
fn an_unchanged_scene_is_not_drawn_again_and_a_moved_one_is() {
    let Some(gpu) = gpu() else { return };
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Bgra8Unorm);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut scene = scene(plate(Paint::Heat, ColorMap::Viridis));
    let view = from_above(Projection::Perspective);
    let mut draw = |scene: &Scene, view: &View| renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, scene, view);
    assert!(draw(&scene, &view), "the first picture");
    assert!(!draw(&scene.clone(), &view), "nothing changed");
    scene.surfaces[0].positions = square(9.0, 1.0).to_vec().into();
    assert!(draw(&scene, &view), "positions changed");
    assert!(draw(&scene, &View { scale: 2.0, ..view }), "the scale changed");
}

#[test]
fn impossible_sizes_are_errors() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::default();
    for (width, height) in [(0.0, 10.0), (1.0e6, 10.0)] {
        let view = View::new(Camera::default(), width, height);
        assert!(picture(&gpu, &scene, &view).is_err(), "{width} x {height}");
    }
}

/// A plate of 2 n² triangles, bent by `rise`.
fn tiles(n: u32, rise: f32) -> Vec<Vec3> {
    let at = |k: u32| 20.0 * (k as f32 / n as f32 - 0.5);
    let places = (0..=n).flat_map(|j| (0..=n).map(move |i| (at(i), at(j))));
    places.map(|(x, y)| Vec3::new(x, y, rise * x * x)).collect()
}

fn tile_triangles(n: u32) -> Vec<[u32; 3]> {
    let corners = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    corners.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect()
}

/// Draws a scene as the window does; what that added to the counts.
fn added(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, view: &View) -> Counts {
    let before = renderer.counts();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, scene, view);
    gpu.queue.submit([encoder.finish()]);
    let after = renderer.counts();
    Counts {
        pictures: after.pictures - before.pictures,
        positions: after.positions - before.positions,
        values: after.values - before.values,
        triangles: after.triangles - before.triangles,
        lines: after.lines - before.lines,
        handles: after.handles - before.handles,
        gizmo: after.gizmo - before.gizmo,
        bytes: after.bytes - before.bytes,
    }
}

#[test]
fn half_a_million_triangles_are_uploaded_once_and_then_only_what_changes() {
    let Some(gpu) = gpu() else { return };
    let n = 500;
    let triangles: Array<[u32; 3]> = tile_triangles(n).into();
    let part = Part::new(triangles.clone(), Paint::Matt([90, 160, 120, 255]));
    let surface = Surface { positions: tiles(n, 0.0).into(), parts: vec![part], scalars: None };
    let border =
        Lines { positions: surface.positions.clone(), edges: vec![[0, n]].into(), width: 1.0, ..Lines::default() };
    let mut scene = Scene { background: NIGHT, surfaces: vec![surface], lines: vec![border], ..Scene::default() };
    let mut view = from_above(Projection::Perspective);
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba8Unorm);
    let first = added(&gpu, &mut renderer, &scene, &view);
    let vertices = u64::from(n + 1).pow(2);
    assert_eq!((first.positions, first.triangles, first.lines, first.pictures), (1, 1, 1, 1), "everything once");
    assert_eq!(triangles.len(), 500_000, "half a million");
    for _ in 0..3 {
        assert_eq!(added(&gpu, &mut renderer, &scene, &view), Counts::default(), "nothing changes: nothing is done");
    }
    for _ in 0..3 {
        view.camera.yaw += 0.1;
        let turned = added(&gpu, &mut renderer, &scene, &view);
        assert_eq!(turned, Counts { pictures: 1, ..Counts::default() }, "turned: nothing is uploaded");
    }
    for k in 1..=3_u8 {
        let positions: Array<Vec3> = tiles(n, 0.01 * f32::from(k)).into();
        scene.surfaces[0].positions = positions.clone();
        scene.lines[0].positions = positions;
        let dragged = added(&gpu, &mut renderer, &scene, &view);
        let bytes = 12 * vertices + 24;
        let expected = Counts { pictures: 1, positions: 1, lines: 1, bytes, ..Counts::default() };
        assert_eq!(dragged, expected, "dragged: positions alone");
    }
}

#[test]
fn a_clear_ground_stays_clear_and_borders_keep_their_color() {
    let Some(gpu) = gpu() else { return };
    let green: Rgba = [90, 160, 120, 255];
    let mut scene = scene(plate(Paint::Matt(green), ColorMap::Viridis));
    scene.background = [0; 4];
    let mut view = from_above(Projection::Perspective);
    view.camera.yaw += 0.3;
    let clear = picture(&gpu, &scene, &view).unwrap();
    assert_eq!(clear.at(2, 2), [0; 4], "the ground");
    let inside = at(&clear, &view, Vec3::ZERO);
    assert_eq!(inside[3], 255, "the plate is opaque");
    let borders = clear.pixels.iter().filter(|p| !matches!(p[3], 0 | 255));
    let mut count = 0;
    for border in borders {
        let [r, g, b, _] = *border;
        assert_near([r, g, b, 255], inside, 6, "a border has the plate's color, not a dark rim");
        count += 1;
    }
    assert!(count > 20, "{count} texels of border");
}
