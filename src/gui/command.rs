//! Every command of the window: its text, tooltip, keys and when it can be used.
//!
//! Menus, toolbar and shortcuts all read this one list, so that none can say something the others do not.

use super::selecting::Pick;
use super::ui_state::Heat;
use crate::project::Example;
use crate::render::{Operator, StandardView};
use egui::ThemePreference;

/// Something the user can ask for. `Mirror` holds the number of the axis across whose mid-plane edits are mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    New,
    Open,
    Save,
    SaveAs,
    ClearRecent,
    ImportOutline,
    ImportBodies,
    Export,
    Quit,
    Undo,
    Redo,
    SelectAll,
    SelectNone,
    Select(Pick),
    BoxSelect,
    LassoSelect,
    Operate(Operator),
    Proportional,
    Snap,
    Mirror(usize),
    ResetSelected,
    ResetAll,
    Play,
    Compensate,
    CompensateNot,
    Mesh,
    ExportMesh,
    ShowMesh,
    Solve,
    ShowResults,
    ShowPattern,
    ExportResults,
    SavePlot,
    SavePicture,
    Report,
    Compare,
    ShowGhost,
    Paint(Heat),
    Fit,
    LookFrom(StandardView),
    Orthographic,
    ShowCage,
    SeeThrough,
    ShowHistory,
    ShowLog,
    ShowLeft,
    ShowRight,
    ResetLayout,
    ZoomIn,
    ZoomOut,
    ZoomReset,
    NextPanel,
    PreviousPanel,
    Theme(ThemePreference),
    Palette,
    Keys,
    Welcome,
    Example(Example),
}

/// What decides whether a command can be used, and whether it is ticked.
#[derive(Clone, Copy, Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "each is an independent fact of the present moment")]
pub(super) struct Facts {
    pub(super) can_undo: bool,
    pub(super) can_redo: bool,
    pub(super) has_recent: bool,
    pub(super) has_selection: bool,
    pub(super) has_hand_edits: bool,
    pub(super) compensates: bool,
    /// Whether imported bodies are in the patch's place.
    pub(super) has_bodies: bool,
    pub(super) has_mesh: bool,
    pub(super) shows_mesh: bool,
    pub(super) is_solving: bool,
    pub(super) has_results: bool,
    pub(super) shows_results: bool,
    pub(super) has_pattern: bool,
    pub(super) shows_pattern: bool,
    pub(super) orthographic: bool,
    pub(super) shows_cage: bool,
    pub(super) sees_through: bool,
    pub(super) shows_log: bool,
    pub(super) shows_history: bool,
    pub(super) shows_left: bool,
    pub(super) shows_right: bool,
    pub(super) selects_by_box: bool,
    pub(super) heat: Heat,
    pub(super) is_comparing: bool,
    pub(super) has_cylinder: bool,
    pub(super) shows_ghost: bool,
    pub(super) selects_by_lasso: bool,
    pub(super) snaps: bool,
    pub(super) is_proportional: bool,
    pub(super) mirrors: [bool; 2],
    /// Whether the deformation can be played: it is there and computed in full.
    pub(super) can_play: bool,
    pub(super) is_playing: bool,
    pub(super) theme: Option<ThemePreference>,
}

/// Why something cannot be done with imported bodies.
const TEMPLATE_ONLY: &str = "imported bodies are in the patch's place, and only the patch can";

