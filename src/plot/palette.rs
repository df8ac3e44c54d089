//! Colors of the plots, which stay apart in print and for color-blind readers.

/// Steps of an ordered quantity, dark to light: the plasma map, cut before it gets too light for white paper.
pub const ORDERED: [[u8; 3]; 6] =
    [[13, 8, 135], [92, 1, 166], [156, 23, 158], [204, 71, 120], [237, 121, 83], [246, 176, 44]];
/// Unordered things, after Okabe and Ito.
pub const DISTINCT: [[u8; 3]; 5] = [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 86, 86]];
/// References.
pub const REFERENCE: [u8; 3] = [33, 37, 41];
