//! Whether the open file was changed by another program.
//!
//! A thread looks at the file's date and length each second while the window has the focus, and at once when it gets
//! it; only where they differ is the content read and compared by its hash. So the window draws nothing while nothing
//! happens, and a file that was merely touched or saved alike is no change.

use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, SystemTime};

const INTERVAL: Duration = Duration::from_secs(1);

/// A file's state.
#[derive(Clone, Debug)]
pub(super) struct Stamp {
    date: Option<SystemTime>,
    len: u64,
    hash: [u8; 32],
}

impl Stamp {
    /// The state of a file now; `None` if it is not there or cannot be read.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let (date, len) = date_and_len(path)?;
        Some(Self { date, len, hash: Sha256::digest(std::fs::read(path).ok()?).into() })
    }

    /// Whether both hold the same.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.hash == other.hash
    }
}

fn date_and_len(path: &Path) -> Option<(Option<SystemTime>, u64)> {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok(), metadata.len()))
}

#[derive(Debug)]
enum Order {
    Watch(PathBuf, Option<Stamp>),
    Rest,
    Focus(bool),
}

/// A file that is watched.
#[derive(Debug)]
struct Watched {
    path: PathBuf,
    known: Option<Stamp>,
}

impl Watched {
    /// The file's new state, told once; `Some(None)` if it is gone.
    fn look(&mut self) -> Option<Option<Stamp>> {
        if self.known.as_ref().map(|k| (k.date, k.len)) == date_and_len(&self.path) {
            return None;
        }
        let now = Stamp::of(&self.path);
        let is_same = match (&self.known, &now) {
            (Some(known), Some(now)) => known.is_same(now),
            (known, now) => known.is_some() == now.is_some(),
        };
        self.known.clone_from(&now);
        (!is_same).then_some(now)
    }
}

/// Watches the open file.
#[derive(Debug)]
pub(super) struct Disk {
    orders: Sender<Order>,
    seen: Receiver<(PathBuf, Option<Stamp>)>,
    /// The file as it was when it was read or written last.
    known: Option<(PathBuf, Stamp)>,
}

/// What became of the open file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Changed,
    Gone,
}

impl Disk {
    /// Begins to watch, and calls `wake` when there is something to tell.
    pub(super) fn spawn(wake: impl Fn() + Send + 'static) -> Self {
        let (orders, received) = channel();
        let (tell, seen) = channel();
        let work = move || {
            let (mut watched, mut has_focus): (Option<Watched>, _) = (None, true);
            loop {
                let order = if has_focus && watched.is_some() {
                    received.recv_timeout(INTERVAL)
                } else {
                    received.recv().map_err(RecvTimeoutError::from)
                };
                match order {
                    Ok(Order::Watch(path, known)) => watched = Some(Watched { path, known }),
                    Ok(Order::Rest) => watched = None,
                    Ok(Order::Focus(focus)) => has_focus = focus,
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return,
                }
                let Some(watched) = watched.as_mut().filter(|_| has_focus) else { continue };
                if let Some(news) = watched.look() {
                    if tell.send((watched.path.clone(), news)).is_err() {
                        return;
                    }
                    wake();
                }
            }
        };
        // Without the thread a change is still noticed when the file is saved.
        drop(std::thread::Builder::new().name("file watch".to_owned()).spawn(work));
        Self { orders, seen, known: None }
    }

    /// Notes that the file now holds what the window holds, or that there is no file.
    pub(super) fn note(&mut self, path: Option<&Path>) {
        self.known = path.and_then(|p| Some((p.to_owned(), Stamp::of(p)?)));
        self.order(match &self.known {
            Some((path, stamp)) => Order::Watch(path.clone(), Some(stamp.clone())),
            None => Order::Rest,
        });
    }

    /// Looks only while the window has the focus.
    pub(super) fn set_focus(&self, has_focus: bool) {
        self.order(Order::Focus(has_focus));
    }

    fn order(&self, order: Order) {
        // A thread that could not be started takes no orders.
        let _ = self.orders.send(order);
    }

    /// What has become of the open file since it was noted.
    pub(super) fn poll(&self) -> Option<Change> {
        let (path, now) = self.seen.try_iter().last()?;
        // It may have been saved by this window after it was looked at.
        let known = self.known.as_ref().filter(|(p, _)| *p == path)?;
        match now {
            None => (!path.exists()).then_some(Change::Gone),
            Some(now) => (!now.is_same(&known.1)).then_some(Change::Changed),
        }
    }

    /// Whether another program has changed the file since it was noted.
    pub(super) fn has_changed(&self, path: &Path) -> bool {
        let known = self.known.as_ref().filter(|(p, _)| p == path);
        known.is_some_and(|(_, known)| Stamp::of(path).is_some_and(|now| !now.is_same(known)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_content_is_a_change_and_another_date_is_none() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.json");
        std::fs::write(&path, "one").expect("writable");
        let mut watched = Watched { path: path.clone(), known: Stamp::of(&path) };
        assert!(watched.look().is_none(), "nothing happened");
        let file = std::fs::File::options().write(true).open(&path).expect("writable");
        file.set_modified(SystemTime::UNIX_EPOCH).expect("allowed");
        assert!(watched.look().is_none(), "only touched");
        std::fs::write(&path, "two").expect("writable");
        assert!(watched.look().is_some_and(|now| now.is_some()), "changed");
        assert!(watched.look().is_none(), "told once");
        std::fs::remove_file(&path).expect("removable");
        assert!(watched.look().is_some_and(|now| now.is_none()), "gone");
        assert!(watched.look().is_none(), "told once");
    }

    #[test]
    fn the_thread_tells_of_a_change_and_of_no_own_one() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.json");
        std::fs::write(&path, "one").expect("writable");
        let (woken, wakes) = channel();
        let mut disk = Disk::spawn(move || woken.send(()).unwrap_or_default());
        disk.note(Some(&path));
        std::fs::write(&path, "two, saved here").expect("writable");
        disk.note(Some(&path));
        std::fs::write(&path, "three").expect("writable");
        assert!(disk.has_changed(&path), "seen when asked");
        // As the window does when it is switched to: looks at once.
        disk.set_focus(true);
        wakes.recv_timeout(Duration::from_secs(60)).expect("woken");
        let start = std::time::Instant::now();
        let change = loop {
            match disk.poll() {
                Some(change) => break change,
                None => assert!(start.elapsed() < Duration::from_secs(60), "told"),
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        assert_eq!(change, Change::Changed, "by another program");
        disk.note(Some(&path));
        assert!(disk.poll().is_none() && !disk.has_changed(&path), "taken note of");
    }
}
