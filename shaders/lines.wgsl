// Lines of constant width on the screen: one quad per edge, smoothed across.

struct LineStyle {
    // Encoded colour and opacity.
    color: vec4<f32>,
    // Width in texels, depth steps towards the eye; rest unused.
    shape: vec4<f32>,
}

@group(1) @binding(0) var<uniform> style: LineStyle;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    // Texels from the middle of the line.
    @location(0) across: f32,
}

@vertex
fn vs_main(@builtin(vertex_index) corner: u32, @location(0) from_world: vec3<f32>, @location(1) to_world: vec3<f32>) -> Fragment {
    var a = globals.clip_from_world * vec4(from_world, 1.0);
    var b = globals.clip_from_world * vec4(to_world, 1.0);
    // The part behind the near plane is cut off, so that the division below is safe.
    let least = globals.depth.z;
    var out: Fragment;
    if a.w < least && b.w < least {
        out.clip = vec4(0.0, 0.0, -1.0, 1.0);
        return out;
    }
    if a.w < least {
        a = mix(b, a, (b.w - least) / (b.w - a.w));
    } else if b.w < least {
        b = mix(a, b, (a.w - least) / (a.w - b.w));
    }
    let half_size = 0.5 * globals.viewport.xy;
    let p = a.xy / a.w * half_size;
    let q = b.xy / b.w * half_size;
    let span = q - p;
    let along = select(vec2(1.0, 0.0), span / length(span), length(span) > 1e-6);
    // One texel of room for the smooth edge.
    let reach = 0.5 * max(style.shape.x, 1.0) + 1.0;
    let side = select(-reach, reach, (corner & 2u) != 0u);
    let end = select(a, b, (corner & 1u) != 0u);
    let place = select(p, q, (corner & 1u) != 0u) + side * vec2(-along.y, along.x);
    // With w = 1 all interpolation is linear on the screen.
    out.clip = vec4(place / half_size, nearer(end, style.shape.y) / end.w, 1.0);
    out.across = side;
    return out;
}

@fragment
fn fs_main(in: Fragment) -> @location(0) vec4<f32> {
    let width = style.shape.x;
    let cover = clamp(0.5 * max(width, 1.0) + 0.5 - abs(in.across), 0.0, 1.0) * min(width, 1.0);
    return vec4(style.color.rgb, style.color.a * cover);
}
