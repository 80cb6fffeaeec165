// A live plot on a canvas: series over time, linear or logarithmic, with zoom, read-out, a way to a moment, PNG and CSV.
import { download, el, onPage, symbol } from "./dom.js";
import { clamp, ticks } from "./draw.js";
import { placeAt } from "./model.js";

const LEFT = 54, RIGHT = 10, TOP = 8, BOTTOM = 36;
/** A logarithmic axis ends this many decades below the smallest threshold: a zero crossing must not stretch it. */
const BELOW = 2;
/** A pointer that has moved less than this has clicked [px]. */
const CLICK = 6;

const words = (value, step) => {
  const size = Math.max(Math.abs(value), step);
  const text = size >= 1e5 || (value && size < 1e-3) ? value.toExponential(0) : value.toFixed(clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 6));
  return text.replace("-", "−");
};

/** A number in a legend. */
const short = (y) => (y === null || y === undefined ? "" : (Math.abs(y) >= 1e-3 || y === 0 ? y.toFixed(Math.abs(y) >= 100 ? 1 : 3) : y.toExponential(1)).replaceAll("-", "−"));

/** A power of ten on an axis. */
const decade = (power) => (power >= -4 && power <= 4 ? (10 ** power).toFixed(Math.max(0, -power)) : `1e${power}`.replace("-", "−"));

