// SPDX-License-Identifier: Apache-2.0
// Shaders: points coloured by their object or by a measure, points as numbers for picking, and the picture with shading.
import * as THREE from 'three';

/**
 * How points are coloured. Class, certainty and distinct (classes in colours that all kinds of sight tell apart) come from
 * the palette, the others from measures of the point. The shader knows them by their place.
 */
export const COLOUR_MODES = ['class', 'certainty', 'height', 'intensity', 'scan', 'primitive', 'distinct', 'coverage'] as const;
export type ColourMode = (typeof COLOUR_MODES)[number];

export interface PointUniforms {
  [name: string]: THREE.IUniform;
  palette: THREE.IUniform<THREE.Texture | null>;
  paletteWidth: THREE.IUniform<number>;
  mode: THREE.IUniform<number>;
  pixelsPerMetre: THREE.IUniform<number>;
  /** Size of a point of the tile [m]. */
  spread: THREE.IUniform<number>;
  /** 1: intensities shade the colours of classes. */
  relief: THREE.IUniform<number>;
  pixelRatio: THREE.IUniform<number>;
  slice: THREE.IUniform<THREE.Vector2>;
  /** The first and the last scan that is shown. */
  scans: THREE.IUniform<THREE.Vector2>;
  /** Number + 1 of the only object to draw; 0: all. */
  only: THREE.IUniform<number>;
  heightRange: THREE.IUniform<THREE.Vector2>;
  clouds: THREE.IUniform<number>;
  dimmed: THREE.IUniform<THREE.Color>;
}

/** What both vertex shaders share: the object's texel decides whether the point is seen; slices cut by height. */
const COMMON = /* glsl */ `
  precision highp float;
  precision highp int;
  uniform sampler2D palette;
  uniform float paletteWidth;
  uniform float pixelsPerMetre, pixelRatio, spread;
  uniform vec2 slice, scans;
  uniform int only;
  in uint object;
  in float cloud;
  in vec4 measures;
  vec4 texelOf(uint number) {
    int n = int(number), width = int(paletteWidth);
    return texelFetch(palette, ivec2(n % width, n / width), 0);
  }
  bool isCut() {
    return measures.y < slice.x || measures.y > slice.y || cloud < scans.x || cloud > scans.y ||
           (only > 0 && int(object) != only);
  }
  float sizeAt(float depth, bool isLit) {
    float size = clamp(spread * pixelsPerMetre / max(depth, 0.1), 1.4, 6.5);
    return (isLit ? size + 1.2 : size) * pixelRatio;
  }
`;

const POINT_VERTEX = /* glsl */ `
  ${COMMON}
  uniform int mode;
  uniform float clouds, relief;
  uniform vec2 heightRange;
  uniform vec3 dimmed;
  out vec3 colour;
  vec3 ramp(float t) {  // dark blue, teal, green, yellow
    t = clamp(t, 0.0, 1.0);
    vec3 a = vec3(0.27, 0.23, 0.52), b = vec3(0.17, 0.50, 0.56), c = vec3(0.33, 0.72, 0.43), d = vec3(0.98, 0.88, 0.25);
    return t < 0.33 ? mix(a, b, t / 0.33) : t < 0.66 ? mix(b, c, (t - 0.33) / 0.33) : mix(c, d, (t - 0.66) / 0.34);
  }
  vec3 labelColour(float label) {
    if (label < 0.5) return vec3(0.72, 0.64, 0.50);
    if (label < 1.5) return vec3(0.78, 0.36, 0.28);
    if (label < 2.5) return vec3(0.98, 0.74, 0.16);
    if (label < 3.5) return vec3(0.25, 0.47, 0.85);
    return vec3(0.25, 0.60, 0.34);
  }
  void main() {
    vec4 texel = texelOf(object);
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * seen;
    bool isLit = texel.a > 0.9;
    gl_PointSize = sizeAt(-seen.z, isLit);
    colour = texel.rgb * mix(1.0, 0.74 + 0.42 * measures.x / 255.0, relief);
    if (mode == 2) colour = ramp((measures.y - heightRange.x) / (heightRange.y - heightRange.x));
    if (mode == 3) colour = ramp(measures.x / 255.0);
    if (mode == 4) colour = ramp(clouds < 1.5 ? 0.5 : cloud / (clouds - 1.0));
    if (mode == 7) colour = ramp((measures.w - 1.0) / 7.0);
    if (mode == 5) colour = labelColour(measures.z);
    if (texel.a < 0.5 && only == 0) colour = mix(colour, dimmed, 0.82);
    if ((texel.a < 0.1 && only == 0) || isCut()) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
`;

