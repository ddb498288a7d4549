// The text of the case file: its lines, its problems beside them, and what is saved.
"use strict";

castx.editor = (() => {
  const { at, make, server } = castx;
  const area = at("text"), gutter = at("gutter");
  const state = { path: "", digest: "", saved: "", problems: [], case: null };
  const listeners = [];
  let waiting = null, checks = 0, last = Promise.resolve();

  const dirty = () => area.value !== state.saved;

  const number = () => {
    const wrong = new Set(state.problems.map((problem) => problem.line)), lines = area.value.split("\n").length;
    gutter.replaceChildren();
    let plain = "";
    for (let line = 1; line <= lines; line++) {
      if (!wrong.has(line)) { plain += `${line}\n`; continue; }
      gutter.append(plain, make("span", { className: "wrong" }, String(line)), "\n");
      plain = "";
    }
    gutter.append(plain);
    gutter.scrollTop = area.scrollTop;
  };

  const reveal = (line) => {
    area.scrollTop = Math.max(0, (line - 6) * parseFloat(getComputedStyle(area).lineHeight));
  };

  const goTo = (line) => {
    const lines = area.value.split("\n"), start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    area.focus();
    area.setSelectionRange(start, start + lines[line - 1].length);
    reveal(line);
  };

  const list = () => {
    const found = state.problems.map(({ line, key, text }) => make("button",
      { className: "problem", onclick: () => { if (line !== null) goTo(line); } },
      make("b", {}, [line === null ? "" : `line ${line}`, key].filter(Boolean).join(", ")), line === null && !key ? text : `: ${text}`));
    if (!found.length && state.path) found.push(make("p", { className: "fine quiet" }, "Keys and values of this file are accepted; Check builds its mesh too."));
    at("problems").replaceChildren(...found);
  };

  const show = () => {
    at("file-name").textContent = state.path || "No case is open";
    at("dirty").textContent = dirty() ? "not saved" : "";
    at("save").disabled = !state.path || !dirty();
    area.disabled = !state.path;
    number();
    list();
  };

  // Take what the server says of a text; text and digest only where they come from the file.
  const take = (answer) => {
    if (answer.text !== undefined && answer.text !== area.value) {
      const top = area.scrollTop;
      area.value = answer.text;
      area.scrollTop = top;
    }
    if (answer.digest !== undefined) { state.digest = answer.digest; state.saved = answer.text; }
    state.problems = answer.problems;
    if (answer.case !== null) state.case = answer.case;
    show();
    listeners.forEach((listener) => listener(state));
  };

  const check = async () => {
    const mine = ++checks, answer = await server.ask("check", { path: state.path, text: area.value });
    if (mine === checks) take(answer);
  };

  // Reading, changing and saving the file take turns: an answer that comes late would undo the one before.
  const settled = () => last.catch(() => {});
  const inTurn = (act) => { last = settled().then(act); return last; };

  const read = async (path, wanted = () => true) => {
    const answer = await server.ask("open", { path });
    if (!wanted()) return false;
    Object.assign(state, { path, case: null });
    checks++;
    take(answer);
    return true;
  };
  const open = (path) => inTurn(() => read(path));

  // The file has another text than the page read: show it, unless something was typed here since.
  const changed = (path, digest) => inTurn(async () => {
    const known = () => path === state.path && digest === state.digest;
    if (!known()) return;
    if (!dirty() && (await read(path, () => !dirty()))) at("dirty").textContent = "read anew: it has changed on the disk";
    else at("dirty").textContent = "not saved, and changed on the disk: open it again to see how";
  });

  // Ask for a change of the file as it is shown; it is written and shown as it is then.
  // Nothing can be typed meanwhile, for the answer takes the place of the text.
  const change = (action, asked = {}) => inTurn(async () => {
    checks++;
    area.readOnly = true;
    try {
      const answer = await server.ask(action, { path: state.path, text: area.value, digest: state.digest, ...asked });
      take(answer);
      return answer;
    } finally {
      area.readOnly = false;
    }
  });

  const save = () => change("save");
  const saved = async () => { await settled(); if (dirty()) await save(); };

  area.addEventListener("scroll", () => { gutter.scrollTop = area.scrollTop; });
  area.addEventListener("input", () => {
    checks++;
    at("dirty").textContent = dirty() ? "not saved" : "";
    at("save").disabled = !dirty();
    number();
    clearTimeout(waiting);
    waiting = setTimeout(() => castx.trying(check), 400);
  });
  window.addEventListener("beforeunload", (event) => { if (dirty()) event.preventDefault(); });

  return { open, save, saved, settled, change, changed, goTo, reveal, state, dirty, text: () => area.value, onChange: (act) => listeners.push(act) };
})();
