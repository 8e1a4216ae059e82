// The organ and what is beside it, drawn in WebGL.
class Picture {
  constructor(gl, surface) {
    Object.assign(this, {gl, surface});
    this.tissue = this.program(tissueVertex, tissueFragment);
    this.solid = this.program(solidVertex, solidFragment);
    const r = surface.radius;
    this.buffers = {
      position: this.buffer(surface.position),
      normal: this.buffer(surface.normal),
      rest: this.buffer(surface.rest),
      colour: this.buffer(surface.colours()),
      index: this.indexBuffer(surface.index)
    };
    this.stylus = this.solidOf(turned(roundedTip(0.045 * r, 0.75 * r)));
    this.finger = this.solidOf(turned(finger(), 28));
    this.shaft = this.solidOf(turned([[0.0001, 0], [1, 0], [1, 1], [0.0001, 1]]));
    this.head = this.solidOf(turned([[0.0001, 0], [1, 0], [0.0001, 1]]));
    this.ball = this.solidOf(turned(Array.from(
        {length: 13},
        (_, n) => [Math.max(1e-4, Math.sin(Math.PI * n / 12)), -Math.cos(Math.PI * n / 12)])));
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.clearColor(0.149, 0.176, 0.2, 1);
  }
  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
        throw new Error('a shader is not taken: ' + gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    const uniforms = {};
    for (let n = 0; n < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++n) {
      const {name} = gl.getActiveUniform(program, n);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    const attributes = {};
    for (let n = 0; n < gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); ++n) {
      const {name} = gl.getActiveAttrib(program, n);
      attributes[name] = gl.getAttribLocation(program, name);
    }
    return {program, uniforms, attributes};
  }
  buffer(values) {
    const gl = this.gl, made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    return made;
  }
  indexBuffer(values) {
    const gl = this.gl, made = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return made;
  }
  solidOf({position, normal, index}) {
    return {
      position: this.buffer(new Float32Array(position)),
      normal: this.buffer(new Float32Array(normal)),
      index: this.indexBuffer(new Uint16Array(index)),
      count: index.length
    };
  }
  feed({attributes}, buffers, sizes) {
    const gl = this.gl;
    for (const name in sizes) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
      gl.enableVertexAttribArray(attributes[name]);
      gl.vertexAttribPointer(attributes[name], sizes[name], gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.index);
  }
  reshaped() {
    const gl = this.gl;
    for (const name of ['position', 'normal']) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.surface[name]);
    }
  }
  drawSolid(solid, matrix, colour, gloss) {
    const gl = this.gl, {uniforms} = this.solid;
    gl.uniformMatrix4fv(uniforms.placed, false, matrix);
    gl.uniform3fv(uniforms.colour, colour);
    gl.uniform1f(uniforms.gloss, gloss);
    this.feed(this.solid, solid, {position: 3, normal: 3});
    gl.drawElements(gl.TRIANGLES, solid.count, gl.UNSIGNED_SHORT, 0);
  }
  // The finger in its true size; it rests on its tip, however it is held.
  drawTool({tip, normal, axis, fingerRadius: r}) {
    const [solid, place] = r > 0 ?
        [this.finger, placed(add(add(tip, normal, r), axis, -r), axis, r, r)] :
        [this.stylus, placed(tip, axis)];
    this.drawSolid(solid, place, [0.72, 0.76, 0.79], 0.8);
  }
  // Nothing hides the force, not the tool either. Dashed where it is uncertain.
  drawForce({tip, force, scale, uncertain}) {
    const {gl, surface} = this, size = length(force);
    if (size < 0.005) return;
    const colour = uncertain ? [1, 0.66, 0.22] : [0.24, 0.56, 1];
    const along = scaled(force, 1 / size), long = scale * size, wide = 0.016 * surface.radius;
    const headLong = Math.min(0.6 * long, 0.11 * surface.radius), shaft = long - headLong;
    const pieces = uncertain ? Math.max(2, Math.floor(shaft / (0.1 * surface.radius))) : 1;
    const piece = shaft / pieces, filled = uncertain ? 0.6 : 1;
    gl.depthRange(0, 0.01);
    for (let n = 0; n < pieces; ++n)
      this.drawSolid(
          this.shaft, placed(add(tip, along, n * piece), along, wide, filled * piece), colour, 0.3);
    this.drawSolid(
        this.head, placed(add(tip, along, shaft), along, 2.4 * wide, headLong), colour, 0.3);
    gl.depthRange(0, 1);
  }
  // mark: what of the organ is shown as touched, {point, radius, pressure}; hand: {tip, normal,
  // axis, fingerRadius (0: a stylus), force, scale, uncertain}; spots: places.
  draw(camera, {mark, hand, spots}) {
    const gl = this.gl, {surface} = this;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const key = unit(add(add(camera.back(), camera.up, 0.9), camera.right, -0.55));
    gl.useProgram(this.tissue.program);
    const {uniforms} = this.tissue;
    gl.uniformMatrix4fv(uniforms.camera, false, camera.matrix);
    gl.uniform3fv(uniforms.view, camera.back());
    gl.uniform3fv(uniforms.key, key);
    gl.uniform3fv(uniforms.pressed, mark ? mark.point : [0, 0, 0]);
    gl.uniform1f(uniforms.ring, mark ? mark.radius : 1);
    gl.uniform1f(uniforms.pressure, mark ? mark.pressure : 0);
    gl.uniform1f(uniforms.showing, mark ? 1 : 0);
    gl.uniform1f(uniforms.thin, 0.006 * surface.radius);
    this.feed(this.tissue, this.buffers, {position: 3, normal: 3, rest: 3, colour: 3});
    gl.drawElements(gl.TRIANGLES, surface.index.length, gl.UNSIGNED_SHORT, 0);
    gl.useProgram(this.solid.program);
    gl.uniformMatrix4fv(this.solid.uniforms.camera, false, camera.matrix);
    gl.uniform3fv(this.solid.uniforms.eye, camera.eye);
    gl.uniform3fv(this.solid.uniforms.key, key);
    for (const spot of spots)
      this.drawSolid(
          this.ball, placed(spot, [0, 0, 1], 0.035 * surface.radius, 0.035 * surface.radius),
          [1, 0.72, 0.36], 0.4);
    if (!hand) return;
    this.drawTool(hand);
    this.drawForce(hand);
  }
}
