// Shaders of the interactive page, one after the other; a line "//// name" begins each. The page puts "#version 300 es" before
// them, and before every vertex shader NX, NY, NZ (control points per axis), WX, WY, WZ (those that count at a place), MOST (the
// largest of these), BX, BY, BZ (basis of an axis: 0 Bezier, 1 B-splines, 2 patches) and "volume".

//// volume
precision highp float;
precision highp int;
uniform highp sampler2D points;                       // p_ijk at texel (i + NX j, k), relative to the scene's centre
vec3 point(int i, int j, int k) { return texelFetch(points, ivec2(i + NX * j, k), 0).xyz; }
vec3 point(int p) { return texelFetch(points, ivec2(p % (NX * NY), p / (NX * NY)), 0).xyz; }

// What counts along an axis: weights b of the control points from `first` on, their derivatives d by the place at rest, the place.
struct Axis { int first; float place, b[MOST], d[MOST]; };

// Bernstein polynomials of degree n - 1 at t and their derivatives, by raising the degree (Xia & Wang 2009, eq. (2)).
Axis bernstein(float t, int n) {
  Axis a;
  a.first = 0;
  a.place = t;
  a.b[0] = 1.0;
  for (int m = 1; m < n; m++) {
    if (m == n - 1) for (int i = 0; i < n; i++) a.d[i] = float(m) * ((i > 0 ? a.b[i - 1] : 0.0) - (i < m ? a.b[i] : 0.0));
    float carried = 0.0;
    for (int i = 0; i < m; i++) { float old = a.b[i]; a.b[i] = carried + (1.0 - t) * old; carried = t * old; }
    a.b[m] = carried;
  }
  return a;
}

// Clamped uniform cubic B-splines at the parameter s, 0 to n - 3, by Cox's and de Boor's recurrence. Control points stand
// at equal distances at rest, so that the place is a sum of weights too, and slope is how fast it moves with s.
Axis bsplines(float s, int n) {
  Axis a;
  a.first = clamp(int(s), 0, n - 4);
  a.b[0] = 1.0;
  float slope = 0.0;
  for (int m = 1; m < 4; m++) {
    float rising = 0.0, last = 0.0;
    for (int r = 0; r < m; r++) {
      float low = float(max(a.first + 1 - m + r, 0)), high = float(min(a.first + r + 1, n - 3)), part = a.b[r] / (high - low);
      a.b[r] = rising + (high - s) * part;
      rising = (s - low) * part;
      if (m == 3) { a.d[r] = last - part; last = part; slope += part; }
    }
    a.b[m] = rising;
    a.d[m] = last;
  }
  for (int r = 0; r < 4; r++) a.d[r] *= float(n - 1) / slope;
  a.place = (float(a.first) + a.b[1] + 2.0 * a.b[2] + 3.0 * a.b[3]) / float(n - 1);
  return a;
}

// Bernstein polynomials of degree 3 of the patch that s lies in, 0 to the number of patches.
Axis patches(float s, int n) {
  int count = n / 3, number = clamp(int(s), 0, count - 1);
  Axis a = bernstein(s - float(number), 4);
  a.first = 3 * number;
  a.place = s / float(count);
  for (int r = 0; r < 4; r++) a.d[r] *= float(count);
  return a;
}

Axis along(float t, int n, int basis) {
  if (basis == 1) return bsplines(t, n);
  if (basis == 2) return patches(t, n);
  return bernstein(t, n);
}

// Q(u,v,w) of eq. (1) and the place at rest; the columns of `derivative` are Q's derivatives by this place, in units of the box.
vec3 evaluate(vec3 u, out mat3 derivative, out vec3 place) {
  Axis x = along(u.x, NX, BX), y = along(u.y, NY, BY), z = along(u.z, NZ, BZ);
  vec3 q = vec3(0);
  derivative = mat3(0);
  place = vec3(x.place, y.place, z.place);
  for (int k = 0; k < WZ; k++) for (int j = 0; j < WY; j++) {
    vec3 line = vec3(0), slope = vec3(0);
    for (int i = 0; i < WX; i++) { vec3 p = point(x.first + i, y.first + j, z.first + k); line += x.b[i] * p; slope += x.d[i] * p; }
    q += y.b[j] * z.b[k] * line;
    derivative += mat3(y.b[j] * z.b[k] * slope, y.d[j] * z.b[k] * line, y.b[j] * z.d[k] * line);
  }
  return q;
}