impl Command {
    /// All commands, in the order of the menus.
    pub(super) const ALL: &'static [Self] = &[
        Self::New,
        Self::Open,
        Self::Save,
        Self::SaveAs,
        Self::ClearRecent,
        Self::ImportOutline,
        Self::ImportBodies,
        Self::Export,
        Self::Quit,
        Self::Undo,
        Self::Redo,
        Self::SelectAll,
        Self::SelectNone,
        Self::Select(Pick::Inverse),
        Self::BoxSelect,
        Self::LassoSelect,
        Self::Select(Pick::Station),
        Self::Select(Pick::Row),
        Self::Select(Pick::Column),
        Self::Select(Pick::Top),
        Self::Select(Pick::Bottom),
        Self::Select(Pick::More),
        Self::Select(Pick::Less),
        Self::Operate(Operator::Move),
        Self::Operate(Operator::Rotate),
        Self::Operate(Operator::Scale),
        Self::Proportional,
        Self::Snap,
        Self::Mirror(0),
        Self::Mirror(1),
        Self::ResetSelected,
        Self::ResetAll,
        Self::Play,
        Self::Compensate,
        Self::CompensateNot,
        Self::Mesh,
        Self::ExportMesh,
        Self::ShowMesh,
        Self::Solve,
        Self::ShowResults,
        Self::ShowPattern,
        Self::ExportResults,
        Self::SavePlot,
        Self::SavePicture,
        Self::Report,
        Self::Compare,
        Self::ShowGhost,
        Self::Paint(Heat::None),
        Self::Paint(Heat::Area),
        Self::Paint(Heat::MaxStrain),
        Self::Paint(Heat::MinStrain),
        Self::Paint(Heat::Thickness),
        Self::Paint(Heat::Distance),
        Self::Fit,
        Self::LookFrom(StandardView::Front),
        Self::LookFrom(StandardView::Back),
        Self::LookFrom(StandardView::Right),
        Self::LookFrom(StandardView::Left),
        Self::LookFrom(StandardView::Top),
        Self::LookFrom(StandardView::Bottom),
        Self::LookFrom(StandardView::Isometric),
        Self::Orthographic,
        Self::ShowCage,
        Self::SeeThrough,
        Self::ShowHistory,
        Self::ShowLog,
        Self::ShowLeft,
        Self::ShowRight,
        Self::ResetLayout,
        Self::ZoomIn,
        Self::ZoomOut,
        Self::ZoomReset,
        Self::NextPanel,
        Self::PreviousPanel,
        Self::Theme(ThemePreference::System),
        Self::Theme(ThemePreference::Light),
        Self::Theme(ThemePreference::Dark),
        Self::Palette,
        Self::Keys,
        Self::Welcome,
        Self::Example(Example::Flat),
        Self::Example(Example::BentH),
        Self::Example(Example::BentE),
        Self::Example(Example::Saddle),
        Self::Example(Example::Twist),
    ];

    /// The text in menus and on buttons, and what it does.
    pub(super) fn text_and_tip(self) -> (&'static str, &'static str) {
        match self {
            Self::New => ("New", "Start again with the paper's antenna, bent to R = 10 mm"),
            Self::Open => ("Open…", "Open a project file"),
            Self::Save => ("Save", "Save the project file"),
            Self::SaveAs => ("Save as…", "Save the project under another name"),
            Self::ClearRecent => ("Clear recent files", "Forget which files were used last; the files stay"),
            Self::ImportOutline => ("Import outline…", "Take the patch's outline from a DXF or SVG drawing"),
            Self::ImportBodies => {
                ("Import bodies…", "Put closed bodies from STL, OBJ or GLB files in the patch's place")
            }
            Self::Export => ("Export…", "Write the geometry with its certificate of no gaps"),
            Self::Quit => ("Quit", "Close the window"),
            Self::Undo => ("Undo", "Take back the last step"),
            Self::Redo => ("Redo", "Do again what was taken back"),
            Self::SelectAll => ("Select all vertices", "Select every cage vertex"),
            Self::SelectNone => ("Select none", "Deselect all cage vertices"),
            Self::Select(pick) => pick.text_and_tip(),
            Self::BoxSelect => ("Select by box", "Drag a box around vertices; Shift adds them, Alt takes them away"),
            Self::LassoSelect => {
                ("Select by lasso", "Draw a line around vertices; Shift adds them, Alt takes them away")
            }
            Self::Operate(Operator::Move) => {
                ("Move", "Move the selected vertices with the pointer or by typed numbers")
            }
            Self::Operate(Operator::Rotate) => ("Rotate", "Turn the selected vertices about their middle"),
            Self::Operate(Operator::Scale) => ("Scale", "Spread or gather the selected vertices about their middle"),
            Self::Proportional => {
                ("Proportional editing", "Let vertices near the selection follow it, the nearer the more")
            }
            Self::Snap => ("Snap to steps", "Round moves to whole steps; Ctrl does the opposite while moving"),
            Self::Mirror(0) => ("Mirror in x", "Do the mirrored to the partners across the plane x = 0"),
            Self::Mirror(_) => ("Mirror in y", "Do the mirrored to the partners across the plane y = 0"),
            Self::Play => ("Play deformation", "Show the antenna go from flat to deformed; again stops"),
            Self::ResetSelected => {
                ("Reset selected vertices", "Put the selected vertices back to where the presets have them")
            }
            Self::ResetAll => ("Reset all vertices", "Remove all hand edits of the cage"),
            Self::Compensate => ("Compensate", "Change the flat antenna so that it keeps its size when deformed"),
            Self::CompensateNot => ("No compensation", "Deform the antenna as drawn"),
            Self::Mesh => ("Mesh", "Fill the antenna and the air around it with tetrahedra"),
            Self::ExportMesh => ("Export mesh…", "Write the mesh for a field solver or a viewer"),
            Self::ShowMesh => ("Mesh view", "Show the mesh, cut open, instead of the antenna in its cage"),
            Self::Solve => ("Solve", "Compute the antenna's reflection over the band, in the background"),
            Self::ShowResults => ("Results", "Show or hide reflection, patterns and figures of the runs"),
            Self::ShowPattern => ("3-D pattern", "Draw the radiation pattern around the antenna"),
            Self::ExportResults => ("Export results…", "Write a run's reflection as a table or a Touchstone file"),
            Self::SavePlot => ("Save plot…", "Save a plot as SVG, PNG or CSV, as it would be printed"),
            Self::SavePicture => ("Save picture…", "Save the 3-D view as a picture of any size, with its colour bar"),
            Self::Report => ("Save report…", "Write one page on the project, for any browser and for print"),
            Self::Compare => ("Compare compensations", "Compute it raw, by WL and isometrically, side by side"),
            Self::ShowGhost => ("Exact cylinder", "Draw the exact cylinder through the antenna"),
            Self::Paint(heat) => (heat.text(), heat.tip()),
            Self::Fit => ("Fit", "Show all of the antenna and its cage, or of the mesh"),
            Self::LookFrom(view) => view_text(view),
            Self::Orthographic => ("Orthographic", "No perspective: equal lengths look equal"),
            Self::ShowCage => ("Cage", "Show the cage and its vertices"),
            Self::SeeThrough => ("See-through substrate", "Show the pin and the ground through the substrate"),
            Self::ShowHistory => ("History", "List every step of the project; go back to any of them"),
            Self::ShowLog => ("Messages", "Show or hide the messages since the program began"),
            Self::ShowLeft => ("Left side", "Show the panels on the left of the view"),
            Self::ShowRight => ("Right side", "Show the panels on the right of the view"),
            Self::ResetLayout => {
                ("Reset layout", "Put panels, tabs and sizes back to where they were at the first start")
            }
            Self::ZoomIn => ("Larger interface", "Make text and controls larger"),
            Self::ZoomOut => ("Smaller interface", "Make text and controls smaller"),
            Self::ZoomReset => ("Normal interface", "Text and controls in their normal size"),
            Self::NextPanel => ("Next panel", "Give the keys to the next panel; Tab goes on within it"),
            Self::PreviousPanel => ("Previous panel", "Give the keys to the panel before"),
            Self::Theme(ThemePreference::System) => ("As the system", "Light or dark as the desktop is"),
            Self::Theme(ThemePreference::Light) => ("Light", "Dark lettering on a light ground"),
            Self::Theme(ThemePreference::Dark) => ("Dark", "Light lettering on a dark ground"),
            Self::Palette => ("Find a command…", "Search all commands by what they are called or do"),
            Self::Keys => ("Keys and mouse", "List what the keys and the mouse do"),
            Self::Welcome => ("Welcome", "Examples and recent files to begin with"),
            Self::Example(example) => example_text(example),
        }
    }

    /// Why it cannot be used now; `None` if it can.
    pub(super) fn why_not(self, facts: &Facts) -> Option<&'static str> {
        let (is_possible, why) = match self {
            Self::Undo => (facts.can_undo, "there is nothing to take back"),
            Self::Redo => (facts.can_redo, "nothing was taken back"),
            Self::ClearRecent => (facts.has_recent, "no file was used yet"),
            Self::SelectNone => (facts.has_selection, "no vertex is selected"),
            Self::ResetSelected if facts.has_hand_edits => (facts.has_selection, "no vertex is selected"),
            Self::ResetSelected | Self::ResetAll => (facts.has_hand_edits, "no vertex was moved by hand"),
            Self::Compensate | Self::Compare if facts.has_bodies => (false, TEMPLATE_ONLY),
            Self::ImportOutline => (!facts.has_bodies, TEMPLATE_ONLY),
            Self::CompensateNot => (facts.compensates, "there is no compensation"),
            Self::ExportMesh | Self::ShowMesh => (facts.has_mesh, "there is no mesh yet"),
            Self::Solve => (!facts.is_solving, "a run is under way"),
            Self::ExportResults => (facts.has_results, "there are no results yet"),
            Self::SavePlot => (
                facts.has_results || facts.has_mesh || facts.heat != Heat::None,
                "there is nothing to plot: no results, no mesh, nothing painted",
            ),
            Self::Compare => (!facts.is_comparing, "a comparison is under way"),
            Self::ShowGhost | Self::Paint(Heat::Distance) => {
                (facts.has_cylinder, "only a single bend without hand edits has one")
            }
            Self::ShowPattern => (facts.has_pattern, "no run with a pattern yet"),
            Self::BoxSelect | Self::LassoSelect | Self::Operate(_) | Self::ShowCage | Self::SeeThrough
                if facts.shows_mesh =>
            {
                (false, "there is no cage in the view of the mesh")
            }
            Self::BoxSelect | Self::LassoSelect => (facts.shows_cage, "the cage is hidden"),
            Self::Operate(_) if facts.has_selection => (facts.shows_cage, "the cage is hidden"),
            Self::Operate(_) => (false, "no vertex is selected"),
            Self::Select(pick) if pick.needs_selection() => (facts.has_selection, "no vertex is selected"),
            Self::Play => (facts.can_play, "there is no deformation that was computed in full"),
            _ => return None,
        };
        (!is_possible).then_some(why)
    }

    /// Whether it can be used now.
    pub(super) fn is_enabled(self, facts: &Facts) -> bool {
        self.why_not(facts).is_none()
    }

    /// Whether it is ticked; `None` for commands that are no switches.
    pub(super) fn is_ticked(self, facts: &Facts) -> Option<bool> {
        match self {
            Self::Orthographic => Some(facts.orthographic),
            Self::ShowMesh => Some(facts.shows_mesh),
            Self::ShowResults => Some(facts.shows_results),
            Self::ShowPattern => Some(facts.shows_pattern),
            Self::ShowGhost => Some(facts.shows_ghost),
            Self::Paint(heat) => Some(facts.heat == heat),
            Self::ShowCage => Some(facts.shows_cage),
            Self::SeeThrough => Some(facts.sees_through),
            Self::ShowHistory => Some(facts.shows_history),
            Self::ShowLeft => Some(facts.shows_left),
            Self::ShowRight => Some(facts.shows_right),
            Self::ShowLog => Some(facts.shows_log),
            Self::BoxSelect => Some(facts.selects_by_box),
            Self::LassoSelect => Some(facts.selects_by_lasso),
            Self::Proportional => Some(facts.is_proportional),
            Self::Snap => Some(facts.snaps),
            Self::Mirror(axis) => Some(facts.mirrors[axis]),
            Self::Play => Some(facts.is_playing),
            Self::Theme(theme) => Some(facts.theme == Some(theme)),
            _ => None,
        }
    }
}

