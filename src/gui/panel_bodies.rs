//! Imported bodies in the patch's place: what each is made of, and the ways to others.

use super::body_rows::body_rows;
use super::command::Command;
use super::field::{Refused, section};
use super::outbox::{Action, Outbox};
use crate::project::{BodiesSpec, BodySpec, Edit, Project};
use crate::units::to_mm;
use egui::{RichText, Ui};

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, project: &Project, spec: &BodiesSpec, refused: Refused<'_>, out: &mut Outbox) {
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
