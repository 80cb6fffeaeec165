// Live curves: errors, camera velocity, joints against their limits, condition and manipulability, real-time factor.
import { button, card, el } from "../lib/dom.js";
import { Chart } from "../lib/chart.js";
import { kept, marginOf } from "../lib/runs.js";

const XYZ = ["#0072b2", "#d55e00", "#009e73"], MORE = ["#0072b2", "#d55e00", "#009e73", "#aa4499", "#170393", "#614d10", "#aa71fc", "#400d07"];
const times = (factor, i) => (row) => (row[i] === null || row[i] === undefined ? null : factor * row[i]);
const plain = (symbol) => symbol.replace("_", "");

/** What is plotted, from what the run says of itself. margin: kept to the limits of the joints [m, rad]. */
export const charts = (about, column, margin) => {
  const units = [...new Set(about.features.map((feature) => feature.read_unit))];
  const errors = about.features.map((feature) => ({
    name: `e_${feature.name}_${feature.read_unit}`, label: `${plain(feature.symbol)}${units.length > 1 ? ` ${feature.read_unit}` : ""}`, title: `${feature.label}, threshold ${Number((feature.factor * feature.threshold).toPrecision(3))} ${feature.read_unit}`, symbol: feature.symbol, unit: units.length > 1 ? ` ${feature.read_unit}` : "",
    colour: feature.colour, value: times(feature.factor, column[`e.${feature.name}`]), level: feature.factor * feature.threshold, sign: plain(feature.symbol) }));
  const velocity = (letters, factor, unit) => letters.map((letter, i) => ({ name: `${letter}_${unit}`, label: letter, colour: XYZ[i], value: times(factor, column[`v.${letter}`]) }));
  const joints = about.joints.map((joint, i) => {
    const ends = kept(joint, margin), at = column[`q.${joint.name}`], [low, high] = ends || [-Math.PI, Math.PI];
    return { name: `${joint.name}_part_of_range`, label: joint.name, colour: MORE[i % MORE.length], title: ends ? `${joint.name}: ${joint.lower} to ${joint.upper}, less ${margin} at each end` : `${joint.name}: no limits, shown from −π to π`,
      value: (row) => (row[at] === null || row[at] === undefined ? null : 2 * (row[at] - low) / (high - low) - 1) };
  });
  return [
    { key: "errors", title: "Errors", unit: units.map((unit) => `[${unit}]`).join(", "), series: errors, least: 0.01, log: true },
    { key: "linear_velocity", title: "Camera linear velocity", unit: "[mm/s]", series: velocity(["vx", "vy", "vz"], 1e3, "mm_per_s"), fixed: true, least: 1 },
    { key: "angular_velocity", title: "Camera angular velocity", unit: "[deg/s]", series: velocity(["wx", "wy", "wz"], 180 / Math.PI, "deg_per_s"), fixed: true, least: 0.2 },
    { key: "joints", title: "Joints", unit: `±1: limits less ${Number((1e3 * margin).toPrecision(3))} mm or ${Number((180 / Math.PI * margin).toPrecision(2))} deg`, series: joints, fixed: true, low: -1.1, high: 1.35,
      lines: [{ at: -1, label: "lower limit, less the margin" }, { at: 1, label: "upper limit, less the margin" }] },
    { key: "condition", title: "Conditioning", unit: "", log: true, series: [
      { name: "condition", label: "condition of L", colour: MORE[0], value: times(1, column.condition) },
      { name: "manipulability", label: "manipulability", colour: MORE[1], value: times(1, column.manipulability) }] },
    { key: "real_time_factor", title: "Real-time factor", unit: "simulated s per wall s", fixed: true, low: 0, high: 1, series: [
      { name: "real_time_factor", label: "reached", colour: MORE[0], value: times(1, column.real_time_factor) }] },
  ];
};

const make = (page) => {
  const { model, shared } = page, { card: box, head, body } = card("Curves", "curves");
  let drawn = [], held = null, due = false, built = "";
  const redraw = () => {
    if (due) return;
    due = true;
    requestAnimationFrame(() => {
      due = false;
      const { run, over } = shared, { about, column } = run || model, margin = run ? run.margin : marginOf(model);
      if ([margin, about.rows].join() !== built) build(about, column, margin);
      if (over && !over.charts) over.charts = Object.fromEntries(charts(over.about, over.column, over.margin).map((spec) => [spec.key, spec.series]));
      for (const chart of drawn) chart.take(run ? run.rows : shared.paused ? held : model.rows, run ? { marks: run.marks, over, zero: run.from, axis: "s since the servo began" } : { axis: "s of simulated time" });
      sync();
    });
  };
  page.redraw = redraw;
  const pause = button("Hold", "Freeze the curves while the run continues", () => {
    shared.paused = !shared.paused;
    held = shared.paused ? model.rows.slice() : null;
    redraw();
  }, { class: "quiet", "aria-pressed": "false", id: "hold" });
  const whole = button("All of it", "Reset the zoom (or double-click a curve)", () => { shared.from = shared.to = null; shared.paused = false; redraw(); }, { class: "quiet" });
  const window_s = el("select", { title: "Time range", "aria-label": "time range", id: "window", onchange: () => { shared.window_s = Number(window_s.value); shared.from = shared.to = null; redraw(); } },
    ...[[5, "5 s"], [10, "10 s"], [20, "20 s"], [60, "1 min"], [600, "all"]].map(([value, label]) => el("option", { value, selected: value === 20 }, label)));
  const sync = () => { window_s.hidden = pause.hidden = Boolean(shared.run); note.textContent = shared.run ? `${page.runs.name(shared.run)}${shared.over ? `; dashed: ${page.runs.name(shared.over)}` : ""}` : ""; pause.setAttribute("aria-pressed", String(shared.paused)); whole.disabled = shared.from === null && !shared.paused; };
  const note = el("small", { id: "curves-of" });
  head.append(note, el("span", { class: "tools" }, window_s, pause, whole));
  const build = (about, column, margin) => {
    built = [margin, about.rows].join();
    drawn = charts(about, column, margin).map((spec) => new Chart(spec, shared, redraw));
    body.replaceChildren(...drawn.map((chart) => chart.element));
    page.charts = drawn;
  };
  model.on("about", (about) => { if (!shared.run) build(about, model.column, marginOf(model)); redraw(); });
  model.on("rows", redraw);
  model.on("theme", () => drawn.forEach((chart) => chart.recolour()));
  build(model.about, model.column, marginOf(model));
  return box;
};

export const panel = { place: "curves", order: 10, make };
