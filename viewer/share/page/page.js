'use strict';
(() => {
  const byId = (id) => document.getElementById(id);
  const facts = JSON.parse(byId('facts').textContent);

  // What stopped the page, and what to do; nothing else is seen then.
  function stop(sentence) {
    byId('trouble').textContent =
        sentence[0].toUpperCase() + sentence.slice(1) + (/[.!?]$/.test(sentence) ? '' : '.');
    byId('trouble').hidden = false;
    byId('words').hidden = byId('numbers').hidden = true;
    document.body.dataset.state = 'stopped';
  }

  // ---- Vectors of three numbers
  // ------------------------------------------------------------------

  const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
  const sub = (a, b) => add(a, b, -1);
  const scaled = (a, t) => [t * a[0], t * a[1], t * a[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross =
      (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = (a) => Math.sqrt(dot(a, a));
  const unit = (a) => scaled(a, 1 / (length(a) || 1));
  const row = (array, n) => [array[3 * n], array[3 * n + 1], array[3 * n + 2]];

  // What a picture's indices can number (palpate share refuses more); each refinement makes about
  // four vertices of one.
  const mostVertices = 65536;

  // ---- The surface: the mesh, refined by Loop's rules so that it looks like an organ
  // ----------------

  // Every fine vertex is a weighted sum of coarse ones; every fine triangle knows where in which
  // coarse one it lies.
  class Surface {
    constructor({vertices, triangles, touchOfTriangle}, levels) {
      this.coarse = vertices;
      this.corners = triangles;
      this.touchOfTriangle = touchOfTriangle;
      const count = vertices.length / 3;
      let sums = Array.from({length: count}, (_, v) => new Map([[v, 1]]));
      let faces = [];
      for (let t = 0; t < triangles.length / 3; ++t)
        faces.push({
          vertices: Array.from(triangles.subarray(3 * t, 3 * t + 3)),
          triangle: t,
          uv: [[0, 0], [1, 0], [0, 1]]
        });
      for (let level = 0; level < levels && 4 * sums.length < mostVertices; ++level)
        ({sums, faces} = Surface.refined(sums, faces));
      this.count = sums.length;
      this.first = new Uint32Array(sums.length + 1);
      sums.forEach((sum, v) => {
        this.first[v + 1] = this.first[v] + sum.size;
      });
      this.from = new Uint16Array(this.first[sums.length]);
      this.weight = new Float32Array(this.from.length);
      sums.forEach((sum, v) => {
        let n = this.first[v];
        for (const [coarse, weight] of sum) {
          this.from[n] = coarse;
          this.weight[n++] = weight;
        }
      });
      this.faces = faces;
      this.index = new Uint16Array(faces.flatMap((face) => face.vertices));
      this.rest = this.fine(vertices);
      this.position = this.rest.slice();
      this.normal = new Float32Array(this.rest.length);
      this.setNormals();
      this.vertexNormals = Surface.normalsOf(vertices, triangles);
      this.felt = new Float32Array(this.count);
      for (const face of faces)
        if (touchOfTriangle[face.triangle] >= 0)
          for (const v of face.vertices) this.felt[v] = 1;
      this.center = [0, 1, 2].map((axis) => {
        let least = Infinity, most = -Infinity;
        for (let v = 0; v < count; ++v) {
          least = Math.min(least, vertices[3 * v + axis]);
          most = Math.max(most, vertices[3 * v + axis]);
        }
        return (least + most) / 2;
      });
      this.radius = 0;
      for (let v = 0; v < count; ++v)
        this.radius = Math.max(this.radius, length(sub(row(vertices, v), this.center)));
    }

    static refined(sums, faces) {
      const edges = new Map(), around = sums.map(() => new Set());
      for (const {vertices} of faces)
        for (let c = 0; c < 3; ++c) {
          const a = vertices[c], b = vertices[(c + 1) % 3], opposite = vertices[(c + 2) % 3];
          const key = Math.min(a, b) * sums.length + Math.max(a, b);
          if (!edges.has(key)) edges.set(key, {a, b, opposite: []});
          edges.get(key).opposite.push(opposite);
          around[a].add(b);
          around[b].add(a);
        }
      const blend = (parts) => {
        const sum = new Map();
        for (const [vertex, weight] of parts)
          for (const [coarse, share] of sums[vertex])
            sum.set(coarse, (sum.get(coarse) || 0) + weight * share);
        return sum;
      };
      const fine = sums.map((_, v) => {
        const n = around[v].size, beta = n === 3 ? 3 / 16 : 3 / (8 * n);
        return blend([[v, 1 - n * beta], ...[...around[v]].map((other) => [other, beta])]);
      });
      for (const edge of edges.values()) {
        edge.number = fine.length;
        const [c, d] = edge.opposite;
        fine.push(blend(
            d === undefined ? [[edge.a, 0.5], [edge.b, 0.5]] :
                              [[edge.a, 3 / 8], [edge.b, 3 / 8], [c, 1 / 8], [d, 1 / 8]]));
      }
      const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
      const split = [];
      for (const {vertices: [a, b, c], triangle, uv: [ta, tb, tc]} of faces) {
        const on = (v, w) => edges.get(Math.min(v, w) * sums.length + Math.max(v, w)).number;
        const ab = on(a, b), bc = on(b, c), ca = on(c, a);
        const tab = middle(ta, tb), tbc = middle(tb, tc), tca = middle(tc, ta);
        split.push(
            {vertices: [a, ab, ca], triangle, uv: [ta, tab, tca]},
            {vertices: [ab, b, bc], triangle, uv: [tab, tb, tbc]},
            {vertices: [ca, bc, c], triangle, uv: [tca, tbc, tc]},
            {vertices: [ab, bc, ca], triangle, uv: [tab, tbc, tca]});
      }
      return {sums: fine, faces: split};
    }

    // Of values per coarse vertex, three each.
    fine(values) {
      const out = new Float32Array(3 * this.count);
      for (let v = 0; v < this.count; ++v)
        for (let n = this.first[v]; n < this.first[v + 1]; ++n) {
          const from = 3 * this.from[n], weight = this.weight[n];
          out[3 * v] += weight * values[from];
          out[3 * v + 1] += weight * values[from + 1];
          out[3 * v + 2] += weight * values[from + 2];
        }
      return out;
    }

    // Of wet tissue, in blotches as it has; paler where nothing can be felt.
    colours() {
      const out = new Float32Array(3 * this.count), {sin} = Math;
      for (let v = 0; v < this.count; ++v) {
        const [x, y, z] = row(this.rest, v).map((metres) => 11 * metres / this.radius);
        const blotch = 0.5 +
            0.5 * sin(3.1 * x + sin(2.3 * y)) * sin(2.9 * y + sin(2.7 * z)) *
                sin(3.3 * z + sin(2.1 * x));
        const tissue = add(scaled([0.49, 0.13, 0.105], 1 - blotch), [0.57, 0.185, 0.145], blotch);
        out.set(this.felt[v] > 0 ? tissue : add(scaled(tissue, 0.55), [0.21, 0.13, 0.115]), 3 * v);
      }
      return out;
    }

    static normalsOf(position, index, out = new Float32Array(position.length)) {
      out.fill(0);
      for (let t = 0; t < index.length; t += 3) {
        const a = 3 * index[t], b = 3 * index[t + 1], c = 3 * index[t + 2];
        const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1],
              uz = position[b + 2] - position[a + 2];
        const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1],
              vz = position[c + 2] - position[a + 2];
        const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
        for (const corner of [a, b, c]) {
          out[corner] += nx;
          out[corner + 1] += ny;
          out[corner + 2] += nz;
        }
      }
      for (let i = 0; i < out.length; i += 3) {
        const over = 1 / (Math.hypot(out[i], out[i + 1], out[i + 2]) || 1);
        out[i] *= over;
        out[i + 1] *= over;
        out[i + 2] *= over;
      }
      return out;
    }
    setNormals() { Surface.normalsOf(this.position, this.index, this.normal); }

    // Displacements of the coarse vertices; the point `seen` under the tool moves by p, and what is
    // about it.
    deform(shape, seen, p, reach) {
      const moved = this.fine(shape);
      if (seen) {
        const at = [0, 0, 0];
        seen.vertices.forEach((v, c) => {
          for (let i = 0; i < 3; ++i) at[i] += seen.shares[c] * moved[3 * v + i];
        });
        const missing = sub(p, at);
        for (let v = 0; v < this.count; ++v) {
          const dx = this.rest[3 * v] - seen.point[0], dy = this.rest[3 * v + 1] - seen.point[1],
                dz = this.rest[3 * v + 2] - seen.point[2];
          const inside = 1 - (dx * dx + dy * dy + dz * dz) / (reach * reach);
          if (inside <= 0) continue;
          for (let i = 0; i < 3; ++i) moved[3 * v + i] += inside * inside * missing[i];
        }
      }
      for (let i = 0; i < moved.length; ++i) this.position[i] = this.rest[i] + moved[i];
      this.setNormals();
    }

    // Where a ray meets the organ first, at rest or as it is: a point of the mesh, and what is seen
    // there.
    hit(from, along, position = this.rest) {
      let nearest = null, least = Infinity;
      for (let t = 0; t < this.faces.length; ++t) {
        const a = 3 * this.index[3 * t], b = 3 * this.index[3 * t + 1],
              c = 3 * this.index[3 * t + 2];
        const e1x = position[b] - position[a], e1y = position[b + 1] - position[a + 1],
              e1z = position[b + 2] - position[a + 2];
        const e2x = position[c] - position[a], e2y = position[c + 1] - position[a + 1],
              e2z = position[c + 2] - position[a + 2];
        const px = along[1] * e2z - along[2] * e2y, py = along[2] * e2x - along[0] * e2z,
              pz = along[0] * e2y - along[1] * e2x;
        const det = e1x * px + e1y * py + e1z * pz;
        if (det < 1e-14) continue;  // seen from behind
        const tx = from[0] - position[a], ty = from[1] - position[a + 1],
              tz = from[2] - position[a + 2];
        const u = (tx * px + ty * py + tz * pz) / det;
        if (u < 0 || u > 1) continue;
        const qx = ty * e1z - tz * e1y, qy = tz * e1x - tx * e1z, qz = tx * e1y - ty * e1x;
        const v = (along[0] * qx + along[1] * qy + along[2] * qz) / det;
        if (v < 0 || u + v > 1) continue;
        const away = (e2x * qx + e2y * qy + e2z * qz) / det;
        if (away > 0 && away < least) {
          least = away;
          nearest = {t, u, v};
        }
      }
      if (!nearest) return null;
      const {t, u, v} = nearest, face = this.faces[t], shares = [1 - u - v, u, v];
      const uv =
          [0, 1].map((i) => face.uv.reduce((sum, corner, c) => sum + shares[c] * corner[i], 0));
      const seen = {vertices: face.vertices, shares, point: [0, 0, 0]};
      face.vertices.forEach((vertex, c) => {
        seen.point = add(seen.point, row(this.rest, vertex), shares[c]);
      });
      return {
        touch: this.touchOfTriangle[face.triangle],
        triangle: face.triangle,
        u: uv[0],
        v: uv[1],
        seen,
        normal: this.normalAt(face.triangle, uv)
      };
    }
    normalAt(triangle, [u, v]) {
      const at = (c) => row(this.vertexNormals, this.corners[3 * triangle + c]);
      return unit(add(add(scaled(at(0), 1 - u - v), at(1), u), at(2), v));
    }
  }

  // ---- The picture
  // ---------------------------------------------------------------------------------

  // A processor that draws by itself passes most of its time with vertices: what does not change is
  // an attribute, and the view is that of an eye far away.
  const tissueVertex = `
attribute vec3 position, normal, rest, colour;
uniform mat4 camera; uniform vec3 pressed; varying vec3 along, skin; varying float away;
void main() {
  along = normal; skin = colour; away = distance(rest, pressed);
  gl_Position = camera * vec4(position, 1.0);
}`;
  const tissueFragment = `
precision mediump float;
uniform vec3 view, key; uniform float ring, pressure, thin, showing;
varying vec3 along, skin; varying float away;
void main() {
  vec3 n = normalize(along);
  float under = showing * (1.0 - smoothstep(0.0, ring, away));
  vec3 pale = mix(skin, vec3(0.80, 0.46, 0.38), 0.55 * under * pressure);
  float lit = dot(n, key), wrapped = max(0.0, (lit + 0.35) / 1.35);
  vec3 light = vec3(1.05, 1.0, 0.95) * wrapped + vec3(0.30, 0.33, 0.37) * (0.75 + 0.25 * n.z);
  light += vec3(0.15, 0.03, 0.02) * (1.0 - abs(lit));
  float shine = max(0.0, dot(n, normalize(key + view)));
  float s2 = shine * shine, s4 = s2 * s2, s8 = s4 * s4, s16 = s8 * s8, s32 = s16 * s16;
  float edge = 1.0 - max(0.0, dot(n, view)), rim = edge * edge * edge;
  vec3 seen = pale * light + vec3(0.5) * s32 * s32 * s16 + vec3(0.11) * s16 + vec3(0.24, 0.22, 0.22) * rim;
  float line = showing * (1.0 - smoothstep(0.0, thin, abs(away - ring)));
  gl_FragColor = vec4(mix(seen, vec3(1.0, 0.72, 0.36), 0.65 * line), 1.0);
}`;
  const solidVertex = `
attribute vec3 position, normal; uniform mat4 camera, placed; varying vec3 along, at;
void main() { vec4 p = placed * vec4(position, 1.0); at = p.xyz; along = (placed * vec4(normal, 0.0)).xyz; gl_Position = camera * p; }`;
  const solidFragment = `
precision mediump float; uniform vec3 eye, key, colour; uniform float gloss; varying vec3 along, at;
void main() {
  vec3 n = normalize(along); float lit = max(0.0, 0.5 + 0.5 * dot(n, key));
  float shine = pow(max(0.0, dot(n, normalize(key + normalize(eye - at)))), 40.0);
  gl_FragColor = vec4(colour * (0.35 + 0.75 * lit) + vec3(gloss * shine), 1.0);
}`;

  // A solid of revolution about z through (radius, height) pairs.
  function turned(profile, around = 14) {
    const position = [], normal = [], index = [];
    profile.forEach(([r, z], n) => {
      const before = profile[Math.max(0, n - 1)],
            after = profile[Math.min(profile.length - 1, n + 1)];
      const slope = unit([after[1] - before[1], before[0] - after[0], 0]);
      for (let a = 0; a <= around; ++a) {
        const angle = 2 * Math.PI * a / around;
        position.push(r * Math.cos(angle), r * Math.sin(angle), z);
        normal.push(slope[0] * Math.cos(angle), slope[0] * Math.sin(angle), slope[1]);
        if (n === 0 || a === around) continue;
        const here = n * (around + 1) + a, below = here - around - 1;
        index.push(below, below + 1, here, here, below + 1, here + 1);
      }
    });
    return {position, normal, index};
  }
  function roundedTip(radius, top) {
    const profile = [];
    for (let n = 0; n <= 8; ++n) {
      const angle = Math.PI / 2 * n / 8;
      profile.push([radius * Math.sin(angle), radius - radius * Math.cos(angle)]);
    }
    return [...profile, [radius, top * 0.6], [radius * 1.15, top], [0.0001, top]];
  }
  // Stands the z axis of a solid along a direction at a place, with its own scales.
  function placed(at, direction, wide = 1, long = 1) {
    const z = unit(direction), x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z)),
          y = cross(z, x);
    return new Float32Array(
        [...scaled(x, wide), 0, ...scaled(y, wide), 0, ...scaled(z, long), 0, ...at, 1]);
  }

  class Camera {
    constructor(surface) {
      this.target = surface.center;
      this.distance = 3.1 * surface.radius;
      this.least = 1.3 * surface.radius;
      this.most = 8 * surface.radius;
      const felt = surface.felt.reduce((sum, one) => sum + one, 1);
      let best = -Infinity;
      for (let tilt = -2; tilt <= 3; ++tilt)
        for (let turn = 0; turn < 16; ++turn) {
          this.turn = turn * Math.PI / 8;
          this.tilt = tilt * Math.PI / 10;
          const back = this.back();
          // The broad side of the organ, and in view what can be touched.
          let area = 0;
          for (let v = 0; v < surface.count; v += 3)
            area += Math.max(0, dot(back, row(surface.normal, v))) *
                (surface.felt[v] > 0 ? 1 + 0.25 * surface.count / felt : 1);
          if (area > best) {
            best = area;
            this.best = [this.turn, this.tilt];
          }
        }
      [this.turn, this.tilt] = this.best;
    }
    back() {
      return [
        Math.cos(this.tilt) * Math.sin(this.turn), -Math.cos(this.tilt) * Math.cos(this.turn),
        Math.sin(this.tilt)
      ];
    }
    orbit(dx, dy) {
      this.turn -= 0.008 * dx;
      this.tilt = Math.min(1.5, Math.max(-1.5, this.tilt + 0.008 * dy));
    }
    zoom(factor) {
      this.distance = Math.min(this.most, Math.max(this.least, this.distance * factor));
    }
    look(width, height) {
      const back = this.back(), right = unit(cross([0, 0, 1], back)), up = cross(back, right);
      const eye = add(this.target, back, this.distance * Math.max(1, 1.15 * height / width));
      const f = 1 / Math.tan(0.32), near = this.distance * 0.05, far = this.distance * 6;
      const view = [
        right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
        -dot(right, eye), -dot(up, eye), -dot(back, eye), 1
      ];
      const project = [
        f * height / width, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
        2 * far * near / (near - far), 0
      ];
      const product = new Float32Array(16);
      for (let c = 0; c < 4; ++c)
        for (let r = 0; r < 4; ++r)
          for (let k = 0; k < 4; ++k) product[4 * c + r] += project[4 * k + r] * view[4 * c + k];
      return Object.assign(this, {eye, right, up, matrix: product, focal: f, width, height});
    }
    // The direction of what is seen at a place of the canvas, in pixels of the page.
    ray(x, y) {
      const sx = (2 * x / this.width - 1) * this.width / this.height / this.focal,
            sy = (1 - 2 * y / this.height) / this.focal;
      return unit(add(add(scaled(this.back(), -1), this.right, sx), this.up, sy));
    }
  }

  class Picture {
    constructor(canvas, gl, surface) {
      Object.assign(this, {canvas, gl, surface});
      this.tissue = this.program(tissueVertex, tissueFragment);
      this.solid = this.program(solidVertex, solidFragment);
      const r = surface.radius;
      this.buffers = {
        position: this.buffer(surface.position),
        normal: this.buffer(surface.normal),
        rest: this.buffer(surface.rest),
        colour: this.buffer(surface.colours()),
        index: this.indexBuffer(surface.index)
      };
      this.tool = this.solidOf(turned(roundedTip(0.045 * r, 0.75 * r)));
      this.shaft = this.solidOf(turned([[0.0001, 0], [1, 0], [1, 1], [0.0001, 1]]));
      this.head = this.solidOf(turned([[0.0001, 0], [1, 0], [0.0001, 1]]));
      this.ball = this.solidOf(turned(Array.from(
          {length: 13},
          (_, n) => [Math.max(1e-4, Math.sin(Math.PI * n / 12)), -Math.cos(Math.PI * n / 12)])));
      gl.enable(gl.DEPTH_TEST);
      gl.enable(gl.CULL_FACE);
      gl.clearColor(0.149, 0.176, 0.2, 1);
    }
    program(vertex, fragment) {
      const gl = this.gl, program = gl.createProgram();
      for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
          throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
      }
      gl.linkProgram(program);
      const uniforms = {};
      for (let n = 0; n < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++n) {
        const {name} = gl.getActiveUniform(program, n);
        uniforms[name] = gl.getUniformLocation(program, name);
      }
      const attributes = {};
      for (let n = 0; n < gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); ++n) {
        const {name} = gl.getActiveAttrib(program, n);
        attributes[name] = gl.getAttribLocation(program, name);
      }
      return {program, uniforms, attributes};
    }
    buffer(values) {
      const gl = this.gl, made = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, made);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
      return made;
    }
    indexBuffer(values) {
      const gl = this.gl, made = gl.createBuffer();
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, values, gl.STATIC_DRAW);
      return made;
    }
    solidOf({position, normal, index}) {
      return {
        position: this.buffer(new Float32Array(position)),
        normal: this.buffer(new Float32Array(normal)),
        index: this.indexBuffer(new Uint16Array(index)),
        count: index.length
      };
    }
    feed({attributes}, buffers, sizes) {
      const gl = this.gl;
      for (const name in sizes) {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
        gl.enableVertexAttribArray(attributes[name]);
        gl.vertexAttribPointer(attributes[name], sizes[name], gl.FLOAT, false, 0, 0);
      }
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.index);
    }
    reshaped() {
      const gl = this.gl;
      for (const name of ['position', 'normal']) {
        gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
        gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.surface[name]);
      }
    }
    drawSolid(solid, matrix, colour, gloss) {
      const gl = this.gl, {uniforms} = this.solid;
      gl.uniformMatrix4fv(uniforms.placed, false, matrix);
      gl.uniform3fv(uniforms.colour, colour);
      gl.uniform1f(uniforms.gloss, gloss);
      this.feed(this.solid, solid, {position: 3, normal: 3});
      gl.drawElements(gl.TRIANGLES, solid.count, gl.UNSIGNED_SHORT, 0);
    }
    // mark: what of the organ is shown as touched, {point, radius, pressure}; hand: {tip, axis,
    // force, scale}; spots: places.
    draw(camera, {mark, hand, spots}) {
      const gl = this.gl, {surface} = this;
      gl.viewport(0, 0, this.canvas.width, this.canvas.height);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const key = unit(add(add(camera.back(), camera.up, 0.9), camera.right, -0.55));
      gl.useProgram(this.tissue.program);
      const {uniforms} = this.tissue;
      gl.uniformMatrix4fv(uniforms.camera, false, camera.matrix);
      gl.uniform3fv(uniforms.view, camera.back());
      gl.uniform3fv(uniforms.key, key);
      gl.uniform3fv(uniforms.pressed, mark ? mark.point : [0, 0, 0]);
      gl.uniform1f(uniforms.ring, mark ? mark.radius : 1);
      gl.uniform1f(uniforms.pressure, mark ? mark.pressure : 0);
      gl.uniform1f(uniforms.showing, mark ? 1 : 0);
      gl.uniform1f(uniforms.thin, 0.006 * surface.radius);
      this.feed(this.tissue, this.buffers, {position: 3, normal: 3, rest: 3, colour: 3});
      gl.drawElements(gl.TRIANGLES, surface.index.length, gl.UNSIGNED_SHORT, 0);
      gl.useProgram(this.solid.program);
      gl.uniformMatrix4fv(this.solid.uniforms.camera, false, camera.matrix);
      gl.uniform3fv(this.solid.uniforms.eye, camera.eye);
      gl.uniform3fv(this.solid.uniforms.key, key);
      for (const spot of spots)
        this.drawSolid(
            this.ball, placed(spot, [0, 0, 1], 0.035 * surface.radius, 0.035 * surface.radius),
            [1, 0.72, 0.36], 0.4);
      if (!hand) return;
      this.drawSolid(this.tool, placed(hand.tip, hand.axis), [0.72, 0.76, 0.79], 0.8);
      const size = length(hand.force);
      if (size < 0.005) return;
      const along = scaled(hand.force, 1 / size), long = hand.scale * size,
            wide = 0.016 * surface.radius;
      const headLong = Math.min(0.6 * long, 0.11 * surface.radius);
      this.drawSolid(
          this.shaft, placed(hand.tip, along, wide, long - headLong), [1, 0.66, 0.22], 0.3);
      this.drawSolid(
          this.head, placed(add(hand.tip, along, long - headLong), along, 2.4 * wide, headLong),
          [1, 0.66, 0.22], 0.3);
    }
  }

  // ---- The force over time
  // ---------------------------------------------------------------------------

  class ForcePlot {
    constructor(canvas) {
      Object.assign(this, {canvas, pen: canvas.getContext('2d'), seconds: 8, samples: []});
    }
    add(time, force, bound) {
      this.samples.push({time, force, bound});
      while (this.samples.length > 2 && this.samples[1].time < time - this.seconds)
        this.samples.shift();
    }
    isFlat() { return this.samples.every((s) => s.force === 0); }
    draw(now) {
      const {canvas, pen, samples} = this, ratio = Math.min(2, devicePixelRatio || 1);
      const width = canvas.clientWidth, height = canvas.clientHeight;
      if (canvas.width !== Math.round(width * ratio)) {
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
      }
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, width, height);
      const most = samples.reduce((top, s) => Math.max(top, s.force + s.bound), 0.4);
      const step =
                [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((size) => most / size <= 4) || most / 4,
            top = Math.ceil(most / step) * step;
      const left = 34, base = height - 16,
            x = (time) => width - 4 - (width - left - 4) * (now - time) / this.seconds;
      const y = (force) => base - (base - 8) * force / top;
      pen.font = '11px system-ui,sans-serif';
      pen.textAlign = 'right';
      for (let force = 0; force <= top + 1e-9; force += step) {
        pen.fillStyle = '#ffffff22';
        pen.fillRect(left, y(force), width - left - 4, 1);
        pen.fillStyle = '#b4bcc2';
        pen.fillText(force.toFixed(step < 1 ? 1 : 0), left - 6, y(force) + 4);
      }
      pen.fillText('now', width - 4, height - 3);
      pen.textAlign = 'left';
      pen.fillText(`${this.seconds} s ago`, left, height - 3);
      pen.fillText('N', left + 4, 12);
      if (samples.length < 2) return;
      pen.save();
      pen.beginPath();
      pen.rect(left, 0, width - left, height);
      pen.clip();
      pen.beginPath();
      samples.forEach((s) => pen.lineTo(x(s.time), y(s.force + s.bound)));
      for (let n = samples.length; n-- > 0;)
        pen.lineTo(x(samples[n].time), y(Math.max(0, samples[n].force - samples[n].bound)));
      pen.fillStyle = '#ffb45466';
      pen.fill();
      pen.beginPath();
      samples.forEach((s) => pen.lineTo(x(s.time), y(s.force)));
      pen.strokeStyle = '#fff';
      pen.lineWidth = 1.6;
      pen.stroke();
      pen.restore();
    }
  }

  // ---- The hand
  // ----------------------------------------------------------------------------------------

  // Presses at a place: in `press` seconds to the wanted depth, and back when it is let go.
  class Hand {
    constructor() {
      Object.assign(this, {place: null, held: false, depth: 0, wanted: 0.01, sideways: [0, 0, 0]});
    }
    begin(place) { Object.assign(this, {place, held: true, sideways: [0, 0, 0]}); }
    advance(seconds) {
      const goal = this.held ? this.wanted : 0, rate = this.held ? 9 : 16;
      this.depth += (goal - this.depth) * (1 - Math.exp(-rate * seconds));
      if (Math.abs(this.depth - goal) < 2e-6) this.depth = goal;
      if (!this.held) {
        this.sideways = scaled(this.sideways, Math.exp(-rate * seconds));
        if (this.depth < 1e-4) {
          this.place = null;
          this.depth = 0;
        }
      }
    }
    // The displacement of the tool, m, in the workspace.
    displacement(radius) {
      const p = add(scaled(this.place.normal, -this.depth), this.sideways), size = length(p);
      return size > radius ? scaled(p, radius / size) : p;
    }
  }

  // ---- The page
  // ----------------------------------------------------------------------------------------

  class Page {
    constructor(surface, touches, gl, worker) {
      const canvas = byId('organ');
      Object.assign(this, {
        surface,
        touches,
        worker,
        canvas,
        camera: new Camera(surface),
        hand: new Hand(),
        picture: new Picture(canvas, gl, surface),
        plot: new ForcePlot(byId('plot')),
        pointers: new Map(),
        over: null,
        answer: null,
        waiting: 0,
        asked: 0,
        changed: true,
        last: 0,
        frames: 0,
        shown: 0
      });
      this.radius = Math.max(...touches.map((touch) => touch.radius));
      this.spots = touches.filter((touch) => touch.fingerRadius === 0).map((touch) => touch.rest);
      const slider = byId('depth');
      slider.max = Math.round(1000 * this.radius);
      this.setDepth(Math.min(0.01, 0.4 * this.radius));
      slider.addEventListener('input', () => this.setDepth(slider.value / 1000));
      canvas.addEventListener('pointerdown', (event) => this.down(event));
      canvas.addEventListener('pointermove', (event) => this.move(event));
      for (const end of ['pointerup', 'pointercancel'])
        canvas.addEventListener(end, (event) => this.up(event));
      canvas.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
      canvas.addEventListener('contextmenu', (event) => event.preventDefault());
      addEventListener('resize', () => {
        this.changed = true;
      });
      this.say(this.resting());
      requestAnimationFrame((time) => this.frame(time));
    }
    say(text) { byId('hint').textContent = text; }
    resting() {
      const fingers = matchMedia('(pointer: coarse)').matches;
      const where = this.spots.length ? 'at the marked place' : 'anywhere';
      return fingers ?
          `Press it ${
              where} with a finger, deeper with the slider. Drag beside it to turn, pinch to come closer.` :
          `Press it ${
              where} with the mouse, deeper with the wheel. Drag beside it to turn, wheel to come closer.`;
    }
    setDepth(depth) {
      this.hand.wanted = Math.min(this.radius, Math.max(0.001, depth));
      byId('depth').value = 1000 * this.hand.wanted;
      byId('depth-shown').textContent = `${(1000 * this.hand.wanted).toFixed(1)} mm`;
    }
    hit(x, y) {
      const from = this.camera.eye, along = this.camera.ray(x, y);
      return this.surface.hit(from, along);
    }

    down(event) {
      this.canvas.setPointerCapture(event.pointerId);
      const hit = this.pointers.size === 0 ? this.hit(event.clientX, event.clientY) : null;
      const pointer = {x: event.clientX, y: event.clientY, presses: false};
      this.pointers.set(event.pointerId, pointer);
      if (!hit) return;
      if (hit.touch < 0)
        return this.say(
            this.spots.length ?
                'Nothing was computed here: press at the marked place.' :
                'The organ is held here, and nothing was computed: press another place.');
      pointer.presses = true;
      this.hand.begin(hit);
      this.say(
          'Move to feel around, ' + (event.pointerType === 'mouse' ? 'wheel' : 'slide the slider') +
          ' to press deeper.');
    }
    move(event) {
      const pointer = this.pointers.get(event.pointerId);
      if (!pointer) return this.hover(event);
      const dx = event.clientX - pointer.x, dy = event.clientY - pointer.y;
      if (pointer.presses)
        this.drag(event, dx, dy);
      else if (this.pointers.size === 2 && !this.hand.held)
        this.pinch(event);
      else if (this.pointers.size === 1) {
        this.camera.orbit(dx, dy);
        this.changed = true;
      }
      Object.assign(pointer, {x: event.clientX, y: event.clientY});
    }
    // On a surface the finger goes along; an active node is pulled aside.
    drag(event, dx, dy) {
      const {hand, camera} = this;
      if (this.touches[hand.place.touch].fingerRadius > 0) {
        const hit = this.hit(event.clientX, event.clientY);
        if (hit && hit.touch === hand.place.touch) hand.place = hit;
        return;
      }
      const metres = 2 * camera.distance / camera.focal / camera.height;
      hand.sideways = add(add(hand.sideways, camera.right, dx * metres), camera.up, -dy * metres);
    }
    pinch(event) {
      const [a, b] = [...this.pointers.entries()].map(
          ([id, p]) => id === event.pointerId ?
              {before: p, now: {x: event.clientX, y: event.clientY}} :
              {before: p, now: p});
      const apart = (one, two) => Math.hypot(one.x - two.x, one.y - two.y) || 1;
      this.camera.zoom(apart(a.before, b.before) / apart(a.now, b.now));
      this.changed = true;
    }
    hover(event) {
      const hit = this.hit(event.clientX, event.clientY);
      this.over = hit && hit.touch >= 0 ? hit : null;
      this.canvas.classList.toggle('over', this.over !== null);
      this.changed = true;
      if (this.over)
        this.worker.postMessage(
            {near: {touch: hit.touch, triangle: hit.triangle, u: hit.u, v: hit.v}});
    }
    up(event) {
      const pointer = this.pointers.get(event.pointerId);
      this.pointers.delete(event.pointerId);
      if (!pointer || !pointer.presses) return;
      this.hand.held = false;
      this.say(this.resting());
    }
    wheel(event) {
      event.preventDefault();
      const notches = event.deltaY / (event.deltaMode === 0 ? 100 : 3);
      if (this.hand.held || this.over) return this.setDepth(this.hand.wanted - 0.001 * notches);
      this.camera.zoom(Math.exp(0.12 * notches));
      this.changed = true;
    }

    // Asks the field for where the hand is, one question at a time.
    ask() {
      const {hand} = this;
      if (!hand.place || this.waiting) return;
      const {touch, triangle, u, v, seen} = hand.place,
                                    p = hand.displacement(this.touches[touch].radius);
      const same = this.answer && this.answer.triangle === triangle && this.answer.u === u &&
          this.answer.v === v && this.answer.p.every((x, i) => x === p[i]);
      if (same) return;
      this.waiting = ++this.asked;
      this.seen = seen;
      this.normal = hand.place.normal;
      this.worker.postMessage({touch, triangle, u, v, p, id: this.waiting});
    }
    heard(answer) {
      this.waiting = 0;
      if (!this.hand.place) return;
      this.answer = answer;
      this.felt = {...answer, shape: null, seen: this.seen, normal: this.normal};
      const reach = 0.8 * (this.touches[answer.touch].fingerRadius || 0.15 * this.surface.radius);
      this.surface.deform(answer.shape, this.seen, answer.p, reach);
      this.picture.reshaped();
      this.changed = true;
      window.palpate.touched = this.felt;
    }
    letGo() {
      this.answer = this.felt = null;
      this.surface.deform(new Float32Array(this.surface.coarse.length), null);
      this.picture.reshaped();
      this.changed = true;
      window.palpate.touched = null;
    }
    show() {
      const felt = this.felt, force = felt ? length(felt.force) : 0;
      const write = (id, text) => {
        if (byId(id).textContent !== text) byId(id).textContent = text;
      };
      write('force', force.toFixed(2));
      write(
          'bound',
          felt && Number.isFinite(felt.bound) ?
              `± ${felt.bound.toFixed(felt.bound < 0.095 ? 3 : 2)}` :
              '');
      write(
          'about',
          !felt            ? 'Not touching' :
              !felt.inside ? 'Beyond what was computed: this force is a guess' :
              felt.coverage < 0.5 ?
                             'Near the end of what was computed: do not rely on this force' :
                             `${(1000 * length(felt.p)).toFixed(1)} mm ${
                                 this.touches[felt.touch].fingerRadius > 0 ?
                                     'deep' :
                                     'from rest'}, ${(1000 * felt.energy).toFixed(1)} mJ stored`);
    }
    scene() {
      const felt = this.felt, spots = felt ? [] : this.spots;
      if (felt) {
        const tip = add(felt.seen.point, felt.p),
              radius = this.touches[felt.touch].fingerRadius || 0.1 * this.surface.radius;
        const axis = unit(add(add(felt.normal, this.camera.right, 0.75), this.camera.up, 0.35));
        return {
          mark: {point: felt.seen.point, radius, pressure: Math.min(1, length(felt.force) / 2)},
          spots,
          hand: {tip, axis, force: felt.force, scale: 0.7 * this.surface.radius / facts.maxForce}
        };
      }
      if (this.over) {
        const radius = this.touches[this.over.touch].fingerRadius || 0.1 * this.surface.radius;
        return {mark: {point: this.over.seen.point, radius, pressure: 0}, spots, hand: null};
      }
      return {mark: null, spots, hand: null};
    }
    frame(time) {
      const seconds = Math.min(0.05, (time - this.last) / 1000);
      this.last = time;
      if (this.hand.place) {
        this.hand.advance(seconds);
        if (this.hand.place)
          this.ask();
        else
          this.letGo();
      }
      const ratio = Math.min(2, devicePixelRatio || 1), {canvas} = this;
      const width = Math.round(canvas.clientWidth * ratio),
            height = Math.round(canvas.clientHeight * ratio);
      if (canvas.width !== width || canvas.height !== height) {
        Object.assign(canvas, {width, height});
        this.changed = true;
      }
      if (this.changed) {
        this.camera.look(canvas.clientWidth, canvas.clientHeight);
        this.picture.draw(this.camera, this.scene());
        this.changed = false;
        if (++this.frames === 1) this.started();
      }
      const force = this.felt ? length(this.felt.force) : 0;
      this.plot.add(
          time / 1000, force, this.felt && Number.isFinite(this.felt.bound) ? this.felt.bound : 0);
      if (time - this.shown > 45) {  // nobody reads numbers faster
        this.shown = time;
        this.show();
        if (this.frames < 5 || !this.plot.isFlat()) this.plot.draw(time / 1000);
      }
      canvas.classList.toggle('pressing', this.hand.held);
      requestAnimationFrame((next) => this.frame(next));
    }
    started() {
      document.body.dataset.state = 'ready';
      window.palpate.ready = performance.now();
    }
  }

  // A processor that draws by itself has no time for smooth edges and many triangles.
  function drawsBySoftware() {
    const gl = document.createElement('canvas').getContext('webgl');
    const named = gl && gl.getExtension('WEBGL_debug_renderer_info');
    const renderer = named ? gl.getParameter(named.UNMASKED_RENDERER_WEBGL) : '';
    if (gl && gl.getExtension('WEBGL_lose_context'))
      gl.getExtension('WEBGL_lose_context').loseContext();
    return /swiftshader|llvmpipe|software|basic render/i.test(renderer);
  }

  function begin() {
    window.palpate = {};
    if (typeof WebAssembly !== 'object' || typeof DecompressionStream !== 'function' ||
        typeof Worker !== 'function')
      return stop(
          'this browser is too old for this page: open it in Chrome or Edge 91, Firefox 113 or Safari 16.4, or in something newer');
    const onCard = !drawsBySoftware();
    const gl = byId('organ').getContext('webgl', {antialias: onCard, alpha: false});
    if (!gl)
      return stop(
          'this page draws the organ with WebGL, which this browser does not offer: turn on hardware acceleration in its ' +
          'settings and load the page again, or open it in another browser. On a phone save the file and open it in the ' +
          'browser itself, not in the preview of a mail');
    byId('organ').addEventListener(
        'webglcontextlost',
        () => stop('the graphics of this machine stopped: load the page again'));
    const worker = new Worker(
        URL.createObjectURL(new Blob([byId('worker').textContent], {type: 'text/javascript'})));
    let page = null;
    worker.onerror = () =>
        stop('the browser did not start the field of this page: open the file in another browser');
    worker.onmessage = ({data}) => {
      if (data.trouble)
        stop(data.trouble);
      else if (data.organ)
        page = window.palpate.page =
            new Page(new Surface(data.organ, onCard ? 2 : 1), data.organ.touches, gl, worker);
      else if (data.preparing === undefined)
        page.heard(data);
    };
    worker.postMessage(
        {field: byId('field-bytes').textContent, organ: byId('organ-bytes').textContent});
  }
  begin();
})();
