import { CUT_EDGES } from "./slice";

export const TEXTURE_WIDTH = 2048;

/// One instance draws a chunk: 256 simplices with four corners each, of which an index makes two triangles or
/// the edges of the wireframe.
export const vertexShader = `
precision highp float;
precision highp int;
precision highp usampler2D;

uniform mat4 projectionMatrix, modelViewMatrix;
uniform usampler2D vertices;  // levels x | y << 16, levels z | w << 16, normal, track | value << 16
uniform usampler2D simplices; // four vertices
uniform usampler2D chunks;    // the chunks to draw
uniform int simplexCount, corners;
uniform vec4 scale, shift;    // scene = level * scale + shift
uniform mat4 frame;           // columns: the directions of the picture, the normal
uniform vec4 plane;           // in levels
uniform float planeOffset;

out vec4 scenePoint;
out vec3 picture, viewPosition, viewNormal;
out float normalSpeed, scalar;
flat out uint label, track;

const uint cutEdges[16] = uint[16](${CUT_EDGES.map((edges) => `${edges}u`).join(", ")});

uvec4 fetch(usampler2D texture_, uint number) {
  return texelFetch(texture_, ivec2(number % ${TEXTURE_WIDTH}u, number / ${TEXTURE_WIDTH}u), 0);
}
vec4 levelsOf(uvec4 vertex) {
  return vec4(vertex.x & 0xffffu, vertex.x >> 16, vertex.y & 0xffffu, vertex.y >> 16);
}
vec4 normalOf(uvec4 vertex) {
  return vec4(ivec4(vertex.z << 24, vertex.z << 16, vertex.z << 8, vertex.z) >> 24);
}
float scalarOf(uvec4 vertex) { return float(vertex.w >> 16) / 65535.0; }

void main() {
  scenePoint = vec4(0);
  picture = viewPosition = viewNormal = vec3(0);
  normalSpeed = scalar = 0.0;
  label = track = 0u;
  gl_Position = vec4(0, 0, 2, 1); // nowhere

  uint chunk = fetch(chunks, uint(gl_InstanceID)).x;
  uint number = chunk * 256u + uint(gl_VertexID >> 2);
  if (number >= uint(simplexCount)) return;
  uvec4 simplex = fetch(simplices, number);
  uvec4 first = fetch(vertices, simplex.x);
  label = first.w >> 16;
  track = first.w & 0xffffu;

  vec4 levels, normal;
  int corner = gl_VertexID & 3;
  if (corners == 3) {
    uvec4 vertex = fetch(vertices, simplex[min(corner, 2)]);
    levels = levelsOf(vertex);
    normal = normalOf(vertex);
    scalar = scalarOf(vertex);
  } else {
    uvec4 vertex[4] = uvec4[4](first, fetch(vertices, simplex.y), fetch(vertices, simplex.z), fetch(vertices, simplex.w));
    vec4 distances;
    uint pattern = 0u;
    for (int i = 0; i < 4; ++i) {
      distances[i] = dot(plane, levelsOf(vertex[i])) - planeOffset;
      if (distances[i] >= 0.0) pattern |= 1u << i;
    }
    if (pattern == 0u || pattern == 15u) return;
    uint edge = cutEdges[pattern] >> (4 * corner) & 15u;
    uint a = edge >> 2, b = edge & 3u;
    // From the vertex of the lower number, so that all simplices at an edge find the same point.
    if (simplex[a] > simplex[b]) { uint swap = a; a = b; b = swap; }
    float share = distances[a] / (distances[a] - distances[b]);
    levels = mix(levelsOf(vertex[a]), levelsOf(vertex[b]), share);
    normal = mix(normalOf(vertex[a]), normalOf(vertex[b]), share);
    scalar = mix(scalarOf(vertex[a]), scalarOf(vertex[b]), share);
  }
  scenePoint = levels * scale + shift;
  picture = (scenePoint * frame).xyz;
  vec4 turned = normal * frame;
  normalSpeed = -normal.w / max(length(normal.xyz), 1e-3);
  vec4 view = modelViewMatrix * vec4(picture, 1);
  viewPosition = view.xyz;
  viewNormal = mat3(modelViewMatrix) * turned.xyz;
  gl_Position = projectionMatrix * view;
}
`;

