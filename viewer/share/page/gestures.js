// Mouse and finger gestures on the canvas. One pointer presses the organ if it starts on the organ,
// and turns the organ if it starts beside it. Two pointers turn and zoom.
class Gestures {
  constructor(page) {
    Object.assign(this, {page, pointers: new Map(), over: null});
    const {canvas} = page;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'])
      canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener('pointerleave', () => this.leave());
    canvas.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }
  down(event) {
    const {page} = this;
    page.canvas.setPointerCapture(event.pointerId);
    const pointer = {x: event.clientX, y: event.clientY, presses: false};
    this.pointers.set(event.pointerId, pointer);
    if (this.pointers.size > 1) return this.stopPressing();
    const hit = page.hit(event.clientX, event.clientY);
    if (!hit) return;
    if (hit.touch < 0) return page.words.untouchable();
    pointer.presses = true;
    page.hand.begin(hit);
    page.words.pressed(event.pointerType === 'mouse');
  }
  move(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return this.hover(event);
    const dx = event.clientX - pointer.x, dy = event.clientY - pointer.y;
    if (pointer.presses)
      this.slide(event, dx, dy);
    else if (this.pointers.size <= 2)
      this.look(event, dx, dy);
    Object.assign(pointer, {x: event.clientX, y: event.clientY});
  }
  // Moves the finger along the surface that it touches, or pulls an active node sideways.
  slide(event, dx, dy) {
    const {hand, camera, touches} = this.page;
    if (touches[hand.place.touch].fingerRadius > 0) {
      const hit = this.page.hit(event.clientX, event.clientY);
      if (hit && hit.touch === hand.place.touch) hand.place = hit;
      return;
    }
    const metres = camera.metresPerPixel();
    hand.sideways = add(add(hand.sideways, camera.right, dx * metres), camera.up, -dy * metres);
  }
  // Turns and zooms the view. With two pointers, the view turns with their midpoint, which each
  // pointer moves by half of its own motion.
  look(event, dx, dy) {
    const {camera} = this.page, count = this.pointers.size;
    camera.orbit(dx / count, dy / count);
    if (count === 2) {
      const [a, b] = [...this.pointers.values()];
      const before = Math.hypot(a.x - b.x, a.y - b.y) || 1;
      const other = this.pointers.get(event.pointerId) === a ? b : a;
      camera.zoom(before / (Math.hypot(event.clientX - other.x, event.clientY - other.y) || 1));
    }
    this.page.changed = true;
  }
  hover(event) {
    const {page} = this, hit = page.hit(event.clientX, event.clientY);
    this.over = hit && hit.touch >= 0 ? hit : null;
    page.canvas.classList.toggle('over', this.over !== null);
    page.changed = true;
    if (this.over) page.prepare(hit);
  }
  // Handles a pointer that leaves the canvas. A pointer that presses continues to press.
  leave() {
    this.over = null;
    this.page.canvas.classList.remove('over');
    this.page.changed = true;
  }
  up(event) {
    const pointer = this.pointers.get(event.pointerId);
    this.pointers.delete(event.pointerId);
    if (pointer && pointer.presses) this.stopPressing();
  }
  stopPressing() {
    for (const pointer of this.pointers.values()) pointer.presses = false;
    this.page.hand.letGo();
    this.page.words.rest();
  }
  wheel(event) {
    event.preventDefault();
    const {page} = this, notches = event.deltaY / (event.deltaMode === 0 ? 100 : 3);
    if (page.hand.held || this.over)
      return page.setDepth(page.hand.wanted - 2 * page.step * notches);
    page.camera.zoom(Math.exp(0.12 * notches));
    page.changed = true;
  }
}
