//! What the antenna is made of: dielectrics and metals by name or by number, and resistors through the substrate.

use super::field::{Choices, Number, Refused, symbol_button};
use super::outbox::{Action, Outbox};
use super::theme::Tokens;
use crate::project::materials::{DIELECTRICS, METALS};
use crate::project::{AntennaSpec, Edit, MaterialSpec, MetalSpec, Project, ResistorSpec};
use crate::units::to_mm;
use egui::{ComboBox, DragValue, Grid, RichText, TextEdit, Ui};

/// What a material is called whose values were changed.
const CUSTOM: &str = "Custom";
/// Width of the lists of materials, points.
const LIST_WIDTH: f32 = 150.0;
/// Resistance that a new resistor has, ohm.
const NEW_OHM: f64 = 50.0;
/// Surface resistance of a sheet that is to be typed, ohm per square.
const NEW_OHM_PER_SQUARE: f64 = 0.05;

/// A row to choose a dielectric by name.
pub(super) fn dielectric(
    ui: &mut Ui,
    (label, tip): (&'static str, &'static str),
    (current, own): (&MaterialSpec, &[MaterialSpec]),
    out: &mut Outbox,
    edit: impl Fn(MaterialSpec) -> Edit,
) {
    let name = if current.name.is_empty() { CUSTOM } else { &current.name };
    let named = ui.label(label).on_hover_text(tip);
    let combo = ComboBox::from_id_salt(label).width(LIST_WIDTH).height(320.0).selected_text(name).show_list(ui, |ui| {
        let mut entry = |ui: &mut Ui, material: MaterialSpec, note: &str| {
            let values = format!("εr {}, tan δ {}", material.eps_r, material.tan_delta);
            let tip = if note.is_empty() { values } else { format!("{values}\n{note}") };
            if ui.selectable_label(*current == material, &material.name).on_hover_text(tip).clicked() {
                out.edit("material", edit(material));
            }
        };
        for known in &DIELECTRICS {
            entry(ui, known.to_spec(), known.note);
        }
        if !own.is_empty() {
            ui.separator();
            own.iter().for_each(|material| entry(ui, material.clone(), "One of this project's own"));
        }
    });
    combo.response.labelled_by(named.id).on_hover_text(tip);
    ui.end_row();
}

/// A row that gives the substrate a name of its own, or takes that away again.
pub(super) fn own_name(ui: &mut Ui, project: &Project, typed: &mut String, refused: Refused<'_>, out: &mut Outbox) {
    let substrate = &project.antenna.substrate;
    if substrate.name.is_empty() {
        let label = ui.label("Keep as");
        ui.horizontal(|ui| {
            let input = TextEdit::singleline(typed).desired_width(92.0).hint_text("name");
            let tip = "A name for these values, to choose them again in this project";
            ui.add(input).labelled_by(label.id).on_hover_text(tip);
            let name = typed.trim();
            let is_named = !name.is_empty();
            if ui.add_enabled(is_named, egui::Button::new("Keep")).on_hover_text(tip).clicked() {
                let material = MaterialSpec { name: name.to_owned(), ..substrate.clone() };
                let antenna = AntennaSpec { substrate: material.clone(), ..project.antenna.clone() };
                let materials = project.materials.iter().cloned().chain([material]).collect();
                out.push(Action::Begin);
                out.edit("own material", Edit::SetMaterials(materials));
                out.edit("own material", Edit::SetAntenna(antenna));
                out.push(Action::End);
                typed.clear();
            }
        });
        ui.end_row();
    } else if project.materials.contains(substrate) {
        ui.label("");
        let tip = "Take it out of this project's own materials; the substrate keeps its values";
        if ui.button("Forget this material").on_hover_text(tip).clicked() {
            let kept = project.materials.iter().filter(|m| *m != substrate).cloned().collect();
            out.edit("own material", Edit::SetMaterials(kept));
        }
        ui.end_row();
    }
    refused.show(ui, "own material");
}

