//! Unsaved work, kept where a crash leaves it.
//!
//! A window with unsaved changes owns a folder and writes its project there some seconds after each change: `project.json`
//! (a project file as any other), `about.json` (the file that it belongs to) and `lock`, which is held locked while the
//! process lives; the system lets go of it however the process ends. So a folder whose lock can be taken was left by a
//! window that is gone, and no two windows can offer the same one. Saving, undoing to the saved state and quitting
//! remove the folder. Not handled: a disk that is full when the work is lost; the message says so before.

use crate::io::document;
use crate::project::{Project, file};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

const FORMAT: &str = "conformant-recovery";
const VERSION: u32 = 1;

/// How long changes wait before they are written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// So that a row of quick changes is written once.
    pub(super) rest: Duration,
    /// A gesture under way is waited for this long: with the time to write, at most ten seconds are lost.
    pub(super) longest: Duration,
}

impl Default for Pace {
    fn default() -> Self {
        Self { rest: Duration::from_secs(5), longest: Duration::from_secs(9) }
    }
}

/// What is kept beside the project.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct About {
    file: Option<PathBuf>,
}

/// A folder whose lock this process holds.
#[derive(Debug)]
struct Slot {
    folder: PathBuf,
    _lock: File,
}

impl Slot {
    fn make(root: &Path) -> io::Result<Self> {
        fs::create_dir_all(root)?;
        let folder = tempfile::Builder::new().prefix("window-").tempdir_in(root)?.keep();
        let lock = File::create(folder.join("lock"))?;
        lock.lock()?;
        Ok(Self { folder, _lock: lock })
    }

    /// Takes over what another window left; `None` while that window lives, or if there is nothing in it.
    fn take(folder: PathBuf) -> Option<Self> {
        let lock = File::open(folder.join("lock")).ok()?;
        lock.try_lock().ok()?;
        let slot = Self { folder, _lock: lock };
        slot.project_file().is_file().then_some(slot)
    }

    fn project_file(&self) -> PathBuf {
        self.folder.join("project.json")
    }

    /// Removes the folder; the project first, so that nobody can take it for unsaved work.
    fn remove(self) -> io::Result<()> {
        let (project, folder) = (self.project_file(), self.folder.clone());
        if project.exists() {
            fs::remove_file(project)?;
        }
        // Some systems do not remove a folder with an open file.
        drop(self);
        fs::remove_dir_all(folder)
    }
}

/// Unsaved work of a window that is gone.
#[derive(Debug)]
pub(super) struct Found {
    slot: Slot,
    /// The file that the project belongs to, if it had one.
    pub(super) file: Option<PathBuf>,
    /// When it was written.
    written: SystemTime,
}

impl Found {
    /// Name for the user.
    pub(super) fn name(&self) -> String {
        let name = self.file.as_ref().and_then(|f| f.file_name());
        name.map_or_else(|| "A project that was never saved".to_owned(), |n| n.to_string_lossy().into_owned())
    }

    /// Whether its file was saved after it was written, and so may hold newer work.
    pub(super) fn is_outdated(&self) -> bool {
        let saved = self.file.as_ref().and_then(|file| fs::metadata(file).and_then(|m| m.modified()).ok());
        saved.is_some_and(|saved| saved > self.written)
    }

    /// How long ago it was written.
    pub(super) fn age(&self) -> String {
        ago(self.written.elapsed().unwrap_or_default())
    }

    /// The project.
    pub(super) fn project(&self) -> Result<Project, file::FileError> {
        file::read(&self.slot.project_file())
    }

    /// Removes it for good.
    pub(super) fn discard(self) -> io::Result<()> {
        self.slot.remove()
    }
}

