//! NASTRAN bulk data: vertices (`GRID*`, 16 characters a number), cells (`CTETRA`) and faces (`CTRIA3`).
//!
//! A [`TetMesh`] enters; millimetres leave. The property number (PID) of a cell or face is the tag of its part, as in
//! [`msh`](super::msh); comments say which name it has. No material or property cards are written: what reads the file
//! assigns them by number. Reading is not handled.
//!
//! Source: MSC Nastran Quick Reference Guide, "GRID", "CTETRA", "CTRIA3", and the large field format.

use super::decimal::wide_field;
use super::parts::Parts;
use super::{IoError, write_atomic_with};
use crate::geometry::VertexId;
use crate::tet::TetMesh;
use std::io::{self, Write};
use std::path::Path;

/// Numbers above have no room in a field of eight characters.
const LARGEST_NUMBER: usize = 99_999_999;

/// Writes a valid mesh in millimetres.
///
/// # Errors
/// [`IoError::BadPartName`] before anything is written; [`IoError::System`].
///
/// # Panics
/// If the mesh has more than 99,999,999 vertices or elements, for which the format has no numbers.
pub fn write(mesh: &TetMesh, path: &Path) -> Result<(), IoError> {
    let largest = mesh.vertices.len().max(mesh.tets.len() + mesh.faces.len());
    assert!(largest <= LARGEST_NUMBER, "{largest} numbers do not fit in eight digits");
    let parts = Parts::of(mesh)?;
    write_atomic_with(path, |out| write_cards(mesh, &parts, out))
}

fn write_cards(mesh: &TetMesh, parts: &Parts<'_>, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "$ Conformant mesh, unit mm")?;
    for volume in &parts.volumes {
        writeln!(out, "$ PID {} CTETRA {}", volume.tag, volume.name)?;
    }
    for sheet in &parts.sheets {
        writeln!(out, "$ PID {} CTRIA3 {}", sheet.tag, sheet.name)?;
    }
    writeln!(out, "BEGIN BULK")?;
    for (v, vertex) in mesh.vertices.iter().enumerate() {
        let [x, y, z] = vertex.to_array().map(wide_field);
        writeln!(out, "GRID*   {:>16}{:16}{x:>16}{y:>16}*", v + 1, "")?;
        writeln!(out, "*       {z:>16}")?;
    }
    let mut element = 0;
    for volume in &parts.volumes {
        for &tet in &volume.tets {
            element += 1;
            writeln!(out, "CTETRA  {element:>8}{:>8}{}", volume.tag, grids(&mesh.tets[tet].vertices))?;
        }
    }
    for sheet in &parts.sheets {
        for &face in &sheet.faces {
            element += 1;
            writeln!(out, "CTRIA3  {element:>8}{:>8}{}", sheet.tag, grids(&mesh.faces[face].vertices))?;
        }
    }
    writeln!(out, "ENDDATA")
}

/// Corners counted from 1, each in a field of eight characters.
fn grids(corners: &[VertexId]) -> String {
    corners.iter().map(|v| format!("{:>8}", v.index() + 1)).collect()
}
