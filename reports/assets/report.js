"use strict";
// Draws the curves of the report. Drag to zoom, double click to see everything; cursors over the same axis go together.
(() => {
  const figures = JSON.parse(document.getElementById("data").textContent);
  const style = () => getComputedStyle(document.documentElement);
  const colour = (name) => style().getPropertyValue(name).trim();
  const alpha = (hex, part) => hex + Math.round(255 * part).toString(16).padStart(2, "0");
  const plots = [];

  const minus = (text) => text.replaceAll("-", "\u2212");
  const number = (value) => {
    if (value === null || value === undefined) return "";
    const size = Math.abs(value);
    return minus(size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(3) : String(Number(value.toPrecision(5))));
  };
  // Points of all curves over one axis.
  const align = (figure) => {
    const columns = figure.curves.map((curve) => {
      const rows = [figure.x[curve.x], curve.y];
      if (curve.band) {
        rows.push(curve.y.map((y, i) => (y === null || curve.band[i] === null ? null : y + curve.band[i])));
        rows.push(curve.y.map((y, i) => (y === null || curve.band[i] === null ? null : y - curve.band[i])));
      }
      return rows;
    });
    return figure.x.length === 1
      ? [figure.x[0], ...columns.flatMap((rows) => rows.slice(1))]
      : uPlot.join(columns);
  };
  const extent = (values) => [values[0], values[values.length - 1]];
  const padded = (low, high) => {
    if (low === null || high === null) return [0, 1];
    const margin = 0.05 * (high - low) || 0.1 * Math.abs(high) || 1;
    return [low - margin, high + margin];
  };

  const draw = (holder, figure) => {
    const data = align(figure);
    const all = extent(data[0]);
    const series = [{ label: figure.axes[0], value: (_, v) => number(v) }];
    const bands = [];
    const followers = {};
    let banded = null;
    for (const curve of figure.curves) {
      const name = curve.style === "bound" ? "--soft" : "--c" + curve.colour;
      const stroke = () => colour(name);
      const points = curve.style === "points";
      const at = series.length;
      // the truth goes with its estimate
      if (banded !== null && curve.style === "dashed") followers[banded].push(at);
      series.push({
        label: curve.name, stroke, width: points ? 0 : 1.6, dash: curve.style === "dashed" || curve.style === "bound" ? [6, 4] : undefined,
        spanGaps: true, value: (_, v) => number(v), paths: points ? () => null : undefined,
        points: points ? { show: true, size: 3, fill: stroke, width: 0 } : { show: false },
      });
      if (curve.band) {
        banded = at;
        const edge = () => alpha(colour(name), 0.55);
        followers[at] = [at + 1, at + 2];
        for (const sign of ["+", "\u2212"]) {
          series.push({ label: curve.name + " " + sign, stroke: edge, width: 0.8, spanGaps: true, points: { show: false } });
        }
        bands.push({ series: [at + 1, at + 2], fill: () => alpha(colour(name), 0.13) });
      }
    }
    const range = (plot, low, high) => {
      const x = plot.scales.x;
      const whole = x.min === null || x.min === undefined || (x.min <= all[0] && x.max >= all[1]);
      return figure.view && whole && !plot.everything ? figure.view : padded(low, high);
    };
    const axis = (label, size) => ({
      label, size, labelSize: 20, labelGap: 2, stroke: () => colour("--soft"), font: "12px system-ui, sans-serif",
      labelFont: "12px system-ui, sans-serif",
      grid: { stroke: () => colour("--grid"), width: 1 }, ticks: { stroke: () => colour("--line"), width: 1, size: 5 },
    });
    const x = axis(figure.axes[0], 34);
    const y = axis(figure.axes[1], 58);
    // on logarithmic axes the library knows which ticks have room for their numbers
    if (!figure.logarithmic) y.values = (_, splits) => splits.map((v) => (v === null ? "" : minus(String(Number(v.toPrecision(6))))));
    const plot = new uPlot({
      width: holder.clientWidth || 600, height: 280, series, bands, axes: [x, y],
      scales: figure.logarithmic ? { x: { time: false, distr: 3 }, y: { distr: 3 } } : { x: { time: false }, y: { range } },
      cursor: { sync: { key: figure.axes[0] }, drag: { x: true, y: false }, points: { size: 7 } },
      legend: { markers: { fill: (plot, at) => plot.series[at].width === 0 ? plot.series[at].points.fill(plot, at) : null } },
      hooks: {
        // the edges of a band go with its curve
        setSeries: [(plot, at, options) => {
          if (at === null || options.show === undefined) return;
          for (const follower of followers[at] || []) plot.setSeries(follower, { show: options.show }, false);
        }],
      },
    }, data, holder);
    const rows = holder.querySelectorAll(".u-series");
    for (const pair of Object.values(followers)) for (const at of pair) rows[at].style.display = "none";
    plot.over.addEventListener("dblclick", () => {
      plot.everything = !plot.everything;
      plot.setScale("x", { min: all[0], max: all[1] });
    });
    plots.push({ plot, holder });
  };

  const fit = (width) => {
    for (const { plot, holder } of plots) {
      // what is folded gets its width when it is opened
      if (!width && holder.clientWidth === 0) continue;
      plot.setSize({ width: width || holder.clientWidth, height: 280 });
      plot.redraw(true, true);
    }
  };
  for (const holder of document.querySelectorAll("[data-figure]")) draw(holder, figures[Number(holder.dataset.figure)]);
  let waiting = 0;
  addEventListener("resize", () => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(() => fit()); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => fit());
  const print = matchMedia("print");
  print.addEventListener("change", () => fit(print.matches ? 330 : 0));
  for (const details of document.querySelectorAll("section > details")) details.addEventListener("toggle", () => fit());
  // what can be moved aside says so
  const wide = document.querySelectorAll(".wide, nav");
  const hint = () => wide.forEach((e) => e.classList.toggle("more", e.scrollLeft + e.clientWidth < e.scrollWidth - 2));
  wide.forEach((e) => e.addEventListener("scroll", hint, { passive: true }));
  addEventListener("resize", hint);
  hint();
  // a link to what is folded opens it
  const reveal = () => {
    const target = document.getElementById(location.hash.slice(1));
    const folded = target && target.querySelector(":scope > details");
    if (folded) folded.open = true;
  };
  addEventListener("hashchange", reveal);
  reveal();
  document.documentElement.dataset.drawn = String(plots.length);
})();
