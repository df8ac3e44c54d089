//! Scales from a number to a colour: one table for the shader and for the legend.
//!
//! [`ColorMap::Viridis`] (for magnitudes: dark to bright) passes through 18 colours of the public-domain (CC0) map of
//! van der Walt, Smith and Firing, joined by a Catmull-Rom spline. [`ColorMap::CoolWarm`] (for signed values: blue, grey,
//! red) is computed by Moreland's construction: straight in a polar form of CIELAB, so that lightness rises evenly
//! to a neutral middle and the two arms look equally strong.
//!
//! Source: \[Mor09\] K. Moreland, *Diverging Color Maps for Scientific Visualization*, ISVC 2009.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded channels and table places are clamped to their range first"
)]

use std::sync::LazyLock;

/// Entries of each table.
pub const N_ENTRIES: usize = 256;

/// A scale of colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColorMap {
    /// For magnitudes, from dark violet over green to yellow.
    #[default]
    Viridis,
    /// For signed values, from blue over light grey to red.
    CoolWarm,
}

type Table = [[u8; 3]; N_ENTRIES];

static VIRIDIS: LazyLock<Table> = LazyLock::new(|| std::array::from_fn(|i| spline(place(i))));
static COOL_WARM: LazyLock<Table> = LazyLock::new(|| std::array::from_fn(|i| diverging(place(i)).map(to_byte)));

impl ColorMap {
    /// All maps, in the order of the rows of the shader's table.
    pub const ALL: [Self; 2] = [Self::Viridis, Self::CoolWarm];

    /// Row of this map in the shader's table.
    pub(super) fn row(self) -> u8 {
        match self {
            Self::Viridis => 0,
            Self::CoolWarm => 1,
        }
    }

    /// The colours of the map in equal steps, sRGB-encoded.
    #[must_use]
    pub fn table(self) -> &'static Table {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::CoolWarm => &COOL_WARM,
        }
    }
}

/// The colour at `t` (0 to 1, clamped; not a number counts as 0), sRGB-encoded: the very one that the shader paints.
#[must_use]
pub fn color(map: ColorMap, t: f32) -> [u8; 3] {
    let last = (N_ENTRIES - 1) as f32;
    map.table()[(t.clamp(0.0, 1.0) * last + 0.5) as usize]
}

fn place(entry: usize) -> f64 {
    entry as f64 / (N_ENTRIES - 1) as f64
}

fn to_byte(value: f64) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}

/// Viridis at every fifteenth of its 256 entries.
const VIRIDIS_POINTS: [[u8; 3]; 18] = [
    [68, 1, 84],
    [72, 23, 105],
    [71, 42, 122],
    [67, 61, 132],
    [61, 78, 138],
    [53, 94, 141],
    [46, 109, 142],
    [41, 123, 142],
    [35, 137, 142],
    [31, 151, 139],
    [33, 165, 133],
    [46, 179, 124],
    [70, 192, 111],
    [101, 203, 94],
    [137, 213, 72],
    [176, 221, 47],
    [216, 226, 25],
    [253, 231, 37],
];

/// Catmull-Rom spline through the points of viridis, ends extended in a straight line.
fn spline(t: f64) -> [u8; 3] {
    let last = VIRIDIS_POINTS.len() - 1;
    let x = t * last as f64;
    let k = (x as usize).min(last - 1);
    let u = x - k as f64;
    std::array::from_fn(|channel| {
        let at = |i: usize| f64::from(VIRIDIS_POINTS[i][channel]);
        let (p1, p2) = (at(k), at(k + 1));
        let p0 = if k == 0 { 2.0 * p1 - p2 } else { at(k - 1) };
        let p3 = if k + 1 == last { 2.0 * p2 - p1 } else { at(k + 2) };
        let cubic = (3.0 * (p1 - p2) + p3 - p0) * u + 2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3;
        to_byte(p1 + 0.5 * u * (p2 - p0 + u * cubic))
    })
}

/// Ends and middle of the diverging map, sRGB: blue, red; the middle is a neutral grey of Msh magnitude 88.
const COOL: [f64; 3] = [59.0, 76.0, 192.0];
const WARM: [f64; 3] = [180.0, 4.0, 38.0];
const MIDDLE_MAGNITUDE: f64 = 88.0;
/// White of CIE D65, as the rows of the sRGB matrix sum up.
const WHITE: [f64; 3] = [0.950_470, 1.0, 1.088_830];

/// Channels from 0 to 255, not rounded, at `t` of the diverging map: each half runs straight in Msh from its end to the neutral middle.
fn diverging(t: f64) -> [f64; 3] {
    let (end, from_middle) = if t < 0.5 { (COOL, 1.0 - 2.0 * t) } else { (WARM, 2.0 * t - 1.0) };
    let [magnitude, saturation, hue] = msh_from_rgb(end);
    // The grey end has no hue of its own: it takes one turned away from purple, so that the arm passes no third hue.
    let spin =
        saturation * (MIDDLE_MAGNITUDE.powi(2) - magnitude.powi(2)).max(0.0).sqrt() / (magnitude * saturation.sin());
    let middle_hue = if hue > -std::f64::consts::FRAC_PI_3 { hue + spin } else { hue - spin };
    let mix = |middle: f64, end: f64| middle + from_middle * (end - middle);
    rgb_from_msh([mix(MIDDLE_MAGNITUDE, magnitude), mix(0.0, saturation), mix(middle_hue, hue)])
}

