//! From a mesh to a picture: the surface of the kept cells, their edges, and the worst cells marked.
//!
//! The faces are found anew only when the mesh, the cut or the colouring changes (a few milliseconds for the meshes
//! of this program); everything else is shared with the last picture. Cells go or stay whole, by their centers.

use super::mesh_session::ShownMesh;
use super::scene::{rgba, to_picture};
use super::theme::Tokens;
use super::ui_state::{MeshPaint, MeshUi};
use crate::antenna::COAX;
use crate::geometry::{RegionRole, VertexId};
use crate::render::{Array, ColorMap, Grid, HandleState, Handles, Lines, Paint, Part, Scalars, Scene, Surface, Vec3};
use crate::tet::{CutFace, FaceRole, TetMesh, cutaway};
use crate::units::from_mm;
use egui::Color32;

/// Ends of the scale of angles, degrees: the regular cell has 70.5, good meshes have few cells above 60.
pub(super) const ANGLE_RANGE: [f32; 2] = [0.0, 60.0];

/// The air is a ball, which fills less of the view than the box around it: a box this much smaller does as much. The
/// box inside the ball would be 0.58 as large; a little more leaves room for the crinkled edge.
const BALL_IN_BOX: f32 = 0.62;

/// What a face looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    Air,
    Substrate,
    Coax,
    Patch,
    Ground,
    Feed,
    Port,
    /// A cell of the list of the worst.
    Worst,
}

impl Look {
    /// All of them, in the order of the legend.
    const ALL: [Self; 8] =
        [Self::Air, Self::Substrate, Self::Coax, Self::Patch, Self::Ground, Self::Feed, Self::Port, Self::Worst];

    /// Name in the legend.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Air => "Air",
            Self::Substrate => "Substrate",
            Self::Coax => "Coaxial line",
            Self::Patch => "Patch",
            Self::Ground => "Ground",
            Self::Feed => "Pin and sleeve",
            Self::Port => "Port",
            Self::Worst => "Worst cells",
        }
    }

    /// Colour in the legend and in the view.
    pub(super) fn color(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Air => tokens.air,
            Self::Substrate => tokens.substrate,
            Self::Coax => tokens.coax,
            Self::Patch => tokens.patch,
            Self::Ground => tokens.ground,
            Self::Feed => tokens.pin,
            Self::Port => tokens.port,
            Self::Worst => tokens.signal,
        }
    }

    fn paint(self, tokens: &Tokens) -> Paint {
        let color = rgba(self.color(tokens));
        match self {
            Self::Patch | Self::Ground | Self::Feed => Paint::Metal(color),
            _ => Paint::Matt(color),
        }
    }

    /// The look of a face by its group, else by the region behind it.
    fn of(mesh: &TetMesh, face: &CutFace) -> Self {
        let group = face.group.map(|g| &mesh.groups[g]);
        match group.map(|g| (g.role, g.name.as_str())) {
            Some((FaceRole::Conductor, "pec_patch")) => Self::Patch,
            Some((FaceRole::Conductor, "pec_ground")) => Self::Ground,
            Some((FaceRole::Conductor, _)) => Self::Feed,
            Some((FaceRole::Port, _)) => Self::Port,
            Some((FaceRole::Outer, _)) | None => {
                let region = &mesh.regions[mesh.tets[face.tet].region.index()];
                match region.role {
                    RegionRole::Dielectric if region.name == COAX => Self::Coax,
                    RegionRole::Dielectric => Self::Substrate,
                    _ => Self::Air,
                }
            }
        }
    }
}

/// What decides which faces are shown, and in what order they are listed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    serial: u64,
    cut: (usize, f64, bool),
    cuts_antenna: bool,
    shows_air: bool,
    paint: MeshPaint,
    marks_worst: bool,
}

/// The surface of the kept cells.
#[derive(Clone, Debug, Default)]
struct Shown {
    /// Faces by their look; with angles painted, those of the worst cells alone.
    parts: Vec<(Look, Array<[u32; 3]>)>,
    painted: Option<Painted>,
    edges: Array<[u32; 2]>,
    bounds: (Vec3, Vec3),
}

