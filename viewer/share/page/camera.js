// A camera that looks at the organ and keeps it in the middle of a part of the window. A part is
// {left, top, width, height}, in pixels of the page.
class Camera {
  constructor(surface) {
    this.target = surface.center;
    this.distance = 3.1 * surface.radius;
    this.least = 1.3 * surface.radius;
    this.most = 8 * surface.radius;
    const felt = surface.felt.reduce((sum, one) => sum + one, 1);
    let best = -Infinity;
    for (let tilt = -2; tilt <= 3; ++tilt)
      for (let turn = 0; turn < 16; ++turn) {
        this.turn = turn * Math.PI / 8;
        this.tilt = tilt * Math.PI / 10;
        const back = this.back();
        // Prefers a view of the broad side of the organ, with the touchable surface in front.
        let area = 0;
        for (let v = 0; v < surface.count; v += 3)
          area += Math.max(0, dot(back, row(surface.normal, v))) *
              (surface.felt[v] > 0 ? 1 + 0.25 * surface.count / felt : 1);
        if (area > best) {
          best = area;
          this.best = [this.turn, this.tilt];
        }
      }
    [this.turn, this.tilt] = this.best;
  }
  back() {
    return [
      Math.cos(this.tilt) * Math.sin(this.turn), -Math.cos(this.tilt) * Math.cos(this.turn),
      Math.sin(this.tilt)
    ];
  }
  orbit(dx, dy) {
    this.turn -= 0.008 * dx;
    this.tilt = Math.min(1.5, Math.max(-1.5, this.tilt + 0.008 * dy));
  }
  zoom(factor) {
    this.distance = Math.min(this.most, Math.max(this.least, this.distance * factor));
  }
  look(whole, part) {
    const back = this.back(), right = unit(cross([0, 0, 1], back)), up = cross(back, right);
    const away = this.distance * Math.max(1, 1.15 * part.height / part.width);
    const eye = add(this.target, back, away), near = away * 0.05, far = away * 6;
    const view = [
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1
    ];
    // scale: pixels of the page per unit of the tangent of the angle at the eye. middle: pixel of
    // the page in which the target appears.
    const scale = part.height / 2 / Math.tan(0.32);
    const middle = [part.left + part.width / 2, part.top + part.height / 2];
    const aside = [2 * middle[0] / whole.width - 1, 1 - 2 * middle[1] / whole.height];
    const project = [
      2 * scale / whole.width, 0, 0, 0, 0, 2 * scale / whole.height, 0, 0, -aside[0], -aside[1],
      (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0
    ];
    const matrix = new Float32Array(16);
    for (let c = 0; c < 4; ++c)
      for (let r = 0; r < 4; ++r)
        for (let k = 0; k < 4; ++k) matrix[4 * c + r] += project[4 * k + r] * view[4 * c + k];
    Object.assign(this, {eye, right, up, away, scale, middle, matrix});
  }
  // Returns the direction of the view ray through a pixel of the page.
  ray(x, y) {
    const sx = (x - this.middle[0]) / this.scale, sy = (this.middle[1] - y) / this.scale;
    return unit(add(add(scaled(this.back(), -1), this.right, sx), this.up, sy));
  }
  // Returns the length, m, that one pixel of the page covers at the distance of the organ.
  metresPerPixel() { return this.away / this.scale; }
}
