//! Every shader parses and validates, and its uniform structs have the layout of their Rust mirrors.

#![cfg(feature = "gui")]

use conformant::render::uniforms;
use std::mem::offset_of;
use std::path::Path;

fn load(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn parse(name: &str) -> naga::Module {
    let source = format!("{}\n{}", load("common.wgsl"), load(name));
    naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{name}:\n{}", e.emit_to_string(&source)))
}

fn passes() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let entries = std::fs::read_dir(folder).expect("the folder of shaders is there");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("readable").file_name().into_string().expect("ASCII names")).collect();
    names.retain(|name| name != "common.wgsl");
    names.sort();
    names
}

#[test]
fn every_shader_is_valid_without_any_extension() {
    let names = passes();
    assert_eq!(names.len(), 6, "one shader per pass: {names:?}");
    for name in names {
        let flags = naga::valid::ValidationFlags::all();
        let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
        let result = validator.validate(&parse(&name));
        assert!(result.is_ok(), "{name}: {}", result.unwrap_err());
    }
}

#[test]
fn every_shader_belongs_to_a_pass_of_the_same_name() {
    for name in passes() {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render").join(name.replace(".wgsl", ".rs"));
        assert!(source.exists(), "{name} has no {}", source.display());
    }
}

/// No storage buffers and no compute: WebGL2 has neither.
#[test]
fn shaders_keep_to_the_limits_of_webgl2() {
    for name in passes() {
        let module = parse(&name);
        let stored = module.global_variables.iter().any(|(_, v)| matches!(v.space, naga::AddressSpace::Storage { .. }));
        assert!(!stored, "{name} uses a storage buffer");
        let computes = module.entry_points.iter().any(|e| e.stage == naga::ShaderStage::Compute);
        assert!(!computes, "{name} computes");
    }
}

/// Holds size and offsets of a struct against the shader's.
macro_rules! assert_layout {
    ($file:literal, $rust:ident { $($field:ident),+ $(,)? }) => {
        let module = parse($file);
        let (_, wgsl) = module
            .types
            .iter()
            .find(|(_, t)| t.name.as_deref() == Some(stringify!($rust)))
            .unwrap_or_else(|| panic!("{} has no struct {}", $file, stringify!($rust)));
        let naga::TypeInner::Struct { members, span } = &wgsl.inner else { panic!("{} is no struct", stringify!($rust)) };
        let ours = [$((stringify!($field), offset_of!(uniforms::$rust, $field))),+];
        let theirs: Vec<(&str, usize)> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        assert_eq!(theirs, ours, "members of {}", stringify!($rust));
        assert_eq!(*span as usize, size_of::<uniforms::$rust>(), "size of {}", stringify!($rust));
        assert!(*span <= 256, "{} fits one style record", stringify!($rust));
    };
}

#[test]
fn uniform_structs_are_laid_out_alike_on_both_sides() {
    assert_layout!("surface.wgsl", Globals { clip_from_world, view_from_world, viewport, depth });
    assert_layout!("surface.wgsl", SurfaceStyle { color, field, finish });
    assert_layout!("lines.wgsl", LineStyle { color, shape });
    assert_layout!("handles.wgsl", HandleStyle { fills, outline, shape });
    assert_layout!("grid.wgsl", GridStyle { color, x_axis, y_axis, place, shape });
}