/// Faces with corners of their own, since an angle belongs to a cell and not to a vertex.
#[derive(Clone, Debug)]
struct Painted {
    positions: Array<Vec3>,
    faces: Array<[u32; 3]>,
    /// Degrees.
    angles: Array<f32>,
}

/// The worst cells as lines and points.
#[derive(Clone, Debug)]
struct Marks {
    edges: Array<[u32; 2]>,
    centers: Array<Vec3>,
    states: Array<HandleState>,
}

/// Makes pictures of a mesh and keeps what can be used again.
#[derive(Debug, Default)]
pub(super) struct MeshScene {
    positions: Option<(u64, Array<Vec3>)>,
    shown: Option<(Key, Shown)>,
    marks: Option<((u64, Option<usize>), Marks)>,
}

impl MeshScene {
    /// Makes the picture of a mesh.
    pub(super) fn scene(&mut self, mesh: &ShownMesh, ui: &MeshUi, tokens: &Tokens) -> Scene {
        let positions = self.positions(mesh);
        let shown = self.shown(mesh, ui);
        let mut scene = Scene { background: rgba(tokens.viewport), ..Scene::default() };
        let parts = shown.parts.iter().map(|(look, faces)| Part::new(faces.clone(), look.paint(tokens)));
        scene.surfaces.push(Surface { positions: positions.clone(), parts: parts.collect(), scalars: None });
        if let Some(Painted { positions, faces, angles }) = &shown.painted {
            scene.surfaces.push(Surface {
                positions: positions.clone(),
                parts: vec![Part::new(faces.clone(), Paint::Heat)],
                scalars: Some(Scalars { values: angles.clone(), range: ANGLE_RANGE, map: ColorMap::Viridis }),
            });
        }
        let [r, g, b, _] = rgba(tokens.mesh_edge);
        let edges = shown.edges.clone();
        scene.lines.push(Lines { positions: positions.clone(), edges, color: [r, g, b, 120], width: 0.8, hidden: 0.0 });
        if ui.marks_worst {
            let marks = self.marks(mesh, ui);
            let color = rgba(tokens.signal);
            scene.lines.push(Lines { positions, edges: marks.edges, color, width: 1.6, hidden: 0.8 });
            scene.handles = Some(Handles {
                positions: marks.centers,
                states: marks.states,
                fills: [color, color, rgba(tokens.handles[2]), color],
                outline: rgba(tokens.panel),
                radius: 3.0,
                hidden: 0.75,
            });
        }
        let [r, g, b, _] = rgba(tokens.grid);
        let z = (shown.bounds.0.z.min(0.0) / 5.0).floor() * 5.0 - 1.0;
        let axes = [rgba(tokens.axes[0]), rgba(tokens.axes[1])];
        scene.grid = Some(Grid { z, spacing: 1.0, color: [r, g, b, 110], axes });
        scene
    }

