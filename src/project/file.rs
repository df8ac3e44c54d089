//! The project file: versioned JSON, read with every doubt and written so that no failure costs the old file.
//!
//! ```json
//! {"format": "conformant-project", "version": 3, "project": {"antenna": {…}, …}}
//! ```
//!
//! Versioning: a reader knows all versions up to [`VERSION`] and refuses newer ones by name. The version goes up when a
//! field is added, removed or changes its meaning; each older version keeps its reader, which brings the value to the
//! present form. Version 2 knew no imported bodies, version 1 no lossy metal, no resistors and no names of materials
//! either: they are read as version 3 is, where what is not said is not there, and materials of the library get their
//! names in version 1. Unknown fields are errors, because dropping them on the next save would lose what the user decided.
//! Numbers are written with the fewest digits that give the same bits back. What is read has passed
//! [`Project::validate`]. Not handled: comments in the file, and two programs saving at the same time (the last wins).

use super::{AntennaSpec, Project, ProjectError};
use crate::io::{self, IoError};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The newest version that this program reads, and the one it writes.
pub const VERSION: u64 = 3;
/// The tag by which a project file is known.
const FORMAT: &str = "conformant-project";
/// A project with every vertex of the finest cage moved takes about a megabyte, the most triangles that can be imported
/// about forty; anything near this limit is no project.
const MAX_BYTES: u64 = 128 << 20;

/// Why a project file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system refuses; names the file.
    #[error(transparent)]
    System(#[from] IoError),
    /// The file is larger than any project.
    #[error("{} is larger than {} MiB: it is not a Conformant project", path.display(), MAX_BYTES >> 20)]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The text is not JSON.
    #[error("{} is not a project file: broken JSON at line {line}, column {column}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the parser expected.
        message: String,
    },
    /// JSON, but without our tag.
    #[error("{} is not a Conformant project: it lacks \"format\": \"{FORMAT}\" and a version", path.display())]
    NotOurs {
        /// The file.
        path: PathBuf,
    },
    /// Written by a later version.
    #[error(
        "{} was made by a newer Conformant, version {version}; this one reads up to {VERSION}: update Conformant to open it",
        path.display()
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its version.
        version: u64,
    },
    /// A field is missing, unknown or of the wrong type.
    #[error("{}, line {line}, column {column}: {field}: {message}", path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// Line, from 1; the end of the innermost object whose kind had to be known first.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// Path of the field.
        field: String,
        /// What is wrong with it.
        message: String,
    },
    /// A value is refused.
    #[error("{}: {source}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Which value, and why.
        source: ProjectError,
    },
}

#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
    #[serde(rename = "project")]
    _project: IgnoredAny,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document<P> {
    format: String,
    version: u64,
    project: P,
}

/// Reads a project file.
///
/// # Errors
/// [`FileError`] naming the file, and line, column and field where that makes sense; never a panic, whatever the file.
pub fn read(path: &Path) -> Result<Project, FileError> {
    let system = |source| IoError::System { action: "read", path: path.to_owned(), source };
    let mut text = Vec::new();
    File::open(path).map_err(system)?.take(MAX_BYTES + 1).read_to_end(&mut text).map_err(system)?;
    parse(path, &text)
}

/// Writes a project file: beside the old one first, then in its place, so that either stands whole at any moment.
///
/// # Errors
/// [`FileError`] if the project is not valid or the system refuses; the old file is untouched then.
pub fn write(path: &Path, project: &Project) -> Result<(), FileError> {
    // NaN and infinity have no JSON: a project that holds them must not reach the disk.
    project.validate().map_err(|source| FileError::Invalid { path: path.to_owned(), source })?;
    let document = Document { format: FORMAT.to_owned(), version: VERSION, project };
    let mut text = serde_json::to_vec_pretty(&document).expect("a valid project has text keys and finite numbers");
    text.push(b'\n');
    Ok(io::write_atomic(path, &text)?)
}

fn parse(path: &Path, text: &[u8]) -> Result<Project, FileError> {
    if text.len() as u64 > MAX_BYTES {
        return Err(FileError::TooLarge { path: path.to_owned() });
    }
    let header: Header = serde_json::from_slice(text).map_err(|error| match error.classify() {
        serde_json::error::Category::Data => FileError::NotOurs { path: path.to_owned() },
        _ => FileError::Syntax {
            path: path.to_owned(),
            line: error.line(),
            column: error.column(),
            message: without_place(&error),
        },
    })?;
    if header.format != FORMAT || header.version == 0 {
        return Err(FileError::NotOurs { path: path.to_owned() });
    }
    if header.version > VERSION {
        return Err(FileError::Newer { path: path.to_owned(), version: header.version });
    }
    let json = &mut serde_json::Deserializer::from_slice(text);
    let mut document: Document<Project> = serde_path_to_error::deserialize(json).map_err(|error| FileError::Field {
        path: path.to_owned(),
        line: error.inner().line(),
        column: error.inner().column(),
        field: error.path().to_string(),
        message: without_place(error.inner()),
    })?;
    if header.version == 1 {
        name_materials(&mut document.project.antenna);
    }
    document.project.validate().map_err(|source| FileError::Invalid { path: path.to_owned(), source })?;
    Ok(document.project)
}

