// Draws the scene as the headlight of the camera lights it, lines of a width in pixels, and the outline of what
// is selected. Colours are encoded for the display, as the window wants them.

struct View {
    clip_from_world: mat4x4<f32>,
    // What a step to the right, one up and one ahead in the picture are in world space, for a depth of one.
    right: vec4<f32>,
    up: vec4<f32>,
    ahead: vec4<f32>,
    // The direction towards the camera where it is the same everywhere (w = 1), or nothing (w = 0).
    to_eye: vec4<f32>,
    // Columns and rows of the picture, and how many of its pixels make a point of the window.
    size: vec2<f32>,
    scale: f32,
    unused: f32,
}

@group(0) @binding(0) var<uniform> view: View;

// ---- surfaces ------------------------------------------------------------------------------------------------

// Drivers that draw on the processor keep some fifty bytes of each triangle for each thing that goes to its
// fragments, and fetch them from memory. So positions are not among them.

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec3<f32>,
    @location(1) n: vec3<f32>,
}

// Its triangles have no normals at their corners.
struct FlatSurface {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec3<f32>,
}

// Its triangles show a part of the picture of all textures.
struct TexturedSurface {
    @builtin(position) clip: vec4<f32>,
    @location(0) texel: vec2<f32>,
    @location(1) n: vec3<f32>,
}

@group(1) @binding(0) var atlas: texture_2d<f32>;
@group(1) @binding(1) var atlas_sampling: sampler;

struct Corner {
    @location(0) p: vec3<f32>,
    @location(1) n: vec4<f32>,
    @location(2) color: vec4<f32>,
}

struct InstanceTransform {
    @location(3) row0: vec4<f32>,
    @location(4) row1: vec4<f32>,
    @location(5) row2: vec4<f32>,
    @location(6) tint: vec4<f32>,
}

fn clip_of(p: vec3<f32>, to: InstanceTransform) -> vec4<f32> {
    let local = vec4<f32>(p, 1.0);
    let world = vec3<f32>(dot(to.row0, local), dot(to.row1, local), dot(to.row2, local));
    return view.clip_from_world * vec4<f32>(world, 1.0);
}

// Normals go by the cofactors of the matrix, its inverse transposed up to a factor.
fn normal_of(n: vec3<f32>, to: InstanceTransform) -> vec3<f32> {
    let cofactors = mat3x3<f32>(
        cross(to.row1.xyz, to.row2.xyz),
        cross(to.row2.xyz, to.row0.xyz),
        cross(to.row0.xyz, to.row1.xyz),
    );
    return n * cofactors;
}

@vertex
fn project_surface(corner: Corner, to: InstanceTransform) -> Surface {
    var out: Surface;
    out.clip = clip_of(corner.p, to);
    out.color = corner.color.rgb * to.tint.rgb;
    out.n = normal_of(corner.n.xyz, to);
    return out;
}

@vertex
fn project_textured(corner: Corner, to: InstanceTransform, @location(7) texel: vec2<f32>) -> TexturedSurface {
    var out: TexturedSurface;
    out.clip = clip_of(corner.p, to);
    out.texel = texel;
    out.n = normal_of(corner.n.xyz, to);
    return out;
}

@vertex
fn project_flat(corner: Corner, to: InstanceTransform) -> FlatSurface {
    var out: FlatSurface;
    out.clip = clip_of(corner.p, to);
    out.color = corner.color.rgb * to.tint.rgb;
    return out;
}

// The way from the eye to a fragment; where that has no beginning, from a point that all of them share.
fn way_to(at: vec4<f32>) -> vec3<f32> {
    let x = 2.0 * at.x / view.size.x - 1.0;
    let y = 1.0 - 2.0 * at.y / view.size.y;
    let depth = select(1.0, at.z, view.to_eye.w == 1.0);
    return (x * view.right.xyz + y * view.up.xyz + depth * view.ahead.xyz) / at.w;
}

fn lit(color: vec3<f32>, n: vec3<f32>, way: vec3<f32>) -> vec4<f32> {
    let to_eye = normalize(select(way, view.to_eye.xyz, view.to_eye.w == 1.0));
    return vec4<f32>(color * (0.28 + 0.72 * abs(dot(normalize(n), to_eye))), 1.0);
}