    /// Lowest and highest corner of the box to be brought into view, mm.
    pub(super) fn bounds(&mut self, mesh: &ShownMesh, ui: &MeshUi) -> (Vec3, Vec3) {
        let (lo, hi) = self.shown(mesh, ui).bounds;
        let (center, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
        let part = if ui.shows_air { BALL_IN_BOX } else { 1.0 };
        (center - part * half, center + part * half)
    }

    /// The looks that are to be seen, for the legend.
    pub(super) fn looks(&self) -> impl Iterator<Item = Look> {
        let shown = self.shown.iter().flat_map(|(_, shown)| shown.parts.iter().map(|(look, _)| *look));
        let marked = self.shown.iter().filter(|(key, _)| key.marks_worst).map(|_| Look::Worst);
        shown.filter(|look| *look != Look::Worst).chain(marked)
    }

    fn positions(&mut self, mesh: &ShownMesh) -> Array<Vec3> {
        if self.positions.as_ref().is_none_or(|(serial, _)| *serial != mesh.serial) {
            self.positions = Some((mesh.serial, Array::new(to_picture(&mesh.ready.meshed.mesh.vertices))));
        }
        self.positions.as_ref().map(|(_, array)| array.clone()).unwrap_or_default()
    }

    fn shown(&mut self, mesh: &ShownMesh, ui: &MeshUi) -> Shown {
        let key = Key {
            serial: mesh.serial,
            cut: (ui.axis, ui.place_mm, ui.flipped),
            cuts_antenna: ui.cuts_antenna,
            shows_air: ui.shows_air,
            paint: ui.paint,
            marks_worst: ui.marks_worst,
        };
        if self.shown.as_ref().is_none_or(|(k, _)| *k != key) {
            let positions = self.positions(mesh);
            self.shown = Some((key, Shown::of(mesh, ui, &positions)));
        }
        self.shown.as_ref().map(|(_, shown)| shown.clone()).unwrap_or_default()
    }

    fn marks(&mut self, mesh: &ShownMesh, ui: &MeshUi) -> Marks {
        let key = (mesh.serial, ui.chosen);
        if let Some((_, marks)) = self.marks.as_ref().filter(|(k, _)| *k == key) {
            return marks.clone();
        }
        let meshed = &mesh.ready.meshed;
        let worst = &meshed.quality.worst;
        let edges = worst.iter().flat_map(|w| {
            let v = meshed.mesh.tets[w.tet].vertices.map(VertexId::raw);
            [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|e: [usize; 2]| e.map(|k| v[k]))
        });
        let state = |i| if ui.chosen == Some(i) { HandleState::Selected } else { HandleState::Normal };
        let marks = Marks {
            edges: Array::new(edges.collect::<Vec<_>>()),
            centers: Array::new(to_picture(&worst.iter().map(|w| w.at).collect::<Vec<_>>())),
            states: Array::new((0..worst.len()).map(state).collect::<Vec<_>>()),
        };
        self.marks = Some((key, marks.clone()));
        marks
    }
}

impl Shown {
    fn of(mesh: &ShownMesh, ui: &MeshUi, positions: &[Vec3]) -> Self {
        let faces = kept_faces(mesh, ui);
        let ready = &mesh.ready;
        let tets = &ready.meshed.mesh;
        let worst: Vec<usize> = ready.meshed.quality.worst.iter().filter(|_| ui.marks_worst).map(|w| w.tet).collect();
        let mut lists: [Vec<[u32; 3]>; Look::ALL.len()] = Default::default();
        let (mut corners, mut angles) = (Vec::new(), Vec::new());
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for face in &faces {
            let triangle = face.vertices.map(VertexId::raw);
            let places = triangle.map(|v| positions[v as usize]);
            for p in places {
                (lo, hi) = (lo.min(p), hi.max(p));
            }
            if worst.contains(&face.tet) {
                lists[Look::Worst as usize].push(triangle);
            } else if ui.paint == MeshPaint::Angle {
                corners.extend(places);
                angles.extend([ready.cells[face.tet].dihedral_min.to_degrees() as f32; 3]);
            } else {
                lists[Look::of(tets, face) as usize].push(triangle);
            }
        }
        let painted = (ui.paint == MeshPaint::Angle).then(|| {
            let own: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
            Painted { positions: Array::new(corners), faces: Array::new(own), angles: Array::new(angles) }
        });
        let parts = Look::ALL.into_iter().zip(lists).filter(|(_, list)| !list.is_empty());
        let edges: Vec<[u32; 2]> = cutaway::edges(&faces).map(|e| e.map(VertexId::raw)).collect();
        Self {
            parts: parts.map(|(look, list)| (look, Array::new(list))).collect(),
            painted,
            edges: Array::new(edges),
            bounds: if faces.is_empty() { (Vec3::ZERO, Vec3::ZERO) } else { (lo, hi) },
        }
    }
}

/// The faces of the cells that the cut leaves.
fn kept_faces(mesh: &ShownMesh, ui: &MeshUi) -> Vec<CutFace> {
    let ready = &mesh.ready;
    let tets = &ready.meshed.mesh;
    let is_air: Vec<bool> = tets.regions.iter().map(|r| r.role == RegionRole::Air).collect();
    let centers = ready.cutaway.centers();
    let place = from_mm(ui.place_mm);
    ready.cutaway.faces(tets, |t| {
        let at = centers[t][ui.axis];
        let is_behind = if ui.flipped { at <= place } else { at >= place };
        if is_air[tets.tets[t].region.index()] { ui.shows_air && is_behind } else { is_behind || !ui.cuts_antenna }
    })
}
