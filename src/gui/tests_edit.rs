//! Tests of editing the cage in the window: selecting, operators, the table, the stack and its play.

use super::command::Command;
use super::edit_ui::Columns;
use super::outbox::Action;
use super::play::Play;
use super::preset_fields;
use super::tests::{Window, button, drag, drop, lone_vertex, move_to, project, settle, vertex_place, window};
use crate::geometry::DVec3;
use crate::project::{PresetSpec, Project};
use crate::render::{GizmoPart, Operator};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.step();
    window.step();
}

fn write(window: &mut Window, text: &str) {
    window.event(Event::Text(text.to_owned()));
    window.step();
}

fn select(window: &mut Window, vertices: &[u32]) {
    window.state_mut().state.selection = vertices.iter().copied().collect();
    window.step();
}

fn selection(window: &Window) -> Vec<u32> {
    window.state().state.selection.iter().copied().collect()
}

/// Number of the vertex at a place of the lattice of the first project: 10 by 4 segments.
fn number([i, j, k]: [u32; 3]) -> u32 {
    (5 * i + j) * 2 + k
}

fn offset(window: &Window, vertex: u32) -> DVec3 {
    DVec3::from_array(project(window).hand_edits.get(&vertex).copied().unwrap_or_default())
}

/// Undo gives the bits of `before` back in one step, and redo those of now.
fn is_one_step(window: &mut Window, before: &Project) {
    let after = project(window);
    assert_ne!(after, *before, "something was done");
    press(window, Modifiers::COMMAND, Key::Z);
    settle(window);
    assert_eq!(project(window), *before, "one step back");
    press(window, Modifiers::COMMAND, Key::Y);
    settle(window);
    assert_eq!(project(window), after, "and forward again");
    press(window, Modifiers::COMMAND, Key::Z);
    settle(window);
}

#[test]
fn keys_select_stations_rows_columns_layers_neighbors_and_the_rest() {
    let mut window = window();
    let vertex = number([3, 2, 1]);
    let shift = Modifiers::SHIFT;
    let cases = [
        (shift, Key::S, 10),
        (shift, Key::R, 11),
        (shift, Key::C, 5),
        (shift, Key::T, 55),
        (shift, Key::B, 55),
        (Modifiers::NONE, Key::Plus, 5),
        (Modifiers::COMMAND, Key::I, 109),
        (Modifiers::NONE, Key::A, 110),
        (Modifiers::ALT, Key::A, 0),
    ];
    for (modifiers, key, count) in cases {
        select(&mut window, &[vertex]);
        press(&mut window, modifiers, key);
        assert_eq!(selection(&window).len(), count, "{modifiers:?} {key:?}");
    }
    select(&mut window, &[vertex]);
    press(&mut window, Modifiers::NONE, Key::Plus);
    press(&mut window, Modifiers::NONE, Key::Minus);
    assert_eq!(selection(&window), [vertex], "grown and shrunk again");
    assert!(!window.state().session.history().can_undo(), "a selection is no step");
}

#[test]
fn a_lasso_selects_what_it_surrounds_and_shift_and_alt_add_and_take_away() {
    let mut window = window();
    let vertex = lone_vertex(&window);
    let at = vertex_place(&window, vertex);
    let corners = [vec2(-9.0, -9.0), vec2(9.0, -9.0), vec2(9.0, 9.0), vec2(-9.0, 9.0)].map(|v| at + v);
    let draw = |window: &mut Window, modifiers: Modifiers| {
        window.event(Event::ModifiersChanged(modifiers));
        move_to(window, corners[0]);
        button(window, corners[0], true, modifiers);
        corners.into_iter().for_each(|corner| move_to(window, corner));
        button(window, corners[3], false, modifiers);
        window.event(Event::ModifiersChanged(Modifiers::NONE));
        window.step();
    };
    let vertex = u32::try_from(vertex).expect("small");
    draw(&mut window, Modifiers::COMMAND);
    assert_eq!(selection(&window), [vertex], "exactly the one inside");
    let other = if vertex == 0 { 1 } else { 0 };
    select(&mut window, &[other]);
    draw(&mut window, Modifiers::COMMAND | Modifiers::SHIFT);
    assert_eq!(selection(&window).len(), 2, "added");
    press(&mut window, Modifiers::SHIFT, Key::L);
    draw(&mut window, Modifiers::ALT);
    assert_eq!(selection(&window), [other], "taken away, by the lasso of the menu");
    assert!(window.state().state.editing.outline.is_none(), "which was for one time");
}

