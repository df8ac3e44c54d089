//! Checkpoints of a field run: a binary file that is whole or refused.
//!
//! Little-endian: magic `CNFTLMCP`, version (u32), fingerprint of the run it belongs to (32 bytes), time step and seconds
//! spent (f64), numbers of steps, of field values, of sums and of circuit states (u64), incident and total voltages (f64), sums (pairs of
//! f64), states (f64), field (f32), and the SHA-256 of everything before. Whether it fits a run is for [`Run::resumed`](crate::tlm::Run::resumed) to say.

use super::error::{ParseError, Place, read as read_bytes};
use super::{IoError, write_atomic};
use crate::tlm::{Checkpoint, Record};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The version that is written and read: a checkpoint is for the same program, soon.
const VERSION: u32 = 2;
const MAGIC: &[u8; 8] = b"CNFTLMCP";
/// Bytes before the series.
const HEAD: usize = 8 + 4 + 32 + 6 * 8;
/// Bytes of the SHA-256 at the end.
const DIGEST: usize = 32;

/// Writes a checkpoint, whole or not at all.
///
/// # Errors
/// [`IoError::System`].
pub fn write(checkpoint: &Checkpoint, path: &Path) -> Result<(), IoError> {
    let Checkpoint { fingerprint, seconds, record, field, waves, sums } = checkpoint;
    let n_numbers = 2 * (record.total.len() + sums.len()) + waves.len();
    let mut bytes = Vec::with_capacity(HEAD + 8 * n_numbers + 4 * field.len() + DIGEST);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(fingerprint);
    bytes.extend(record.dt.to_le_bytes());
    bytes.extend(seconds.to_le_bytes());
    bytes.extend((record.total.len() as u64).to_le_bytes());
    bytes.extend((field.len() as u64).to_le_bytes());
    bytes.extend((sums.len() as u64).to_le_bytes());
    bytes.extend((waves.len() as u64).to_le_bytes());
    let numbers = record.incident.iter().chain(&record.total).chain(sums.as_flattened()).chain(waves);
    numbers.for_each(|v| bytes.extend(v.to_le_bytes()));
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
    let counts = count().zip(count()).zip(count().zip(count()));
    let ((n_steps, n_field), (n_sums, n_waves)) = counts.ok_or_else(damaged)?;
    let n_pairs = n_steps.checked_add(n_sums).and_then(|n| n.checked_mul(16));
    let n_numbers = n_pairs.and_then(|n| n_waves.checked_mul(8)?.checked_add(n));
    let expected = n_numbers.and_then(|n| n_field.checked_mul(4)?.checked_add(n));
    let Some(numbers) = n_numbers.filter(|_| expected == Some(rest.len())) else { return Err(damaged()) };
    let (numbers, field) = rest.split_at(numbers);
    let mut incident: Vec<f64> = numbers.as_chunks().0.iter().map(|c| f64::from_le_bytes(*c)).collect();
    let waves = incident.split_off(2 * (n_steps + n_sums));
    let sums = incident.split_off(2 * n_steps);
    let total = incident.split_off(n_steps);
    Ok(Checkpoint {
        fingerprint,
        seconds,
        record: Record { dt, incident, total },
        waves,
        sums: sums.as_chunks().0.to_vec(),
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
        Checkpoint {
            fingerprint: [7; 32],
            seconds: 1.25,
            record,
            field: vec![1.0, -2.5e-38, 3.0e7],
            waves: vec![-0.5, 1e-3, 7.0],
            sums: vec![[1.5, -2.5]],
        }
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