/// A row to choose what a sheet of metal is made of, and one for its resistance where it has some.
pub(super) fn metal(
    ui: &mut Ui,
    (place, label): (&'static str, &'static str),
    current: &MetalSpec,
    (refused, out): (Refused<'_>, &mut Outbox),
    edit: impl Fn(MetalSpec) -> Edit,
) {
    let tip = "Without loss, or a sheet such as conductive fabric";
    let name = match current {
        MetalSpec::Perfect => "Perfect",
        MetalSpec::Sheet { name, .. } if name.is_empty() => CUSTOM,
        MetalSpec::Sheet { name, .. } => name,
    };
    let named = ui.label(label).on_hover_text(tip);
    let combo = ComboBox::from_id_salt(label).width(LIST_WIDTH).selected_text(name).show_list(ui, |ui| {
        let mut entry = |ui: &mut Ui, text: &str, metal: MetalSpec, tip: String| {
            if ui.selectable_label(name == text, text).on_hover_text(tip).clicked() && metal != *current {
                out.edit(place, edit(metal));
            }
        };
        entry(ui, "Perfect", MetalSpec::Perfect, "Without loss".to_owned());
        for known in &METALS {
            entry(ui, known.name, known.to_spec(), format!("{} Ω/sq\n{}", known.ohm_per_square, known.note));
        }
        let ohm_per_square = match current {
            MetalSpec::Sheet { ohm_per_square, .. } => *ohm_per_square,
            MetalSpec::Perfect => NEW_OHM_PER_SQUARE,
        };
        let custom = MetalSpec::Sheet { name: String::new(), ohm_per_square };
        entry(ui, CUSTOM, custom, "Any other sheet, by its resistance".to_owned());
    });
    combo.response.labelled_by(named.id).on_hover_text(tip);
    ui.end_row();
    if let MetalSpec::Sheet { ohm_per_square, .. } = current {
        let tip = "Surface resistance of the whole sheet: both sides together, as a four-point probe measures it";
        let number = Number::new(place, "Resistance", "Ω/sq", 0.005).tip(tip);
        number.row(ui, *ohm_per_square, refused, out, |v| {
            edit(MetalSpec::Sheet { name: String::new(), ohm_per_square: v })
        });
    }
}

/// The list of resistors.
pub(super) fn resistors(ui: &mut Ui, antenna: &AntennaSpec, refused: Refused<'_>, out: &mut Outbox) {
    let with = |resistors: Vec<ResistorSpec>| Edit::SetAntenna(AntennaSpec { resistors, ..antenna.clone() });
    if antenna.resistors.is_empty() {
        ui.label(RichText::new("None. A resistor joins ground and patch; a small one is a shorting post.").weak());
    } else {
        Grid::new("resistors").num_columns(5).min_col_width(20.0).spacing([6.0, 4.0]).show(ui, |ui| {
            let heads = ["No.", "x (mm)", "y (mm)", "R (Ω)"];
            let heads = heads.map(|head| ui.label(RichText::new(head).color(Tokens::here(ui).weak)).id);
            ui.end_row();
            for (index, resistor) in antenna.resistors.iter().enumerate() {
                let label = ui.label((index + 1).to_string());
                for (column, head) in heads[1..].iter().enumerate() {
                    let mut new = *resistor;
                    let (value, tip) = match column {
                        0 => (&mut new.x_mm, "Across the width, from the patch's center, mm"),
                        1 => {
                            (&mut new.y_mm, "Along the length, from the patch's center, mm; the feed is at negative y")
                        }
                        _ => (&mut new.ohm, "Resistance between ground and patch, Ω"),
                    };
                    let speed = if column == 2 { 0.01 * value.max(1.0) } else { 0.02 };
                    let input = DragValue::new(value).speed(speed).max_decimals(4).update_while_editing(false);
                    let response = ui.add_sized([62.0, 20.0], input).labelled_by(label.id).labelled_by(*head);
                    let response = response.on_hover_text(tip);
                    let change = response.changed().then(|| {
                        let mut all = antenna.resistors.clone();
                        all[index] = new;
                        ("resistors", with(all))
                    });
                    out.gesture(&response, change);
                }
                if symbol_button(ui, "🗑", &format!("Remove resistor {}", index + 1), true) {
                    let mut all = antenna.resistors.clone();
                    all.remove(index);
                    out.edit("resistors", with(all));
                }
                ui.end_row();
            }
        });
    }
    let place = antenna.to_params().roomiest_place();
    let add = ui.add_enabled(place.is_some(), egui::Button::new("Add resistor"));
    let add = add.on_hover_text("Put a resistor where there is most room under the patch");
    if add.on_disabled_hover_text("There is no room left under the patch").clicked()
        && let Some(at) = place
    {
        let [x_mm, y_mm] = [at.x, at.y].map(|c| (to_mm(c) * 1e3).round() / 1e3 + 0.0);
        let added = ResistorSpec { x_mm, y_mm, ohm: NEW_OHM };
        out.edit("resistors", with(antenna.resistors.iter().copied().chain([added]).collect()));
    }
    refused.show_alone(ui, "resistors");
}
