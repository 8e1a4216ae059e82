// Runs the field in a thread of its own, so that preparing it does not delay the picture.
//
// Messages to the worker: {field, organ} once, then questions {touch, triangle, u, v, p, id} and
// {near: {touch, triangle, u, v}}, the place of the pointer. Only the newest question is answered.
// Messages from the worker: {organ} once, then {preparing: id} while the answer to a question is
// prepared, and answers with the id of the question. At any time the worker may instead send the
// reason of a Stop, which stops the page.

let field;         // exports of page_field.cpp
let asked = null;  // the newest question
let near = null;   // last known place of the pointer, prepared ahead
let working = false;
let words = '';  // text that the field wrote to standard error: the reason why it ended
const nextPiece = new MessageChannel();

// Reason to stop the page: {tooOld}, {damaged: how} or {trouble: sentence}.
class Stop {
  constructor(why) { this.why = why; }
}

async function unpacked(text, what) {
  try {
    const packed = await (await fetch('data:application/octet-stream;base64,' + text)).blob();
    const stream = packed.stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch (error) {
    throw new Stop({damaged: `its ${what} cannot be unpacked`});
  }
}

// WASI's fd_write: appends the written text to `words`. pairs: address of `count` pairs of address
// and length.
function write(file, pairs, count, written) {
  const view = new DataView(field.memory.buffer);
  let size = 0;
  for (let n = 0; n < count; ++n) {
    const at = view.getUint32(pairs + 8 * n, true),
          length = view.getUint32(pairs + 8 * n + 4, true);
    words += new TextDecoder().decode(new Uint8Array(field.memory.buffer, at, length));
    size += length;
  }
  view.setUint32(written, size, true);
  return 0;
}

async function open({field: fieldText, organ: organText}) {
  const [fieldBytes, organBytes] =
      await Promise.all([unpacked(fieldText, 'field'), unpacked(organText, 'organ')]);
  if (!WebAssembly.validate(fieldBytes)) throw new Stop({tooOld: true});
  const nothing = () => 0;
  const {instance} = await WebAssembly.instantiate(fieldBytes, {
    env: {emscripten_notify_memory_growth: nothing},
    wasi_snapshot_preview1: {
      proc_exit: () => {
        throw new WebAssembly.RuntimeError('the field ended');
      },
      environ_sizes_get: nothing,
      environ_get: nothing,
      fd_write: write,
      fd_close: nothing,
      fd_seek: nothing,
    },
  });
  field = instance.exports;
  field._initialize();
  const at = field.allocate(organBytes.length);
  new Uint8Array(field.memory.buffer).set(organBytes, at);
  field.openOrgan(at, organBytes.length);
  field.release(at);
  setTimeout(workAhead, 1000);
  const copy = (Type, begin, count) => new Type(field.memory.buffer, begin, count).slice();
  const vertices = field.vertexCount(), triangles = field.triangleCount();
  const corners = copy(Int32Array, field.triangles(), 3 * triangles);
  postMessage({
    organ: {
      vertices: copy(Float64Array, field.vertices(), 3 * vertices),
      triangles: corners,
      touchOfTriangle: copy(Int32Array, field.touchOfTriangle(), triangles),
      touches: Array.from(
          {length: field.touchCount()},
          (_, n) => {
            const [fingerRadius, radius, x, y, z] = copy(Float64Array, field.touchNumbers(n), 5);
            return {fingerRadius, radius, rest: [x, y, z]};
          }),
    }
  });
}

function answer({touch, triangle, u, v, p, id}) {
  const numbers =
      new Float64Array(field.memory.buffer, field.evaluate(touch, triangle, u, v, ...p), 10);
  const [fx, fy, fz, bound, energy, coverage, inside, x, y, z] = numbers;
  const at = field.shapeAt(touch, triangle, u, v, ...p);
  const shape = new Float32Array(field.memory.buffer, at, 3 * field.vertexCount()).slice();
  postMessage(
      {
        id,
        touch,
        triangle,
        u,
        v,
        p,
        s: [x, y, z],
        force: [fx, fy, fz],
        bound,
        energy,
        coverage,
        inside: inside === 1,
        shape
      },
      [shape.buffer]);
}

// Does one step of work. Returns whether there may be more work.
function work() {
  if (asked) {
    if (field.prepare(asked.touch, asked.triangle, asked.u, asked.v)) {
      postMessage({preparing: asked.id});
      return true;
    }
    const question = asked;
    asked = null;
    answer(question);
    return true;
  }
  return near !== null && field.prepare(near.touch, near.triangle, near.u, near.v) === 1;
}

// Prepares places that may be touched later. Pauses a quarter of a second after each step, because
// the same processor may have to draw.
function workAhead() {
  if (near && !working && !field.prepareAhead(near.touch, near.triangle, near.u, near.v)) return;
  setTimeout(workAhead, 250);
}

function tell(error) {
  working = false;
  asked = near = null;
  if (error instanceof Stop)
    postMessage(error.why);
  else if (words)
    postMessage({trouble: words});
  else if (error instanceof WebAssembly.RuntimeError)
    postMessage({damaged: error.message});
  else
    postMessage(
        {trouble: `the computation of forces stopped (${error.message}): reload the page`});
}

nextPiece.port1.onmessage = () => {
  try {
    working = work();
  } catch (error) {
    return tell(error);
  }
  if (working) nextPiece.port2.postMessage(null);
};

onmessage = ({data}) => {
  if (data.field) return void open(data).catch(tell);
  if (data.near)
    near = data.near;
  else
    near = asked = data;
  if (!working && field) {
    working = true;
    nextPiece.port2.postMessage(null);
  }
};
