//! Import of closed bodies: files, unit, what each body is made of, and what stands against welding them, with places.

use super::body_rows::body_rows;
use super::dialogs::{PathField, Purpose, problem_with};
use super::draft::{self, Draft};
use super::export_dialog::{answer, work};
use super::field::{Choices, rows};
use super::outbox::{Action, Outbox};
use super::places;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::antenna::{BodyFault, WeldError};
use crate::io::bodies::{Solid, name_plainly, read};
use crate::io::outline::LENGTH_UNITS;
use crate::project::{BodiesSpec, BodyKind, BodySpec, Edit, LooseBody, MaterialSpec, WELD_MM};
use crate::render::{Camera, Vec3};
use crate::task::{Progress, Task};
use egui::{ComboBox, DragValue, ProgressBar, RichText, ScrollArea, Spinner, Ui};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Range of the weld tolerance, mm.
const WELD_RANGE_MM: (f64, f64) = (1e-6, 1.0);
/// Distance of the eye from the bodies over the diagonal of the box around them.
const DISTANCE: f32 = 3.5;
/// Time between two looks at how far the work is.
const PAUSE: Duration = Duration::from_millis(100);
/// Height of the lists of bodies and of problems, points.
const LIST_HEIGHT: f32 = 170.0;

/// The dialog.
#[derive(Debug)]
pub(super) struct BodiesDialog {
    pub(super) field: PathField,
    asked: Asked,
    /// What the user chose each body to be made of, by its name.
    chosen: BTreeMap<String, BodyKind>,
    /// Materials of the project's own.
    own: Vec<MaterialSpec>,
    /// What was read and welded last.
    found: Option<(Asked, Found)>,
    working: Option<Working>,
    /// The camera from before the bodies were looked at.
    before: Option<Camera>,
    /// What was looked at last.
    looked_at: Option<[Vec3; 2]>,
}

/// A thread that reads and welds; it stops when this is dropped.
#[derive(Debug)]
struct Working {
    asked: Asked,
    receiver: Receiver<Found>,
    task: Task,
    progress: Arc<Mutex<Option<Progress>>>,
}

impl Drop for Working {
    fn drop(&mut self) {
        self.task.cancel();
    }
}

impl Working {
    fn start(ui: &Ui, asked: &Asked) -> Self {
        let progress = Arc::<Mutex<Option<Progress>>>::default();
        let sink = Arc::clone(&progress);
        let task = Task::with_progress(move |step| *sink.lock().unwrap_or_else(PoisonError::into_inner) = Some(step));
        let (own, own_task) = (asked.clone(), task.clone());
        let receiver = work(ui, move || welded(&own, &own_task).map_err(anyhow::Error::msg));
        Self { asked: asked.clone(), receiver, task, progress }
    }

    /// How far it is.
    fn ui(&self, ui: &mut Ui) {
        let progress = *self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        ui.horizontal(|ui| {
            match progress.filter(|p| p.total > 0) {
                Some(p) => {
                    let part = p.done as f32 / p.total as f32;
                    ui.add(ProgressBar::new(part).desired_width(150.0).desired_height(14.0));
                }
                None => {
                    ui.add(Spinner::new().size(14.0));
                }
            }
            let phase = progress.map_or("beginning", |p| p.phase);
            ui.label(RichText::new(format!("Reading and welding: {phase}…")).weak());
        });
        ui.ctx().request_repaint_after(PAUSE);
    }
}

/// What bodies are read from and how they are welded.
#[derive(Clone, Debug, PartialEq)]
struct Asked {
    files: Vec<PathBuf>,
    /// Place among the units.
    unit: usize,
    weld_mm: f64,
}

/// What came of it, or why nothing could be read.
type Found = Result<Welded, String>;

#[derive(Debug)]
struct Welded {
    /// The bodies as read, without their surfaces.
    solids: Vec<Solid>,
    n_triangles: Vec<usize>,
    draft: Draft,
    /// All bodies as metal, for what they are made of does not matter to their shape.
    spec: Result<BodiesSpec, Vec<BodyFault>>,
}

impl BodiesDialog {
    /// Asks for files in a folder.
    pub(super) fn new(own: &[MaterialSpec], folder: &Path) -> Self {
        Self {
            field: PathField::new(Purpose::Bodies, folder.join("").display().to_string()),
            asked: Asked { files: Vec::new(), unit: 0, weld_mm: WELD_MM },
            chosen: BTreeMap::new(),
            own: own.to_vec(),
            found: None,
            working: None,
            before: None,
            looked_at: None,
        }
    }

    /// The work under way, if any.
    #[cfg(test)]
    pub(super) fn task(&self) -> Option<&Task> {
        self.working.as_ref().map(|working| &working.task)
    }

