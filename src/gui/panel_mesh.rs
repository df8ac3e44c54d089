//! The tetrahedral mesh: what is meshed, how it is looked at, and how good it is.

use super::command::{Command, Facts};
use super::field::{Choices, rows};
use super::mesh_session::{MeshSession, ShownMesh, density_text, grouped, has_cylinder, metal_text, shape_text};
use super::outbox::{Action, Outbox};
use super::panel_distortion::ROW_HEIGHT;
use super::places;
use super::plot_export;
use super::plots::PlotKind;
use super::theme::Tokens;
use super::ui_state::{MeshPaint, MeshUi, UiState};
use crate::pipeline::{Density, Shape};
use crate::project::Project;
use crate::tet::{BIN_WIDTH, CellStatistics, Metal, WorstCell};
use crate::units::to_mm;
use egui::{ComboBox, Grid, ProgressBar, RichText, Slider, Spinner, Ui};
use egui_plot::{AxisHints, Bar, BarChart, Plot};

/// Height of the histogram, points.
const PLOT_HEIGHT: f32 = 130.0;
/// Labels of the axes fade in between these distances, points.
const LABEL_SPACING: egui::Rangef = egui::Rangef { min: 10.0, max: 14.0 };
/// Distance of the eye over the longest edge of the cell that it is shown: some rings of neighbors are seen, too.
const EYE_DISTANCE: f64 = 18.0;

/// Draws the panel.
pub(super) fn ui(
    ui: &mut Ui,
    project: &Project,
    mesh: &MeshSession,
    facts: &Facts,
    state: &mut UiState,
    out: &mut Outbox,
) {
    choices(ui, project, &mut state.mesh);
    ui.add_space(4.0);
    if mesh.is_busy() {
        busy(ui, mesh, out);
    } else {
        ui.horizontal(|ui| {
            for command in [Command::Mesh, Command::ExportMesh] {
                if command.tool_button(ui, facts) {
                    out.push(Action::Run(command));
                }
            }
        });
    }
    let tokens = Tokens::here(ui);
    if let Some(error) = mesh.error() {
        let text = RichText::new(format!("No mesh was made: {}", error.text)).color(tokens.error);
        ui.add(egui::Label::new(text).wrap());
        places::list(ui, error.places_mm(project), state);
    }
    let Some(shown) = mesh.shown() else {
        if !mesh.is_busy() && mesh.error().is_none() {
            let text = "There is no mesh yet. Press Mesh: the antenna and the air around it are filled with \
                        tetrahedra, ready for a field solver. It takes a few seconds, and you can go on meanwhile.";
            ui.label(RichText::new(text).weak());
        }
        return;
    };
    if shown.is_stale(project) {
        let text = RichText::new("⚠ The geometry has changed since: this mesh is out of date.").color(tokens.warning);
        ui.add(egui::Label::new(text).wrap());
        if !mesh.is_busy() && ui.button("Mesh again").on_hover_text("Mesh the geometry as it is now").clicked() {
            out.push(Action::Run(Command::Mesh));
        }
    }
    heading(ui, "View");
    look(ui, shown, facts, state, out);
    heading(ui, "Result");
    results(ui, shown);
    heading(ui, "Cells by their smallest dihedral angle");
    histogram(ui, &shown.ready.meshed.quality.whole, out);
    heading(ui, "Worst cells");
    worst(ui, shown, state);
}

pub(super) fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.separator();
    ui.label(RichText::new(text).strong());
}

/// One of several values, each with its name and tooltip.
pub(super) fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    (name, tip): (&'static str, &'static str),
    value: &mut T,
    all: &[T],
    text: fn(T) -> (&'static str, &'static str),
    possible: impl Fn(T) -> Result<(), &'static str>,
) {
    let label = ui.label(name).on_hover_text(tip);
    let combo = ComboBox::from_id_salt(name).width(130.0).selected_text(text(*value).0).show_list(ui, |ui| {
        for &one in all {
            let (text, tip) = text(one);
            let button = egui::Button::selectable(*value == one, text);
            let why_not = possible(one).err();
            let response = ui.add_enabled(why_not.is_none(), button).on_hover_text(tip);
            if response.on_disabled_hover_text(why_not.unwrap_or_default()).clicked() {
                *value = one;
            }
        }
    });
    combo.response.labelled_by(label.id).on_hover_text(tip);
    ui.end_row();
}

