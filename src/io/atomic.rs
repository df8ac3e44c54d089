//! Files that are there whole or not at all.
//!
//! The content goes to a temporary file in the same folder, is flushed to the disk and then takes the place of the old
//! file by a rename. Killed at any moment, the old file is still there and readable; what may be left behind is a
//! temporary file, never a broken one under the name asked for.

use super::IoError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file at once: afterwards `path` holds `bytes`, or what it held before.
///
/// A link is followed; an existing file keeps its permissions.
///
/// # Errors
/// [`IoError::System`] if the folder cannot be written or the disk is full.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    write_atomic_with(path, |out| out.write_all(bytes))
}

/// As [`write_atomic`], with the content written piece by piece.
///
/// # Errors
/// As [`write_atomic`]; an error of `fill` leaves the old file in place.
pub fn write_atomic_with(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), IoError> {
    replace(path, fill).map_err(|source| IoError::System { action: "write", path: path.to_owned(), source })
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".conformant-").suffix(".tmp");
    if let Some(permissions) = permissions(&target) {
        builder.permissions(permissions);
    }
    let mut out = BufWriter::new(builder.tempfile_in(folder)?);
    fill(&mut out)?;
    let temporary = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    temporary.as_file().sync_all()?;
    temporary.persist(&target).map_err(|e| e.error)?;
    // The rename itself lasts once the folder is on the disk; some systems cannot open a folder, which costs only that.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// The old file's permissions, or those that the process gives to any new file.
#[cfg(unix)]
fn permissions(target: &Path) -> Option<fs::Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(fs::metadata(target).map_or_else(|_| fs::Permissions::from_mode(0o666), |m| m.permissions()))
}

#[cfg(not(unix))]
fn permissions(_target: &Path) -> Option<fs::Permissions> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_that_breaks_off_leaves_the_old_file_and_no_other() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.json");
        write_atomic(&path, b"old").unwrap();
        let broken = write_atomic_with(&path, |out| {
            out.write_all(b"new, half")?;
            Err(io::Error::other("power cut"))
        });
        assert!(broken.is_err(), "the failure is reported");
        assert_eq!(fs::read(&path).unwrap(), b"old", "the old file stands");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "no temporary file is left");
        write_atomic(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new", "replaced");
    }

    #[test]
    fn the_message_names_the_path() {
        let error = write_atomic(Path::new("/nowhere/at/all.json"), b"x").unwrap_err();
        assert!(error.to_string().contains("/nowhere/at/all.json"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("shared.json");
        write_atomic(&path, b"1").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write_atomic(&path, b"2").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640, "mode as before");
    }
}
