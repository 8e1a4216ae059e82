// Returns the part of the window in which the organ is drawn. It is the whole window if the numbers
// leave most of the middle free. Otherwise it is the larger of the parts beside and above the
// numbers, below the words.
function stageIn(whole) {
  const top = byId('words').getBoundingClientRect().bottom;
  const numbers = byId('numbers').getBoundingClientRect();
  const above = {left: 0, top, width: whole.width, height: numbers.top - top};
  if (numbers.width > 0.8 * whole.width) return above;
  const free = Math.hypot(
      Math.max(0, numbers.left - whole.width / 2), Math.max(0, numbers.top - whole.height / 2));
  if (free > 0.35 * Math.min(whole.width, whole.height)) return {left: 0, top: 0, ...whole};
  const beside = {left: 0, top, width: numbers.left, height: whole.height - top};
  const sizeOf = (part) => Math.min(part.width, part.height);
  return sizeOf(above) > sizeOf(beside) ? above : beside;
}

// Returns the pixels of the canvas per pixel of the page: at most two, and in total no more than a
// large screen has. A processor that draws by itself has time for fewer. The organ is then less
// sharp in a huge window, but moves.
function pixelsFor(whole) {
  const most = palpate.onCard ? 5120 * 2880 : 1920 * 1200;
  return Math.min(2, devicePixelRatio || 1, Math.sqrt(most / whole.width / whole.height));
}
