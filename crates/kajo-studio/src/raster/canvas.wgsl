// Shows a picture in all of the viewport, in place of what is there.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var sampling: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn project_picture(@builtin(vertex_index) corner: u32) -> Corner {
    // A triangle around the viewport.
    let uv = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 2.0;
    var out: Corner;
    out.clip = vec4<f32>(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0);
    out.uv = uv;
    return out;
}

@fragment
fn show_picture(in: Corner) -> @location(0) vec4<f32> {
    return textureSample(picture, sampling, in.uv);
}

// For a window that encodes what it is given.
@fragment
fn show_decoded(in: Corner) -> @location(0) vec4<f32> {
    let c = textureSample(picture, sampling, in.uv);
    let dark = c.rgb / 12.92;
    let bright = pow((c.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(bright, dark, c.rgb <= vec3<f32>(0.04045)), c.a);
}
