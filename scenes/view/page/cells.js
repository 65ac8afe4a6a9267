'use strict';
// The Voronoi diagram as the method draws it: every site of every outline is a mesh whose height is the distance to it
// (a cone about a point, tents over a segment, a funnel over an arc); seen from below, the nearest wins. A first pass keeps of
// every pixel whose cell it is and how far it is, a second one makes colours of it, once a pixel.

const FINE = 96, COARSE = 24;  // triangles of a whole turn: of what is small on the screen fewer will do
const SMALL = 30;  // pixels: a cone of COARSE triangles is a quarter of one off at most
const COLORS = 1024;  // in a row of their texture
const OVERLAP = 0.03;  // [rad], of what meets at a vertex: no pixel falls between

const directionOf = ([x, y]) => Math.atan2(y, x);
const turnTo = (from, to) => Math.atan2(Math.sin(to - from), Math.cos(to - from));

/** Direction of travel along a site [rad], at its beginning or end. */
function directionAt(site, point) {
  if (site.kind === 'segment') return directionOf([site.b[0] - site.a[0], site.b[1] - site.a[1]]);
  return directionOf([point[0] - site.center[0], point[1] - site.center[1]]) + Math.sign(site.sweep) * Math.PI / 2;
}

/**
 * Triangles of a loop of sites: base point, direction of growth, and height. Each site covers what is abreast of it, each vertex
 * the sector between its sites' normals: what is nearest to anything is nearest to what covers it.
 */
function loopMesh(loop, cone, out) {
  const vertex = (x, y, dx, dy, z) => out.push(x, y, dx, dy, z);
  const fan = ([x, y], from, sweep, r) => {
    const steps = Math.max(1, Math.ceil(cone * Math.abs(sweep) / (2 * Math.PI))), m = 1 / Math.cos(sweep / steps / 2);
    for (let i = 0; i < steps; ++i) {
      const a = from + sweep * i / steps, b = from + sweep * (i + 1) / steps;
      vertex(x, y, 0, 0, -r);
      vertex(x, y, m * Math.cos(a), m * Math.sin(a), -r);
      vertex(x, y, m * Math.cos(b), m * Math.sin(b), -r);
    }
  };
  const quad = (a, b, nx, ny, r) => {
    vertex(...a, 0, 0, -r); vertex(...b, 0, 0, -r); vertex(...b, nx, ny, -r);
    vertex(...a, 0, 0, -r); vertex(...b, nx, ny, -r); vertex(...a, nx, ny, -r);
  };
  const abreast = site => {
    if (site.kind === 'segment') {
      const dx = site.b[0] - site.a[0], dy = site.b[1] - site.a[1], l = Math.hypot(dx, dy) || 1;
      quad(site.a, site.b, -dy / l, dx / l, site.radius);
      quad(site.a, site.b, dy / l, -dx / l, site.radius);
      return;
    }
    const [cx, cy] = site.center, R = site.arc_radius, from = directionOf([site.a[0] - cx, site.a[1] - cy]);
    const steps = Math.max(2, Math.ceil(cone * Math.abs(site.sweep) / (2 * Math.PI)));
    for (let i = 0; i < steps; ++i) {
      const a = from + site.sweep * i / steps, b = from + site.sweep * (i + 1) / steps;
      const A = [Math.cos(a), Math.sin(a)], B = [Math.cos(b), Math.sin(b)];
      const on = (u, away, z) => vertex(cx + R * u[0], cy + R * u[1], away * u[0], away * u[1], z);
      on(A, 0, -site.radius); on(B, 0, -site.radius); on(B, 1, -site.radius);
      on(A, 0, -site.radius); on(B, 1, -site.radius); on(A, 1, -site.radius);
      // inwards to the centre, where it is R away
      on(A, 0, -site.radius); on(B, 0, -site.radius); vertex(cx, cy, 0, 0, R - site.radius);
    }
  };
  const joint = (before, after) => {
    const from = directionAt(before, before.b), turn = turnTo(from, directionAt(after, after.a));
    if (before.radius !== after.radius) return fan(after.a, 0, 2 * Math.PI, after.radius);
    const side = (sign, sweep) =>
      fan(after.a, from + sign * Math.PI / 2 - Math.sign(turn || 1) * OVERLAP, sweep + Math.sign(turn || 1) * 2 * OVERLAP, after.radius);
    side(turn > 0 ? -1 : 1, turn);
    if (Math.abs(turn) < OVERLAP) side(turn > 0 ? 1 : -1, turn);
  };
  const {sites} = loop, last = sites[sites.length - 1];
  if (sites[0].kind === 'point') return sites.forEach(site => fan(site.a, 0, 2 * Math.PI, site.radius));
  sites.forEach(abreast);
  for (let i = 1; i < sites.length; ++i) joint(sites[i - 1], sites[i]);
  if (loop.closed) return joint(last, sites[0]);
  const half = Math.PI + 2 * OVERLAP;
  fan(sites[0].a, directionAt(sites[0], sites[0].a) + Math.PI / 2 - OVERLAP, half, sites[0].radius);
  fan(last.b, directionAt(last, last.b) - Math.PI / 2 - OVERLAP, half, last.radius);
}

