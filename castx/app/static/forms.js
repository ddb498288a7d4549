// Forms of a case: each key with its meaning, its allowed words, its default, and what is wrong with it.
"use strict";

castx.forms = (() => {
  const { at, make, server, editor } = castx;
  const state = { path: "", text: null, open: new Set(["Case"]), rest: new Set() };
  const EMPTY = "tables of which nothing is set";
  let shownTab = false;

  const lists = (suggested) => Object.entries(suggested).map(([name, words]) =>
    make("datalist", { id: `names-${name}` }, ...words.map((word) => make("option", { value: word }))));

  // What a key is set to: a choice, or words; `act` gets what was entered.
  const input = (field, suggested, act) => {
    const label = { "aria-label": field.key, "data-key": field.key };
    if (field.words.length) {
      const none = make("option", { value: "" }, field.default ? `${field.default.replaceAll('"', "")} (as usual)` : "–");
      const known = field.value === "" || field.words.includes(field.value) ? field.words : [field.value, ...field.words];
      const made = make("select", { ...label, onchange: () => act(made.value) }, none, ...known.map((word) => make("option", { value: word }, word)));
      made.value = field.value;
      return made;
    }
    const made = make("input", { ...label, value: field.value, spellcheck: false, placeholder: field.default, onchange: () => act(made.value) });
    if (field.name in suggested) made.setAttribute("list", `names-${field.name}`);
    return made;
  };

  const row = (field, suggested, act) => make("div", { className: field.given ? "field given" : "field", "data-field": field.key },
    make("label", {}, make("b", {}, field.name), field.needed ? make("span", { className: "quiet" }, " needed") : "", input(field, suggested, act)),
    make("span", { className: "quiet" }, field.meaning), make("p", { className: "wrong-field", hidden: true }));

  const keep = (set, name) => (event) => { if (event.target.open) set.add(name); else set.delete(name); };

  const set = (field) => (value) => castx.trying(async () => {
    const { line } = await editor.change("set", { keys: field.path, value });
    if (line !== null) editor.reveal(line);
    await show();
  });

  // Keys that are given or needed at once, the others on demand.
  const group = ({ title, meaning, given, fields }, suggested) => {
    const first = fields.filter((field) => field.given || field.needed), rest = fields.filter((field) => !field.given && !field.needed);
    const rows = (some) => some.map((field) => row(field, suggested, set(field)));
    return make("details", { className: "group", "data-group": title, open: state.open.has(title), ontoggle: keep(state.open, title) },
      make("summary", {}, make("b", {}, title), make("span", { className: "quiet" }, given ? ` ${first.length} of ${fields.length} keys` : " nothing is set")),
      make("p", { className: "quiet" }, meaning), ...rows(first),
      ...(rest.length ? [make("details", { open: state.rest.has(title), ontoggle: keep(state.rest, title) },
        make("summary", { className: "quiet" }, `${rest.length} further keys, as usual`), ...rows(rest))] : []));
  };

  // A form for a further entry of a list, which is written as a whole.
  const adder = ({ name, meaning, fields }, suggested) => {
    const values = {}, title = `Add to ${name}`;
    const rows = (some) => some.map((field) => row(field, suggested, (value) => { values[field.name] = value; }));
    return make("details", { className: "group", "data-group": title, open: state.open.has(title), ontoggle: keep(state.open, title) },
      make("summary", {}, title, make("span", { className: "quiet" }, ` ${meaning}`)),
      ...rows(fields.filter((field) => field.needed)),
      make("details", {}, make("summary", { className: "quiet" }, "further keys"), ...rows(fields.filter((field) => !field.needed))),
      make("button", { className: "main", "data-add": name, onclick: () => castx.trying(async () => { await editor.change("add", { list: name, values }); state.open.delete(title); await show(); }) }, `Add to ${name}`));
  };

  // Each problem stands beside the longest key that it is about.
  const mark = () => {
    const rows = [...at("groups").querySelectorAll("[data-field]")];
    rows.forEach((found) => { found.lastChild.hidden = true; found.lastChild.textContent = ""; found.classList.remove("wrong-row"); });
    for (const { key, text } of editor.state.problems) {
      const beside = rows.filter(({ dataset }) => key === dataset.field || (key.startsWith(dataset.field) && ".[".includes(key[dataset.field.length])))
        .sort((one, other) => other.dataset.field.length - one.dataset.field.length)[0];
      if (!beside || beside.closest("[data-adds]")) continue;
      beside.classList.add("wrong-row");
      beside.lastChild.hidden = false;
      beside.lastChild.append(beside.lastChild.textContent ? "; " : "", text);
      for (let around = beside.parentElement.closest("details"); around; around = around.parentElement.closest("details")) around.open = true;
    }
  };

  const search = () => {
    const wanted = at("form-search").value.trim().toLowerCase();
    for (const found of at("groups").querySelectorAll(".group")) {
      const rows = [...found.querySelectorAll("[data-field]")];
      rows.forEach((one) => { one.hidden = wanted !== "" && !one.textContent.toLowerCase().includes(wanted); });
      found.hidden = wanted !== "" && rows.every((one) => one.hidden);
      if (wanted !== "" && !found.hidden) found.querySelectorAll("details").forEach((inner) => { inner.open = true; });
      if (wanted !== "" && !found.hidden) found.open = true;
    }
  };

  const show = async () => {
    if (!shownTab || !editor.state.path) return;
    state.text = editor.text();
    const active = document.activeElement?.dataset?.key, top = at("groups").scrollTop;
    const { groups, lists: further, suggested } = await server.ask("form", { text: state.text });
    const made = (some) => some.map((one) => group(one, suggested)), empty = groups.filter((one) => !one.given);
    at("groups").replaceChildren(...lists(suggested), ...made(groups.filter((one) => one.given)),
      make("details", { className: "group", open: state.open.has(EMPTY), ontoggle: keep(state.open, EMPTY) },
        make("summary", { className: "quiet" }, `${empty.length} further tables, of which nothing is set`), ...made(empty)),
      make("div", { "data-adds": "" }, ...further.map((one) => adder(one, suggested))));
    mark();
    search();
    if (active) at("groups").querySelector(`[data-key="${CSS.escape(active)}"]`)?.focus();
    at("groups").scrollTop = top;
  };

  at("form-search").addEventListener("input", search);
  editor.onChange(({ path }) => {
    if (path !== state.path) Object.assign(at("form-search"), { value: "" });
    state.path = path;
    if (shownTab && editor.text() !== state.text) castx.trying(show); else if (shownTab) mark();
  });
  return { shown: (yes) => { shownTab = yes; if (yes) castx.trying(show); }, show };
})();
