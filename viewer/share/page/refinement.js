// Refines a triangle mesh by Loop's rules, so that it looks smooth like an organ.

// Returns {sums, faces} of the refined mesh. sums: one Map per fine vertex, from coarse vertices to
// their weights. faces: fine triangles, each with its position in a coarse triangle. Refines at
// most `times` times. Each time the number of vertices about quadruples; the last refinement is the
// one before it would reach `most`.
function refined(vertexCount, triangles, times, most) {
  let mesh = {sums: Array.from({length: vertexCount}, (_, v) => new Map([[v, 1]])), faces: []};
  for (let t = 0; t < triangles.length / 3; ++t)
    mesh.faces.push({
      vertices: Array.from(triangles.subarray(3 * t, 3 * t + 3)),
      triangle: t,
      uv: [[0, 0], [1, 0], [0, 1]]
    });
  for (let time = 0; time < times && 4 * mesh.sums.length < most; ++time) mesh = refinedOnce(mesh);
  return mesh;
}

function refinedOnce({sums, faces}) {
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