/// Magnitude, saturation angle and hue angle of CIELAB taken as a vector.
fn msh_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    let [r, g, b] = rgb.map(|c| decode(c / 255.0));
    let xyz = [
        0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b,
        0.212_672_9 * r + 0.715_152_2 * g + 0.072_175_0 * b,
        0.019_333_9 * r + 0.119_192_0 * g + 0.950_304_1 * b,
    ];
    let f: [f64; 3] = std::array::from_fn(|i| {
        let ratio = xyz[i] / WHITE[i];
        if ratio > 0.008_856 { ratio.cbrt() } else { 7.787 * ratio + 16.0 / 116.0 }
    });
    let (lightness, a, b) = (116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2]));
    let magnitude = (lightness * lightness + a * a + b * b).sqrt();
    [magnitude, (lightness / magnitude).clamp(-1.0, 1.0).acos(), b.atan2(a)]
}

/// sRGB channels, 0 to 255 and possibly beyond, of magnitude, saturation and hue.
fn rgb_from_msh([magnitude, saturation, hue]: [f64; 3]) -> [f64; 3] {
    let lightness = magnitude * saturation.cos();
    let (a, b) = (magnitude * saturation.sin() * hue.cos(), magnitude * saturation.sin() * hue.sin());
    let fy = (lightness + 16.0) / 116.0;
    let f = [fy + a / 500.0, fy, fy - b / 200.0];
    let [x, y, z]: [f64; 3] = std::array::from_fn(|i| {
        let ratio = if f[i] > 0.206_893 { f[i].powi(3) } else { (f[i] - 16.0 / 116.0) / 7.787 };
        ratio * WHITE[i]
    });
    let linear = [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ];
    linear.map(|c| 255.0 * encode(c))
}

fn decode(c: f64) -> f64 {
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

fn encode(c: f64) -> f64 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of an encoded colour.
    fn luminance(rgb: [u8; 3]) -> f64 {
        let [r, g, b] = rgb.map(|c| decode(f64::from(c) / 255.0));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn ends_are_the_published_colors() {
        assert_eq!(color(ColorMap::Viridis, 0.0), [68, 1, 84], "dark end of viridis");
        assert_eq!(color(ColorMap::Viridis, 1.0), [253, 231, 37], "bright end of viridis");
        assert_eq!(color(ColorMap::CoolWarm, 0.0), [59, 76, 192], "cool end");
        assert_eq!(color(ColorMap::CoolWarm, 1.0), [180, 4, 38], "warm end");
    }

    #[test]
    fn magnitude_grows_brighter_all_the_way() {
        let table = ColorMap::Viridis.table();
        for (i, pair) in table.windows(2).enumerate() {
            assert!(luminance(pair[1]) > luminance(pair[0]) - 2e-3, "entry {i}: {pair:?}");
        }
    }

    #[test]
    fn signed_values_meet_in_a_neutral_grey_and_arms_are_even() {
        let table = ColorMap::CoolWarm.table();
        // The middle lies between two entries.
        let middle: [u16; 3] = std::array::from_fn(|c| (u16::from(table[127][c]) + u16::from(table[128][c])) / 2);
        assert!(middle.iter().all(|c| c.abs_diff(221) <= 1), "middle {middle:?}");
        // Before rounding, which moves the light entries by more than the small steps around the middle.
        let lightness = |k: i32| {
            let [magnitude, saturation, _] = msh_from_rgb(diverging(f64::from(k) / 1000.0));
            magnitude * saturation.cos()
        };
        for k in 1..=500 {
            assert!(lightness(k) > lightness(k - 1), "the cool arm rises at {k}/1000");
            assert!(lightness(1000 - k) > lightness(1001 - k), "the warm arm falls at {k}/1000");
            let uneven = (lightness(k) - lightness(1000 - k)).abs();
            assert!(uneven < 2.0, "the arms differ by {uneven} of 100 at {k}/1000");
        }
    }

    #[test]
    fn no_step_jumps() {
        for map in ColorMap::ALL {
            for (i, pair) in map.table().windows(2).enumerate() {
                let jump = (0..3).map(|c| pair[0][c].abs_diff(pair[1][c])).max().unwrap();
                // Largest at the dark red end, where one channel nears zero and its encoding is steep.
                assert!(jump <= 7, "{map:?} entry {i}: {pair:?}");
            }
        }
    }

    #[test]
    fn values_beyond_the_ends_and_nan_are_clamped() {
        assert_eq!(color(ColorMap::Viridis, -3.0), color(ColorMap::Viridis, 0.0), "below");
        assert_eq!(color(ColorMap::Viridis, 7.0), color(ColorMap::Viridis, 1.0), "above");
        assert_eq!(color(ColorMap::Viridis, f32::NAN), color(ColorMap::Viridis, 0.0), "not a number");
    }
}
