// Bodies in space by the triangles of their faces: turned, moved, zoomed, and picked face by face.
"use strict";

castx.FaceView = class {
  static COLOURS = [[202, 206, 212], [178, 199, 217], [214, 200, 176], [190, 208, 186], [208, 190, 205], [196, 196, 178]];
  static NAMED = [122, 174, 214];
  static FOUND = [238, 151, 46];
  static PICKED = [214, 84, 24];
  static DARK = [0.25, 0.27, 0.31];

  constructor(canvas, onPick, maps) {
    this.canvas = canvas;
    this.palette = [...castx.FaceView.COLOURS, castx.FaceView.NAMED, castx.FaceView.FOUND, castx.FaceView.PICKED];
    this.painter = new castx.Painter(canvas, maps ?? { faces: this.palette });
    this.triangles = this.painter.batch();
    this.edges = this.painter.batch();
    this.hidden = new Set();
    this.mesh = false;
    this.colour = () => 0;
    this.shown = () => true;
    this.counts = [];
    this.listen(onPick);
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // points: 9 numbers for each triangle; counts: triangles of each face, which lie behind each other.
  load(points, counts, keep, flat = false) {
    this.points = points;
    this.counts = counts;
    this.outlines = castx.FaceView.outlines(points, counts);
    this.flat = flat;
    this.fit(keep);
  }

  // Let what is shown fill the view; keep: from where it is seen, or else from the usual side.
  fit(keep) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    let at = 0;
    this.counts.forEach((count, face) => {
      for (let i = 9 * at; this.shown(face) && i < 9 * (at + count); i++) {
        low[i % 3] = Math.min(low[i % 3], this.points[i]);
        high[i % 3] = Math.max(high[i % 3], this.points[i]);
      }
      at += count;
    });
    if (low[0] > high[0]) return; // nothing is shown
    const before = keep ? this.camera : undefined;
    this.camera = new castx.Camera(low, high, !this.flat, this.flat ? [0, 0, 1] : [1, -1.4, 0.9]);
    if (before) Object.assign(this.camera, { yaw: before.yaw, pitch: before.pitch, zoom: before.zoom });
  }

  // Sides of triangles that one face has once: its outline.
  static outlines(points, counts) {
    const found = [];
    let at = 0;
    for (const count of counts) {
      const sides = new Map();
      for (let t = at; t < at + count; t++) {
        const keys = [0, 1, 2].map((k) => `${points[9 * t + 3 * k]},${points[9 * t + 3 * k + 1]},${points[9 * t + 3 * k + 2]}`);
        for (let k = 0; k < 3; k++) {
          const [one, other] = [keys[k], keys[(k + 1) % 3]], key = one < other ? `${one} ${other}` : `${other} ${one}`;
          sides.set(key, sides.has(key) ? null : [9 * t + 3 * k, 9 * t + 3 * ((k + 1) % 3)]);
        }
      }
      found.push([...sides.values()].filter((side) => side !== null));
      at += count;
    }
    return found;
  }

  // Fill anew what is drawn: face after face in its colour.
  refresh() {
    if (!this.points) return;
    const positions = [], values = [], lines = [];
    this.faceOf = [];
    let at = 0;
    this.counts.forEach((count, face) => {
      if (this.shown(face)) {
        const value = this.colour(face) + 0.5;
        for (let i = 9 * at; i < 9 * (at + count); i++) positions.push(this.points[i]);
        for (let i = 0; i < 3 * count; i++) values.push(value);
        for (let t = 0; t < count; t++) this.faceOf.push(face);
        const sides = this.mesh ? this.sides(at, count) : this.outlines[face];
        for (const side of sides) for (const end of side) lines.push(this.points[end], this.points[end + 1], this.points[end + 2]);
      }
      at += count;
    });
    this.positions = positions;
    this.painter.fill(this.triangles, Float32Array.from(positions), Float32Array.from(values));
    this.painter.fill(this.edges, Float32Array.from(lines), new Float32Array(lines.length / 3));
    this.draw();
  }

  sides(at, count) {
    const found = [];
    for (let t = at; t < at + count; t++) for (let k = 0; k < 3; k++) found.push([9 * t + 3 * k, 9 * t + 3 * ((k + 1) % 3)]);
    return found;
  }

  draw() {
    if (!this.camera || !this.canvas.clientHeight) return;
    const { camera, turn } = this.camera.matrices(this.canvas.clientWidth / this.canvas.clientHeight);
    this.matrix = camera;
    this.painter.begin(camera, turn);
    this.paint();
  }

  paint() {
    this.painter.triangles(this.triangles, "faces", [0, this.palette.length]);
    this.painter.lines(this.edges, castx.FaceView.DARK);
  }

  // The face under a point of the canvas, x and y from -1 to 1; null: none.
  picked(x, y) {
    const m = this.matrix, p = this.positions ?? [];
    let best = null, depth = Infinity;
    const project = (i) => [0, 1, 2].map((k) => m[k] * p[i] + m[4 + k] * p[i + 1] + m[8 + k] * p[i + 2] + m[12 + k]);
    for (let t = 0; 9 * t < p.length; t++) {
      const [a, b, c] = [project(9 * t), project(9 * t + 3), project(9 * t + 6)];
      const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
      const s = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
      const r = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
      if (!(s >= 0 && r >= 0 && s + r <= 1)) continue;
      const z = a[2] + s * (b[2] - a[2]) + r * (c[2] - a[2]);
      if (z < depth) [best, depth] = [this.faceOf[t], z];
    }
    return best;
  }

  listen(onPick) {
    const { canvas } = this;
    let last = null, moved = 0, shifted = false;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      [moved, shifted] = [0, event.button !== 0 || event.shiftKey];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (last === null || !this.camera) return;
      const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
      last = [event.clientX, event.clientY];
      moved += Math.abs(dx) + Math.abs(dy);
      if (moved < 4) return;
      if (shifted) {
        this.camera.shift[0] += (2 * dx) / canvas.clientWidth;
        this.camera.shift[1] -= (2 * dy) / canvas.clientHeight;
      } else this.camera.turn(dx, dy);
      this.draw();
    });
    canvas.addEventListener("pointerup", (event) => {
      last = null;
      if (moved >= 4 || shifted || !this.matrix) return;
      const box = canvas.getBoundingClientRect();
      onPick(this.picked((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height));
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      if (!this.camera) return;
      event.preventDefault();
      this.zoom(Math.exp(-0.0015 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const turns = { ArrowLeft: [12, 0], ArrowRight: [-12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12] }[event.key];
      if (turns && this.camera) { this.camera.turn(...turns); this.draw(); event.preventDefault(); }
      if (event.key === "+" || event.key === "-") this.zoom(event.key === "+" ? 1.2 : 1 / 1.2);
    });
  }

  zoom(factor) {
    this.camera.zoom *= factor;
    this.draw();
  }
};
