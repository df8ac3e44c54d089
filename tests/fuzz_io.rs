//! Mutated files: every reader answers with a value or a message, never with a panic, and soon.

use conformant::geometry::{DVec3, Facet, Plc, Region, RegionId, RegionRole, VertexId};
use conformant::io::{
    CERTIFICATE_FILE, ExportOptions, GLTF_FILE, OBJ_FILE, csv, export, gltf, import, obj, stl, surface_json, verify,
};
use std::fs;
use std::path::Path;

/// Two tetrahedra with a face in common, m.
fn pair() -> Plc {
    let region = |name: &str, role, eps_r| Region { name: name.to_owned(), role, eps_r, tan_delta: 0.0 };
    let facet = |corners: [usize; 3], back, front| Facet {
        vertices: corners.map(VertexId::new),
        back: RegionId::new(back),
        front: RegionId::new(front),
    };
    let vertices = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.25, 0.0], [0.1, 0.1, 1.0], [0.3, 0.2, -1.7]];
    Plc {
        vertices: vertices.map(|v| DVec3::from_array(v) * 1e-3).to_vec(),
        facets: vec![
            facet([0, 2, 1], 1, 2),
            facet([0, 1, 3], 1, 0),
            facet([1, 2, 3], 1, 0),
            facet([2, 0, 3], 1, 0),
            facet([0, 4, 1], 2, 0),
            facet([1, 4, 2], 2, 0),
            facet([2, 4, 0], 2, 0),
        ],
        regions: vec![
            region("air", RegionRole::Air, 1.0),
            region("substrate", RegionRole::Dielectric, 2.33),
            region("ground", RegionRole::Conductor, 1.0),
        ],
    }
}

/// Bytes that stand for trouble in binary files: huge counts, infinities, NaN, negative zero.
const WORDS: [[u8; 4]; 6] =
    [[0xFF; 4], [0xFF, 0xFF, 0xFF, 0x7F], [0, 0, 0x80, 0x7F], [0, 0, 0xC0, 0x7F], [0, 0, 0, 0x80], [0, 0, 0, 0x40]];
/// And in text.
const TOKENS: [&str; 14] = [
    "nan",
    "inf",
    "1e999",
    "-1",
    "0",
    "-9223372036854775808",
    "18446744073709551615",
    "4294967295",
    "1e-99999999999",
    "\u{fffd}",
    "\"",
    "{}",
    "[[[[",
    "null",
];

/// One to four random changes: bits, words, tokens in the place of numbers, cuts, doubled and removed chunks.
fn mutate(seed: &[u8], rng: &mut fastrand::Rng) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..rng.usize(1..5) {
        if bytes.len() < 8 {
            break;
        }
        let at = rng.usize(0..bytes.len());
        let end = (at + rng.usize(1..64)).min(bytes.len());
        match rng.u32(0..7) {
            0 => bytes[at] ^= 1 << rng.u32(0..8),
            1 => {
                let at = at.min(bytes.len() - 4);
                bytes[at..at + 4].copy_from_slice(rng.choice(&WORDS).expect("not empty"));
            }
            2 => {
                let is_number = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-');
                let start = bytes[at..].iter().position(is_number).map_or(at, |k| at + k);
                let length = bytes[start..].iter().take_while(|b| is_number(b)).count();
                bytes.splice(start..start + length, rng.choice(TOKENS).expect("not empty").bytes());
            }
            3 if rng.u32(0..4) == 0 => bytes.truncate(at),
            4 => {
                let chunk = bytes[at..end].to_vec();
                bytes.splice(at..at, chunk);
            }
            5 => drop(bytes.drain(at..end)),
            _ => bytes[at] = rng.u8(..),
        }
    }
    bytes
}

/// The message of an error must say something.
fn judge<T, E: std::fmt::Display>(result: Result<T, E>, tally: &mut [usize; 2]) {
    match result {
        Ok(_) => tally[0] += 1,
        Err(e) => {
            assert!(e.to_string().len() > 10, "a message that helps nobody: {e}");
            tally[1] += 1;
        }
    }
}

fn fuzz<T, E: std::fmt::Display>(seed: &[u8], count: u64, parse: impl Fn(&[u8]) -> Result<T, E>) {
    assert!(parse(seed).is_ok(), "the seed itself is read");
    let mut tally = [0; 2];
    for case in 0..count {
        judge(parse(&mutate(seed, &mut fastrand::Rng::with_seed(case))), &mut tally);
    }
    assert!(tally[1] > 0, "some mutations are refused: {tally:?}");
}

