//! The antenna's dimensions and materials, and a first guess of them for a wanted frequency.

use super::command::Command;
use super::field::{Number, Refused, rows, section};
use super::outbox::{Action, Outbox};
use super::panel_bodies;
use super::panel_materials::{dielectric, metal, own_name, resistors};
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::antenna::{FirstGuess, first_guess};
use crate::project::{AntennaSpec, Edit, Project};
use crate::units::{GHZ, to_mm};
use egui::{RichText, Ui};

type Access = fn(&mut AntennaSpec) -> &mut f64;
type AccessCount = fn(&mut AntennaSpec) -> &mut usize;

/// Titles of the groups, their numbers, and where each number is kept.
fn groups() -> [(&'static str, Vec<(Number, Access)>); 4] {
    let mm = |place, label, tip| Number::new(place, label, "mm", 0.01).tip(tip);
    let plain = |place, label, speed, tip| Number::new(place, label, "", speed).tip(tip);
    [
        (
            "Patch",
            vec![
                (mm("width", "Width W", "Extent of the patch along x; an outline is stretched to it"), |a| {
                    &mut a.width_mm
                }),
                (mm("length", "Length L", "Extent along y: the resonant side; an outline is stretched to it"), |a| {
                    &mut a.length_mm
                }),
                (mm("patch_thickness", "Thickness", "Thickness of the patch's metal"), |a| &mut a.patch_thickness_mm),
            ],
        ),
        (
            "Substrate",
            vec![
                (mm("height", "Height h", "From the ground to the patch"), |a| &mut a.height_mm),
                (mm("ground_width", "Width", "Extent of substrate and ground along x"), |a| &mut a.ground_width_mm),
                (mm("ground_length", "Length", "Extent of substrate and ground along y"), |a| &mut a.ground_length_mm),
                (mm("ground_thickness", "Ground thickness", "Thickness of the ground's metal"), |a| {
                    &mut a.ground_thickness_mm
                }),
                (plain("substrate.eps_r", "Permittivity εr", 0.01, "Relative permittivity, at least 1"), |a| {
                    &mut a.substrate.eps_r
                }),
                (plain("substrate.tan_delta", "Loss tangent", 0.0001, "Loss tangent of the substrate"), |a| {
                    &mut a.substrate.tan_delta
                }),
            ],
        ),
        (
            "Feed",
            vec![
                (mm("inset", "Inset y0", "From the radiating edge at y = -L/2 to the pin's axis"), |a| &mut a.inset_mm),
                (mm("feed_offset", "Offset", "Of the pin from the center line, along x"), |a| &mut a.feed_offset_mm),
                (mm("pin_radius", "Pin radius", "Radius of the inner conductor"), |a| &mut a.pin_radius_mm),
            ],
        ),
        (
            "Coaxial line",
            vec![
                (mm("coax_radius", "Outer radius", "Inner radius of the outer conductor"), |a| &mut a.coax_radius_mm),
                (mm("coax_length", "Length", "Of the line below the ground"), |a| &mut a.coax_length_mm),
                (plain("sheath.eps_r", "Permittivity εr", 0.01, "Of the sheath between the conductors"), |a| {
                    &mut a.sheath.eps_r
                }),
                (plain("sheath.tan_delta", "Loss tangent", 0.0001, "Of the sheath between the conductors"), |a| {
                    &mut a.sheath.tan_delta
                }),
            ],
        ),
    ]
}

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, project: &Project, state: &mut UiState, out: &mut Outbox) {
    let antenna = &project.antenna;
    let refused = state.refused.clone();
    let refused = Refused(refused.as_ref());
    if let Some(bodies) = &project.bodies {
        return panel_bodies::ui(ui, project, bodies, state, out);
    }
    for (title, numbers) in groups() {
        section(ui, title, true, |ui| {
            rows(ui, title, |ui| {
                for (number, access) in &numbers {
                    before(ui, number.place, project, out);
                    let mut new = antenna.clone();
                    let value = *access(&mut new);
                    number.row(ui, value, refused, out, |v| {
                        *access(&mut new) = v;
                        new = new.stretched_from(antenna);
                        // Other values are another material.
                        match number.place {
                            "substrate.eps_r" | "substrate.tan_delta" => new.substrate.name.clear(),
                            "sheath.eps_r" | "sheath.tan_delta" => new.sheath.name.clear(),
                            _ => {}
                        }
                        Edit::SetAntenna(new)
                    });
                    if number.place == "substrate.tan_delta" {
                        own_name(ui, project, &mut state.material_name, refused, out);
                    }
                }
                after(ui, title, antenna, refused, out);
            });
        });
    }
    section(ui, "Resistors", true, |ui| resistors(ui, antenna, refused, out));
    section(ui, "First guess", true, |ui| guess(ui, antenna, state, refused, out));
}

/// The choice of a material, before its values.
fn before(ui: &mut Ui, place: &str, project: &Project, out: &mut Outbox) {
    let (antenna, own) = (&project.antenna, &project.materials[..]);
    match place {
        "substrate.eps_r" => {
            let label = ("Material", "Of the substrate; changing its values makes it a custom one");
            dielectric(ui, label, (&antenna.substrate, own), out, |substrate| {
                Edit::SetAntenna(AntennaSpec { substrate, ..antenna.clone() })
            });
        }
        "sheath.eps_r" => {
            let label = ("Sheath", "Between the conductors; changing its values makes it a custom one");
            dielectric(ui, label, (&antenna.sheath, own), out, |sheath| {
                Edit::SetAntenna(AntennaSpec { sheath, ..antenna.clone() })
            });
        }
        _ => {}
    }
}

