//! `import`: bodies of other programs, checked, welded, and made a project.

use super::args::ImportArgs;
use super::report::table;
use crate::antenna::{BodyFault, WeldError};
use crate::io::bodies::{Solid, name_plainly, read};
use crate::io::outline::LENGTH_UNITS;
use crate::pipeline::Scene;
use crate::project::{BodiesSpec, BodyKind, BodySpec, Edit, LooseBody, MaterialSpec, Project, file};
use crate::task::Task;
use crate::units::to_mm;
use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;

/// What `import --json` prints.
#[derive(Debug, Serialize)]
struct Report {
    bodies: Vec<BodyReport>,
    /// Facets that two bodies have in common.
    shared_facets: usize,
    /// Everything that stands against welding; empty if nothing does.
    faults: Vec<FaultReport>,
    /// The project file, if one was written.
    project: Option<String>,
}

#[derive(Debug, Serialize)]
struct BodyReport {
    name: String,
    /// As in the project file.
    kind: BodyKind,
    triangles: usize,
    volume_mm3: f64,
}

#[derive(Debug, Serialize)]
struct FaultReport {
    message: String,
    places_mm: Vec<[f64; 3]>,
}

pub(super) fn run(args: &ImportArgs, task: &Task) -> Result<()> {
    if let Some(out) = &args.out {
        let name = out.display();
        ensure!(args.force || !out.exists(), "{name} exists: choose another name, or --force to replace it");
    }
    let loose = with_kinds(solids(args)?, args)?;
    let mut report = Report {
        bodies: loose.iter().map(BodyReport::of).collect(),
        shared_facets: 0,
        faults: Vec::new(),
        project: args.out.as_ref().map(|out| out.display().to_string()),
    };
    match BodiesSpec::weld(&loose, args.weld, task) {
        Ok(bodies) => {
            let bodies = fed(bodies, args)?;
            let plc = bodies.to_plc();
            report.shared_facets = plc.n_shared_facets();
            for (body, (id, _)) in report.bodies.iter_mut().zip(plc.solids()) {
                let surface = plc.boundary(id);
                (body.triangles, body.volume_mm3) = (surface.faces.len(), surface.volume() * to_mm(1.0).powi(3));
            }
            let mut project = Project::default();
            Edit::SetBodies(Some(Box::new(bodies))).apply(&mut project)?;
            Scene::new(&project)?;
            if let Some(out) = &args.out {
                file::write(out, &project)?;
            }
        }
        Err(WeldError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(WeldError::Faults(faults)) => {
            report.project = None;
            report.faults = faults.iter().map(FaultReport::of).collect();
        }
    }
    if args.json {
        super::print(&serde_json::to_string_pretty(&report)?)?;
    } else if report.faults.is_empty() {
        super::print(&report.text())?;
    }
    let faults: Vec<&str> = report.faults.iter().map(|f| f.message.as_str()).collect();
    ensure!(faults.is_empty(), "the bodies cannot be welded:\n  {}", faults.join("\n  "));
    Ok(())
}

/// The bodies with the feed asked for, if any.
fn fed(bodies: BodiesSpec, args: &ImportArgs) -> Result<BodiesSpec> {
    match args.feed[..] {
        [] => Ok(bodies),
        [x, y] => Ok(bodies.with_upright_feed([x, y], args.feed_ohm)?),
        [a, b, c, d, e, f] => Ok(bodies.with_feed([[a, b, c], [d, e, f]], args.feed_ohm)?),
        _ => bail!("--feed takes two numbers (X,Y) or six (X,Y,Z,X,Y,Z)"),
    }
}

fn solids(args: &ImportArgs) -> Result<Vec<Solid>> {
    let unit = LENGTH_UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(&args.unit));
    let names = LENGTH_UNITS.map(|(known, _)| known).join(", ");
    let (_, unit) = unit.with_context(|| format!("--unit takes one of {names}, not \"{}\"", args.unit))?;
    let mut solids = Vec::new();
    for path in &args.files {
        solids.extend(read(path, *unit)?);
    }
    name_plainly(&mut solids);
    Ok(solids)
}

