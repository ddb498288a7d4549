// Commands of castx as they run: what they say, how far a run is, its curves.
"use strict";

castx.run = (() => {
  const { at, make, server, editor } = castx;
  // `own` is the folder of the case, `other` one that was chosen in its place, `results` the one that is shown.
  const seen = { command: "", said: 0, version: 0, path: "", own: "", other: "", results: "", running: false, run: {}, ofCase: {}, folders: [], asked: 0 };
  let plots = [], listening = new AbortController();

  // Letters of a line of the output, so that the command breaks its lines where the page would.
  const columns = () => {
    const context = document.createElement("canvas").getContext("2d"), style = getComputedStyle(at("said"));
    context.font = `${style.fontSize} ${style.fontFamily}`;
    return Math.max(0, Math.floor((at("run").clientWidth - 40) / context.measureText("0").width));
  };

  const begin = async (command, asked = {}) => {
    await editor.saved();
    if (command !== "report") seen.other = "";
    castx.tabs.show("Run"); // first, so that the width of its output is known
    await server.ask("command", { command, path: editor.state.path, digest: editor.state.digest, columns: columns(), ...asked });
    await tick();
  };

  const STOPPED = 130;
  const ending = (code) => (code === 0 ? "done" : code === STOPPED ? "stopped" : `ended with exit code ${code}`);

  // What a command says last against its case; it stands behind the name of castx.
  const refusal = (text) => {
    const lines = text.trimEnd().split("\n"), from = lines.findLastIndex((line) => line.startsWith("castx: "));
    return (from < 0 ? lines.slice(-3) : lines.slice(from)).join("\n").replace(/^castx: /, "");
  };

  // What can be done now: a case has to be open, a run to have left something.
  const offer = () => {
    // Run and Resume are of the case, reports of what is shown.
    if (!seen.other) seen.ofCase = seen.run;
    const free = !seen.running, open = editor.state.path !== "", { known, checkpoint, exit } = seen.ofCase;
    const resumed = checkpoint && exit !== "finished", done = seen.run.exit === "finished" && !at("do-show").hidden;
    at("do-check").disabled = at("do-run").disabled = !free || !open;
    at("do-restart").disabled = !free || !open || !checkpoint;
    at("do-report").disabled = !free || !seen.run.known;
    at("do-run").textContent = known ? "Run anew" : "Run";
    at("do-run").title = known ? `What is in ${seen.own} is kept beside it under a number` : "";
    at("do-run").className = resumed || done ? "" : "main";
    at("do-show").className = done ? "main" : "";
    at("do-restart").className = resumed ? "main" : "";
  };

  const say = ({ text, name, ended, code, stopping, lines, said }) => {
    const said_ = at("said");
    if (text !== seen.command || said < seen.said) { said_.textContent = ""; seen.command = text; }
    at("command").hidden = false;
    at("command").textContent = `${text}    – ${ended ? ending(code) : stopping ? "stopping after its step" : "running"}`;
    if (lines.length) {
      const low = said_.scrollTop + said_.clientHeight >= said_.scrollHeight - 20;
      said_.append(lines.join("\n") + "\n");
      if (low) said_.scrollTop = said_.scrollHeight;
    }
    seen.said = said;
    const refused = ended && code !== 0 && code !== STOPPED;
    at("ending").hidden = !refused;
    if (refused) at("ending").textContent = refusal(said_.textContent);
    if (seen.running && ended) {
      if (name === "run") { seen.other = ""; castx.trying(castx.list); }
      castx.finished?.(name, code);
      expectSoon();
    }
    seen.running = !ended;
    if (!ended) at("expected").textContent = "";
    at("do-stop").disabled = ended || stopping;
  };

  const draw = (pages) => {
    plots.forEach(({ plot }) => plot.destroy());
    listening.abort();
    listening = new AbortController();
    at("curves").replaceChildren(...pages.map((page) => make("div", {},
      make("h3", {}, page.title), make("p", { className: "quiet" }, page.caption), make("div", { "data-curves": page.title }))));
    plots = castx.charts.draw(at("curves"), pages, listening.signal);
  };

  const clock = (seconds) => {
    const whole = Math.max(Math.round(seconds), 0), two = (x) => String(x).padStart(2, "0");
    return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
  };
  const remains = (left) => (left === null || left === undefined ? "time left unknown yet" : `about ${clock(left)} left`);

  const show = (run) => {
    const known = run.version !== 0 && run.time !== undefined, end = run.end || (seen.other ? 0 : editor.state.case?.end);
    seen.run = { known, checkpoint: run.checkpoint, exit: run.exit };
    at("do-show").hidden = !run.report;
    at("run-bar").hidden = !known;
    if (!known) {
      at("run-state").textContent = run.said ?? `No results in ${seen.results} yet.`;
      if (run.version === 0) draw([]);
      return;
    }
    if (end) at("run-bar").value = Math.min(run.time / end, 1);
    const solid = Object.entries(run.solid).map(([name, share]) => `${name} ${(100 * share).toFixed(1)} % solid`);
    const goes = seen.running && !run.exit && !seen.other, how = goes ? `running, ${remains(run.left)}` : run.exit || "no end is recorded: it was killed, or runs elsewhere";
    at("run-state").textContent = [`${seen.results}: t = ${castx.text(run.time)} s${end ? ` of at most ${castx.text(end)} s` : ""}`,
      `${run.steps} steps`, ...solid, how + (run.message ? `: ${run.message.split("\n")[0]}` : "")].join(", ");
    if (run.curves) draw(run.curves);
  };

  // The folders with results: that of the case first, then all others, such as those kept under a number.
  const offerResults = () => {
    const { own, other, folders } = seen, others = folders.filter((name) => name !== own);
    const names = [own, ...others], label = (name) => (name === own ? `${own || "none"} (of this case)` : name);
    // A list that stays as it is keeps its elements: a choice may be under way in it.
    const text = names.map(label).join("\n"), list = at("results-of");
    if (text !== [...list.options].map((option) => option.textContent).join("\n")) {
      list.replaceChildren(...names.map((name) => make("option", { value: name }, label(name))));
    }
    list.value = other || own;
    at("results-state").textContent = other ? "of another run; Run and Resume are those of the case that is open" : "";
  };
  const listed = (folders) => { seen.folders = folders; offerResults(); };

  // How long a run would take, asked when the text, its mesh or the runs of the folder have changed.
  const expect = async () => {
    const { path } = editor.state, mine = ++seen.asked;
    if (!path || seen.running) at("expected").textContent = "";
    if (!path || seen.running || at("run").hidden) return;
    const { text } = await server.ask("expect", { path, text: editor.text(), cells: castx.meshes?.cells() ?? 0 });
    if (mine === seen.asked) at("expected").textContent = text ? `Time that a run will take: ${text}` : "";
  };
  let waiting = null;
  const expectSoon = () => { clearTimeout(waiting); waiting = setTimeout(() => castx.trying(expect), 300); };
  editor.onChange(({ path }) => {
    if (path !== seen.path) Object.assign(seen, { path, other: "" });
    expectSoon();
  });

  const ask = async () => {
    const own = editor.state.case?.results ?? "";
    if (own !== seen.own) Object.assign(seen, { own, other: "" });
    const results = seen.other || own;
    if (results !== seen.results) { Object.assign(seen, { results, version: 0 }); offerResults(); }
    const inside = results && !results.startsWith("..");
    const { path, digest } = editor.state;
    const answer = await server.ask("state", { since: seen.said, version: seen.version, path, digest, ...(inside ? { results } : {}) });
    if (answer.changed) await editor.changed(path, digest);
    if (answer.command !== null) say(answer.command);
    if (answer.run !== null) {
      show(answer.run);
      seen.version = answer.run.version;
      castx.moments.follow(results, answer.run.version, !seen.running || seen.other !== "");
    } else {
      seen.run = {};
      at("run-state").textContent = !results ? "No run yet." : `Results would lie in ${results}, outside of this folder: run it from the command line.`;
    }
    offer();
  };

  // One question at a time: an old answer must not be shown behind a newer one. The one that waits serves all who ask.
  let last = Promise.resolve(), next = null;
  const tick = () => {
    next ??= last.then(() => {
      next = null;
      const asked = ask();
      last = asked.catch(() => {});
      return asked;
    });
    return next;
  };

  for (const [id, command, asked] of [["do-check", "check"], ["do-run", "run"], ["do-restart", "run", { restart: true }]]) {
    at(id).addEventListener("click", () => castx.trying(() => begin(command, asked)));
  }
  at("do-report").addEventListener("click", () => castx.trying(() => begin("report", { path: seen.results })));
  at("do-stop").addEventListener("click", () => castx.trying(async () => { await server.ask("stop"); await tick(); }));
  const open = async () => {
    const { address } = await server.ask("show", { path: `${seen.results}/report.html` });
    window.open(address, "_blank", "noopener");
  };
  at("do-show").addEventListener("click", () => castx.trying(open));

  // After a run that has come to its end its report is written and opened, if that is wished.
  const finished = async (name, code) => {
    if (code !== 0 || !at("with-report").checked) return;
    if (name === "run" && seen.own && !seen.own.startsWith("..")) await begin("report", { path: seen.own });
    if (name === "report") await open();
  };

  at("results-of").addEventListener("change", ({ target }) => {
    seen.other = target.value === seen.own ? "" : target.value;
    castx.trying(tick);
  });

  return { tick, begin, finished, columns, seen, listed, expect, expectSoon };
})();
