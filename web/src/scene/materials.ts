// SPDX-License-Identifier: Apache-2.0
// Shaders: points as numbers of their objects with a measure, and the picture, which gives the numbers their colours: an
// answer lights up, and a click finds its object, without drawing points anew.
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

/** The texel of an object: its colour and state. */
const TEXEL = /* glsl */ `
  uniform sampler2D palette;
  uniform float paletteWidth;
  vec4 texelOf(uint number) {
    int n = int(number), width = int(paletteWidth);
    return texelFetch(palette, ivec2(n % width, n / width), 0);
  }
`;

/** What the points have: the object's texel decides whether the point is seen; slices cut by height. */
const POINT_INPUTS = /* glsl */ `
  precision highp float;
  precision highp int;
  ${TEXEL}
  uniform float pixelsPerMetre, pixelRatio, spread;
  uniform vec2 slice, scans;
  uniform int only;
  in uint object;
  in float cloud;
  in vec4 measures;
  bool isCut() {
    return measures.y < slice.x || measures.y > slice.y || cloud < scans.x || cloud > scans.y ||
           (only > 0 && int(object) != only);
  }
  float sizeAt(float depth) {
    return clamp(spread * pixelsPerMetre / max(depth, 0.1), 1.4, 6.5) * pixelRatio;
  }
`;

/** Writes the object's number + 1 and in alpha what the colour mode needs of the point, from 0 to 1. */
const POINT_VERTEX = /* glsl */ `
  ${POINT_INPUTS}
  uniform int mode;
  uniform float clouds, relief;
  uniform vec2 heightRange;
  flat out vec4 mark;
  const float PLAIN = 0.619;  // neither darker nor lighter, see the picture
  void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * seen;
    gl_PointSize = sizeAt(-seen.z);
    uint number = object + 1u;
    float measure = relief > 0.5 ? measures.x / 255.0 : PLAIN;
    if (only == 0) {
      if (mode == 2) measure = (measures.y - heightRange.x) / (heightRange.y - heightRange.x);
      if (mode == 3) measure = measures.x / 255.0;
      if (mode == 4) measure = clouds < 1.5 ? 0.5 : cloud / (clouds - 1.0);
      if (mode == 5) measure = measures.z / 255.0;
      if (mode == 7) measure = (measures.w - 1.0) / 7.0;
    }
    mark = vec4(uvec4(number & 255u, (number >> 8) & 255u, number >> 16, 0u)) / 255.0;
    mark.a = clamp(measure, 0.0, 1.0);
    if ((texelOf(object).a < 0.1 && only == 0) || isCut()) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
`;

const POINT_FRAGMENT = /* glsl */ `
  precision highp float;
  flat in vec4 mark;
  out vec4 written;
  void main() { written = mark; }
`;

/** The numbers and depths of a few pixels of the picture, as they are. */
const PEEK_FRAGMENT = /* glsl */ `
  precision highp float;
  precision highp int;
  uniform sampler2D marks, depths;
  uniform vec2 corner;
  out uvec4 written;
  void main() {
    ivec2 at = ivec2(corner) + ivec2(gl_FragCoord.xy), size = textureSize(marks, 0);
    written = uvec4(0u);
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) return;
    uvec3 bytes = uvec3(texelFetch(marks, at, 0).rgb * 255.0 + 0.5);
    written = uvec4(bytes.r | (bytes.g << 8) | (bytes.b << 16), floatBitsToUint(texelFetch(depths, at, 0).x), 0u, 1u);
  }
`;

/**
 * Colours of the objects, and eye-dome lighting: what lies behind something nearer is dark along its edge, which shows
 * shape without normals.
 */
const PICTURE_FRAGMENT = /* glsl */ `
  precision highp float;
  precision highp int;
  ${TEXEL}
  uniform sampler2D marks, depths;
  uniform int mode;
  uniform vec2 pixel, planes;
  uniform vec3 background, dimmed;
  uniform float strength;
  uniform bool isFine;  // four more neighbours, when the picture rests
  in vec2 place;
  out vec4 written;
  vec3 ramp(float t) {  // dark blue, teal, green, yellow
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
  vec3 colourOf(vec4 mark) {
    uvec4 bytes = uvec4(mark * 255.0 + 0.5);
    vec4 texel = texelOf((bytes.r | (bytes.g << 8) | (bytes.b << 16)) - 1u);
    vec3 colour = texel.rgb * (0.74 + 0.42 * mark.a);
    if (mode == 2 || mode == 3 || mode == 4 || mode == 7) colour = ramp(mark.a);
    if (mode == 5) colour = labelColour(float(bytes.a));
    return texel.a < 0.5 ? mix(colour, dimmed, 0.82) : colour;
  }
  /** One over the distance, but for a factor. */
  float nearnessAt(vec2 at) {
    return (planes.y + planes.x) - (texture(depths, at).x * 2.0 - 1.0) * (planes.y - planes.x);
  }
  /** About log2 of own distance over the neighbour's: nearer neighbours count, up to a limit. */
  float dropTo(float own, vec2 offset) {
    return clamp(1.443 * nearnessAt(place + offset * pixel) * own - 1.443, 0.0, 0.06);
  }
  void main() {
    float depth = texture(depths, place).x;
    gl_FragDepth = depth;
    if (depth >= 1.0) { written = vec4(background, 1.0); return; }
    float own = 1.0 / nearnessAt(place), drop = 0.0;
    drop += dropTo(own, vec2(1.0, 0.0)) + dropTo(own, vec2(-1.0, 0.0));
    drop += dropTo(own, vec2(0.0, 1.0)) + dropTo(own, vec2(0.0, -1.0));
    if (isFine) {
      drop += 0.5 * (dropTo(own, vec2(2.0, 2.0)) + dropTo(own, vec2(-2.0, -2.0)));
      drop += 0.5 * (dropTo(own, vec2(2.0, -2.0)) + dropTo(own, vec2(-2.0, 2.0)));
    } else {
      drop *= 1.6;
    }
    written = vec4(colourOf(texture(marks, place)) * max(0.42, exp(-drop * strength)), 1.0);
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

export function peekMaterial(): THREE.ShaderMaterial {
  const material = shader(PICTURE_VERTEX, PEEK_FRAGMENT, { marks: { value: null }, depths: { value: null }, corner: { value: new THREE.Vector2() } });
  material.depthTest = false;
  return material;
}

/** Shares palette, mode and the colour of what is dimmed with the points. */
export function pictureMaterial({ palette, paletteWidth, mode, dimmed }: PointUniforms): THREE.ShaderMaterial {
  const material = shader(PICTURE_VERTEX, PICTURE_FRAGMENT, {
    palette, paletteWidth, mode, dimmed, marks: { value: null }, depths: { value: null }, pixel: { value: new THREE.Vector2() },
    planes: { value: new THREE.Vector2() }, background: { value: new THREE.Color() }, strength: { value: 4.5 },
    isFine: { value: true },
  });
  material.depthFunc = THREE.AlwaysDepth;
  return material;
}