/// Text and tooltip of an example.
fn example_text(example: Example) -> (&'static str, &'static str) {
    match example {
        Example::Flat => ("Flat antenna", "The paper's patch antenna as drawn, in a cage"),
        Example::BentH => ("Bent, H-plane, R = 10 mm", "The width curves around a cylinder along y"),
        Example::BentE => ("Bent, E-plane, R = 10 mm", "The resonant length curves around a cylinder along x"),
        Example::Saddle => ("Saddle", "Curved in opposite ways along x and y"),
        Example::Twist => ("Twist", "A half wave across the patch that turns along it"),
    }
}

/// Text and tooltip of a view.
fn view_text(view: StandardView) -> (&'static str, &'static str) {
    match view {
        StandardView::Front => ("Front", "Look along +y, x to the right"),
        StandardView::Back => ("Back", "Look along -y"),
        StandardView::Right => ("Right", "Look from +x"),
        StandardView::Left => ("Left", "Look from -x"),
        StandardView::Top => ("Top", "Look down, x to the right and y up"),
        StandardView::Bottom => ("Bottom", "Look up at the ground plane"),
        StandardView::Isometric => ("Isometric", "Look from +x, -y and +z"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::bars::MENUS;
    use super::*;
    use egui::os::OperatingSystem;
    use std::collections::HashMap;

    #[test]
    fn no_two_commands_share_a_key() {
        for os in [OperatingSystem::Nix, OperatingSystem::Windows, OperatingSystem::Mac] {
            let mut seen = HashMap::new();
            for &command in Command::ALL {
                for key in command.keys(os) {
                    let before = seen.insert(key, command);
                    assert_eq!(before, None, "{key:?} runs {command:?} too");
                }
            }
        }
    }

    #[test]
    fn every_command_says_what_it_does() {
        for command in Command::ALL {
            let (text, tip) = command.text_and_tip();
            assert!(!text.is_empty() && tip.len() > text.len() / 2, "{command:?}");
            assert!(!tip.ends_with('.'), "{command:?}: tips are phrases");
        }
    }

    #[test]
    fn every_command_is_listed_and_stands_in_one_menu() {
        let source = include_str!("command.rs");
        let body = source.split("pub(super) enum Command {").nth(1).expect("the enum");
        let names = body.split('}').next().expect("its end").lines().map(|line| line.trim().trim_end_matches(','));
        for name in names.filter(|name| !name.is_empty()) {
            let name = name.split('(').next().expect("a first part");
            let is_it = |c: &&Command| format!("{c:?}").split('(').next() == Some(name);
            assert!(Command::ALL.iter().any(|c| is_it(&c)), "{name} is missing from the list of all");
        }
        let in_menus = || MENUS.iter().flat_map(|(_, groups)| groups.iter().flat_map(|group| group.iter()));
        for command in Command::ALL {
            assert_eq!(in_menus().filter(|c| *c == command).count(), 1, "{command:?} stands in one menu");
        }
        assert_eq!(in_menus().count(), Command::ALL.len(), "and nothing else does");
    }

    #[test]
    fn what_cannot_be_used_says_why() {
        let nothing = Facts { shows_mesh: true, is_solving: true, ..Facts::default() };
        let refused: Vec<&Command> = Command::ALL.iter().filter(|c| !c.is_enabled(&nothing)).collect();
        assert!(refused.len() > 8, "{refused:?}");
        for command in refused {
            assert!(command.why_not(&nothing).is_some_and(|why| !why.is_empty()), "{command:?}");
        }
    }
}