export class Chart {
  /**
   * spec: { title, unit, series: [{ name, label, colour, value(row) -> number | null, level, sign }], log, low, high, lines: [{ at, label }] }
   * shared: { window_s, from, to, paused, seek(t) }, one for all charts; from and to are null while the newest is followed.
   */
  constructor(spec, shared, changed) {
    Object.assign(this, { spec, shared, changed, rows: [], marks: [], over: null, zero: 0, axis: "", hidden: new Set(), log: Boolean(spec.log), cursor: null });
    this.canvas = el("canvas", { tabindex: 0, role: "img", "aria-label": `${spec.title} ${spec.unit} over time; the numbers are below, and in the CSV file`, title: "Click: go to this moment. Drag: zoom. Double-click: reset the zoom." });
    this.legend = el("div", { class: "legend" });
    this.outputs = spec.series.map((one, i) => {
      const output = el("output"), other = el("output", { class: "other", hidden: true, title: "the other run, at the same time after its start" });
      const chip = el("button", { type: "button", "aria-pressed": "true", title: one.title || one.label, onclick: () => {
        if (!this.hidden.delete(i)) this.hidden.add(i);
        chip.setAttribute("aria-pressed", String(!this.hidden.has(i)));
        this.draw();
      } }, el("i", { class: "swatch" }), ...(one.symbol ? [el("span", {}, symbol(one.symbol), one.unit)] : [one.label]), output, other);
      chip.firstChild.style.background = onPage(one.colour);
      this.legend.append(chip);
      return { output, other };
    });
    this.logButton = el("button", { type: "button", class: "quiet", title: "Linear or logarithmic", "aria-pressed": String(this.log), onclick: () => this.setLog(!this.log) }, "log");
    const tool = (text, title, act) => el("button", { type: "button", class: "quiet", title, onclick: act }, text);
    this.element = el("figure", { class: "chart", "data-chart": spec.key }, el("figcaption", {}, el("b", {}, spec.title), el("span", {}, spec.unit),
      el("span", { class: "tools" }, spec.fixed ? null : this.logButton, tool("PNG", "Save this plot as a picture", () => this.png()), tool("CSV", "Save the numbers that are shown", () => this.csv()))),
    this.canvas, this.legend);
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  setLog(log) { this.log = log; this.logButton.setAttribute("aria-pressed", String(log)); this.draw(); }

  recolour() { this.spec.series.forEach((one, i) => { this.legend.children[i].firstChild.style.background = onPage(one.colour); }); this.draw(); }

  /** rows: of the run that is shown.  marks: its moments.  over: a run that is drawn dashed, from the same beginning on.  zero: where
   * the axis begins to count [s].  axis: its name. */
  take(rows, { marks = [], over = null, zero = 0, axis = "" } = {}) { Object.assign(this, { rows, marks, over, zero, axis }); this.draw(); }

  /** [from, to] in seconds that are shown. */
  range() {
    const { shared, rows } = this, end = rows.length ? rows[rows.length - 1][0] : 0;
    if (shared.from === null && shared.run) return [rows[0][0], Math.max(end, rows[0][0] + 0.1)];
    return shared.from === null ? [Math.max(rows.length ? rows[0][0] : 0, end - shared.window_s), Math.max(end, (rows.length ? rows[0][0] : 0) + 1)] : [shared.from, shared.to];
  }

  inRange([from, to]) {
    const { rows } = this;
    const at = (t) => { let a = 0, b = rows.length; while (a < b) { const m = (a + b) >> 1; if (rows[m][0] < t) a = m + 1; else b = m; } return a; };
    return [Math.max(0, at(from) - 1), Math.min(rows.length, at(to) + 1)];
  }

  /** The series of the run that is drawn over this one. */
  others() {
    const series = this.over?.charts?.[this.spec.key], shift = this.over && this.rows.length ? this.rows[0][0] - this.over.from : 0;
    if (!series) return [];
    return this.spec.series.flatMap((one, i) => (this.hidden.has(i) ? [] : series.filter(({ name }) => name === one.name).map(({ value }) => ({ i, value, rows: this.over.rows, shift, colour: one.colour }))));
  }

  draw() {
    const ratio = Math.min(devicePixelRatio || 1, 2), w = this.canvas.clientWidth, h = this.canvas.clientHeight;
    if (!w || !h) return;
    if (this.canvas.width !== Math.round(w * ratio) || this.canvas.height !== Math.round(h * ratio)) { this.canvas.width = Math.round(w * ratio); this.canvas.height = Math.round(h * ratio); }
    const pen = this.canvas.getContext("2d"), style = getComputedStyle(this.element), colour = (name) => style.getPropertyValue(name).trim();
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    const [from, to] = this.range(), [first, end] = this.inRange([from, to]), { spec } = this;
    const size = (y) => (this.log ? Math.log10(Math.max(Math.abs(y), 1e-12)) : y);
    let low = Infinity, high = -Infinity;
    const stride = Math.max(1, Math.floor((end - first) / (2 * w)));
    const missing = (y) => y === null || y === undefined || (this.log && y === 0);
    const hold = (y) => { low = Math.min(low, size(y)); high = Math.max(high, size(y)); };
    spec.series.forEach((one, s) => {
      if (this.hidden.has(s)) return;
      for (let i = first; i < end; i += stride) {
        const y = one.value(this.rows[i]);
        if (!missing(y)) hold(y);
      }
      if (this.log && one.level) hold(one.level);
    });
    const others = this.others();
    for (const { value, rows, shift } of others) {
      for (const row of rows) {
        const y = value(row);
        if (!missing(y) && row[0] + shift >= from && row[0] + shift <= to) hold(y);
      }
    }
    const empty = first < end && !this.spec.series.some((one, s) => !this.hidden.has(s) && this.rows.slice(first, end).some((row) => (one.value(row) ?? null) !== null));
    const levels = spec.series.filter((one, s) => one.level && !this.hidden.has(s)).map((one) => one.level);
    if (this.log && levels.length) { low = Math.max(low, Math.log10(Math.min(...levels)) - BELOW); high = Math.max(high, low + 1); }
    if (!(low <= high)) { low = this.log ? -3 : -1; high = this.log ? 0 : 1; }
    if (!this.log && spec.low !== undefined) { low = Math.min(low, spec.low); high = Math.max(high, spec.high); }
    const pad = Math.max(0.06 * (high - low), this.log ? 0.08 : 0.5 * (spec.least || 0) - 0.5 * (high - low), 1e-9);
    low -= pad;
    high += pad;
    const X = (t) => LEFT + (t - from) / (to - from) * (w - LEFT - RIGHT), Y = (v) => TOP + (high - v) / (high - low) * (h - TOP - BOTTOM);
    Object.assign(this, { X, from, to, w });
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = colour("--soft");
    pen.strokeStyle = colour("--line");
    pen.lineWidth = 1;
    const line = (x0, y0, x1, y1) => { pen.beginPath(); pen.moveTo(x0, y0); pen.lineTo(x1, y1); pen.stroke(); };
    pen.textAlign = "center";
    const { zero } = this, across = ticks(from - zero, to - zero, Math.max(3, w / 90));
    for (const t of across.values) { const x = X(t + zero), text = words(t, across.step); line(x, TOP, x, h - BOTTOM); pen.fillText(text, Math.min(x, w - pen.measureText(text).width / 2), h - BOTTOM + 14); }
    pen.fillText(this.axis, (LEFT + w - RIGHT) / 2, h - 6);
    pen.textAlign = "right";
    const up = this.log ? { values: [], step: 1 } : ticks(low, high, 5), decades = Math.floor(high) - Math.ceil(low) + 1, every = Math.max(1, Math.ceil(decades / 8));
    if (this.log) for (let v = Math.floor(low); v <= high; v++) {
      const within = [0, ...(decades < 3 ? [Math.log10(2), Math.log10(5)] : [])].map((part) => v + part).filter((one) => one >= low && one <= high);
      if (v % every === 0) up.values.push(...within);
    }
    for (const v of up.values) {
      pen.strokeStyle = !this.log && v === 0 ? colour("--axis") : colour("--line");
      line(LEFT, Y(v), w - RIGHT, Y(v));
      pen.fillText(this.log ? (Number.isInteger(v) ? decade(v) : String(Number((10 ** v).toPrecision(1)))) : words(v, up.step), LEFT - 6, Y(v) + 4);
    }
    if (empty) { pen.textAlign = "center"; pen.fillText("only while it servoes", (LEFT + w - RIGHT) / 2, (TOP + h - BOTTOM) / 2); }
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, TOP - 2, w - LEFT - RIGHT, h - TOP - BOTTOM + 4);
    pen.clip();
    this.levels(pen, colour, (v) => Y(size(v)), w);
    /** A curve through every step-th row, with gaps where a value is missing; shift: added to the time of the rows [s]. */
    const trace = (rows, value, { begin = 0, stop = rows.length, step = 1, shift = 0 }) => {
      pen.beginPath();
      let on = false;
      for (let i = begin; i < stop; i += step) {
        const y = value(rows[i]);
        if (missing(y)) { on = false; continue; }
        if (on) pen.lineTo(X(rows[i][0] + shift), Y(size(y))); else pen.moveTo(X(rows[i][0] + shift), Y(size(y)));
        on = true;
      }
      pen.stroke();
    };
    spec.series.forEach((one, s) => {
      if (this.hidden.has(s)) return;
      pen.strokeStyle = onPage(one.colour);
      pen.lineWidth = 1.7;
      pen.lineJoin = "round";
      trace(this.rows, one.value, { begin: first, stop: end, step: stride });
      pen.lineWidth = 1;
    });
    for (const { value, rows, shift, colour: own } of others) {
      pen.strokeStyle = onPage(own);
      pen.setLineDash([7, 4]);
      trace(rows, value, { shift });
      pen.setLineDash([]);
    }
    pen.textAlign = "left";
    const free = [LEFT, LEFT, LEFT];   // names of moments stand in three lanes; one that fits into none is left to the time line
    const moments = this.marks.flatMap(({ times, label }) => times.map((t, i) => ({ t, label: i ? "" : label }))).sort((a, b) => a.t - b.t);
    for (const { t, label } of moments) {
      pen.strokeStyle = pen.fillStyle = colour("--soft");
      pen.setLineDash([2, 3]);
      line(X(t), TOP, X(t), h - BOTTOM);
      pen.setLineDash([]);
      if (!label) continue;   // it came before
      const wide = pen.measureText(label).width, x = Math.min(X(t) + 3, w - RIGHT - wide), lane = free.findIndex((one) => x >= one);
      if (lane < 0) continue;
      pen.fillText(label, x, TOP + 9 + 12 * lane);
      free[lane] = x + wide + 6;
    }
    pen.restore();
    if (this.shared.at !== null && this.shared.at >= from && this.shared.at <= to) {
      pen.strokeStyle = colour("--accent");
      pen.lineWidth = 1.5;
      line(X(this.shared.at), TOP, X(this.shared.at), h - BOTTOM);
      pen.lineWidth = 1;
    }
    const { cursor, at } = this.shared, pointed = cursor !== null && cursor !== undefined && cursor >= from && cursor <= to;
    const time = pointed ? cursor : at !== null ? at : this.rows.length ? this.rows[this.rows.length - 1][0] : 0;
    const row = this.rows[placeAt(this.rows, time)], when = pointed || at !== null ? `${(time - zero).toFixed(2)} s` : "";
    if (pointed) { pen.strokeStyle = colour("--axis"); line(X(cursor), TOP, X(cursor), h - BOTTOM); }
    if (when && time >= from && time <= to) {   // the moment whose numbers the legend shows
      const wide = pen.measureText(when).width + 8, x = clamp(X(time) - wide / 2, LEFT, w - wide);
      pen.fillStyle = colour("--ink");
      pen.fillRect(x, h - BOTTOM + 2, wide, 15);
      pen.fillStyle = colour("--card");
      pen.textAlign = "left";
      pen.fillText(when, x + 4, h - BOTTOM + 14);
    }
    if (this.selecting) {
      pen.fillStyle = colour("--accent");
      pen.globalAlpha = 0.15;
      pen.fillRect(Math.min(...this.selecting), TOP, Math.abs(this.selecting[1] - this.selecting[0]), h - TOP - BOTTOM);
      pen.globalAlpha = 1;
    }
    this.outputs.forEach(({ output, other }, i) => {
      output.textContent = row ? short(spec.series[i].value(row)) : "";
      const found = others.find((one) => one.i === i), there = found && found.rows[placeAt(found.rows, time - found.shift)];
      other.hidden = !found;
      other.textContent = found ? `┄ ${short(found.value(there))}` : "";
    });
  }

