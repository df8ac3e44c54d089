//! One self-contained HTML page on a project: what was decided, what was computed of it, and what was not.
//!
//! Enters: a [`Contents`] of plain values, each with whether it still belongs to the project as it is. Leaves: one
//! text ([`html`]) with all pictures inlined, no script and no reference to anything outside, to be read in any
//! browser, printed and kept. All text of the user is escaped; the markup is well-formed as XML. Numbers have their
//! units; what was not computed is said, not left out.
//!
//! Not handled: other languages, and letting the reader sort or filter.

mod html;
mod names;
mod sections;
mod style;

pub use names::{job_name, key_and_unit};

use crate::io::Certificate;
use crate::pipeline::solve_job::RunResult;
use crate::pipeline::{Deformed, Meshed};
use crate::plot::PlotError;
use crate::project::Project;
use html::Page;

/// What the page tells.
#[derive(Clone, Debug)]
pub struct Contents<'a> {
    /// The project's name.
    pub name: String,
    /// The project.
    pub project: &'a Project,
    /// The deformed antenna as the project has it now, or why there is none.
    pub deformed: Result<&'a Deformed, String>,
    /// What was proved of its surfaces, or why nothing could be.
    pub certificate: Result<Certificate, String>,
    /// A mesh, or why there is none.
    pub mesh: Result<MeshContents<'a>, String>,
    /// Solved antennas; those that are out of date say so.
    pub runs: Vec<RunContents<'a>>,
    /// Pictures of the antenna.
    pub pictures: Vec<Image>,
}

/// A mesh with what it was made of.
#[derive(Clone, Debug)]
pub struct MeshContents<'a> {
    /// Shape and density in words.
    pub about: String,
    /// The mesh.
    pub meshed: &'a Meshed,
    /// Whether the project has changed since.
    pub is_stale: bool,
}

/// A solved antenna.
#[derive(Clone, Debug)]
pub struct RunContents<'a> {
    /// What it is called.
    pub name: String,
    /// What came of it.
    pub result: &'a RunResult,
    /// Whether what was solved has changed since.
    pub is_stale: bool,
}

/// A picture as a PNG file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// What it shows.
    pub caption: String,
    /// The file.
    pub png: Vec<u8>,
}

/// The page.
///
/// # Errors
/// [`PlotError`] if a plot cannot be drawn.
pub fn html(contents: &Contents<'_>) -> Result<String, PlotError> {
    let mut page = Page::new(&contents.name);
    sections::summary(&mut page, contents);
    for image in &contents.pictures {
        page.image(image);
    }
    sections::antenna(&mut page, contents.project);
    sections::deformation(&mut page, contents.project);
    sections::certificate(&mut page, contents);
    sections::distortion(&mut page, contents);
    sections::compensation(&mut page, contents);
    sections::mesh(&mut page, contents)?;
    sections::reflection(&mut page, contents)?;
    sections::patterns(&mut page, contents)?;
    Ok(page.finish())
}

#[cfg(test)]
mod tests;