//// object-vertex
layout(location = 0) in vec3 coordinates;             // parameters of the vertex
layout(location = 1) in vec3 normal;                  // of the surface at rest
layout(location = 2) in vec2 uv;
layout(location = 3) in vec3 tint;
layout(location = 4) in vec4 atlas;                   // where it is in the atlas of taxels; whether it is on some
uniform mat4 camera;
uniform vec3 origin, size;
out vec4 taxel;
out vec3 world, shading, cell, shade;
out vec2 skin_place;
out float displacement, strain;
void main() {
  mat3 derivative;
  vec3 place;
  world = evaluate(coordinates, derivative, place);
  mat3 F = mat3(derivative[0] / size.x, derivative[1] / size.y, derivative[2] / size.z);
  shading = mat3(cross(F[1], F[2]), cross(F[2], F[0]), cross(F[0], F[1])) * normal;   // areas deform by the cofactors of F
  mat3 green = 0.5 * (transpose(F) * F - mat3(1));
  strain = sqrt(dot(green[0], green[0]) + dot(green[1], green[1]) + dot(green[2], green[2]));
  displacement = distance(world, origin + size * place);
  skin_place = uv;
  shade = tint;
  taxel = atlas;
  cell = place * vec3(NX - 1, NY - 1, NZ - 1);
  gl_Position = camera * vec4(world, 1);
}

//// object-fragment
precision highp float;
in vec4 taxel;
in vec3 world, shading, cell, shade;
in vec2 skin_place;
in float displacement, strain;
uniform vec3 eye, up, key;
uniform float colouring, largest, cage, hollow;       // colouring 0: paint, 1: displacement, 2: strain, 3: cells, 4: taxels; hollow: hatched from within
uniform sampler2D ramp, skin;
uniform highp sampler3D cells;                        // or taxels: share of the scale, whether turned inside out
out vec4 colour;
float cell_lines() {
  vec3 width = max(fwidth(cell), 1e-6), near = abs(fract(cell - 0.5) - 0.5) / width;
  vec3 inside = step(1e-4, width);                    // the coordinate that is constant on a face draws no line
  vec3 line = (1.0 - smoothstep(0.4, 1.4, near)) * inside;
  return max(line.x, max(line.y, line.z));
}
void main() {
  vec3 view = normalize(eye - world), facet = cross(dFdx(world), dFdy(world));
  facet *= sign(dot(facet, view));
  vec3 n = normalize(shading);
  n = dot(n, facet) < 0.0 ? -n : n;                   // a surface seen from its back is lit like its front
  float value = colouring < 1.5 ? displacement : strain;
  bool painted = colouring < 0.5;
  vec2 inner = colouring > 3.5 ? taxel.w * texture(cells, taxel.xyz).rg : texture(cells, cell / vec3(textureSize(cells, 0))).rg;
  float share = colouring > 2.5 ? inner.r : value / largest;
  vec3 ramped = texture(ramp, vec2(clamp(share, 0.0, 1.0), 0.5)).rgb;
  if (colouring > 2.5 && inner.g > 0.0) ramped = vec3(0.5);
  vec3 base = pow(painted ? shade * texture(skin, skin_place).rgb : ramped, vec3(2.2));
  if (cage > 0.5) base *= 1.0 - 0.45 * cell_lines();
  if (hollow > 0.5 && dot(shading, view) < 0.0) base *= 0.7 + 0.3 * step(0.35, fract((gl_FragCoord.x + gl_FragCoord.y) / 16.0));
  float diffuse = max((dot(n, key) + 0.15) / 1.15, 0.0), sky = 0.5 + 0.5 * dot(n, up);
  float gloss = pow(max(dot(n, normalize(key + view)), 0.0), 70.0), rim = pow(1.0 - max(dot(n, view), 0.0), 4.0);
  vec3 light = base * (mix(vec3(0.12, 0.115, 0.11), vec3(0.34, 0.37, 0.42), sky) + 0.80 * diffuse);
  light += (painted ? 1.0 : 0.35) * (0.30 * gloss + 0.16 * rim * sky);
  colour = vec4(pow(min(light, 1.0), vec3(1.0 / 2.2)), 1);
}