/// Two rows: which of the antenna's shapes, and how finely it is meshed.
pub(super) fn shape_and_density(ui: &mut Ui, project: &Project, shape: &mut Shape, density: &mut Density) {
    let tip = "Which of the antenna's shapes is meant";
    let shapes = [Shape::Deformed, Shape::Flat, Shape::Cylinder];
    let why_not = "Only a single bend without hand edits lies on an exact cylinder";
    let possible = |s| if s != Shape::Cylinder || has_cylinder(project) { Ok(()) } else { Err(why_not) };
    choice(ui, ("Shape", tip), shape, &shapes, shape_text, possible);
    let densities = [Density::Coarse, Density::Default, Density::Fine];
    choice(ui, ("Density", "How fine the mesh is"), density, &densities, density_text, |_| Ok(()));
}

fn choices(ui: &mut Ui, project: &Project, chosen: &mut MeshUi) {
    rows(ui, "mesh choices", |ui| {
        shape_and_density(ui, project, &mut chosen.shape, &mut chosen.density);
        let tip = "How patch and ground are modelled";
        choice(ui, ("Metal", tip), &mut chosen.metal, &[Metal::Sheet, Metal::Solid], metal_text, |_| Ok(()));
    });
}

fn busy(ui: &mut Ui, mesh: &MeshSession, out: &mut Outbox) {
    let progress = mesh.progress();
    ui.horizontal(|ui| {
        match progress.filter(|p| p.total > 0) {
            Some(p) => {
                let part = p.done as f32 / p.total as f32;
                ui.add(ProgressBar::new(part).desired_width(190.0).desired_height(14.0));
            }
            None => {
                ui.add(Spinner::new().size(16.0));
            }
        }
        if ui.button("Cancel").on_hover_text("Stop meshing; what is shown stays").clicked() {
            out.push(Action::CancelMesh);
        }
    });
    let phase = progress.map_or("beginning", |p| p.phase);
    ui.label(RichText::new(format!("Meshing: {phase}…")).weak());
}

fn look(ui: &mut Ui, shown: &ShownMesh, facts: &Facts, state: &mut UiState, out: &mut Outbox) {
    ui.horizontal(|ui| {
        if Command::ShowMesh.tool_button(ui, facts) {
            out.push(Action::Run(Command::ShowMesh));
        }
        ui.checkbox(&mut state.mesh.marks_worst, "Mark worst cells")
            .on_hover_text("The cells of the list below, seen through all others");
    });
    let view = &mut state.mesh;
    ui.add_enabled_ui(view.shows, |ui| {
        rows(ui, "mesh view", |ui| {
            ui.label("Cut across").on_hover_text("Cells on one side of a plane are left out, whole");
            ui.horizontal(|ui| {
                for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                    let tip = format!("A plane of constant {name}");
                    if ui.selectable_value(&mut view.axis, axis, name).on_hover_text(tip).clicked() {
                        view.keep_within(&shown.bounds_mm);
                    }
                }
                ui.checkbox(&mut view.flipped, "Flip").on_hover_text("Keep the other side");
            });
            ui.end_row();
            let label = ui.label("Place").on_hover_text("Where the plane is");
            let [lo, hi] = shown.bounds_mm[view.axis];
            let slider = Slider::new(&mut view.place_mm, lo..=hi).suffix(" mm").max_decimals(2).smart_aim(true);
            ui.add(slider.clamping(egui::SliderClamping::Never)).labelled_by(label.id);
            ui.end_row();
            ui.label("Show").on_hover_text("What is left of the cells");
            ui.horizontal(|ui| {
                ui.checkbox(&mut view.shows_air, "Air").on_hover_text("The air around the antenna");
                let tip = "Cut the antenna, too; else the air alone is cut";
                ui.checkbox(&mut view.cuts_antenna, "Cut antenna").on_hover_text(tip);
            });
            ui.end_row();
            ui.label("Colours").on_hover_text("What the colours of the cells show");
            ui.horizontal(|ui| {
                let tip = "What the cells are made of";
                ui.selectable_value(&mut view.paint, MeshPaint::Region, "Material").on_hover_text(tip);
                let tip = "Smallest dihedral angle of each cell";
                ui.selectable_value(&mut view.paint, MeshPaint::Angle, "Quality").on_hover_text(tip);
            });
            ui.end_row();
        });
    });
}