#[test]
fn typed_moves_turns_and_scalings_are_exact_and_one_step_each() {
    let mut window = window();
    let before = project(&window);
    let [a, b] = [number([4, 2, 1]), number([6, 2, 1])];
    select(&mut window, &[a]);
    press(&mut window, Modifiers::NONE, Key::G);
    move_to(&mut window, pos2(700.0, 300.0));
    press(&mut window, Modifiers::NONE, Key::Z);
    write(&mut window, "0.255");
    press(&mut window, Modifiers::NONE, Key::Backspace);
    window.get_by_label_contains("Move along z: 0.25| mm");
    assert_eq!(offset(&window, a), DVec3::new(0.0, 0.0, 0.25), "seen while it runs");
    press(&mut window, Modifiers::NONE, Key::Enter);
    settle(&mut window);
    assert_eq!(offset(&window, a), DVec3::new(0.0, 0.0, 0.25), "applied");
    is_one_step(&mut window, &before);

    select(&mut window, &[a, b]);
    let [start_a, start_b] = places(&mut window, [a, b]);
    for (keys, number, expected) in [
        ([Key::S, Key::X], "1.2", 0.1 * (start_b - start_a).x),
        ([Key::R, Key::Z], "-10-", (start_b.x - start_a.x) * (10.0_f64.to_radians().cos() - 1.0) / 2.0),
    ] {
        keys.into_iter().for_each(|key| press(&mut window, Modifiers::NONE, key));
        write(&mut window, number);
        press(&mut window, Modifiers::NONE, Key::Enter);
        settle(&mut window);
        let moved = offset(&window, b)[0];
        assert!((moved - expected).abs() < 1.1e-3, "{keys:?}: {moved} instead of {expected}");
        assert!((offset(&window, a)[0] + expected).abs() < 1.1e-3, "{keys:?}: the other one the opposite way");
        is_one_step(&mut window, &before);
    }

    select(&mut window, &[b]);
    press(&mut window, Modifiers::NONE, Key::G);
    press(&mut window, Modifiers::NONE, Key::X);
    write(&mut window, "=");
    write(&mut window, "2.5");
    press(&mut window, Modifiers::NONE, Key::Enter);
    settle(&mut window);
    assert!((places(&mut window, [a, b])[1].x - 2.5).abs() < 1e-3, "an absolute number is the place itself");
    is_one_step(&mut window, &before);
}

#[test]
fn operators_follow_the_pointer_and_are_applied_by_a_click_or_given_up() {
    let mut window = window();
    let before = project(&window);
    let vertex = number([5, 2, 1]);
    select(&mut window, &[vertex]);
    let click = |window: &mut Window, at: Pos2, which: PointerButton| {
        for pressed in [true, false] {
            window.event(Event::PointerButton { pos: at, button: which, pressed, modifiers: Modifiers::NONE });
            window.step();
        }
        settle(window);
    };
    let from = pos2(620.0, 300.0);
    for (ends, applies) in [(PointerButton::Primary, true), (PointerButton::Secondary, false)] {
        move_to(&mut window, from);
        press(&mut window, Modifiers::NONE, Key::G);
        press(&mut window, Modifiers::NONE, Key::Z);
        move_to(&mut window, from - vec2(0.0, 9.0));
        assert!(offset(&window, vertex)[2] > 0.1, "it follows without a button: {:?}", offset(&window, vertex));
        click(&mut window, from - vec2(0.0, 9.0), ends);
        move_to(&mut window, from + vec2(30.0, 30.0));
        assert_eq!(selection(&window), [vertex], "the click selected nothing else");
        if applies {
            is_one_step(&mut window, &before);
        }
        assert_eq!(project(&window), before, "{ends:?}");
    }
    press(&mut window, Modifiers::NONE, Key::R);
    move_to(&mut window, from + vec2(9.0, 30.0));
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(project(&window), before, "given up by the key");
    assert!(!window.state().session.in_gesture(), "and over");
    window.state_mut().state.selection.clear();
    press(&mut window, Modifiers::NONE, Key::G);
    assert!(!window.state().session.in_gesture(), "nothing to move");
}

