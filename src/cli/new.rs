//! `new`: from flags to a project file.

use super::args::NewArgs;
use super::choices::Section;
use crate::antenna::{Dielectric, first_guess};
use crate::io::outline::{self, LENGTH_UNITS};
use crate::pipeline::Scene;
use crate::project::materials::{DIELECTRICS, METALS, dielectric_named, metal_named};
use crate::project::{
    AntennaSpec, BendPlane, Edit, MaterialSpec, MetalSpec, PresetEntry, PresetSpec, Project, ResistorSpec, file,
};
use crate::units::{GHZ, from_mm, to_mm};
use anyhow::{Context, Result, bail, ensure};

/// Wanted input resistance of a first guess, ohm.
const RESISTANCE: f64 = 50.0;
/// Bend radius where none is given, mm.
const BEND_RADIUS_MM: f64 = 10.0;
/// Radius of the doubly curved shapes where none is given, mm.
const SECTION_RADIUS_MM: f64 = 20.0;
/// Substrate and ground reach past the patch by this many substrate heights when the patch is sized by frequency.
const MARGIN_HEIGHTS: f64 = 3.0;

pub(super) fn run(args: &NewArgs) -> Result<()> {
    let name = args.file.display();
    ensure!(args.force || !args.file.exists(), "{name} exists: choose another name, or --force to replace it");
    let project = project(args)?;
    // Refuse here what no command could pose; the editor can still be used to go to the limit.
    Scene::new(&project).and_then(|scene| scene.checked_pose()).with_context(|| format!("{name} is not written"))?;
    file::write(&args.file, &project)?;
    let shapes: Vec<String> = project.presets.iter().map(|entry| super::info::preset(entry.preset)).collect();
    let shape = if shapes.is_empty() { "flat".to_owned() } else { shapes.join("; ") };
    let antenna = &project.antenna;
    super::print(&format!("wrote {name}: patch {} x {} mm, {shape}", antenna.width_mm, antenna.length_mm))
}

fn project(args: &NewArgs) -> Result<Project> {
    let mut project = Project::default();
    set_antenna(&mut project, args)?;
    let mut cage = project.cage;
    cage.padding_mm = match args.padding[..] {
        [] => cage.padding_mm,
        [all] => [all; 3],
        [x, y, z] => [x, y, z],
        _ => bail!("--padding takes one number or three (x,y,z)"),
    };
    cage.segments = match args.segments[..] {
        [] => along_the_bend(args, cage.segments[0]),
        [n] => along_the_bend(args, n),
        [x, y] => [x, y],
        _ => bail!("--segments takes one number or two (x,y)"),
    };
    Edit::SetCage(cage).apply(&mut project)?;
    Edit::SetPresets(presets(args)?).apply(&mut project)?;
    Ok(project)
}

/// One number of segments: a plain bend needs them along what curves only, other shapes both ways.
fn along_the_bend(args: &NewArgs, n: usize) -> [usize; 2] {
    match args.bend.filter(|_| args.preset.is_none()).map(BendPlane::from) {
        Some(BendPlane::H) => [n, 1],
        Some(BendPlane::E) => [1, n],
        None => [n, n],
    }
}

/// The materials that can be named, for the help.
pub(super) fn materials() -> String {
    let substrates = DIELECTRICS.map(|d| format!("  {:<28}{:<8}{}", d.name, d.eps_r, d.tan_delta));
    let metals = METALS.map(|m| format!("  {:<28}{}", m.name, m.ohm_per_square));
    format!(
        "Substrates, with permittivity and loss tangent:\n{}\n\nMetals, with ohm per square of the whole sheet:\n{}",
        substrates.join("\n"),
        metals.join("\n")
    )
}

/// What a sheet is made of, as typed: perfect, a name, or ohm per square.
fn metal(typed: &str) -> Result<MetalSpec> {
    if typed.eq_ignore_ascii_case("perfect") {
        return Ok(MetalSpec::Perfect);
    }
    if let Ok(ohm_per_square) = typed.parse() {
        return Ok(MetalSpec::Sheet { name: String::new(), ohm_per_square });
    }
    metal_named(typed).with_context(|| format!("\"{typed}\" names no metal, or several: see conformant new --help"))
}

/// Length of a unit by its name, m.
fn unit(name: &str) -> Result<f64> {
    let found = LENGTH_UNITS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
    let names = LENGTH_UNITS.map(|(known, _)| known).join(", ");
    Ok(found.with_context(|| format!("--unit takes one of {names}, not \"{name}\""))?.1)
}

