//! The open project with what is computed from it: history, worker, and the last good geometry.
//!
//! Nothing here draws. The window calls [`Session::sync`] once per frame; that collects replies and sends a request if
//! the project differs from the one last sent: a live one during a gesture, a full one at its end. Replies of an old
//! generation are dropped, a refused request leaves the last good geometry on show, and a drag whose result is refused
//! is undone.

use super::hand_edits::micrometres;
use super::play::Play;
use crate::cage::Cage;
use crate::geometry::DVec3;
use crate::pipeline::worker::{Quality, Reply, Worker};
use crate::pipeline::{Deformed, PipelineError};
use crate::project::{Edit, EditError, Example, History, Project};
use crate::task::Progress;
use crate::units::from_mm;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The computed antenna on show and the project it belongs to.
#[derive(Debug)]
pub(super) struct Shown {
    pub(super) deformed: Deformed,
    pub(super) project: Project,
    /// Counts the replies shown, so that pictures know when to change.
    pub(super) serial: u64,
    /// Whether it is a part of the deformation, for looking only.
    is_part: bool,
}

/// The posed cage as drawn.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    pub(super) cage: Arc<Cage>,
    /// Handles, then centers; m.
    pub(super) vertices: Vec<DVec3>,
    /// Counts the changes.
    pub(super) serial: u64,
}

/// Something that happened to the computation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum News {
    /// The project cannot be computed; the last good geometry stays.
    Refused(String),
    /// A drag ended in a pose that is not possible; it was taken back as far as needed.
    TakenBack(String),
}

#[derive(Debug)]
struct Sent {
    project: Project,
    quality: Quality,
    generation: u64,
    answered: bool,
    is_part: bool,
}

/// The open project.
#[derive(Debug)]
pub(super) struct Session {
    history: History,
    /// Its file, once it has one.
    pub(super) path: Option<PathBuf>,
    worker: Worker,
    sent: Option<Sent>,
    shown: Option<Shown>,
    pose: Option<(Project, Pose)>,
    refused: Option<String>,
    /// Where the last refused shape fails, mm; until something is changed.
    places_mm: Vec<[f64; 3]>,
    in_gesture: bool,
    guarded: bool,
    serial: u64,
    play: Play,
}

/// What the window starts with: the paper's antenna, bent so that there is something to see.
#[must_use]
pub(super) fn first_project() -> Project {
    Example::BentH.project()
}

impl Session {
    /// Opens `project`, with its file if it has one.
    pub(super) fn new(project: Project, path: Option<PathBuf>, worker: Worker) -> Self {
        Self {
            history: History::new(project),
            path,
            worker,
            sent: None,
            shown: None,
            pose: None,
            refused: None,
            places_mm: Vec::new(),
            in_gesture: false,
            guarded: false,
            serial: 0,
            play: Play::default(),
        }
    }

    /// A session that shows what was computed elsewhere and computes nothing itself.
    pub(super) fn showing(project: Project, deformed: Deformed) -> Self {
        let shown = Shown { deformed, project: project.clone(), serial: 1, is_part: false };
        Self { shown: Some(shown), ..Self::new(project, None, Worker::spawn(|| ())) }
    }

    /// The project as it is now.
    pub(super) fn project(&self) -> &Project {
        self.history.project()
    }

    /// Undo, redo and whether there are unsaved changes.
    pub(super) fn history(&self) -> &History {
        &self.history
    }

    /// The last good geometry.
    pub(super) fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// The last good geometry if it is that of the project as it is now, computed in full.
    pub(super) fn finished(&self) -> Option<&Deformed> {
        let shown = self.shown.as_ref().filter(|s| s.deformed.is_final && s.project == *self.project());
        shown.map(|s| &s.deformed)
    }