const MESH_VERTEX = `#version 300 es
in vec2 base; in vec2 grow; in float low;
in vec4 pose;    // x, y, cosine, sine
in vec2 cell;    // whose it is, and how far it reaches [m]
uniform vec2 view;    // scale to clip space
uniform float deepest;    // [m]
out float height; flat out uint owner;
vec2 turned(vec2 v) { return vec2(pose.z * v.x - pose.w * v.y, pose.w * v.x + pose.z * v.y); }
void main() {
  vec2 p = pose.xy + turned(base + cell.y * grow);
  height = low + (dot(grow, grow) > 0.0 ? cell.y : 0.0);
  owner = uint(cell.x);
  gl_Position = vec4(p * view, clamp(height / deepest, -1.0, 1.0) * 0.999, 1.0);
}`;
const MESH_FRAGMENT = `#version 300 es
precision highp float;
in float height; flat in uint owner;
out uvec2 seen;    // 0: nobody's
void main() { seen = uvec2(owner + 1u, floatBitsToUint(height)); }`;
const PAINT_VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2[3](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID], 0.0, 1.0); }`;
const PAINT_FRAGMENT = `#version 300 es
precision highp float;
uniform highp usampler2D seen; uniform sampler2D colors;
uniform float ring; uniform float pixel;
out vec4 shade;
uint ownerAt(ivec2 at) { return texelFetch(seen, clamp(at, ivec2(0), textureSize(seen, 0) - 1), 0).x; }
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec2 here = texelFetch(seen, at, 0).xy;
  if (here.x == 0u) { shade = vec4(0.0); return; }
  int k = int(here.x - 1u);
  vec3 color = texelFetch(colors, ivec2(k % ${COLORS}, k / ${COLORS}), 0).rgb;
  float height = uintBitsToFloat(here.y), away = abs(fract(height / ring + 0.5) - 0.5) * ring;
  color *= mix(0.93, 1.0, height > 0.0 ? smoothstep(0.5, 1.5, away / pixel) : 1.0);
  int borders = int(ownerAt(at + ivec2(1, 0)) != here.x) + int(ownerAt(at - ivec2(1, 0)) != here.x) +
                int(ownerAt(at + ivec2(0, 1)) != here.x) + int(ownerAt(at - ivec2(0, 1)) != here.x);
  shade = vec4(mix(color, vec3(1.0), 0.85 * min(1.0, 0.4 * float(borders))), 1.0);
}`;

class Cells {
  constructor(canvas, shapes) {
    const gl = canvas.getContext('webgl2', {antialias: false, depth: false});
    if (!gl) return;
    this.gl = gl;
    this.canvas = canvas;
    this.meshProgram = this.program(MESH_VERTEX, MESH_FRAGMENT, ['view', 'deepest']);
    this.paintProgram = this.program(PAINT_VERTEX, PAINT_FRAGMENT, ['seen', 'colors', 'ring', 'pixel']);
    if (!this.meshProgram || !this.paintProgram) { this.gl = null; return; }
    this.meshes = [FINE, COARSE].flatMap(cone => shapes.map(shape => this.mesh(shape, cone)));
    this.radii = shapes.map(shape => shape.bounding_radius);
    this.nothing = gl.createVertexArray();
    this.seen = this.texture();
    this.colors = this.texture();
    this.depth = gl.createRenderbuffer();
    this.target = gl.createFramebuffer();
  }

  program(vertex, fragment, uniforms) {
    const gl = this.gl, name = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(name, shader);
    }
    gl.linkProgram(name);
    if (!gl.getProgramParameter(name, gl.LINK_STATUS)) return null;
    return {name, at: Object.fromEntries(uniforms.map(u => [u, gl.getUniformLocation(name, u)]))};
  }

  texture() {
    const gl = this.gl, name = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, name);
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, gl.NEAREST);
    return name;
  }

  /** What the first pass draws into, as large as the canvas. */
  fit() {
    const gl = this.gl, {width, height} = this.canvas;
    if (this.width === width && this.height === height) return;
    [this.width, this.height] = [width, height];
    gl.bindTexture(gl.TEXTURE_2D, this.seen);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32UI, width, height, 0, gl.RG_INTEGER, gl.UNSIGNED_INT, null);
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.seen, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
  }

  get works() { return !!this.gl; }

  mesh(shape, cone) {
    const gl = this.gl, numbers = [];
    for (const loop of shape.loops) loopMesh(loop, cone, numbers);
    const array = gl.createVertexArray(), places = gl.createBuffer();
    gl.bindVertexArray(array);
    const attributes = (buffer, stride, step, list) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      for (const [name, size, offset] of list) {
        const where = gl.getAttribLocation(this.meshProgram.name, name);
        gl.enableVertexAttribArray(where);
        gl.vertexAttribPointer(where, size, gl.FLOAT, false, stride, offset);
        gl.vertexAttribDivisor(where, step);
      }
    };
    attributes(gl.createBuffer(), 20, 0, [['base', 2, 0], ['grow', 2, 8], ['low', 1, 16]]);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    attributes(places, 24, 1, [['pose', 4, 0], ['cell', 2, 16]]);
    return {array, places, count: numbers.length / 5};
  }

  /**
   * `things`: {shape, pose: [x, y, angle], owner, reach: no place of its cell that is seen is farther from it [m]}; `colors`: of
   * every owner, [r, g, b]; `view`: {x, y, scale} in pixels of the canvas.
   */
  draw(things, colors, view, ring) {
    const gl = this.gl;
    this.fit();
    gl.viewport(0, 0, this.width, this.height);
    this.drawMeshes(things, view);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(this.paintProgram.name);
    gl.bindVertexArray(this.nothing);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.colors);
    const rows = Math.ceil(colors.length / COLORS), bytes = new Uint8Array(4 * COLORS * rows);
    colors.forEach((c, k) => bytes.set([255 * c[0], 255 * c[1], 255 * c[2], 255].map(Math.round), 4 * k));
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, COLORS, rows, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.seen);
    const {at} = this.paintProgram;
    gl.uniform1i(at.seen, 0);
    gl.uniform1i(at.colors, 1);
    gl.uniform1f(at.ring, ring);
    gl.uniform1f(at.pixel, 1 / view.scale);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  drawMeshes(things, view) {
    const gl = this.gl, {at, name} = this.meshProgram, of = this.meshes.map(() => []);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(name);
    const all = 1.5 * Math.hypot(this.width, this.height) / view.scale;
    let deepest = 0;
    for (const {shape, pose, owner, reach} of things) {
      const far = Math.min(reach, all);
      deepest = Math.max(deepest, far);
      const small = Math.max(far, this.radii[shape]) * view.scale < SMALL;
      // places relative to the view: nothing is lost far from the origin
      of[small ? shape + this.radii.length : shape].push(pose[0] - view.x, pose[1] - view.y, Math.cos(pose[2]), Math.sin(pose[2]), owner, far);
    }
    gl.uniform1f(at.deepest, deepest);
    gl.uniform2f(at.view, 2 * view.scale / this.width, 2 * view.scale / this.height);
    this.meshes.forEach((mesh, k) => {
      if (!of[k].length) return;
      gl.bindVertexArray(mesh.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.places);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(of[k]), gl.STREAM_DRAW);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, mesh.count, of[k].length / 6);
    });
  }

  /** Whose cell was drawn last at a pixel from the bottom left, and the distance to it [m]; null: nobody's. */
  at(column, row) {
    const gl = this.gl, words = new Uint32Array(4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.readPixels(column, row, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return words[0] ? {owner: words[0] - 1, distance: new Float32Array(words.buffer)[1]} : null;
  }

  clear() {
    this.gl.clearColor(0, 0, 0, 0);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT | this.gl.DEPTH_BUFFER_BIT);
  }
}
