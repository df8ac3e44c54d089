//! The 3-D view: camera, picking and dragging cage vertices.
//!
//! What a drag does is decided where the button went down. A vertex or a part of the gizmo moves, turns or scales the
//! selection ([`super::operating`]), one undo step per drag, live; empty ground turns the view (left), slides it (middle, right or
//! Shift) or draws an outline around vertices (Ctrl a lasso; after a command a box or a lasso). Operators that a command
//! began are driven by the pointer until a click. Places are points from the top left of the view.

use super::bodies_feed;
use super::compare_session::mode_text;
use super::draft::Draft;
use super::edit_overlay;
use super::edit_ui::Outline;
use super::heat::{Bar, Heated, OnShow, ticks};
use super::mark_overlay;
use super::mesh_scene::MeshScene;
use super::mesh_session::ShownMesh;
use super::operating::{Operating, Outcome};
use super::outbox::{Action, Outbox};
use super::overlay;
use super::paint::ScenePaint;
use super::pattern_scene::{self, PatternScene};
use super::play::Play;
use super::scene::{Hot, SceneBuilder, Subject, gizmo, to_picture};
use super::selecting::Drawn;
use super::session::{Pose, Session};
use super::solve_session::SolveSession;
use super::theme::Tokens;
use super::ui_state::{MeshPaint, UiState};
use super::view_export::Shot;
use crate::geometry::DVec3;
use crate::project::CompensationMode;
use crate::render::pick::{gizmo_at, handle_at};
use crate::render::{Gizmo, GizmoPart, Operator, Scene, Vec2, Vec3, View};
use egui::{Area, CursorIcon, EventFilter, Id, Key, Modifiers, Order, PointerButton, Pos2, Rect, Response, Role};
use egui::{Sense, Ui, WidgetInfo};

/// How far from a vertex a press still grabs it, points: a little more than its disc.
const GRAB_RADIUS: f32 = 9.0;
/// Room around what is fitted, as a factor: vertices at the very border are hard to grab.
const FIT_ROOM: f32 = 1.12;
/// Zoom per point scrolled: a usual wheel click (50 points) changes the size by a tenth.
const ZOOM_PER_POINT: f32 = 0.002;

/// What the pointer is doing.
#[derive(Debug, Default)]
enum Drag {
    #[default]
    Nothing,
    Orbit,
    Pan,
    Outline(Drawn),
    Operate(Box<Operating>),
    /// Called off or applied; waits for the button to come up.
    Over,
}

/// What the view remembers between frames.
#[derive(Debug, Default)]
pub(super) struct Viewport {
    drag: Drag,
    /// The operator to begin with.
    wanted: Option<Operator>,
    hot: Hot,
    builder: SceneBuilder,
    mesh: MeshScene,
    pattern: PatternScene,
    /// What was drawn last.
    shot: Option<Shot>,
}

/// What there is to be seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sources<'a> {
    pub(super) session: &'a Session,
    /// The cage.
    pub(super) pose: Option<&'a Pose>,
    /// The mesh, which is shown instead of antenna and cage.
    pub(super) mesh: Option<&'a ShownMesh>,
    /// The runs whose pattern is drawn around the antenna.
    pub(super) solve: Option<&'a SolveSession>,
    /// The computed antenna, and whether it is another one than the project's, which is only looked at.
    pub(super) on_show: Option<OnShow<'a>>,
    pub(super) preview: Option<CompensationMode>,
    /// Places to be marked, mm.
    pub(super) places_mm: &'a [[f64; 3]],
    /// Bodies that are looked at before they are imported.
    pub(super) draft: Option<&'a Draft>,
}

/// What a frame of the view works with.
struct Frame<'a> {
    session: &'a Session,
    pose: Option<&'a Pose>,
    mesh: Option<&'a ShownMesh>,
    solve: Option<&'a SolveSession>,
    on_show: Option<OnShow<'a>>,
    preview: Option<CompensationMode>,
    places_mm: &'a [[f64; 3]],
    draft: Option<&'a Draft>,
    /// Handles in picture units.
    handles: &'a [Vec3],
    gizmo: Option<Gizmo>,
    rect: Rect,
}