//// solid-vertex
layout(location = 0) in vec3 place;                   // along the solid's own axes
layout(location = 1) in vec3 outward;
uniform mat4 camera;
uniform vec3 anchor, normal, tangent, tint;
out vec4 taxel;
out vec3 world, shading, cell, shade;
out vec2 skin_place;
out float displacement, strain;
void main() {
  mat3 axes = mat3(tangent, cross(normal, tangent), normal);
  world = anchor + axes * place;
  shading = axes * outward;
  shade = tint;
  cell = vec3(0);
  taxel = vec4(0);
  skin_place = vec2(0);
  displacement = strain = 0.0;
  gl_Position = camera * vec4(world, 1);
}

//// height-vertex
// Shadow on a plane: the height of object and solids above the patch, then the share of the sky that they hide from each texel.
layout(location = 0) in vec3 coordinates;
uniform vec3 centre, normal, tangent;
uniform float reach;
out float height;
void main() {
  mat3 derivative;
  vec3 place, offset = (evaluate(coordinates, derivative, place) - centre) / reach;
  height = dot(offset, normal);
  gl_Position = vec4(dot(offset, tangent), dot(offset, cross(normal, tangent)), 0, 1);
}

//// solid-height-vertex
layout(location = 0) in vec3 place;                   // along the solid's own axes, of which the first and the third are given
uniform vec3 centre, normal, tangent, anchor, first, pole;
uniform float reach;
out float height;
void main() {
  vec3 offset = (anchor + mat3(first, cross(pole, first), pole) * place - centre) / reach;
  height = dot(offset, normal);
  gl_Position = vec4(dot(offset, tangent), dot(offset, cross(normal, tangent)), 0, 1);
}

//// height-fragment
precision highp float;
in float height;
out vec4 colour;
void main() {
  if (height < -0.01) discard;                        // what is below the plane casts no shadow on it
  colour = vec4(clamp(height, 0.0, 1.0));
}

//// cover-vertex
out vec2 place;
void main() { place = vec2(gl_VertexID & 1, gl_VertexID >> 1); gl_Position = vec4(2.0 * place - 1.0, 0, 1); }

//// occlusion-fragment
precision highp float;
in vec2 place;
uniform sampler2D heights;
out vec4 colour;
const int TAPS = 96;
const float REACH = 0.5;                              // how far a shadow spreads, in patch radii
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy) % 4;           // 16 turns of the spiral, averaged over 4 x 4 texels when the plane is drawn
  float hidden = 0.0, turn = float(texel.x + 4 * texel.y) / 16.0;
  for (int i = 0; i < TAPS; i++) {                    // a spiral, denser near the middle; each tap stands for its share of area
    float r = REACH * (float(i) + turn) / float(TAPS), angle = 2.399963 * float(i) + 6.283185 * fract(turn * 7.0);
    float h = texture(heights, place + 0.5 * r * vec2(cos(angle), sin(angle))).r;
    float floored = max(h, 2.0 * REACH / float(TAPS)), reach2 = floored * floored + r * r;
    if (h < 0.999) hidden += 2.0 * r * REACH / float(TAPS) * floored * floored / (reach2 * reach2);
  }
  colour = vec4(min(hidden, 1.0));
}

