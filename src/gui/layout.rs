//! Which panes there are and where: a tree of tiles that the user drags, splits and resizes, kept between runs.
//!
//! Sizes of a container's children are its shares, in points wherever the 3-D view is within: there the others keep
//! theirs when the window changes, and the view takes what is left.

use super::ui_state::{RightTab, Tab};
use egui::{Id, Rect, Vec2};
use egui_tiles::{Container, LinearDir, Shares, SimplificationOptions, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

/// Widths of the sides at first, points: all inputs fit, and 1280 points leave the view the larger half.
const WIDTHS: [f32; 2] = [312.0, 316.0];
/// Heights of the results and of the messages at first, points.
const HEIGHTS: [f32; 2] = [320.0, 130.0];
/// Greatest part of the room for what lies beside or below the view.
const GREATEST: f32 = 0.6;
/// Part of the free room for what is put beside or below the view.
const NEW: f32 = 1.0 / 3.0;

/// Something that is shown in a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) enum Pane {
    View,
    Cage,
    Antenna,
    History,
    Figures,
    Mesh,
    Solve,
    Results,
    Messages,
}

impl Pane {
    /// The panes that are left of the view at first, right of it, and below all.
    pub(super) const LEFT: [Self; 3] = [Self::Cage, Self::Antenna, Self::History];
    pub(super) const RIGHT: [Self; 3] = [Self::Figures, Self::Mesh, Self::Solve];
    pub(super) const BELOW: [Self; 2] = [Self::Results, Self::Messages];

    /// Name on its tab, and what it holds.
    pub(super) fn text_and_tip(self) -> (&'static str, &'static str) {
        match self {
            Self::View => ("View", "The antenna in its cage"),
            Self::Cage => ("Cage", "Presets, cage and vertices"),
            Self::Antenna => ("Antenna", "Dimensions and materials of the flat antenna"),
            Self::History => ("History", "Every step of the project; go back to any of them"),
            Self::Figures => ("Deformation", "Distortion of the deformed antenna and its compensation"),
            Self::Mesh => ("Mesh", "The tetrahedral mesh of the antenna and the air around it"),
            Self::Solve => ("Solve", "The field: reflection and radiation"),
            Self::Results => ("Results", "Reflection, patterns and figures of the runs"),
            Self::Messages => ("Messages", "What was said since the program began"),
        }
    }

    /// Least width and height, points: below that nothing can be read.
    fn least(self) -> [f32; 2] {
        match self {
            Self::Results => [300.0, 200.0],
            Self::Messages => [200.0, 80.0],
            _ => [260.0, 160.0],
        }
    }
}

impl From<Tab> for Pane {
    fn from(tab: Tab) -> Self {
        match tab {
            Tab::Cage => Self::Cage,
            Tab::Antenna => Self::Antenna,
            Tab::History => Self::History,
        }
    }
}

impl From<RightTab> for Pane {
    fn from(tab: RightTab) -> Self {
        match tab {
            RightTab::Figures => Self::Figures,
            RightTab::Mesh => Self::Mesh,
            RightTab::Solve => Self::Solve,
        }
    }
}

/// The panes in their tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Layout {
    pub(super) tree: Tree<Pane>,
}

impl Default for Layout {
    /// Tabs on both sides of the view; results and messages below, over the whole width that the curves need.
    fn default() -> Self {
        let mut tiles = Tiles::default();
        let [results, messages] = Pane::BELOW;
        let groups = [&Pane::LEFT[..], &[Pane::View], &Pane::RIGHT, &[results], &[messages]];
        let [left, view, right, results, messages] = groups.map(|panes| {
            let children = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
            tiles.insert_tab_tile(children)
        });
        let row = tiles.insert_horizontal_tile(vec![left, view, right]);
        let root = tiles.insert_vertical_tile(vec![row, results, messages]);
        for (of, [first, second], sizes) in [(row, [left, right], WIDTHS), (root, [results, messages], HEIGHTS)] {
            if let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(of) {
                linear.shares.set_share(first, sizes[0]);
                linear.shares.set_share(second, sizes[1]);
            }
        }
        Self { tree: Tree::new(Id::unique("panes"), root, tiles) }
    }
}

/// How a tree is kept simple: every pane has its tab.
pub(super) fn tabs_for_all() -> SimplificationOptions {
    SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
}

impl Layout {
    /// Whether each pane is there once: what another version kept may be of other panes.
    pub(super) fn is_sound(&self) -> bool {
        let Some(tiles) = self.in_order() else { return false };
        let found: Vec<Pane> = tiles.into_iter().filter_map(|id| self.tree.tiles.get_pane(&id).copied()).collect();
        let all = Pane::LEFT.into_iter().chain(Pane::RIGHT).chain(Pane::BELOW).chain([Pane::View]);
        let each_once = all.clone().all(|pane| found.iter().filter(|p| **p == pane).count() == 1);
        each_once && found.len() == all.count()
    }