/// A time span in words, one unit.
fn ago(span: Duration) -> String {
    let seconds = span.as_secs();
    let (count, unit) = match seconds {
        0..60 => return "less than a minute ago".to_owned(),
        60..3600 => (seconds / 60, "minute"),
        3600..86_400 => (seconds / 3600, "hour"),
        _ => (seconds / 86_400, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}

/// What the window knows of its project at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment<'a> {
    pub(super) now: Instant,
    pub(super) project: &'a Project,
    pub(super) file: Option<&'a Path>,
    pub(super) is_dirty: bool,
    pub(super) in_gesture: bool,
}

/// Keeps the unsaved work of one window.
#[derive(Debug, Default)]
pub(super) struct Recovery {
    /// Where all windows keep theirs; nothing is kept where there is no such place.
    root: Option<PathBuf>,
    pub(super) pace: Pace,
    own: Option<Slot>,
    /// The project last written or being written.
    written: Option<Project>,
    /// Since when there are changes that are not written.
    since: Option<Instant>,
    writing: Option<JoinHandle<Result<(), String>>>,
    has_failed: bool,
    /// What other windows left, as long as the user has not decided.
    pub(super) found: Vec<Found>,
}

impl Recovery {
    /// Keeps unsaved work below `root`, and looks for what was left there.
    pub(super) fn new(root: Option<PathBuf>) -> Self {
        let mut found = root.as_deref().map(look).unwrap_or_default();
        found.sort_by_key(|f| std::cmp::Reverse(f.written));
        Self { root, found, ..Self::default() }
    }

    /// Writes what is due; returns how long until something may be, and what the user must be told.
    pub(super) fn tick(&mut self, moment: Moment<'_>) -> (Option<Duration>, Option<String>) {
        let Some(root) = self.root.clone() else { return (None, None) };
        let said = self.collect();
        if !moment.is_dirty {
            return (None, said.or(self.clear()));
        }
        if self.written.as_ref() == Some(moment.project) {
            self.since = None;
            return (None, said);
        }
        let since = *self.since.get_or_insert(moment.now);
        let wait = if moment.in_gesture { self.pace.longest } else { self.pace.rest };
        let due = (since + wait).saturating_duration_since(moment.now);
        if !due.is_zero() || self.writing.is_some() {
            return (Some(due.max(Duration::from_millis(100))), said);
        }
        let started = self.write(&root, moment);
        (None, said.or(started.err().and_then(|error| self.fail(&error.to_string()))))
    }

    fn write(&mut self, root: &Path, moment: Moment<'_>) -> io::Result<()> {
        if self.own.is_none() {
            self.own = Some(Slot::make(root)?);
        }
        let folder = self.own.as_ref().map(|slot| slot.folder.clone()).unwrap_or_default();
        let about = About { file: moment.file.map(Path::to_owned) };
        let project = moment.project.clone();
        (self.written, self.since) = (Some(project.clone()), None);
        // Not here: the disk may be slow, and the file is only done when it is on the disk.
        let work = move || {
            document::write(&folder.join("about.json"), FORMAT, VERSION, &about).map_err(|e| e.to_string())?;
            file::write(&folder.join("project.json"), &project).map_err(|e| e.to_string())
        };
        self.writing = Some(std::thread::Builder::new().name("autosave".to_owned()).spawn(work)?);
        Ok(())
    }

    /// Takes the outcome of the writing, if it is over.
    fn collect(&mut self) -> Option<String> {
        let writing = self.writing.take_if(|writing| writing.is_finished())?;
        self.join(writing)
    }

    fn join(&mut self, writing: JoinHandle<Result<(), String>>) -> Option<String> {
        match writing.join().unwrap_or_else(|_| Err("the writing broke off".to_owned())) {
            Ok(()) => {
                self.has_failed = false;
                None
            }
            Err(error) => self.fail(&error),
        }
    }

    /// Tries again later; said once.
    fn fail(&mut self, error: &str) -> Option<String> {
        self.written = None;
        let is_first = !std::mem::replace(&mut self.has_failed, true);
        is_first
            .then(|| format!("Unsaved changes cannot be kept for the case of a crash: {error}. Save the project soon"))
    }

    /// Removes what is kept: there are no unsaved changes, or they are not wanted.
    pub(super) fn clear(&mut self) -> Option<String> {
        (self.since, self.written) = (None, None);
        let said = self.writing.take().and_then(|writing| self.join(writing));
        let own = self.own.take()?;
        let removed = own.remove();
        said.or(removed.err().map(|error| format!("What was kept for the case of a crash cannot be removed: {error}")))
    }

    /// Goes on with the folder of work that was recovered, so that it stays kept.
    pub(super) fn adopt(&mut self, found: Found) {
        let before = self.own.replace(found.slot);
        self.written = None;
        // An empty folder of this window's own is worth no message.
        let _ = before.map(Slot::remove);
    }

    /// Removes what is kept of a window that closes in order; unsaved changes that it was not asked about stay.
    pub(super) fn close(&mut self, is_wanted: bool) {
        if is_wanted {
            let _ = self.writing.take().map(JoinHandle::join);
        } else {
            // Nobody is there any more to be told.
            let _ = self.clear();
        }
    }
}

/// What windows that are gone have left.
fn look(root: &Path) -> Vec<Found> {
    let Ok(entries) = fs::read_dir(root) else { return Vec::new() };
    let found = entries.filter_map(|entry| {
        let slot = Slot::take(entry.ok()?.path())?;
        let written = fs::metadata(slot.project_file()).and_then(|m| m.modified()).ok()?;
        let about: Option<About> = document::read(&slot.folder.join("about.json"), FORMAT, VERSION).ok();
        Some(Found { slot, file: about.and_then(|a| a.file), written })
    });
    found.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lifted(mm: f64) -> Project {
        Project { hand_edits: [(3, [0.0, 0.0, mm])].into(), ..Project::default() }
    }

    fn moment(now: Instant, project: &Project) -> Moment<'_> {
        Moment { now, project, file: None, is_dirty: *project != Project::default(), in_gesture: false }
    }

    /// Waits until what is being written is on the disk.
    fn flush(recovery: &mut Recovery) {
        if let Some(writing) = recovery.writing.take() {
            assert_eq!(recovery.join(writing), None, "written");
        }
    }

    #[test]
    fn no_change_waits_longer_than_nine_seconds_even_in_a_gesture() {
        let dir = tempfile::tempdir().expect("a folder");
        let start = Instant::now();
        let mut rng = fastrand::Rng::with_seed(3);
        let mut recovery = Recovery::new(Some(dir.path().to_owned()));
        let (mut project, mut changed, mut in_gesture) = (lifted(1.0), start, false);
        for tenth in 1..1200_u32 {
            let now = start + Duration::from_millis(100) * tenth;
            if rng.u32(0..30) == 0 {
                in_gesture = !in_gesture;
            }
            if rng.u32(0..4) == 0 {
                // Of the changes that are not written, the oldest counts.
                if recovery.written.as_ref() == Some(&project) {
                    changed = now;
                }
                project = lifted(f64::from(tenth));
            }
            recovery.tick(Moment { in_gesture, ..moment(now, &project) });
            flush(&mut recovery);
            if recovery.written.as_ref() != Some(&project) {
                assert!(now - changed < recovery.pace.longest, "{:?} at {tenth}", now - changed);
            }
        }
        assert!(recovery.own.is_some(), "something was written");
    }

    #[test]
    fn quick_changes_are_written_once_and_saving_removes_them() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut recovery = Recovery::new(Some(dir.path().to_owned()));
        let start = Instant::now();
        let [first, second] = [lifted(1.0), lifted(2.0)];
        let (wait, _) = recovery.tick(moment(start, &first));
        assert_eq!(wait, Some(recovery.pace.rest), "not at once");
        recovery.tick(moment(start + Duration::from_secs(4), &second));
        assert!(recovery.own.is_none(), "not yet");
        assert_eq!(recovery.tick(moment(start + recovery.pace.rest, &second)), (None, None), "then the newest");
        flush(&mut recovery);
        let kept = recovery.own.as_ref().expect("a folder").project_file();
        assert_eq!(file::read(&kept).expect("readable"), second, "as it is now");
        recovery.tick(moment(start + Duration::from_secs(6), &Project::default()));
        assert_eq!(fs::read_dir(dir.path()).expect("readable").count(), 0, "nothing is left");
    }

    #[test]
    fn what_a_window_left_is_offered_to_one_other_and_only_after_its_end() {
        let dir = tempfile::tempdir().expect("a folder");
        let elsewhere = tempfile::tempdir().expect("another folder");
        let root = || Some(dir.path().to_owned());
        let mut window = Recovery::new(root());
        window.pace = Pace { rest: Duration::ZERO, longest: Duration::ZERO };
        let project = lifted(1.0);
        let file = elsewhere.path().join("bent.json");
        window.tick(Moment { file: Some(&file), ..moment(Instant::now(), &project) });
        flush(&mut window);
        assert!(Recovery::new(root()).found.is_empty(), "the window still lives");
        window.close(true);
        drop(window);
        let mut heir = Recovery::new(root());
        assert_eq!(heir.found.len(), 1, "left behind");
        assert!(Recovery::new(root()).found.is_empty(), "held by the window that offers it");
        let found = heir.found.remove(0);
        assert_eq!((found.name(), found.age()), ("bent.json".to_owned(), "less than a minute ago".to_owned()));
        assert_eq!(found.project().expect("readable"), project, "the work");
        assert!(!found.is_outdated(), "its file was not even saved");
        fs::write(&file, "newer").expect("writable");
        File::options()
            .write(true)
            .open(&file)
            .and_then(|f| f.set_modified(found.written + Duration::from_secs(1)))
            .expect("dated");
        assert!(found.is_outdated(), "its file was saved later");
        heir.adopt(found);
        assert!(Recovery::new(root()).found.is_empty(), "kept by the heir from now on");
        heir.close(false);
        assert!(Recovery::new(root()).found.is_empty(), "gone when it closes in order");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told_once() {
        let dir = tempfile::tempdir().expect("a folder");
        let blocked = dir.path().join("file");
        fs::write(&blocked, "x").expect("writable");
        let mut recovery = Recovery::new(Some(blocked));
        recovery.pace.rest = Duration::ZERO;
        let (_, said) = recovery.tick(moment(Instant::now(), &lifted(1.0)));
        assert!(said.is_some_and(|s| s.contains("Save the project")), "told");
        let (_, said) = recovery.tick(moment(Instant::now(), &lifted(2.0)));
        assert_eq!(said, None, "once");
    }

    #[test]
    fn ages_are_told_in_one_unit() {
        for (seconds, text) in [(3, "less than a minute ago"), (60, "1 minute ago"), (7300, "2 hours ago")] {
            assert_eq!(ago(Duration::from_secs(seconds)), text);
        }
        assert_eq!(ago(Duration::from_secs(86_400 * 5)), "5 days ago");
    }
}
