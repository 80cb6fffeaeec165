// Controls from a schema: a slider for a number, a list for a choice, a switch, and sections of these.
import { el, nearest, notice, symbol } from "./dom.js";
import { valueAt } from "./model.js";
import { keyWords, readIn } from "./units.js";

/** Where a slider of a key without useful bounds ends, by unit; the number beside it takes any value that is allowed. */
const SPAN = { "grey levels": 100, s: 0.2, "1/s": 10, m: 0.2, rad: 0.5, "m, rad": 0.1, Hz: 100, "m/s": 1, "rad/s": 2 };
const SEND_MS = 60;

const lowest = (schema) => schema.minimum ?? schema.exclusiveMinimum ?? -Infinity;
const highest = (schema) => schema.maximum ?? schema.exclusiveMaximum ?? Infinity;

/** Bounds that are more than this many spans away are no end for a slider. */
const FAR = 5;
/** Where the slider of a key that is no less than 0 begins and ends, by unit: factors count, so it is logarithmic. */
const FACTORS = { "1/s": [0.1, 100] };

const decadeBelow = (x) => 10 ** Math.floor(Math.log10(x) + 1e-9);

/**
 * How a slider maps its way of 0 to 1 to a number: { from(part), to(value) }. It stays as it is while a value changes.
 * first: the value that was there first.  value: the one there now; only one that lies beyond an end moves this end.
 */
export const scaleOf = (schema, first, value = first) => {
  const low = lowest(schema), high = highest(schema), size = Math.abs(first || 0) || Math.abs(schema.default || 0);
  if (schema.exclusiveMinimum === 0 && size > 0) {   // a gain, a threshold
    const [least, most] = FACTORS[schema.unit] || [0.1 * decadeBelow(size), 100 * decadeBelow(size)], now = Math.abs(value || 0) || size;
    const bottom = Math.log(Math.min(least, decadeBelow(now))), top = Math.log(Math.min(Math.max(most, 10 * decadeBelow(0.999 * now)), Math.max(high, now)));
    return { from: (part) => Math.exp(bottom + part * (top - bottom)), to: (x) => (Math.log(Math.max(x, 1e-12)) - bottom) / (top - bottom) };
  }
  const span = Math.max(SPAN[schema.unit] || 1, 3 * size, Math.abs(value || 0));
  const begin = Number.isFinite(low) && low > -1000 ? low : -span, end = Number.isFinite(high) && high - begin <= Math.max(FAR * span, begin < 0 ? 1000 : 0) ? high : Math.max(begin, 0) + span;
  return { from: (part) => begin + part * (end - begin), to: (x) => (x - begin) / (end - begin) };
};

const short = (value, schema) => (schema.type === "integer" ? String(Math.round(value)) : String(Number(value.toPrecision(4))));

/** The kind of a schema that a value is of, where there are several. */
export const kindOf = (kinds, value) => kinds.find((kind) => value && Object.entries(kind.properties || {}).every(([key, one]) => one.const === undefined || one.const === value[key])) || kinds[0];

export class Fields {
  constructor(page) {
    this.page = page;
    this.model = page.model;
    this.byPath = new Map();
    this.waiting = new Map();
    this.firsts = new Map();
    this.model.on("values", (paths) => this.refresh(paths));
  }

  /** Sends a value, no oftener than the run can take it; the newest always arrives. paths: that get it, where it is not one. */
  send(path, value, paths = [path]) {
    const pending = this.waiting.get(path) || {};
    pending.value = value;
    this.waiting.set(path, pending);
    if (pending.timer || pending.flying) return;
    pending.timer = setTimeout(() => {
      pending.timer = null;
      pending.flying = true;
      const sent = pending.value;
      let refused = false;
      this.page.ask({ do: "set", values: Object.fromEntries(paths.map((one) => [one, sent])) })
        .then(() => notice(path, ""), (error) => { refused = true; this.fault(path, paths.length > 1 ? error.faults?.[0] || error.message : error.message); })
        .finally(() => { pending.flying = false; if (pending.value !== sent) this.send(path, pending.value, paths); else this.refresh([path], refused); });
    }, pending.last && performance.now() - pending.last < SEND_MS ? SEND_MS : 0);
    pending.last = performance.now();
  }

  /** Whether the run has not yet answered to the newest value of a path: until then the page shows what was asked for. */
  sending(path) { const pending = this.waiting.get(path); return Boolean(pending && (pending.timer || pending.flying)); }

  fault(path, text) {
    notice(path, text);
    setTimeout(() => notice(path, ""), 8000);
  }

  /** Shows the values of these paths (null: of all); refused: also in a box that is being written in. */
  refresh(paths, refused = false) {
    for (const [path, fields] of this.byPath)
      if (paths === null || paths.some((one) => path === one || path.startsWith(`${one}.`) || one.startsWith(`${path}.`)))
        for (const field of fields) field(refused);
  }

  listen(path, show) {
    if (!this.byPath.has(path)) this.byPath.set(path, []);
    this.byPath.get(path).push(show);
    show();
  }

