//! Which panes there are and where: a tree of tiles that the user drags, splits and resizes, kept between runs.
//!
//! Sizes of a container's children are its shares, in points wherever the 3-D view is within: there the others keep
//! theirs when the window changes, and the view takes what is left.

use super::ui_state::{RightTab, Tab};
use egui::{Id, Rect, Vec2};
use egui_tiles::{Container, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

/// Widths of the sides at first, points: all inputs fit, and 1280 points leave the view the larger half.
const WIDTHS: [f32; 2] = [312.0, 316.0];
/// Least width and height of what lies beside or below the view, points, and the greatest part of the room.
const LEAST: [f32; 2] = [260.0, 160.0];
const GREATEST: f32 = 0.6;

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
}

impl Pane {
    /// The panes that are left of the view at first, and right of it.
    pub(super) const LEFT: [Self; 3] = [Self::Cage, Self::Antenna, Self::History];
    pub(super) const RIGHT: [Self; 3] = [Self::Figures, Self::Mesh, Self::Solve];

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
    /// Tabs on both sides of the view.
    fn default() -> Self {
        let mut tiles = Tiles::default();
        let [left, view, right] = [&Pane::LEFT[..], &[Pane::View], &Pane::RIGHT].map(|panes| {
            let children = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
            tiles.insert_tab_tile(children)
        });
        let root = tiles.insert_horizontal_tile(vec![left, view, right]);
        if let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(root) {
            linear.shares.set_share(left, WIDTHS[0]);
            linear.shares.set_share(right, WIDTHS[1]);
        }
        Self { tree: Tree::new(Id::unique("panes"), root, tiles) }
    }
}

impl Layout {
    /// Whether each pane is there once: what another version kept may be of other panes.
    pub(super) fn is_sound(&self) -> bool {
        let mut found = Vec::new();
        let mut open: Vec<TileId> = self.tree.root().into_iter().collect();
        let mut left = self.tree.tiles.len();
        while let Some(id) = open.pop() {
            if left == 0 {
                return false;
            }
            left -= 1;
            match self.tree.tiles.get(id) {
                Some(Tile::Pane(pane)) => found.push(*pane),
                Some(Tile::Container(container)) => open.extend(container.children()),
                None => return false,
            }
        }
        let all = Pane::LEFT.into_iter().chain(Pane::RIGHT).chain([Pane::View]);
        let each_once = all.clone().all(|pane| found.iter().filter(|p| **p == pane).count() == 1);
        each_once && found.len() == all.count()
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

    /// Where the panes in front are with their tabs, from left to right.
    pub(super) fn areas(&self) -> Vec<Rect> {
        let in_front = self.tree.active_tiles().into_iter().filter(|id| self.tree.tiles.get_pane(id).is_some());
        let with_tabs = in_front.map(|id| self.tree.tiles.parent_of(id).unwrap_or(id));
        let mut areas: Vec<Rect> = with_tabs.filter_map(|id| self.tree.tiles.rect(id)).collect();
        areas.sort_by(|a, b| a.left().total_cmp(&b.left()).then(a.top().total_cmp(&b.top())));
        areas
    }

    /// Gives whatever lies around the view the size it had, and the view the rest of `size`; `gap` is between tiles.
    pub(super) fn keep_sizes(&mut self, mut size: Vec2, gap: f32) {
        let mut at = self.tree.root();
        while let Some(id) = at {
            let Some(inner) = self.child_with_view(id) else { return };
            let shown: Vec<TileId> = match self.tree.tiles.get_container(id) {
                Some(container) => {
                    container.children().copied().filter(|c| self.tree.tiles.is_visible_in_layout(*c)).collect()
                }
                None => return,
            };
            if let Some(Tile::Container(Container::Linear(linear))) = self.tree.tiles.get_mut(id) {
                let along = usize::from(linear.dir == LinearDir::Vertical);
                let room = size[along] - gap * (shown.len().saturating_sub(1)) as f32;
                let mut rest = room;
                for &other in shown.iter().filter(|c| **c != inner) {
                    let share = linear.shares[other].clamp(LEAST[along], (GREATEST * room).max(LEAST[along]));
                    linear.shares.set_share(other, share);
                    rest -= share;
                }
                linear.shares.set_share(inner, rest.max(LEAST[along].min(room)));
            }
            size = self.tree.tiles.rect(inner).map_or(size, |rect| rect.size());
            at = Some(inner);
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

    #[test]
    fn the_sides_keep_their_widths_and_the_view_takes_the_rest() {
        let mut layout = Layout::default();
        let shares = |layout: &Layout| {
            let root = layout.tree.root().expect("a tree");
            let Some(Container::Linear(linear)) = layout.tree.tiles.get_container(root) else { panic!("a row") };
            linear.children.iter().map(|c| linear.shares[*c]).collect::<Vec<f32>>()
        };
        for width in [1920.0, 1280.0] {
            layout.keep_sizes(vec2(width, 700.0), 1.0);
            assert_eq!(shares(&layout), [312.0, width - 2.0 - 628.0, 316.0], "{width} points wide");
        }
        layout.show(&Pane::LEFT, false);
        layout.keep_sizes(vec2(1280.0, 700.0), 1.0);
        assert_eq!(shares(&layout)[1..], [1280.0 - 1.0 - 316.0, 316.0], "the left side is folded away");
    }
}
