// Draws the organ, the tool and the force in WebGL.

// Colours of the arrow, as in `palpate view`: blue, or amber if the force is uncertain.
const blue = [0.10, 0.42, 0.86], amber = [0.98, 0.67, 0.10];

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
    this.finger = this.solidOf(turned(finger(), 28));
    this.thinRadius = 0.045 * r;
    this.thinTool = this.solidOf(turned(thinTool(this.thinRadius, 0.75 * r)));
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
        throw new Error('a shader cannot be compiled: ' + gl.getShaderInfoLog(shader));
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
  // Draws the tool with its tip at `tip`. A finger has its true size; a tool without a size is
  // thin.
  drawTool({tip, normal, axis, radius}) {
    const middle = add(tip, normal, radius || this.thinRadius);
    if (radius > 0)
      this.drawSolid(this.finger, placed(middle, axis, radius, radius), [0.66, 0.71, 0.76], 0.3);
    else
      this.drawSolid(this.thinTool, placed(middle, axis), [0.72, 0.76, 0.79], 0.8);
  }
  // Draws the arrow of the force in front of everything, including the tool. The arrow is blue, or
  // amber and dashed if the force is uncertain.
  drawArrow({tip, force, scale, isUncertain}) {
    const size = length(force), {radius} = this.surface;
    if (size < 0.005) return;
    const along = scaled(force, 1 / size), long = scale * size, wide = 0.016 * radius;
    const headLong = Math.min(0.6 * long, 0.11 * radius), shaft = long - headLong;
    const pieces = isUncertain ? Math.max(2, Math.floor(shaft / (0.1 * radius))) : 1;
    const filled = isUncertain ? 0.6 : 1, colour = isUncertain ? amber : blue;
    this.gl.depthRange(0, 0.01);
    for (let n = 0; n < pieces; ++n)
      this.drawSolid(
          this.shaft,
          placed(add(tip, along, shaft * n / pieces), along, wide, filled * shaft / pieces), colour,
          0.3);
    this.drawSolid(
        this.head, placed(add(tip, along, shaft), along, 2.4 * wide, headLong), colour, 0.3);
    this.gl.depthRange(0, 1);
  }
  // Draws everything. mark: the touched spot of the organ, {point, radius, pressure}. hand: {tip,
  // normal, axis, radius, force, isUncertain, scale}; radius is 0 if there is no finger. spots:
  // positions of the active nodes.
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
    this.drawArrow(hand);
  }
}