const POINT_FRAGMENT = /* glsl */ `
  precision mediump float;
  in vec3 colour;
  out vec4 written;
  void main() { written = vec4(colour, 1.0); }
`;

const PICK_VERTEX = /* glsl */ `
  ${COMMON}
  flat out uint picked, vertex;
  void main() {
    vec4 texel = texelOf(object);
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * seen;
    gl_PointSize = max(sizeAt(-seen.z, texel.a > 0.9), 3.0 * pixelRatio);
    picked = object;
    vertex = uint(gl_VertexID);
    if (texel.a < 0.1 || isCut()) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
`;

const PICK_FRAGMENT = /* glsl */ `
  precision highp float;
  precision highp int;
  uniform int tile;
  flat in uint picked, vertex;
  out uvec4 written;
  void main() { written = uvec4(picked, uint(tile) + 1u, vertex, 1u); }
`;

/** Eye-dome lighting: what stands before something farther away gets a dark edge, which shows shape without normals. */
const PICTURE_FRAGMENT = /* glsl */ `
  precision highp float;
  uniform sampler2D colours, depths;
  uniform vec2 pixel, planes;
  uniform vec3 background;
  uniform float strength;
  uniform bool isFine;  // four more neighbours, when the picture rests
  in vec2 place;
  out vec4 written;
  float distanceAt(vec2 at) {
    float d = texture(depths, at).x * 2.0 - 1.0;
    return log2(2.0 * planes.x * planes.y / (planes.y + planes.x - d * (planes.y - planes.x)));
  }
  /** Farther neighbours count up to a limit: the edge of a thing before the sky is no darker than another. */
  float dropTo(float own, vec2 offset) {
    return clamp(own - distanceAt(place + offset * pixel), 0.0, 0.06);
  }
  void main() {
    float depth = texture(depths, place).x;
    gl_FragDepth = depth;
    if (depth >= 1.0) { written = vec4(background, 1.0); return; }
    float own = distanceAt(place), drop = 0.0;
    drop += dropTo(own, vec2(1.0, 0.0)) + dropTo(own, vec2(-1.0, 0.0));
    drop += dropTo(own, vec2(0.0, 1.0)) + dropTo(own, vec2(0.0, -1.0));
    if (isFine) {
      drop += 0.5 * (dropTo(own, vec2(2.0, 2.0)) + dropTo(own, vec2(-2.0, -2.0)));
      drop += 0.5 * (dropTo(own, vec2(2.0, -2.0)) + dropTo(own, vec2(-2.0, 2.0)));
    } else {
      drop *= 1.6;
    }
    written = vec4(texture(colours, place).rgb * max(0.42, exp(-drop * strength)), 1.0);
  }
`;

const PICTURE_VERTEX = /* glsl */ `
  precision highp float;
  out vec2 place;
  void main() {
    place = position.xy * 0.5 + 0.5;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }
`;

export function pointUniforms(): PointUniforms {
  return {
    palette: { value: null }, paletteWidth: { value: 1 }, mode: { value: 0 },
    pixelsPerMetre: { value: 500 }, spread: { value: 0.04 }, relief: { value: 0 }, pixelRatio: { value: 1 },
    slice: { value: new THREE.Vector2(0, 255) }, scans: { value: new THREE.Vector2(0, 65535) }, only: { value: 0 }, heightRange: { value: new THREE.Vector2(16, 96) },
    clouds: { value: 1 }, dimmed: { value: new THREE.Color() },
  };
}

function shader(vertexShader: string, fragmentShader: string, uniforms: Record<string, THREE.IUniform>) {
  return new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader, fragmentShader, uniforms, blending: THREE.NoBlending,
  });
}

export const pointMaterial = (uniforms: PointUniforms) => shader(POINT_VERTEX, POINT_FRAGMENT, uniforms);

export const pickMaterial = (uniforms: PointUniforms) =>
  shader(PICK_VERTEX, PICK_FRAGMENT, { ...uniforms, tile: { value: 0 } });

export function pictureMaterial(): THREE.ShaderMaterial {
  const material = shader(PICTURE_VERTEX, PICTURE_FRAGMENT, {
    colours: { value: null }, depths: { value: null }, pixel: { value: new THREE.Vector2() },
    planes: { value: new THREE.Vector2() }, background: { value: new THREE.Color() }, strength: { value: 4.5 },
    isFine: { value: true },
  });
  material.depthFunc = THREE.AlwaysDepth;
  return material;
}
