//! Gmsh MSH, text, versions 4.1 and 2.2 (several solvers read 2.2 only): the mesh with its parts by name.
//!
//! A [`TetMesh`] enters; millimetres leave, with all digits. Each region with cells is a physical volume, each group
//! with faces a physical surface, both under their names, with tags above 0 that no other part has. A triangle's
//! normal points out of the region behind it. In 4.1 each part is one entity of the same tag; a volume names the
//! surfaces that have a face of its cells, which need not enclose it: interfaces without a group are no surface. A
//! vertex belongs to the first surface that uses it, else to the first volume. Reading is not handled.
//!
//! Source: Gmsh reference manual, "MSH file format" and "Legacy formats".

use super::decimal::millimetres;
use super::parts::Parts;
use super::{IoError, write_atomic_with};
use crate::geometry::{DVec3, VertexId};
use crate::tet::TetMesh;
use std::io::{self, Write};
use std::path::Path;

const TRIANGLE: usize = 2;
const TETRAHEDRON: usize = 4;

/// Version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MshVersion {
    /// 2.2, the legacy one.
    V2_2,
    /// 4.1, with entities.
    V4_1,
}

/// Writes a valid mesh in millimetres.
///
/// # Errors
/// [`IoError::BadPartName`] before anything is written; [`IoError::System`].
pub fn write(mesh: &TetMesh, version: MshVersion, path: &Path) -> Result<(), IoError> {
    let parts = Parts::of(mesh)?;
    write_atomic_with(path, |out| match version {
        MshVersion::V2_2 => write_2_2(mesh, &parts, out),
        MshVersion::V4_1 => write_4_1(mesh, &parts, out),
    })
}

fn write_head(version: &str, parts: &Parts<'_>, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$Comments\nConformant mesh, unit mm\n$EndComments")?;
    writeln!(out, "$PhysicalNames\n{}", parts.sheets.len() + parts.volumes.len())?;
    for sheet in &parts.sheets {
        writeln!(out, "2 {} \"{}\"", sheet.tag, sheet.name)?;
    }
    for volume in &parts.volumes {
        writeln!(out, "3 {} \"{}\"", volume.tag, volume.name)?;
    }
    writeln!(out, "$EndPhysicalNames")
}

fn write_2_2(mesh: &TetMesh, parts: &Parts<'_>, out: &mut dyn Write) -> io::Result<()> {
    write_head("2.2", parts, out)?;
    writeln!(out, "$Nodes\n{}", mesh.vertices.len())?;
    for (v, &vertex) in mesh.vertices.iter().enumerate() {
        writeln!(out, "{} {}", v + 1, millimetres(vertex))?;
    }
    writeln!(out, "$EndNodes\n$Elements\n{}", mesh.faces.len() + mesh.tets.len())?;
    let mut element = 0;
    for sheet in &parts.sheets {
        for &face in &sheet.faces {
            element += 1;
            let corners = nodes(&mesh.faces[face].vertices);
            writeln!(out, "{element} {TRIANGLE} 2 {tag} {tag}{corners}", tag = sheet.tag)?;
        }
    }
    for volume in &parts.volumes {
        for &tet in &volume.tets {
            element += 1;
            let corners = nodes(&mesh.tets[tet].vertices);
            writeln!(out, "{element} {TETRAHEDRON} 2 {tag} {tag}{corners}", tag = volume.tag)?;
        }
    }
    writeln!(out, "$EndElements")
}

fn write_4_1(mesh: &TetMesh, parts: &Parts<'_>, out: &mut dyn Write) -> io::Result<()> {
    write_head("4.1", parts, out)?;
    let face_corners = |f: &usize| mesh.faces[*f].vertices;
    let tet_corners = |t: &usize| mesh.tets[*t].vertices;
    writeln!(out, "$Entities\n0 0 {} {}", parts.sheets.len(), parts.volumes.len())?;
    for sheet in &parts.sheets {
        let bounds = bounds(mesh, sheet.faces.iter().flat_map(face_corners));
        writeln!(out, "{tag} {bounds} 1 {tag} 0", tag = sheet.tag)?;
    }
    for volume in &parts.volumes {
        let bounds = bounds(mesh, volume.tets.iter().flat_map(tet_corners));
        write!(out, "{tag} {bounds} 1 {tag} {}", volume.sheets.len(), tag = volume.tag)?;
        volume.sheets.iter().try_for_each(|tag| write!(out, " {tag}"))?;
        writeln!(out)?;
    }
    writeln!(out, "$EndEntities")?;

    let mut free = vec![true; mesh.vertices.len()];
    let mut own = |corners: &mut dyn Iterator<Item = VertexId>| -> Vec<VertexId> {
        let mut own: Vec<_> = corners.filter(|v| std::mem::take(&mut free[v.index()])).collect();
        own.sort_unstable();
        own
    };
    let of_sheets = parts.sheets.iter().map(|s| (2, s.tag, own(&mut s.faces.iter().flat_map(face_corners))));
    let mut blocks: Vec<_> = of_sheets.collect();
    blocks.extend(parts.volumes.iter().map(|v| (3, v.tag, own(&mut v.tets.iter().flat_map(tet_corners)))));
    blocks.retain(|(_, _, vertices)| !vertices.is_empty());
    let n_vertices = mesh.vertices.len();
    writeln!(out, "$Nodes\n{} {n_vertices} 1 {n_vertices}", blocks.len())?;
    for (dimension, tag, vertices) in blocks {
        writeln!(out, "{dimension} {tag} 0 {}", vertices.len())?;
        vertices.iter().try_for_each(|v| writeln!(out, "{}", v.index() + 1))?;
        vertices.iter().try_for_each(|v| writeln!(out, "{}", millimetres(mesh.vertices[v.index()])))?;
    }
    writeln!(out, "$EndNodes")?;

    let n_elements = mesh.faces.len() + mesh.tets.len();
    let n_blocks = parts.sheets.len() + parts.volumes.len();
    writeln!(out, "$Elements\n{n_blocks} {n_elements} 1 {n_elements}")?;
    let mut element = 0;
    for sheet in &parts.sheets {
        writeln!(out, "2 {} {TRIANGLE} {}", sheet.tag, sheet.faces.len())?;
        for face in &sheet.faces {
            element += 1;
            writeln!(out, "{element}{}", nodes(&face_corners(face)))?;
        }
    }
    for volume in &parts.volumes {
        writeln!(out, "3 {} {TETRAHEDRON} {}", volume.tag, volume.tets.len())?;
        for tet in &volume.tets {
            element += 1;
            writeln!(out, "{element}{}", nodes(&tet_corners(tet)))?;
        }
    }
    writeln!(out, "$EndElements")
}

/// Corners counted from 1, each after a space.
fn nodes(corners: &[VertexId]) -> String {
    corners.iter().map(|v| format!(" {}", v.index() + 1)).collect()
}

/// The lowest and the highest coordinates, mm.
fn bounds(mesh: &TetMesh, corners: impl Iterator<Item = VertexId>) -> String {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let places = corners.map(|v| mesh.vertices[v.index()]);
    let (low, high) = places.fold(start, |(low, high), p| (low.min(p), high.max(p)));
    format!("{} {}", millimetres(low), millimetres(high))
}
