// Handles of constant size on the screen: one quad per point, a disc (locked: a square) with a rim.

struct HandleStyle {
    // Encoded fills: normal, hovered, selected, locked.
    fills: array<vec4<f32>, 4>,
    outline: vec4<f32>,
    // Radius and rim in texels, factor on the alpha, depth steps towards the eye.
    shape: vec4<f32>,
}

@group(1) @binding(0) var<uniform> style: HandleStyle;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) offset: vec2<f32>,
    @location(1) @interpolate(flat) state: u32,
}

const LOCKED: u32 = 3u;

fn radius_of(state: u32) -> f32 {
    var factors = array<f32, 4>(1.0, 1.35, 1.25, 0.8);
    return style.shape.x * factors[state];
}

@vertex
fn vs_main(@builtin(vertex_index) corner: u32, @location(0) position: vec3<f32>, @location(1) state: u32) -> Fragment {
    let center = globals.clip_from_world * vec4(position, 1.0);
    var out: Fragment;
    out.state = min(state, 3u);
    if center.w < globals.depth.z {
        out.clip = vec4(0.0, 0.0, -1.0, 1.0);
        return out;
    }
    let reach = radius_of(out.state) + style.shape.y + 1.0;
    out.offset = reach * vec2(select(-1.0, 1.0, (corner & 1u) != 0u), select(-1.0, 1.0, (corner & 2u) != 0u));
    let place = center.xy / center.w + out.offset / (0.5 * globals.viewport.xy);
    out.clip = vec4(place, nearer(center, style.shape.w) / center.w, 1.0);
    return out;
}

@fragment
fn fs_main(in: Fragment) -> @location(0) vec4<f32> {
    let square = max(abs(in.offset.x), abs(in.offset.y));
    let distance = select(length(in.offset), square, in.state == LOCKED);
    let radius = radius_of(in.state);
    let inside = clamp(radius + 0.5 - distance, 0.0, 1.0);
    let cover = clamp(radius + style.shape.y + 0.5 - distance, 0.0, 1.0);
    let color = mix(style.outline, style.fills[in.state], inside);
    return vec4(color.rgb, color.a * cover * style.shape.z);
}
