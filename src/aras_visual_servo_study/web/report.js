// Plots of the report: zoom, pan, turn, read off. The page is whole without this: each plot's picture is drawn already.
import { clamp, make, minus, tickText, ticks } from "./lib/draw.js";

const times = [], paths = [], video = document.querySelector("video");
// Units of a feature without one are "-": only the number is shown then. Small numbers keep two digits.
const readable = (value, unit) => value === null ? "–" :
  minus(Math.abs(value) >= 100 ? value.toFixed(1) : Math.abs(value) >= 1 ? value.toFixed(2) :
    Math.abs(value) >= 1e-3 || value === 0 ? value.toFixed(4) : value.toExponential(1)) + (unit === "-" ? "" : " " + unit);

// What both kinds share: size, buttons, pointers and keys.
class Plot {
  constructor(figure) {
    this.figure = figure;
    this.data = JSON.parse(figure.querySelector("script").textContent);
    this.svg = figure.querySelector("svg");
    this.readout = figure.querySelector(".readout");
    this.cursor = null;
    this.touches = new Map();
    figure.classList.add("live");
    this.svg.setAttribute("tabindex", "0");
    const on = (name, work, options) => this.svg.addEventListener(name, work, options);
    on("pointerdown", (event) => this.down(event));
    on("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) on(name, (event) => this.up(event));
    on("pointerleave", () => { if (!this.touches.size && (!video || video.paused)) point(null); });
    on("dblclick", () => this.all());
    on("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey && document.activeElement !== this.svg) return;
      event.preventDefault();
      this.zoom(Math.exp(clamp(event.deltaY, -120, 120) * 0.002), this.place(event));
    }, { passive: false });
    on("keydown", (event) => {
      const work = { "+": () => this.zoom(0.6), "-": () => this.zoom(1 / 0.6), "0": () => this.all(), "Escape": () => this.all(),
        "ArrowLeft": () => this.step(-1), "ArrowRight": () => this.step(1) }[event.key];
      if (work) { event.preventDefault(); work(); }
    });
    for (const button of figure.querySelectorAll("button"))
      button.addEventListener("click", () => ({ in: () => this.zoom(0.6), out: () => this.zoom(1 / 0.6), all: () => this.all(),
        left: () => this.shift(-1), right: () => this.shift(1) })[button.dataset.do]());
  }
  layout(width) {
    this.w = width || Math.round(this.svg.getBoundingClientRect().width) || 520;
    this.h = Math.round(clamp(this.w * 0.6, 230, 330));
    this.svg.setAttribute("viewBox", `0 0 ${this.w} ${this.h}`);
    this.draw();
  }
  place(event) {
    const box = this.svg.getBoundingClientRect();
    return { x: (event.clientX - box.left) * this.w / box.width, y: (event.clientY - box.top) * this.h / box.height };
  }
  down(event) {
    this.touches.set(event.pointerId, this.place(event));
    try { this.svg.setPointerCapture(event.pointerId); } catch (error) { /* a pointer made by a test */ }
    this.started = this.place(event);
    this.moved = false;
    this.begin(event);
  }
  move(event) {
    const at = this.place(event), before = this.touches.get(event.pointerId);
    if (!before) { this.hover(at); return; }
    if (this.touches.size === 2) {
      const other = [...this.touches].find(([id]) => id !== event.pointerId)[1];
      this.pinch(before, at, other);
    } else {
      this.moved = this.moved || Math.hypot(at.x - this.started.x, at.y - this.started.y) > 5;
      this.drag(before, at, event);
    }
    this.touches.set(event.pointerId, at);
  }
  up(event) {
    if (!this.touches.delete(event.pointerId)) return;
    if (!this.touches.size) this.end(this.place(event), event);
  }
  begin() {}
  end(at) { if (!this.moved) this.hover(at); }
  step(direction) { pointAt(this.data.t[clamp((this.cursor === null ? -1 : this.cursor) + direction, 0, this.data.t.length - 1)]); }
  /** Shows the moment whose place is nearest to the pointer. ways: lists of [x, y] or null by moment.  least: how near. */
  nearest(at, ways, least) {
    let best = null;
    for (const way of ways) way.forEach((place, i) => {
      const far = place ? Math.hypot(place[0] - at.x, place[1] - at.y) : Infinity;
      if (far < least) { least = far; best = i; }
    });
    best === null ? point(null) : pointAt(this.data.t[best]);
  }
  label(x, y, text, anchor, sub) {
    const node = make("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor }, this.svg, text);
    if (sub !== undefined) {
      make("tspan", { dy: 3, "font-size": "80%" }, node, sub);
      make("tspan", { dy: -3 }, node, " [mm]");
    }
    return node;
  }
}

class TimePlot extends Plot {
  constructor(figure) {
    super(figure);
    this.hidden = new Set();
    this.end_s = Math.max(this.data.t[this.data.t.length - 1], 1e-3);
    this.range = [0, this.end_s];
    this.chips = [...figure.querySelectorAll(".legend button")];
    this.chips.forEach((chip, index) => chip.addEventListener("click", () => {
      this.hidden.has(index) ? this.hidden.delete(index) : this.hidden.add(index);
      chip.classList.toggle("off", this.hidden.has(index));
      chip.setAttribute("aria-pressed", String(!this.hidden.has(index)));
      this.draw();
    }));
  }
  value(y) { return y === null ? null : this.data.log ? Math.log10(Math.max(Math.abs(y), 1e-7)) : y; }
  x(t) { return this.left + (t - this.range[0]) / (this.range[1] - this.range[0]) * (this.edge - this.left); }
  t(x) { return this.range[0] + (x - this.left) / (this.edge - this.left) * (this.range[1] - this.range[0]); }
  y(v) { return 12 + (this.high - v) / (this.high - this.low) * (this.h - 12 - 42); }
  draw() {
    const { t, series, log } = this.data, svg = this.svg, [from, to] = this.range, bottom = this.h - 42;
    this.left = 58; this.edge = this.w - (this.data.right ? 56 : 10);
    svg.replaceChildren();
    const seen = [];
    series.forEach((one, index) => this.hidden.has(index) || one.y.forEach((y, i) => {
      const near = t[i] >= from && t[i] <= to || (t[i + 1] >= from && t[i] < from) || (t[i - 1] <= to && t[i] > to);
      if (near && y !== null) seen.push(this.value(y));
    }));
    const whole = to - from > 0.999 * this.end_s;
    if (whole) seen.push(...(log ? this.data.levels.map((level) => Math.log10(level.y)) : this.data.ends || [0]));
    if (!seen.length) seen.push(0, 1);
    this.low = Math.min(...seen); this.high = Math.max(...seen);
    const pad = 0.06 * (this.high - this.low) || Math.max(Math.abs(this.high) * 1e-3, 1e-6);
    this.low -= pad; this.high += pad;
    const across = ticks(from, to, Math.max(3, Math.round(this.w / 85)));
    for (const value of across.values) {
      const x = this.x(value);
      make("path", { class: "grid", d: `M${x} 12V${bottom}` }, svg);
      this.label(x, bottom + 16, tickText(value, across.step), "middle");
    }
    this.ruler(this.data.scale, (y, zero) => {
      make("path", { class: zero ? "zero" : "grid", d: `M${this.left} ${y}H${this.edge}` }, svg);
      return [this.left - 6, "end"];
    });
    if (this.data.right) this.ruler(this.data.right.scale, (y) => {
      make("path", { class: "frame", d: `M${this.edge} ${y}h4` }, svg);
      return [this.edge + 7, "start"];
    });
    const clip = `clip-${this.figure.id}`;
    make("rect", { x: this.left, y: 12, width: this.edge - this.left, height: bottom - 12 }, make("clipPath", { id: clip }, make("defs", {}, svg)));
    const inside = make("g", { "clip-path": `url(#${clip})` }, svg);
    for (const end of this.data.ends || []) make("path", { class: "end", d: `M${this.left} ${this.y(end)}H${this.edge}` }, inside);
    for (const level of log ? this.data.levels : [])
      make("path", { class: "level", stroke: level.color, style: `--c:${level.color}`, "stroke-dasharray": level.dash, "stroke-dashoffset": level.offset, d: `M${this.left} ${this.y(Math.log10(level.y))}H${this.edge}` }, inside);
    series.forEach((one, index) => {
      if (this.hidden.has(index)) return;
      let d = "", pen = "M";
      one.y.forEach((y, i) => {
        if (y === null) { pen = "M"; return; }
        d += pen + this.x(t[i]).toFixed(2) + " " + this.y(this.value(y)).toFixed(2);
        pen = "L";
      });
      make("path", { class: "curve", stroke: one.color, style: `--c:${one.color}`, "stroke-dasharray": one.dash || "none", d }, inside);
    });
    make("path", { class: "frame", d: `M${this.left} 12V${bottom}H${this.edge}${this.data.right ? "V12" : ""}` }, svg);
    this.label((this.left + this.edge) / 2, this.h - 7, this.data.across, "middle");
    for (const [x, text] of [[12, this.data.label], [this.w - 4, this.data.right?.label]])
      if (text) this.label(0, 0, text, "middle").setAttribute("transform", `translate(${x} ${(12 + bottom) / 2}) rotate(-90)`);
    this.over = make("g", {}, svg);
    this.mark();
  }
  /** Draws the numbers of a scale. factor: to its unit.  place: of a height, draws its line and tells [x, anchor] of its number. */
  ruler(factor, place) {
    const { log } = this.data, to = (v) => (log ? v + Math.log10(factor) : v * factor), from = (v) => (log ? v - Math.log10(factor) : v / factor);
    const low = to(this.low), high = to(this.high);
    let up = ticks(low, high, 5);
    if (log && up.step < 1 && high - low > 1.2) up = { values: ticks(Math.ceil(low), high, 50).values.filter((v) => Math.abs(v - Math.round(v)) < 1e-9), step: 1 };
    for (const value of up.values) {
      const y = this.y(from(value)), [x, anchor] = place(y, !log && Math.abs(value) < 1e-12);
      const whole_power = log && Math.abs(value - Math.round(value)) < 1e-9;
      const text = this.label(x, y + 4, !log ? tickText(value, up.step) : whole_power ? "10" : (10 ** value).toExponential(1).replace("-", "−"), anchor);
      if (whole_power) make("tspan", { dy: -5, "font-size": "80%" }, text, minus(String(Math.round(value))));
    }
  }
  mark(selection) {
    this.over.replaceChildren();
    if (selection) {
      const [a, b] = [Math.min(...selection), Math.max(...selection)];
      make("rect", { class: "selection", x: a, y: 12, width: b - a, height: this.h - 54 }, this.over);
    }
    const i = this.cursor;
    const show = i !== null && this.data.t[i] >= this.range[0] - 1e-9 && this.data.t[i] <= this.range[1] + 1e-9;
    if (show) {
      const x = this.x(this.data.t[i]);
      make("path", { class: "cursor", d: `M${x} 12V${this.h - 42}` }, this.over);
      this.data.series.forEach((one, index) => {
        if (one.y[i] !== null && !this.hidden.has(index))
          make("circle", { cx: x, cy: this.y(this.value(one.y[i])), r: 3.2, fill: one.color, style: `--c:${one.color}` }, this.over);
      });
    }
    this.readout.textContent = i === null ? "" : `t = ${this.data.t[i].toFixed(3)} s`;
    this.chips.forEach((chip, index) => {
      const one = this.data.series[index];
      chip.querySelector("output").textContent = i === null ? "" : readable(one.y[i] === null ? null : one.y[i] * one.factor + (one.offset || 0), one.unit);
    });
  }
  hover(at) { pointAt(this.t(at.x)); }
  begin(event) { this.mode = event.pointerType === "touch" ? "touch" : event.shiftKey || event.button === 1 ? "pan" : "select"; if (this.mode === "touch") this.hover(this.started); }
  drag(before, at) {
    const zoomed = this.range[1] - this.range[0] < 0.999 * this.end_s;
    if (this.mode === "select") { if (this.moved) this.mark([clamp(this.started.x, this.left, this.edge), clamp(at.x, this.left, this.edge)]); }
    else if (this.mode === "pan" || zoomed) { const d = this.t(before.x) - this.t(at.x); look(this.range[0] + d, this.range[1] + d); }
    else this.hover(at);
  }
  pinch(before, at, other) {
    const a = this.t(before.x), b = this.t(other.x), gap = at.x - other.x;
    this.mode = "pinched";
    if (Math.abs(gap) < 12 || Math.abs(before.x - other.x) < 12) return;
    const per = (a - b) / gap;     // seconds per pixel that keep both fingers on their moments
    const from = b + (this.left - other.x) * per, to = b + (this.edge - other.x) * per;
    if (to > from) look(from, to);
  }
  end(at) {
    if (this.mode === "select" && this.moved) {
      const [a, b] = [this.t(this.started.x), this.t(at.x)].sort((p, q) => p - q);
      look(Math.max(a, 0), Math.min(b, this.end_s));
    } else if (!this.moved) {
      this.hover(at);
      if (video) { video.pause(); video.currentTime = clamp(this.t(at.x), 0, video.duration || 0); }
    }
    this.mode = null;
  }
  zoom(factor, at) {
    const [from, to] = this.range, mid = at ? clamp(this.t(at.x), from, to) : this.cursor !== null ? clamp(this.data.t[this.cursor], from, to) : (from + to) / 2;
    look(mid + (from - mid) * factor, mid + (to - mid) * factor);
  }
  shift(direction) { const d = direction * 0.3 * (this.range[1] - this.range[0]); look(this.range[0] + d, this.range[1] + d); }
  all() { look(0, this.end_s); }
}

class PathPlot extends Plot {
  constructor(figure) {
    super(figure);
    const points = this.data.p.concat(this.data.goal ? [this.data.goal] : []);
    const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k]))), high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
    const edges = low.map((x, k) => Math.max(high[k] - x, 1e-3)), longest = Math.max(...edges);
    this.half = edges.map((edge) => Math.max(edge, longest / 2) / 2 * 1.08);
    this.whole = { azimuth: -57 * Math.PI / 180, elevation: 30 * Math.PI / 180, centre: low.map((x, k) => (x + high[k]) / 2), closer: 1 };
    this.view = { ...this.whole };
  }
  scale() {
    const { azimuth, closer } = this.view, { elevation } = this.whole, s = Math.abs(Math.sin(azimuth)), c = Math.abs(Math.cos(azimuth));
    const wide = s * this.half[0] + c * this.half[1], deep = c * this.half[0] + s * this.half[1];
    return closer * Math.min((this.w - 120) / (2 * wide), (this.h - 80) / (2 * (this.half[2] * Math.cos(elevation) + deep * Math.sin(elevation))));
  }
  project(p) {
    const { azimuth, elevation, centre } = this.view, scale = this.scale();
    const [x, y, z] = p.map((value, k) => value - centre[k]), s = Math.sin(azimuth), c = Math.cos(azimuth);
    return [this.w / 2 + scale * (-s * x + c * y), this.h / 2 - 8 - scale * (Math.cos(elevation) * z - Math.sin(elevation) * (c * x + s * y))];
  }
  draw() {
    const { azimuth, centre, closer } = this.view, svg = this.svg, { p, goal, colors } = this.data;
    const low = centre.map((x, k) => x - this.half[k] / closer), high = centre.map((x, k) => x + this.half[k] / closer), floor = low[2];
    const s = Math.sin(azimuth), c = Math.cos(azimuth);
    // Numbers stand at the edges of the floor that are near, and at the post on the left.
    const nearX = c > 0 ? high[0] : low[0], nearY = s > 0 ? high[1] : low[1], corner = this.project([nearX, nearY, floor]);
    const post = [[low[0], low[1]], [low[0], high[1]], [high[0], low[1]], [high[0], high[1]]]
      .reduce((a, b) => this.project([...a, floor])[0] <= this.project([...b, floor])[0] ? a : b);
    const line = (kind, a, b) => make("path", { class: kind, d: `M${a[0].toFixed(1)} ${a[1].toFixed(1)}L${b[0].toFixed(1)} ${b[1].toFixed(1)}` }, svg);
    const chain = (points) => points.map((q) => q.map((v) => v.toFixed(1)).join(",")).join(" ");
    svg.replaceChildren();
    for (const axis of [0, 1]) {
      const { values, step } = ticks(low[axis], high[axis], 4);
      const [mx, my] = this.project(axis === 0 ? [centre[0], nearY, floor] : [nearX, centre[1], floor]);
      const side = mx < corner[0] ? -1 : 1, anchor = side < 0 ? "end" : "start";
      for (const value of values) {
        const a = [low[0], low[1], floor], b = [high[0], high[1], floor];
        a[axis] = b[axis] = value;
        line("grid", this.project(a), this.project(b));
        const [x, y] = this.project(axis === 0 ? [value, nearY, floor] : [nearX, value, floor]);
        this.label(x + 3 * side, y + 13, tickText(1e3 * value, 1e3 * step), anchor);
      }
      this.label(mx + 46 * side, my + 28, "xy"[axis], anchor, "W");
    }
    const { values, step } = ticks(low[2], high[2], 3);
    for (const value of values) {
      const [x, y] = this.project([...post, value]);
      line("grid", [x - 4, y], [x, y]);
      this.label(x - 7, y + 4, tickText(1e3 * value, 1e3 * step), "end");
    }
    const top = this.project([...post, high[2]]);
    line("frame", this.project([...post, floor]), top);
    this.label(top[0], top[1] - 9, "z", "middle", "W");
    make("polyline", { class: "frame", points: chain([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]], [low[0], low[1]]].map((q) => this.project([...q, floor]))) }, svg);
    make("polyline", { class: "shadow", points: chain(p.map((q) => this.project([q[0], q[1], floor]))) }, svg);
    make("polyline", { class: "curve", stroke: colors.path, style: `--c:${colors.path}`, points: chain(p.map((q) => this.project(q))) }, svg);
    const [x, y] = this.project(p[0]);
    make("circle", { cx: x, cy: y, r: 5, fill: "none", stroke: colors.start, style: `--c:${colors.start}`, "stroke-width": 2 }, svg);
    if (goal) {
      const [gx, gy] = this.project(goal);
      const corners = [...Array(10).keys()].map((k) => `${gx + (k % 2 ? 3.4 : 8) * Math.sin(k * Math.PI / 5)} ${gy - (k % 2 ? 3.4 : 8) * Math.cos(k * Math.PI / 5)}`);
      make("path", { d: `M${corners.join("L")}Z`, fill: colors.goal, style: `--c:${colors.goal}` }, svg);
    }
    this.over = make("g", {}, svg);
    this.mark();
  }
  mark() {
    this.over.replaceChildren();
    const i = this.cursor;
    if (i !== null) {
      const [x, y] = this.project(this.data.p[i]);
      make("circle", { cx: x, cy: y, r: 4.5, fill: this.data.colors.path, style: `--c:${this.data.colors.path}` }, this.over);
    }
    this.readout.textContent = i === null ? "" : `t = ${this.data.t[i].toFixed(3)} s:  ` +
      this.data.p[i].map((value, k) => `${"xyz"[k]} ${minus((value * 1e3).toFixed(2))}`).join(",  ") + " mm";
  }
  hover(at) { this.nearest(at, [this.data.p.map((point) => this.project(point))], 24); }
  drag(before, at, event) {
    const dx = at.x - before.x, dy = at.y - before.y, view = this.view;
    if (event.shiftKey) this.pan(dx, dy);
    else {
      view.azimuth -= dx * 0.01;
      view.elevation = clamp(view.elevation + dy * 0.01, -0.2, Math.PI / 2);
      this.draw();
    }
  }
  pan(dx, dy) {
    const { azimuth, elevation, centre } = this.view, per = 1 / this.scale();
    const s = Math.sin(azimuth), c = Math.cos(azimuth), se = Math.sin(elevation), ce = Math.cos(elevation);
    const right = [-s, c, 0], up = [-se * c, -se * s, ce];
    this.view.centre = centre.map((x, k) => x - per * (dx * right[k] - dy * up[k]));
    this.draw();
  }
  pinch(before, at, other) {
    const ratio = Math.hypot(before.x - other.x, before.y - other.y) / Math.max(Math.hypot(at.x - other.x, at.y - other.y), 1);
    this.zoom(ratio);
    this.pan((at.x - before.x) / 2, (at.y - before.y) / 2);
  }
  zoom(factor, at) {
    const around = at || (this.cursor !== null ? (([x, y]) => ({ x, y }))(this.project(this.data.p[this.cursor])) : { x: this.w / 2, y: this.h / 2 });
    const closer = clamp(this.view.closer / factor, 0.3, 1e4), scaled = this.view.closer / closer;
    this.pan((this.w / 2 - around.x) * (1 - scaled), (this.h / 2 - 8 - around.y) * (1 - scaled));
    this.view.closer = closer;
    this.draw();
  }
  shift(direction) { this.view.azimuth += direction * 0.2; this.draw(); }
  all() { this.view = { ...this.whole, centre: [...this.whole.centre] }; this.draw(); }
}