fn results(ui: &mut Ui, shown: &ShownMesh) {
    let (request, meshed) = (&shown.request, &shown.ready.meshed);
    let made_of = format!(
        "{}, {}, {}",
        shape_text(request.shape).0,
        density_text(request.settings.density).0.to_lowercase(),
        metal_text(request.settings.metal).0.to_lowercase()
    );
    ui.label(RichText::new(made_of).color(Tokens::here(ui).weak).small()).on_hover_text("What was meshed, and how");
    let all = &meshed.quality.whole;
    let recovery = &meshed.recovery;
    let recovered = format!(
        "The air's first mesh lacked {} edges and {} facets of the antenna's skin; {} helper points were added and {} \
         edges halved to bring them back",
        recovery.n_missing_edges,
        recovery.n_missing_facets,
        recovery.n_helpers,
        recovery.splits.len()
    );
    let degrees = |angle: f64| format!("{:.2}°", angle.to_degrees());
    let millimetres = |length: f64| format!("{:.4} mm", to_mm(length));
    let lines = [
        ("Cells", grouped(meshed.mesh.tets.len()), "Tetrahedra in antenna and air"),
        ("Vertices", grouped(meshed.mesh.vertices.len()), "Corners of the tetrahedra"),
        ("Time", format!("{:.1} s", meshed.seconds), "Time that meshing took"),
        ("Smallest angle", degrees(all.dihedral_min), "Smallest dihedral angle of all cells"),
        ("  1 % below", degrees(all.dihedral_p1), "One cell in a hundred has a smaller dihedral angle"),
        ("Smallest inradius", millimetres(all.inradius_min), "Of the spheres inside the cells: rules the time step"),
        ("Off smooth map", millimetres(meshed.map_distance), "Greatest distance of an edge's middle from the map"),
        ("Skin recovery", format!("{} edges", recovery.n_missing_edges), recovered.as_str()),
    ];
    Grid::new("mesh figures").num_columns(2).striped(true).spacing([10.0, 3.0]).min_row_height(ROW_HEIGHT).show(
        ui,
        |ui| {
            for (name, value, tip) in lines {
                ui.label(name).on_hover_text(tip);
                ui.label(value).on_hover_text(tip);
                ui.end_row();
            }
        },
    );
}