@fragment
fn shade_surface(in: Surface) -> @location(0) vec4<f32> {
    let way = way_to(in.clip);
    let flat_n = cross(dpdx(way), dpdy(way));
    return lit(in.color, select(in.n, flat_n, dot(in.n, in.n) == 0.0), way);
}

@fragment
fn shade_textured(in: TexturedSurface) -> @location(0) vec4<f32> {
    let way = way_to(in.clip);
    let flat_n = cross(dpdx(way), dpdy(way));
    let color = textureSampleLevel(atlas, atlas_sampling, in.texel, 0.0).rgb;
    return lit(color, select(in.n, flat_n, dot(in.n, in.n) == 0.0), way);
}

@fragment
fn shade_flat(in: FlatSurface) -> @location(0) vec4<f32> {
    let way = way_to(in.clip);
    return lit(in.color, cross(dpdx(way), dpdy(way)), way);
}

@fragment
fn mark_surface(in: FlatSurface) -> @location(0) vec4<f32> {
    return vec4<f32>(1.0);
}

// ---- lines ---------------------------------------------------------------------------------------------------

struct Line {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
}

@vertex
fn project_line(
    @builtin(vertex_index) corner: u32,
    @location(0) from_point: vec4<f32>,
    @location(1) to_point: vec4<f32>,
    @location(2) color: vec4<f32>,
) -> Line {
    var a = view.clip_from_world * vec4<f32>(from_point.xyz, 1.0);
    var b = view.clip_from_world * vec4<f32>(to_point.xyz, 1.0);
    // What lies behind the camera is cut off before anything is divided by its distance.
    let nearest = 1e-5;
    if a.w < nearest && b.w >= nearest {
        a = mix(a, b, (nearest - a.w) / (b.w - a.w));
    } else if b.w < nearest && a.w >= nearest {
        b = mix(b, a, (nearest - b.w) / (a.w - b.w));
    }
    let along = (b.xy / b.w - a.xy / a.w) * view.size;
    let length_px = length(along);
    let direction = select(vec2<f32>(1.0, 0.0), along / length_px, length_px > 1e-6);
    let across = vec2<f32>(-direction.y, direction.x) * from_point.w * view.scale / view.size;
    let side = select(-1.0, 1.0, (corner & 1u) == 1u);
    var end = a;
    if (corner & 2u) == 2u {
        end = b;
    }
    // A hair towards the camera, so that lines on surfaces are seen whole.
    var out: Line;
    out.clip = vec4<f32>(end.xy + side * across * end.w, end.z - 2e-5 * end.w, end.w);
    if a.w < nearest || b.w < nearest {
        out.clip = vec4<f32>(2.0, 2.0, 2.0, 1.0);
    }
    out.color = color;
    return out;
}

@fragment
fn shade_line(in: Line) -> @location(0) vec4<f32> {
    return vec4<f32>(in.color.rgb * in.color.a, in.color.a);
}

@fragment
fn shade_hidden_line(in: Line) -> @location(0) vec4<f32> {
    let a = in.color.a * 0.3;
    return vec4<f32>(in.color.rgb * a, a);
}

// ---- the outline of the selection ------------------------------------------------------------------------------

@group(0) @binding(1) var marked: texture_2d<f32>;

@vertex
fn project_outline(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    let x = f32(corner & 1u) * 4.0 - 1.0;
    let y = f32(corner >> 1u) * 4.0 - 1.0;
    return vec4<f32>(x, y, 0.0, 1.0);
}

fn is_marked(at: vec2<i32>) -> bool {
    let last = vec2<i32>(view.size) - 1;
    return textureLoad(marked, clamp(at, vec2<i32>(0), last), 0).r > 0.5;
}

@fragment
fn shade_outline(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let p = vec2<i32>(at.xy);
    if is_marked(p) {
        discard;
    }
    let r = max(i32(round(1.6 * view.scale)), 1);
    let near = is_marked(p + vec2<i32>(r, 0)) || is_marked(p - vec2<i32>(r, 0))
        || is_marked(p + vec2<i32>(0, r)) || is_marked(p - vec2<i32>(0, r))
        || is_marked(p + vec2<i32>(1, 1)) || is_marked(p - vec2<i32>(1, 1))
        || is_marked(p + vec2<i32>(1, -1)) || is_marked(p - vec2<i32>(1, -1));
    if !near {
        discard;
    }
    return vec4<f32>(1.0, 0.66, 0.2, 1.0);
}
