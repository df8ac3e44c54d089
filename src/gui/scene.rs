//! From the session to a picture: which triangles, lines and handles, in which colours.
//!
//! Lists are made anew only when what they come from has changed; everything else is shared with the last picture, so
//! that a drag uploads positions and nothing else.

use super::heat::{self, Heated, OnShow};
use super::session::Pose;
use super::theme::Tokens;
use super::ui_state::{Heat, HeatPart, UiState};
use crate::antenna::{COAX, GROUND, PATCH, PIN, SUBSTRATE};
use crate::geometry::{DVec3, Plc, Region, RegionId, RegionRole, VertexId};
use crate::pipeline;
use crate::project::Project;
use crate::render::scene::{crease_edges, unique_edges};
use crate::render::{
    Array, Gizmo, GizmoPart, Grid, HandleState, Handles, Lines, Paint, Part, Rgba, Scalars, Scene, Surface, Vec3,
};
use crate::units::to_mm;
use egui::Color32;
use std::sync::Arc;

/// Folds sharper than this are drawn as outlines, degrees: more than a bent facet turns, less than a pin's polygon.
pub(super) const CREASE_DEG: f32 = 20.0;
/// How much of the exact cylinder is seen where it is drawn through the antenna.
const GHOST_OPACITY: f32 = 0.28;
/// Makes scenes and keeps what can be used again.
#[derive(Debug, Default)]
pub(super) struct SceneBuilder {
    /// Triangles of each region and outlines, of the complex at this address.
    shape: Option<(Arc<Plc>, Shape)>,
    /// The flat antenna, shown until the first answer.
    drawn: Option<(Project, Arc<Plc>)>,
    /// By the answer's number and the complex's address.
    positions: Option<((u64, usize), Array<Vec3>)>,
    heat: Option<((u64, Heat, HeatPart), Heated)>,
    ghost: Option<(u64, Array<Vec3>)>,
    cage: Option<(u64, CageShape)>,
    states: Option<(Vec<HandleState>, Array<HandleState>)>,
}

#[derive(Clone, Debug)]
struct Shape {
    parts: Vec<(Region, Array<[u32; 3]>)>,
    creases: Array<[u32; 2]>,
    /// Those of substrate and patch.
    carried_creases: Array<[u32; 2]>,
}

#[derive(Clone, Debug)]
struct CageShape {
    positions: Array<Vec3>,
    handles: Array<Vec3>,
    edges: Array<[u32; 2]>,
}

/// What is under the pointer or being dragged.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Hot {
    pub(super) vertex: Option<u32>,
    pub(super) gizmo: Option<GizmoPart>,
}

/// Positions in millimetres as the renderer takes them.
pub(super) fn to_picture(points: &[DVec3]) -> Vec<Vec3> {
    points.iter().map(|p| (*p * to_mm(1.0)).as_vec3()).collect()
}

/// A colour as the renderer takes it.
pub(super) fn rgba(color: Color32) -> Rgba {
    color.to_srgba_unmultiplied()
}

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subject<'a> {
    /// The computed antenna.
    pub(super) on_show: Option<OnShow<'a>>,
    /// Whose antenna is drawn for as long as nothing is computed, if any.
    pub(super) drawn: Option<&'a Project>,
    pub(super) pose: Option<&'a Pose>,
    /// Whether the cage's vertices can be taken hold of.
    pub(super) is_fixed: bool,
}

