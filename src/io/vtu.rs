//! VTK unstructured grid (`.vtu`, for ParaView): the cells with their region and any other number per cell.
//!
//! A [`TetMesh`] enters; millimetres leave: XML with the arrays appended as raw little-endian bytes, each after its
//! length as `u64`. The cell array `region` holds the region's number; a comment at the file's head says which name it
//! has. Faces with a boundary condition are not written, since a viewer would lay them over the cells. Reading is not
//! handled.
//!
//! Source: VTK File Formats, "Unstructured grid" (XML, version 1.0).

use super::parts::Parts;
use super::{IoError, write_atomic_with};
use crate::tet::TetMesh;
use crate::units::to_mm;
use std::io::{self, Write};
use std::path::Path;

/// VTK's number of the linear tetrahedron.
const TETRAHEDRON: u8 = 10;

/// A number for each cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellField<'a> {
    /// Name of the array, with its unit: `inradius_mm`.
    pub name: &'a str,
    /// `[n_tets]`.
    pub values: &'a [f64],
}

/// An array in the file: its XML attributes and its bytes.
struct Array<'a> {
    kind: &'static str,
    name: &'a str,
    components: usize,
    bytes: Vec<u8>,
}

/// Writes a valid mesh in millimetres, with `fields` beside the region of each cell.
///
/// # Errors
/// [`IoError::BadPartName`] before anything is written; [`IoError::System`].
///
/// # Panics
/// If a field has not one value per cell.
pub fn write(mesh: &TetMesh, fields: &[CellField<'_>], path: &Path) -> Result<(), IoError> {
    let parts = Parts::of(mesh)?;
    for field in fields {
        assert_eq!(field.values.len(), mesh.tets.len(), "field {} has one value per cell", field.name);
    }
    let geometry = geometry(mesh);
    let region = mesh.tets.iter().flat_map(|t| t.region.raw().to_le_bytes()).collect();
    let mut cells = vec![Array { kind: "UInt32", name: "region", components: 1, bytes: region }];
    cells.extend(fields.iter().map(|f| {
        let bytes = f.values.iter().flat_map(|v| v.to_le_bytes()).collect();
        Array { kind: "Float64", name: f.name, components: 1, bytes }
    }));
    write_atomic_with(path, |out| {
        writeln!(out, "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!-- Conformant mesh, unit mm -->")?;
        for volume in &parts.volumes {
            // Two hyphens would end the comment.
            writeln!(out, "<!-- region {}: {} -->", volume.tag, volume.name.replace("--", "\u{2010}\u{2010}"))?;
        }
        write_grid(mesh, &geometry, &cells, out)
    })
}

/// Points, and the connectivity, offsets and types of the cells.
fn geometry(mesh: &TetMesh) -> [Array<'static>; 4] {
    let points = mesh.vertices.iter().flat_map(|v| v.to_array()).flat_map(|c| to_mm(c).to_le_bytes());
    let corners = mesh.tets.iter().flat_map(|t| t.vertices).flat_map(|v| i64::from(v.raw()).to_le_bytes());
    let ends = (1_i64..).take(mesh.tets.len()).flat_map(|t| (4 * t).to_le_bytes());
    let array = |kind, name, components, bytes| Array { kind, name, components, bytes };
    [
        array("Float64", "Points", 3, points.collect()),
        array("Int64", "connectivity", 1, corners.collect()),
        array("Int64", "offsets", 1, ends.collect()),
        array("UInt8", "types", 1, vec![TETRAHEDRON; mesh.tets.len()]),
    ]
}

fn write_grid(mesh: &TetMesh, geometry: &[Array<'_>; 4], cells: &[Array<'_>], out: &mut dyn Write) -> io::Result<()> {
    let format = "version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"";
    writeln!(out, "<VTKFile type=\"UnstructuredGrid\" {format}>\n<UnstructuredGrid>")?;
    writeln!(out, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", mesh.vertices.len(), mesh.tets.len())?;
    let mut offset = 0;
    let sections = [("Points", &geometry[..1]), ("Cells", &geometry[1..]), ("CellData", cells)];
    for (section, arrays) in sections {
        writeln!(out, "<{section}>")?;
        for Array { kind, name, components, bytes } in arrays {
            let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
            // Some readers make a list of lists of an array whose one component is spelled out.
            let components =
                if *components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
            write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\"{components}")?;
            writeln!(out, " format=\"appended\" offset=\"{offset}\"/>")?;
            offset += size_of::<u64>() + bytes.len();
        }
        writeln!(out, "</{section}>")?;
    }
    write!(out, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    for array in geometry.iter().chain(cells) {
        out.write_all(&(array.bytes.len() as u64).to_le_bytes())?;
        out.write_all(&array.bytes)?;
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}
