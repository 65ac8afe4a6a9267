'use strict';
// The Voronoi diagram as the method draws it: every site of every outline is a mesh whose height is the distance to it
// (a cone about a point, tents over a segment, a funnel over an arc); seen from below, the nearest wins.

const CONE = 96;

/** Triangles of one site: base point, direction of growth, and how far along it each vertex is (0 or 1). */
function siteMesh(site, out) {
  const vertex = (x, y, dx, dy, z) => out.push(x, y, dx, dy, z);
  const fan = (x, y, r) => {
    for (let i = 0; i < CONE; ++i) {
      const a = 2 * Math.PI * i / CONE, b = 2 * Math.PI * (i + 1) / CONE, m = 1 / Math.cos(Math.PI / CONE);
      vertex(x, y, 0, 0, -r);
      vertex(x, y, m * Math.cos(a), m * Math.sin(a), -r);
      vertex(x, y, m * Math.cos(b), m * Math.sin(b), -r);
    }
  };
  const quad = (a, b, nx, ny, r) => {
    vertex(...a, 0, 0, -r); vertex(...b, 0, 0, -r); vertex(...b, nx, ny, -r);
    vertex(...a, 0, 0, -r); vertex(...b, nx, ny, -r); vertex(...a, nx, ny, -r);
  };
  if (site.kind === 'point') return fan(...site.a, site.radius);
  fan(...site.a, site.radius);
  fan(...site.b, site.radius);
  if (site.kind === 'segment') {
    const dx = site.b[0] - site.a[0], dy = site.b[1] - site.a[1], l = Math.hypot(dx, dy) || 1;
    quad(site.a, site.b, -dy / l, dx / l, site.radius);
    quad(site.a, site.b, dy / l, -dx / l, site.radius);
    return;
  }
  const [cx, cy] = site.center, R = site.arc_radius, from = Math.atan2(site.a[1] - cy, site.a[0] - cx);
  const steps = Math.max(2, Math.ceil(CONE * Math.abs(site.sweep) / (2 * Math.PI)));
  for (let i = 0; i < steps; ++i) {
    const a = from + site.sweep * i / steps, b = from + site.sweep * (i + 1) / steps;
    const A = [Math.cos(a), Math.sin(a)], B = [Math.cos(b), Math.sin(b)];
    const on = (u, away, z) => vertex(cx + R * u[0], cy + R * u[1], away * u[0], away * u[1], z);
    on(A, 0, -site.radius); on(B, 0, -site.radius); on(B, 1, -site.radius);
    on(A, 0, -site.radius); on(B, 1, -site.radius); on(A, 1, -site.radius);
    // inwards to the centre, where it is R away
    on(A, 0, -site.radius); on(B, 0, -site.radius); vertex(cx, cy, 0, 0, R - site.radius);
  }
}

const VERTEX = `#version 300 es
in vec2 base; in vec2 grow; in float low;
uniform vec4 pose;    // x, y, cosine, sine
uniform vec4 view;    // centre, scale to clip space
uniform float far;    // [m]
out float height;
vec2 turned(vec2 v) { return vec2(pose.z * v.x - pose.w * v.y, pose.w * v.x + pose.z * v.y); }
void main() {
  vec2 p = pose.xy + turned(base + far * grow);
  height = low + (dot(grow, grow) > 0.0 ? far : 0.0);
  gl_Position = vec4((p - view.xy) * view.zw, clamp(height / far, -1.0, 1.0) * 0.999, 1.0);
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in float height;
uniform vec3 color; uniform float ring; uniform float pixel;
out vec4 shade;
void main() {
  float away = abs(fract(height / ring + 0.5) - 0.5) * ring;
  float line = height > 0.0 ? smoothstep(0.5, 1.5, away / pixel) : 1.0;
  shade = vec4(color * mix(0.93, 1.0, line), 1.0);
}`;

class Cells {
  constructor(canvas, shapes) {
    const gl = canvas.getContext('webgl2', {antialias: true, depth: true});
    if (!gl) return;
    this.gl = gl;
    this.canvas = canvas;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) { this.gl = null; return; }
    this.program = program;
    this.uniform = name => gl.getUniformLocation(program, name);
    this.at = Object.fromEntries(['pose', 'view', 'far', 'color', 'ring', 'pixel'].map(n => [n, this.uniform(n)]));
    this.meshes = shapes.map(shape => this.mesh(shape));
  }

  get works() { return !!this.gl; }

  mesh(shape) {
    const gl = this.gl, numbers = [];
    for (const loop of shape.loops) for (const site of loop.sites) siteMesh(site, numbers);
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    [['base', 2, 0], ['grow', 2, 8], ['low', 1, 16]].forEach(([name, size, offset]) => {
      const where = gl.getAttribLocation(this.program, name);
      gl.enableVertexAttribArray(where);
      gl.vertexAttribPointer(where, size, gl.FLOAT, false, 20, offset);
    });
    return {array, count: numbers.length / 5};
  }

  /**
   * `things`: {shape, pose: [x, y, angle], color: [r, g, b]}; `view`: {x, y, scale} in pixels of the canvas; `reach`: no place that
   * is seen is farther from all of them [m].
   */
  draw(things, view, ring, reach) {
    const gl = this.gl, {width, height} = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    const far = Math.min(reach, 1.5 * Math.hypot(width, height) / view.scale);
    gl.uniform1f(this.at.far, far);
    gl.uniform1f(this.at.ring, ring);
    gl.uniform1f(this.at.pixel, 1 / view.scale);
    // places relative to the view: nothing is lost far from the origin
    gl.uniform4f(this.at.view, 0, 0, 2 * view.scale / width, 2 * view.scale / height);
    for (const {shape, pose, color} of things) {
      const mesh = this.meshes[shape];
      gl.bindVertexArray(mesh.array);
      gl.uniform4f(this.at.pose, pose[0] - view.x, pose[1] - view.y, Math.cos(pose[2]), Math.sin(pose[2]));
      gl.uniform3f(this.at.color, ...color);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
  }

  clear() {
    this.gl.clearColor(0, 0, 0, 0);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT | this.gl.DEPTH_BUFFER_BIT);
  }
}
