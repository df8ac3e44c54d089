//! Plots as files.

use crate::io::write_atomic;
use crate::plot::{Format, Plot};
use anyhow::{Context, Result};
use std::path::Path;

/// Writes a plot into a folder that exists, one file per form, under its own name.
///
/// # Errors
/// If it cannot be drawn or a file cannot be written.
pub(super) fn write(plot: &Plot, folder: &Path, formats: &[Format]) -> Result<()> {
    for &format in formats {
        let bytes = plot.bytes(format).with_context(|| format!("drawing {}", plot.name()))?;
        write_atomic(&folder.join(plot.name()).with_extension(format.ending()), &bytes)?;
    }
    Ok(())
}