fn histogram(ui: &mut Ui, cells: &CellStatistics, out: &mut Outbox) {
    let width = BIN_WIDTH.to_degrees();
    let accent = Tokens::here(ui).accent;
    let bar = |(k, &count): (usize, &usize)| {
        Bar::new((k as f64 + 0.5) * width, count as f64).width(0.88 * width).fill(accent)
    };
    let bars: Vec<Bar> = cells.histogram.iter().enumerate().map(bar).collect();
    let angles = AxisHints::new_x().label("Angle (°)").formatter(|mark, _| format!("{:.0}", mark.value));
    let counts = AxisHints::new_y().label("Cells").formatter(|mark, _| grouped(mark.value.max(0.0) as usize));
    let every_15 = |k: u8| egui_plot::GridMark { value: 15.0 * f64::from(k), step_size: 15.0 };
    let plot = Plot::new("angles")
        .height(PLOT_HEIGHT)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .include_x(0.0)
        .include_x(width * cells.histogram.len() as f64)
        .include_y(0.0)
        .x_grid_spacer(move |_| (0..=5).map(every_15).collect())
        .custom_x_axes(vec![angles.label_spacing(LABEL_SPACING)])
        .custom_y_axes(vec![counts.label_spacing(LABEL_SPACING)])
        .show_x(false)
        .show_y(false)
        .show(ui, |plot| plot.bar_chart(BarChart::new("cells", bars).color(accent)));
    let name = "Cells by their smallest dihedral angle";
    plot.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    plot_export::menu(&plot.response, PlotKind::MeshAngles, out);
    let Some(pointer) = plot.response.hover_pos() else { return };
    let bin = (plot.transform.value_from_position(pointer).x / width).max(0.0) as usize;
    if let Some(&count) = cells.histogram.get(bin) {
        let [from, to] = [bin, bin + 1].map(|k| k as f64 * width);
        plot.response.on_hover_text_at_pointer(format!("{from:.0}° to {to:.0}°: {} cells", grouped(count)));
    }
}

fn worst(ui: &mut Ui, shown: &ShownMesh, state: &mut UiState) {
    let weak = Tokens::here(ui).weak;
    let cells = &shown.ready.meshed.quality.worst;
    ui.spacing_mut().button_padding = egui::vec2(4.0, 1.0);
    ui.spacing_mut().interact_size.y = ROW_HEIGHT;
    Grid::new("worst cells").num_columns(3).striped(true).spacing([10.0, 2.0]).min_row_height(ROW_HEIGHT).show(
        ui,
        |ui| {
            ui.label(RichText::new(" Center (mm)").color(weak)).on_hover_text("x, y and z; press one to look at it");
            ui.label(RichText::new("Inradius (mm)").color(weak)).on_hover_text("Radius of the inscribed sphere");
            ui.label(RichText::new("Angles (°)").color(weak)).on_hover_text("Smallest and largest dihedral angle");
            ui.end_row();
            for (index, cell) in cells.iter().enumerate() {
                let [x, y, z] = cell.at.to_array().map(to_mm);
                let is_chosen = state.mesh.chosen == Some(index) && state.mesh.shows;
                let place = ui.selectable_label(is_chosen, format!("{x:.2}, {y:.2}, {z:.2}"));
                let name = format!("Worst cell {}", index + 1);
                place.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, &name));
                let region = &shown.ready.meshed.mesh.regions[cell.region.index()].name;
                if place.on_hover_text(format!("{name}, in the {region}: look at it, cut open there")).clicked() {
                    show_cell(shown, index, cell, state);
                }
                ui.label(format!("{:.4}", to_mm(cell.quality.inradius)));
                let [least, most] = [cell.quality.dihedral_min, cell.quality.dihedral_max].map(f64::to_degrees);
                ui.label(format!("{least:.1} to {most:.1}"));
                ui.end_row();
            }
        },
    );
}

/// Brings a cell before the eye: the mesh is cut where it begins, on the side that the eye is on.
fn show_cell(shown: &ShownMesh, index: usize, cell: &WorstCell, state: &mut UiState) {
    state.show_mesh(true);
    let region = &shown.ready.meshed.mesh.regions[cell.region.index()];
    let view = &mut state.mesh;
    view.chosen = Some(index);
    view.marks_worst = true;
    if region.role == crate::geometry::RegionRole::Air {
        view.shows_air = true;
    } else {
        view.cuts_antenna = true;
    }
    view.flipped = state.camera.axes()[2][view.axis] > 0.0;
    // Rounded to a micrometre so that the slider reads well, and away from the cell, which stays.
    let place = to_mm(cell.at[view.axis]) * 1e3;
    view.place_mm = if view.flipped { place.ceil() } else { place.floor() } / 1e3;
    state.look_at((cell.at * to_mm(1.0)).as_vec3(), (EYE_DISTANCE * to_mm(cell.quality.edge_max)) as f32);
}