    /// What the view shows of the bodies.
    pub(super) fn draft(&self) -> Option<&Draft> {
        let (_, found) = self.found.as_ref().filter(|_| !self.asked.files.is_empty())?;
        found.as_ref().ok().map(|welded| &welded.draft)
    }

    /// Brings the bodies before the eye, once.
    fn look(&mut self, state: &mut UiState) {
        let Some(bounds) = self.draft().map(|draft| draft.bounds) else { return };
        if self.looked_at.replace(bounds) != Some(bounds) {
            state.show_mesh(false);
            self.before.get_or_insert(state.camera);
            let [lo, hi] = bounds;
            state.look_at(lo.midpoint(hi), DISTANCE * lo.distance(hi));
        }
    }

    /// Puts the camera back where it was.
    pub(super) fn give_back(&mut self, state: &mut UiState) {
        state.camera = self.before.take().unwrap_or(state.camera);
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Import bodies");
        let about = "Closed bodies from STL, OBJ or binary glTF files take the patch's place, flat in a new cage. Those \
                     that touch are welded, so that they share their interface.";
        ui.add(egui::Label::new(RichText::new(about).weak()).wrap());
        ui.add_space(6.0);
        self.file(ui, state);
        ui.add_space(4.0);
        rows(ui, "bodies", |ui| self.choices(ui));
        self.work(ui);
        self.look(state);
        let current = self.found.as_ref().is_some_and(|(asked, _)| *asked == self.asked);
        let mut made = None;
        if self.asked.files.is_empty() {
            ui.label(RichText::new("No file yet: a body is a solid, a group or a node of a file.").weak());
        } else if current {
            made = self.report(ui, state);
        } else if let Some(working) = &self.working {
            working.ui(ui);
        }
        ui.add_space(8.0);
        let mut close = false;
        ui.horizontal(|ui| {
            let button = ui.add_enabled(made.is_some(), egui::Button::new("Import"));
            let why = "Every body needs a material, and nothing may stand against welding";
            let go =
                button.on_hover_text("Put these bodies in the patch's place").on_disabled_hover_text(why).clicked();
            close = ui.button("Cancel").on_hover_text("Stop, and import nothing").clicked();
            if let (true, Some(spec)) = (go, made) {
                out.push(Action::Edit("bodies", Edit::SetBodies(Some(Box::new(spec)))));
                state.fit = true;
                close = true;
            }
        });
        close
    }

    /// The path of a file, and the files so far.
    fn file(&mut self, ui: &mut Ui, state: &mut UiState) {
        let mut go = self.field.ui(ui, "File");
        let path = self.field.path();
        let is_known = self.asked.files.contains(&path);
        let problem = problem_with(&path, false).or(is_known.then_some("This file is among them."));
        ui.horizontal(|ui| {
            let tip = "Read the bodies of this file too; several files are welded together";
            go |= ui.add_enabled(problem.is_none(), egui::Button::new("Add file")).on_hover_text(tip).clicked();
            if let Some(problem) = problem {
                ui.label(RichText::new(problem).weak());
            }
        });
        if go && problem.is_none() {
            state.last_folder = path.parent().map(Path::to_owned);
            self.field.text = path.with_file_name("").display().to_string();
            self.asked.files.push(path);
        }
        let mut removed = None;
        for (k, path) in self.asked.files.iter().enumerate() {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            ui.horizontal(|ui| {
                if ui.small_button("✖").on_hover_text(format!("Leave {name} out")).clicked() {
                    removed = Some(k);
                }
                ui.label(name).on_hover_text(path.display().to_string());
            });
        }
        removed.map(|k| self.asked.files.remove(k));
    }

    fn choices(&mut self, ui: &mut Ui) {
        let tip = "What a number in STL and OBJ files means; glTF is always in metres, with y up";
        let label = ui.label("Unit").on_hover_text(tip);
        let combo = ComboBox::from_id_salt("body unit").width(90.0).selected_text(LENGTH_UNITS[self.asked.unit].0);
        let combo = combo.show_list(ui, |ui| {
            for (k, (name, _)) in LENGTH_UNITS.iter().enumerate() {
                ui.selectable_value(&mut self.asked.unit, k, *name);
            }
        });
        combo.response.labelled_by(label.id).on_hover_text(tip);
        ui.end_row();
        let tip =
            "Distance within which two places become one: above the files' rounding, well below the thinnest part";
        let label = ui.label("Weld within").on_hover_text(tip);
        let (lo, hi) = WELD_RANGE_MM;
        let input = DragValue::new(&mut self.asked.weld_mm).suffix(" mm").speed(1e-4).max_decimals(6).range(lo..=hi);
        ui.add(input.update_while_editing(false)).labelled_by(label.id).on_hover_text(tip);
        ui.end_row();
    }

