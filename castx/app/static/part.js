// The part of a case: its faces in space, their names and conditions, and the first case of a part.
"use strict";

castx.parts = (() => {
  const { at, make, server, editor } = castx;
  const state = { path: "", text: "", faces: [], bodies: [], surfaces: {}, drawing: "", found: new Set(), face: null, choices: null };
  let view = null;

  const source = () => ({ path: state.path, text: state.path === editor.state.path ? editor.text() : "" });
  const ofCase = () => state.path === editor.state.path && state.path !== "";

  // A face between two bodies is seen from the one that is shown.
  const shown = (face) => state.faces[face].bodies.some((body) => !view.hidden.has(body));
  const colour = (face) => {
    const { COLOURS } = castx.FaceView;
    if (face === state.face) return COLOURS.length + 2;
    if (state.found.has(face)) return COLOURS.length + 1;
    if (state.named.has(face)) return COLOURS.length;
    const body = state.faces[face].bodies.find((name) => !view.hidden.has(name));
    return Math.max(state.bodies.indexOf(body), 0) % COLOURS.length;
  };

  const open = () => {
    if (view !== null) return view;
    try {
      view = new castx.FaceView(at("part-canvas"), (face) => castx.trying(() => pick(face)));
    } catch {
      throw new Error("This browser has no WebGL 2, without which the part cannot be drawn. Its faces can still be named in the text.");
    }
    Object.assign(view, { colour, shown });
    return view;
  };

  const takeSurfaces = ({ surfaces, wrong, known, drawing }) => {
    Object.assign(state, { surfaces, drawing, named: new Set(Object.values(surfaces).flat()) });
    const row = (name, faces, kind) => make("button", { className: kind, onclick: () => mark(faces) }, `${name} `, make("span", { className: "quiet" }, `${faces.length} ${faces.length === 1 ? "face" : "faces"}`));
    at("surfaces").replaceChildren(
      ...Object.entries(surfaces).map(([name, faces]) => row(name, faces, "chip named")),
      ...Object.entries(known).filter(([name]) => name.endsWith("/outside")).map(([name, faces]) => row(name, faces, "chip")),
      ...Object.entries(wrong).map(([name, text]) => make("p", { className: "notice" }, `${name}: ${text}`)));
  };

  const mark = (faces) => {
    state.found = new Set(faces);
    state.face = null;
    view.refresh();
  };

  const extent = (name) => `${state.extents[name].map((x) => castx.text(1000 * x)).join(" × ")} mm`;

  const bodies = () => castx.boxes(at("bodies"), state.bodies, view, (name) => ` ${extent(name)}`);

  // Show the faces of a case, or of a part that has no case yet.
  const show = async (path) => {
    if (!path) return;
    open();
    at("part-state").textContent = "reading the part …";
    try {
      const fresh = path !== state.path;
      const asked = { path, text: path === editor.state.path ? editor.text() : "" };
      const answer = await server.ask("faces", asked);
      const counts = await castx.unpacked(answer.counts), points = await castx.unpacked(answer.points);
      if (fresh) {
        castx.hideMoulds(answer.bodies, view.hidden); // a mould hides the casting in it
      }
      Object.assign(state, { path, faces: answer.faces, bodies: answer.bodies, extents: answer.extents, found: new Set(), face: null });
      takeSurfaces(answer);
      view.load(points, counts, !fresh);
      bodies();
      at("part-state").textContent = `${path}: ${answer.bodies.length} ${answer.bodies.length === 1 ? "body" : "bodies"}, ${answer.faces.length} faces. ${ofCase() ? "Click a face to name it." : "Write a case for it in the tab New case; then its faces can be named."}`;
      at("naming").hidden = true;
      at("part-view").hidden = false;
      view.refresh();
    } catch (error) {
      at("part-state").textContent = "";
      throw error;
    }
  };

  const pick = async (face) => {
    state.face = face;
    if (face === null) {
      state.found = new Set();
      at("naming").hidden = true;
      view.refresh();
      return;
    }
    view.refresh();
    const answer = await server.ask("propose", { ...source(), face });
    state.found = new Set(answer.faces);
    view.refresh();
    tell(answer);
    at("selector").value = answer.selector;
    at("selector").dataset.proposal = answer.proposal;
    at("surface-name").value = answer.name ?? "";
    at("kind").disabled = !answer.free;
    if (!answer.free) at("kind").value = "";
    numbers();
    at("finds").textContent = finds(answer.faces);
    at("naming").hidden = !ofCase();
  };

  const tell = ({ text, on, said, free }) => {
    at("face-text").textContent = free && ofCase() ? `${text}. ${on}: ${said || "no condition, insulated"}` : text;
  };

  const finds = (faces) => `finds ${faces.length} ${faces.length === 1 ? "face" : "faces"}`;

  const select = async () => {
    try {
      const { faces } = await server.ask("select", { ...source(), selector: at("selector").value });
      state.found = new Set(faces);
      at("finds").textContent = finds(faces);
    } catch (error) {
      state.found = new Set();
      at("finds").textContent = error.message;
    }
    view.refresh();
  };

  const numbers = () => {
    const kind = state.choices?.conditions.find(({ name }) => name === at("kind").value);
    at("kind-text").textContent = at("kind").disabled ? "The face lies between two bodies: their interface says what passes there, in the tab Case. It can have a name." : kind?.summary ?? "";
    at("numbers").replaceChildren(...(kind?.keys ?? []).map((key) => make("label", {},
      `${key.text}${key.needed ? "" : " (optional)"} `,
      make("input", { name: key.name, size: 12, placeholder: key.usual ? `usually ${key.usual}` : "" }),
      make("span", { className: "quiet" }, key.meaning))));
  };

  const name = async () => {
    const given = Object.fromEntries([...at("numbers").querySelectorAll("input")].map((input) => [input.name, input.value]));
    const answer = await editor.change("name", { name: at("surface-name").value, selector: at("selector").value, kind: at("kind").value, numbers: given });
    if (state.face !== null) tell(await server.ask("propose", { ...source(), face: state.face }));
    at("finds").textContent = "written into the case file";
    const line = answer.text.split("\n").findIndex((text) => text.includes(at("selector").value));
    if (line >= 0) editor.goTo(line + 1);
  };

  const list = (parts) => {
    const options = (none) => [make("option", { value: "" }, parts.length ? none : "no STEP, IGES or BREP file here"), ...parts.map((part) => make("option", { value: part }, part))];
    for (const id of ["new-part", "part-file"]) {
      const chosen = at(id).value;
      at(id).replaceChildren(...options("choose a part"));
      if (parts.includes(chosen)) at(id).value = chosen;
    }
    at("no-part").hidden = parts.length > 0;
  };

  const choose = async () => {
    if (state.choices !== null) return;
    state.choices = await server.ask("choices");
    const { processes, materials, conditions } = state.choices;
    const option = (value, text) => make("option", { value }, text);
    at("new-process").append(...processes.map((one) => option(one.name, one.name)));
    at("new-alloy").append(...materials.filter((one) => one.melts).map((one) => option(one.name, `${one.name} (${one.class})`)));
    at("new-mould").append(...materials.filter((one) => !one.melts).map((one) => option(one.name, `${one.name} (${one.class})`)));
    at("kind").append(...conditions.map((one) => option(one.name, one.name)));
  };

  const ofProcess = () => {
    const process = state.choices.processes.find((one) => one.name === at("new-process").value);
    const refuses = process?.refuses ?? {};
    at("process-text").textContent = process ? [process.summary, ...Object.values(refuses)].join("; ") + "." : "Without a process, materials and temperatures are left to you, marked with CHOOSE.";
    at("new-alloy").options[0].textContent = process ? `as usual: ${process.alloy}` : "–";
    at("new-mould").options[0].textContent = process ? `as usual: ${process.mould}` : "–";
    for (const id of ["new-alloy", "new-mould"]) at(id).disabled = !process;
    for (const option of ["split", "top"]) {
      at(`new-${option}`).disabled = option in refuses;
      if (option in refuses) at(`new-${option}`).selectedIndex = 0;
    }
    ofSplit();
  };

  const ofSplit = () => { at("new-plane").disabled = !at("new-split").value; };

  const write = async () => {
    const given = Object.fromEntries(["process", "alloy", "mould", "split", "top"].map((key) => [key, at(`new-${key}`).disabled ? "" : at(`new-${key}`).value]));
    const plane = at("new-plane").value.trim().replace(",", ".");
    if (given.split && plane) given.split += `=${plane}${/[0-9.]$/.test(plane) ? "mm" : ""}`;
    state.output = at("new-output").value || at("new-part").value.replace(/\.[^.]*$/, ".toml");
    await server.ask("command", { command: "new", path: at("new-part").value, output: state.output, columns: castx.run.columns(), ...given });
    castx.tabs.show("Run");
    await castx.run.tick();
  };

  // After castx new its case is opened.
  castx.finished = (command, code) => castx.trying(async () => {
    await castx.list();
    await castx.run.finished(command, code);
    if (command !== "new" || code !== 0) return;
    await castx.open(state.output);
    castx.tabs.show("Part");
    const measured = at("said").textContent.split("\n").filter((line) => line.includes(", modulus ") || line.startsWith("by their labels"));
    await show(state.output);
    at("part-state").append(...measured.map((line) => make("span", { className: "measured" }, line)));
  });

  at("show-part").addEventListener("click", () => castx.trying(() => show(editor.state.path)));
  at("part-file").addEventListener("change", (event) => castx.trying(() => show(event.target.value)));
  at("selector").addEventListener("input", () => castx.trying(select));
  at("propose").addEventListener("click", () => { at("selector").value = at("selector").dataset.proposal; castx.trying(select); });
  at("kind").addEventListener("change", numbers);
  at("do-name").addEventListener("click", () => castx.trying(name));
  // The part that was chosen: its name for the case, and its size, by which wrong units show.
  const chosen = async () => {
    const part = at("new-part").value;
    at("do-new").disabled = !part;
    at("new-output").placeholder = part.replace(/\.[^.]*$/, ".toml");
    at("part-size").textContent = part ? "reading the part …" : "";
    if (!part) return;
    try {
      await show(part);
      at("part-size").textContent = state.bodies.map((name) => `${name}: ${extent(name)}`).join(", ") + `; ${state.faces.length} faces. The tab Part shows it.`;
    } catch (error) {
      at("part-size").textContent = "";
      throw error;
    }
  };

  at("new-part").addEventListener("change", () => castx.trying(chosen));
  at("new-process").addEventListener("change", ofProcess);
  at("new-split").addEventListener("change", ofSplit);
  at("do-new").addEventListener("click", () => castx.trying(write));
  // Names in the text are those in the view; a part with other faces is drawn anew.
  const follow = async () => {
    const answer = await server.ask("surfaces", source());
    if (answer.drawing !== state.drawing) return show(state.path);
    takeSurfaces(answer);
    view.refresh();
  };

  editor.onChange(({ path, case: known }) => {
    at("show-part").disabled = !known?.cad;
    if (path !== state.path) at("naming").hidden = true;
    else if (!at("part-view").hidden) follow().catch(() => {}); // while something else is wrong in the text, as before
  });

  return { list, show, pick, choose, ofProcess, state, view: () => view };
})();
