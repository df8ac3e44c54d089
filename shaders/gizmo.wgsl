// Triangles that are already on the screen, in drawing order.

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
}

@vertex
fn vs_main(@location(0) place: vec2<f32>, @location(1) color: vec4<f32>) -> Fragment {
    var out: Fragment;
    out.clip = vec4(place, 0.5, 1.0);
    out.color = color;
    return out;
}

@fragment
fn fs_main(in: Fragment) -> @location(0) vec4<f32> {
    return in.color;
}
