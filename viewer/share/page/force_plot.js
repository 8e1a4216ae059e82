// The force of the last seconds, with its error band.
class ForcePlot {
  constructor(canvas) {
    Object.assign(this, {canvas, pen: canvas.getContext('2d'), seconds: 8, samples: []});
  }
  add(time, force, bound) {
    this.samples.push({time, force, bound});
    while (this.samples.length > 2 && this.samples[1].time < time - this.seconds)
      this.samples.shift();
  }
  // Adapts to the size of the window.
  fit() {
    const {canvas} = this;
    this.ratio = Math.min(2, devicePixelRatio || 1);
    Object.assign(this, {width: canvas.clientWidth, height: canvas.clientHeight});
    canvas.width = Math.round(this.width * this.ratio);
    canvas.height = Math.round(this.height * this.ratio);
    this.letters = 0.75 * parseFloat(getComputedStyle(canvas).fontSize);
    this.isDrawn = false;
  }
  // A curve without force does not change, so it is drawn only once.
  draw(now) {
    const {pen, samples, ratio, width, height, letters} = this;
    const isFlat = samples.every((s) => s.force === 0);
    if (isFlat && this.isDrawn) return;
    this.isDrawn = isFlat;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const left = 3 * letters, base = height - 1.5 * letters;
    const most = samples.reduce((top, s) => Math.max(top, s.force + s.bound), 0.4);
    const lines =
        Math.min(4, Math.floor(base / (1.5 * letters)));  // as many as leave room for numbers
    const step =
        [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((size) => most / size <= lines) || most / lines;
    const top = Math.ceil(most / step) * step;
    const x = (time) => width - 4 - (width - left - 4) * (now - time) / this.seconds;
    const y = (force) => base - (base - 0.7 * letters) * force / top;
    pen.font = `${letters}px system-ui,sans-serif`;
    pen.textAlign = 'right';
    for (let force = 0; force <= top + 1e-9; force += step) {
      pen.fillStyle = '#ffffff22';
      pen.fillRect(left, y(force), width - left - 4, 1);
      pen.fillStyle = '#b4bcc2';
      pen.fillText(force.toFixed(step < 1 ? 1 : 0), left - 6, y(force) + 0.36 * letters);
    }
    pen.fillText('now', width - 4, height - 0.27 * letters);
    pen.textAlign = 'left';
    pen.fillText(`${this.seconds} s ago`, left, height - 0.27 * letters);
    pen.fillText('N', left + 4, 1.1 * letters);
    if (samples.length < 2) return;
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, width - left, height);
    pen.clip();
    pen.beginPath();
    samples.forEach((s) => pen.lineTo(x(s.time), y(s.force + s.bound)));
    for (let n = samples.length; n-- > 0;)
      pen.lineTo(x(samples[n].time), y(Math.max(0, samples[n].force - samples[n].bound)));
    pen.fillStyle = '#b4bcc266';
    pen.fill();
    pen.beginPath();
    samples.forEach((s) => pen.lineTo(x(s.time), y(s.force)));
    pen.strokeStyle = '#fff';
    pen.lineWidth = 1.6;
    pen.stroke();
    pen.restore();
  }
}
