// Returns the part of the window in which the organ is drawn. It is the whole window if the panel
// of numbers leaves most of the middle free. Otherwise it is the part below the words, either
// beside or above the numbers, whichever is larger.
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

// Returns the pixels of the canvas per pixel of the page. It is at most two, and limits the canvas
// to the pixels of a large screen. Without a graphics card the limit is lower, so that the organ
// still moves smoothly in a huge window, although it is less sharp.
function pixelsFor(whole) {
  const most = palpate.onCard ? 5120 * 2880 : 1920 * 1200;
  return Math.min(2, devicePixelRatio || 1, Math.sqrt(most / whole.width / whole.height));
}
