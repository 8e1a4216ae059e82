// The page: a hand presses, the field answers, and the picture shows the result.
class Page {
  constructor(surface, touches, gl, worker) {
    const reach = Math.max(...touches.map((touch) => touch.radius));
    Object.assign(this, {
      surface,
      touches,
      gl,
      worker,
      reach,
      step: reach / byId('depth').max,  // slider step, m; 0.5 mm if the hand can press 30 mm
      canvas: gl.canvas,
      camera: new Camera(surface),
      hand: new Hand(reach),
      picture: new Picture(gl, surface),
      plot: new ForcePlot(byId('plot')),
      words: new Words(touches, reach),
      spots: touches.filter((touch) => touch.fingerRadius === 0).map((touch) => touch.rest),
      answer: null,
      felt: null,
      waiting: 0,
      asked: 0,
      changed: true,
      last: 0,
      frames: 0,
      shown: 0
    });
    this.fit();
    this.look();
    this.gestures = new Gestures(this);
    this.pointers = this.gestures.pointers;
    const slider = byId('depth');
    this.setDepth(this.hand.wanted);
    slider.addEventListener('input', () => this.setDepth(slider.value * this.step));
    requestAnimationFrame((time) => this.frame(time));
  }
  setDepth(depth) {
    this.hand.wanted = Math.min(this.reach, Math.max(this.step, depth));
    const slider = byId('depth'), text = this.words.millimetres(this.hand.wanted);
    slider.value = this.hand.wanted / this.step;
    slider.setAttribute('aria-valuetext', text);
    byId('depth-shown').textContent = text;
  }
  hit(x, y) { return this.surface.hit(this.camera.eye, this.camera.ray(x, y)); }
  // Tells the field that this place may be touched soon.
  prepare({touch, triangle, u, v}) { this.worker.postMessage({near: {touch, triangle, u, v}}); }

  // Returns the question to the field for the current hand.
  question() {
    const {hand, touches} = this, {touch, triangle, u, v} = hand.place;
    return {touch, triangle, u, v, p: hand.displacement(touches[touch].radius)};
  }
  // Returns whether the last answer belongs to this question.
  isAnswered({triangle, u, v, p}) {
    const {answer} = this;
    return answer && answer.triangle === triangle && answer.u === u && answer.v === v &&
        answer.p.every((x, i) => x === p[i]);
  }
  // Asks the field about the current hand, unless the field has not answered the last question yet.
  ask() {
    if (!this.hand.place || this.waiting) return;
    const question = this.question(), {seen, normal} = this.hand.place;
    if (this.isAnswered(question)) return;
    this.waiting = ++this.asked;
    Object.assign(this, {seen, normal});
    this.worker.postMessage({...question, id: this.waiting});
  }
  heard(answer) {
    this.waiting = 0;
    if (!this.hand.place) return;
    this.answer = answer;
    this.felt = {...answer, shape: null, seen: this.seen, normal: this.normal};
    const reach = 0.8 * (this.touches[answer.touch].fingerRadius || 0.15 * this.surface.radius);
    this.surface.deform(answer.shape, this.seen, answer.p, reach);
    this.reshaped();
  }
  letGo() {
    this.answer = this.felt = null;
    this.surface.deform(new Float32Array(this.surface.coarse.length), null);
    this.reshaped();
  }
  reshaped() {
    this.picture.reshaped();
    this.changed = true;
    palpate.touched = this.felt;
  }
  // Handles the return of the graphics context, which has lost all its data.
  restored() {
    this.picture = new Picture(this.gl, this.surface);
    this.changed = true;
  }

  scene() {
    const {felt} = this, {over} = this.gestures, spots = felt ? [] : this.spots;
    const radiusOf = ({touch}) => this.touches[touch].fingerRadius || 0.1 * this.surface.radius;
    if (!felt) {
      const mark = over && {point: over.seen.point, radius: radiusOf(over), pressure: 0};
      return {mark, spots, hand: null};
    }
    const axis = unit(add(add(felt.normal, this.camera.right, 0.75), this.camera.up, 0.35));
    return {
      mark: {
        point: felt.seen.point,
        radius: radiusOf(felt),
        pressure: Math.min(1, length(felt.force) / 2)
      },
      spots,
      hand: {
        tip: add(felt.seen.point, felt.p),
        normal: felt.normal,
        axis,
        radius: this.touches[felt.touch].fingerRadius,
        force: felt.force,
        isUncertain: isUncertain(felt),
        scale: 0.7 * this.surface.radius / facts.maxForce
      }
    };
  }
  // Adapts to the size of the window.
  fit() {
    const {canvas} = this, whole = {width: canvas.clientWidth, height: canvas.clientHeight};
    const ratio = pixelsFor(whole), width = Math.round(whole.width * ratio);
    const isFitted = this.whole && this.whole.width === whole.width &&
        this.whole.height === whole.height && canvas.width === width;
    if (isFitted) return;
    Object.assign(canvas, {width, height: Math.round(whole.height * ratio)});
    this.whole = whole;
    this.stage = stageIn(whole);
    this.plot.fit();
    this.changed = true;
  }
  look() { this.camera.look(this.whole, this.stage); }
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
    this.fit();
    if (this.changed) {
      this.look();
      this.picture.draw(this.camera, this.scene());
      this.changed = false;
      if (++this.frames === 1) this.started();
    }
    const force = this.felt ? length(this.felt.force) : 0;
    const bound = this.felt && Number.isFinite(this.felt.bound) ? this.felt.bound : 0;
    this.plot.add(time / 1000, force, bound);
    if (time - this.shown > 45) {  // faster changes cannot be read
      this.shown = time;
      this.words.show(this.felt);
      this.plot.draw(time / 1000);
    }
    this.canvas.classList.toggle('pressing', this.hand.held);
    requestAnimationFrame((next) => this.frame(next));
  }
  started() {
    document.body.dataset.state = 'ready';
    palpate.ready = performance.now();
  }
}