fn set_materials(antenna: &mut AntennaSpec, args: &NewArgs) -> Result<()> {
    if let Some(name) = &args.substrate {
        antenna.substrate = dielectric_named(name)
            .with_context(|| format!("\"{name}\" names no substrate, or several: see conformant new --help"))?;
    }
    if args.eps_r.is_some() || args.tan_delta.is_some() {
        let MaterialSpec { eps_r, tan_delta, .. } = antenna.substrate;
        let (eps_r, tan_delta) = (args.eps_r.unwrap_or(eps_r), args.tan_delta.unwrap_or(tan_delta));
        antenna.substrate = MaterialSpec { name: String::new(), eps_r, tan_delta }.recognized();
    }
    for (typed, metal_of) in
        [(&args.patch_metal, &mut antenna.patch_metal), (&args.ground_metal, &mut antenna.ground_metal)]
    {
        if let Some(typed) = typed {
            *metal_of = metal(typed)?;
        }
    }
    let (resistors, rest) = args.resistor.as_chunks();
    ensure!(rest.is_empty(), "--resistor takes three numbers, x,y,ohm");
    antenna.resistors = resistors.iter().map(|&[x_mm, y_mm, ohm]| ResistorSpec { x_mm, y_mm, ohm }).collect();
    Ok(())
}

fn set_antenna(project: &mut Project, args: &NewArgs) -> Result<()> {
    let mut antenna = project.antenna.clone();
    antenna.height_mm = args.height.unwrap_or(antenna.height_mm);
    set_materials(&mut antenna, args)?;
    if let Some(freq_ghz) = args.freq {
        let substrate = Dielectric { eps_r: antenna.substrate.eps_r, tan_delta: antenna.substrate.tan_delta };
        let guess = first_guess(freq_ghz * GHZ, substrate, from_mm(antenna.height_mm), RESISTANCE)
            .with_context(|| format!("no first guess for {freq_ghz} GHz"))?;
        // Micrometres are finer than any workshop, and short enough to read.
        let rounded = |length: f64| (to_mm(length) * 1e3).round() / 1e3;
        antenna.width_mm = rounded(guess.width);
        antenna.length_mm = rounded(guess.length);
        antenna.inset_mm = rounded(guess.inset);
        let margin = 2.0 * MARGIN_HEIGHTS * antenna.height_mm;
        antenna.ground_width_mm = antenna.ground_width_mm.max((antenna.width_mm + margin).ceil());
        antenna.ground_length_mm = antenna.ground_length_mm.max((antenna.length_mm + margin).ceil());
    }
    if let Some(drawing) = &args.outline {
        let unit = args.unit.as_deref().map(unit).transpose()?;
        ensure!(args.tolerance > 0.0, "--tolerance must be positive");
        antenna = antenna.with_outline(&outline::read(drawing, unit, from_mm(args.tolerance))?);
    }
    match args.feed[..] {
        [] => {}
        [x, y] => (antenna.feed_offset_mm, antenna.inset_mm) = (x, y + antenna.length_mm / 2.0),
        _ => bail!("--feed takes two numbers, x,y"),
    }
    Ok(Edit::SetAntenna(antenna).apply(project)?)
}

fn presets(args: &NewArgs) -> Result<Vec<PresetEntry>> {
    let mut presets = Vec::new();
    if let Some(plane) = args.bend {
        presets.push(PresetSpec::Bend {
            plane: plane.into(),
            radius_mm: args.radius.unwrap_or(BEND_RADIUS_MM),
            rule: args.rule.into(),
            kept_plane_mm: args.kept_plane,
        });
    }
    if let Some(shape) = args.preset {
        // A radius given for a bend is the bend's.
        let radius_mm = args.radius.filter(|_| args.bend.is_none()).unwrap_or(SECTION_RADIUS_MM);
        let amplitude_mm = args.amplitude.unwrap_or(if shape == Section::Crumple { 1.0 } else { 10.0 });
        let &[along_x, along_y] = &args.waves[..] else { bail!("--waves takes two numbers, x,y") };
        presets.push(match shape {
            Section::Convex => PresetSpec::Convex { radius_mm, amplitude_mm },
            Section::Concave => PresetSpec::Concave { radius_mm, amplitude_mm },
            Section::Saddle => PresetSpec::Saddle { radius_mm, amplitude_mm },
            Section::Twist => PresetSpec::Twist { amplitude_mm, rate_deg_per_mm: args.rate },
            Section::Crumple => PresetSpec::Crumple { amplitude_mm, waves: [along_x, along_y], phase_deg: 0.0 },
        });
    }
    ensure!(
        !presets.is_empty() || args.radius.is_none(),
        "--radius needs a shape: add --bend h, --bend e or --preset convex"
    );
    Ok(presets.into_iter().map(|preset| PresetEntry { enabled: true, preset }).collect())
}