    /// All tiles as they are read, from left to right and from top to bottom; `None` if it is no tree.
    fn in_order(&self) -> Option<Vec<TileId>> {
        let mut found = Vec::new();
        let mut open: Vec<TileId> = self.tree.root().into_iter().collect();
        while let Some(id) = open.pop() {
            if found.len() == self.tree.tiles.len() {
                return None;
            }
            found.push(id);
            if let Tile::Container(container) = self.tree.tiles.get(id)? {
                let children: Vec<TileId> = container.children().copied().collect();
                open.extend(children.into_iter().rev());
            }
        }
        Some(found)
    }

    /// The tile of a pane.
    pub(super) fn tile(&self, pane: Pane) -> Option<TileId> {
        self.tree.tiles.find_pane(&pane)
    }

    /// Whether a pane is on show, and not behind another tab.
    pub(super) fn is_in_front(&self, pane: Pane) -> bool {
        self.tile(pane).is_some_and(|tile| self.tree.active_tiles().contains(&tile))
    }

    /// Brings a pane to the front of its tabs.
    pub(super) fn bring_forward(&mut self, pane: Pane) {
        self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(p) if *p == pane));
    }

    /// Shows or folds away some panes, wherever they are.
    pub(super) fn show(&mut self, panes: &[Pane], shows: bool) {
        for tile in panes.iter().filter_map(|pane| self.tile(*pane)).collect::<Vec<_>>() {
            self.tree.set_visible(tile, shows);
        }
    }

    /// The panes in front and where they are with their tabs, in the order in which they are read.
    pub(super) fn areas(&self) -> Vec<(Pane, Rect)> {
        let active = self.tree.active_tiles();
        let shown = self.in_order().unwrap_or_default().into_iter().filter(|id| active.contains(id));
        let area = |id: TileId| {
            let pane = self.tree.tiles.get_pane(&id)?;
            let with_tabs = self.tree.tiles.parent_of(id).unwrap_or(id);
            Some((*pane, self.tree.tiles.rect(with_tabs)?))
        };
        shown.filter_map(area).collect()
    }

    /// How far results and messages reach up from the lower left corner, where notifications appear, points.
    pub(super) fn height_at_corner(&self, width: f32) -> f32 {
        let areas = self.areas();
        let whole = areas.iter().fold(Rect::NOTHING, |whole, (_, rect)| whole.union(*rect));
        let mut top = whole.bottom();
        // From the lowest up, as long as they lie upon each other.
        for (_, rect) in areas.iter().rev().filter(|(pane, _)| Pane::BELOW.contains(pane)) {
            let is_next = (rect.bottom() - top).abs() < 4.0 && rect.left() < whole.left() + width;
            if is_next && rect.height() <= GREATEST * whole.height() {
                top = rect.top();
            }
        }
        (whole.bottom() - top).max(0.0)
    }

    /// Gives whatever lies around the view the size it had, and the view the rest of `size`; `gap` is between tiles.
    pub(super) fn keep_sizes(&mut self, mut size: Vec2, gap: f32) {
        // What a drag has left empty takes no room.
        self.tree.simplify(&tabs_for_all());
        let mut at = self.tree.root();
        while let Some(id) = at {
            let Some(inner) = self.child_with_view(id) else { return };
            let Some(container) = self.tree.tiles.get_container(id) else { return };
            let shown = container.children().copied().filter(|c| self.tree.tiles.is_visible_in_layout(*c));
            let others: Vec<TileId> = shown.filter(|c| *c != inner).collect();
            if let Container::Linear(linear) = container {
                let along = usize::from(linear.dir == LinearDir::Vertical);
                let room = (size[along] - gap * others.len() as f32).max(0.0);
                let sizes = self.sizes(&linear.shares, &others, (inner, room), along);
                size[along] = room - sizes.iter().sum::<f32>();
                if let Some(Tile::Container(Container::Linear(linear))) = self.tree.tiles.get_mut(id) {
                    for (other, size) in others.into_iter().zip(sizes) {
                        linear.shares.set_share(other, size);
                    }
                    linear.shares.set_share(inner, size[along]);
                }
            }
            at = Some(inner);
        }
    }

    /// Sizes of the tiles around that of the view, which leave it its least in the room there is, points.
    fn sizes(&self, kept: &Shares, others: &[TileId], (view, room): (TileId, f32), along: usize) -> Vec<f32> {
        let share = |id: TileId| kept.iter().find(|(other, _)| **other == id).map(|(_, share)| *share);
        let taken: f32 = others.iter().filter_map(|id| share(*id)).sum();
        let wanted = others.iter().map(|&id| {
            let least = self.least(id, along);
            share(id).unwrap_or(NEW * (room - taken)).clamp(least, (GREATEST * room).max(least))
        });
        let wanted: Vec<f32> = wanted.collect();
        let most = (room - self.least(view, along)).max(room * (1.0 - GREATEST));
        let fit = (most / wanted.iter().sum::<f32>()).min(1.0);
        wanted.into_iter().map(|size| fit * size).collect()
    }

    /// Least size of a tile along the width (0) or the height (1), points.
    fn least(&self, id: TileId, along: usize) -> f32 {
        match self.tree.tiles.get(id) {
            None => 0.0,
            Some(Tile::Pane(pane)) => pane.least()[along],
            Some(Tile::Container(container)) => {
                let shown = container.children().filter(|c| self.tree.tiles.is_visible_in_layout(**c));
                let least = shown.map(|child| self.least(*child, along));
                match container {
                    Container::Linear(linear) if usize::from(linear.dir == LinearDir::Vertical) == along => least.sum(),
                    _ => least.fold(0.0, f32::max),
                }
            }
        }
    }

    /// The child of a tile that the view is in.
    fn child_with_view(&self, id: TileId) -> Option<TileId> {
        let mut child = self.tile(Pane::View)?;
        // The tree is no deeper than it has tiles.
        for _ in 0..self.tree.tiles.len() {
            let parent = self.tree.tiles.parent_of(child)?;
            if parent == id {
                return Some(child);
            }
            child = parent;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    #[test]
    fn a_layout_survives_its_file_and_one_of_other_panes_is_noticed() {
        let layout = Layout::default();
        assert!(layout.is_sound(), "each pane once");
        let text = serde_json::to_string(&layout).expect("plain values");
        assert_eq!(serde_json::from_str::<Layout>(&text).expect("readable"), layout, "as it was");
        let mut fewer = layout.clone();
        let tile = fewer.tile(Pane::Mesh).expect("it is there");
        fewer.tree.remove_recursively(tile);
        assert!(!fewer.is_sound(), "one is missing");
        let mut twice = layout;
        let tile = twice.tree.tiles.insert_pane(Pane::Cage);
        let root = twice.tree.root().expect("a tree");
        if let Some(Tile::Container(container)) = twice.tree.tiles.get_mut(root) {
            container.add_child(tile);
        }
        assert!(!twice.is_sound(), "one is there twice");
    }

    /// Sizes of the children of the container that some panes lie in, as they were kept last.
    fn shares(layout: &Layout, pane: Pane) -> Vec<f32> {
        let tabs = layout.tile(pane).and_then(|tile| layout.tree.tiles.parent_of(tile)).expect("it has tabs");
        let parent = layout.tree.tiles.parent_of(tabs).expect("beside others");
        let Some(Container::Linear(linear)) = layout.tree.tiles.get_container(parent) else { panic!("a row") };
        linear.children.iter().map(|c| linear.shares[*c]).collect()
    }

    #[test]
    fn the_sides_keep_their_widths_and_the_view_takes_the_rest() {
        let mut layout = Layout::default();
        layout.show(&Pane::BELOW, false);
        for width in [1920.0, 1280.0] {
            layout.keep_sizes(vec2(width, 700.0), 1.0);
            assert_eq!(shares(&layout, Pane::View), [312.0, width - 2.0 - 628.0, 316.0], "{width} points wide");
        }
        layout.show(&Pane::LEFT, false);
        layout.keep_sizes(vec2(1280.0, 700.0), 1.0);
        assert_eq!(shares(&layout, Pane::View)[1..], [1280.0 - 1.0 - 316.0, 316.0], "the left side is folded away");
    }

    #[test]
    fn what_lies_below_keeps_its_height_and_leaves_the_view_some() {
        let mut layout = Layout::default();
        let heights = |layout: &Layout| shares(layout, Pane::Results);
        layout.show(&Pane::BELOW, true);
        layout.keep_sizes(vec2(1280.0, 702.0), 1.0);
        assert_eq!(heights(&layout), [250.0, 320.0, 130.0], "both below");
        for _ in 0..50 {
            layout.keep_sizes(vec2(1280.0, 502.0), 1.0);
        }
        let [view, results, messages] = heights(&layout)[..] else { panic!("three") };
        assert!(
            view >= 159.0 && results >= 199.0 && messages >= 79.0,
            "in a low window: {view}, {results}, {messages}"
        );
        assert!((view + results + messages - 500.0).abs() < 0.1, "all the room: {view}, {results}, {messages}");
    }

    #[test]
    fn what_is_put_below_the_view_gets_a_third() {
        let mut layout = Layout::default();
        layout.show(&Pane::BELOW, false);
        let history = layout.tile(Pane::History).expect("it is there");
        let root = layout.tree.root().expect("a tree");
        layout.tree.move_tile_to_container(history, root, 1, false);
        layout.keep_sizes(vec2(1280.0, 601.0), 1.0);
        assert_eq!(shares(&layout, Pane::History)[..2], [400.0, 200.0], "a third of the height");
        layout.tree.move_tile_to_container(history, root, 0, false);
        layout.keep_sizes(vec2(1280.0, 901.0), 1.0);
        assert_eq!(shares(&layout, Pane::History)[..2], [300.0, 600.0], "put above it: what it leaves counts no more");
    }
}
