// Commands of castx as they run: what they say, how far a run is, its curves.
"use strict";

castx.run = (() => {
  const { at, make, server, editor } = castx;
  const seen = { command: "", said: 0, version: 0, results: "", running: false };
  let plots = [], listening = new AbortController();

  const begin = async (command, asked = {}) => {
    await editor.saved();
    await server.ask("command", { command, path: editor.state.path, ...asked });
    castx.tabs.show("Run");
    await tick();
  };

  const say = ({ text, name, ended, code, stopping, lines, said }) => {
    const said_ = at("said");
    if (text !== seen.command || said < seen.said) { said_.textContent = ""; seen.command = text; }
    at("command").hidden = false;
    at("command").textContent = text + (ended ? `    – ended with exit code ${code}` : stopping ? "    – stopping" : "    – running");
    if (lines.length) {
      const low = said_.scrollTop + said_.clientHeight >= said_.scrollHeight - 20;
      said_.append(lines.join("\n") + "\n");
      if (low) said_.scrollTop = said_.scrollHeight;
    }
    seen.said = said;
    if (seen.running && ended) castx.finished?.(name, code);
    seen.running = !ended;
    at("do-stop").disabled = ended || stopping;
    for (const id of ["do-check", "do-run", "do-restart", "do-report"]) at(id).disabled = !ended;
  };

  const draw = (pages) => {
    plots.forEach(({ plot }) => plot.destroy());
    listening.abort();
    listening = new AbortController();
    at("curves").replaceChildren(...pages.map((page) => make("div", {},
      make("h3", {}, page.title), make("p", { className: "quiet" }, page.caption), make("div", { "data-curves": page.title }))));
    plots = castx.charts.draw(at("curves"), pages, listening.signal);
  };

  const show = (run) => {
    const known = run.version !== 0 && run.time !== undefined, end = editor.state.case?.end;
    at("do-show").hidden = !run.report;
    at("run-bar").hidden = !known;
    if (!known) {
      at("run-state").textContent = run.said ?? `No results in ${seen.results} yet.`;
      if (run.version === 0) draw([]);
      return;
    }
    if (end) at("run-bar").value = Math.min(run.time / end, 1);
    const solid = Object.entries(run.solid).map(([name, share]) => `${name} ${(100 * share).toFixed(1)} % solid`);
    const ending = seen.running && !run.exit ? "running" : run.exit || "no end is recorded: it was killed, or runs elsewhere";
    at("run-state").textContent = [`${seen.results}: t = ${castx.text(run.time)} s${end ? ` of at most ${castx.text(end)} s` : ""}`,
      `${run.steps} steps`, ...solid, ending + (run.message ? `: ${run.message}` : "")].join(", ");
    if (run.curves) draw(run.curves);
  };

  const tick = async () => {
    const results = editor.state.case?.results ?? "";
    if (results !== seen.results) Object.assign(seen, { results, version: 0 });
    const inside = results && !results.startsWith("..");
    const answer = await server.ask("state", { since: seen.said, version: seen.version, ...(inside ? { results } : {}) });
    if (answer.command !== null) say(answer.command);
    if (answer.run !== null) {
      show(answer.run);
      seen.version = answer.run.version;
      castx.moments.follow(results, answer.run.version, !seen.running);
    } else if (results) at("run-state").textContent = `Results would lie in ${results}, outside of this folder: run it from the command line.`;
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
    if (name === "run" && seen.results && !seen.results.startsWith("..")) await begin("report", { path: seen.results });
    if (name === "report") await open();
  };

  return { tick, begin, finished, seen };
})();