fn exported(name: &str) -> Vec<u8> {
    let dir = tempfile::tempdir().expect("a temporary folder");
    export(&pair(), dir.path(), &ExportOptions::default()).expect("a valid complex");
    fs::read(dir.path().join(name)).expect("an exported file")
}

#[test]
fn mutated_stl_files_give_a_value_or_a_message() {
    fuzz(&exported("substrate.stl"), 2500, stl::parse);
    let facet = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5 0 0\n   vertex 0 2.5 -1e-3\n  endloop\n endfacet\n";
    let text = format!("solid a\n{}endsolid a\n", facet.repeat(4));
    fuzz(text.as_bytes(), 2500, stl::parse);
}

#[test]
fn mutated_obj_and_csv_files_give_a_value_or_a_message() {
    fuzz(&exported(OBJ_FILE), 2000, obj::parse);
    fuzz(b"0.5,1,2\n-1e-3,2,3\n4,5,6\n", 500, csv::parse_points);
}

#[test]
fn mutated_surfaces_give_a_value_or_a_message() {
    let seed = br#"{"regions": {"0": "outside", "1": "substrate", "2": "pin metal"}, "eps_r": {"1": 2.33},
        "sheet": {"0": "interface", "1": "PEC sheet", "2": "lid"}, "sheet_role": {"2": "outer"},
        "V": [[0, 0, 0], [1.5, 0, 0], [0, 2.25, 0], [0.1, 0.1, 1], [0.3, 0.2, -1.7]],
        "F": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 4, 1], [1, 4, 2], [2, 4, 0]],
        "region_pair": [[1, 2], [1, 0], [1, 0], [1, 0], [2, 0], [2, 0], [2, 0]],
        "sheet_tag": [0, 2, 2, 1, 0, 0, 0]}"#;
    let checked = |bytes: &[u8]| {
        let surface = surface_json::parse(bytes).map_err(|e| e.to_string())?;
        surface.check().map_err(|e| e.to_string())
    };
    fuzz(seed, 2500, checked);
}

#[test]
fn mutated_gltf_files_give_a_value_or_a_message() {
    let seed = exported(GLTF_FILE);
    fuzz(&seed, 1500, gltf::parse);
    // With lengths that agree again, so that the mutation reaches what the container guards.
    let json = usize::try_from(u32::from_le_bytes(seed[12..16].try_into().unwrap())).unwrap();
    let (json, bin) = (&seed[20..20 + json], &seed[28 + json..]);
    let whole = |json: &[u8], bin: &[u8]| {
        let length = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap().to_le_bytes();
        let mut bytes =
            [&b"glTF"[..], &[2, 0, 0, 0], &[0; 4], &length(json), b"JSON", json, &length(bin), b"BIN\0", bin].concat();
        let total = length(&bytes);
        bytes[8..12].copy_from_slice(&total);
        bytes
    };
    fuzz(json, 2500, |json| gltf::parse(&whole(json, bin)));
    fuzz(bin, 500, |bin| gltf::parse(&whole(json, bin)));
}

#[test]
fn mutated_folders_give_a_finding_or_a_message() {
    let dir = tempfile::tempdir().unwrap();
    let written = export(&pair(), dir.path(), &ExportOptions::default()).unwrap();
    let mut tally = [0; 2];
    for case in 0..1000 {
        let mut rng = fastrand::Rng::with_seed(case);
        let path: &Path = rng.choice(&written.files).unwrap();
        let old = fs::read(path).unwrap();
        let new = mutate(&old, &mut rng);
        fs::write(path, &new).unwrap();
        let source = if rng.bool() { dir.path() } else { path };
        judge(import(source), &mut tally);
        match verify(dir.path()) {
            Ok(found) => {
                let harmless = path.ends_with(CERTIFICATE_FILE) || new == old;
                assert!(harmless || !found.is_valid(), "case {case}: {} was changed", path.display());
            }
            Err(e) => assert!(path.ends_with(CERTIFICATE_FILE) && e.to_string().len() > 10, "case {case}: {e}"),
        }
        fs::write(path, old).unwrap();
    }
    assert!(tally[0] > 0 && tally[1] > 0, "some imports work and some do not: {tally:?}");
    assert!(verify(dir.path()).unwrap().is_valid(), "as it was");
}