    /// Starts to read and weld what is asked for, and takes what was found.
    fn work(&mut self, ui: &Ui) {
        if let Some(working) = &self.working {
            if working.asked != self.asked {
                working.task.cancel();
            }
            let Some(found) = answer(&working.receiver) else { return };
            if !working.task.is_cancelled() {
                self.found = Some((working.asked.clone(), found));
            }
            self.working = None;
        }
        let is_done = self.found.as_ref().is_some_and(|(asked, _)| *asked == self.asked);
        if is_done || self.asked.files.is_empty() {
            return;
        }
        self.working = Some(Working::start(ui, &self.asked));
    }

    /// The bodies with their materials, or what is wrong with them; what would be imported.
    fn report(&mut self, ui: &mut Ui, state: &mut UiState) -> Option<BodiesSpec> {
        let error = Tokens::here(ui).error;
        let welded = match &self.found.as_ref()?.1 {
            Ok(welded) => welded,
            Err(reason) => {
                ui.add(egui::Label::new(RichText::new(reason).color(error)).wrap());
                return None;
            }
        };
        let kind = |solid: &Solid| self.chosen.get(&solid.name).cloned().or_else(|| BodyKind::suggested(solid));
        let kinds: Vec<Option<BodyKind>> = welded.solids.iter().map(kind).collect();
        let notes: Vec<(String, Option<BodyKind>, String)> = welded
            .solids
            .iter()
            .zip(&welded.n_triangles)
            .zip(&kinds)
            .map(|((solid, n), kind)| {
                let material = if solid.material_name.is_empty() { "none" } else { &solid.material_name };
                (solid.name.clone(), kind.clone(), format!("{n} triangles; material in the file: {material}"))
            })
            .collect();
        ScrollArea::vertical().id_salt("body list").max_height(LIST_HEIGHT).show(ui, |ui| {
            if let Some((k, kind)) = body_rows(ui, &notes, &self.own) {
                self.chosen.insert(notes[k].0.clone(), kind);
            }
        });
        let [lo, hi] = welded.draft.bounds;
        let [x, y, z] = (hi - lo).to_array();
        ui.label(format!("{} bodies, {x:.3} × {y:.3} × {z:.3} mm in all", welded.solids.len()));
        match &welded.spec {
            Ok(spec) => {
                let shared = spec.to_plc().n_shared_facets();
                ui.label(RichText::new(format!("All closed; {shared} facets shared")).color(Tokens::here(ui).good));
                let bodies = welded.solids.iter().zip(kinds);
                let bodies = bodies.map(|(solid, kind)| Some(BodySpec { name: solid.name.clone(), kind: kind? }));
                let bodies = bodies.collect::<Option<Vec<_>>>();
                if bodies.is_none() {
                    ui.label(RichText::new("Say what each body is made of.").weak());
                }
                Some(BodiesSpec { bodies: bodies?, ..spec.clone() })
            }
            Err(faults) => {
                ScrollArea::vertical().id_salt("faults").max_height(LIST_HEIGHT).show(ui, |ui| {
                    for fault in faults {
                        ui.add(egui::Label::new(RichText::new(fault.to_string()).color(error)).wrap());
                        places::list(ui, &draft::places_mm(fault), state);
                    }
                });
                None
            }
        }
    }
}

fn welded(asked: &Asked, task: &Task) -> Found {
    let unit = LENGTH_UNITS[asked.unit].1;
    let mut solids = Vec::new();
    let phase = task.phase("reading files", asked.files.len());
    for path in &asked.files {
        task.check().map_err(|cancelled| cancelled.to_string())?;
        phase.advance(1);
        solids.extend(read(path, unit).map_err(|error| error.to_string())?);
    }
    name_plainly(&mut solids);
    let n_triangles = solids.iter().map(|s| s.surface.faces.len()).collect();
    let mut draft = Draft::new(solids.iter().map(|s| &s.surface));
    let loose: Vec<LooseBody> = solids
        .iter_mut()
        .map(|solid| LooseBody {
            spec: BodySpec { name: solid.name.clone(), kind: BodyKind::Metal },
            surface: std::mem::take(&mut solid.surface),
        })
        .collect();
    let spec = match BodiesSpec::weld(&loose, asked.weld_mm, task) {
        Ok(spec) => Ok(spec),
        Err(WeldError::Faults(faults)) => {
            draft.places_mm = faults.iter().flat_map(draft::places_mm).collect();
            Err(faults)
        }
        Err(WeldError::Cancelled(cancelled)) => return Err(cancelled.to_string()),
    };
    Ok(Welded { solids, n_triangles, draft, spec })
}
