//! The order in which points go into the mesh: rounds of doubling size, each along a space-filling curve \[ACR03\].
//!
//! Near points follow each other, so walks are short, while the first rounds spread the mesh over the whole domain.

use crate::geometry::DVec3;

/// Bits per coordinate of the curve's cells.
const BITS: u32 = 21;
/// Rounds at most; the last one holds half of the points.
const ROUNDS: u32 = 14;

/// The numbers of the points in the order of insertion; the same for the same points.
pub(super) fn insertion_order(points: &[DVec3]) -> Vec<usize> {
    let (lo, hi) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let scale = f64::from((1_u32 << BITS) - 1) / (hi - lo).max_element().max(f64::MIN_POSITIVE);
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut keyed: Vec<(u32, u64, usize)> = points
        .iter()
        .enumerate()
        .map(|(i, &p)| {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let round = ROUNDS - (random >> 11 | 1 << ROUNDS).trailing_zeros();
            (round, morton((p - lo) * scale), i)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|k| k.2).collect()
}

/// Interleaves the bits of a point's cell.
fn morton(cell: DVec3) -> u64 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "scaled to 21 bits")]
    let spread = |x: f64| {
        let mut x = x as u64 & 0x1f_ffff;
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            x = (x | x << shift) & mask;
        }
        x
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}
