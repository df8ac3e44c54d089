//! `apply`: carries points through any closed triangle cage, numbers as they stand.

use super::args::ApplyArgs;
use crate::geometry::{TriMesh, VertexId};
use crate::io::{IoError, csv, obj};
use crate::pipeline;
use crate::task::Task;
use anyhow::{Context, Result, ensure};
use std::path::Path;

pub(super) fn run(args: &ApplyArgs, task: &Task) -> Result<()> {
    let rest = obj::read_surface(&args.cage)?;
    let posed = read_posed(&args.posed, &rest)?;
    let points = csv::read_points(&args.points)?;
    let (n_vertices, n_faces) = (rest.vertices.len(), rest.faces.len());
    let (images, weights) = pipeline::apply_cage(rest, &posed.vertices, &points, task)
        .with_context(|| format!("carrying {} through {}", args.points.display(), args.cage.display()))?;
    csv::write_table(&args.out, &[], images.iter().map(|p| p.to_array()))?;
    if let Some(path) = &args.weights {
        let row = |point: usize| {
            let phi = (0..n_vertices).map(move |v| (point, v));
            let psi = (0..n_faces).map(move |f| (point, f));
            let weights = &weights;
            phi.map(|(p, v)| weights.phi(p, v)).chain(psi.map(|(p, f)| weights.psi(p, f)))
        };
        csv::write_table(path, &[], (0..points.len()).map(row))?;
    }
    super::print(&format!(
        "carried {} points through a cage of {n_vertices} vertices and {n_faces} faces to {}",
        points.len(),
        args.out.display()
    ))
}

/// The posed cage: it need not be closed outward (a pose may cross itself), but must be the same cage.
fn read_posed(path: &Path, rest: &TriMesh) -> Result<TriMesh> {
    let bytes =
        std::fs::read(path).map_err(|source| IoError::System { action: "read", path: path.to_owned(), source })?;
    let obj = obj::parse(&bytes).map_err(|source| IoError::Malformed { path: path.to_owned(), source })?;
    let faces: Vec<[VertexId; 3]> = obj.groups.into_iter().flat_map(|g| g.faces).collect();
    let (found, expected) = (obj.vertices.len(), rest.vertices.len());
    ensure!(found == expected, "{} has {found} vertices, but the cage at rest has {expected}", path.display());
    let differs = faces.iter().zip(&rest.faces).position(|(a, b)| a != b);
    if let Some(face) = differs.or((faces.len() != rest.faces.len()).then_some(faces.len().min(rest.faces.len()))) {
        anyhow::bail!(
            "face {} of {} is not that of the cage at rest: export both with the same faces in the same order",
            face + 1,
            path.display()
        );
    }
    Ok(TriMesh { vertices: obj.vertices, faces })
}