impl SceneBuilder {
    /// Makes the picture of a subject.
    pub(super) fn scene(&mut self, subject: Subject<'_>, state: &UiState, tokens: &Tokens, hot: Hot) -> Scene {
        let mut scene = Scene { background: rgba(tokens.viewport), ..Scene::default() };
        let mut lowest = 0.0_f32;
        if let Some((surface, creases)) = self.antenna(subject, state, tokens) {
            lowest = surface.positions.iter().map(|p| p.z).fold(lowest, f32::min);
            scene.lines.push(creases);
            scene.surfaces.push(surface);
        }
        if let Some((surface, creases)) = subject.on_show.and_then(|shown| self.ghost(shown, state, tokens)) {
            scene.lines.push(creases);
            scene.surfaces.push(surface);
        }
        if let Some(pose) = subject.pose.filter(|_| state.shows_cage) {
            let cage = self.cage(pose);
            lowest = cage.positions.iter().map(|p| p.z).fold(lowest, f32::min);
            let [r, g, b, _] = rgba(tokens.cage);
            scene.lines.push(Lines {
                positions: cage.positions,
                edges: cage.edges,
                color: [r, g, b, 200],
                width: 1.1,
                hidden: 0.35,
            });
            if !subject.is_fixed {
                scene.gizmo = gizmo(&cage.handles, state, tokens, hot);
                scene.handles = Some(self.handles(cage.handles, state, tokens, hot));
            }
        }
        let [r, g, b, _] = rgba(tokens.grid);
        let axes = [rgba(tokens.axes[0]), rgba(tokens.axes[1])];
        // A little below everything, in steps, so that it does not tremble with a drag.
        let z = (lowest / 5.0).floor() * 5.0 - 1.0;
        scene.grid = Some(Grid { z, spacing: 1.0, color: [r, g, b, 110], axes });
        scene
    }

    /// What is painted on an antenna, if anything is and the antenna has it.
    pub(super) fn heated(&mut self, shown: OnShow<'_>, state: &UiState) -> Option<&Heated> {
        let key = (shown.serial, state.heat, state.heat_part);
        if self.heat.as_ref().is_none_or(|(k, _)| *k != key) {
            let shape = self.shape(&shown.deformed.flat);
            let regions = shape.parts.iter().map(|(region, triangles)| (region.name.as_str(), &triangles[..]));
            let heated = Heated::new(state.heat, state.heat_part, shown.deformed, regions)?;
            self.heat = Some((key, heated));
        }
        self.heat.as_ref().map(|(_, heated)| heated)
    }

    /// The exact cylinder's substrate and patch, where it is to be seen.
    fn ghost(&mut self, shown: OnShow<'_>, state: &UiState, tokens: &Tokens) -> Option<(Surface, Lines)> {
        if !state.shows_ghost {
            return None;
        }
        if self.ghost.as_ref().is_none_or(|(serial, _)| *serial != shown.serial) {
            self.ghost = Some((shown.serial, Array::new(heat::ghost(shown.deformed)?)));
        }
        let positions = self.ghost.as_ref()?.1.clone();
        let shape = self.shape(&shown.deformed.flat);
        let color = rgba(tokens.ideal);
        // Over painted parts its outlines alone are drawn: a veil would falsify the colours.
        let is_veil = state.heat == Heat::None;
        let parts = shape.parts.iter().filter(|(r, _)| is_veil && matches!(r.name.as_str(), SUBSTRATE | PATCH));
        let parts = parts
            .map(|(_, triangles)| Part { opacity: GHOST_OPACITY, ..Part::new(triangles.clone(), Paint::Matt(color)) });
        let surface = Surface { positions: positions.clone(), parts: parts.collect(), scalars: None };
        let creases = Lines { positions, edges: shape.carried_creases, color, width: 1.3, hidden: 0.45 };
        Some((surface, creases))
    }

