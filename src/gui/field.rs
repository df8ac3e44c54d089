//! Labelled inputs, so that every number has a name, a unit, a tooltip and one undo step per gesture.

use super::outbox::Outbox;
use super::theme::Tokens;
use crate::project::Edit;
use egui::{ComboBox, DragValue, Grid, InnerResponse, Key, Response, RichText, Slider, Ui, Widget};
use std::ops::RangeInclusive;

/// Width of the labels of a panel, points: the longest one fits.
const LABEL_WIDTH: f32 = 92.0;
/// Room for the number beside a slider, points: two digits, three decimals and the longest unit.
const VALUE_WIDTH: f32 = 97.0;
/// Shortest and longest slider, points.
const SLIDER_WIDTHS: [f32; 2] = [48.0, 160.0];

/// A number in a panel.
#[derive(Clone, Debug)]
pub(super) struct Number {
    /// The field that a refusal is shown at; also what makes the widget unique in its panel.
    pub(super) place: &'static str,
    pub(super) label: &'static str,
    pub(super) tip: &'static str,
    pub(super) unit: &'static str,
    /// Ends of the slider; `None` for a number without one.
    pub(super) slider: Option<RangeInclusive<f64>>,
    /// Change per point dragged, where there is no slider.
    pub(super) speed: f64,
    /// Whether it counts something.
    pub(super) is_count: bool,
}

impl Number {
    /// A number that is typed, or dragged at `speed` per point.
    pub(super) const fn new(place: &'static str, label: &'static str, unit: &'static str, speed: f64) -> Self {
        Self { place, label, tip: "", unit, slider: None, speed, is_count: false }
    }

    /// Adds a tooltip.
    pub(super) const fn tip(mut self, tip: &'static str) -> Self {
        self.tip = tip;
        self
    }

    /// Adds a slider; typed numbers may lie beyond its ends.
    pub(super) const fn slider(mut self, range: RangeInclusive<f64>) -> Self {
        self.slider = Some(range);
        self
    }

    /// Allows whole numbers only.
    pub(super) const fn count(mut self) -> Self {
        self.is_count = true;
        self
    }

    fn suffix(&self) -> String {
        match self.unit {
            "" => String::new(),
            "°" => "°".to_owned(),
            unit => format!(" {unit}"),
        }
    }

    /// Draws label and input as one row of a grid; returns the response and the new value if it changed.
    pub(super) fn show(&self, ui: &mut Ui, value: f64) -> (Response, Option<f64>) {
        let label = ui.label(self.label).on_hover_text(self.tip);
        let mut new = value;
        let rest = ui.available_width() - ui.spacing().item_spacing.x - VALUE_WIDTH;
        ui.spacing_mut().slider_width = rest.clamp(SLIDER_WIDTHS[0], SLIDER_WIDTHS[1]);
        let response = match &self.slider {
            Some(range) => Slider::new(&mut new, range.clone())
                .clamping(egui::SliderClamping::Never)
                .suffix(self.suffix())
                .max_decimals(if self.is_count { 0 } else { 3 })
                .smart_aim(true)
                .update_while_editing(false)
                .ui(ui),
            None => DragValue::new(&mut new)
                .speed(self.speed)
                .suffix(self.suffix())
                .max_decimals(if self.is_count { 0 } else { 4 })
                .update_while_editing(false)
                .ui(ui),
        };
        let response = response.labelled_by(label.id);
        let response = if self.tip.is_empty() { response } else { response.on_hover_text(self.tip) };
        let changed = response.changed() && new.to_bits() != value.to_bits();
        (response, changed.then_some(new))
    }

    /// Draws the row, asks for the change, and shows below it why the last change was refused.
    pub(super) fn row(
        &self,
        ui: &mut Ui,
        value: f64,
        refused: Refused<'_>,
        out: &mut Outbox,
        edit: impl FnOnce(f64) -> Edit,
    ) {
        let (response, new) = self.show(ui, value);
        ui.end_row();
        out.gesture(&response, new.map(|v| (self.place, edit(v))));
        refused.show(ui, self.place);
    }
}

/// The field whose last change was refused, and why.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refused<'a>(pub(super) Option<&'a (&'static str, String)>);

impl Refused<'_> {
    /// Shows the message in a row of its own, if it belongs to `place`.
    pub(super) fn show(self, ui: &mut Ui, place: &str) {
        if let Some((_, message)) = self.0.filter(|(p, _)| *p == place) {
            ui.label("");
            self.message(ui, message);
            ui.end_row();
        }
    }

    /// Shows the message outside of a grid, if it belongs to `place`.
    pub(super) fn show_alone(self, ui: &mut Ui, place: &str) {
        if let Some((_, message)) = self.0.filter(|(p, _)| *p == place) {
            self.message(ui, message);
        }
    }

    fn message(self, ui: &mut Ui, message: &str) {
        let text = RichText::new(message).color(Tokens::here(ui).error).small();
        ui.add(egui::Label::new(text).wrap());
    }
}

/// A grid of labelled inputs.
pub(super) fn rows<R>(
    ui: &mut Ui,
    id: impl std::hash::Hash + std::fmt::Debug,
    content: impl FnOnce(&mut Ui) -> R,
) -> R {
    Grid::new(id).num_columns(2).min_col_width(LABEL_WIDTH).striped(false).spacing([8.0, 5.0]).show(ui, content).inner
}

/// A heading over a group of inputs.
pub(super) fn section<R>(ui: &mut Ui, title: &str, open: bool, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    let heading = RichText::new(title).strong();
    egui::CollapsingHeader::new(heading).id_salt(title).default_open(open).show_unindented(ui, content).body_returned
}

/// A list of choices that closes whether one was chosen by the pointer or by a key.
pub(super) trait Choices {
    /// Draws it with its choices.
    fn show_list<R>(self, ui: &mut Ui, choices: impl FnOnce(&mut Ui) -> R) -> InnerResponse<Option<R>>;
}

impl Choices for ComboBox<'_> {
    fn show_list<R>(self, ui: &mut Ui, choices: impl FnOnce(&mut Ui) -> R) -> InnerResponse<Option<R>> {
        let mut closes = false;
        let shown = self.show_ui(ui, |ui| {
            let inner = choices(ui);
            closes = is_chosen_by_key(ui);
            if closes {
                ui.close();
            }
            inner
        });
        if closes {
            shown.response.request_focus();
        }
        shown
    }
}

/// Whether a key has pressed something of this layer in this frame.
fn is_chosen_by_key(ui: &Ui) -> bool {
    let is_pressed = ui.input(|i| i.key_pressed(Key::Enter) || i.key_pressed(Key::Space));
    let focused = ui.memory(|m| m.focused()).filter(|_| is_pressed);
    let layer = |id| ui.ctx().viewport(|v| v.this_pass.widgets.get(id).map(|w| w.layer_id));
    focused.is_some_and(|id| layer(id) == Some(ui.layer_id()))
}

/// A small button with a symbol and a name for tooltips and screen readers.
pub(super) fn symbol_button(ui: &mut Ui, symbol: &str, name: &str, enabled: bool) -> bool {
    let response = ui.add_enabled(enabled, egui::Button::new(symbol).small());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, name));
    response.on_hover_text(name).clicked()
}
