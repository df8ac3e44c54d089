//! `export` and `verify`: geometry for other programs, and its proof.

use super::args::{ExportArgs, VerifyArgs};
use super::choices::{ExportShape, Format};
use super::report::{ExportReport, table};
use crate::io::{self, ExportOptions, Verification};
use crate::pipeline;
use crate::project::file;
use crate::task::Task;
use anyhow::{Context, Result};
use serde::Serialize;

pub(super) fn export(args: &ExportArgs, task: &Task) -> Result<()> {
    let project = file::read(&args.file)?;
    let name = args.file.display();
    let mut options = ExportOptions {
        obj: args.format.contains(&Format::Obj),
        gltf: args.format.contains(&Format::Gltf),
        ..ExportOptions::default()
    };
    let surface = match args.shape {
        ExportShape::Deformed => {
            let deformed = pipeline::deform(&project, task).with_context(|| format!("deforming {name}"))?;
            options.summary = pipeline::summary(&project, &deformed);
            deformed.surface()
        }
        ExportShape::Flat => pipeline::flat(&project).with_context(|| format!("building {name}"))?,
        ExportShape::Cylinder => {
            pipeline::exact_cylinder(&project, task).with_context(|| format!("bending {name}"))?.with_context(|| {
                format!("{name} has no exact cylinder: only a single bend without hand edits has one")
            })?
        }
    };
    let shape = match args.shape {
        ExportShape::Deformed => "deformed",
        ExportShape::Flat => "flat",
        ExportShape::Cylinder => "exact cylinder",
    };
    options.summary.insert("shape".to_owned(), shape.into());
    let report = ExportReport::new(&args.out, &io::export(&surface, &args.out, &options)?);
    if args.json {
        return super::print(&serde_json::to_string_pretty(&report)?);
    }
    super::print(&report.text())
}

/// What `verify --json` prints.
#[derive(Debug, Serialize)]
struct VerifyReport {
    /// The folder.
    dir: String,
    /// True if every claim of the certificate was proved anew.
    valid: bool,
    solids: Vec<SolidReport>,
    /// Interface facets certified to be shared bit for bit.
    shared_facets: usize,
    findings: Vec<FindingReport>,
}

#[derive(Debug, Serialize)]
struct SolidReport {
    region: String,
    triangles: usize,
    volume_mm3: f64,
    area_mm2: f64,
}

#[derive(Debug, Serialize)]
struct FindingReport {
    file: String,
    fault: String,
}

impl VerifyReport {
    fn new(dir: String, verification: &Verification) -> Self {
        let certificate = &verification.certificate;
        let solid = |s: &io::SolidRecord| SolidReport {
            region: s.material.material.clone(),
            triangles: s.shape.triangles,
            volume_mm3: s.shape.volume_mm3,
            area_mm2: s.shape.area_mm2,
        };
        let finding = |f: &io::Finding| FindingReport { file: f.file.clone(), fault: f.fault.to_string() };
        Self {
            dir,
            valid: verification.is_valid(),
            solids: certificate.solids.iter().map(solid).collect(),
            shared_facets: certificate.n_shared_facets(),
            findings: verification.findings.iter().map(finding).collect(),
        }
    }

    fn text(&self) -> String {
        let head = ["solid", "triangles", "volume", "area"].map(str::to_owned).to_vec();
        let row = |s: &SolidReport| {
            let volume = format!("{:.6} mm3", s.volume_mm3);
            vec![s.region.clone(), s.triangles.to_string(), volume, format!("{:.6} mm2", s.area_mm2)]
        };
        let rows: Vec<_> = std::iter::once(head).chain(self.solids.iter().map(row)).collect();
        if self.valid {
            let proved = format!("{}: proved, {} shared facets, no fault found", self.dir, self.shared_facets);
            return format!("{}\n\n{proved}", table(&rows));
        }
        let faults: Vec<String> = self.findings.iter().map(|f| format!("  {}: {}", f.file, f.fault)).collect();
        let count = self.findings.len();
        let faults_word = if count == 1 { "fault" } else { "faults" };
        format!("{}: {count} {faults_word} found\n{}", self.dir, faults.join("\n"))
    }
}

/// True if the certificate holds.
pub(super) fn verify(args: &VerifyArgs) -> Result<bool> {
    let verification = io::verify(&args.dir)?;
    let report = VerifyReport::new(args.dir.display().to_string(), &verification);
    if args.json {
        super::print(&serde_json::to_string_pretty(&report)?)?;
    } else {
        super::print(&report.text())?;
    }
    Ok(report.valid)
}