  /** Thresholds and limits: dotted, with a name at their right end, so that they are not taken for a curve. */
  levels(pen, colour, Y, w) {
    const { spec } = this, found = this.log ? [] : (spec.lines || []).map(({ at, label }) => ({ at, label, ink: colour("--warn") }));
    spec.series.forEach((one, s) => {
      if (!one.level || this.hidden.has(s)) return;
      for (const at of this.log ? [one.level] : [-one.level, one.level]) {
        const same = found.find((other) => other.at === at);
        if (same) { same.label += same.label && `, ${one.sign}`; same.ink = colour("--soft"); } else found.push({ at, label: at > 0 ? `threshold ${one.sign}` : "", ink: onPage(one.colour) });
      }
    });
    const placed = [];
    pen.textAlign = "right";
    for (const { at, label, ink } of found) {
      const y = Y(at);
      pen.strokeStyle = pen.fillStyle = ink;
      pen.setLineDash([1.5, 3.5]);
      pen.beginPath();
      pen.moveTo(LEFT, y);
      pen.lineTo(w - RIGHT, y);
      pen.stroke();
      pen.setLineDash([]);
      if (!label || placed.some((other) => Math.abs(other - y) < 12)) continue;
      placed.push(y);
      if (spec.lines) pen.fillText(label, LEFT + 4 + pen.measureText(label).width, y + (at > 0 ? 11 : -4)); else pen.fillText(label, w - RIGHT - 2, y - 3);
    }
  }

