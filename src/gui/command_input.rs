//! How commands are given: by key, as a line of a menu, as a button.

use super::command::{Command, Facts};
use egui::{Context, Key, KeyboardShortcut, Modifiers};

impl Command {
    /// What its tooltip says: what it does and its keys.
    pub(super) fn tooltip(self, ctx: &Context) -> String {
        let (_, tip) = self.text_and_tip();
        let keys: Vec<String> = self.keys(ctx.os()).iter().map(|k| ctx.format_shortcut(k)).collect();
        if keys.is_empty() { tip.to_owned() } else { format!("{tip} ({})", keys.join(", ")) }
    }

    /// The commands whose keys were pressed in this frame, if they can be used; keys are consumed.
    ///
    /// Keys that mean something to a text field belong to it while one is being edited.
    pub(super) fn pressed(ctx: &Context, facts: &Facts) -> Vec<Self> {
        let os = ctx.os();
        let typing = ctx.text_edit_focused();
        let mut keys: Vec<(KeyboardShortcut, Self)> =
            Self::ALL.iter().flat_map(|&c| c.keys(os).into_iter().map(move |k| (k, c))).collect();
        // A shortcut matches with extra modifiers too, so the ones with more modifiers go first.
        keys.sort_by_key(|(k, _)| std::cmp::Reverse(usize::from(k.modifiers.any()) + usize::from(k.modifiers.shift)));
        // Letters and digits, and the keys by which text is selected, undone and redone.
        let is_text = |k: &KeyboardShortcut| {
            let edits_text = matches!(k.logical_key, Key::A | Key::Z | Key::Y);
            let is_letter = k.modifiers.is_none() || k.modifiers == Modifiers::SHIFT;
            (is_letter && !(Key::F1..=Key::F35).contains(&k.logical_key)) || edits_text
        };
        let mut found = Vec::new();
        for (shortcut, command) in keys {
            if !(typing && is_text(&shortcut)) && ctx.input_mut(|i| i.consume_shortcut(&shortcut)) {
                found.push(command);
            }
        }
        found.retain(|c| c.is_enabled(facts));
        found
    }

    /// Draws it as a line of a menu; true if it was chosen.
    pub(super) fn menu_item(self, ui: &mut egui::Ui, facts: &Facts) -> bool {
        let (text, _) = self.text_and_tip();
        let keys = self.keys(ui.ctx().os());
        let mut button = match self.is_ticked(facts) {
            Some(ticked) => egui::Button::selectable(ticked, text),
            None => egui::Button::new(text),
        };
        if let Some(shortcut) = keys.first() {
            button = button.shortcut_text(ui.ctx().format_shortcut(shortcut));
        }
        self.add(ui, facts, button)
    }

    /// Draws it as a button of the toolbar; true if it was pressed.
    pub(super) fn tool_button(self, ui: &mut egui::Ui, facts: &Facts) -> bool {
        let (text, _) = self.text_and_tip();
        let text = text.trim_end_matches('…');
        let button = match self.is_ticked(facts) {
            Some(ticked) => egui::Button::new(text).selected(ticked),
            None => egui::Button::new(text),
        };
        self.add(ui, facts, button)
    }

    fn add(self, ui: &mut egui::Ui, facts: &Facts, button: egui::Button<'_>) -> bool {
        let tip = self.tooltip(ui.ctx());
        let why_not = self.why_not(facts);
        let response = ui.add_enabled(why_not.is_none(), button);
        let why_not = why_not.map_or_else(String::new, |why| format!("{tip}\nNot now: {why}"));
        response.on_hover_text(tip).on_disabled_hover_text(why_not).clicked()
    }
}