export const fragmentShader = `
precision highp float;
precision highp int;

uniform int colourMode; // 0 solid, 1 along an axis, 2 speed, 3 scalar, 4 label
uniform vec4 colourAxis;
uniform vec2 colourRange;
uniform vec3 solid;
uniform sampler2D colourMap, palette;
uniform float opacity, wire;
uniform int side;       // 0 both, 1 those that face away, 2 those that face the viewer
uniform vec4 clip;      // what lies beyond this plane of the picture is left out
uniform vec3 boxLow, boxHigh;
uniform int highlight;  // a track; -1: none
uniform vec4 section;   // surfaces in R^3: a plane of the scene, drawn as a line on the surface
uniform float sectionOffset;
uniform int sectionMode; // 0 none, 1 a line, 2 a line, and what is beyond is left out
uniform vec3 sectionColour;
uniform bool orthographic, mask;

in vec4 scenePoint;
in vec3 picture, viewPosition, viewNormal;
in float normalSpeed, scalar;
flat in uint label, track;
out vec4 fragment;

vec3 linear(vec3 colour) { return pow(colour, vec3(2.2)); }

vec3 baseColour() {
  if (colourMode == 0) return solid;
  if (colourMode == 4) return texelFetch(palette, ivec2(int(label % 64u), 0), 0).rgb;
  float value = colourMode == 1 ? dot(colourAxis, scenePoint) : colourMode == 2 ? normalSpeed : scalar;
  float share = (value - colourRange.x) / max(colourRange.y - colourRange.x, 1e-12);
  return texture(colourMap, vec2(clamp(share, 0.002, 0.998), 0.5)).rgb;
}

void main() {
  if (dot(clip.xyz, picture) > clip.w) discard;
  if (any(lessThan(picture, boxLow)) || any(greaterThan(picture, boxHigh))) discard;
  float beyond = dot(section, scenePoint) - sectionOffset;
  if (sectionMode == 2 && beyond > 0.0) discard;

  vec3 toViewer = orthographic ? vec3(0, 0, 1) : normalize(-viewPosition);
  vec3 normal = normalize(viewNormal);
  if (!(dot(normal, normal) > 0.5)) normal = toViewer;
  bool inner = dot(normal, toViewer) < 0.0;
  if (side == 1 && !inner || side == 2 && inner) discard;
  if (mask) { fragment = vec4(1); return; }
  if (wire > 0.0) { fragment = vec4(vec3(wire > 1.5 ? 1.0 : 0.0), 0.35); return; }
  if (inner) normal = -normal;

  vec3 base = linear(baseColour());
  if (inner) base = mix(base, vec3(dot(base, vec3(0.3, 0.6, 0.1))), 0.35) * 0.62;
  if (highlight >= 0 && int(track) != highlight) base = mix(vec3(dot(base, vec3(0.3, 0.6, 0.1))), vec3(0.3), 0.4);

  const vec3 key = normalize(vec3(-0.45, 0.75, 0.6)), fill = normalize(vec3(0.8, -0.1, 0.45));
  float sky = 0.5 + 0.5 * normal.y;
  vec3 light = mix(vec3(0.13, 0.12, 0.14), vec3(0.27, 0.29, 0.33), sky)
    + vec3(0.74, 0.71, 0.67) * max(dot(normal, key), 0.0)
    + vec3(0.10, 0.12, 0.16) * max(dot(normal, fill), 0.0);
  vec3 halfway = normalize(key + toViewer);
  float shine = pow(max(dot(normal, halfway), 0.0), 48.0) * 0.22;
  float rim = pow(1.0 - max(dot(normal, toViewer), 0.0), 3.0) * 0.16;
  vec3 colour = base * light + shine + rim * (0.35 + base);

  float alpha = opacity;
  if (sectionMode == 1) {
    float width = max(fwidth(beyond), 1e-9);
    float line = 1.0 - smoothstep(1.2, 2.4, abs(beyond) / width);
    if (beyond > 0.0) { colour = mix(colour, vec3(dot(colour, vec3(0.3, 0.6, 0.1))), 0.75); }
    colour = mix(colour, linear(sectionColour), line);
    alpha = max(alpha, line);
  }
  fragment = vec4(pow(clamp(colour, 0.0, 1.0), vec3(1.0 / 2.2)), alpha);
}
`;