  listen() {
    const { canvas, shared } = this, time = (x) => this.from + (x - LEFT) / (this.w - LEFT - RIGHT) * (this.to - this.from);
    const at = (event) => event.clientX - canvas.getBoundingClientRect().left;
    const look = (from, to) => { if (to - from < 0.02) return; shared.from = from; shared.to = to; this.changed(); };
    canvas.addEventListener("pointermove", (event) => {
      if (this.begun === undefined) { shared.cursor = time(at(event)); this.changed(); return; }
      this.moved = Math.max(this.moved, Math.abs(at(event) - this.pressed));
      if (event.shiftKey || event.pointerType === "touch") {
        if (this.moved < CLICK) return;
        const d = time(this.begun) - time(at(event));
        this.begun = at(event);
        look(this.from + d, this.to + d);
      } else { this.selecting = [this.begun, Math.max(LEFT, Math.min(this.w - RIGHT, at(event)))]; this.draw(); }
    });
    canvas.addEventListener("pointerdown", (event) => { this.begun = this.pressed = Math.max(LEFT, at(event)); this.moved = 0; canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener("pointerup", () => {
      const chosen = this.selecting, clicked = this.begun !== undefined && this.moved < CLICK;
      if (clicked) shared.seek?.(time(Math.min(this.pressed, this.w - RIGHT)));
      this.begun = this.selecting = undefined;
      if (chosen && !clicked) look(...[time(chosen[0]), time(chosen[1])].sort((a, b) => a - b));
      this.draw();
    });
    canvas.addEventListener("pointercancel", () => { this.begun = this.selecting = undefined; });
    canvas.addEventListener("pointerleave", () => { shared.cursor = null; this.changed(); });
    canvas.addEventListener("dblclick", () => { shared.from = shared.to = null; this.changed(); });
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.altKey && document.activeElement !== canvas) return;   // the page scrolls, unless the plot was clicked
      event.preventDefault();
      const mid = time(at(event)), factor = event.deltaY > 0 ? 1.25 : 0.8;
      look(mid + (this.from - mid) * factor, mid + (this.to - mid) * factor);
    }, { passive: false });
  }

  csv() {
    const [first, end] = this.inRange(this.range()), { series } = this.spec;
    const lines = [["t_s", ...series.map((one) => one.name)].join(",")];
    for (const row of this.rows.slice(first, end)) lines.push([row[0], ...series.map((one) => one.value(row) ?? "")].join(","));
    download(`${this.spec.key}.csv`, new Blob([lines.join("\n") + "\n"], { type: "text/csv" }));
  }

  png() {
    const { canvas } = this, picture = document.createElement("canvas"), ratio = canvas.width / canvas.clientWidth, head = 30 * ratio;
    picture.width = canvas.width;
    picture.height = canvas.height + head;
    const pen = picture.getContext("2d"), style = getComputedStyle(this.element);
    pen.fillStyle = style.getPropertyValue("--card");
    pen.fillRect(0, 0, picture.width, picture.height);
    pen.drawImage(canvas, 0, head);
    pen.scale(ratio, ratio);
    pen.font = "600 12px system-ui, sans-serif";
    pen.fillStyle = style.getPropertyValue("--ink");
    pen.fillText(`${this.spec.title}  ${this.spec.unit}`, 8, 19);
    let x = 16 + pen.measureText(`${this.spec.title}  ${this.spec.unit}`).width;
    this.spec.series.forEach((one, i) => {
      if (this.hidden.has(i)) return;
      pen.fillStyle = onPage(one.colour);
      pen.fillRect(x, 13, 12, 3);
      pen.fillText(one.label, x + 16, 19);
      x += 30 + pen.measureText(one.label).width;
    });
    picture.toBlob((blob) => download(`${this.spec.key}.png`, blob), "image/png");
  }
}