//// plane-vertex
uniform mat4 camera;
uniform vec3 centre, normal, tangent;
uniform vec2 extent;                                  // of the patch, in units of reach
uniform float reach;
out vec3 world;
out vec2 patch_place;
void main() {
  patch_place = extent * (2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0);
  world = centre + reach * (patch_place.x * tangent + patch_place.y * cross(normal, tangent));
  gl_Position = camera * vec4(world, 1);
}

//// plane-fragment
precision highp float;
in vec3 world;
in vec2 patch_place;
uniform vec3 anchor, normal, tangent, tint, eye;
uniform vec4 floors[4];                               // normal and distance; of a plate nothing is drawn below them
uniform vec2 extent;
uniform float spacing, plate;
uniform sampler2D shadow;
out vec4 colour;
float grid(float step_width) {
  vec2 at = vec2(dot(world - anchor, tangent), dot(world - anchor, cross(normal, tangent))) / step_width;
  vec2 width = fwidth(at), line = 1.0 - smoothstep(0.5 * width, 1.5 * width, abs(fract(at - 0.5) - 0.5));
  return max(line.x, line.y) * (1.0 - smoothstep(0.2, 0.7, max(width.x, width.y)));
}
float hatch(float step_width) {                       // what is seen from its solid side
  float at = dot(world - anchor, tangent + cross(normal, tangent)) / step_width, width = fwidth(at);
  float line = 1.0 - smoothstep(0.11, 0.11 + width, abs(fract(at) - 0.5));
  return mix(line, 0.25, smoothstep(0.3, 0.9, width));
}
float shade(vec2 at, vec2 texel) {
  return 0.25 * (texture(shadow, at + texel).r + texture(shadow, at - texel).r
    + texture(shadow, at + vec2(texel.x, -texel.y)).r + texture(shadow, at + vec2(-texel.x, texel.y)).r);
}
void main() {
  for (int i = 0; i < 4; i++) if (plate > 0.5 && dot(world, floors[i].xyz) < floors[i].w) discard;
  vec2 inside = extent - abs(patch_place), pixel = fwidth(patch_place);
  float rim = 1.0 - smoothstep(1.0, 2.0, min(inside.x / pixel.x, inside.y / pixel.y));
  float fade = plate > 0.5 ? 1.0 : 1.0 - smoothstep(0.55, 1.0, length(patch_place));
  float solid = plate > 0.5 ? 0.45 : 0.62;
  bool front = dot(eye - world, normal) > 0.0;
  float hidden = front ? 0.8 * shade(0.5 * patch_place + 0.5, 1.0 / vec2(textureSize(shadow, 0))) : 0.0;
  float lines = 0.28 * grid(spacing) + 0.22 * grid(5.0 * spacing) + 0.6 * rim * plate;
  vec3 base = mix(tint, tint * 0.45, lines);
  float cover = front ? solid + (1.0 - solid) * lines : 0.08 + 0.30 * hatch(0.5 * spacing) + 0.5 * (1.0 - solid) * lines;
  colour = vec4(base * (1.0 - hidden), fade * (cover + (1.0 - cover) * hidden));
}

//// line-vertex
layout(location = 0) in ivec2 ends;
uniform mat4 camera;
uniform vec2 viewport;
uniform float width;
out float side;
void main() {
  vec4 a = camera * vec4(point(ends.x), 1), b = camera * vec4(point(ends.y), 1);
  if (a.w < 1e-3) a = mix(b, a, (b.w - 1e-3) / (b.w - a.w));
  if (b.w < 1e-3) b = mix(a, b, (a.w - 1e-3) / (a.w - b.w));
  vec2 along = normalize((b.xy / b.w - a.xy / a.w) * viewport + vec2(1e-6, 0));
  vec4 end = gl_VertexID < 2 ? a : b;
  side = float(2 * (gl_VertexID & 1) - 1) * (width + 1.0);
  end.xy += side * vec2(-along.y, along.x) / viewport * end.w;
  gl_Position = end;
}

