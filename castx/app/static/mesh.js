// The mesh of a case: its sizes, how many cells it has, and how it looks.
"use strict";

castx.boxes = (place, names, view, extra = () => "") => place.replaceChildren(...names.map((name) => castx.make("label", {}, castx.make("input", {
  type: "checkbox", checked: !view.hidden.has(name),
  onchange: (event) => { if (event.target.checked) view.hidden.delete(name); else view.hidden.add(name); view.fit(true); view.refresh(); },
}), ` ${name}`, castx.make("span", { className: "quiet" }, extra(name)))));

castx.hideMoulds = (names, hidden) => {
  hidden.clear();
  for (const name of names) if (names.length > 1 && /mould|mold|die\b|cope|drag/i.test(name)) hidden.add(name);
  if (hidden.size === names.length) hidden.clear();
};

castx.meshes = (() => {
  const { at, make, server, editor } = castx;
  const SIZES = ["size", "interface_size", "across", "curvature", "growth", "refinement", "narrowest", "most_cells"];
  const state = { path: "", faces: [], picked: null, bodies: [], cells: 0 };
  let view = null;

  const shown = (face) => !view.hidden.has(state.faces[face].bodies[0]);
  const colour = (face) => (face === state.picked ? castx.FaceView.COLOURS.length + 2
    : state.bodies.indexOf(state.faces[face].bodies[0]) % castx.FaceView.COLOURS.length);

  const pick = (face) => {
    state.picked = face;
    at("mesh-picked").textContent = face === null ? "" : state.faces[face].text;
    view.refresh();
  };

  // The sizes that this sort of geometry has, which are written as they are changed.
  const sizes = async () => {
    if (!editor.state.path) return;
    const { groups } = await server.ask("form", { text: editor.text() });
    const geometry = groups.find(({ title }) => title === "geometry");
    at("sizes").replaceChildren(...SIZES.map((name) => geometry.fields.find((field) => field.name === name)).filter(Boolean).map((field) => {
      const input = make("input", { value: field.value, placeholder: field.default, size: 10, "data-size": field.name, onchange: () => castx.trying(async () => {
        const { line } = await editor.change("set", { keys: field.path, value: input.value });
        if (line !== null) editor.reveal(line);
      }) });
      return make("label", { title: field.meaning }, field.name, input, make("span", { className: "quiet" }, field.meaning.split(/[([;]/)[0].trim()));
    }));
  };

  const text = ({ bodies, edges, worst }) => {
    const total = bodies.reduce((sum, body) => sum + body.cells, 0), nodes = bodies.reduce((sum, body) => sum + body.nodes, 0);
    const each = bodies.length > 1 ? ` (${bodies.map((body) => `${body.name} ${body.cells}`).join(", ")})` : "";
    const long = edges === null ? "" : `; edges of ${castx.text(1000 * edges[0])} to ${castx.text(1000 * edges[1])} mm, worst cell of quality ${castx.text(worst)} (1: regular)`;
    return `${total} cells${each}, ${nodes} nodes${long}`;
  };

  const draw = async () => {
    const begun = Date.now(), said = at("mesh-state"), path = editor.state.path;
    if (!path) throw new Error("Open a case, or write one in the tab New case.");
    const clock = setInterval(() => { said.textContent = `meshing … ${Math.round((Date.now() - begun) / 1000)} s`; }, 500);
    at("do-mesh").disabled = true;
    try {
      await editor.settled();
      const found = await server.ask("mesh", { path, text: editor.text() });
      const counts = await castx.unpacked(found.counts), points = await castx.unpacked(found.points);
      at("mesh-view").hidden = false;
      view ??= Object.assign(new castx.FaceView(at("mesh-canvas"), pick), { colour, shown, mesh: true });
      const names = found.bodies.map(({ name }) => name), fresh = path !== state.path || names.join() !== state.bodies.join();
      Object.assign(state, { path, faces: found.faces, bodies: names, picked: null });
      state.cells = found.bodies.reduce((sum, body) => sum + body.cells, 0);
      castx.run.expectSoon();
      if (fresh) castx.hideMoulds(names, view.hidden);
      view.load(points, counts, !fresh, found.flat);
      castx.boxes(at("mesh-bodies"), names, view, (name) => ` ${found.bodies.find((body) => body.name === name).cells}`);
      at("mesh-cells").textContent = [text(found), ...found.remarks].join(". ");
      at("mesh-picked").textContent = "";
      said.textContent = `made in ${((Date.now() - begun) / 1000).toFixed(0)} s`;
      view.refresh();
    } catch (error) {
      said.textContent = "";
      throw error;
    } finally {
      clearInterval(clock);
      at("do-mesh").disabled = false;
    }
  };

  at("do-mesh").addEventListener("click", () => castx.trying(draw));
  editor.onChange(({ path }) => {
    state.cells = 0;
    if (path !== state.path) at("mesh-view").hidden = true;
    else at("mesh-state").textContent = "the mesh below is that of before the last change";
  });
  return { shown: (yes) => { if (yes) castx.trying(sizes); }, draw, state, view: () => view, cells: () => state.cells };
})();
