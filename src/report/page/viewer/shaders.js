// Shaders (GLSL ES 3.00). Input colours are sRGB; output colours have premultiplied alpha.

const SOLID_VERTEX = `#version 300 es
in vec3 position;
in vec3 normal;
uniform mat4 model, camera;
uniform vec2 viewport;
uniform float grow, parallelView;
uniform vec3 eye;
out vec3 place;
out vec3 facing;
void main() {
  vec4 world = model * vec4(position, 1.0);
  place = world.xyz;
  facing = mat3(model) * normal;
  gl_Position = camera * world;
  if (grow > 0.0) {
    vec2 away = (camera * vec4(facing, 0.0)).xy * viewport;
    float far = length(away);
    // A vertex seen from the front is not moved, because a movement would flip its faces.
    float front = abs(dot(normalize(facing), normalize(eye - place * (1.0 - parallelView))));
    float share = 1.0 - smoothstep(0.6, 0.9, front);
    if (far > 1e-6) gl_Position.xy += away / far * grow * share * 2.0 / viewport * gl_Position.w;
  }
}`;

// Shading: hemisphere light from the sky, a key light with a soft shadow, a weak specular highlight.
const LIGHT = `
uniform highp sampler2DShadow shadowMap;
uniform mat4 shadowCamera;
uniform vec3 sun, eye;
uniform float parallelView;
float lit(vec3 place, vec3 n, float soft) {
  vec4 seen = shadowCamera * vec4(place + n * 6.0, 1.0);
  vec3 at = seen.xyz * 0.5 + 0.5;
  if (at.x <= 0.0 || at.y <= 0.0 || at.x >= 1.0 || at.y >= 1.0 || at.z >= 1.0) return 1.0;
  float sum = 0.0;
  // Percentage-closer filtering from the rim inwards; if four samples agree, the other samples are skipped.
  for (int k = 15; k >= 0; k--) {
    float turn = 2.399963 * float(k);
    float far = sqrt((float(k) + 0.5) / 16.0) * soft;
    sum += texture(shadowMap, vec3(at.xy + vec2(cos(turn), sin(turn)) * far, at.z - 0.0012));
    if (k == 12 && (sum < 0.001 || sum > 3.999)) return sum / 4.0;
  }
  return sum / 16.0;
}
vec3 shaded(vec3 colour, vec3 place, vec3 n) {
  vec3 base = pow(colour, vec3(2.2));
  vec3 sky = mix(vec3(0.30, 0.29, 0.29), vec3(0.62, 0.64, 0.68), n.z * 0.5 + 0.5);
  float key = max(dot(n, sun), 0.0);
  if (key > 0.0) key *= lit(place, n, 0.0035);
  vec3 back = normalize(eye - place * (1.0 - parallelView));
  float rim = pow(1.0 - max(dot(n, back), 0.0), 3.0) * 0.10;
  float shine = pow(max(dot(n, normalize(sun + back)), 0.0), 36.0) * 0.10 * step(0.001, key);
  vec3 light = base * (sky + key * vec3(0.78, 0.76, 0.72)) + rim * sky + shine;
  return pow(min(light, vec3(1.0)), vec3(1.0 / 2.2));
}`;