  value(path, schema) { const value = valueAt(this.model.values, path); return value === undefined ? schema.default : value; }

  waits(path) { return !this.model.about.at_once.some((pattern) => new RegExp(`^(?:${pattern})$`).test(path)); }

  row(path, schema, label, control, more = null) {
    const { unit } = readIn(/number|integer|array/.test(schema.type) ? schema.unit : ""), shown = unit || schema.unit;
    const help = [path, schema.description, shown ? `[${shown}]` : ""].filter(Boolean).join("\n");
    const note = el("small", { class: "waits", hidden: true }, "after Reset");
    this.listen(path, () => { note.hidden = !this.waits(path) || !this.model.waiting.includes(path); });
    return el("div", { class: "field", "data-path": path, title: help }, el("label", {}, label, shown && shown !== "-" ? el("small", {}, ` ${shown}`) : "", note), control, more);
  }

  /** The control of one key, or the section of one that holds others. */
  make(path, schema, label = keyWords(path.split(".").pop())) {
    const choices = this.model.about.choices[path] || schema.enum;
    if (path === "servo.features") return this.list(path, schema, label);
    if (choices) return this.choice(path, schema, label, choices);
    if (schema.type === "boolean") return this.toggle(path, schema, label);
    if (schema.type === "number" || schema.type === "integer") return this.number(path, schema, label);
    if (schema.type === "string") return this.text(path, schema, label);
    if (schema.type === "array" && /number|integer/.test(schema.items?.type) && (schema.minItems === schema.maxItems) && schema.maxItems <= 8) return this.numbers(path, schema, label);
    if (schema.properties || (schema.type === "object" && typeof schema.additionalProperties === "object")) return this.section(path, schema, label);
    return this.json(path, schema, label);
  }

  /** paths: where there are several, the number is that of all of them; without one where they differ. */
  number(path, schema, label, paths = [path]) {
    const limits = () => { const most = this.model.ends[path]; return most === undefined ? schema : { ...schema, maximum: Math.min(most, highest(schema)) }; };
    const common = () => { const all = paths.map((one) => this.value(one, schema)); return all.every((one) => one === all[0]) ? all[0] : undefined; };
    if (!this.firsts.has(path)) this.firsts.set(path, this.value(paths[0], schema));
    const scaleNow = (value) => scaleOf(limits(), this.firsts.get(path), value);
    let scale = scaleNow(common()), held = false;
    const { factor, unit } = readIn(schema.unit), name = `${label.textContent ?? label} ${unit}`.trim();
    const slider = el("input", { type: "range", min: 0, max: 1, step: 0.001, "aria-label": `${name}, slider` });
    const box = el("input", { type: "number", step: "any", "aria-label": name });
    const write = (value) => { box.value = short(factor * value, schema); slider.setAttribute("aria-valuetext", `${box.value} ${unit}`); };
    const show = (refused) => {
      const value = common() ?? null;
      if (held || (!refused && this.sending(path))) return;
      if (refused || document.activeElement !== box) { if (value === null) box.value = ""; else write(value); }
      scale = scaleNow(value ?? this.value(paths[0], schema));
      slider.value = value === null && paths.length === 1 ? 0 : scale.to(value ?? this.value(paths[0], schema));
    };
    slider.oninput = () => {
      held = true;
      let value = Number(short(scale.from(Number(slider.value)), schema));
      value = Math.min(highest(limits()), Math.max(lowest(schema), value));
      write(value);
      this.send(path, value, paths);
    };
    slider.onchange = () => { held = false; if (!this.sending(path)) show(true); };
    box.onchange = () => {
      const value = box.value === "" ? null : Number((Number(box.value) / factor).toPrecision(12));
      this.send(path, value, paths);
    };
    if (paths.length > 1) box.placeholder = "differ";
    this.listen(path, show);
    return this.row(path, schema, label, slider, box);
  }

  choice(path, schema, label, choices) {
    const select = el("select", { "aria-label": label, onchange: () => (this.instead?.(path, select.value) || this.send(path, select.value)) }, ...choices.map((one) => el("option", { value: one }, String(one).replaceAll("_", " "))));
    this.listen(path, () => { select.value = this.value(path, schema) ?? choices[0]; });
    return this.row(path, schema, label, select);
  }

  toggle(path, schema, label) {
    const box = el("input", { type: "checkbox", "aria-label": label, onchange: () => this.send(path, box.checked) });
    this.listen(path, () => { box.checked = Boolean(this.value(path, schema)); });
    return this.row(path, schema, label, box);
  }

  text(path, schema, label) {
    const box = el("input", { type: "text", "aria-label": label, spellcheck: "false", onchange: () => this.send(path, box.value === "" ? null : box.value) });
    this.listen(path, (refused) => { if (refused || document.activeElement !== box) box.value = this.value(path, schema) ?? ""; });
    return this.row(path, schema, label, box);
  }

