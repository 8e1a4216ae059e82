// Vectors of three numbers.

const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const sub = (a, b) => add(a, b, -1);
const scaled = (a, t) => [t * a[0], t * a[1], t * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross =
    (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.sqrt(dot(a, a));
const unit = (a) => scaled(a, 1 / (length(a) || 1));
const row = (array, n) => [array[3 * n], array[3 * n + 1], array[3 * n + 2]];