    /// Why the project as it is now cannot be computed.
    pub(super) fn refusal(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// Where the last refused shape fails, mm.
    pub(super) fn places_mm(&self) -> &[[f64; 3]] {
        &self.places_mm
    }

    /// Whether a gesture is under way.
    pub(super) fn in_gesture(&self) -> bool {
        self.in_gesture
    }

    /// Whether an answer is outstanding.
    pub(super) fn is_busy(&self) -> bool {
        self.sent.as_ref().is_some_and(|s| !s.answered)
    }

    /// What the worker is doing.
    pub(super) fn progress(&self) -> Option<Progress> {
        self.worker.progress()
    }

    /// How much of the deformation is shown.
    pub(super) fn play(&self) -> Play {
        self.play
    }

    /// Whether a part of the deformation can be shown: previews go on from one that is computed in full.
    pub(super) fn can_play(&self) -> bool {
        let project = self.project();
        let is_deformed = !project.active_presets().is_empty() || !project.hand_edits.is_empty();
        is_deformed && (self.play.is_on() || self.finished().is_some())
    }

    /// Shows a part of the deformation, if it can be; any change of the project ends that.
    pub(super) fn show(&mut self, play: Play) {
        if self.can_play() && !self.in_gesture {
            self.play = play;
        }
    }

    /// The project as it is looked at.
    fn viewed(&self) -> Project {
        self.project().at_amount(self.play.amount)
    }

    /// Begins a gesture.
    pub(super) fn begin(&mut self) {
        self.play = Play::default();
        self.history.begin();
        self.in_gesture = true;
    }

    /// Ends the gesture; if its result is refused, it is taken back as far as needed: at once to the last good preview
    /// where the preview was refused already, or else when the answer comes.
    pub(super) fn end(&mut self) -> Option<News> {
        let refused = self.refused.take();
        if refused.is_some()
            && let Some(shown) = self.shown.as_ref().filter(|s| !s.is_part)
        {
            let target = shown.project.clone();
            self.head_for(&target);
        }
        self.history.end();
        self.in_gesture = false;
        self.guarded = true;
        refused.map(News::TakenBack)
    }

    /// Calls off the gesture.
    pub(super) fn cancel(&mut self) {
        self.history.cancel();
        self.in_gesture = false;
    }

    /// Changes the project.
    pub(super) fn apply(&mut self, edit: Edit) -> Result<(), EditError> {
        self.guarded = false;
        self.places_mm.clear();
        self.play = Play::default();
        self.history.apply(edit)
    }

    /// One step back.
    pub(super) fn undo(&mut self) {
        self.step(History::undo);
    }

    /// One step forward.
    pub(super) fn redo(&mut self) {
        self.step(History::redo);
    }

    /// Goes to a step of the history, on whatever branch.
    pub(super) fn go_to(&mut self, step: u64) {
        self.step(|history| history.go_to(step));
    }

    fn step(&mut self, step: impl FnOnce(&mut History) -> bool) {
        step(&mut self.history);
        self.places_mm.clear();
        self.play = Play::default();
        self.in_gesture = false;
        self.guarded = false;
    }

    /// Starts over with another project.
    pub(super) fn replace(&mut self, project: Project, path: Option<PathBuf>) {
        self.history.replace(project);
        self.play = Play::default();
        self.path = path;
        self.places_mm.clear();
        self.in_gesture = false;
        self.guarded = false;
        self.refused = None;
        self.shown = None;
        // Even if it is the project sent last: nothing is on show now.
        self.sent = None;
    }

    /// Notes that the project was saved to `path`.
    pub(super) fn mark_saved(&mut self, path: &Path) {
        self.history.mark_saved();
        self.path = Some(path.to_owned());
    }

    /// Name for titles: that of the file, without its ending.
    pub(super) fn name(&self) -> String {
        let stem = self.path.as_ref().and_then(|p| p.file_stem());
        stem.map_or_else(|| "Untitled".to_owned(), |s| s.to_string_lossy().into_owned())
    }

    /// Stops the computation under way; the last good geometry stays.
    pub(super) fn stop_work(&mut self) {
        self.worker.cancel();
        if let Some(sent) = &mut self.sent {
            sent.answered = true;
        }
    }

    /// Collects replies and sends a request if one is due.
    pub(super) fn sync(&mut self) -> Vec<News> {
        let mut news = Vec::new();
        while let Some(reply) = self.worker.poll() {
            news.extend(self.receive(reply));
        }
        self.send();
        news
    }

    fn send(&mut self) {
        let quality = if self.in_gesture || self.play.is_on() { Quality::Live } else { Quality::Full };
        let project = self.viewed();
        if let Some(sent) = &self.sent {
            let same = sent.project == project;
            if same && (sent.quality == quality || quality == Quality::Live) {
                return;
            }
            // A drag makes a project per frame. The next one waits for the answer, or none would ever be finished.
            if !sent.answered && sent.quality == Quality::Live && quality == Quality::Live {
                return;
            }
        }
        let generation = self.worker.request(project.clone(), quality);
        let is_part = self.play.is_on();
        self.sent = Some(Sent { project, quality, generation, answered: false, is_part });
    }

    /// The number of the last request.
    #[cfg(test)]
    pub(super) fn generation(&self) -> Option<u64> {
        self.sent.as_ref().map(|s| s.generation)
    }

    /// Takes an answer of the worker.
    pub(super) fn receive(&mut self, reply: Reply) -> Option<News> {
        let sent = self.sent.as_mut().filter(|s| s.generation == reply.generation && !s.answered)?;
        sent.answered = true;
        match reply.result {
            Ok(deformed) => {
                self.refused = None;
                self.guarded &= sent.quality == Quality::Live;
                self.serial += 1;
                let project = sent.project.clone();
                let is_part = sent.is_part;
                self.shown = Some(Shown { deformed: *deformed, project, serial: self.serial, is_part });
                None
            }
            Err(PipelineError::Cancelled(_)) => None,
            Err(error) => {
                let message = error.to_string();
                self.places_mm = error.places_mm();
                let is_full = sent.quality == Quality::Full;
                if is_full && std::mem::take(&mut self.guarded) && sent.project == *self.history.project() {
                    self.take_back(reply.retreat.as_deref());
                    self.refused = None;
                    return Some(News::TakenBack(message));
                }
                let is_new = self.refused.as_deref() != Some(&message);
                self.refused = Some(message.clone());
                (is_new && is_full).then_some(News::Refused(message))
            }
        }
    }

    /// Takes the last gesture back without a trace, and goes as far in its direction as is possible.
    fn take_back(&mut self, furthest: Option<&Project>) {
        self.history.withdraw();
        if let Some(furthest) = furthest {
            self.history.begin();
            self.head_for(furthest);
            self.history.end();
        }
    }

    /// Takes over the presets and hand edits of another project with the same cage.
    fn head_for(&mut self, other: &Project) {
        let project = self.history.project();
        if other.cage != project.cage
            || other.antenna != project.antenna
            || other.bodies != project.bodies
            || other.settings != project.settings
        {
            return;
        }
        let mut offsets: Vec<(u32, [f64; 3])> = project.hand_edits.keys().map(|&v| (v, [0.0; 3])).collect();
        offsets.extend(other.hand_edits.iter().map(|(&v, offset)| (v, offset.map(micrometres))));
        for edit in [Edit::SetPresets(other.presets.clone()), Edit::MoveVertices(offsets)] {
            self.history.apply(edit).expect("these numbers were part of a valid project with this cage");
        }
    }

    /// The cage to draw: the computed one moved by the hand edits made since, or else the one that presets and hand
    /// edits give; the last possible one where they give none.
    pub(super) fn pose(&mut self) -> Option<&Pose> {
        let project = &self.viewed();
        let shown_serial = self.shown.as_ref().map_or(0, |s| s.serial);
        let is_new = self.pose.as_ref().is_none_or(|(p, pose)| p != project || pose.serial >> 32 != shown_serial);
        if is_new {
            let made = self.shown.as_ref().and_then(|s| moved_since(s, project)).or_else(|| raw_pose(project));
            if let Some((cage, vertices)) = made {
                let count = self.pose.as_ref().map_or(0, |(_, pose)| pose.serial & 0xffff_ffff);
                let serial = (shown_serial << 32) | ((count + 1) & 0xffff_ffff);
                self.pose = Some((project.clone(), Pose { cage, vertices, serial }));
            }
        }
        self.pose.as_ref().map(|(_, pose)| pose)
    }
}

/// The pose that was computed, moved by what the hand edits changed; `None` if anything else of the cage changed.
fn moved_since(shown: &Shown, project: &Project) -> Option<(Arc<Cage>, Vec<DVec3>)> {
    let then = &shown.project;
    let same = then.cage == project.cage
        && then.presets == project.presets
        && then.antenna == project.antenna
        && then.bodies == project.bodies
        && then.settings == project.settings;
    if !same {
        return None;
    }
    let cage = &shown.deformed.cage;
    let mut handles = shown.deformed.posed.clone();
    for (edits, sign) in [(&then.hand_edits, -1.0), (&project.hand_edits, 1.0)] {
        add_offsets(&mut handles, edits.iter(), sign);
    }
    Some((Arc::clone(cage), cage.with_centers(handles)))
}

/// The pose that presets and hand edits give, before any calibration.
fn raw_pose(project: &Project) -> Option<(Arc<Cage>, Vec<DVec3>)> {
    let cage = project.rest_cage().ok()?;
    let mut handles = crate::cage::pose(&cage, &project.active_presets()).ok()?;
    add_offsets(&mut handles, project.hand_edits.iter(), 1.0);
    let vertices = cage.with_centers(handles);
    Some((Arc::new(cage), vertices))
}

fn add_offsets<'a>(handles: &mut [DVec3], edits: impl Iterator<Item = (&'a u32, &'a [f64; 3])>, sign: f64) {
    for (&vertex, &offset_mm) in edits {
        if let Some(handle) = handles.get_mut(vertex as usize) {
            *handle += sign * DVec3::from_array(offset_mm.map(from_mm));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cage::PoseError;
    use crate::task::Task;

    fn session() -> Session {
        Session::new(first_project(), None, Worker::spawn(|| {}))
    }

    fn lift(mm: f64) -> Edit {
        Edit::MoveVertices(vec![(3, [0.0, 0.0, mm])])
    }

    fn reply(session: &Session, late: u64, result: Result<Box<Deformed>, PipelineError>) -> Reply {
        let sent = session.sent.as_ref().expect("a request was sent");
        Reply { generation: sent.generation - late, result, retreat: None }
    }

    #[test]
    fn answers_to_an_older_request_are_dropped() {
        let mut session = session();
        session.send();
        session.apply(lift(0.1)).expect("valid");
        session.send();
        let deformed = crate::pipeline::deform(&first_project(), &Task::default()).expect("the first project");
        let late = reply(&session, 1, Ok(Box::new(deformed.clone())));
        assert_eq!(session.receive(late), None, "no news");
        assert!(session.shown().is_none() && session.is_busy(), "still waiting");
        let fresh = reply(&session, 0, Ok(Box::new(deformed)));
        session.receive(fresh);
        assert!(session.finished().is_some() && !session.is_busy(), "the newest one is shown");
    }

    #[test]
    fn a_refused_drag_is_undone_and_a_refused_number_stays() {
        let refusal = || Err(PipelineError::Pose(PoseError::InsideOut));
        let mut session = session();
        session.begin();
        session.apply(lift(9.0)).expect("valid");
        assert_eq!(session.end(), None, "not yet known");
        session.send();
        let answer = reply(&session, 0, refusal());
        assert!(matches!(session.receive(answer), Some(News::TakenBack(_))), "said");
        assert_eq!(*session.project(), first_project(), "undone");
        session.send();
        session.apply(lift(9.0)).expect("valid");
        session.send();
        let answer = reply(&session, 0, refusal());
        assert!(matches!(session.receive(answer), Some(News::Refused(_))), "said");
        assert_ne!(*session.project(), first_project(), "a typed number stays to be corrected");
        assert!(session.refusal().is_some(), "and the reason stays on show");
    }
}
