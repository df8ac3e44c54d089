//! One self-contained HTML page on a project: what was decided, what was computed of it, and what was not.
//!
//! Enters: a [`Contents`] of plain values, each with whether it still belongs to the project as it is. Leaves: one
//! text ([`html()`]) with all pictures inlined, no script and no reference to anything outside, to be read in any
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
mod tests {
    use super::*;
    use crate::io::{ExportOptions, certify};
    use crate::pipeline::deform;
    use crate::pipeline::made_up::made_up;
    use crate::project::{BendPlane, PresetEntry, PresetSpec, RuleSpec};
    use crate::task::Task;
    use crate::units::GHZ;

    fn bent() -> Project {
        let preset =
            PresetSpec::Bend { plane: BendPlane::H, radius_mm: 12.5, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        let mut project = Project { presets: vec![PresetEntry { enabled: true, preset }], ..Project::default() };
        project.cage.segments = [10, 1];
        project.hand_edits.insert(3, [0.125, 0.0, -0.25]);
        project
    }

    /// Follows every tag of the page: each is closed by its own end, all attributes are quoted.
    fn check_tags(html: &str) -> usize {
        let body = html.strip_prefix("<!DOCTYPE html>").expect("a document");
        let (mut open, mut count) = (Vec::new(), 0);
        let mut rest = body;
        while let Some(start) = rest.find('<') {
            let end = start + rest[start..].find('>').expect("a tag has an end");
            let tag = &rest[start + 1..end];
            rest = &rest[end + 1..];
            count += 1;
            assert!(!tag.contains('<'), "a mark within a tag: <{tag:.80}");
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(name), "the end of the tag that is open");
                continue;
            }
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes of <{tag:.80}>");
            let name = tag.split(|c: char| c.is_whitespace() || c == '/').next().expect("a name");
            if !tag.ends_with('/') {
                open.push(name);
            }
            if name == "style" {
                rest = &rest[rest.find("</style>").expect("the style sheet ends")..];
            }
        }
        assert!(open.is_empty(), "left open: {open:?}");
        count
    }

    fn assert_closed(html: &str) {
        for outside in ["http:", "https:", "url(", "<link", "<script", "@import", "src=\"/", "href="] {
            assert!(!html.contains(outside), "a reference to the outside: {outside}");
        }
        assert_eq!(html.matches("src=").count(), html.matches("src=\"data:image/png;base64,").count(), "inlined");
    }

    #[test]
    fn the_page_is_well_formed_self_contained_and_holds_the_numbers() {
        let project = bent();
        let deformed = deform(&project, &Task::default()).unwrap();
        let certificate = certify(&deformed.surface(), &ExportOptions::default()).unwrap();
        let volume = format!("{:.4}", certificate.solids[0].shape.volume_mm3);
        let result = RunResult { patterns: Vec::new(), ..made_up(11.0 * GHZ) };
        let (new, old) = (result.clone(), result);
        let contents = Contents {
            name: "wrist <b>& \"co\"".to_owned(),
            project: &project,
            deformed: Ok(&deformed),
            certificate: Ok(certificate),
            mesh: Err("none was made".to_owned()),
            runs: vec![
                RunContents { name: "flat".to_owned(), result: &old, is_stale: true },
                RunContents { name: "bent, <raw>".to_owned(), result: &new, is_stale: false },
            ],
            pictures: vec![Image { caption: "From \"above\"".to_owned(), png: vec![137, 80, 78, 71] }],
        };
        let html = html(&contents).unwrap();
        assert!(check_tags(&html) > 200, "a whole page");
        assert_closed(&html);
        assert!(html.contains("<h1>wrist &lt;b&gt;&amp; &quot;co&quot;</h1>") && !html.contains("<raw>"), "escaped");
        let f = deformed.figures.as_ref().expect("the template's");
        let numbers = [
            format!("{:+.2} %", 100.0 * f.rho_patch),
            format!("{:.3} mm", f.length * 1e3),
            format!("{:.4} GHz", new.resonance.unwrap().freq / GHZ),
            "12.5 mm".to_owned(),
            "+0.125".to_owned(),
            "12345".to_owned(),
            volume,
        ];
        for number in numbers {
            assert!(html.contains(&number), "{number} is told");
        }
        for word in ["flat (out of date)", "Crossing triangles", "No mesh: none was made", "No far field", "Iteration"]
        {
            assert!(html.contains(word), "{word}");
        }
        assert_eq!(html.matches("<svg").count(), 2, "reflection and Smith chart");
        assert!(html.contains("base64,iVBORw=="), "the picture");
    }

    #[test]
    fn what_is_missing_is_said() {
        let project = Project::default();
        let nothing = Contents {
            name: "empty".to_owned(),
            project: &project,
            deformed: Err("it is refused: R < 3 mm".to_owned()),
            certificate: Err("there is no geometry".to_owned()),
            mesh: Err("none was made".to_owned()),
            runs: Vec::new(),
            pictures: Vec::new(),
        };
        let html = html(&nothing).unwrap();
        check_tags(&html);
        assert_closed(&html);
        assert!(html.contains("it is refused: R &lt; 3 mm"), "why");
        assert_eq!(html.matches("not computed</span>").count(), 6, "each part says so");
    }
}
