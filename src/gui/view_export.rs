//! Saves the 3-D view as a picture: larger than on the screen, on any ground, with its scales of colours.

use super::app::App;
use super::dialogs::Dialog;
use super::field::Choices;
use super::file_field::{FileField, Pressed};
use super::heat::Bar;
use super::outbox::Outbox;
use super::ui_state::UiState;
use crate::io::write_atomic;
use crate::plot::{ColorScale, Overlay};
use crate::render::{Gpu, Picture, Scene, View, colormap, picture};
use egui::{ComboBox, Ui};
use std::path::Path;

/// What is seen: the scene, from where, and the scales beside it.
#[derive(Clone, Debug)]
pub(super) struct Shot {
    pub(super) scene: Scene,
    pub(super) view: View,
    pub(super) bars: Vec<Bar>,
    /// Colour of lettering on the theme's ground.
    pub(super) ink: [u8; 3],
}

/// What is behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ground {
    Theme,
    White,
    Nothing,
}

/// Dark lettering, for white and for nothing.
const DARK_INK: [u8; 3] = [33, 37, 41];

/// How the picture is made.
#[derive(Clone, Copy, Debug)]
struct Choice {
    /// Pixels to a point of the screen.
    scale: u32,
    ground: Ground,
    has_bars: bool,
    has_grid: bool,
}

/// The dialog.
#[derive(Debug)]
pub(super) struct ViewExport {
    shot: Shot,
    choice: Choice,
    file: FileField,
}

impl App {
    /// Asks where to save a picture of the view.
    pub(super) fn ask_picture(&mut self) {
        if let Some(shot) = self.viewport.shot().cloned() {
            let dialog = ViewExport::new(shot, &self.folder(), &self.session.name());
            self.dialog = Dialog::ViewExport(Box::new(dialog));
        }
    }
}

impl ViewExport {
    /// Offers to save a view to a file in `folder` named after the project.
    pub(super) fn new(shot: Shot, folder: &Path, name: &str) -> Self {
        let choice = Choice { scale: 2, ground: Ground::Theme, has_bars: true, has_grid: true };
        Self { shot, choice, file: FileField::new(&folder.join(format!("{name}-view.png"))) }
    }

    /// Whether a thread is at work.
    pub(super) fn is_working(&self) -> bool {
        self.file.is_working()
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Save picture of the view");
        ui.add_space(6.0);
        if let Some(closes) = self.file.working(ui, "Drawing…", state, out) {
            return closes;
        }
        self.choices(ui);
        ui.add_space(6.0);
        match self.file.ui(ui, "Save") {
            Pressed::Nothing => false,
            Pressed::Cancel => true,
            Pressed::Go(path) => {
                let (shot, choice) = (self.shot.clone(), self.choice);
                self.file.write(ui, path, move |path| {
                    let picture = render(&Gpu::headless()?, shot, choice)?;
                    write_atomic(path, &picture.png()?)?;
                    Ok(vec![
                        format!("Saved a picture of {} x {} pixels:", picture.width, picture.height),
                        path.display().to_string(),
                    ])
                });
                false
            }
        }
    }

    fn choices(&mut self, ui: &mut Ui) {
        let size = |scale: u32| {
            let size = (self.shot.view.size * scale as f32).round();
            format!("{scale}x: {} x {} pixels", size.x, size.y)
        };
        let label = ui.label("Size");
        let combo = ComboBox::from_id_salt("picture size").width(200.0).selected_text(size(self.choice.scale));
        let combo = combo.show_list(ui, |ui| {
            for scale in [1, 2, 4] {
                ui.selectable_value(&mut self.choice.scale, scale, size(scale));
            }
        });
        combo.response.labelled_by(label.id).on_hover_text("As large as the view on the screen, or larger");
        ui.add_space(6.0);
        ui.label("Background");
        for (ground, text, tip) in [
            (Ground::Theme, "As on the screen", "The ground of the theme"),
            (Ground::White, "White", "For print"),
            (Ground::Nothing, "Transparent", "To be laid over something else"),
        ] {
            ui.radio_value(&mut self.choice.ground, ground, text).on_hover_text(tip);
        }
        ui.add_space(6.0);
        let has_any = !self.shot.bars.is_empty();
        ui.add_enabled(has_any, egui::Checkbox::new(&mut self.choice.has_bars, "Colour bar"))
            .on_hover_text("The scale of what is painted")
            .on_disabled_hover_text("Nothing is painted");
        ui.checkbox(&mut self.choice.has_grid, "Grid").on_hover_text("The grid below the antenna");
    }
}

