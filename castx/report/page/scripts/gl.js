// Drawing of triangles and lines by WebGL 2: colours by value from a row of a texture, weak light from the eye.
"use strict";

castx.Painter = class {
  static VERTEX = `#version 300 es
    in vec3 position; in float value; uniform mat4 camera; uniform mat3 turn; uniform vec2 limits; uniform float nearer; out vec3 place;
    out float share; out float known;
    void main() {
      gl_Position = camera * vec4(position, 1.0) - vec4(0.0, 0.0, nearer, 0.0);
      place = turn * position;
      known = value < 3e38 ? 1.0 : 0.0;
      share = known > 0.5 ? (value - limits.x) / max(limits.y - limits.x, 1e-30) : 0.0;
    }`;
  static FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 place; in float share; in float known; uniform sampler2D colours; uniform float row; uniform vec4 plain;
    out vec4 colour;
    void main() {
      if (plain.a > 0.5) { colour = vec4(plain.rgb, 1.0); return; }
      vec3 n = normalize(cross(dFdx(place), dFdy(place)));
      float light = 0.72 + 0.28 * abs(n.z);
      vec3 base = known > 0.99 && row >= 0.0 ? texture(colours, vec2(clamp(share, 0.004, 0.996), row)).rgb
                                            : vec3(0.79, 0.80, 0.82);
      colour = vec4(base * light, 1.0);
    }`;

  // Throws where there is no WebGL 2.
  constructor(canvas, maps) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (gl === null) throw new Error("no WebGL 2");
    this.gl = gl;
    this.canvas = canvas;
    this.program = this.link();
    this.at = Object.fromEntries(["camera", "turn", "limits", "row", "plain", "nearer"].map(
      (name) => [name, gl.getUniformLocation(this.program, name)]));
    this.rows = Object.keys(maps);
    this.load(Object.values(maps));
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(1, 1, 1, 1);
  }

  link() {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, castx.Painter.VERTEX], [gl.FRAGMENT_SHADER, castx.Painter.FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "position");
    gl.bindAttribLocation(program, 1, "value");
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    return program;
  }

  load(maps) {
    const gl = this.gl, texels = Uint8Array.from(maps.flat(2));
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, maps[0].length, maps.length, 0, gl.RGB, gl.UNSIGNED_BYTE, texels);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  }

  // What is drawn: {positions, values} kept on the card until it is filled anew.
  batch() {
    const gl = this.gl;
    return { positions: gl.createBuffer(), values: gl.createBuffer(), count: 0 };
  }

  fill(batch, positions, values) {
    const gl = this.gl;
    batch.count = positions.length / 3;
    for (const [buffer, content] of [[batch.positions, positions], [batch.values, values]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, content, gl.DYNAMIC_DRAW);
    }
  }

  begin(camera, turn) {
    const gl = this.gl, scale = window.devicePixelRatio || 1;
    const width = Math.round(this.canvas.clientWidth * scale), height = Math.round(this.canvas.clientHeight * scale);
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.at.camera, false, camera);
    gl.uniformMatrix3fv(this.at.turn, false, turn);
  }

  // Triangles in the colours of a map between limits; grey without a map.
  triangles(batch, map, limits) {
    this.gl.uniform4f(this.at.plain, 0, 0, 0, 0);
    this.gl.uniform1f(this.at.nearer, 0);
    this.gl.uniform1f(this.at.row, map === null ? -1 : (this.rows.indexOf(map) + 0.5) / this.rows.length);
    this.gl.uniform2f(this.at.limits, ...limits);
    this.draw(batch, this.gl.TRIANGLES);
  }

  lines(batch, colour) {
    this.gl.uniform4f(this.at.plain, ...colour, 1);
    this.gl.uniform1f(this.at.nearer, 0.001); // than the faces on which they lie
    this.draw(batch, this.gl.LINES);
  }

  draw(batch, kind) {
    const gl = this.gl;
    if (batch.count === 0) return;
    [batch.positions, batch.values].forEach((buffer, place) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, place === 0 ? 3 : 1, gl.FLOAT, false, 0, 0);
    });
    gl.drawArrays(kind, 0, batch.count);
  }
};
