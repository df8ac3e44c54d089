//! Colours and sizes of the window, light and dark, in one place.
//!
//! Panels and painters take every colour from [`Tokens`]; none is written elsewhere. Text and its ground keep a
//! contrast of at least 4.5 to 1 in both themes (tested below).

use egui::{Color32, Context, CornerRadius, FontId, Margin, Stroke, TextStyle, Theme, Visuals, vec2};
use std::collections::BTreeMap;

const fn rgb(r: u8, g: u8, b: u8) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// The colours of one theme.
#[derive(Debug)]
pub(super) struct Tokens {
    /// Ground of panels, menus and dialogs.
    pub(super) panel: Color32,
    /// Ground of text fields.
    pub(super) field: Color32,
    /// Buttons at rest, under the pointer and pressed.
    pub(super) button: [Color32; 3],
    /// Lines between things.
    pub(super) line: Color32,
    /// Text, and text of less weight.
    pub(super) text: Color32,
    pub(super) weak: Color32,
    /// Links, selections, the main action.
    pub(super) accent: Color32,
    /// Ground of what is selected.
    pub(super) selected: Color32,
    pub(super) good: Color32,
    pub(super) warning: Color32,
    pub(super) error: Color32,
    /// Colours of the x, y and z axis.
    pub(super) axes: [Color32; 3],
    /// Ground of the viewport, its grid and the lettering on it.
    pub(super) viewport: Color32,
    pub(super) grid: Color32,
    /// Patch, ground, pin: metal. Substrate and sheath: matt.
    pub(super) patch: Color32,
    pub(super) ground: Color32,
    pub(super) pin: Color32,
    pub(super) substrate: Color32,
    pub(super) coax: Color32,
    /// Air and port of a mesh, its edges, and cells that call for attention.
    pub(super) air: Color32,
    pub(super) port: Color32,
    pub(super) mesh_edge: Color32,
    pub(super) signal: Color32,
    /// Outlines of the antenna's parts.
    pub(super) crease: Color32,
    /// The exact cylinder drawn through the antenna.
    pub(super) ideal: Color32,
    /// Lines of the cage.
    pub(super) cage: Color32,
    /// Cage vertices: normal, hovered, selected, locked; and their rim.
    pub(super) handles: [Color32; 4],
    pub(super) handle_rim: Color32,
    /// Curves of a plot.
    pub(super) series: [Color32; N_SERIES],
}

/// Curves that can be told apart by colour.
pub(super) const N_SERIES: usize = 8;

static DARK: Tokens = Tokens {
    panel: rgb(28, 30, 34),
    field: rgb(18, 19, 22),
    button: [rgb(48, 51, 57), rgb(62, 66, 74), rgb(40, 43, 48)],
    line: rgb(58, 61, 68),
    text: rgb(218, 221, 226),
    weak: rgb(154, 160, 170),
    accent: rgb(92, 172, 255),
    selected: rgb(24, 78, 132),
    good: rgb(92, 200, 130),
    warning: rgb(240, 180, 80),
    error: rgb(255, 122, 112),
    axes: [rgb(238, 96, 96), rgb(110, 200, 96), rgb(96, 150, 255)],
    viewport: rgb(37, 40, 45),
    grid: rgb(96, 102, 112),
    patch: rgb(222, 142, 78),
    ground: rgb(190, 120, 68),
    pin: rgb(214, 184, 98),
    substrate: rgb(196, 204, 190),
    coax: rgb(226, 228, 232),
    air: rgb(104, 132, 168),
    port: rgb(120, 200, 110),
    mesh_edge: rgb(18, 22, 30),
    signal: rgb(255, 64, 160),
    crease: rgb(24, 26, 30),
    ideal: rgb(120, 226, 150),
    cage: rgb(120, 178, 240),
    handles: [rgb(206, 224, 246), rgb(255, 226, 120), rgb(255, 158, 44), rgb(120, 124, 130)],
    handle_rim: rgb(20, 26, 34),
    series: [
        rgb(92, 172, 255),
        rgb(255, 158, 64),
        rgb(110, 210, 120),
        rgb(244, 116, 158),
        rgb(190, 150, 255),
        rgb(90, 215, 215),
        rgb(232, 212, 90),
        rgb(196, 202, 210),
    ],
};

