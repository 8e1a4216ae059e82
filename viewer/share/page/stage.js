// The part of the window where the organ is: where words and numbers leave room. In a large window they lie beside it.
function stageIn(whole) {
  const words = byId('words').getBoundingClientRect(), numbers = byId('numbers').getBoundingClientRect();
  const below = {left: 0, top: words.bottom, width: whole.width, height: numbers.top - words.bottom};
  if (numbers.width > 0.8 * whole.width) return below;
  const beside = {left: 0, top: words.bottom, width: numbers.left, height: whole.height - words.bottom};
  if (numbers.height > 0.5 * whole.height) return beside;
  return {left: 0, top: 0, width: whole.width, height: whole.height};
}

// Of the canvas, for each of the page: two at most, and no more in all than a large screen has. A processor that draws
// by itself has time for few: then the organ is less sharp in a huge window, but moves.
function pixelsFor(whole) {
  const most = palpate.onCard ? 5120 * 2880 : 1920 * 1200;
  return Math.min(2, devicePixelRatio || 1, Math.sqrt(most / whole.width / whole.height));
}
