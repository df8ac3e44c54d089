//! Results kept beside their project, found again by a hash of what they were computed from.
//!
//! One versioned JSON file per run, named by the run's key. The key covers what the result depends on and nothing
//! else: antenna, what poses and compensates the shape in question, mesh, band and stop rule, and the version of the
//! solver. Presets that are switched off, and settings that the shape or the compensation does not use, leave it as it
//! is; so the flat antenna's result serves every bend of it.

use super::kept_fields;
use super::mesh::Shape;
use super::solve::{SolveSettings, Solved};
use crate::io::{IoError, document};
use crate::project::{AntennaSpec, CageSpec, CompensationMode, MetalSpec, PresetSpec, Project, RuleSpec, Settings};
use crate::results::{FarField, FittedResonance, Sweep};
use crate::tlm::SOLVER_VERSION;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// The tag of a result's file.
const FORMAT: &str = "conformant-result";
/// The newest version that is read, and the one that is written. Version 1 has no far fields.
const VERSION: u32 = 2;

/// What is solved: a project's shape and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The project, with what does not matter to this shape at its default.
    project: Project,
    shape: Shape,
    settings: SolveSettings,
    solver_version: u32,
}

impl Job {
    /// The job of solving a project's shape with this program.
    #[must_use]
    pub fn new(project: &Project, shape: Shape, settings: &SolveSettings) -> Self {
        Self { project: relevant(project, shape), shape, settings: settings.clone(), solver_version: SOLVER_VERSION }
    }

    /// The project, with what does not matter to the shape at its default.
    #[must_use]
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// Which of its shapes.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// How it is solved.
    #[must_use]
    pub fn settings(&self) -> &SolveSettings {
        &self.settings
    }

    /// Whether solving a project as this job says would be another job by now.
    #[must_use]
    pub fn is_stale(&self, project: &Project) -> bool {
        *self != Self::new(project, self.shape, &self.settings)
    }

    /// SHA-256 of the job, hexadecimal.
    #[must_use]
    pub fn key(&self) -> String {
        let text = serde_json::to_vec(self).expect("plain values with text keys have a JSON form");
        Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Where its result is kept.
    #[must_use]
    pub fn result_path(&self, dir: &Path) -> PathBuf {
        dir.join(format!("{:.16}.json", self.key()))
    }

    /// Where its run is kept while it is interrupted.
    #[must_use]
    pub fn checkpoint_path(&self, dir: &Path) -> PathBuf {
        dir.join(format!("{:.16}.checkpoint", self.key()))
    }
}

/// The project with all at its default that a shape does not depend on.
fn relevant(project: &Project, shape: Shape) -> Project {
    let mut project = project.clone();
    project.presets.retain(|entry| entry.enabled);
    // Materials are what they are by their values.
    project.materials.clear();
    project.antenna = nameless(project.antenna);
    let defaults = Settings::default();
    match shape {
        Shape::Flat => {
            project = Project { antenna: project.antenna, bodies: project.bodies, ..Project::default() };
        }
        Shape::Cylinder => {
            project.cage = CageSpec::default();
            project.settings = Settings { tolerance_mm: project.settings.tolerance_mm, ..defaults };
            for entry in &mut project.presets {
                if let PresetSpec::Bend { rule, .. } = &mut entry.preset {
                    *rule = RuleSpec::Tangent;
                }
            }
        }
        Shape::Deformed => {
            if project.settings.compensation != CompensationMode::Wl {
                project.settings.scope = defaults.scope;
                project.settings.fit_orders = defaults.fit_orders;
            }
        }
    }
    project
}

/// An antenna whose materials have no names.
fn nameless(mut antenna: AntennaSpec) -> AntennaSpec {
    antenna.substrate.name.clear();
    antenna.sheath.name.clear();
    for metal in [&mut antenna.patch_metal, &mut antenna.ground_metal] {
        if let MetalSpec::Sheet { name, .. } = metal {
            name.clear();
        }
    }
    antenna
}

/// The folder in which a project's results are kept: `antenna.json` has `antenna.results`.
#[must_use]
pub fn results_dir(project_file: &Path) -> PathBuf {
    project_file.with_extension("results")
}

/// A result with what it was computed from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    job: Job,
    freqs_hz: Vec<f64>,
    s11_re: Vec<f64>,
    s11_im: Vec<f64>,
    reference_ohm: f64,
    /// The strongest resonance by fit.
    pub fitted: Option<FittedResonance>,
    /// Figures of the run.
    pub figures: RunFigures,
    /// Far fields, by ascending frequency: those nearest to the resonance where all would be too much.
    #[serde(default, with = "kept_fields", skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<FarField>,
}

