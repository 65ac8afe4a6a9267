'use strict';
// The Voronoi diagram as the method draws it: of all meshes (cell_mesh.js), seen from below, the nearest wins. A first pass keeps of
// every pixel whose cell it is, how far, and in which direction that grows; a second one makes colours of it.
//
// Where a computer is too slow for that (pace.js) the first pass has fewer pixels. The second one goes on from each of them
// along its slope, so that borders stay where they are, and lines.

const COLORS = 1024;  // in a row of their texture
const TIE = 0.1;  // of a pixel: distances less different are the same (corners of triangles are rounded to 1/16)

const ROW = 512;  // things in a row of their texture, two texels each
// A mesh is kept many times in one: software draws each instance by itself, which costs more than its few triangles.
const BUNDLE = 2048, MOST_COPIES = 128;  // vertices, copies

// Of a vertex (cell_mesh.js), and which of the copies it is of.
const COLUMNS_OF_MESH = [['base', 2, 0], ['grow', 2, 2], ['radii', 2, 4], ['most', 1, 6], ['copy', 1, 7]];

const MESH_VERTEX = `#version 300 es
in vec2 base; in vec2 grow; in vec2 radii; in float most; in float copy;
uniform highp sampler2D things;    // x, y, cosine, sine; whose it is, and how far it reaches [m]
uniform ivec3 which;    // the first, the one behind the last, copies in a mesh
uniform vec2 view;    // scale to clip space
out vec2 q; flat out vec2 sizes; flat out uint owner;
void main() {
  int k = which.x + gl_InstanceID * which.z + int(copy);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);    // nowhere
  q = vec2(0.0);
  sizes = radii;
  owner = 0u;
  if (k >= which.y) return;
  ivec2 at = ivec2(2 * (k % ${ROW}), k / ${ROW});
  vec4 pose = texelFetch(things, at, 0);
  vec2 cell = texelFetch(things, at + ivec2(1, 0), 0).xy, v = min(radii.x + radii.y + cell.y, most) * grow;
  q = vec2(pose.z * v.x - pose.w * v.y, pose.w * v.x + pose.z * v.y);
  owner = uint(cell.x) + 1u;
  vec2 p = pose.xy + vec2(pose.z * base.x - pose.w * base.y, pose.w * base.x + pose.z * base.y) + q;
  gl_Position = vec4(p * view, 0.0, 1.0);
}`;
// `coarse`: the second pass goes on from what is seen, along its slope.
const meshFragment = coarse => `#version 300 es
#define COARSE ${coarse}
precision highp float;
in vec2 q; flat in vec2 sizes; flat in uint owner;    // see cell_mesh.js
uniform float deepest;    // [m]
uniform uint first; uniform float tie;    // the first of the bodies; behind a floor what stands on it is no nearer than the floor [m]
// whose, 0: nobody's; the distance; the unit vector in whose direction that grows
#if COARSE
out uvec4 seen;
#else
out uvec2 seen;
#endif
void main() {
  float l = length(q), height = abs(l - sizes.y) - sizes.x;
#if COARSE
  seen = uvec4(owner, floatBitsToUint(vec3(height, q * ((l < sizes.y ? -1.0 : 1.0) / max(l, 1e-30)))));
#else
  seen = uvec2(owner, floatBitsToUint(height));
#endif
  if (owner >= first) height += tie;
  gl_FragDepth = 0.5 + 0.4995 * clamp(height / deepest, -1.0, 1.0);
}`;
const PAINT_VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2[3](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID], 0.0, 1.0); }`;
// `coarse`: the first pass has fewer pixels, 0 or 1.
const paintFragment = coarse => `#version 300 es
#define COARSE ${coarse}
precision highp float;
uniform highp usampler2D seen; uniform sampler2D colors;
uniform vec2 coarse;    // pixels of the first pass a pixel of this one
uniform uint scenery;    // owners below are sites of the scene: no border between two of them, whose cells may tie where they join
uniform float ring; uniform float pixel; uniform float large; uniform vec3 paper;    // ring, pixel [m]; large: pixels of the screen
out vec4 shade;
uvec4 look(ivec2 at) { return texelFetch(seen, at, 0); }
bool apart(uvec4 a, uvec4 b) { return a.x != b.x && max(a.x, b.x) > scenery; }
// a pixel of the first pass as seen from here: the slope there, and the distance taken on from there [m]
vec3 taken(uvec4 s, vec2 on) {
  vec2 slope = uintBitsToFloat(s.zw);
  return vec3(slope, s.x == 0u ? 1e30 : uintBitsToFloat(s.y) + dot(slope, on));
}
// the way from one cell to the other [m]
float way(uvec4 s, vec3 a, uvec4 t, vec3 b) {
  vec2 turn = b.xy - a.xy;
  return apart(s, t) ? (b.z - a.z) * inversesqrt(max(dot(turn, turn), 1e-12)) : 1e30;
}
void main() {
  vec2 place = gl_FragCoord.xy * coarse - 0.5;
  ivec2 at = ivec2(round(place));
  uvec4 here = look(at);
  if (here.x == 0u) { shade = vec4(paper, 1.0); return; }
  uvec4 right = look(at + ivec2(1, 0)), left = look(at - ivec2(1, 0)), up = look(at + ivec2(0, 1)), down = look(at - ivec2(0, 1));
  float height = uintBitsToFloat(here.y), border = 1e30;    // border: the way to the nearest other cell [pixels]
#if COARSE
  vec2 texel = pixel / coarse, on = (place - vec2(at)) * texel;
  if (any(notEqual(uvec4(right.x, left.x, up.x, down.x), uvec4(here.x)))) {
    uvec4 middle = here;
    vec3 m = taken(here, on), e = taken(right, on - vec2(texel.x, 0.0)), w = taken(left, on + vec2(texel.x, 0.0));
    vec3 n = taken(up, on - vec2(0.0, texel.y)), s = taken(down, on + vec2(0.0, texel.y)), best = m;
    if (e.z < best.z) { best = e; here = right; }
    if (w.z < best.z) { best = w; here = left; }
    if (n.z < best.z) { best = n; here = up; }
    if (s.z < best.z) { best = s; here = down; }
    height = best.z;
    border = min(min(way(here, best, right, e), way(here, best, left, w)), min(way(here, best, up, n), way(here, best, down, s)));
    border = min(border, way(here, best, middle, m)) / pixel;
  } else height += dot(uintBitsToFloat(here.zw), on);
#else    // by how many of its neighbours are of another
  bool r = apart(right, here), l = apart(left, here), u = apart(up, here), d = apart(down, here);
  border = 1.3 - 0.5 * (float(r) + float(l) + float(u) + float(d));
  if (border == 1.3) border = 1e30;
#endif
  int owner = int(here.x - 1u);
  vec3 color = texelFetch(colors, ivec2(owner % ${COLORS}, owner / ${COLORS}), 0).rgb;
  float away = abs(fract(height / ring + 0.5) - 0.5) * ring;
  color *= mix(0.93, 1.0, height > 0.0 ? smoothstep(0.5, 1.5, away / pixel) : 1.0);
  float line = min(1.0, 1.6 / large) * clamp(1.0 + 0.3 / large - border, 0.0, 1.0);
  shade = vec4(mix(color, paper.g > 0.5 ? vec3(1.0) : paper, 0.75 * line), 1.0);
}`;

/** Outlines where they are, of whom and how far their cells reach: columns that grow as need be. */
class Things {
  constructor() { this.make(64); this.count = 0; }
  make(room) {
    const of = {shape: Int32Array, owner: Int32Array, x: Float64Array, y: Float64Array, angle: Float64Array, reach: Float64Array};
    for (const [name, kind] of Object.entries(of)) {
      const column = new kind(room);
      if (this[name]) column.set(this[name]);
      this[name] = column;
    }
  }
  add(shape, owner, x, y, angle) {
    const k = this.count++;
    if (k === this.shape.length) this.make(2 * k);
    this.shape[k] = shape; this.owner[k] = owner; this.x[k] = x; this.y[k] = y; this.angle[k] = angle;
  }
}

class Cells {
  constructor(canvas, shapes) {
    const gl = canvas.getContext('webgl2', {antialias: false, depth: false, alpha: false});
    if (!gl) return;
    this.gl = gl;
    this.canvas = canvas;
    this.shapes = shapes;
    this.meshPrograms = [0, 1].map(coarse => this.program(MESH_VERTEX, meshFragment(coarse), ['things', 'which', 'view', 'deepest', 'first', 'tie']));
    this.paintPrograms = [0, 1].map(coarse =>
      this.program(PAINT_VERTEX, paintFragment(coarse), ['seen', 'colors', 'coarse', 'scenery', 'ring', 'pixel', 'large', 'paper']));
    if (![...this.meshPrograms, ...this.paintPrograms].every(made => made)) { this.gl = null; return; }
    this.meshes = [];
    this.nothing = gl.createVertexArray();
    this.seen = this.texture();
    this.colors = this.texture();
    this.where = this.texture();
    this.depth = gl.createRenderbuffer();
    this.target = gl.createFramebuffer();
    this.size = [0, 0];
    this.places = new Float32Array(0);
  }

  get works() { return !!this.gl; }

  /** True where the browser has no graphics card for it. */
  get bySoftware() {
    if (this.software === undefined) {
      const {gl} = this, told = gl && gl.getExtension('WEBGL_debug_renderer_info');
      const name = gl ? String(gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER)) : '';
      this.software = /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
    }
    return this.software;
  }

  program(vertex, fragment, uniforms) {
    const gl = this.gl, name = gl.createProgram();
    COLUMNS_OF_MESH.forEach(([column], k) => gl.bindAttribLocation(name, k, column));
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

  /** What the first pass draws into; coarse: with slopes. */
  fit(width, height, coarse) {
    const gl = this.gl;
    if (this.size[0] === width && this.size[1] === height && this.sloped === coarse) return;
    Object.assign(this, {size: [width, height], sloped: coarse});
    gl.bindTexture(gl.TEXTURE_2D, this.seen);
    const [kind, parts] = coarse ? [gl.RGBA32UI, gl.RGBA_INTEGER] : [gl.RG32UI, gl.RG_INTEGER];
    gl.texImage2D(gl.TEXTURE_2D, 0, kind, width, height, 0, parts, gl.UNSIGNED_INT, null);
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.seen, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
  }

  /** The mesh of a shape, made when it is first seen. */
  mesh(shape) {
    if (this.meshes[shape]) return this.meshes[shape];
    const gl = this.gl, {vertices, triangles} = new CellMesh(this.shapes[shape]), n = vertices.length / VERTEX, width = VERTEX + 1;
    const copies = Math.min(MOST_COPIES, Math.max(1, Math.floor(BUNDLE / n)));
    const corners = new Float32Array(width * n * copies), faces = new Uint32Array(triangles.length * copies);
    for (let c = 0; c < copies; ++c) {
      for (let i = 0; i < n; ++i) {
        for (let j = 0; j < VERTEX; ++j) corners[width * (c * n + i) + j] = vertices[VERTEX * i + j];
        corners[width * (c * n + i) + VERTEX] = c;
      }
      for (let i = 0; i < triangles.length; ++i) faces[c * triangles.length + i] = c * n + triangles[i];
    }
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    COLUMNS_OF_MESH.forEach(([, size, offset], where) => {
      gl.enableVertexAttribArray(where);
      gl.vertexAttribPointer(where, size, gl.FLOAT, false, 4 * width, 4 * offset);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
    return this.meshes[shape] = {array, count: triangles.length, copies};
  }

  /** Of every owner, [r, g, b]. */
  setColors(colors) {
    const gl = this.gl, rows = Math.ceil(colors.length / COLORS), bytes = new Uint8Array(4 * COLORS * rows);
    colors.forEach((c, k) => bytes.set([255 * c[0], 255 * c[1], 255 * c[2], 255].map(Math.round), 4 * k));
    gl.bindTexture(gl.TEXTURE_2D, this.colors);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, COLORS, rows, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  }

  /**
   * `view`: {x, y, scale} in pixels of a picture of `width` x `height`; `looks`: {ring [m], paper: [r, g, b], fixed: how many of the
   * owners, the first of them, are sites of the scene}; `detail`: {paint, mesh}, by
   * how much coarser than that picture the two passes are.
   */
  draw(things, {x, y, scale}, [width, height], looks, detail) {
    const gl = this.gl, {canvas} = this, of = by => [Math.max(1, Math.round(width / by)), Math.max(1, Math.round(height / by))];
    const [w, h] = of(detail.paint);
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, {width: w, height: h});
    const [columns, rows] = detail.mesh === detail.paint ? [w, h] : of(detail.mesh), coarse = columns < w ? 1 : 0;
    this.fit(columns, rows, coarse);
    gl.viewport(0, 0, columns, rows);
    this.drawMeshes(things, {x, y, across: 2 * scale / width, up: 2 * scale / height, tie: TIE / scale}, 1.5 * Math.hypot(width, height) / scale, coarse, looks.fixed);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, w, h);
    gl.disable(gl.DEPTH_TEST);
    const {name, at} = this.paintPrograms[coarse];
    gl.useProgram(name);
    gl.bindVertexArray(this.nothing);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.colors);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.seen);
    gl.uniform1i(at.seen, 0);
    gl.uniform1i(at.colors, 1);
    gl.uniform2f(at.coarse, columns / w, rows / h);
    gl.uniform1ui(at.scenery, looks.fixed);
    gl.uniform1f(at.ring, looks.ring);
    gl.uniform1f(at.pixel, width / (w * scale));
    gl.uniform1f(at.large, width / w);
    gl.uniform3f(at.paper, ...looks.paper);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    this.begin();
  }

  /** What was told is begun with: a flush alone is put off until something else is drawn. */
  begin() {
    const {gl} = this, fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    gl.deleteSync(fence);
  }

  /** `all`: farther than that nothing is seen [m]. */
  drawMeshes(things, view, all, coarse, fixed) {
    const gl = this.gl, {at, name} = this.meshPrograms[coarse], n = things.count, {shapes} = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(name);
    // things of one mesh follow each other
    const starts = new Int32Array(shapes.length + 1);
    let deepest = 0;
    for (let i = 0; i < n; ++i) {
      deepest = Math.max(deepest, Math.min(things.reach[i], all));
      ++starts[things.shape[i] + 1];
    }
    for (let m = 0; m < shapes.length; ++m) starts[m + 1] += starts[m];
    const rows = Math.max(1, Math.ceil(n / ROW)), next = starts.slice();
    if (this.places.length < 8 * ROW * rows) this.places = new Float32Array(8 * ROW * rows);
    const {places} = this;
    for (let i = 0; i < n; ++i) {
      let to = 8 * next[things.shape[i]]++;
      // places relative to the view: nothing is lost far from the origin
      places[to++] = things.x[i] - view.x; places[to++] = things.y[i] - view.y;
      places[to++] = Math.cos(things.angle[i]); places[to++] = Math.sin(things.angle[i]);
      places[to++] = things.owner[i]; places[to++] = Math.min(things.reach[i], all);
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.where);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 2 * ROW, rows, 0, gl.RGBA, gl.FLOAT, places);
    gl.uniform1i(at.things, 0);
    gl.uniform1f(at.deepest, deepest);
    gl.uniform1ui(at.first, fixed + 1);
    gl.uniform1f(at.tie, view.tie);
    gl.uniform2f(at.view, view.across, view.up);
    for (let m = 0; m < shapes.length; ++m) {
      const count = starts[m + 1] - starts[m];
      if (!count) continue;
      const mesh = this.mesh(m), bundles = Math.ceil(count / mesh.copies);
      gl.bindVertexArray(mesh.array);
      gl.uniform3i(at.which, starts[m], starts[m + 1], mesh.copies);
      // of a bundle that is not full the copies in use alone
      gl.drawElementsInstanced(gl.TRIANGLES, mesh.count * Math.min(count, mesh.copies), gl.UNSIGNED_INT, 0, bundles);
    }
  }

  /** Whose cell was drawn last at a pixel of the first pass, from the bottom left, and the distance to it [m]; null: nobody's. */
  at(column, row) {
    const gl = this.gl, words = new Uint32Array(4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.readPixels(column, row, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return words[0] ? {owner: words[0] - 1, distance: new Float32Array(words.buffer)[1]} : null;
  }
}
