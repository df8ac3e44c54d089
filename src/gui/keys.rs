//! The keys of the commands.

use super::command::Command;
use crate::render::{Operator, StandardView};
use egui::{Key, KeyboardShortcut, Modifiers, os::OperatingSystem};

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
            Self::ShowLeft => vec![plain(Key::F8)],
            Self::ShowRight => vec![plain(Key::F9)],
            Self::ZoomIn => vec![command(Key::Plus), command(Key::Equals)],
            Self::ZoomOut => vec![command(Key::Minus)],
            Self::ZoomReset => vec![command(Key::Num0)],
            Self::NextPanel => vec![plain(Key::F6)],
            Self::PreviousPanel => vec![shift(Key::F6)],
            Self::Palette => vec![command_shift(Key::P)],
            Self::Keys => vec![plain(Key::F1)],
            Self::ResetLayout | Self::ClearRecent | Self::Welcome | Self::Example(_) => Vec::new(),
            Self::ImportOutline | Self::ImportBodies => Vec::new(),
            Self::SavePlot | Self::SavePicture | Self::Report | Self::Compare | Self::ShowGhost => Vec::new(),
            Self::Paint(_) | Self::ResetAll | Self::CompensateNot | Self::ShowLog | Self::Theme(_) => Vec::new(),
        }
    }
}
