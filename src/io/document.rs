//! Versioned JSON documents: `{"format": …, "version": …, "content": …}`.
//!
//! Any plain value enters and comes back. The tag and the version are looked at before the content, so that a file of
//! another kind or of a later program is named as such. Unknown fields are for the content's own type to refuse.

use super::error::{ParseError, Place, read as read_bytes};
use super::{IoError, write_atomic};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

#[derive(Deserialize)]
struct Header {
    format: String,
    version: u32,
    #[serde(rename = "content")]
    _content: IgnoredAny,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document<T> {
    format: String,
    version: u32,
    content: T,
}

/// Writes a document, whole or not at all; its folder is made where it is missing.
///
/// # Errors
/// [`IoError::System`]; [`IoError::Malformed`] for content that JSON cannot hold.
pub fn write<T: Serialize>(path: &Path, format: &str, version: u32, content: &T) -> Result<(), IoError> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|source| IoError::System {
            action: "create",
            path: folder.to_owned(),
            source,
        })?;
    }
    let document = Document { format: format.to_owned(), version, content };
    let mut text = serde_json::to_vec(&document).map_err(|error| ParseError::json(&error).at(path))?;
    text.push(b'\n');
    write_atomic(path, &text)
}

/// Reads a document of a kind.
///
/// * `version`: the newest one that the content's type can hold.
///
/// # Errors
/// [`IoError`] naming the file, and what in it does not belong.
pub fn read<T: DeserializeOwned>(path: &Path, format: &str, version: u32) -> Result<T, IoError> {
    let text = read_bytes(path)?;
    let header: Header = serde_json::from_slice(&text).map_err(|error| ParseError::json(&error).at(path))?;
    if header.format != format {
        let what = format!("its format is \"{}\", not \"{format}\"", header.format);
        return Err(ParseError::new(Place::File, what).at(path));
    }
    if header.version > version {
        return Err(IoError::TooNew { path: path.to_owned(), found: header.version, known: version });
    }
    let document: Document<T> = serde_json::from_slice(&text).map_err(|error| ParseError::json(&error).at(path))?;
    Ok(document.content)
}

/// The JSON files of a folder, oldest first; none where it cannot be read.
#[must_use]
pub fn by_age(dir: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(dir) else { return Vec::new() };
    let dated = entries.filter_map(|entry| {
        let entry = entry.ok()?;
        Some((entry.metadata().ok()?.modified().ok()?, entry.path()))
    });
    let mut files: Vec<_> = dated.filter(|(_, path)| path.extension().is_some_and(|ending| ending == "json")).collect();
    files.sort();
    files.into_iter().map(|(_, path)| path).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_comes_back_and_other_files_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/a.json");
        let content = vec![0.1, -1e-300, 1.0 / 3.0];
        write(&path, "conformant-test", 2, &content).unwrap();
        assert_eq!(read::<Vec<f64>>(&path, "conformant-test", 2).unwrap(), content, "bit for bit");
        let fails = |text: &str, what: &str| {
            std::fs::write(&path, text).unwrap();
            let message = read::<Vec<f64>>(&path, "conformant-test", 2).unwrap_err().to_string();
            assert!(message.contains("a.json") && message.contains(what), "{text}: {message}");
        };
        fails("{", "not the JSON that belongs here");
        fails(r#"{"format": "other", "version": 1, "content": []}"#, "its format is \"other\"");
        fails(r#"{"format": "conformant-test", "version": 3, "content": []}"#, "format version 3");
        fails(r#"{"format": "conformant-test", "version": 2, "content": ["x"]}"#, "invalid type");
        fails(r#"{"format": "conformant-test", "version": 2, "content": [], "more": 1}"#, "unknown field");
    }
}