// What the features show in the image. The image behind is that of the replay, where there is one.
class ImagePlot extends Plot {
  constructor(figure) {
    super(figure);
    this.over = this.svg.querySelector(".now");
    this.back = this.svg.querySelector(".view");
    this.start = this.back?.getAttribute("href");
    this.desired = document.querySelector("img[data-panel=desired]");
    const { width, height } = this.data;
    this.whole = { x: -0.5, y: -0.5, w: width, h: height };
    this.view = { ...this.whole };
    document.addEventListener("picture", (event) => { if (this.back) this.picture(event.detail); });
  }
  picture(image) {
    if (!this.data.difference || !this.desired) { this.back.setAttribute("href", image.src); return; }
    const canvas = document.createElement("canvas"), { width, height, full, colours } = this.data;
    canvas.width = width; canvas.height = height;
    const pen = canvas.getContext("2d", { willReadFrequently: true });
    const pixels = (one) => { pen.drawImage(one, 0, 0, width, height); return pen.getImageData(0, 0, width, height); };
    this.goal ||= pixels(this.desired);
    const now = pixels(image), grey = (data, i) => (data[i] + data[i + 1] + data[i + 2]) / 3;
    const [darker, equal, brighter] = colours.map((colour) => [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16)));
    for (let i = 0; i < now.data.length; i += 4) {
      const share = clamp((grey(now.data, i) - grey(this.goal.data, i)) / full, -1, 1), end = share < 0 ? darker : brighter;
      for (let k = 0; k < 3; k++) now.data[i + k] = equal[k] + Math.abs(share) * (end[k] - equal[k]);
    }
    pen.putImageData(now, 0, 0);
    this.back.setAttribute("href", canvas.toDataURL("image/jpeg", 0.9));
  }
  layout() { this.draw(); }
  draw() {
    const { x, y, w, h } = this.view;
    this.svg.setAttribute("viewBox", `${x} ${y} ${w} ${h}`);
    this.mark();
  }
  place(event) {
    const box = this.svg.getBoundingClientRect(), { x, y, w, h } = this.view;
    return { x: x + (event.clientX - box.left) / box.width * w, y: y + (event.clientY - box.top) / box.height * h };
  }
  mark() {
    const i = this.cursor === null ? 0 : this.cursor, { ways, shapes, t } = this.data;
    this.over.replaceChildren();
    for (const { seen, goal, color, closed } of shapes) {
      const points = seen[Math.min(i, seen.length - 1)].filter(Boolean);
      if (points.length) make("path", { class: goal ? "shape" : "still", stroke: color, d: `M${points.map((p) => p.join(" ")).join("L")}${closed ? "Z" : ""}` }, this.over);
    }
    for (const { p, color } of ways)
      if (p[i]) make("circle", { class: "dot", cx: p[i][0], cy: p[i][1], r: (this.view.w / 115).toFixed(2), stroke: color }, this.over);
    if (this.cursor === null && this.back && this.back.getAttribute("href") !== this.start) this.back.setAttribute("href", this.start);
    this.readout.textContent = this.cursor === null ? "" : `t = ${t[i].toFixed(3)} s` + (ways.length === 1 && ways[0].p[i] ? `:  u ${minus(ways[0].p[i][0].toFixed(1))},  v ${minus(ways[0].p[i][1].toFixed(1))} px` : "");
  }
  hover(at) { this.nearest(at, this.data.ways.map(({ p }) => p), this.view.w / 12); }
  drag(before, at, event) {
    this.view.x -= at.x - before.x; this.view.y -= at.y - before.y;
    this.draw();
    this.touches.set(event.pointerId, before);   // the image moved under the pointer
  }
  move(event) {
    const before = this.touches.get(event.pointerId);
    super.move(event);
    if (before && this.touches.size === 1) this.touches.set(event.pointerId, this.place(event));
  }
  pinch(before, at, other) { this.zoom(Math.hypot(before.x - other.x, before.y - other.y) / Math.max(Math.hypot(at.x - other.x, at.y - other.y), 1), other); }
  zoom(factor, at) {
    const { x, y, w, h } = this.view, k = clamp(factor, this.whole.w / 40 / w, this.whole.w / w), to = at || { x: x + w / 2, y: y + h / 2 };
    this.view = { x: to.x + (x - to.x) * k, y: to.y + (y - to.y) * k, w: w * k, h: h * k };
    this.draw();
  }
  shift(direction) { this.view.x += direction * 0.2 * this.view.w; this.draw(); }
  all() { this.view = { ...this.whole }; this.draw(); }
}

