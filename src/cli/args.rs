//! The arguments: what can be typed, and nothing of what it does.

use super::choices::{
    DensityChoice, ExportShape, Format, MetalChoice, Mode, PaperChoice, Plane, Rule, ScopeChoice, Section, StopChoice,
};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// A cage editor for antennas: bends a flat patch antenna with Green coordinates, gap-free.
#[derive(Debug, Parser)]
#[command(name = "conformant", version, args_conflicts_with_subcommands = true, disable_help_subcommand = true)]
#[command(after_help = "Without a command the editor opens. Exit codes: 0 done, 1 failed, 2 wrong usage, \
    3 `verify` found faults, 130 cancelled.")]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    /// Project to open in the editor
    pub(super) file: Option<PathBuf>,
}

/// What to do without the window.
#[derive(Debug, Subcommand)]
#[allow(clippy::large_enum_variant, reason = "made once")]
pub enum Command {
    /// Write a new project file
    New(NewArgs),
    /// Check and weld closed bodies of other programs, and make a project of them
    Import(ImportArgs),
    /// Compute the deformed antenna, print its figures and export it with certificate
    Deform(DeformArgs),
    /// Compensate and print the iterations
    Compensate(CompensateArgs),
    /// Export geometry with certificate
    Export(ExportArgs),
    /// Mesh the antenna and the air around it with tetrahedra, or any surface complex
    Mesh(MeshArgs),
    /// Solve the field of the antenna and report its reflection
    Solve(SolveArgs),
    /// Solve flat, exact cylinder, uncompensated, WL and isometric in one go, and compare
    Compare(CompareArgs),
    /// Prove an export's certificate anew from its files
    Verify(VerifyArgs),
    /// Write one page on a project, with the results kept beside it: HTML for any browser and for print
    Report(PageArgs),
    /// Compute the surface error over bend radius for many cages, as tables and plots
    Study(StudyArgs),
    /// Say what a project holds and whether it can be posed
    Info(InfoArgs),
    /// Carry points through any closed triangle cage, numbers as they stand
    Apply(ApplyArgs),
}