/// Figures of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunFigures {
    /// The port's impedance as meshed, ohm.
    pub port_impedance_ohm: f64,
    /// Number of cells.
    pub tets: usize,
    /// Cells whose stubs were clipped.
    pub clipped_cells: usize,
    /// Time step, s.
    pub dt_s: f64,
    /// Steps done.
    pub steps: usize,
    /// How far the reflected voltage had fallen, dB.
    pub residual_db: f64,
    /// Whether the stop rule was met.
    pub is_settled: bool,
    /// Cells times steps per second.
    pub tet_steps_per_second: f64,
    /// Time that meshing and solving took, s.
    pub seconds: f64,
}

impl RunFigures {
    /// The figures of a solved antenna.
    #[must_use]
    pub fn of(solved: &Solved) -> Self {
        Self {
            port_impedance_ohm: solved.port_impedance,
            tets: solved.meshed.mesh.tets.len(),
            clipped_cells: solved.n_clipped,
            dt_s: solved.record.dt,
            steps: solved.record.total.len(),
            residual_db: solved.residual_db,
            is_settled: solved.is_settled,
            tet_steps_per_second: solved.speed,
            seconds: solved.seconds,
        }
    }
}

impl Stored {
    /// A result to be kept, with as many of its far fields as a file may hold.
    #[must_use]
    pub fn new<'a>(
        job: Job,
        sweep: &Sweep,
        fitted: Option<FittedResonance>,
        figures: RunFigures,
        fields: impl IntoIterator<Item = &'a FarField>,
    ) -> Self {
        let [lo, hi] = job.settings.band;
        let fields = kept_fields::nearest(fields, sweep.resonance().map_or((lo + hi) / 2.0, |r| r.freq));
        let Sweep { freqs, s11, reference } = sweep;
        Self {
            job,
            freqs_hz: freqs.clone(),
            s11_re: s11.iter().map(|s| s.re).collect(),
            s11_im: s11.iter().map(|s| s.im).collect(),
            reference_ohm: *reference,
            fitted,
            figures,
            fields,
        }
    }

    /// What it was computed from.
    #[must_use]
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// S11 over frequency.
    #[must_use]
    pub fn sweep(&self) -> Sweep {
        let s11 = self.s11_re.iter().zip(&self.s11_im).map(|(&re, &im)| Complex::new(re, im)).collect();
        Sweep { freqs: self.freqs_hz.clone(), s11, reference: self.reference_ohm }
    }

    /// Keeps the result in a folder, which is made where it is missing; returns its file.
    ///
    /// # Errors
    /// [`IoError`].
    pub fn save(&self, dir: &Path) -> Result<PathBuf, IoError> {
        let path = self.job.result_path(dir);
        document::write(&path, FORMAT, VERSION, self)?;
        Ok(path)
    }

    /// The result of a job, if a folder holds it.
    ///
    /// # Errors
    /// [`IoError`] if its file is there but cannot be read.
    pub fn find(job: &Job, dir: &Path) -> Result<Option<Self>, IoError> {
        let path = job.result_path(dir);
        if !path.exists() {
            return Ok(None);
        }
        // A file that was renamed is no result of this job.
        Ok(Self::read(&path)?.filter(|stored| stored.job == *job))
    }

    /// The results that a folder holds, oldest first, but the newest `n` at most; what cannot be read with its reason.
    #[must_use]
    pub fn newest(dir: &Path, n: usize) -> Vec<Result<Self, IoError>> {
        let files = document::by_age(dir);
        let newest = &files[files.len().saturating_sub(n)..];
        newest.iter().filter_map(|path| Self::read(path).transpose()).collect()
    }

    /// A result's file; `None` where its series were cut by hand.
    fn read(path: &Path) -> Result<Option<Self>, IoError> {
        let stored: Self = document::read(path, FORMAT, VERSION)?;
        let n = stored.freqs_hz.len();
        Ok(Some(stored).filter(|stored| stored.s11_re.len() == n && stored.s11_im.len() == n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::made_up::made_up;
    use crate::pipeline::solve_job::RunResult;
    use crate::pipeline::{Density, MeshSettings, StopRule};
    use crate::project::materials::{DIELECTRICS, METALS};
    use crate::project::{BendPlane, PresetEntry, ResistorSpec};

    fn bent() -> Project {
        let preset =
            PresetSpec::Bend { plane: BendPlane::E, radius_mm: 10.0, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        Project { presets: vec![PresetEntry { enabled: true, preset }], ..Project::default() }
    }

    fn settings() -> SolveSettings {
        SolveSettings::new(MeshSettings { density: Density::Coarse, ..MeshSettings::default() }, [7e9, 14e9])
    }

    fn key(shape: Shape, change: impl Fn(&mut Project)) -> String {
        let mut project = bent();
        change(&mut project);
        Job::new(&project, shape, &settings()).key()
    }

    #[test]
    fn the_key_follows_what_the_result_depends_on() {
        type Change = fn(&mut Project);
        let changes: [(Change, [bool; 3]); 11] = [
            (|p| p.antenna.ground_metal = METALS[0].to_spec(), [true, true, true]),
            (|p| p.antenna.substrate.name = "other".to_owned(), [false, false, false]),
            (|p| p.materials.push(DIELECTRICS[1].to_spec()), [false, false, false]),
            (|p| p.antenna.resistors.push(ResistorSpec { x_mm: 3.0, y_mm: 2.0, ohm: 50.0 }), [true, true, true]),
            (|p| p.antenna.width_mm += 0.01, [true, true, true]),
            (|p| p.presets[0].enabled = false, [true, false, true]),
            (|p| p.cage.padding_mm[2] += 1.0, [true, false, false]),
            (|p| p.settings.compensation = CompensationMode::None, [true, false, false]),
            (|p| p.settings.tolerance_mm = 0.02, [true, false, true]),
            (|p| p.settings.fit_orders = [3, 3], [false, false, false]),
            (|p| p.presets.push(PresetEntry { enabled: false, ..p.presets[0] }), [false, false, false]),
        ];
        for (n, (change, expected)) in changes.into_iter().enumerate() {
            for (shape, expected) in [Shape::Deformed, Shape::Flat, Shape::Cylinder].into_iter().zip(expected) {
                assert_eq!(key(shape, change) != key(shape, |_| ()), expected, "change {n}, {shape:?}");
                let mut changed = bent();
                change(&mut changed);
                assert_eq!(Job::new(&bent(), shape, &settings()).is_stale(&changed), expected, "{n}, {shape:?}");
            }
        }
        let wl = |orders| {
            move |p: &mut Project| {
                p.settings.compensation = CompensationMode::Wl;
                p.settings.fit_orders = orders;
            }
        };
        assert_ne!(key(Shape::Deformed, wl([3, 3])), key(Shape::Deformed, wl([5, 5])), "WL depends on its orders");
        let other = SolveSettings { stop: StopRule::Settled { tolerance: 1e-3 }, ..settings() };
        assert_ne!(Job::new(&bent(), Shape::Flat, &other).key(), key(Shape::Flat, |_| ()), "another stop rule");
    }

    fn stored(job: Job) -> Stored {
        Stored {
            job,
            freqs_hz: vec![7e9, 7.1e9],
            s11_re: vec![0.1, -1.0 / 3.0],
            s11_im: vec![0.0, 1e-17],
            reference_ohm: 50.0,
            fitted: Some(FittedResonance { freq: 1.1e10, freq_error: 1e6, q: 4.8, q_error: 0.1 }),
            figures: RunFigures {
                port_impedance_ohm: 49.4,
                tets: 50_000,
                clipped_cells: 150,
                dt_s: 1.4e-13,
                steps: 9000,
                residual_db: -40.1,
                is_settled: true,
                tet_steps_per_second: 5e7,
                seconds: 9.5,
            },
            fields: Vec::new(),
        }
    }

    #[test]
    fn far_fields_come_back_to_the_bit_and_the_nearest_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let job = Job::new(&bent(), Shape::Flat, &settings());
        let result = made_up(10.6e9);
        let kept = result.stored(job.clone());
        let path = kept.save(folder.path()).unwrap();
        let found = Stored::find(&job, folder.path()).unwrap().expect("kept");
        let bits = |fields: &[FarField]| -> Vec<u64> {
            let samples = fields.iter().flat_map(|f| f.e_theta.iter().chain(&f.e_phi));
            samples.flat_map(|e| [e.re.to_bits(), e.im.to_bits()]).collect()
        };
        assert_eq!(found, kept, "as kept");
        assert_eq!(bits(&found.fields), bits(&[result.patterns[0].field.clone()]), "to the bit");
        assert_eq!(RunResult::from(&found).patterns[0].cuts(), result.patterns[0].cuts(), "with its cuts");
        let text = std::fs::read_to_string(&path).unwrap();
        let begin = text.find(",\"fields\":").expect("they are in the file");
        let first = format!("{}}}}}\n", &text[..begin]).replace("\"version\":2", "\"version\":1");
        std::fs::write(&path, first).unwrap();
        let old = Stored::find(&job, folder.path()).unwrap().expect("of version 1");
        assert_eq!(old, Stored { fields: Vec::new(), ..kept.clone() }, "but for its fields");
        std::fs::write(&path, text.replacen("\"samples\":\"AAAA", "\"samples\":\"", 1)).unwrap();
        let message = Stored::find(&job, folder.path()).unwrap_err().to_string();
        assert!(message.contains("far field"), "{message}");
        let many: Vec<FarField> = (0..100_u32)
            .map(|k| FarField { freq: 9e9 + 4e7 * f64::from(k), ..result.patterns[0].field.clone() })
            .collect();
        let kept = Stored::new(job, &result.sweep, None, result.figures, &many);
        let [first, .., last] = &kept.fields[..] else { panic!("many") };
        assert!(kept.fields.len() < 50 && first.freq < 10.6e9 && last.freq > 10.6e9, "around the resonance");
        assert!(kept.fields.is_sorted_by(|a, b| a.freq < b.freq), "ascending");
        let size = std::fs::metadata(kept.save(folder.path()).unwrap()).unwrap().len();
        assert!((1_500_000..2_200_000).contains(&size), "{size} bytes");
    }

    #[test]
    fn a_result_is_found_by_its_job_alone() {
        let folder = tempfile::tempdir().unwrap();
        let job = Job::new(&bent(), Shape::Cylinder, &settings());
        assert_eq!(Stored::find(&job, folder.path()).unwrap(), None, "nothing yet");
        let path = stored(job.clone()).save(folder.path()).unwrap();
        assert_eq!(Stored::find(&job, folder.path()).unwrap(), Some(stored(job.clone())), "as kept");
        let newest = Stored::newest(folder.path(), 8);
        assert!(matches!(&newest[..], [Ok(found)] if *found == stored(job.clone())), "without its job");
        assert!(Stored::newest(folder.path(), 0).is_empty(), "no more than asked for");
        assert!(Stored::newest(&folder.path().join("nothing"), 8).is_empty(), "no folder");
        let other = Job::new(&bent(), Shape::Flat, &settings());
        std::fs::rename(&path, other.result_path(folder.path())).unwrap();
        assert_eq!(Stored::find(&other, folder.path()).unwrap(), None, "renamed by hand");
        std::fs::write(&path, r#"{"format": "conformant-result", "version": 1, "content": {"a": 1}}"#).unwrap();
        let message = Stored::find(&job, folder.path()).unwrap_err().to_string();
        assert!(message.contains("unknown field `a`"), "{message}");
        let newest = Stored::newest(folder.path(), 8);
        assert!(matches!(newest[..], [Err(_), Ok(_)] | [Ok(_), Err(_)]), "why one cannot be read");
        assert_eq!(results_dir(Path::new("x/antenna.json")), Path::new("x/antenna.results"), "beside the project");
    }
}