//// line-fragment
precision highp float;
in float side;
uniform vec4 ink;
uniform float width;
out vec4 colour;
void main() { colour = vec4(ink.rgb, ink.a * clamp(width + 0.5 - abs(side), 0.0, 1.0)); }

//// ball-vertex
layout(location = 0) in float pinned;
uniform mat4 camera;
uniform vec3 free_colour, pinned_colour;
uniform float diameter, least, most, alone;           // alone: 1 where pinned points are drawn alone
out vec3 base;
void main() {
  if (alone > pinned) { gl_Position = vec4(2, 2, 2, 1); return; }
  base = pinned > 0.5 ? pinned_colour : free_colour;
  gl_Position = camera * vec4(point(gl_VertexID), 1);
  gl_PointSize = clamp(diameter / gl_Position.w, least, most);
}

//// ball-fragment
precision highp float;
in vec3 base;
uniform float opacity;
out vec4 colour;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float r = length(at), edge = fwidth(r);
  if (r > 1.0) discard;
  vec3 n = vec3(at.x, -at.y, sqrt(max(1.0 - r * r, 0.0)));
  float light = 0.55 + 0.5 * max(dot(n, normalize(vec3(-0.4, 0.7, 0.6))), 0.0);
  colour = vec4(base * light + 0.25 * pow(max(n.z * 0.75 + n.y * 0.45 - n.x * 0.25, 0.0), 20.0), opacity * (1.0 - smoothstep(1.0 - edge, 1.0, r)));
}

//// dot-vertex
layout(location = 0) in vec3 place;
uniform mat4 camera;
uniform float diameter;
void main() {
  gl_Position = camera * vec4(place, 1);
  gl_Position.z -= 3e-4 * gl_Position.w;              // in front of what it touches
  gl_PointSize = diameter;
}

//// dot-fragment
precision highp float;
uniform vec4 mark;
uniform vec3 outline;
out vec4 colour;
void main() {
  float r = length(2.0 * gl_PointCoord - 1.0), edge = fwidth(r);
  if (r > 1.0) discard;
  colour = vec4(mix(mark.rgb, outline, smoothstep(0.65 - edge, 0.65, r)), mark.a * (1.0 - smoothstep(1.0 - edge, 1.0, r)));
}

//// arrow-vertex
uniform mat4 camera;
uniform vec3 start, end;
uniform vec2 viewport;
uniform float width, extra;                           // of the shaft, and how much larger all is, pixels
void main() {
  vec4 a = camera * vec4(start, 1), b = camera * vec4(end, 1);
  if (a.w < 1e-3) a = mix(b, a, (b.w - 1e-3) / (b.w - a.w));
  if (b.w < 1e-3) b = mix(a, b, (a.w - 1e-3) / (a.w - b.w));
  vec2 from = 0.5 * viewport * a.xy / a.w, to = 0.5 * viewport * b.xy / b.w, way = to - from + vec2(0, 1e-6);
  vec2 along = normalize(way), side = vec2(along.y, -along.x);
  float wide = min(width, length(way) / 6.5), rim = extra * wide / width;   // a short arrow is small as a whole
  vec2 neck = to - along * 4.0 * wide;
  bool head = gl_VertexID > 5;
  vec2 at;
  if (head) {
    float wing = 1.6 * (wide + rim);
    at = gl_VertexID == 8 ? to + 2.0 * rim * along : neck - rim * along + (gl_VertexID == 6 ? wing : -wing) * side;
  } else {
    bool far = gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5;
    bool left = gl_VertexID == 1 || gl_VertexID == 3 || gl_VertexID == 4;
    at = (far ? neck : from - rim * along) + (left ? -1.0 : 1.0) * (0.5 * wide + rim) * side;
  }
  vec4 end_point = head || gl_VertexID == 2 || gl_VertexID > 3 ? b : a;
  gl_Position = vec4(2.0 * at / viewport * end_point.w, end_point.zw);
}

//// flat-fragment
precision highp float;
uniform vec4 ink;
out vec4 colour;
void main() { colour = ink; }