/// Draws the picture as chosen.
fn render(gpu: &Gpu, mut shot: Shot, choice: Choice) -> anyhow::Result<Picture> {
    let theme = shot.scene.background;
    shot.scene.background = match choice.ground {
        Ground::Theme => theme,
        Ground::White => [255; 4],
        Ground::Nothing => [0; 4],
    };
    if !choice.has_grid {
        shot.scene.grid = None;
    }
    shot.view.scale = choice.scale as f32;
    let mut picture = picture(gpu, &shot.scene, &shot.view)?;
    let ink = if choice.ground == Ground::Theme { shot.ink } else { DARK_INK };
    let mut right = picture.width;
    for bar in shot.bars.iter().filter(|_| choice.has_bars) {
        let steps = 64_u8;
        let colors = (0..steps).map(|k| colormap::color(bar.map, 1.0 - f32::from(k) / f32::from(steps - 1)));
        let scale = ColorScale { title: bar.title.clone(), ticks: bar.ticks.to_vec(), colors: colors.collect(), ink };
        let overlay = scale.overlay(choice.scale)?;
        right = right.saturating_sub(overlay.width);
        lay_over(&mut picture, &overlay, right);
    }
    Ok(picture)
}

/// Lays a picture over another one, `left` pixels from its left and at its top.
fn lay_over(picture: &mut Picture, overlay: &Overlay, left: u32) {
    for y in 0..overlay.height.min(picture.height) {
        for x in 0..overlay.width.min(picture.width.saturating_sub(left)) {
            let over = overlay.pixels[(y * overlay.width + x) as usize];
            let under = &mut picture.pixels[y as usize * picture.width as usize + (left + x) as usize];
            let [a, b] = [over[3], under[3]].map(|a| f32::from(a) / 255.0);
            let alpha = a + b * (1.0 - a);
            for c in 0..3 {
                let sum = f32::from(over[c]) * a + f32::from(under[c]) * b * (1.0 - a);
                under[c] = (sum / alpha.max(1e-6)).round() as u8;
            }
            under[3] = (alpha * 255.0).round() as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::tests::has_adapter;
    use crate::render::{Camera, ColorMap};

    #[test]
    fn the_picture_has_the_size_the_ground_and_the_bar_that_were_chosen() {
        if !has_adapter() {
            return;
        }
        let gpu = Gpu::headless().expect("it was there");
        let bar = Bar {
            map: ColorMap::Viridis,
            title: "Area".to_owned(),
            ticks: ["4", "3", "2", "1", "0"].map(str::to_owned),
        };
        let scene = Scene { background: [10, 20, 30, 255], ..Scene::default() };
        let shot = Shot { scene, view: View::new(Camera::default(), 400.0, 320.0), bars: vec![bar], ink: [250; 3] };
        let grounds = [(Ground::Theme, [10, 20, 30, 255]), (Ground::White, [255; 4]), (Ground::Nothing, [0; 4])];
        for (k, (ground, expected)) in (1_u32..).zip(grounds) {
            let choice = Choice { scale: k.next_power_of_two(), ground, has_bars: true, has_grid: true };
            let picture = render(&gpu, shot.clone(), choice).expect("drawn");
            assert_eq!((picture.width, picture.height), (400 * choice.scale, 320 * choice.scale), "{ground:?}");
            assert_eq!(picture.at(5, 5), expected, "{ground:?}");
            let yellow = colormap::color(ColorMap::Viridis, 1.0);
            let bright = picture.pixels.iter().filter(|p| p[..3] == yellow && p[3] == 255).count();
            assert!(bright > 20, "{ground:?}: the bright end of the bar, {bright}");
            let bare = render(&gpu, shot.clone(), Choice { has_bars: false, ..choice }).expect("drawn");
            assert!(bare.pixels.iter().all(|p| *p == expected), "{ground:?}: without the bar");
        }
    }
}