/// Places of cage vertices, mm.
fn places<const N: usize>(window: &mut Window, vertices: [u32; N]) -> [DVec3; N] {
    let pose = window.state_mut().session.pose().expect("a cage");
    vertices.map(|v| pose.vertices[v as usize] * 1e3)
}

#[test]
fn rings_turn_and_knobs_scale_the_selection_in_one_step_each() {
    let mut window = window();
    let before = project(&window);
    let chosen = [[3, 1, 1], [3, 3, 1], [7, 1, 1], [7, 3, 1]].map(number);
    select(&mut window, &chosen);
    window.state_mut().state.camera.distance *= 0.6;
    window.step();
    let start = places(&mut window, chosen);
    let pivot = start.iter().sum::<DVec3>() / 4.0;
    let grip = |window: &Window, part: &str| window.get_by_label(part).rect().center();
    let center = grip(&window, "Move in the plane of the screen");

    let from = grip(&window, "Turn about z");
    move_to(&mut window, from);
    window.step();
    assert!(window.state().viewport.is_hot(GizmoPart::Ring(2)), "lit up under the pointer");
    let to = center + egui::emath::Rot2::from_angle(-0.3) * (from - center);
    drag(&mut window, from, to);
    window.get_by_label_contains("Rotate about z");
    drop(&mut window, to);
    // Offsets are whole micrometres.
    let angles: Vec<f64> = places(&mut window, chosen)
        .iter()
        .zip(&start)
        .map(|(after, before)| {
            let [a, b] = [*before - pivot, *after - pivot];
            assert!((a.z - b.z).abs() < 1e-9 && (a.length() - b.length()).abs() < 2e-3, "a turn about z: {a} to {b}");
            a.truncate().angle_to(b.truncate())
        })
        .collect();
    assert!(angles[0] > 0.1 && angles.iter().all(|a| (a - angles[0]).abs() < 1e-3), "all alike: {angles:?}");
    is_one_step(&mut window, &before);

    let from = grip(&window, "Scale along x");
    let to = center + (from - center) * 1.1;
    drag(&mut window, from, to);
    window.get_by_label_contains("Scale along x: ");
    drop(&mut window, to);
    for (after, before) in places(&mut window, chosen).iter().zip(&start) {
        let expected = DVec3::new(1.1, 1.0, 1.0) * (*before - pivot);
        assert!((*after - pivot - expected).length() < 2e-3, "a tenth longer: {after} from {before}");
    }
    is_one_step(&mut window, &before);

    let from = grip(&window, "Turn about x");
    drag(&mut window, from, from + vec2(12.0, 9.0));
    assert_ne!(project(&window), before, "it turns");
    window.key_press(Key::Escape);
    window.step();
    assert_eq!(project(&window), before, "given up");
    drop(&mut window, from);
    assert!(!window.state().session.history().can_undo(), "no step");
    select(&mut window, &chosen[..1]);
    window.step();
    assert!(window.query_by_label("Turn about z").is_none(), "a single vertex is moved only");
    window.get_by_label("Move along z");
}