/// What follows the numbers of a group.
fn after(ui: &mut Ui, title: &str, antenna: &AntennaSpec, refused: Refused<'_>, out: &mut Outbox) {
    match title {
        "Patch" => {
            outline(ui, antenna, refused, out);
            metal(ui, ("patch_metal", "Metal"), &antenna.patch_metal, (refused, out), |patch_metal| {
                Edit::SetAntenna(AntennaSpec { patch_metal, ..antenna.clone() })
            });
        }
        "Substrate" => {
            let label = ("ground_metal", "Ground metal");
            metal(ui, label, &antenna.ground_metal, (refused, out), |ground_metal| {
                Edit::SetAntenna(AntennaSpec { ground_metal, ..antenna.clone() })
            });
        }
        "Coaxial line" => segments(ui, antenna, refused, out),
        _ => {}
    }
}

/// What the patch's outline is, and how to change it.
fn outline(ui: &mut Ui, antenna: &AntennaSpec, refused: Refused<'_>, out: &mut Outbox) {
    ui.label("Outline").on_hover_text("A rectangle, or any closed line from a drawing");
    ui.horizontal(|ui| {
        let n = antenna.outline_mm.len();
        ui.label(if n == 0 { "Rectangle".to_owned() } else { format!("{n} points") });
        if ui.button("Import…").on_hover_text(Command::ImportOutline.text_and_tip().1).clicked() {
            out.push(Action::Run(Command::ImportOutline));
        }
        if n > 0
            && ui.button("Rectangle").on_hover_text("Make the patch a rectangle of this width and length").clicked()
        {
            out.edit("outline", Edit::SetAntenna(AntennaSpec { outline_mm: Vec::new(), ..antenna.clone() }));
        }
    });
    ui.end_row();
    refused.show(ui, "outline");
}

fn segments(ui: &mut Ui, antenna: &AntennaSpec, refused: Refused<'_>, out: &mut Outbox) {
    let tip = "Straight sides of the polygon that stands for the circle";
    let fields: [(&'static str, &'static str, AccessCount); 2] = [
        ("pin_segments", "Pin sides", |a| &mut a.pin_segments),
        ("coax_segments", "Coax sides", |a| &mut a.coax_segments),
    ];
    for (place, label, access) in fields {
        let mut new = antenna.clone();
        let value = *access(&mut new) as f64;
        Number::new(place, label, "", 0.1).count().tip(tip).row(ui, value, refused, out, |v| {
            *access(&mut new) = v.round().clamp(0.0, 1e4) as usize;
            Edit::SetAntenna(new)
        });
    }
}

fn guess(ui: &mut Ui, antenna: &AntennaSpec, state: &mut UiState, refused: Refused<'_>, out: &mut Outbox) {
    let freq = Number::new("guess_freq", "Frequency", "GHz", 0.05).tip("Wanted resonance");
    let ohm = Number::new("guess_ohm", "Resistance", "Ω", 0.5).tip("Wanted input resistance at resonance");
    let params = antenna.to_params();
    let made = first_guess(state.guess_freq_ghz * GHZ, params.substrate, params.height, state.guess_ohm);
    rows(ui, "guess", |ui| {
        for (number, value) in [(freq, &mut state.guess_freq_ghz), (ohm, &mut state.guess_ohm)] {
            if let (_, Some(new)) = number.show(ui, *value) {
                *value = new;
            }
            ui.end_row();
        }
        if let Ok(guess) = &made {
            for (label, text) in describe(guess) {
                ui.label(label);
                ui.label(text);
                ui.end_row();
            }
        }
    });
    match made {
        Ok(guess) => {
            let tip = "Set width, length and inset to these numbers; the substrate stays";
            if ui.button("Use these dimensions").on_hover_text(tip).clicked() {
                // Typed numbers have few digits, so the guess gets no more than a tenth of a micrometre either.
                let rounded = |value: f64| (to_mm(value) * 1e4).round() / 1e4;
                let mut new = antenna.clone();
                (new.width_mm, new.length_mm) = (rounded(guess.width), rounded(guess.length));
                new.inset_mm = rounded(guess.inset);
                new = new.stretched_from(antenna);
                out.edit("guess", Edit::SetAntenna(new));
            }
        }
        Err(error) => {
            ui.colored_label(Tokens::here(ui).error, RichText::new(error.to_string()).small());
        }
    }
    refused.show_alone(ui, "guess");
}

fn describe(guess: &FirstGuess) -> [(&'static str, String); 4] {
    [
        ("Width W", format!("{:.3} mm", to_mm(guess.width))),
        ("Length L", format!("{:.3} mm", to_mm(guess.length))),
        ("Inset y0", format!("{:.3} mm", to_mm(guess.inset))),
        ("Edge resistance", format!("{:.0} Ω", guess.edge_resistance)),
    ]
}
