// A grid in a plane of constant z, drawn on one quad: thin and strong lines, the two axes, fading outwards.

struct GridStyle {
    // Encoded colours: lines, x axis, y axis.
    color: vec4<f32>,
    x_axis: vec4<f32>,
    y_axis: vec4<f32>,
    // Center x and y, z, half the side of the quad; mm.
    place: vec4<f32>,
    // Distance of thin lines in mm, line width in texels, depth steps away from the eye; 0.
    shape: vec4<f32>,
}

@group(1) @binding(0) var<uniform> style: GridStyle;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

@vertex
fn vs_main(@builtin(vertex_index) corner: u32) -> Fragment {
    let unit = vec2(select(-1.0, 1.0, (corner & 1u) != 0u), select(-1.0, 1.0, (corner & 2u) != 0u));
    var out: Fragment;
    out.at = style.place.xy + style.place.w * unit;
    out.clip = globals.clip_from_world * vec4(out.at, style.place.z, 1.0);
    out.clip.z = nearer(out.clip, -style.shape.z);
    return out;
}

// How much of a texel the lines `spacing` apart cover, for x and y; lines that crowd together fade out.
fn cover(at: vec2<f32>, texel: vec2<f32>, spacing: f32) -> vec2<f32> {
    let from_line = abs(fract(at / spacing + 0.5) - 0.5) * spacing / texel;
    let crowded = smoothstep(vec2(0.08), vec2(0.3), texel / spacing);
    return clamp(0.5 * style.shape.y + 0.5 - from_line, vec2(0.0), vec2(1.0)) * (1.0 - crowded);
}

@fragment
fn fs_main(in: Fragment) -> @location(0) vec4<f32> {
    let texel = max(fwidth(in.at), vec2(1e-9));
    let thin = cover(in.at, texel, style.shape.x);
    let strong = cover(in.at, texel, 10.0 * style.shape.x);
    let lines = max(0.35 * max(thin.x, thin.y), max(strong.x, strong.y));
    // The x axis is where y = 0, and the other way round.
    let axes = clamp(0.75 * style.shape.y + 0.5 - abs(in.at) / texel, vec2(0.0), vec2(1.0));
    var color = vec4(style.color.rgb, style.color.a * lines);
    color = mix(color, style.x_axis, axes.y);
    color = mix(color, style.y_axis, axes.x);
    let outwards = length(in.at - style.place.xy) / style.place.w;
    color.a *= 1.0 - smoothstep(0.2, 1.0, outwards);
    return color;
}
