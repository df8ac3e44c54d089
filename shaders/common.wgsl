// What every pass of the scene shares; put in front of each of the other files. Depth is reversed: 1 near, 0 far.

struct Globals {
    clip_from_world: mat4x4<f32>,
    view_from_world: mat4x4<f32>,
    // Width and height in texels, texels per point, 1 in perspective and 0 in orthographic views.
    viewport: vec4<f32>,
    // Factor and summand that bring depth one step nearer; near plane as the least w; 0.
    depth: vec4<f32>,
}

@group(0) @binding(0) var<uniform> globals: Globals;

// Depth of `clip` brought `steps` nearer to the eye (farther where negative), in clip space.
fn nearer(clip: vec4<f32>, steps: f32) -> f32 {
    return clip.z * (1.0 + steps * globals.depth.x) + steps * globals.depth.y * clip.w;
}

fn decode(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

fn encode(c: vec3<f32>) -> vec3<f32> {
    let x = clamp(c, vec3(0.0), vec3(1.0));
    return select(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3(0.0031308));
}