// One time range and one moment for all plots.
const look = (from, to) => {
  const end = times.length ? times[0].end_s : 0, span = clamp(to - from, end * 1e-4, end);
  from = clamp(from, 0, end - span);
  for (const plot of times) { plot.range = [from, from + span]; plot.draw(); }
};
const nearest = (t, moments) => moments.reduce((best, moment, i) => Math.abs(moment - t) < Math.abs(moments[best] - t) ? i : best, 0);
const point = (index) => {
  const t = index === null ? null : times[0].data.t[index];
  for (const plot of [...times, ...paths]) { plot.cursor = t === null ? null : nearest(t, plot.data.t); plot.mark(); }
  if (t !== null) document.dispatchEvent(new CustomEvent("moment", { detail: t }));
};
const pointAt = (t) => point(times.length ? nearest(t, times[0].data.t) : 0);

document.addEventListener("seek", (event) => { if (times.length) pointAt(event.detail); });

for (const figure of document.querySelectorAll("figure.plot"))
  figure.dataset.kind === "time" ? times.push(new TimePlot(figure)) : paths.push(figure.dataset.kind === "image" ? new ImagePlot(figure) : new PathPlot(figure));
const plots = [...times, ...paths], layout = (width) => plots.forEach((plot) => plot.layout(width));
layout();
let waiting = 0;
window.addEventListener("resize", () => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(() => layout()); });
// On paper: nothing zoomed, letters as large as those around them.
window.addEventListener("beforeprint", () => {
  plots.forEach((plot) => plot.all());
  layout(380);
});
window.addEventListener("afterprint", () => layout());
if (video && times.length) {
  const follow = () => { if (!video.paused) { pointAt(video.currentTime); requestAnimationFrame(follow); } };
  video.addEventListener("play", follow);
  video.addEventListener("seeked", () => pointAt(video.currentTime));
}
