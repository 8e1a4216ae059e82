// Solids that are drawn with the organ: the tool, the arrow of the force, marks.

// Returns a solid of revolution about z, with a profile of (radius, height) pairs.
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
// Returns the profile of a half ball, from a pole at height -radius to the equator at 0.
function halfBall(radius) {
  const profile = [];
  for (let n = 0; n <= 8; ++n) {
    const angle = Math.PI / 2 * n / 8;
    profile.push([radius * Math.sin(angle), -radius * Math.cos(angle)]);
  }
  return profile;
}
// Returns the profile of a tool that is not a finger and therefore has no size of its own. The
// centre of its round tip is at height 0.
const thinTool = (radius, top) =>
    [...halfBall(radius), [radius, top * 0.6], [radius * 1.15, top], [0.0001, top]];
// Returns the profile of a finger of radius 1, with the centre of its round tip at height 0.
// `palpate view` draws a finger of the same length.
function finger() {
  const end = halfBall(1), long = 2.2;
  return [...end, ...end.reverse().map(([r, z]) => [r, long - z])];
}
// Returns a matrix that places a solid at `at`, with its z axis along `direction`. wide, long:
// scale factors across and along that axis.
function placed(at, direction, wide = 1, long = 1) {
  const z = unit(direction), x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z)),
        y = cross(z, x);
  return new Float32Array(
      [...scaled(x, wide), 0, ...scaled(y, wide), 0, ...scaled(z, long), 0, ...at, 1]);
}
