// The last moment of a run with fields: the surfaces of its bodies in the colours of one of them.
"use strict";

castx.MomentView = class extends castx.FaceView {
  constructor(canvas, maps) {
    super(canvas, () => {}, maps);
    this.values = new Float32Array(0);
  }

  refresh() {
    if (!this.points) return;
    const positions = [], values = [], lines = [];
    let at = 0;
    this.counts.forEach((count, body) => {
      if (this.shown(body)) {
        for (let i = 9 * at; i < 9 * (at + count); i++) positions.push(this.points[i]);
        for (let i = 3 * at; i < 3 * (at + count); i++) values.push(this.values[i]);
        for (const side of this.outlines[body]) for (const end of side) lines.push(this.points[end], this.points[end + 1], this.points[end + 2]);
      }
      at += count;
    });
    this.painter.fill(this.triangles, Float32Array.from(positions), Float32Array.from(values));
    this.painter.fill(this.edges, Float32Array.from(lines), new Float32Array(lines.length / 3));
    this.draw();
  }

  paint() {
    this.painter.triangles(this.triangles, this.map, this.limits);
    this.painter.lines(this.edges, castx.FaceView.DARK);
  }
};

castx.moments = (() => {
  const { at, make, server } = castx;
  const EVERY = 8000; // ms between drawings while a run goes on
  const state = { results: "", version: 0, drawn: 0, busy: false, bodies: [], time: null };
  let view = null;

  const scale = ({ maps, colours, limits, factor, title }) => {
    const canvas = at("moment-colours"), context = canvas.getContext("2d"), map = maps[colours];
    for (let x = 0; x < canvas.width; x++) {
      context.fillStyle = `rgb(${map[Math.floor((x * map.length) / canvas.width)].join(",")})`;
      context.fillRect(x, 0, 1, 1);
    }
    at("moment-low").textContent = castx.text(factor * limits[0]);
    at("moment-high").textContent = `${castx.text(factor * limits[1])}  ${title}`;
  };

  const draw = async () => {
    if (state.busy) return;
    state.busy = true;
    const results = state.results;
    try {
      const found = await server.ask("moment", { results, field: at("moment-field").value || "temperature" });
      const [counts, points, values] = await Promise.all([found.counts, found.points, found.values].map(castx.unpacked));
      if (results !== state.results) return;
      at("moment").hidden = false;
      view ??= new castx.MomentView(at("moment-canvas"), found.maps);
      const fresh = found.bodies.join() !== state.bodies.join();
      Object.assign(state, { bodies: found.bodies, time: found.time });
      if (fresh) castx.hideMoulds(found.bodies, view.hidden);
      Object.assign(view, { values, map: found.colours, limits: found.limits, shown: (body) => !view.hidden.has(found.bodies[body]) });
      view.load(points, counts, !fresh, found.flat);
      at("moment-field").replaceChildren(...found.fields.map(({ name, title }) => make("option", { value: name, selected: name === found.field }, title)));
      castx.boxes(at("moment-bodies"), found.bodies, view);
      scale(found);
      at("moment-state").textContent = `t = ${castx.text(found.time)} s`;
      view.refresh();
    } finally {
      state.busy = false;
    }
  };

  const late = () => {
    if (state.time !== null) at("moment-state").textContent = `t = ${castx.text(state.time)} s; a later moment cannot be read yet`;
  };

  // Draw anew when a run has gone on; what cannot be read yet is read later.
  const follow = (results, version, ended) => {
    if (results !== state.results) {
      Object.assign(state, { results, version: 0, bodies: [], time: null });
      at("moment").hidden = true;
    }
    const due = Date.now() - state.drawn > EVERY || ended;
    if (!version || version === state.version || !due || state.busy || at("run").hidden) return;
    state.drawn = Date.now();
    draw().then(
      () => { if (results === state.results) state.version = version; },
      () => { if (results === state.results) late(); },
    );
  };

  at("do-moment").addEventListener("click", () => castx.trying(draw));
  at("moment-field").addEventListener("change", () => castx.trying(draw));
  return { follow, draw, state, view: () => view };
})();