  /** Features by name: an unknown one is answered by the nearest, each a button that takes its place. */
  list(path, schema, label) {
    const known = this.model.about.known, hint = el("div", { class: "wide hints", role: "status" });
    const words = ({ symbol: sign, name, label: what }) => [symbol(sign), ` ${name}, ${what}`];
    const take = () => {
      const names = box.value.split(/[\s,]+/).filter(Boolean), strange = names.find((name) => !known.some((one) => one.name === name) && !/\d/.test(name));
      hint.replaceChildren();
      if (!strange) { this.send(path, names); return; }
      hint.append(el("span", {}, `${strange} is not known. The nearest: `), ...nearest(strange, known.map((one) => one.name)).map((name) => el("button", { type: "button", class: "quiet", "data-name": name, onclick: () => {
        box.value = names.map((one) => (one === strange ? name : one)).join(", ");
        take();
      } }, ...words(known.find((one) => one.name === name)))));
    };
    const box = el("input", { type: "text", "aria-label": `${label}, names with commas`, spellcheck: "false", onchange: take });
    this.listen(path, (refused) => { if (refused || (document.activeElement !== box && !hint.firstChild)) box.value = (this.value(path, schema) || this.model.about.features.map(({ name }) => name)).join(", "); });
    const row = this.row(path, schema, label, box);
    row.append(hint, el("details", { class: "section wide" }, el("summary", {}, el("small", {}, "known features")), el("ul", { class: "known" }, ...known.map((one) => el("li", {}, ...words(one))))));
    return row;
  }

  numbers(path, schema, label) {
    const { factor } = readIn(schema.unit);
    const boxes = Array.from({ length: schema.maxItems }, (_, i) => el("input", { type: "number", step: "any", "aria-label": `${label} ${i + 1}`, onchange: () => {
      const value = boxes.map((box) => Number((Number(box.value || 0) / factor).toPrecision(12)));
      this.send(path, value);
    } }));
    this.listen(path, (refused) => { const value = this.value(path, schema) || []; boxes.forEach((box, i) => { if (refused || document.activeElement !== box) box.value = value[i] === undefined ? "" : Number((factor * value[i]).toPrecision(6)); }); });
    return this.row(path, schema, label, el("span", { class: "numbers" }, ...boxes));
  }

  json(path, schema, label) {
    const box = el("textarea", { rows: 1, "aria-label": label, spellcheck: "false", onchange: () => {
      try { this.send(path, box.value.trim() === "" ? null : JSON.parse(box.value)); } catch (error) { this.fault(path, `${path}: found no JSON: ${error.message}`); }
    } });
    this.listen(path, (refused) => { if (refused || document.activeElement !== box) { const value = this.value(path, schema); box.value = value === undefined ? "" : JSON.stringify(value); } });
    return this.row(path, schema, label, box);
  }

  /** A section: its keys; of a table, an entry for each name that stands in it. */
  section(path, schema, label, open = false) {
    const body = el("div", { class: "body" }), toggle = el("input", { type: "checkbox" });
    const optional = schema.default === undefined && schema.properties && schema.required?.length && path.includes(".");
    const build = () => {
      const value = valueAt(this.model.values, path), keys = schema.properties ? Object.keys(schema.properties) : Object.keys(value || {});
      toggle.checked = value !== undefined;
      const names = [toggle.checked, ...keys].join();
      if (body.dataset.names === names) return;
      body.dataset.names = names;
      body.replaceChildren(...(optional ? [el("label", { class: "check" }, toggle, `with ${label}`)] : []), ...(toggle.checked || !optional ? keys : []).map((key) => this.make(`${path}.${key}`, schema.properties ? schema.properties[key] : schema.additionalProperties, key)));
    };
    toggle.onchange = () => this.send(path, toggle.checked ? Object.fromEntries((schema.required || []).map((key) => [key, start(schema.properties[key])])) : null);
    const details = el("details", { class: "section", open, title: schema.description || "" }, el("summary", {}, label), body);
    details.addEventListener("toggle", () => { if (details.open) this.listenOnce(path, build); });
    if (open) this.listenOnce(path, build);
    return details;
  }

  listenOnce(path, build) {
    if (build.listens) { build(); return; }
    build.listens = true;
    this.listen(path, build);
  }
}

/** A value to begin with, for a required key without default. */
const start = (schema) => {
  if (schema.default !== undefined) return schema.default;
  if (schema.enum) return schema.enum[0];
  if (schema.const !== undefined) return schema.const;
  if (schema.type === "array") return Array.from({ length: schema.minItems || 0 }, () => start(schema.items));
  if (schema.type === "number" || schema.type === "integer") {
    const low = lowest(schema), high = highest(schema);
    if (Number.isFinite(low) && Number.isFinite(high)) return (low + high) / 2;
    return Number.isFinite(low) ? low + 0.1 : Number.isFinite(high) ? high - 0.1 : 0;
  }
  return schema.properties ? Object.fromEntries((schema.required || []).map((key) => [key, start(schema.properties[key])])) : "";
};
export { start };