/// Arguments of `import`.
#[derive(Debug, Args)]
#[command(
    after_help = "Each body must be closed: a solid of an STL file, a group or object of an OBJ file, a node of a \
    binary glTF file. Bodies that touch share their interface afterwards; overlaps and open bodies are refused, with \
    the places."
)]
pub struct ImportArgs {
    /// STL, OBJ or GLB files
    #[arg(required = true)]
    pub(super) files: Vec<PathBuf>,
    /// Unit of STL and OBJ files: mm, cm, m, um, in or mil; glTF is always in metres
    #[arg(long, default_value = "mm")]
    pub(super) unit: String,
    /// A body, or all bodies of a material of this name, is a perfect conductor; may be given several times
    #[arg(long, value_name = "NAME")]
    pub(super) metal: Vec<String>,
    /// A body, or all bodies of a material of this name, is a dielectric; may be given several times
    #[arg(long, value_name = "NAME=EPS_R[,TAN_DELTA]")]
    pub(super) dielectric: Vec<String>,
    /// Distance within which two places become one, mm
    #[arg(long, value_name = "MM", default_value_t = crate::project::WELD_MM)]
    pub(super) weld: f64,
    /// Feed across the lowest gap between two metal bodies above each other at X,Y, or from one place on metal to another
    /// at X,Y,Z,X,Y,Z, mm
    #[arg(long, value_name = "PLACE", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    pub(super) feed: Vec<f64>,
    /// Resistance of the feed's source, ohm
    #[arg(long, value_name = "OHM", default_value_t = 50.0)]
    pub(super) feed_ohm: f64,
    /// Project file to write; without it the bodies are checked only
    #[arg(long, value_name = "JSON")]
    pub(super) out: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    pub(super) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct PageArgs {
    /// Project file
    pub(super) file: PathBuf,
    /// File to write
    #[arg(long, value_name = "HTML")]
    pub(super) out: PathBuf,
    /// Also mesh the deformed antenna, so fine, for its quality
    #[arg(long, value_name = "DENSITY", num_args = 0..=1, default_missing_value = "default")]
    pub(super) mesh: Option<DensityChoice>,
}

/// Arguments of `new`.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true, after_help = super::new::materials())]
pub struct NewArgs {
    /// Project file to write
    pub(super) file: PathBuf,
    /// Bend in the H-plane (x curves) or the E-plane (y curves)
    #[arg(long, value_name = "PLANE")]
    pub(super) bend: Option<Plane>,
    /// Bend radius of the patch's bottom plane, mm; negative bends the other way [default: 10, section shapes 20]
    #[arg(long, value_name = "MM")]
    pub(super) radius: Option<f64>,
    /// How the stations of a bent cage are placed
    #[arg(long, default_value = "tangent")]
    pub(super) rule: Rule,
    /// Height of the plane whose length a bend keeps, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    pub(super) kept_plane: f64,
    /// Distance from the antenna to the cage, mm: one number, or x,y,z
    #[arg(long, value_name = "MM", value_delimiter = ',', num_args = 1)]
    pub(super) padding: Vec<f64>,
    /// Segments of the cage: x,y, or one number, which for a plain bend is along the bend
    #[arg(long, value_name = "N", value_delimiter = ',', num_args = 1)]
    pub(super) segments: Vec<usize>,
    /// Another shape, on top of the bend if there is one
    #[arg(long, value_name = "SHAPE")]
    pub(super) preset: Option<Section>,
    /// Amplitude of the shape, mm [default: 10, crumple 1]
    #[arg(long, value_name = "MM")]
    pub(super) amplitude: Option<f64>,
    /// Rate of the twist, degrees per mm along y
    #[arg(long, value_name = "DEG", default_value_t = 0.573)]
    pub(super) rate: f64,
    /// Waves of the crumple over the cage's extent along x,y
    #[arg(long, value_name = "N", value_delimiter = ',', num_args = 1, default_value = "2,0")]
    pub(super) waves: Vec<f64>,
    /// Size the patch for this frequency, GHz (a first guess)
    #[arg(long, value_name = "GHZ")]
    pub(super) freq: Option<f64>,
    /// Substrate height, mm
    #[arg(long, value_name = "MM")]
    pub(super) height: Option<f64>,
    /// Drawing of the patch's outline, DXF or SVG: its one closed line
    #[arg(long, value_name = "FILE", conflicts_with = "freq")]
    pub(super) outline: Option<PathBuf>,
    /// Unit of the drawing: mm, cm, m, um, in or mil [default: as the file says]
    #[arg(long, requires = "outline")]
    pub(super) unit: Option<String>,
    /// How far straight pieces may leave the drawing's curves, mm
    #[arg(long, value_name = "MM", default_value_t = 0.02)]
    pub(super) tolerance: f64,
    /// Place of the feed from the patch's center, mm
    #[arg(long, value_name = "X,Y", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    pub(super) feed: Vec<f64>,
    /// Substrate by name, listed below; --eps-r and --tan-delta change its values
    #[arg(long, value_name = "NAME")]
    pub(super) substrate: Option<String>,
    /// Relative permittivity of the substrate
    #[arg(long, value_name = "NUMBER")]
    pub(super) eps_r: Option<f64>,
    /// Loss tangent of the substrate
    #[arg(long, value_name = "NUMBER")]
    pub(super) tan_delta: Option<f64>,
    /// What the patch is made of: perfect, a name listed below, or ohm per square
    #[arg(long, value_name = "METAL")]
    pub(super) patch_metal: Option<String>,
    /// What the ground is made of
    #[arg(long, value_name = "METAL")]
    pub(super) ground_metal: Option<String>,
    /// A resistor from ground to patch at a place from the patch's center, mm, and its ohm; may be given several times
    #[arg(long, value_name = "X,Y,OHM", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    pub(super) resistor: Vec<f64>,
    /// Replace the file if it exists
    #[arg(long)]
    pub(super) force: bool,
}

/// Arguments of `deform`.
#[derive(Debug, Args)]
pub struct DeformArgs {
    /// Project file
    pub(super) file: PathBuf,
    /// Compensation, instead of the project's own
    #[arg(long, value_name = "MODE")]
    pub(super) compensate: Option<Mode>,
    /// What WL scales, instead of the project's own choice
    #[arg(long)]
    pub(super) scope: Option<ScopeChoice>,
    /// Export the geometry with certificate into this folder
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `compensate`.
#[derive(Debug, Args)]
pub struct CompensateArgs {
    /// Project file
    pub(super) file: PathBuf,
    /// Compensation, instead of the project's own
    #[arg(long)]
    pub(super) mode: Option<Mode>,
    /// What WL scales, instead of the project's own choice
    #[arg(long)]
    pub(super) scope: Option<ScopeChoice>,
    /// Degrees of the polynomials that measure width and length
    #[arg(long, value_names = ["P", "Q"], num_args = 2)]
    pub(super) orders: Option<Vec<usize>>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Project file
    pub(super) file: PathBuf,
    /// Folder to write into; made where it is missing
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Which geometry
    #[arg(long, default_value = "deformed")]
    pub(super) shape: ExportShape,
    /// Formats; STL is always written, since the certificate rests on it
    #[arg(long, value_delimiter = ',', default_value = "stl,obj,gltf")]
    pub(super) format: Vec<Format>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `mesh`.
#[derive(Debug, Args)]
pub struct MeshArgs {
    /// Project file
    #[arg(required_unless_present = "surface", conflicts_with = "surface")]
    pub(super) file: Option<PathBuf>,
    /// Mesh all regions of this surface complex instead: JSON, as the documentation of `io::surface_json` says
    #[arg(long, value_name = "JSON")]
    pub(super) surface: Option<PathBuf>,
    /// Which of the project's shapes
    #[arg(long, default_value = "deformed", conflicts_with = "surface")]
    pub(super) shape: ExportShape,
    /// How fine
    #[arg(long, default_value = "default")]
    pub(super) density: DensityChoice,
    /// Patch and ground as sheets without thickness, or as bodies of their true thickness
    #[arg(long, default_value = "sheet", conflicts_with = "surface")]
    pub(super) metal: MetalChoice,
    /// Write the mesh into this folder, in every format; made where it is missing
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// How an antenna is solved.
#[derive(Debug, Args)]
pub(super) struct RunArgs {
    /// How fine a mesh is
    #[arg(long, default_value = "default")]
    pub(super) density: DensityChoice,
    /// Lower and upper end of the band, GHz [default: two thirds to four thirds of the patch's cavity resonance]
    #[arg(long, value_names = ["LO", "HI"], num_args = 2)]
    pub(super) band: Option<Vec<f64>>,
    /// When a run stops
    #[arg(long, default_value = "decay")]
    pub(super) stop: StopChoice,
}

/// Arguments of `solve`.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Project file
    pub(super) file: PathBuf,
    /// Which of the project's shapes
    #[arg(long, default_value = "deformed")]
    pub(super) shape: ExportShape,
    #[command(flatten)]
    pub(super) run: RunArgs,
    /// Leave the cells at the edges of sheets as they are: resonances come out too low, by some percent at coarse edges
    #[arg(long)]
    pub(super) no_edge_correction: bool,
    /// Go on where the same run was interrupted
    #[arg(long)]
    pub(super) resume: bool,
    /// Time between checkpoints of a long run, seconds; Ctrl-C leaves one in any case
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub(super) checkpoint_every: u64,
    /// Frequencies whose patterns are gathered and written, GHz [default: 41 over the band are gathered, the one nearest
    /// to the resonance is written]
    #[arg(long, value_name = "F", num_args = 1..)]
    pub(super) pattern_ghz: Vec<f64>,
    /// Write S11 as table, Touchstone and plot, and patterns as tables, plot and far-field source into this folder; made
    /// where it is missing
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Project file; its results are kept beside it
    #[arg(required_unless_present = "paper", conflicts_with = "paper")]
    pub(super) file: Option<PathBuf>,
    /// The paper's antenna instead: bent to 10 and 6.5 mm in both planes, and in the shapes of section VI
    #[arg(long, value_name = "WHICH", num_args = 0..=1, default_missing_value = "all")]
    pub(super) paper: Option<PaperChoice>,
    /// Folder for table, Touchstone files and plots; made where it is missing
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    pub(super) run: RunArgs,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Folder written by an export
    pub(super) dir: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `study`.
#[derive(Debug, Args)]
pub struct StudyArgs {
    /// Folder to write into; made where it is missing
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Project file
    pub(super) file: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `apply`.
#[derive(Debug, Args)]
pub struct ApplyArgs {
    /// Closed triangle cage at rest, OBJ
    #[arg(long, value_name = "OBJ")]
    pub(super) cage: PathBuf,
    /// The same cage posed: same vertices and faces in the same order, OBJ
    #[arg(long, value_name = "OBJ")]
    pub(super) posed: PathBuf,
    /// Points to carry: CSV without header, x,y,z
    #[arg(long, value_name = "CSV")]
    pub(super) points: PathBuf,
    /// Where the carried points go: CSV without header, x,y,z
    #[arg(long, value_name = "CSV")]
    pub(super) out: PathBuf,
    /// Where the weights go: CSV without header, per point phi of each vertex, then psi of each face
    #[arg(long, value_name = "CSV")]
    pub(super) weights: Option<PathBuf>,
}