/// Each body with what it is made of: as told, else as its file says.
fn with_kinds(solids: Vec<Solid>, args: &ImportArgs) -> Result<Vec<LooseBody>> {
    let mut told: Vec<(String, BodyKind)> = args.metal.iter().map(|name| (name.clone(), BodyKind::Metal)).collect();
    for text in &args.dielectric {
        told.push(dielectric(text)?);
    }
    let is_called = |solid: &Solid, name: &str| {
        solid.name.eq_ignore_ascii_case(name) || solid.material_name.eq_ignore_ascii_case(name)
    };
    let described = |s: &Solid| match s.material_name.is_empty() {
        true => s.name.clone(),
        false => format!("{} (material {})", s.name, s.material_name),
    };
    let all = solids.iter().map(described).collect::<Vec<_>>().join(", ");
    if let Some((name, _)) = told.iter().find(|(name, _)| !solids.iter().any(|s| is_called(s, name))) {
        bail!("no body is called \"{name}\", and none has a material of that name: there are {all}");
    }
    let kind_of = |solid: &Solid| {
        let told = told.iter().find(|(name, _)| is_called(solid, name)).map(|(_, kind)| kind.clone());
        told.or_else(|| BodyKind::suggested(solid))
    };
    let nameless: Vec<String> = solids.iter().filter(|s| kind_of(s).is_none()).map(described).collect();
    ensure!(
        nameless.is_empty(),
        "say what these bodies are made of, by --metal NAME or --dielectric NAME=EPS_R,TAN_DELTA: {}",
        nameless.join(", ")
    );
    let loose = |solid: Solid| {
        let kind = kind_of(&solid).unwrap_or(BodyKind::Metal);
        LooseBody { spec: BodySpec { name: solid.name, kind }, surface: solid.surface }
    };
    Ok(solids.into_iter().map(loose).collect())
}

/// A dielectric as typed: `base=2.2` or `base=2.2,0.001`.
fn dielectric(text: &str) -> Result<(String, BodyKind)> {
    let numbers = |values: &str| {
        let (eps_r, tan_delta) = values.split_once(',').unwrap_or((values, "0"));
        Some((eps_r.trim().parse().ok()?, tan_delta.trim().parse().ok()?))
    };
    let (name, (eps_r, tan_delta)) = text
        .rsplit_once('=')
        .and_then(|(name, values)| Some((name, numbers(values)?)))
        .with_context(|| format!("--dielectric takes NAME=EPS_R or NAME=EPS_R,TAN_DELTA, not \"{text}\""))?;
    let material = MaterialSpec { name: String::new(), eps_r, tan_delta }.recognized();
    Ok((name.to_owned(), BodyKind::Dielectric(material)))
}

impl BodyReport {
    fn of(body: &LooseBody) -> Self {
        let (name, kind) = (body.spec.name.clone(), body.spec.kind.clone());
        Self { name, kind, triangles: body.surface.faces.len(), volume_mm3: body.surface.volume() * to_mm(1.0).powi(3) }
    }
}

impl FaultReport {
    fn of(fault: &BodyFault) -> Self {
        let places_mm = fault.places().iter().map(|p| p.to_array().map(to_mm)).collect();
        Self { message: fault.to_string(), places_mm }
    }
}

impl Report {
    fn text(&self) -> String {
        let head = ["body", "material", "triangles", "volume"].map(str::to_owned).to_vec();
        let row = |b: &BodyReport| {
            vec![b.name.clone(), b.kind.to_string(), b.triangles.to_string(), format!("{:.6} mm3", b.volume_mm3)]
        };
        let rows: Vec<_> = std::iter::once(head).chain(self.bodies.iter().map(row)).collect();
        let welded = format!("all closed; welded, with {} facets shared", self.shared_facets);
        let mut parts = vec![table(&rows), String::new(), welded];
        parts.extend(self.project.as_ref().map(|p| format!("wrote {p}")));
        parts.join("\n")
    }
}