const SOLID_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
in vec3 facing;
uniform vec4 colour;
uniform float flatly;
${LIGHT}
out vec4 seen;
void main() {
  vec3 n = normalize(gl_FrontFacing ? facing : -facing);
  vec3 c = flatly > 0.5 ? colour.rgb : shaded(colour.rgb, place, n);
  seen = vec4(c * colour.a, colour.a);
}`;

const SHADOW_FRAGMENT = `#version 300 es
precision mediump float;
void main() {}`;

// Line segments: strips of constant width on the screen.
const LINE_VERTEX = `#version 300 es
in vec2 corner;
in vec3 start;
in vec3 end;
uniform mat4 model, camera;
uniform vec2 viewport;
uniform float width, pull;
out float side;
void main() {
  vec4 a = camera * model * vec4(start, 1.0);
  vec4 b = camera * model * vec4(end, 1.0);
  if (a.w < 1.0) a = mix(a, b, (1.0 - a.w) / (b.w - a.w));
  if (b.w < 1.0) b = mix(b, a, (1.0 - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
  float far = length(along);
  vec2 d = far > 1e-6 ? along / far : vec2(1.0, 0.0);
  vec4 p = corner.x < 0.5 ? a : b;
  float half_ = 0.5 * width + 0.75;
  p.xy += (vec2(-d.y, d.x) * corner.y + d * (corner.x - 0.5) * 0.6) * half_ * 2.0 / viewport * p.w;
  p.z -= pull * p.w;
  side = corner.y * half_;
  gl_Position = p;
}`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in float side;
uniform vec4 colour;
uniform float width;
out vec4 seen;
void main() {
  float a = colour.a * clamp(0.5 * width + 0.5 - abs(side), 0.0, 1.0);
  if (a < 0.004) discard;
  seen = vec4(colour.rgb * a, a);
}`;

// Arrows: a round shaft and a cone, whose shape does not depend on the length of the arrow.
const ARROW_VERTEX = `#version 300 es
in vec2 round_;
in vec4 form;
in vec3 origin;
in vec3 way;
in vec3 tint;
uniform mat4 camera;
uniform vec2 viewport;
uniform float radius, perMm, grow;
out vec3 place;
out vec3 facing;
out vec3 colour;
void main() {
  float far = length(way);
  vec3 d = far > 1e-9 ? way / far : vec3(0.0, 0.0, 1.0);
  vec3 u = normalize(cross(d, abs(d.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  vec3 v = cross(d, u);
  float px = (camera * vec4(origin, 1.0)).w / perMm;
  float r = clamp(radius, 0.8 * px, 3.2 * px);
  float head = min(7.5 * r, 0.6 * far);
  float scale = head / (7.5 * r);
  float wide = form.y * 2.7 * r * scale + (1.0 - form.y) * r * min(1.0, scale * 2.0);
  wide = wide * form.z + grow * px;
  float along = form.x * (far - head) + form.w * head;
  if (grow > 0.0) along += (form.w > 0.5 ? 2.0 : form.x < 0.5 ? -1.0 : 0.0) * grow * px;
  vec3 out_ = u * round_.x + v * round_.y;
  place = origin + d * along + out_ * wide;
  facing = normalize(form.y > 0.5 ? out_ * 0.94 + d * 0.34 : out_);
  colour = tint;
  gl_Position = camera * vec4(place, 1.0);
}`;

const ARROW_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
in vec3 facing;
in vec3 colour;
uniform vec4 halo;
uniform vec3 eye;
uniform float parallelView;
out vec4 seen;
void main() {
  vec3 n = normalize(facing);
  vec3 back = normalize(eye - place * (1.0 - parallelView));
  float light = 0.78 + 0.30 * max(dot(n, normalize(back + vec3(0.0, 0.0, 0.5))), 0.0);
  vec3 c = min(colour * light, vec3(1.0));
  seen = halo.a > 0.0 ? vec4(halo.rgb * halo.a, halo.a) : vec4(c, 1.0);
}`;

// Marks of nodes: discs on the surface, which tilt towards a camera that looks from the side.
const GLYPH_VERTEX = `#version 300 es
in vec2 corner;
in vec3 centre;
in vec4 tint;
in vec2 kind;
uniform mat4 camera;
uniform vec3 across, upwards;
uniform float radius, perMm, least, most, pull;
out vec2 at;
out vec4 colour;
flat out int sign_;
out float px;
void main() {
  float mmPerPx = (camera * vec4(centre, 1.0)).w / perMm;
  float r = clamp(radius, least * mmPerPx, most * mmPerPx) * kind.y;
  px = r / mmPerPx;
  float room = 1.0 + 2.0 / px;
  at = corner * room;
  colour = tint;
  sign_ = int(kind.x + 0.5);
  vec4 p = camera * vec4(centre + (across * corner.x + upwards * corner.y) * r * room, 1.0);
  p.z -= pull * p.w;
  gl_Position = p;
}`;

const GLYPH_FRAGMENT = `#version 300 es
precision highp float;
in vec2 at;
in vec4 colour;
flat in int sign_;
in float px;
uniform float fade;
uniform vec3 paper;
out vec4 seen;
const int DOT = ${markCode("ok")};
const int SPOT = ${markCode("spot")};
const int DIAMOND = ${markCode("diamond")};
float band(float d, float half_) { return clamp(half_ + 0.5 - abs(d), 0.0, 1.0); }
float segment(vec2 p, vec2 a, vec2 b) {
  vec2 ab = b - a;
  return length(p - a - ab * clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0));
}
void main() {
  float r = length(at) * px;
  float a = 0.0;
  float halo = 0.0;
  vec3 c = colour.rgb;
  if (sign_ == DOT) {
    a = clamp(px - r + 0.5, 0.0, 1.0);
    c = mix(c * 0.55, c, clamp(px - 0.9 - r + 0.5, 0.0, 1.0));
  } else if (sign_ == SPOT) {
    a = band(r - px + 2.0, 1.6);
    halo = band(r - px + 2.0, 3.0);
  } else if (sign_ == DIAMOND) {
    float d = (abs(at.x) + abs(at.y) - 1.0) * 0.70711 * px;
    a = band(d + 1.5, 1.3);
    halo = band(d + 1.5, 2.6);
  } else {
    float d = 1e6;
    float part = 1.0;
    ${GLYPH_BRANCHES}
    a = band(d, 1.0) * part;
    halo = band(d, 2.0) * part;
  }
  float b = max(a, halo * 0.85);
  c = mix(paper, c, b > 0.0 ? a / b : 1.0);
  b *= colour.a * fade;
  if (b < 0.01) discard;
  seen = vec4(c * b, b);
}`;

// The floor: lines every 100 and 500 mm that fade out in the distance, and the shadow of the cell.
const FLOOR_VERTEX = `#version 300 es
in vec2 corner;
uniform mat4 camera;
uniform vec4 bounds;
uniform float height;
out vec3 place;
void main() {
  place = vec3(mix(bounds.xy, bounds.zw, corner), height);
  gl_Position = camera * vec4(place, 1.0);
}`;

const FLOOR_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
uniform vec4 line, ground, bounds;
uniform float dark;
${LIGHT}
out vec4 seen;
float grid(vec2 p, float spacing, float width) {
  vec2 g = abs(fract(p / spacing - 0.5) - 0.5) * spacing;
  vec2 px = fwidth(p);
  vec2 near = clamp(width * 0.5 + 0.5 - g / px, 0.0, 1.0) * clamp(spacing / px / 6.0 - 0.5, 0.0, 1.0);
  return max(near.x, near.y);
}
void main() {
  vec2 middle = (bounds.xy + bounds.zw) * 0.5;
  vec2 from = abs(place.xy - middle) / (bounds.zw - bounds.xy) * 2.0;
  vec2 rim = (vec2(1.0) - from) * (bounds.zw - bounds.xy) * 0.5;
  float edge = smoothstep(-20.0, 0.0, min(rim.x, rim.y));
  float lines = max(grid(place.xy, 500.0, 1.2), 0.45 * grid(place.xy, 100.0, 1.0));
  vec2 axes = clamp(1.3 - abs(place.xy) / fwidth(place.xy), 0.0, 1.0);
  float shadow = (1.0 - lit(place, vec3(0.0, 0.0, 1.0), 0.008)) * dark;
  float l = max(lines, max(axes.x, axes.y)) * line.a;
  vec4 c = vec4(ground.rgb * ground.a, ground.a);
  c = vec4(line.rgb * l, l) + c * (1.0 - l);
  c = c * (1.0 - shadow) + vec4(vec3(0.02, 0.03, 0.05) * shadow, shadow);
  seen = c * edge;
}`;
