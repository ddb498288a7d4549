// The controls of the view: field, moment, bodies, cut, displacements, colours, and the mouse.
"use strict";

castx.Controls = class {
  constructor(view, root) {
    this.view = view;
    this.root = root;
    this.timer = null;
    this.pending = Promise.resolve();
    this.of = (name) => root.querySelector(`[data-control="${name}"]`);
  }

  start() {
    this.fillFields();
    this.fillBodies();
    this.fillMoments();
    this.fillCuts();
    this.listen();
    this.mouse();
    new ResizeObserver(() => this.view.draw()).observe(this.view.canvas);
    return this.update(true);
  }

  static option(select, value, text) {
    const option = document.createElement("option");
    option.value = value;
    option.textContent = text;
    select.append(option);
  }

  fillFields() {
    for (const field of this.view.scene.fields) castx.Controls.option(this.of("field"), field.name, field.title);
  }

  fillBodies() {
    for (const name of this.view.shown) {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = true;
      box.dataset.body = name;
      box.addEventListener("change", () => {
        if (box.checked) this.view.shown.add(name); else this.view.shown.delete(name);
        this.redraw();
      });
      label.append(box, ` ${name}`);
      this.of("bodies").append(label);
    }
  }

  fillMoments() {
    const { times, moments } = this.view.scene, slider = this.of("moment");
    slider.max = times.length - 1;
    slider.value = this.view.state.moment;
    moments.forEach((text, i) => {
      if (text === "") return;
      const chip = document.createElement("button");
      chip.type = "button";
      chip.textContent = `${text}, ${castx.text(times[i])} s`;
      chip.addEventListener("click", () => this.show({ moment: i }));
      this.of("chips").append(chip);
    });
    this.of("play").disabled = times.length < 2;
  }

  fillCuts() {
    const { space, turned, scene } = this.view, select = this.of("cut");
    const axes = space ? ["x", "y", "z"] : turned ? ["r", "z"] : ["x", "y"];
    castx.Controls.option(select, "", "none");
    axes.forEach((axis, i) => castx.Controls.option(select, i, `across ${axis}`));
    if (space) castx.Controls.option(select, "eye", "across the line of sight");
    this.of("revolve").closest("label").hidden = !turned;
    if (scene.factor === 0) this.of("factor").closest("label").hidden = true;
    if (scene.cut !== null) {
      const { low, high } = this.view.camera;
      select.value = "1";
      this.of("flip").checked = true; // the side of smaller y is taken away
      this.of("place").value = (1000 * (scene.cut - low[1])) / (high[1] - low[1]);
    }
  }

  listen() {
    const again = (name, event, change) => this.of(name).addEventListener(event, () => this.show(change(this.of(name))));
    again("field", "change", (of) => ({ field: of.value }));
    again("moment", "input", (of) => ({ moment: Number(of.value) }));
    again("factor", "input", (of) => ({ factor: (Number(of.value) / 100) * this.view.scene.factor }));
    again("scale", "change", (of) => ({ thisMoment: of.checked }));
    const anew = (name, event, change) => this.of(name).addEventListener(event, () => this.show(change(this.of(name)), true));
    anew("mesh", "change", (of) => ({ mesh: of.checked }));
    anew("revolve", "change", (of) => {
      this.view.camera.show(of.checked ? [0.6, 0.55, -0.75] : [0, 0, 1], of.checked); // into the quarter that is open
      return { revolved: of.checked };
    });
    for (const name of ["cut", "place", "flip"]) anew(name, name === "place" ? "input" : "change", () => ({}));
    this.of("cut").addEventListener("change", () => { this.sight = null; this.show({}, true); });
    this.of("play").addEventListener("click", () => this.play());
    this.of("reset").addEventListener("click", () => { this.view.camera.reset(); this.redraw(); });
    this.of("save").addEventListener("click", () => this.save());
  }

  // Change what is shown; changes follow each other even where arrays are still unpacked.
  show(change, rebuild = false) {
    Object.assign(this.view.state, change);
    return this.update(rebuild);
  }

  update(rebuild) {
    this.pending = this.pending.then(async () => {
      if (rebuild) this.view.state.plane = this.plane();
      if (rebuild || this.view.stale) await this.view.rebuild();
      await this.view.refresh();
      this.tell();
    });
    return this.pending;
  }

  redraw() {
    this.view.draw();
    this.tell();
  }

  plane() {
    const kind = this.of("cut").value, { low, high } = this.view.camera;
    this.of("place").disabled = this.of("flip").disabled = kind === "";
    if (kind === "") return null;
    const share = Number(this.of("place").value) / 1000;
    let normal, from, to;
    if (kind === "eye") {
      this.sight ??= this.view.camera.axes()[2];
      normal = this.sight;
      const middle = castx.geometry.dot(normal, this.view.camera.centre), half = 0.5 * this.view.camera.size;
      [from, to] = [middle - half, middle + half];
    } else {
      const axis = Number(kind);
      normal = [0, 1, 2].map((i) => (i === axis ? 1 : 0));
      [from, to] = [this.view.turned && axis === 0 ? 0 : low[axis], high[axis]];
    }
    const offset = from + share * (to - from) + 1e-6 * (to - from); // beside nodes that lie on it
    return this.of("flip").checked ? { normal: normal.map((x) => -x), offset: -offset } : { normal, offset };
  }

  // Texts, colour bars and positions of the controls.
  tell() {
    const { state, scene } = this.view, field = this.view.field();
    this.of("field").value = state.field;
    this.of("moment").value = state.moment;
    const when = `t = ${castx.text(scene.times[state.moment])} s`, what = scene.moments[state.moment];
    this.of("time").textContent = field?.final ? "at the end" : what === "" ? when : `${when}: ${what}`;
    this.of("caption").textContent = field?.caption ?? "";
    this.of("exaggeration").textContent = state.factor === 0 ? "not drawn" : `${castx.text(state.factor)} times`;
    this.of("scales").replaceChildren(...this.view.scales().map((scale) => this.bar(scale, field)));
    [...this.of("chips").children].forEach((chip) => {
      chip.classList.toggle("now", chip.textContent.startsWith(`${what}, `) && what !== "");
    });
  }

  bar(scale, field) {
    const element = document.createElement("div"), strip = document.createElement("div"), ends = document.createElement("div");
    const colours = this.view.scene.colours[scale.map].map((rgb) => `rgb(${rgb.join(",")})`);
    element.className = "scale";
    strip.className = "strip";
    strip.style.background = `linear-gradient(to right, ${colours.join(",")})`;
    ends.className = "ends";
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {
      const tick = document.createElement("span");
      tick.textContent = castx.text(field.factor * (scale.limits[0] + share * (scale.limits[1] - scale.limits[0])));
      ends.append(tick);
    }
    const label = document.createElement("div");
    label.textContent = `${field.title}${field.unit ? ` [${field.unit}]` : ""}, ${scale.names.join(", ")}`;
    element.append(label, strip, ends);
    return element;
  }

  play() {
    const button = this.of("play"), count = this.view.scene.times.length;
    if (this.timer !== null) {
      clearTimeout(this.timer);
      this.timer = null;
      button.textContent = "▶ play";
      return;
    }
    button.textContent = "❚❚ pause";
    const step = async () => {
      await this.show({ moment: (this.view.state.moment + 1) % count });
      if (this.timer !== null) this.timer = setTimeout(step, this.view.state.moment === count - 1 ? 1200 : 350);
    };
    this.timer = setTimeout(step, 0);
  }

  save() {
    const link = document.createElement("a");
    this.view.draw();
    link.href = this.view.canvas.toDataURL("image/png");
    link.download = `${this.view.state.field}_${castx.text(this.view.scene.times[this.view.state.moment])}_s.png`;
    link.click();
  }

  mouse() {
    const canvas = this.view.canvas, camera = this.view.camera;
    let last = null;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointerup", () => { last = null; });
    canvas.addEventListener("pointercancel", () => { last = null; });
    canvas.addEventListener("pointermove", (event) => {
      if (last === null) { this.point(event); return; }
      const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
      last = [event.clientX, event.clientY];
      if (event.shiftKey || event.buttons === 2) {
        camera.shift[0] += (2 * dx) / canvas.clientWidth;
        camera.shift[1] -= (2 * dy) / canvas.clientHeight;
      } else {
        camera.turn(dx, dy);
      }
      this.view.draw();
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return; // the page scrolls until the view is clicked
      event.preventDefault();
      camera.zoom = Math.max(0.2, Math.min(50, camera.zoom * Math.exp(-0.0015 * event.deltaY)));
      this.view.draw();
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const turns = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] };
      if (!(event.key in turns)) return;
      event.preventDefault();
      camera.turn(...turns[event.key]);
      this.view.draw();
    });
  }

  point(event) {
    const box = this.view.canvas.getBoundingClientRect();
    const found = this.view.picked((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    const field = this.view.field(), axes = this.view.space ? ["x", "y", "z"] : this.view.turned ? ["r", "z"] : ["x", "y"];
    this.of("readout").textContent = found === null ? "" : `${found.body}: ${
      Number.isNaN(found.value) ? "no value" : `${castx.text(field.factor * found.value)} ${field.unit}`} at ${
      found.place.map((x, i) => `${axes[i]} ${(1000 * x).toFixed(1)}`).join(", ")} mm`;
  }
};