impl Frame<'_> {
    /// The part of the gizmo under a place, with the gizmo's center; a vertex there comes before a ring.
    fn gizmo_at(&self, view: &View, at: Vec2) -> Option<(Vec3, GizmoPart)> {
        let gizmo = self.gizmo.as_ref()?;
        let part = gizmo_at(view, gizmo, at)?;
        let is_hidden = matches!(part, GizmoPart::Ring(_)) && handle_at(view, self.handles, at, GRAB_RADIUS).is_some();
        (!is_hidden).then_some((gizmo.center, part))
    }

    fn subject(&self) -> Subject<'_> {
        let drawn = Some(self.session.project()).filter(|_| self.draft.is_none());
        Subject { on_show: self.on_show, drawn, pose: self.pose, is_fixed: self.preview.is_some() }
    }

    /// Begins an operator on the selection; the side of the vertex `lead` leads where edits are mirrored.
    fn operate(
        &self,
        operator: Operator,
        lead: Option<u32>,
        at: Vec2,
        state: &UiState,
        out: &mut Outbox,
    ) -> Option<Operating> {
        if state.play.is_on() {
            // Vertices are moved from where they really are.
            out.push(Action::Show(Play::default()));
            return None;
        }
        let pose = self.pose.filter(|_| state.shows_cage)?;
        let mirror = lead.map_or(state.editing.mirror(), |v| state.editing.mirror().led_by(&pose.cage, v));
        Operating::begin(operator, (pose, self.session.project()), &state.selection, mirror, at, out)
    }

    fn local(&self, at: Pos2) -> Vec2 {
        let v = at - self.rect.min;
        Vec2::new(v.x, v.y)
    }

    fn view(&self, ui: &Ui, state: &UiState) -> View {
        let size = Vec2::new(self.rect.width(), self.rect.height());
        View { camera: state.camera, size, scale: ui.ctx().pixels_per_point() }
    }
}

