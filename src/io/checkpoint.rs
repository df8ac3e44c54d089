//! Checkpoints of a field run: a binary file that is whole or refused.
//!
//! Little-endian: magic `CNFTLMCP`, version (u32), fingerprint of the run it belongs to (32 bytes), time step and seconds
//! spent (f64), numbers of steps and of field values (u64), incident and total voltages (f64), field (f32), and the
//! SHA-256 of everything before. Whether it fits a run is for [`Run::resume`](crate::tlm::Run::resume) to say.

use super::error::{ParseError, Place, read as read_bytes};
use super::{IoError, write_atomic};
use crate::tlm::{Checkpoint, Record};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The version that is written and read: a checkpoint is for the same program, soon.
const VERSION: u32 = 1;
const MAGIC: &[u8; 8] = b"CNFTLMCP";
/// Bytes before the series.
const HEAD: usize = 8 + 4 + 32 + 4 * 8;
/// Bytes of the SHA-256 at the end.
const DIGEST: usize = 32;

/// Writes a checkpoint, whole or not at all.
///
/// # Errors
/// [`IoError::System`].
pub fn write(checkpoint: &Checkpoint, path: &Path) -> Result<(), IoError> {
    let Checkpoint { fingerprint, seconds, record, field } = checkpoint;
    let mut bytes = Vec::with_capacity(HEAD + 16 * record.total.len() + 4 * field.len() + DIGEST);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(fingerprint);
    bytes.extend(record.dt.to_le_bytes());
    bytes.extend(seconds.to_le_bytes());
    bytes.extend((record.total.len() as u64).to_le_bytes());
    bytes.extend((field.len() as u64).to_le_bytes());
    record.incident.iter().chain(&record.total).for_each(|v| bytes.extend(v.to_le_bytes()));
    field.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    let digest = Sha256::digest(&bytes);
    bytes.extend(digest);
    write_atomic(path, &bytes)
}

/// Reads a checkpoint.
///
/// # Errors
/// [`IoError`] naming the file if it is missing, damaged, or of another version.
pub fn read(path: &Path) -> Result<Checkpoint, IoError> {
    parse(&read_bytes(path)?).map_err(|error| error.at(path))
}

fn parse(bytes: &[u8]) -> Result<Checkpoint, ParseError> {
    let broken = |what: &str| ParseError::new(Place::File, what.to_owned());
    let damaged = || broken("the checkpoint is damaged: solve without it");
    if bytes.len() < HEAD + DIGEST || !bytes.starts_with(MAGIC) {
        return Err(broken("this is no checkpoint of a field run"));
    }
    let (content, digest) = bytes.split_at(bytes.len() - DIGEST);
    if Sha256::digest(content)[..] != *digest {
        return Err(damaged());
    }
    let mut rest = &content[MAGIC.len()..];
    let version = u32::from_le_bytes(take(&mut rest).ok_or_else(damaged)?);
    if version != VERSION {
        return Err(broken(&format!("the checkpoint has version {version}, not {VERSION}: solve without it")));
    }
    let fingerprint = take(&mut rest).ok_or_else(damaged)?;
    let mut number = || take(&mut rest).map(f64::from_le_bytes);
    let (dt, seconds) = number().zip(number()).ok_or_else(damaged)?;
    let mut count = || usize::try_from(u64::from_le_bytes(take(&mut rest)?)).ok();
    let (n_steps, n_field) = count().zip(count()).ok_or_else(damaged)?;
    let expected = n_steps.checked_mul(16).and_then(|s| n_field.checked_mul(4)?.checked_add(s));
    if expected != Some(rest.len()) {
        return Err(damaged());
    }
    let (series, field) = rest.split_at(16 * n_steps);
    let mut series: Vec<f64> = series.as_chunks().0.iter().map(|c| f64::from_le_bytes(*c)).collect();
    let total = series.split_off(n_steps);
    Ok(Checkpoint {
        fingerprint,
        seconds,
        record: Record { dt, incident: series, total },
        field: field.as_chunks().0.iter().map(|c| f32::from_le_bytes(*c)).collect(),
    })
}

/// The next bytes.
fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (head, tail) = rest.split_first_chunk()?;
    *rest = tail;
    Some(*head)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkpoint() -> Checkpoint {
        let record =
            Record { dt: 1.5e-13, incident: vec![0.1, -0.2, 1e-300], total: vec![0.3, f64::MIN_POSITIVE, -0.0] };
        Checkpoint { fingerprint: [7; 32], seconds: 1.25, record, field: vec![1.0, -2.5e-38, 3.0e7] }
    }

    #[test]
    fn a_checkpoint_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        write(&checkpoint(), &path).unwrap();
        assert_eq!(read(&path).unwrap(), checkpoint(), "as written");
    }

    #[test]
    fn every_damaged_byte_and_every_cut_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        write(&checkpoint(), &path).unwrap();
        let good = std::fs::read(&path).unwrap();
        for place in 0..good.len() {
            let mut bad = good.clone();
            bad[place] ^= 16;
            assert!(parse(&bad).is_err(), "byte {place}");
            assert!(parse(&good[..place]).is_err(), "cut at {place}");
        }
        std::fs::write(&path, &good[..good.len() - 1]).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains("a.checkpoint") && message.contains("damaged"), "{message}");
        assert!(parse(b"{}").unwrap_err().to_string().contains("no checkpoint"), "another file");
        assert!(read(&folder.path().join("b")).unwrap_err().to_string().contains("cannot read"), "missing");
    }
}
