//! Imported bodies in the patch's place: what each is made of, and the ways to others.

use super::bodies_feed::FeedUi;
use super::body_rows::body_rows;
use super::command::Command;
use super::field::{Number, Refused, rows, section};
use super::outbox::{Action, Outbox};
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::project::{BodiesSpec, BodySpec, Edit, FeedSpec, Project};
use crate::units::to_mm;
use egui::{DragValue, RichText, Ui};

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, project: &Project, spec: &BodiesSpec, state: &mut UiState, out: &mut Outbox) {
    let refused = state.refused.clone();
    let refused = Refused(refused.as_ref());
    section(ui, "Bodies", true, |ui| {
        let note = |body: &BodySpec| (body.name.clone(), Some(body.kind.clone()), "An imported body".to_owned());
        let rows: Vec<_> = spec.bodies.iter().map(note).collect();
        if let Some((k, kind)) = body_rows(ui, &rows, &project.materials) {
            let mut new = spec.clone();
            new.bodies[k].kind = kind;
            out.edit("bodies", Edit::SetBodies(Some(Box::new(new))));
        }
        refused.show_alone(ui, "bodies");
        ui.add_space(4.0);
        let [n_vertices, n_facets] = spec.shape.counts();
        let (lo, hi) = spec.bounds();
        let [x, y, z] = (hi - lo).to_array().map(to_mm);
        let size = format!(
            "{x:.3} × {y:.3} × {z:.3} mm, {n_vertices} vertices and {n_facets} triangles, welded within {} mm",
            spec.weld_mm
        );
        ui.add(egui::Label::new(RichText::new(size).weak()).wrap());
    });
    section(ui, "Feed", true, |ui| feed(ui, spec, &mut state.feed, out));
    section(ui, "In their place", true, |ui| {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Import bodies…").on_hover_text(Command::ImportBodies.text_and_tip().1).clicked() {
                out.push(Action::Run(Command::ImportBodies));
            }
            let tip = "Take the bodies out and put the coax-fed patch in their place; undo brings them back";
            if ui.button("Patch template").on_hover_text(tip).clicked() {
                out.edit("bodies", Edit::SetBodies(None));
            }
        });
    });
}

/// Where the bodies are fed, and where they are to be.
fn feed(ui: &mut Ui, spec: &BodiesSpec, typed: &mut FeedUi, out: &mut Outbox) {
    typed.follow(spec.feed);
    let now = match spec.feed {
        None => "None yet: the field solver needs one.".to_owned(),
        Some(FeedSpec { from_mm: [a, b, c], to_mm: [d, e, f], ohm }) => {
            format!("{ohm} Ω from ({a:.3}, {b:.3}, {c:.3}) to ({d:.3}, {e:.3}, {f:.3}) mm")
        }
    };
    ui.add(egui::Label::new(RichText::new(now).weak()).wrap());
    let tip =
        "Across the lowest gap between two metal bodies above each other; else from one place on metal to another";
    ui.checkbox(&mut typed.is_upright, "Upright").on_hover_text(tip);
    rows(ui, "feed", |ui| {
        let n_numbers = if typed.is_upright { 2 } else { 3 };
        let names = if typed.is_upright { &["Place"][..] } else { &["From", "To"] };
        for (name, end) in names.iter().zip(&mut typed.ends_mm) {
            ui.label(*name).on_hover_text("mm");
            ui.horizontal(|ui| {
                for (axis, value) in ["x ", "y ", "z "].into_iter().zip(end).take(n_numbers) {
                    ui.add(DragValue::new(value).prefix(axis).speed(0.01).max_decimals(4)).on_hover_text("mm");
                }
            });
            ui.end_row();
        }
        let ohm = Number::new("feed_ohm", "Resistance", "Ω", 0.5).tip("Of the source across the gap");
        if let (_, Some(new)) = ohm.show(ui, typed.ohm) {
            typed.ohm = new;
        }
        ui.end_row();
    });
    ui.horizontal_wrapped(|ui| {
        if ui.button("Place feed").on_hover_text("A lumped source in series with its resistance").clicked() {
            place_feed(spec, typed, out);
        }
        let tip = "Click the antenna where the feed goes; Esc gives up";
        let pick = egui::Button::new("Pick in the view").selected(typed.picks.is_some());
        if ui.add(pick).on_hover_text(tip).clicked() {
            typed.picks = if typed.picks.is_some() { None } else { Some(0) };
        }
        if spec.feed.is_some() && ui.button("Remove feed").on_hover_text("Leave the bodies without one").clicked() {
            out.edit("feed", Edit::SetBodies(Some(Box::new(BodiesSpec { feed: None, ..spec.clone() }))));
        }
    });
    if let Some(error) = &typed.error {
        ui.add(egui::Label::new(RichText::new(error).color(Tokens::here(ui).error).small()).wrap());
    }
}

/// Places the feed as typed, or says why not.
pub(super) fn place_feed(spec: &BodiesSpec, typed: &mut FeedUi, out: &mut Outbox) {
    let [[x, y, _], _] = typed.ends_mm;
    let fed = match typed.is_upright {
        true => spec.with_upright_feed([x, y], typed.ohm),
        false => spec.with_feed(typed.ends_mm, typed.ohm),
    };
    typed.error = fed.as_ref().err().map(ToString::to_string);
    if let Ok(fed) = fed {
        out.edit("feed", Edit::SetBodies(Some(Box::new(fed))));
    }
}