    fn antenna(&mut self, subject: Subject<'_>, state: &UiState, tokens: &Tokens) -> Option<(Surface, Lines)> {
        let shown = subject.on_show;
        let drawn = subject.drawn.filter(|_| shown.is_none()).and_then(|project| self.drawn_flat(project));
        let (serial, flat, points) = match (shown, &drawn) {
            (Some(OnShow { deformed, serial }), _) => (serial, Arc::clone(&deformed.flat), &deformed.positions),
            (None, Some(flat)) => (0, Arc::clone(flat), &flat.vertices),
            (None, None) => return None,
        };
        let key = (serial, Arc::as_ptr(&flat) as usize);
        if self.positions.as_ref().is_none_or(|(k, _)| *k != key) {
            self.positions = Some((key, Array::new(to_picture(points))));
        }
        let positions = self.positions.as_ref()?.1.clone();
        let shape = self.shape(&flat);
        let scalars = shown.and_then(|shown| self.scalars(shown, state));
        let see_through = state.sees_through;
        let parts = shape.parts.iter().map(|(region, triangles)| {
            let is_painted = scalars.is_some() && state.heat_part.paints(&region.name);
            let paint = if is_painted { Paint::Heat } else { paint_of(region, tokens) };
            let is_substrate = region.role == RegionRole::Dielectric && region.name != COAX;
            let opacity = if see_through && is_substrate { 0.35 } else { 1.0 };
            Part { opacity, ..Part::new(triangles.clone(), paint) }
        });
        let surface = Surface { positions: positions.clone(), parts: parts.collect(), scalars };
        let [r, g, b, _] = rgba(tokens.crease);
        let creases = Lines { positions, edges: shape.creases.clone(), color: [r, g, b, 190], width: 1.0, hidden: 0.0 };
        Some((surface, creases))
    }

    fn drawn_flat(&mut self, project: &Project) -> Option<Arc<Plc>> {
        let is_same = |known: &Project| known.antenna == project.antenna && known.bodies == project.bodies;
        if !self.drawn.as_ref().is_some_and(|(known, _)| is_same(known)) {
            self.drawn = Some((project.clone(), Arc::new(pipeline::flat(project).ok()?)));
        }
        self.drawn.as_ref().map(|(_, plc)| Arc::clone(plc))
    }

    fn shape(&mut self, flat: &Arc<Plc>) -> Shape {
        let is_same = self.shape.as_ref().is_some_and(|(plc, _)| Arc::ptr_eq(plc, flat));
        if !is_same {
            self.shape = Some((Arc::clone(flat), Shape::of(flat)));
        }
        self.shape.as_ref().map(|(_, shape)| shape.clone()).unwrap_or_else(|| Shape::of(flat))
    }

    fn scalars(&mut self, shown: OnShow<'_>, state: &UiState) -> Option<Scalars> {
        let heated = self.heated(shown, state)?;
        Some(Scalars { values: heated.values.clone(), range: state.heat_range(heated.auto), map: state.heat.map() })
    }

    fn cage(&mut self, pose: &Pose) -> CageShape {
        if let Some((serial, shape)) = self.cage.as_ref().filter(|(s, _)| *s == pose.serial) {
            debug_assert_eq!(*serial, pose.serial, "found by its serial");
            return shape.clone();
        }
        let points = to_picture(&pose.vertices);
        let cage = &pose.cage;
        // An edge from bottom to top in the middle runs through the antenna and is no edge of the surface.
        let on_surface = |e: &&[VertexId; 2]| {
            let [from, to] = e.map(|v| cage.lattice[v.index()]);
            let on_rim = (0..2).any(|k| from[k] == 0 || from[k] == cage.segments[k]);
            from[2] == to[2] || on_rim
        };
        let edges: Vec<[u32; 2]> = cage.edges().iter().filter(on_surface).map(|e| e.map(|v| v.raw())).collect();
        let handles = points[..pose.cage.n_handles().min(points.len())].to_vec();
        let shape = CageShape { positions: Array::new(points), handles: Array::new(handles), edges: Array::new(edges) };
        self.cage = Some((pose.serial, shape.clone()));
        shape
    }