static LIGHT: Tokens = Tokens {
    panel: rgb(246, 247, 249),
    field: rgb(255, 255, 255),
    button: [rgb(226, 229, 234), rgb(212, 217, 224), rgb(200, 206, 214)],
    line: rgb(205, 209, 216),
    text: rgb(28, 31, 36),
    weak: rgb(88, 95, 106),
    accent: rgb(0, 92, 184),
    selected: rgb(190, 220, 252),
    good: rgb(14, 112, 52),
    warning: rgb(138, 84, 0),
    error: rgb(184, 28, 28),
    axes: [rgb(200, 30, 30), rgb(24, 120, 24), rgb(30, 80, 210)],
    viewport: rgb(232, 235, 240),
    grid: rgb(128, 136, 148),
    patch: rgb(206, 122, 58),
    ground: rgb(172, 102, 52),
    pin: rgb(196, 162, 70),
    substrate: rgb(214, 220, 206),
    coax: rgb(244, 245, 247),
    air: rgb(178, 204, 234),
    port: rgb(96, 176, 90),
    mesh_edge: rgb(40, 56, 82),
    signal: rgb(214, 0, 120),
    crease: rgb(60, 64, 72),
    ideal: rgb(10, 130, 60),
    cage: rgb(26, 92, 172),
    handles: [rgb(255, 255, 255), rgb(255, 208, 60), rgb(240, 122, 0), rgb(160, 165, 172)],
    handle_rim: rgb(26, 72, 136),
    series: [
        rgb(0, 92, 184),
        rgb(182, 76, 0),
        rgb(20, 122, 50),
        rgb(190, 20, 90),
        rgb(110, 60, 190),
        rgb(0, 116, 128),
        rgb(120, 98, 0),
        rgb(80, 86, 96),
    ],
};

impl Tokens {
    /// The colours of a theme.
    pub(super) fn of(theme: Theme) -> &'static Self {
        match theme {
            Theme::Dark => &DARK,
            Theme::Light => &LIGHT,
        }
    }

    /// The colours of the theme that `ui` is drawn with.
    pub(super) fn here(ui: &egui::Ui) -> &'static Self {
        Self::of(if ui.visuals().dark_mode { Theme::Dark } else { Theme::Light })
    }
}

/// Gives both themes their colours and sizes.
pub(super) fn install(ctx: &Context) {
    for theme in [Theme::Dark, Theme::Light] {
        ctx.style_mut_of(theme, |style| {
            let sizes = [
                (TextStyle::Small, FontId::proportional(11.0)),
                (TextStyle::Body, FontId::proportional(13.0)),
                (TextStyle::Button, FontId::proportional(13.0)),
                (TextStyle::Monospace, FontId::monospace(12.0)),
                (TextStyle::Heading, FontId::proportional(15.0)),
            ];
            style.text_styles = BTreeMap::from(sizes);
            style.drag_value_text_style = TextStyle::Button;
            style.spacing.item_spacing = vec2(8.0, 5.0);
            style.spacing.button_padding = vec2(8.0, 3.0);
            style.spacing.interact_size = vec2(40.0, 22.0);
            style.spacing.slider_width = 88.0;
            style.spacing.combo_width = 110.0;
            style.spacing.tooltip_width = 340.0;
            style.spacing.window_margin = Margin::same(14);
            style.visuals = visuals(theme);
        });
    }
}

fn visuals(theme: Theme) -> Visuals {
    let tokens = Tokens::of(theme);
    let mut visuals = theme.default_visuals();
    visuals.panel_fill = tokens.panel;
    visuals.window_fill = tokens.panel;
    visuals.window_stroke = Stroke::new(1.0, tokens.line);
    visuals.extreme_bg_color = tokens.field;
    visuals.faint_bg_color = tokens.panel.lerp_to_gamma(tokens.text, 0.035);
    visuals.hyperlink_color = tokens.accent;
    visuals.warn_fg_color = tokens.warning;
    visuals.error_fg_color = tokens.error;
    visuals.weak_text_color = Some(tokens.weak);
    visuals.selection.bg_fill = tokens.selected;
    visuals.selection.stroke = Stroke::new(1.0, tokens.text);
    visuals.slider_trailing_fill = true;
    visuals.striped = true;
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, tokens.line);
    visuals.widgets.noninteractive.fg_stroke.color = tokens.text;
    let widgets = &mut visuals.widgets;
    for (widget, fill) in [
        (&mut widgets.inactive, tokens.button[0]),
        (&mut widgets.hovered, tokens.button[1]),
        (&mut widgets.active, tokens.button[2]),
        (&mut widgets.open, tokens.button[1]),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.fg_stroke.color = tokens.text;
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    visuals.widgets.inactive.bg_stroke = Stroke::new(1.0, tokens.line);
    visuals.widgets.hovered.bg_stroke = Stroke::new(1.0, tokens.accent);
    visuals.widgets.active.bg_stroke = Stroke::new(1.5, tokens.accent);
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast ratio of WCAG 2: relative luminances plus 0.05.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |c: Color32| {
            let [r, g, b, _] = egui::Rgba::from(c).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn all_text_is_readable_in_both_themes() {
        for theme in [Theme::Dark, Theme::Light] {
            let t = Tokens::of(theme);
            for ground in [t.panel, t.viewport] {
                for text in [t.text, t.weak, t.good, t.warning, t.error, t.accent] {
                    let ratio = contrast(text, ground);
                    assert!(ratio >= 4.5, "{theme:?}: {text:?} on {ground:?} has {ratio:.2}");
                }
            }
            assert!(contrast(t.text, t.button[1]) >= 4.5, "{theme:?}: button text");
            assert!(contrast(t.text, t.selected) >= 4.5, "{theme:?}: selected text");
            for curve in t.series {
                assert!(contrast(curve, t.field) >= 4.5 && contrast(curve, t.panel) >= 4.5, "{theme:?}: {curve:?}");
            }
        }
    }
}
