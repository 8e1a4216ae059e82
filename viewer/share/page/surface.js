// The drawn surface: the coarse mesh of the field, refined `times` times.

class Surface {
  constructor({vertices, triangles, touchOfTriangle}, times) {
    this.coarse = vertices;
    this.corners = triangles;
    this.touchOfTriangle = touchOfTriangle;
    const count = vertices.length / 3;
    const {sums, faces} = refined(count, triangles, times, facts.mostVertices);
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

  // Interpolates values, three per vertex, from the coarse vertices to the fine vertices.
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

  // Returns the colours of the vertices: wet tissue with blotches, paler where nothing can be felt.
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

  // Deforms the surface. shape: displacements of the coarse vertices. The drawn point `seen` under
  // the tool moves by p; vertices within `reach` of it follow.
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

  // Returns the first point of the drawn surface that a ray meets; null if there is none. The
  // result has the corresponding point of the coarse mesh and, as `seen`, the drawn point at rest.
  // position: positions of the drawn vertices, by default at rest.
  hit(from, along, position = this.rest) {
    let nearest = null, least = Infinity;
    for (let t = 0; t < this.faces.length; ++t) {
      const a = 3 * this.index[3 * t], b = 3 * this.index[3 * t + 1], c = 3 * this.index[3 * t + 2];
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
