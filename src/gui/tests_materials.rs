//! Tests of the antenna panel's materials, metals and resistors.

use super::app::App;
use super::outbox::Action;
use super::tests::{Window, project, settle};
use super::ui_state::Tab;
use crate::project::materials::{METALS, dielectric_named};
use crate::project::{AntennaSpec, Edit, MetalSpec, ResistorSpec};
use egui::{Key, Modifiers, Theme};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

fn antenna_panel() -> Window {
    // Tall enough for the whole panel.
    let builder = Harness::builder().with_size((1280.0, 1500.0)).with_theme(Theme::Dark);
    let mut window = builder.build_eframe(|cc| App::new(cc, None));
    window.state_mut().state.tab = Tab::Antenna;
    settle(&mut window);
    window
}

fn undo(window: &mut Window) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(window);
}

#[test]
fn materials_and_metals_are_chosen_by_name_and_undone() {
    let mut window = antenna_panel();
    let before = project(&window);
    window.get_by_label("Metal").click();
    window.run_steps(2);
    window.get_by_label(METALS[0].name).click();
    settle(&mut window);
    assert_eq!(project(&window).antenna.patch_metal, METALS[0].to_spec(), "chosen for the patch");
    assert_eq!(project(&window).antenna.ground_metal, MetalSpec::Perfect, "the ground stays");
    undo(&mut window);
    assert_eq!(project(&window), before, "one step back");
    window.get_by_label("Material").click();
    window.run_steps(2);
    window.get_by_label("FR-4").click();
    settle(&mut window);
    assert_eq!(Some(project(&window).antenna.substrate), dielectric_named("FR-4"), "name and values");
    assert_eq!(project(&window).antenna.sheath, before.antenna.sheath, "the sheath stays");
}

#[test]
fn a_choice_by_key_closes_its_list_and_gives_the_keys_back() {
    let mut window = antenna_panel();
    let is_open = |window: &Window| window.query_by_label(METALS[0].name).is_some();
    window.get_by_label("Metal").focus();
    window.run_steps(2);
    let list = window.ctx.memory(|m| m.focused());
    for chosen in [Key::Enter, Key::Space] {
        window.key_press(Key::Enter);
        window.run_steps(3);
        assert!(is_open(&window), "the same key does not close it: {chosen:?}");
        window.key_press(Key::ArrowDown);
        window.run_steps(3);
        window.key_press(chosen);
        settle(&mut window);
        assert!(!is_open(&window), "closed by {chosen:?}");
        assert_eq!(window.ctx.memory(|m| m.focused()), list, "the keys go on from the list");
    }
    window.key_press(Key::Enter);
    window.run_steps(3);
    window.key_press(Key::ArrowDown);
    window.run_steps(3);
    window.key_press(Key::ArrowDown);
    window.run_steps(3);
    window.key_press(Key::Enter);
    settle(&mut window);
    assert_eq!(project(&window).antenna.patch_metal, METALS[0].to_spec(), "the second line was chosen");
}

#[test]
fn values_of_ones_own_can_be_named_and_forgotten() {
    let mut window = antenna_panel();
    let mut antenna = project(&window).antenna;
    antenna.substrate.eps_r = 2.31;
    antenna.substrate.name.clear();
    window.state_mut().edit("substrate.eps_r", Edit::SetAntenna(antenna));
    settle(&mut window);
    let nameless = project(&window);
    window.state_mut().state.material_name = "my felt".to_owned();
    window.run_steps(2);
    window.get_by_label("Keep").click();
    settle(&mut window);
    let kept = project(&window);
    assert!(kept.materials.len() == 1 && kept.materials[0] == kept.antenna.substrate, "kept under its name");
    assert_eq!(kept.antenna.substrate.name, "my felt", "and the substrate is called so");
    undo(&mut window);
    assert_eq!(project(&window), nameless, "one step");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    settle(&mut window);
    window.get_by_label("Forget this material").click();
    settle(&mut window);
    assert!(project(&window).materials.is_empty(), "forgotten");
    assert!((project(&window).antenna.substrate.eps_r - 2.31).abs() < 1e-12, "its values stay in use");
}

#[test]
fn resistors_are_added_where_there_is_room_moved_and_removed() {
    let mut window = antenna_panel();
    let before = project(&window);
    for count in 1..=2 {
        window.get_by_label("Add resistor").click();
        settle(&mut window);
        assert_eq!(project(&window).antenna.resistors.len(), count, "added, and accepted");
    }
    let mark = window.get_by_label("Resistor 2: 50 Ω").rect();
    assert!(window.get_by_label("3-D view").rect().contains_rect(mark), "marked in the view");
    window.get_by_label("Feed point");
    let ctx = window.ctx.clone();
    let mut resistors = project(&window).antenna.resistors;
    resistors[1] = ResistorSpec { x_mm: 8.0, ..resistors[1] };
    let outside = Edit::SetAntenna(AntennaSpec { resistors, ..project(&window).antenna });
    window.state_mut().carry_out(&ctx, Action::Edit("resistors", outside));
    window.step();
    window.get_by_label_contains("resistors[1] (resistor 2) at (8.0000, ");
    window.get_by_label("Remove resistor 1").click();
    settle(&mut window);
    assert_eq!(project(&window).antenna.resistors.len(), 1, "removed");
    (0..3).for_each(|_| undo(&mut window));
    assert_eq!(project(&window), before, "step by step");
}