impl Viewport {
    /// Draws the view and turns what the pointer does into wishes.
    pub(super) fn ui(&mut self, ui: &mut Ui, sources: Sources<'_>, state: &mut UiState, out: &mut Outbox) {
        let Sources { session, mesh, on_show, preview, places_mm, draft, .. } = sources;
        let solve = sources.solve.filter(|_| mesh.is_none());
        // The cage is neither seen nor grabbed while the mesh is shown.
        let pose = sources.pose.filter(|_| mesh.is_none());
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "3-D view"));
        let handles = match pose.filter(|_| state.shows_cage && preview.is_none()) {
            Some(pose) => to_picture(&pose.vertices[..pose.cage.n_handles().min(pose.vertices.len())]),
            None => Vec::new(),
        };
        state.selection.retain(|&v| pose.is_none_or(|p| (v as usize) < p.cage.n_handles()));
        let gizmo = gizmo(&handles, state, Tokens::here(ui), self.hot);
        let frame =
            Frame { session, pose, mesh, solve, on_show, preview, places_mm, draft, handles: &handles, gizmo, rect };
        if std::mem::take(&mut state.fit) {
            self.fit(ui, &frame, state);
        }
        if matches!(self.drag, Drag::Operate(_)) && !session.in_gesture() {
            // Something else ended it: what it began from is gone.
            self.drag = Drag::Over;
        }
        self.hover(ui, &response, &frame, state);
        self.start_wanted(ui, &response, &frame, state, out);
        self.start(ui, &response, &frame, state, out);
        self.go_on(ui, &response, &frame, state, out);
        self.click(ui, &response, &frame, state, out);
        self.zoom(ui, &response, &frame, state);
        let scene = self.draw(ui, &frame, state);
        if session.project().bodies.is_none() || mesh.is_some() {
            state.feed.picks = None;
        }
        bodies_feed::hint(ui, rect, &mut state.feed);
        self.overlay(ui, &response, &frame, state, &scene);
    }

    /// Begins an operator on the selection with the next frame.
    pub(super) fn begin(&mut self, operator: Operator) {
        self.wanted = Some(operator);
    }

    /// Whether the pointer is over a part of the gizmo, or drags it.
    #[cfg(test)]
    pub(super) fn is_hot(&self, part: GizmoPart) -> bool {
        self.hot.gizmo == Some(part)
    }

    /// True while the pointer holds something or an operator runs: keys belong to that.
    pub(super) fn is_dragging(&self) -> bool {
        !matches!(self.drag, Drag::Nothing)
    }

    fn fit(&mut self, ui: &Ui, frame: &Frame<'_>, state: &mut UiState) {
        let (lo, hi) = match frame.mesh {
            Some(mesh) => self.mesh.bounds(mesh, &state.mesh),
            None => {
                let scene = self.scene(ui, frame, state);
                let surfaces = scene.surfaces.iter().flat_map(|s| s.positions.iter());
                let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
                surfaces.chain(frame.handles).fold(start, |(lo, hi), &p| (lo.min(p), hi.max(p)))
            }
        };
        let mut view = frame.view(ui, state);
        view.fit(lo, hi);
        view.camera.distance *= FIT_ROOM;
        state.camera = view.camera;
    }

    fn scene(&mut self, ui: &Ui, frame: &Frame<'_>, state: &UiState) -> Scene {
        let tokens = Tokens::here(ui);
        match frame.mesh {
            Some(mesh) => self.mesh.scene(mesh, &state.mesh, tokens),
            None => {
                let mut scene = self.builder.scene(frame.subject(), state, tokens, self.hot);
                let antenna = scene.surfaces.iter().flat_map(|s| s.positions.iter());
                let [lo, hi] =
                    antenna.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[lo, hi], &p| [lo.min(p), hi.max(p)]);
                let pattern = frame.solve.filter(|_| lo.is_finite());
                let pattern = pattern.and_then(|solve| self.pattern.surface(solve, &state.solve, [lo, hi]));
                scene.surfaces.extend(pattern);
                scene
            }
        }
    }

    fn hover(&mut self, ui: &Ui, response: &Response, frame: &Frame<'_>, state: &UiState) {
        if self.is_dragging() {
            return;
        }
        self.hot = Hot::default();
        let Some(at) = response.hover_pos().filter(|_| response.contains_pointer()) else { return };
        let (view, at) = (frame.view(ui, state), frame.local(at));
        self.hot.gizmo = frame.gizmo_at(&view, at).map(|(_, part)| part);
        if self.hot.gizmo.is_none() {
            self.hot.vertex = handle_at(&view, frame.handles, at, GRAB_RADIUS).and_then(|v| u32::try_from(v).ok());
        }
        if self.hot.gizmo.is_some() || self.hot.vertex.is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
        } else if state.editing.outline.is_some() || state.feed.picks.is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        }
    }

    /// Decides what a drag does, by what lies where the button went down.
    fn start(&mut self, ui: &Ui, response: &Response, frame: &Frame<'_>, state: &mut UiState, out: &mut Outbox) {
        if !response.drag_started() {
            return;
        }
        let Some(origin) = ui.input(|i| i.pointer.press_origin()) else { return };
        let (from, view, modifiers) = (frame.local(origin), frame.view(ui, state), ui.input(|i| i.modifiers));
        if !response.drag_started_by(PointerButton::Primary) {
            self.drag = Drag::Pan;
            return;
        }
        let part = frame.gizmo_at(&view, from);
        let vertex = handle_at(&view, frame.handles, from, GRAB_RADIUS);
        let outline = state.editing.outline.take().or(modifiers.command.then_some(Outline::Lasso));
        let operate = |part: GizmoPart, grabbed: Vec3, lead: Option<u32>, state: &UiState, out: &mut Outbox| {
            let (operator, bound) = part.operation();
            let operating = frame.operate(operator, lead, from, state, out);
            operating.map_or(Drag::Over, |o| Drag::Operate(Box::new(o.held(grabbed, bound))))
        };
        self.drag = if let Some(outline) = outline {
            Drag::Outline(Drawn::new(outline, from))
        } else if let Some((center, part)) = part {
            self.hot.gizmo = Some(part);
            operate(part, center, None, state, out)
        } else if let Some(index) = vertex {
            let vertex = u32::try_from(index).unwrap_or(u32::MAX);
            if !state.selection.contains(&vertex) {
                if !modifiers.shift {
                    state.selection.clear();
                }
                state.selection.insert(vertex);
            }
            self.hot.vertex = Some(vertex);
            operate(GizmoPart::Center, frame.handles[index], Some(vertex), state, out)
        } else if modifiers.shift {
            Drag::Pan
        } else {
            Drag::Orbit
        };
    }

    /// Begins the operator that a command asked for; the pointer then drives it without a button.
    fn start_wanted(&mut self, ui: &Ui, response: &Response, frame: &Frame<'_>, state: &UiState, out: &mut Outbox) {
        let Some(operator) = self.wanted.take().filter(|_| !self.is_dragging()) else { return };
        // It begins with the next frame, when the whole deformation is shown again.
        self.wanted = Some(operator).filter(|_| state.play.is_on());
        let at = ui.input(|i| i.pointer.latest_pos()).map_or(frame.local(frame.rect.center()), |p| frame.local(p));
        if let Some(operating) = frame.operate(operator, None, at, state, out) {
            self.drag = Drag::Operate(Box::new(operating));
            self.hot = Hot::default();
            response.request_focus();
        }
    }

    fn go_on(&mut self, ui: &mut Ui, response: &Response, frame: &Frame<'_>, state: &mut UiState, out: &mut Outbox) {
        let pointer = response.interact_pointer_pos().map(|p| frame.local(p));
        let mut view = frame.view(ui, state);
        match &mut self.drag {
            Drag::Nothing => return,
            Drag::Over => {}
            Drag::Orbit => state.camera.orbit(to_render(response.drag_delta())),
            Drag::Pan => {
                view.pan(to_render(response.drag_delta()));
                state.camera = view.camera;
            }
            Drag::Outline(drawn) => {
                if ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape)) {
                    self.drag = Drag::Over;
                } else if let Some(to) = pointer {
                    drawn.extend(to);
                    if response.drag_stopped() {
                        drawn.select(&view, frame.handles, to, ui.input(|i| i.modifiers), state);
                    }
                }
            }
            Drag::Operate(operating) => {
                ui.ctx().set_cursor_icon(if operating.is_held { CursorIcon::Grabbing } else { CursorIcon::Move });
                if !operating.is_held {
                    hold_input(ui, response);
                }
                let pointer = ui.input(|i| i.pointer.latest_pos()).map(|p| frame.local(p));
                if operating.go_on(ui, &view, pointer, &mut state.editing, out) == Outcome::Running {
                    return;
                }
                self.drag = Drag::Over;
            }
        }
        if !ui.input(|i| i.pointer.any_down()) {
            self.drag = Drag::Nothing;
        }
    }

    fn click(&mut self, ui: &Ui, response: &Response, frame: &Frame<'_>, state: &mut UiState, out: &mut Outbox) {
        let at = response.interact_pointer_pos().filter(|_| response.clicked() && !self.is_dragging());
        let Some(at) = at else { return };
        response.request_focus();
        let (view, at, shift) = (frame.view(ui, state), frame.local(at), ui.input(|i| i.modifiers.shift));
        if state.feed.picks.is_some() {
            let scene = self.scene(ui, frame, state);
            let bodies = frame.session.project().bodies.as_ref().filter(|_| frame.mesh.is_none());
            let of_bodies = bodies.zip(frame.on_show).zip(scene.surfaces.first());
            if let Some(((spec, shown), surface)) = of_bodies {
                let flat = &shown.deformed.flat;
                bodies_feed::click((&view, at), surface, flat, spec, &mut state.feed, out);
            }
            return;
        }
        let on_gizmo = frame.gizmo_at(&view, at).is_some_and(|(_, part)| part != GizmoPart::Center);
        match handle_at(&view, frame.handles, at, GRAB_RADIUS).and_then(|v| u32::try_from(v).ok()) {
            Some(vertex) if shift && state.selection.remove(&vertex) => {}
            Some(vertex) if shift => {
                state.selection.insert(vertex);
            }
            Some(vertex) => state.selection = [vertex].into(),
            None if !shift && !on_gizmo => state.selection.clear(),
            None => {}
        }
    }

    fn zoom(&self, ui: &Ui, response: &Response, frame: &Frame<'_>, state: &mut UiState) {
        let Some(at) = response.hover_pos().filter(|_| response.contains_pointer()) else { return };
        if matches!(self.drag, Drag::Operate(_)) && state.editing.is_proportional {
            return;
        }
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = pinch * (ZOOM_PER_POINT * scroll).exp();
        let mut view = frame.view(ui, state);
        view.zoom(factor, frame.local(at));
        state.camera = view.camera;
    }

    fn draw(&mut self, ui: &Ui, frame: &Frame<'_>, state: &UiState) -> Scene {
        let scene = self.scene(ui, frame, state);
        ui.painter().rect_filled(frame.rect, 0.0, Tokens::here(ui).viewport);
        let paint = ScenePaint { scene: scene.clone(), view: frame.view(ui, state) };
        ui.painter().add(egui_wgpu::Callback::new_paint_callback(frame.rect, paint));
        scene
    }

    /// What is painted on the antenna on show.
    pub(super) fn heated(&mut self, on_show: Option<OnShow<'_>>, state: &UiState) -> Option<&Heated> {
        self.builder.heated(on_show?, state)
    }

    /// What was drawn last, to be drawn again as a picture.
    pub(super) fn shot(&self) -> Option<&Shot> {
        self.shot.as_ref()
    }

    /// The scales of colours that the picture needs.
    fn bars(&mut self, frame: &Frame<'_>, state: &UiState) -> Vec<Bar> {
        if frame.mesh.is_some() {
            return (state.mesh.paint == MeshPaint::Angle).then(overlay::angle_bar).into_iter().collect();
        }
        let heated = frame.on_show.and_then(|shown| self.builder.heated(shown, state));
        let heat = heated.map(|heated| Bar {
            map: state.heat.map(),
            title: state.heat.text().to_owned(),
            ticks: ticks(state.heat, state.heat_range(heated.auto)),
        });
        let found = frame.solve.and_then(|solve| pattern_scene::pattern(solve, &state.solve));
        let pattern = found.map(|(_, pattern)| {
            overlay::pattern_bar(pattern.field.freq, pattern_scene::range(pattern, state.solve.range_db))
        });
        heat.into_iter().chain(pattern).collect()
    }

    fn overlay(&mut self, ui: &Ui, response: &Response, frame: &Frame<'_>, state: &UiState, scene: &Scene) {
        let view = frame.view(ui, state);
        edit_overlay::name_vertices(ui, response, &view, frame.handles, state);
        if let Some(gizmo) = &frame.gizmo {
            edit_overlay::name_gizmo(ui, response, &view, gizmo);
        }
        let bars = self.bars(frame, state);
        overlay::draw(ui, frame.rect, &view);
        overlay::bars(ui, frame.rect, &bars);
        let tokens = Tokens::here(ui);
        let [r, g, b, _] = tokens.text.to_array();
        self.shot = Some(Shot { scene: scene.clone(), view, bars, ink: [r, g, b] });
        if let Some(mode) = frame.preview {
            let text = format!("Preview: {}. The project is not changed.", mode_text(mode));
            overlay::note(ui, frame.rect, text, tokens.warning);
        } else if let Some((run, _)) = frame.solve.and_then(|solve| pattern_scene::pattern(solve, &state.solve)) {
            overlay::note(ui, frame.rect, format!("Pattern of {}", run.name), tokens.weak);
        }
        frame.draft.into_iter().for_each(|draft| draft.draw(ui, frame.rect, &view));
        if frame.mesh.is_none() && frame.preview.is_none() {
            let places = frame.places_mm.iter().map(|p| DVec3::from_array(*p).as_vec3());
            overlay::places(ui, frame.rect, &view, places);
        }
        if let Some(mesh) = frame.mesh {
            let is_stale = mesh.is_stale(frame.session.project());
            overlay::mesh(ui, frame.rect, self.mesh.looks(), state.mesh.paint, is_stale);
        }
        if let Some(pose) = frame.pose.filter(|_| state.shows_cage) {
            edit_overlay::mirrors(ui, frame.rect, &view, (pose, frame.handles), state);
        }
        let marks = frame.on_show.filter(|_| frame.mesh.is_none()).map_or(&[][..], |shown| &shown.deformed.marks);
        let reads = !self.is_dragging() && self.hot.vertex.is_none() && self.hot.gizmo.is_none();
        let is_read = mark_overlay::draw(ui, response, &view, marks, reads);
        match &self.drag {
            Drag::Outline(drawn) => {
                if let Some(to) = response.interact_pointer_pos() {
                    drawn.draw(ui, frame.rect, frame.local(to));
                }
            }
            Drag::Operate(operating) => edit_overlay::operator(ui, frame.rect, &view, operating, &state.editing),
            Drag::Nothing if state.feed.picks.is_some() => {}
            Drag::Nothing if state.editing.outline.is_some() => {
                if let Some(outline) = state.editing.outline {
                    edit_overlay::outline_hint(ui, frame.rect, outline);
                }
            }
            Drag::Nothing => {
                let pointer = response.hover_pos().filter(|_| response.contains_pointer());
                let hovered = self.hot.vertex.filter(|_| pointer.is_some());
                if let (Some(vertex), Some(pose)) = (hovered, frame.pose) {
                    overlay::vertex_hint(ui, frame.rect, vertex, pose);
                } else if let (Some(part), Some(_)) = (self.hot.gizmo, pointer) {
                    overlay::hint(ui, frame.rect, &format!("{}: drag; Esc gives up", edit_overlay::part_text(part)));
                } else if is_read {
                    // Its value is all there is to say.
                } else if let (Some(at), Some(surface), None) = (pointer, scene.surfaces.first(), frame.mesh) {
                    overlay::value_hint(ui, &view, surface, at, frame.local(at), state.heat);
                }
            }
            _ => {}
        }
    }
}

fn to_render(v: egui::Vec2) -> Vec2 {
    Vec2::new(v.x, v.y)
}

/// Keeps pointer and keys from everything else for this frame: a click anywhere ends the operator, Tab goes on to its
/// next number.
fn hold_input(ui: &Ui, response: &Response) {
    let filter = EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: true };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
    let screen = ui.ctx().content_rect();
    let cover = Area::new(Id::unique("operator")).order(Order::Foreground).fixed_pos(screen.min);
    cover.show(ui.ctx(), |ui| ui.allocate_rect(screen, Sense::click_and_drag()));
}
