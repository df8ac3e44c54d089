// Triangles, flat-shaded: the normal is that of the triangle, from screen derivatives.

struct SurfaceStyle {
    // Encoded colour and opacity.
    color: vec4<f32>,
    // Low end and inverse width of the range, row of the map, 1 to paint the field.
    field: vec4<f32>,
    // From 0 matt to 1 metal; rest unused.
    finish: vec4<f32>,
}

@group(0) @binding(1) var color_maps: texture_2d<f32>;
@group(1) @binding(0) var<uniform> style: SurfaceStyle;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) in_view: vec3<f32>,
    @location(1) value: f32,
}

@vertex
fn vs_main(@location(0) position: vec3<f32>, @location(1) value: f32) -> Fragment {
    var out: Fragment;
    out.clip = globals.clip_from_world * vec4(position, 1.0);
    out.in_view = (globals.view_from_world * vec4(position, 1.0)).xyz;
    out.value = value;
    return out;
}

// Key light over the left shoulder, fill light from the right: fixed to the viewer.
const KEY: vec3<f32> = vec3(-0.371, 0.510, 0.776);
const FILL: vec3<f32> = vec3(0.696, -0.087, 0.713);

@fragment
fn fs_main(in: Fragment) -> @location(0) vec4<f32> {
    let to_eye = normalize(mix(vec3(0.0, 0.0, 1.0), -in.in_view, globals.viewport.w));
    let raw = cross(dpdx(in.in_view), dpdy(in.in_view));
    // A triangle seen exactly edge-on has no derivative normal; it then faces the eye.
    var normal = select(to_eye, raw / length(raw), length(raw) > 1e-20);
    normal = select(-normal, normal, dot(normal, to_eye) >= 0.0);
    let facing = clamp(dot(normal, to_eye), 0.0, 1.0);

    if style.field.w > 0.5 {
        // A field keeps its legend's colour where it faces the eye and only darkens as it turns away.
        let t = clamp((in.value - style.field.x) * style.field.y, 0.0, 1.0);
        let texel = vec2(i32(t * 255.0 + 0.5), i32(style.field.z));
        let color = textureLoad(color_maps, texel, 0).rgb;
        return vec4(color * mix(0.68, 1.0, smoothstep(0.0, 0.9, facing)), style.color.a);
    }
    let base = decode(style.color.rgb);
    let up = (globals.view_from_world * vec4(0.0, 0.0, 1.0, 0.0)).xyz;
    let sky = 0.5 + 0.5 * dot(normal, up);
    let key = max(dot(normal, KEY), 0.0);
    let fill = max(dot(normal, FILL), 0.0);
    // The key light falls off faster than a cosine: a gentle bend then shows as a clear gradient.
    let matt = base * (mix(0.17, 0.32, sky) + 0.72 * key * key + 0.16 * fill);
    // Metal mirrors a bright sky over a dark ground, which turns with the bend, and has a highlight of its own colour.
    let mirrored = smoothstep(-0.9, 0.95, dot(reflect(-to_eye, normal), normalize(up + 0.6 * KEY)));
    let gloss = pow(max(dot(normal, normalize(KEY + to_eye)), 0.0), 36.0);
    let metal = base * (0.25 + 0.34 * key + 0.54 * mirrored) + mix(vec3(0.12), base, 0.5) * 0.5 * gloss;
    return vec4(encode(mix(matt, metal, style.finish.x)), style.color.a);
}