#[test]
fn near_vertices_follow_mirrored_partners_too_and_steps_are_whole() {
    let mut window = window();
    let before = project(&window);
    let [vertex, beside, far] = [[2, 1, 1], [2, 2, 1], [8, 4, 1]].map(number);
    let [partner, opposite] = [[8, 1, 1], [8, 3, 1]].map(number);
    let lift = |window: &mut Window| {
        select(window, &[vertex]);
        for key in [Key::G, Key::Z] {
            press(window, Modifiers::NONE, key);
        }
        write(window, "0.2");
        press(window, Modifiers::NONE, Key::Enter);
        settle(window);
    };
    press(&mut window, Modifiers::NONE, Key::O);
    window.state_mut().state.editing.radius_mm = 8.0;
    lift(&mut window);
    let part = offset(&window, beside)[2];
    assert!(part > 0.0 && part < 0.2 && offset(&window, far)[2] <= 0.0, "the nearer the more: {part}");
    is_one_step(&mut window, &before);
    press(&mut window, Modifiers::NONE, Key::O);

    press(&mut window, Modifiers::SHIFT, Key::X);
    lift(&mut window);
    assert_eq!(project(&window).hand_edits.keys().copied().collect::<Vec<_>>(), [vertex, partner], "about one plane");
    is_one_step(&mut window, &before);
    press(&mut window, Modifiers::SHIFT, Key::Y);
    lift(&mut window);
    assert_eq!(project(&window).hand_edits.len(), 4, "about both");
    assert_eq!(offset(&window, opposite), DVec3::new(0.0, 0.0, 0.2), "the same height everywhere");
    press(&mut window, Modifiers::NONE, Key::Delete);
    settle(&mut window);
    assert_eq!(project(&window), before, "partners are reset together");

    press(&mut window, Modifiers::SHIFT, Key::G);
    let from = vertex_place(&window, vertex as usize);
    drag(&mut window, from, from + vec2(4.0, -12.0));
    drop(&mut window, from + vec2(4.0, -12.0));
    let moved = project(&window).hand_edits;
    let is_whole = |v: &f64| (v / 0.5 - (v / 0.5).round()).abs() < 1e-9;
    assert!(!moved.is_empty() && moved.values().flatten().all(is_whole), "half millimetres: {moved:?}");
}

#[test]
fn the_table_sets_one_or_all_and_scrolls_through_many() {
    let mut window = window();
    // Tall enough for the whole panel.
    window.set_size(vec2(1280.0, 1600.0));
    window.run_steps(4);
    let before = project(&window);
    press(&mut window, Modifiers::COMMAND, Key::A);
    window.state_mut().state.editing.columns = Columns::Offsets;
    window.step();
    let fields = window
        .get_all_by_role(Role::SpinButton)
        .filter(|n| n.accesskit_node().label().is_some_and(|label| label.contains("of cage vertex")));
    let count = fields.count();
    assert!((3..=60).contains(&count), "only the rows in view are drawn: {count}");
    let type_into = |window: &mut Window, label: &str, text: &str| {
        let at = window.get_by_label(label).rect().center();
        move_to(window, at);
        button(window, at, true, Modifiers::NONE);
        button(window, at, false, Modifiers::NONE);
        window.step();
        press(window, Modifiers::COMMAND, Key::A);
        write(window, text);
        press(window, Modifiers::NONE, Key::Enter);
        settle(window);
    };
    type_into(&mut window, "Set all z to, mm", "0.125");
    let all = project(&window).hand_edits;
    assert!(
        all.len() == 110 && all.values().all(|o| DVec3::from_array(*o) == DVec3::new(0.0, 0.0, 0.125)),
        "all of them"
    );
    is_one_step(&mut window, &before);
    let vertex = number([5, 2, 1]);
    select(&mut window, &[vertex]);
    window.state_mut().state.editing.columns = Columns::Places;
    window.step();
    type_into(&mut window, &format!("x of cage vertex {vertex}, mm"), "0.5");
    assert_eq!(offset(&window, vertex), DVec3::new(0.5, 0.0, 0.0), "it stood at x = 0");
    is_one_step(&mut window, &before);
}

