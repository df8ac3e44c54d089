//! What each body is made of, row by row.

use super::field::Choices;
use crate::project::materials::DIELECTRICS;
use crate::project::{BodyKind, MaterialSpec};
use egui::{ComboBox, DragValue, Grid, RichText, Ui};

/// What a dielectric is called whose values were typed.
const CUSTOM: &str = "Other dielectric";
/// Values of a dielectric that is to be typed.
const NEW: (f64, f64) = (2.2, 0.0);

/// Draws a row for each body, of its name, its material (`None` where it is to be chosen) and a note; returns the row
/// whose material was changed, and what to.
pub(super) fn body_rows(
    ui: &mut Ui,
    bodies: &[(String, Option<BodyKind>, String)],
    own: &[MaterialSpec],
) -> Option<(usize, BodyKind)> {
    let mut changed = None;
    Grid::new("body rows").num_columns(4).spacing([8.0, 4.0]).striped(true).show(ui, |ui| {
        for (k, (name, kind, note)) in bodies.iter().enumerate() {
            let label = ui.label(name).on_hover_text(note);
            let combo =
                ComboBox::from_id_salt(("body", k)).width(122.0).height(320.0).selected_text(text(kind.as_ref()));
            let combo = combo.show_list(ui, |ui| choices(ui, kind.as_ref(), own));
            combo.response.labelled_by(label.id).on_hover_text(format!("What {name} is made of"));
            if let Some(new) = combo.inner.flatten() {
                changed = Some((k, new));
            }
            if let Some(BodyKind::Dielectric(material)) = kind
                && let Some(new) = values(ui, name, material)
            {
                changed = Some((k, BodyKind::Dielectric(new)));
            }
            ui.end_row();
        }
    });
    changed
}

fn text(kind: Option<&BodyKind>) -> RichText {
    match kind {
        None => RichText::new("choose…").italics(),
        Some(BodyKind::Metal) => RichText::new("Metal, perfect"),
        Some(BodyKind::Dielectric(m)) if m.name.is_empty() => RichText::new(CUSTOM),
        Some(BodyKind::Dielectric(m)) => RichText::new(&m.name),
    }
}

fn choices(ui: &mut Ui, current: Option<&BodyKind>, own: &[MaterialSpec]) -> Option<BodyKind> {
    let mut chosen = None;
    let mut entry = |ui: &mut Ui, kind: BodyKind, tip: String| {
        if ui.selectable_label(current == Some(&kind), text(Some(&kind))).on_hover_text(tip).clicked() {
            chosen = Some(kind);
        }
    };
    entry(ui, BodyKind::Metal, "A conductor without loss".to_owned());
    ui.separator();
    for material in DIELECTRICS.iter().map(|d| d.to_spec()).chain(own.iter().cloned()) {
        let tip = format!("εr {}, tan δ {}", material.eps_r, material.tan_delta);
        entry(ui, BodyKind::Dielectric(material), tip);
    }
    let (eps_r, tan_delta) = match current {
        Some(BodyKind::Dielectric(m)) => (m.eps_r, m.tan_delta),
        _ => NEW,
    };
    let other = MaterialSpec { name: String::new(), eps_r, tan_delta };
    entry(ui, BodyKind::Dielectric(other), "Any other, by its numbers".to_owned());
    chosen
}

/// Permittivity and loss tangent; other values are another material.
fn values(ui: &mut Ui, name: &str, material: &MaterialSpec) -> Option<MaterialSpec> {
    let mut new = material.clone();
    let number = |ui: &mut Ui, value: &mut f64, prefix: &str, speed: f64, range: std::ops::RangeInclusive<f64>| {
        let input = DragValue::new(value).prefix(prefix).speed(speed).max_decimals(5).range(range);
        ui.add(input.update_while_editing(false)).on_hover_text(format!("Of {name}")).changed()
    };
    let mut is_changed = number(ui, &mut new.eps_r, "εr ", 0.01, 1.0..=1000.0);
    is_changed |= number(ui, &mut new.tan_delta, "tan δ ", 1e-4, 0.0..=1.0);
    is_changed.then(|| MaterialSpec { name: String::new(), ..new }.recognized())
}