    fn handles(&mut self, positions: Array<Vec3>, state: &UiState, tokens: &Tokens, hot: Hot) -> Handles {
        let state_of = |i: usize| {
            let vertex = u32::try_from(i).ok();
            if vertex.is_some_and(|v| state.selection.contains(&v)) {
                HandleState::Selected
            } else if vertex == hot.vertex {
                HandleState::Hovered
            } else {
                HandleState::Normal
            }
        };
        let states: Vec<HandleState> = (0..positions.len()).map(state_of).collect();
        if self.states.as_ref().is_none_or(|(before, _)| *before != states) {
            self.states = Some((states.clone(), Array::new(states)));
        }
        Handles {
            positions,
            states: self.states.as_ref().map(|(_, array)| array.clone()).unwrap_or_default(),
            fills: tokens.handles.map(rgba),
            outline: rgba(tokens.handle_rim),
            radius: 3.6,
            hidden: 0.25,
        }
    }
}

/// The gizmo at the middle of the selection.
pub(super) fn gizmo(handles: &[Vec3], state: &UiState, tokens: &Tokens, hot: Hot) -> Option<Gizmo> {
    let selected: Vec<Vec3> = state.selection.iter().filter_map(|&v| handles.get(v as usize).copied()).collect();
    if selected.is_empty() {
        return None;
    }
    let center = selected.iter().sum::<Vec3>() / selected.len() as f32;
    let [x, y, z] = tokens.axes.map(rgba);
    Some(Gizmo {
        center,
        is_whole: selected.len() > 1,
        colors: [x, y, z, rgba(tokens.handles[2])],
        hot: hot.gizmo,
        hot_color: rgba(tokens.handles[1]),
    })
}

/// The material look of a region.
fn paint_of(region: &Region, tokens: &Tokens) -> Paint {
    match (region.role, region.name.as_str()) {
        (RegionRole::Conductor, GROUND) => Paint::Metal(rgba(tokens.ground)),
        (RegionRole::Conductor, PIN) => Paint::Metal(rgba(tokens.pin)),
        (RegionRole::Conductor, _) => Paint::Metal(rgba(tokens.patch)),
        (_, COAX) => Paint::Matt(rgba(tokens.coax)),
        _ => Paint::Matt(rgba(tokens.substrate)),
    }
}

impl Shape {
    /// Sorts the facets by the region that is seen, and finds the outlines.
    fn of(flat: &Plc) -> Self {
        let solids: Vec<(RegionId, &Region)> = flat.solids().collect();
        let mut parts: Vec<(Region, Vec<[u32; 3]>)> =
            solids.iter().map(|(_, region)| ((*region).clone(), Vec::new())).collect();
        let rank = |id: RegionId| solids.iter().position(|(s, _)| *s == id);
        let mut all = Vec::with_capacity(flat.facets.len());
        for facet in &flat.facets {
            let triangle = facet.vertices.map(|v| v.raw());
            all.push(triangle);
            // Where two solids touch, the metal is the one that is seen through a translucent substrate.
            let sides = [facet.back, facet.front].into_iter().filter_map(rank);
            if let Some(part) = sides.max_by_key(|&i| precedence(solids[i].1)) {
                parts[part].1.push(triangle);
            }
        }
        let parts: Vec<(Region, Array<[u32; 3]>)> =
            parts.into_iter().map(|(region, triangles)| (region, Array::new(triangles))).collect();
        let creases = crease_edges(&to_picture(&flat.vertices), &all, CREASE_DEG);
        let creases = if creases.is_empty() { unique_edges(&all) } else { creases };
        let mut is_carried = vec![false; flat.vertices.len()];
        let carried = parts.iter().filter(|(r, _)| matches!(r.name.as_str(), SUBSTRATE | PATCH));
        for &v in carried.flat_map(|(_, triangles)| triangles.iter().flatten()) {
            is_carried[v as usize] = true;
        }
        let carried = creases.iter().filter(|e| e.iter().all(|&v| is_carried[v as usize])).copied();
        Self { parts, carried_creases: Array::new(carried.collect::<Vec<_>>()), creases: Array::new(creases) }
    }
}

fn precedence(region: &Region) -> u8 {
    match (region.role, region.name.as_str()) {
        (_, PATCH) => 4,
        (_, PIN) => 3,
        (RegionRole::Conductor, _) => 2,
        (_, COAX) => 1,
        _ => 0,
    }
}