#[test]
fn presets_are_hidden_doubled_deleted_and_dragged_to_another_place() {
    let mut window = window();
    let ctx = window.ctx.clone();
    for (_, _, preset) in preset_fields::choices().into_iter().skip(5) {
        window.state_mut().carry_out(&ctx, Action::AddPreset(preset));
    }
    settle(&mut window);
    window.set_size(vec2(1280.0, 1600.0));
    window.run_steps(4);
    let before = project(&window);
    let kinds =
        |window: &Window| project(window).presets.iter().map(|e| preset_fields::name(&e.preset)).collect::<Vec<_>>();
    assert_eq!(kinds(&window), ["Bend, H-plane", "Twist", "Crumple"], "from the lowest");
    let click = |window: &mut Window, label: &str| {
        window.get_by_label(label).click();
        window.step();
        settle(window);
    };
    click(&mut window, "Apply preset 2");
    assert!(!project(&window).presets[1].enabled, "left out");
    is_one_step(&mut window, &before);
    click(&mut window, "Duplicate preset 1");
    assert_eq!(kinds(&window)[..2], ["Bend, H-plane"; 2], "twice");
    is_one_step(&mut window, &before);
    click(&mut window, "Delete preset 3");
    assert_eq!(kinds(&window).len(), 2, "gone");
    is_one_step(&mut window, &before);
    let grip = |window: &Window, k: usize| window.get_by_label(&format!("Move preset {k}")).rect().center();
    // Below the middle of the row of preset 2, above that of preset 1.
    let (from, to) = (grip(&window, 3), grip(&window, 1) - vec2(0.0, 12.0));
    drag(&mut window, from, to);
    assert_eq!(project(&window), before, "not before it is let go");
    drop(&mut window, to);
    assert_eq!(kinds(&window), ["Bend, H-plane", "Crumple", "Twist"], "one line down is applied one earlier");
    is_one_step(&mut window, &before);
    window.get_by_label("Move preset 1").focus();
    window.step();
    window.step();
    press(&mut window, Modifiers::NONE, Key::ArrowUp);
    settle(&mut window);
    assert_eq!(kinds(&window), ["Twist", "Bend, H-plane", "Crumple"], "by the keyboard");
    is_one_step(&mut window, &before);
}

#[test]
fn playing_shows_parts_and_changes_nothing() {
    let mut window = window();
    let before = project(&window);
    press(&mut window, Modifiers::SHIFT, Key::Space);
    let amounts: Vec<f64> = (0..12)
        .map(|_| {
            window.step();
            window.state().session.play().amount
        })
        .collect();
    assert!(amounts.windows(2).all(|w| w[1] > w[0]) && amounts[11] < 1.0, "it grows: {amounts:?}");
    let radius = |window: &Window| {
        let shown = window.state().session.shown().expect("a preview");
        let PresetSpec::Bend { radius_mm, .. } = shown.project.presets[0].preset else { panic!("a bend") };
        radius_mm
    };
    window.state_mut().session.show(Play::held(0.5));
    window.step();
    settle(&mut window);
    assert!((radius(&window) - 20.0).abs() < 1e-9, "half the curvature");
    window.get_by_label_contains("50 % of the deformation");
    let session = &window.state().session;
    assert_eq!(*session.project(), before, "the project stays");
    assert!(!session.history().can_undo() && !session.history().is_dirty(), "and so does its history");
    press(&mut window, Modifiers::SHIFT, Key::Space);
    settle(&mut window);
    assert!(window.state().session.finished().is_some(), "stopped: the whole, computed in full");

    window.state_mut().session.show(Play::held(0.3));
    window.step();
    select(&mut window, &[number([5, 2, 1])]);
    let ctx = window.ctx.clone();
    window.state_mut().carry_out(&ctx, Action::Run(Command::Operate(Operator::Move)));
    window.step();
    window.step();
    assert!(!window.state().session.play().is_on(), "an edit is made on the whole");
    press(&mut window, Modifiers::NONE, Key::Escape);
    settle(&mut window);
    assert_eq!(project(&window), before, "and given up");
}
