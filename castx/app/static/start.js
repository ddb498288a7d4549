// Begin: claim the page for this window, list the files, and ask again and again how things stand.
"use strict";

castx.trying = async (act) => {
  const refusal = castx.at("refusal");
  try {
    await act();
    refusal.hidden = true;
  } catch (error) {
    refusal.textContent = error.message;
    refusal.hidden = false;
  }
};

castx.tabs = (() => {
  const { at, make } = castx, panels = [...document.querySelectorAll(".panel")];
  const show = (name) => {
    panels.forEach((panel) => { panel.hidden = panel.dataset.tab !== name; });
    [...at("tabs").children].forEach((tab) => tab.setAttribute("aria-selected", String(tab.textContent === name)));
    castx.forms.shown(name === "Case");
    castx.meshes.shown(name === "Mesh");
    if (name === "Run") castx.run.expectSoon();
    window.dispatchEvent(new Event("resize"));
  };
  at("tabs").append(...panels.map(({ dataset }) => make("button", { role: "tab", onclick: () => show(dataset.tab) }, dataset.tab)));
  show("Run");
  return { show };
})();

(async () => {
  const { at, make, server, editor } = castx;
  const EVERY = 1000;
  let alive = false;

  const list = async () => {
    const files = await server.ask("files"), now = editor.state.path;
    const option = (name) => make("option", { value: name, selected: name === now }, name);
    at("case").replaceChildren(make("option", { value: "" }, files.cases.length ? "choose a case file" : "no case file here"), ...files.cases.map(option));
    castx.parts?.list(files.parts);
    castx.run.listed(files.results);
    return files;
  };
  castx.list = list;

  const open = async (path) => {
    if (!path) return;
    if (editor.dirty() && !window.confirm(`${editor.state.path} is not saved. Open another file and lose what was typed?`)) {
      at("case").value = editor.state.path;
      return;
    }
    await editor.open(path);
    at("case").value = path;
    await castx.run.tick();
  };
  castx.open = open;

  const begin = async (force) => {
    const answer = await server.claim(force);
    at("elsewhere").hidden = answer.claimed;
    at("elsewhere-text").textContent = "castx app is open in another window. One window works at a time, so that no two write the same file.";
    at("folder").textContent = `${answer.folder} · castx ${answer.version}`;
    alive = answer.claimed;
    if (!alive) return;
    const files = await list();
    await castx.parts.choose();
    castx.parts.ofProcess();
    if (files.cases.length === 0 && !editor.state.path) castx.tabs.show("New case");
    if (files.cases.length === 1 && !editor.state.path) await open(files.cases[0]);
    document.body.dataset.ready = "yes";
  };

  server.onLost(() => {
    alive = false;
    at("elsewhere-text").textContent = "castx app was opened in another window, and this one has stopped.";
    at("elsewhere").hidden = false;
  });
  at("take-over").addEventListener("click", () => castx.trying(() => begin(true)));
  at("again").addEventListener("click", () => castx.trying(list));
  at("case").addEventListener("change", (event) => castx.trying(() => open(event.target.value)));
  at("save").addEventListener("click", () => castx.trying(editor.save));
  window.addEventListener("keydown", (event) => {
    if ((event.ctrlKey || event.metaKey) && event.key === "s") {
      event.preventDefault();
      if (editor.dirty()) castx.trying(editor.save);
    }
  });

  await castx.trying(() => begin(false));
  let failed = false;
  setInterval(async () => {
    if (!alive) return;
    try {
      await castx.run.tick();
      if (failed) at("refusal").hidden = true;
      failed = false;
    } catch (error) {
      failed = true;
      at("refusal").textContent = error.message;
      at("refusal").hidden = false;
    }
  }, EVERY);
})();
