// Copies the finished picture into the viewport of the pass at hand.

@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var picture_sampler: sampler;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

// One triangle that covers the viewport.
@vertex
fn vs_main(@builtin(vertex_index) corner: u32) -> Fragment {
    let at = vec2(f32((corner << 1u) & 2u), f32(corner & 2u));
    var out: Fragment;
    out.clip = vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
    out.at = at;
    return out;
}

// For targets that store encoded colour.
@fragment
fn fs_encoded(in: Fragment) -> @location(0) vec4<f32> {
    return vec4(textureSample(picture, picture_sampler, in.at).rgb, 1.0);
}

// For targets that encode what is written to them.
@fragment
fn fs_linear(in: Fragment) -> @location(0) vec4<f32> {
    return vec4(decode(textureSample(picture, picture_sampler, in.at).rgb), 1.0);
}
