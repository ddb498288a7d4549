// Curves, most of them over time, with uPlot: numbers at the pointer, several runs and measured points in one diagram.
"use strict";

castx.charts = (() => {
  const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#5b5b5b", "#8c6d31"];
  const HEIGHT = 240, PAPER = [680, 190];

  // A curve has one colour in all runs, a run one kind of line.
  const styles = (panel) => {
    const curves = [], runs = [];
    for (const table of panel.tables) {
      for (const { curve, run } of table.lines) {
        if (!curves.includes(curve)) curves.push(curve);
        if (!runs.includes(run)) runs.push(run);
      }
    }
    const dashes = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
    return ({ curve, run }) => {
      const place = curves.indexOf(curve), round = Math.floor(place / COLOURS.length);
      return { stroke: COLOURS[place % COLOURS.length], dash: dashes[(runs.indexOf(run) + round) % dashes.length] };
    };
  };

  const series = (panel) => {
    const style = styles(panel), value = (_, y) => castx.text(y);
    const found = [{ label: panel.abscissa, value: (_, x) => castx.text(x) }];
    for (const { measured, lines } of panel.tables) {
      for (const line of lines) {
        const { stroke, dash } = style(line);
        found.push(measured
          ? { label: line.name, stroke, value, paths: () => null, points: { show: true, size: 6, stroke, fill: "#fff" } }
          : { label: line.name, stroke, dash, width: 1.8, value, points: { show: false },
            ...(panel.steps ? { paths: uPlot.paths.stepped({ align: -1 }) } : {}) });
      }
    }
    return found;
  };

  const positive = (panel, values) => (panel.logarithmic ? values.map((y) => (y > 0 ? y : null)) : values);

  const columns = (panel) => {
    const tables = panel.tables.map((table) => [table.time, ...table.lines.map((line) => positive(panel, line.values))]);
    return tables.length === 1 ? tables[0] : uPlot.join(tables);
  };

  const range = (panel) => (_, low, high) => {
    if (low === null || high === null) return [0, 1];
    if (panel.logarithmic) return [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high) + 1e-9)];
    const levels = Object.values(panel.levels);
    const [least, most] = [Math.min(low, ...levels), Math.max(high, ...levels)];
    if (most - least < panel.least) return [-0.05 * panel.least, panel.least];
    const margin = 0.05 * (most - least) || Math.abs(most) || 1;
    return [least - margin, most + margin];
  };

  // Thin lines with names, such as solidus and liquidus.
  const levels = (panel) => (plot) => {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = "#6a7078";
    ctx.setLineDash([6 * uPlot.pxRatio, 4 * uPlot.pxRatio]);
    ctx.font = `${11 * uPlot.pxRatio}px sans-serif`;
    ctx.textAlign = "right";
    const line = 12 * uPlot.pxRatio;
    let above = -Infinity;
    for (const [name, level] of Object.entries(panel.levels).sort(([, one], [, other]) => other - one)) {
      const y = plot.valToPos(level, "y", true), close = y - above < line;
      if (y < bbox.top || y > bbox.top + bbox.height) continue;
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
      ctx.fillText(name, bbox.left + bbox.width - 4, close ? y + line : y - 4); // not over the name above
      above = y;
    }
    ctx.restore();
  };

  // The point of a series that is nearest to the pointer: tables of different times are joined with holes.
  const nearest = (plot, of, index) => {
    const values = plot.data[of];
    for (let k = 0; k < values.length; k++) {
      for (const at of [index - k, index + k]) if (values[at] !== undefined && values[at] !== null) return at;
    }
    return index;
  };

  // Loggers begin early and end late: the run decides, as long as it has a value; gaps end with their interface.
  const span = (panel) => {
    const computed = panel.tables.filter((table) => !table.measured);
    const known = computed.flatMap((table) => table.time.filter((_, at) => table.lines.some((line) => line.values[at] !== null)));
    const times = known.length ? known : computed.flatMap((table) => table.time);
    return times.reduce(([first, last], time) => [Math.min(first, time), Math.max(last, time)], [times[0], times[0]]);
  };

  const options = (panel, width) => {
    const [first, last] = span(panel);
    return {
      width, height: HEIGHT, series: series(panel),
      scales: { x: { time: false, range: (_, low, high) => (low === null || low < first || high > last ? [first, last || 1] : [low, high]) },
        y: { range: range(panel), distr: panel.logarithmic ? 3 : 1 } },
      axes: [{ label: panel.abscissa, labelSize: 20, size: 36 },
        { label: panel.label, size: 64, labelSize: 20, values: (_, found) => found.map((y) => (y === null ? "" : castx.text(y))) }],
      cursor: { sync: { key: panel.abscissa, setSeries: false }, dataIdx: nearest, drag: { x: true, y: false } },
      legend: { live: true },
      hooks: { draw: [levels(panel)] },
    };
  };

  // Buttons that show the curves up to a moment: what happens in seconds is thin in the hours until a part is cold.
  const untils = (root, pages, drawn) => {
    const last = Math.max(...drawn.map(({ ends }) => ends[1])), events = new Map();
    for (const { until } of pages) for (const [name, time] of Object.entries(until ?? {})) if (time < 0.9 * last) events.set(name, time);
    const first = root.querySelector("[data-curves]");
    if (!events.size || !first) return;
    const show = (time) => drawn.forEach(({ plot, ends, over }) => { if (over) plot.setScale("x", { min: ends[0], max: time === null ? ends[1] : Math.min(time, ends[1]) }); });
    const bar = document.createElement("p");
    bar.className = "untils";
    const button = (text, time) => {
      const made = document.createElement("button");
      made.textContent = text;
      made.addEventListener("click", () => show(time));
      bar.append(made, " ");
    };
    button("whole run", null);
    for (const [name, time] of events) button(`until ${name}, ${castx.text(time)} s`, time);
    first.before(bar);
  };

  // signal: ends the listening of curves that are taken away.
  const draw = (root, pages, signal) => {
    const drawn = [];
    for (const page of pages) {
      const target = root.querySelector(`[data-curves="${CSS.escape(page.title)}"]`);
      for (const panel of page.panels) {
        const holder = document.createElement("div");
        holder.className = "chart";
        target.append(holder);
        const plot = new uPlot(options(panel, holder.clientWidth || 800), columns(panel), holder);
        drawn.push({ plot, holder, ends: span(panel), over: panel.abscissa === "time [s]" });
      }
    }
    const fit = (width, height) => drawn.forEach(({ plot, holder }) => plot.setSize({ width: width ?? holder.clientWidth, height }));
    window.addEventListener("resize", () => fit(null, HEIGHT), { signal });
    window.addEventListener("beforeprint", () => fit(...PAPER), { signal });
    window.addEventListener("afterprint", () => fit(null, HEIGHT), { signal });
    untils(root, pages, drawn);
    return drawn;
  };

  return { draw };
})();
