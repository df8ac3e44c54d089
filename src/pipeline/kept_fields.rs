//! Far fields as a result's file keeps them: their samples to the bit.
//!
//! The samples of a field are doubles, least significant byte first, as text of 64 letters (RFC 4648): half as long as
//! their decimals. First all of the component along theta, then all along phi, each real before imaginary, in the order of
//! [`FarField`].

use crate::results::{FarField, Powers};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use nalgebra::Complex;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Length of the samples of all fields of a result, as text. More would make opening a project slow, less would not
/// hold the 41 usual frequencies of a small antenna.
const MAX_TEXT: usize = 2_000_000;
/// Bytes of a sample of both components.
const SAMPLE: usize = 32;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    freq_hz: f64,
    /// From pole to pole.
    intervals: usize,
    powers: Powers,
    samples: String,
}

/// Of some fields those nearest to a frequency, Hz, as many as are kept, by ascending frequency.
pub(super) fn nearest<'a>(fields: impl IntoIterator<Item = &'a FarField>, freq: f64) -> Vec<FarField> {
    let mut fields: Vec<&FarField> = fields.into_iter().collect();
    fields.sort_by(|a, b| (a.freq - freq).abs().total_cmp(&(b.freq - freq).abs()));
    let mut room = MAX_TEXT;
    let fits = |field: &&&FarField| {
        let left = room.checked_sub((field.e_theta.len() * SAMPLE).div_ceil(3) * 4);
        room = left.unwrap_or(0);
        left.is_some()
    };
    let mut kept: Vec<FarField> = fields.iter().take_while(fits).map(|field| (*field).clone()).collect();
    kept.sort_by(|a, b| a.freq.total_cmp(&b.freq));
    kept
}

/// For serde.
pub(super) fn serialize<S: Serializer>(fields: &[FarField], serializer: S) -> Result<S::Ok, S::Error> {
    let kept = |field: &FarField| {
        let samples = field.e_theta.iter().chain(&field.e_phi);
        let bytes: Vec<u8> = samples.flat_map(|e| [e.re, e.im]).flat_map(f64::to_le_bytes).collect();
        Kept {
            freq_hz: field.freq,
            intervals: field.theta.len() - 1,
            powers: field.powers,
            samples: BASE64_STANDARD.encode(bytes),
        }
    };
    serializer.collect_seq(fields.iter().map(kept))
}

/// For serde.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<FarField>, D::Error> {
    let field = |kept: Kept| {
        let bytes = BASE64_STANDARD.decode(&kept.samples).map_err(D::Error::custom)?;
        let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let samples: Vec<Complex<f64>> = numbers.as_chunks().0.iter().map(|&[re, im]| Complex::new(re, im)).collect();
        let (e_theta, e_phi) = samples.split_at(samples.len() / 2);
        let e = [e_theta, e_phi].map(<[_]>::to_vec);
        FarField::from_samples(kept.freq_hz, kept.intervals, e, kept.powers).ok_or_else(|| {
            let what = "the samples of a far field are cut or spoiled: delete the file and solve again";
            D::Error::custom(what)
        })
    };
    Vec::<Kept>::deserialize(deserializer)?.into_iter().map(field).collect()
}
