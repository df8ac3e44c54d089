//! The keys of the commands.

use super::command::{Command, Facts};
use crate::render::{Operator, StandardView};
use egui::{Context, Key, KeyboardShortcut, Modifiers, os::OperatingSystem};

/// A key alone.
pub(super) fn plain(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

/// A key with Shift.
pub(super) fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

impl Command {
    /// Keys that run it; the first is the one shown.
    pub(super) fn keys(self, os: OperatingSystem) -> Vec<KeyboardShortcut> {
        let command = |key| KeyboardShortcut::new(Modifiers::COMMAND, key);
        let command_shift = |key| KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, key);
        let control = |key| KeyboardShortcut::new(Modifiers::CTRL, key);
        match self {
            Self::New => vec![command(Key::N)],
            Self::Open => vec![command(Key::O)],
            Self::Save => vec![command(Key::S)],
            Self::SaveAs => vec![command_shift(Key::S)],
            Self::Export => vec![command(Key::E)],
            Self::Quit => vec![command(Key::Q)],
            Self::Undo => vec![command(Key::Z)],
            Self::Redo if os == OperatingSystem::Mac => vec![command_shift(Key::Z)],
            Self::Redo => vec![command(Key::Y), command_shift(Key::Z)],
            Self::SelectAll => vec![command(Key::A), plain(Key::A)],
            Self::SelectNone => vec![command_shift(Key::A), KeyboardShortcut::new(Modifiers::ALT, Key::A)],
            Self::Select(pick) => pick.keys(),
            Self::BoxSelect => vec![plain(Key::B)],
            Self::LassoSelect => vec![shift(Key::L)],
            Self::Operate(Operator::Move) => vec![plain(Key::G)],
            Self::Operate(Operator::Rotate) => vec![plain(Key::R)],
            Self::Operate(Operator::Scale) => vec![plain(Key::S)],
            Self::Proportional => vec![plain(Key::O)],
            Self::Snap => vec![shift(Key::G)],
            Self::Mirror(0) => vec![shift(Key::X)],
            Self::Mirror(_) => vec![shift(Key::Y)],
            Self::Play => vec![shift(Key::Space)],
            Self::ResetSelected => vec![plain(Key::Delete), plain(Key::Backspace)],
            Self::Compensate => vec![command(Key::Enter)],
            Self::Mesh => vec![plain(Key::M)],
            Self::ExportMesh => vec![command_shift(Key::E)],
            Self::ShowMesh => vec![plain(Key::V)],
            Self::Solve => vec![plain(Key::F5)],
            Self::ShowResults => vec![plain(Key::P)],
            Self::ShowPattern => vec![plain(Key::L)],
            Self::ExportResults => vec![command_shift(Key::R)],
            Self::Fit => vec![plain(Key::F), plain(Key::Home)],
            Self::LookFrom(StandardView::Front) => vec![plain(Key::Num1)],
            Self::LookFrom(StandardView::Back) => vec![control(Key::Num1)],
            Self::LookFrom(StandardView::Right) => vec![plain(Key::Num3)],
            Self::LookFrom(StandardView::Left) => vec![control(Key::Num3)],
            Self::LookFrom(StandardView::Top) => vec![plain(Key::Num7)],
            Self::LookFrom(StandardView::Bottom) => vec![control(Key::Num7)],
            Self::LookFrom(StandardView::Isometric) => vec![plain(Key::Num0)],
            Self::Orthographic => vec![plain(Key::Num5)],
            Self::ShowCage => vec![plain(Key::C)],
            Self::SeeThrough => vec![plain(Key::T)],
            Self::ShowHistory => vec![command(Key::H)],
            Self::Palette => vec![command_shift(Key::P)],
            Self::Keys => vec![plain(Key::F1)],
            Self::ClearRecent | Self::Welcome | Self::Example(_) => Vec::new(),
            Self::ResetAll | Self::CompensateNot | Self::SavePlot | Self::ShowLog | Self::Theme(_) => Vec::new(),
        }
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
            (is_letter && !matches!(k.logical_key, Key::F1 | Key::F5)) || edits_text
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
}