/// Names the materials of an antenna of version 1, which had none, where they are ones of the library.
fn name_materials(antenna: &mut AntennaSpec) {
    for material in [&mut antenna.substrate, &mut antenna.sheath] {
        *material = material.clone().recognized();
    }
}

/// The parser's message without its own " at line 1 column 2".
fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.rfind(" at line ").map_or(message.clone(), |end| message[..end].to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::{
        BendPlane, CompensationMode, MaterialSpec, MetalSpec, PresetEntry, PresetSpec, ResistorSpec, RuleSpec,
        ScopeSpec,
    };
    use super::*;

    fn text(project: &Project) -> String {
        let document = Document { format: FORMAT.to_owned(), version: VERSION, project };
        serde_json::to_string_pretty(&document).unwrap()
    }

    fn message(text: &str) -> String {
        parse(Path::new("a.json"), text.as_bytes()).expect_err("refused").to_string()
    }

    /// A valid project in which every number that may be any is random, with all its digits.
    fn random_project(rng: &mut fastrand::Rng) -> Project {
        let mut project = Project::default();
        for value in [&mut project.antenna.width_mm, &mut project.antenna.length_mm, &mut project.cage.padding_mm[0]] {
            *value *= 0.5 + 0.5 * rng.f64();
        }
        let mut any = |scale: f64| (rng.f64() - 0.5) * scale;
        let presets = [
            PresetSpec::Bend {
                plane: BendPlane::E,
                radius_mm: any(1e3),
                rule: RuleSpec::Arc,
                kept_plane_mm: any(1e-300),
            },
            PresetSpec::Convex { radius_mm: any(1e9), amplitude_mm: any(1.0) },
            PresetSpec::Concave { radius_mm: any(1.0), amplitude_mm: -0.0 },
            PresetSpec::Saddle { radius_mm: any(1.0), amplitude_mm: f64::MIN_POSITIVE / 8.0 },
            PresetSpec::Twist { amplitude_mm: any(1.0), rate_deg_per_mm: any(1.0) },
            PresetSpec::Crumple { amplitude_mm: any(1.0), waves: [any(9.0), any(9.0)], phase_deg: any(360.0) },
        ];
        project.presets = presets.map(|preset| PresetEntry { enabled: any(1.0) > 0.0, preset }).to_vec();
        for vertex in 0..40 {
            project.hand_edits.insert(vertex * 6, [any(1.0), any(1e-8), any(1e5)]);
        }
        project.antenna.patch_metal =
            MetalSpec::Sheet { name: "\u{3b1} \"ink\"".to_owned(), ohm_per_square: 0.5 + any(0.9) };
        project.antenna.ground_metal = MetalSpec::Sheet { name: String::new(), ohm_per_square: 1e-6 };
        project.antenna.resistors = vec![
            ResistorSpec { x_mm: 2.45 + any(0.04), y_mm: any(1e-300), ohm: 50.0 + any(99.0) },
            ResistorSpec { x_mm: -2.45 + any(0.04), y_mm: -0.0, ohm: 1e7 },
        ];
        project.materials = vec![MaterialSpec { name: "my felt".to_owned(), eps_r: 1.5 + any(0.5), tan_delta: 0.02 }];
        project.settings.tolerance_mm = 0.011 + any(1e-3);
        project.settings.compensation = CompensationMode::Wl;
        project.settings.scope = ScopeSpec::Patch;
        project.settings.fit_orders = [rng.usize(1..10), 3];
        project
    }

    #[test]
    fn a_project_comes_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.json");
        let mut rng = fastrand::Rng::with_seed(21);
        for _ in 0..200 {
            let project = random_project(&mut rng);
            write(&path, &project).expect("a valid project in a writable folder");
            let back = read(&path).expect("just written");
            assert_eq!(back, project, "equal");
            // The text spells every bit, down to the sign of zero, so equal texts mean equal bits.
            assert_eq!(text(&back), text(&project), "bit for bit");
        }
    }

    #[test]
    fn a_project_that_is_not_valid_is_not_written_and_the_old_file_stays() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.json");
        write(&path, &Project::default()).expect("valid");
        let mut broken = Project::default();
        broken.settings.tolerance_mm = f64::NAN;
        let error = write(&path, &broken).expect_err("NaN has no JSON");
        assert!(error.to_string().contains("settings.tolerance_mm is NaN"), "{error}");
        assert_eq!(read(&path).expect("still there"), Project::default(), "the old file");
        let nowhere = write(&dir.path().join("none/a.json"), &Project::default()).expect_err("no such folder");
        assert!(nowhere.to_string().contains("cannot write"), "{nowhere}");
    }

    #[test]
    fn a_file_that_is_not_ours_says_so() {
        assert!(matches!(read(Path::new("/nowhere/a.json")), Err(FileError::System(_))), "missing file");
        let newer = r#"{"format": "conformant-project", "version": 7, "project": {"antenna": "other"}}"#;
        assert_eq!(
            message(newer),
            "a.json was made by a newer Conformant, version 7; this one reads up to 3: update Conformant to open it"
        );
        for other in ["{}", "[]", "3", r#"{"format": "else", "version": 1, "project": {}}"#] {
            assert!(message(other).contains("is not a Conformant project"), "{other}");
        }
        assert!(message("{\"format\":\n  \"confor").contains("broken JSON at line 2, column "), "cut short");
        assert!(message("").contains("broken JSON at line 1, column 0"), "empty");
        let deep =
            format!("{{\"format\": \"conformant-project\", \"version\": 1, \"project\": {}", "[".repeat(100_000));
        assert!(message(&deep).contains("broken JSON"), "deep nesting ends in a message");
        let huge = vec![b' '; usize::try_from(MAX_BYTES).unwrap() + 1];
        assert!(matches!(parse(Path::new("a"), &huge), Err(FileError::TooLarge { .. })), "too large");
    }

    #[test]
    fn a_file_of_version_1_is_read_as_an_antenna_without_losses_in_its_metal() {
        let new = text(&Project::default());
        let old = new.replacen("\"version\": 3", "\"version\": 1", 1).replace("\"name\": \"RT/duroid 5880\",", "");
        for unknown in ["metal", "resistors", "materials", "name", "bodies"] {
            assert!(!old.contains(unknown), "version 1 had no {unknown}: {old}");
        }
        let project = parse(Path::new("a"), old.as_bytes()).expect("as version 1 wrote it");
        assert_eq!(project, Project::default(), "perfect metal, no resistors, named materials");
        let other = parse(Path::new("a"), old.replace("2.2", "2.25").as_bytes()).expect("as version 1 wrote it");
        assert_eq!(other.antenna.substrate.name, "", "values of no known material");
    }

    #[test]
    fn a_wrong_field_is_named_with_its_path_line_and_column() {
        let mut project = Project::default();
        project
            .presets
            .push(PresetEntry { enabled: true, preset: PresetSpec::Convex { radius_mm: 20.0, amplitude_mm: 10.0 } });
        project.antenna.ground_metal = MetalSpec::Sheet { name: String::new(), ohm_per_square: 0.05 };
        project.antenna.resistors.push(ResistorSpec { x_mm: 3.0, y_mm: 2.0, ohm: 50.0 });
        let good = text(&project);
        assert!(parse(Path::new("a"), good.as_bytes()).is_ok(), "the text before it is spoiled");
        let faults = [
            ("\"width_mm\": 10.83", "\"width_mm\": \"ten\"", "a.json, line 6, column 23: project.antenna.width_mm: "),
            ("\"width_mm\": 10.83,", "", "project.antenna: missing field `width_mm`"),
            ("\"width_mm\"", "\"breadth_mm\"", "project.antenna.breadth_mm: unknown field `breadth_mm`"),
            ("\"convex\"", "\"concrete\"", "project.presets[0].preset"),
            ("\"radius_mm\": 20.0", "\"radius_mm\": null", "project.presets[0].preset"),
            ("10.83", "1e999", "project.antenna.width_mm: number out of range"),
            ("10.83", "1e300", "a.json: antenna.width_mm is 1"),
            ("\"inset_mm\": 1.75", "\"inset_mm\": 9.0", "a.json: antenna.inset is 9.0000 mm"),
            ("\"x_mm\": 3.0", "\"x_mm\": 6.0", "a.json: antenna.resistors[0] (resistor 1) at (6.0000, 2.0000) mm"),
            ("\"x_mm\": 3.0", "\"x\": 3.0", "project.antenna.resistors[0].x: unknown field `x`"),
            ("\"kind\": \"sheet\"", "\"kind\": \"wool\"", "project.antenna.ground_metal.kind: unknown variant `wool`"),
            ("0.05", "-0.05", "a.json: antenna.ground_metal is -0.05, but must lie between 0.000001 and 1000000"),
        ];
        for (from, to, expected) in faults {
            assert!(good.contains(from), "{from} stands in the text");
            let said = message(&good.replacen(from, to, 1));
            assert!(said.contains(expected), "{from} -> {to}: {said}");
        }
    }
}
