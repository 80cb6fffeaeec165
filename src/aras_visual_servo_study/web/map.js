// Maps of sweeps: a dot is a start. It tells its start, result and reason; a click gives the command that reruns it.
import { el } from "./lib/dom.js";
import { clamp, make, minus, tickText, ticks } from "./lib/draw.js";

const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const CHANGE = ["#0b3c8c", "#3b7cc4", "#9cc3e6", "#eeeeee", "#f3b58f", "#d96a2b", "#8c3200"];
const LEFT = 58, TOP = 10, BOTTOM = 44, RIGHT = 78;
const mix = (stops, share) => {
  const at = clamp(share, 0, 1) * (stops.length - 1), i = Math.min(Math.floor(at), stops.length - 2);
  const part = (k) => [0, 1].map((j) => parseInt(stops[i + j].slice(1 + 2 * k, 3 + 2 * k), 16));
  return `rgb(${[0, 1, 2].map((k) => { const [a, b] = part(k); return Math.round(a + (b - a) * (at - i)); }).join(",")})`;
};
const powers = (low, high) => {
  const values = [];
  for (let k = Math.ceil(Math.log10(low)); k <= Math.log10(high); k++) values.push(10 ** k);
  return { values: values.length > 1 ? values : [low, high] };
};

class Maps {
  constructor(section) {
    this.section = section;
    this.data = JSON.parse(section.querySelector("script").textContent);
    this.place = Object.fromEntries(this.data.columns.map((name, i) => [name, i]));
    this.chosen = null;
    this.told = section.querySelector(".run");
    this.tip = section.appendChild(el("div", { class: "tip", hidden: "" }));
    this.axes = ["x", "y"].map((axis) => {
      const choice = section.querySelector(`select[data-axis=${axis}]`);
      for (const { key, label } of this.data.axes) choice.append(el("option", { value: key }, label));
      choice.value = this.data[axis];
      choice.onchange = () => { this.data[axis] = choice.value; this.draw(); };
      return choice;
    });
    this.number = section.querySelector("input[type=number]");
    this.number.oninput = () => this.choose(this.data.rows.find((row) => this.value(row, "id") === Number(this.number.value)) || null);
    this.figures = this.data.maps.map((map) => {
      const svg = make("svg", { role: "img", "aria-label": map.title });
      section.querySelector(".maps").append(el("figure", {}, el("figcaption", {}, map.title), svg));
      svg.addEventListener("pointermove", (event) => this.hover(event, svg));
      svg.addEventListener("pointerleave", () => { this.tip.hidden = true; });
      svg.addEventListener("click", (event) => this.choose(this.nearest(event, svg)));
      return { map, svg };
    });
    section.classList.add("live");
    this.draw();
  }
  value(row, key) {
    const found = row[this.place[key]];
    return this.data.texts[key] && found !== null ? this.data.texts[key][found] : found;
  }
  ends(key) {
    const seen = this.data.rows.map((row) => this.value(row, key)).filter((x) => x !== null);
    const low = Math.min(...seen), high = Math.max(...seen), pad = 0.04 * (high - low) || Math.max(Math.abs(low) * 0.01, 1e-3);
    return seen.length ? [low - pad, high + pad] : [0, 1];
  }
  label(key) { return this.data.axes.find((axis) => axis.key === key).label; }
  draw(width) {
    for (const one of this.figures) this.map(one, width);
    this.mark();
  }
  map(one, width) {
    const { svg, map } = one, { x, y } = this.data, w = width || Math.round(svg.getBoundingClientRect().width) || 400;
    const h = Math.round(clamp(0.82 * (w - LEFT - RIGHT), 170, 380)) + TOP + BOTTOM, right = w - RIGHT, bottom = h - BOTTOM;
    svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
    svg.replaceChildren();
    const [x0, x1] = this.ends(x), [y0, y1] = this.ends(y);
    const at = one.at = (row) => {
      const a = this.value(row, x), b = this.value(row, y);
      return a === null || b === null ? null : [LEFT + (a - x0) / (x1 - x0) * (right - LEFT), bottom - (b - y0) / (y1 - y0) * (bottom - TOP)];
    };
    one.size = [w, h];
    const across = ticks(x0, x1, Math.max(4, Math.round(w / 100))), up = ticks(y0, y1, 5);
    for (const v of across.values) {
      const u = LEFT + (v - x0) / (x1 - x0) * (right - LEFT);
      make("path", { class: "grid", d: `M${u} ${TOP}V${bottom}` }, svg);
      make("text", { x: u, y: bottom + 16, "text-anchor": "middle" }, svg, tickText(v, across.step));
    }
    for (const v of up.values) {
      const b = bottom - (v - y0) / (y1 - y0) * (bottom - TOP);
      make("path", { class: "grid", d: `M${LEFT} ${b}H${right}` }, svg);
      make("text", { x: LEFT - 6, y: b + 4, "text-anchor": "end" }, svg, tickText(v, up.step));
    }
    make("path", { class: "frame", d: `M${LEFT} ${TOP}V${bottom}H${right}` }, svg);
    make("text", { x: (LEFT + right) / 2, y: h - 6, "text-anchor": "middle" }, svg, this.label(x));
    make("text", { transform: `translate(13 ${(TOP + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, svg, this.label(y));
    one.dots = [];
    const colour = this.colours(one, right + 14, bottom);
    const rows = this.data.rows.map((row) => [row, colour(row)]).sort((a, b) => a[1].layer - b[1].layer);
    for (const [row, { fill, cross, missing }] of rows) {
      const p = at(row);
      if (!p || missing) continue;
      const [u, v] = p, seen = map.kind === "classes" ? `--c:${fill}` : "";
      const dot = cross ? make("path", { d: `M${u - 3.5} ${v - 3.5}l7 7M${u + 3.5} ${v - 3.5}l-7 7`, stroke: fill, style: seen, "stroke-width": 1.4 }, svg)
        : make("circle", { cx: u, cy: v, r: rows.length > 1500 ? 2.6 : 4.5, fill, style: seen, "stroke-width": 0.6 }, svg);
      dot.setAttribute("class", "dot");
      dot.dataset.id = this.value(row, "id");
      one.dots.push([u, v, row]);
    }
    one.over = make("g", {}, svg);
  }
  // A function from a row to the look of its dot; draws the legend beside the map.
  colours({ map, svg }, left, bottom) {
    if (map.kind === "classes") {
      const known = Object.keys(map.classes).filter((name) => this.data.rows.some((row) => this.value(row, map.key) === name));
      known.forEach((name, i) => {
        const y = TOP + 9 + 30 * i, { color, cross, label } = map.classes[name];
        if (cross) make("path", { d: `M${left - 8} ${y - 4}l7 7m0 -7l-7 7`, stroke: color, style: `--c:${color}`, "stroke-width": 1.4 }, svg);
        else make("circle", { class: "key", cx: left - 4, cy: y - 1, r: 4, fill: color, style: `--c:${color}`, "stroke-width": 0.6 }, svg);
        label.split(" ").forEach((word, j) => make("text", { x: left + 5, y: y + 3 + 12 * j, "font-size": "88%" }, svg, word));
      });
      return (row) => {
        const { color, cross } = map.classes[this.value(row, map.key)];
        return { fill: color, cross, layer: known.indexOf(this.value(row, map.key)) };
      };
    }
    const values = this.data.rows.map((row) => this.value(row, map.key)).filter((v) => v !== null);
    if (!values.length) { make("text", { x: (LEFT + left) / 2, y: (TOP + bottom) / 2, "text-anchor": "middle" }, svg, "no run has a value"); return () => ({ missing: true, layer: 0 }); }
    let low = Math.min(...values), high = Math.max(...values);
    const change = map.kind === "change", stops = change ? CHANGE : VIRIDIS, log = !change && low > 0 && high > 100 * low;
    if (change) { high = Math.max(Math.abs(low), Math.abs(high)) || 1e-9; low = -high; } else if (high === low) { low -= Math.abs(low) * 1e-3 + 1e-9; high += Math.abs(high) * 1e-3 + 1e-9; }
    const share = log ? (v) => Math.log(v / low) / Math.log(high / low) : (v) => (v - low) / (high - low);
    const count = 40, step = (bottom - TOP) / count;
    for (let i = 0; i < count; i++) make("rect", { x: left, y: bottom - (i + 1) * step, width: 11, height: step + 0.5, fill: mix(stops, (i + 0.5) / count) }, svg);
    const { values: marked, step: apart } = log ? powers(low, high) : ticks(low, high, 5);
    const words = (v) => (log ? Number(v.toPrecision(2)).toString() : tickText(v, apart));
    for (const v of marked) make("text", { x: left + 15, y: bottom - share(v) * (bottom - TOP) + 4, "font-size": "88%" }, svg, words(v));
    return (row) => {
      const v = this.value(row, map.key);
      if (v === null) return this.data.crosses && this.value(row, this.data.crosses.key) === this.data.crosses.value ? { fill: "#8c8c8c", cross: true, layer: -1 } : { missing: true, layer: 0 };
      return { fill: mix(stops, share(v)), layer: change ? Math.abs(share(v) - 0.5) : 0 };
    };
  }
  nearest(event, svg) {
    const one = this.figures.find((other) => other.svg === svg), box = svg.getBoundingClientRect();
    const u = (event.clientX - box.left) * one.size[0] / box.width, v = (event.clientY - box.top) * one.size[1] / box.height;
    let best = null, least = 16;
    for (const [a, b, row] of one.dots) { const far = Math.hypot(a - u, b - v); if (far < least) { least = far; best = row; } }
    return best;
  }
  text(row, { key, unit, digits }) {
    const value = this.value(row, key);
    return value === null || value === "" ? null : minus(typeof value === "number" && digits !== null ? value.toFixed(digits) : value) + (unit ? ` ${unit}` : "");
  }
  hover(event, svg) {
    const row = this.nearest(event, svg);
    this.tip.hidden = !row;
    if (!row) return;
    this.tip.replaceChildren(el("b", {}, `run ${this.value(row, "id")}`), ...this.data.facts.filter((fact) => fact.short)
      .map((fact) => [fact, this.text(row, fact)]).filter(([, text]) => text !== null).map(([fact, text]) => el("span", {}, `${fact.label}: ${text}`)));
    const box = this.section.getBoundingClientRect(), wide = this.tip.offsetWidth;
    this.tip.style.left = `${Math.min(Math.max(event.clientX - box.left + 14, 0), Math.max(box.width - wide, 0))}px`;
    this.tip.style.top = `${event.clientY - box.top + 16}px`;
  }
  // Where the sweep is: beside this page, or where the page was told.
  command({ text, folder }, id) {
    const beside = location.protocol === "file:" ? decodeURIComponent(location.pathname).replace(/\/[^/]*$/, "") : "FOLDER";
    const path = folder || beside, quoted = /^[\w@%+=:,./-]+$/.test(path) ? path : `'${path.replace(/'/g, `'"'"'`)}'`;
    return text.replace("{id}", id).replace("{folder}", () => quoted);
  }
  choose(row) {
    if (!row) return;
    this.chosen = row;
    const id = this.value(row, "id"), list = el("dl", {});
    this.number.value = id;
    for (const fact of this.data.facts) {
      const text = this.text(row, fact);
      if (text !== null) list.append(el("div", {}, el("dt", {}, fact.label), el("dd", {}, text)));
    }
    this.told.replaceChildren(el("h3", {}, `Run ${id}`), list);
    for (const command of this.data.commands) {
      const line = this.command(command, id), code = el("code", {}, line), copy = el("button", { type: "button" }, "copy");
      copy.onclick = () => navigator.clipboard?.writeText(line).then(() => { copy.textContent = "copied"; }, () => getSelection().selectAllChildren(code));
      this.told.append(el("p", { class: "soft" }, command.label), el("div", { class: "command" }, el("pre", {}, code), copy));
    }
    this.mark();
  }
  mark() {
    for (const { over, at } of this.figures) {
      over.replaceChildren();
      const p = this.chosen && at(this.chosen);
      if (p) make("circle", { class: "ring", cx: p[0], cy: p[1], r: 8.5 }, over);
    }
  }
}

const all = [...document.querySelectorAll(".domain")].map((section) => new Maps(section));
let waiting = 0;
window.addEventListener("resize", () => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(() => all.forEach((maps) => maps.draw())); });
window.addEventListener("beforeprint", () => all.forEach((maps) => maps.draw(400)));
window.addEventListener("afterprint", () => all.forEach((maps) => maps.draw()));
