//! The keys of the commands.

use super::command::Command;
use super::ui_state::Heat;
use crate::project::Example;
use crate::render::{Operator, StandardView};
use egui::{Key, KeyboardShortcut, Modifiers, ThemePreference, os::OperatingSystem};

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
            Self::ImportOutline => vec![command_shift(Key::O)],
            Self::ImportBodies => vec![command_shift(Key::I)],
            Self::SavePlot => vec![command(Key::P)],
            Self::SavePicture => vec![plain(Key::F12)],
            Self::Report => vec![command_shift(Key::H)],
            Self::ClearRecent => vec![command_shift(Key::Delete)],
            Self::ResetAll => vec![shift(Key::Delete)],
            Self::CompensateNot => vec![command_shift(Key::Enter)],
            Self::Compare => vec![command(Key::K)],
            Self::ShowGhost => vec![plain(Key::E)],
            Self::Paint(heat) => vec![KeyboardShortcut::new(Modifiers::ALT, heat_key(heat))],
            Self::ShowLog => vec![command(Key::L)],
            Self::ResetLayout => vec![shift(Key::F8)],
            Self::Theme(ThemePreference::System) => vec![shift(Key::F2)],
            Self::Theme(ThemePreference::Light) => vec![shift(Key::F3)],
            Self::Theme(ThemePreference::Dark) => vec![shift(Key::F4)],
            Self::Welcome => vec![shift(Key::F1)],
            Self::Example(example) => vec![command(example_key(example))],
        }
    }
}

fn heat_key(heat: Heat) -> Key {
    match heat {
        Heat::None => Key::Num0,
        Heat::Area => Key::Num1,
        Heat::MaxStrain => Key::Num2,
        Heat::MinStrain => Key::Num3,
        Heat::Thickness => Key::Num4,
        Heat::Distance => Key::Num5,
    }
}

fn example_key(example: Example) -> Key {
    match example {
        Example::Flat => Key::F1,
        Example::BentH => Key::F2,
        Example::BentE => Key::F3,
        Example::Saddle => Key::F4,
        Example::Twist => Key::F5,
    }
}
