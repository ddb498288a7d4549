// The view of the bodies: what is shown of them, drawn when something changes.
"use strict";

castx.View = class {
  static NOTHING = 3.3e38; // stands for values that are no numbers; see gl.js
  static DARK = [0.19, 0.2, 0.23];
  static FRONT = [0, 0.63, 1];
  static OPENED = 1.5 * Math.PI;
  static SWEPT = 30;

  constructor(scene, canvas) {
    this.scene = scene;
    this.space = scene.model === "3d";
    this.turned = scene.model === "axisymmetric";
    this.painter = new castx.Painter(canvas, scene.colours);
    this.canvas = canvas;
    this.cache = new Map();
    this.shown = new Set(Object.keys(scene.bodies));
    this.state = { field: scene.fields[0]?.name ?? "", moment: castx.View.first(scene), factor: 0, revolved: false,
      mesh: false, thisMoment: false, plane: null };
  }

  // A moment of freezing if there is one, else the last.
  static first({ moments }) {
    const half = moments.findIndex((text) => text.includes("50 % solid"));
    return half < 0 ? moments.length - 1 : half;
  }

  async load() {
    this.bodies = [];
    for (const [name, body] of Object.entries(this.scene.bodies)) {
      const points = await castx.unpacked(body.points), cells = await castx.unpacked(body.cells);
      const inner = body.inner === null ? null : await castx.unpacked(body.inner);
      const found = { name, kind: body.kind, points, cells, inner, there: body.there, batch: this.painter.batch(),
        lines: this.painter.batch(), front: this.painter.batch() };
      found.shape = castx.geometry.shape(found);
      if (this.turned) found.shape.edges = found.shape.edges.filter(([i, j]) => points[3 * i] !== 0 || points[3 * j] !== 0);
      const moved = this.scene.displacements[name];
      found.displacement = moved === undefined ? null : await castx.unpacked(moved);
      this.bodies.push(found);
    }
    const { low, high } = this.box();
    this.camera = new castx.Camera(low, high, this.space, this.scene.direction ?? [0, 0, 1]);
  }

  box() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const { points } of this.bodies) {
      points.forEach((x, i) => {
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
      });
    }
    if (this.turned) [low[0], low[2], high[2]] = [-high[0], -high[0], high[0]];
    return { low, high };
  }

  field() {
    return this.scene.fields.find((found) => found.name === this.state.field);
  }

  // Values of a field of a body at the moment, null if there are none.
  async values(field, body) {
    const found = field?.bodies[body.name];
    if (found === undefined) return null;
    const key = `${field.name} ${body.name}`;
    if (!this.cache.has(key)) this.cache.set(key, castx.unpacked(found.values));
    const series = await this.cache.get(key);
    return series[field.final ? series.length - 1 : this.state.moment];
  }

  // How far the metal of a body has sunk at the moment; null: not at all, or the field shows what has flowed out.
  async sunk(body) {
    const level = this.scene.pipes.levels[body.name]?.[this.state.moment] ?? null, { field } = this.scene.pipes;
    if (level === null || this.state.field === field) return null;
    const values = await this.values(this.scene.fields.find((found) => found.name === field), body);
    return values === null ? null : { values, level };
  }

  // Whether bodies have sunk otherwise than they are built.
  get stale() {
    return this.built !== undefined && this.built !== this.shape();
  }

  shape() {
    const { levels, field } = this.scene.pipes;
    return JSON.stringify([this.state.field === field, Object.values(levels).map((found) => found[this.state.moment])]);
  }

  // Find anew what a cut and pipes leave of the bodies.
  async rebuild() {
    this.built = this.shape();
    for (const body of this.bodies) {
      const { triangles, segments, nodes } = castx.geometry.drawn(body, this.state.plane, await this.sunk(body));
      body.nodes = nodes;
      body.places = nodes.values(body.points, 3);
      const lines = this.state.mesh ? castx.View.sides(triangles) : segments;
      body.soup = this.copied(triangles, segments);
      body.edges = this.copied(lines, null);
    }
  }

  // All sides of triangles as segments.
  static sides(triangles) {
    const found = { a: [], b: [], t: [], cell: [], length: 2 * triangles.length };
    for (let i = 0; i < triangles.length; i++) {
      for (const k of [i, i % 3 === 2 ? i - 2 : i + 1]) {
        for (const key of ["a", "b", "t", "cell"]) found[key].push(triangles[key][k]);
      }
    }
    return found;
  }

  // Vertices with the turns about the axis at which they are drawn; swept: segments that become surfaces.
  copied(vertices, swept) {
    const count = vertices.length, turns = !this.turned ? [0] : [0, this.state.revolved ? castx.View.OPENED : Math.PI];
    const index = [], angle = [];
    for (const turn of turns) {
      for (let i = 0; i < count; i++) { index.push(i); angle.push(turn); }
    }
    const base = { ...vertices, length: count };
    if (this.turned && this.state.revolved && swept !== null) {
      for (const key of ["a", "b", "t", "cell"]) base[key] = vertices[key].concat(swept[key]);
      this.sweep(index, angle, count, swept.length);
    }
    return { ...base, index, angle };
  }

  sweep(index, angle, first, count) {
    const step = castx.View.OPENED / castx.View.SWEPT;
    for (let i = first; i < first + count; i += 2) {
      for (let k = 0; k < castx.View.SWEPT; k++) {
        const [now, next] = [k * step, (k + 1) * step];
        for (const [vertex, turn] of [[i, now], [i + 1, now], [i + 1, next], [i, now], [i + 1, next], [i, next]]) {
          index.push(vertex);
          angle.push(turn);
        }
      }
    }
  }

  // Positions and values of what is drawn of a body.
  placed(soup, body, values, inCells) {
    const { a, b, t, cell, index, angle } = soup, count = index.length;
    const positions = new Float32Array(3 * count), found = new Float32Array(count);
    const factor = this.state.factor, displacement = factor === 0 ? undefined : body.displacement?.[this.state.moment];
    const moved = displacement === undefined ? null : body.nodes.values(displacement, 3);
    for (let i = 0; i < count; i++) {
      const v = index[i], p = 3 * a[v], q = 3 * b[v], share = t[v];
      const at = [0, 0, 0];
      for (let k = 0; k < 3; k++) {
        at[k] = body.places[p + k] + share * (body.places[q + k] - body.places[p + k]);
        if (moved !== null) at[k] += factor * (moved[p + k] + share * (moved[q + k] - moved[p + k]));
      }
      positions[3 * i] = angle[i] === 0 ? at[0] : at[0] * Math.cos(angle[i]);
      positions[3 * i + 1] = at[1];
      positions[3 * i + 2] = angle[i] === 0 ? at[2] : at[0] * Math.sin(angle[i]);
      const value = values === null ? NaN
        : inCells ? values[cell[v]] : share === 0 ? values[a[v]] : values[a[v]] + share * (values[b[v]] - values[a[v]]);
      found[i] = Number.isNaN(value) ? castx.View.NOTHING : value;
    }
    return { positions, values: found };
  }

  // Fill what is drawn with the field and the displacements of the moment.
  async refresh() {
    const field = this.field(), front = this.scene.fields.find((found) => found.name === "solid_fraction");
    for (const body of this.bodies) {
      const inCells = field?.bodies[body.name]?.in_cells ?? false;
      body.now = await this.values(field, body);
      const values = body.now === null || inCells ? body.now : body.nodes.values(body.now, 1);
      body.placed = this.placed(body.soup, body, values, inCells);
      this.painter.fill(body.batch, body.placed.positions, body.placed.values);
      const edges = this.placed(body.edges, body, null, false);
      this.painter.fill(body.lines, edges.positions, edges.values);
      const solid = field?.front ? await this.values(front, body) : null;
      const line = solid === null ? new Float32Array(0) : this.contour(body, solid, 0.5);
      this.painter.fill(body.front, line, new Float32Array(line.length / 3));
    }
    this.draw();
  }

  // Segments on which a nodal field has a level.
  contour(body, nodal, level) {
    const { values } = this.placed(body.soup, body, body.nodes.values(nodal, 1), false), at = body.placed.positions, found = [];
    for (let i = 0; i < values.length; i += 3) {
      const ends = [];
      for (const [j, k] of [[i, i + 1], [i + 1, i + 2], [i + 2, i]]) {
        const share = (level - values[j]) / (values[k] - values[j]);
        if (values[j] < level !== values[k] < level) {
          for (let c = 0; c < 3; c++) ends.push(at[3 * j + c] + share * (at[3 * k + c] - at[3 * j + c]));
        }
      }
      if (ends.length === 6) found.push(...ends);
    }
    return Float32Array.from(found);
  }

  visible() {
    return this.bodies.filter((body) => this.shown.has(body.name) && body.there[this.state.moment]);
  }

  // Colour scales of what is seen: castings have one, the bodies around them another.
  scales() {
    const field = this.field(), found = new Map();
    for (const body of this.visible()) {
      const own = field?.bodies[body.name];
      if (own === undefined || body.now === null) continue;
      const limits = this.state.thisMoment ? castx.View.range(body.now) : own.limits;
      if (limits === null) continue;
      const casting = this.scene.freezing.includes(body.name);
      const key = casting ? "castings" : "others";
      const scale = found.get(key) ?? { map: own.colours, limits: [Infinity, -Infinity], names: [] };
      scale.limits = [Math.min(scale.limits[0], limits[0]), Math.max(scale.limits[1], limits[1])];
      scale.names.push(body.name);
      found.set(key, scale);
    }
    return [...found.values()];
  }

  static range(values) {
    let low = Infinity, high = -Infinity;
    for (const x of values) if (!Number.isNaN(x)) { low = Math.min(low, x); high = Math.max(high, x); }
    return low <= high ? [low, high] : null;
  }

  draw() {
    const aspect = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    const { camera, turn } = this.camera.matrices(aspect);
    this.matrix = camera;
    this.painter.begin(camera, turn);
    const scales = this.scales();
    for (const body of this.visible()) {
      const scale = scales.find((found) => found.names.includes(body.name));
      this.painter.triangles(body.batch, scale?.map ?? null, scale?.limits ?? [0, 1]);
      this.painter.lines(body.lines, castx.View.DARK);
      this.painter.lines(body.front, castx.View.FRONT);
    }
  }

  // What lies under a point of the canvas, x and y from -1 to 1: body, value and place; null: nothing.
  picked(x, y) {
    let best = null;
    const m = this.matrix, project = (p, i) => [
      m[0] * p[i] + m[4] * p[i + 1] + m[8] * p[i + 2] + m[12], m[1] * p[i] + m[5] * p[i + 1] + m[9] * p[i + 2] + m[13],
      m[2] * p[i] + m[6] * p[i + 1] + m[10] * p[i + 2] + m[14]];
    for (const body of this.visible()) {
      const { positions, values } = body.placed;
      for (let i = 0; i < values.length; i += 3) {
        const [p, q, r] = [0, 3, 6].map((k) => project(positions, 3 * i + k));
        const area = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
        const s = ((x - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (y - p[1])) / area;
        const t = ((q[0] - p[0]) * (y - p[1]) - (x - p[0]) * (q[1] - p[1])) / area;
        if (!(s >= 0 && t >= 0 && s + t <= 1)) continue;
        const depth = p[2] + s * (q[2] - p[2]) + t * (r[2] - p[2]);
        if (best === null || depth < best.depth) best = { depth, body, i, weights: [1 - s - t, s, t] };
      }
    }
    return best === null ? null : this.found(best);
  }

  found({ body, i, weights }) {
    const values = [0, 1, 2].map((k) => body.placed.values[i + k]), { a, b, t, index } = body.soup;
    const mixed = (of) => weights.reduce((sum, weight, k) => sum + weight * of(k), 0);
    const point = (k, axis) => {
      const v = index[i + k], [p, q] = [body.places[3 * a[v] + axis], body.places[3 * b[v] + axis]];
      return p + t[v] * (q - p);
    };
    const known = values.every((value) => value < 3e38);
    return {
      body: body.name, value: known ? mixed((k) => values[k]) : NaN,
      place: (this.space ? [0, 1, 2] : [0, 1]).map((axis) => mixed((k) => point(k, axis))),
    };
  }
};
