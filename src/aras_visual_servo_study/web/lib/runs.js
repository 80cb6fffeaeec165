// The servos of this session, each with its rows and the moments that matter, also after a reset.
import { thinned, valueAt } from "./model.js";
import { keyWords, readIn } from "./units.js";

const MOST_RUNS = 20, MOST_ROWS = 3000, MOST_MARKS = 20, MOST_TIMES = 50, MOST_NAMED = 5;
const MARKED = { NEAR_SINGULARITY: "near singularity", OUT_OF_REACH: "out of reach", TARGET_LOST: "target lost", STALE_INPUT: "no input" };
const ENDED = { ...MARKED, JOINT_LIMIT: "joint limit", CONVERGED: "converged", SETTLED: "settled", TIMED_OUT: "timed out", STOPPED: "stopped", STOPPED_BY_RULE: "stopped by rule", FAULT: "fault" };
/** A servo that ends so with its first image has no row of its own, and is a run all the same. */
const AT_ONCE = ["FAULT", "TARGET_LOST"];
/** A joint nearer than this to the end of its way is at its limit, and has left it when it is farther away [m, rad]. */
const AT_LIMIT = 0.005, OFF_LIMIT = 0.02;

/** [lower, upper] within which the servo keeps a joint: its limits less the margin; null: it has none. */
export const kept = ({ lower, upper }, margin) => (lower === null || upper === null ? null : [lower + margin, upper - margin]);

/** The margin that the servo keeps to the limits of the joints [m, rad]. */
export const marginOf = (model) => valueAt(model.values, "servo.joint_limit_margin") ?? model.about.schema.servo.properties.joint_limit_margin.default;

const schemaAt = (about, path) => path.split(".").reduce((node, key) => node && (node.properties?.[key] || (/^\d+$/.test(key) && node.items) || node.additionalProperties || null), { properties: about.schema });

/** { path: value } of all settings, a list of plain values as one. */
const flat = (node, path = "", found = {}) => {
  const inner = node && typeof node === "object" && !(Array.isArray(node) && node.every((one) => typeof one !== "object"));
  if (!inner) found[path] = node;
  else for (const [key, value] of Object.entries(node)) flat(value, path ? `${path}.${key}` : key, found);
  return found;
};

/** What a setting is called: its key, before it the name of its table, and the number of its camera or model. */
const words = (about, path) => {
  const keys = path.split("."), key = keyWords(keys.pop()), table = schemaAt(about, keys.join("."));
  if (table && !table.properties && table.additionalProperties) return `${keyWords(keys.pop()).replace(/s$/, "")} ${key}`;
  const number = Number(keys[keys.length - 1]);
  return number > 0 ? `${key} of ${keys[keys.length - 2].replace(/s$/, "")} ${number + 1}` : key;
};

const text = (schema, value) => {
  if (value === undefined || value === null) return "none";
  const { factor, unit } = readIn(schema?.unit && schema.unit !== "-" ? schema.unit : ""), one = (x) => (typeof x === "number" ? Number((factor * x).toPrecision(4)) : x);
  return `${Array.isArray(value) ? value.map(one).join(", ") : one(value)}${unit ? ` ${unit}` : ""}`;
};

/** A value at the beginning, and at the end where it was changed meanwhile. */
const change = (before, after) => (before === after ? before : `${before} → ${after}`);

const gains = (values) => {
  const all = Object.values(values.servo.gains_per_s || {});
  return all.every((gain) => gain === all[0]) ? String(all[0]) : all.join(", ");
};

export class Runs {
  constructor(model) {
    this.model = model;
    this.all = [];
    this.now = null;
    this.count = 0;
    this.last = "";
    this.begun = [];   // what the run says of the beginning of each servo: { image, values, after }
    model.on("rows", (_, added) => { for (const row of added) this.take(row); });
    model.on("anew", () => this.leave());
    model.on("about", (about) => { if (this.names && this.names !== String(about.rows)) this.leave(); this.names = String(about.rows); });
    model.on("servo", (message) => this.told(message));
  }

  take(row) {
    const { column, about } = this.model, servo = row[column.servo], status = about.statuses[row[column.status]], before = this.last;
    this.last = status;
    if (!this.now) {
      const begun = this.begun.findLast((one) => one.image <= row[column.image]) || null;   // the first rows may have been thinned away
      if (!servo && (!AT_ONCE.includes(status) || before === "" || !begun || begun.known)) return;
      // A page that was away is sent all rows again.
      const image = row[column.image];
      if (this.all.some((run) => run.images[0] <= image && image <= run.images[1] && Math.abs(run.from - row[0]) <= run.to - run.from)) return;
      if (begun) begun.known = true;
      this.now = { rows: [], column, about, begun, margin: marginOf(this.model), number: ++this.count, from: row[0], to: row[0], images: [image, image], marks: [], status: "SERVOING", ended: false, told: "", at: new Set() };
      this.mark(row[0], "began", "began");
      this.all.push(this.now);
      this.found = null;
      if (this.all.length > MOST_RUNS) this.all.shift();
      this.model.emit("run", this.now);
    }
    const run = this.now;
    run.rows.push(row);
    if (run.rows.length > MOST_ROWS) run.rows = thinned(run.rows);
    run.to = row[0];
    run.images[1] = row[column.image];
    run.status = status;
    this.limits(row);
    const limited = row[column.limited] === null ? "" : about.joints[row[column.limited]].name;
    const told = status !== "JOINT_LIMIT" ? MARKED[status] || "" : !limited ? "held back by limits" : run.at.has(limited) ? "" : `${limited}: slowed before its limit`;
    if (servo && told && told !== run.told) this.mark(row[0], status, told);
    run.told = told;
    if (servo) return;
    this.mark(row[0], status, MARKED[status] || status === "JOINT_LIMIT" ? `ended, ${ENDED[status]}` : ENDED[status] || "ended");
    this.close();
  }

  /** Takes in the settings with which a servo began, or ended. They come before the rows of that moment. */
  told({ image, values, after }) {
    this.found = null;
    if (values) this.begun = [...this.begun.filter((one) => one.image < image), { image, values, after: values }].slice(-MOST_RUNS);
    else for (const one of [...this.begun, ...this.all.map(({ begun }) => begun)]) if (one?.image === image) one.after = after;
  }

  /** Marks the joints that meet their limits, whatever the status says: the joint alone tells that. */
  limits(row) {
    const { at, about, column, margin } = this.now;
    for (const joint of about.joints) {
      const ends = kept(joint, margin), q = row[column[`q.${joint.name}`]];
      if (!ends || q === null) continue;
      const left = Math.min(q - ends[0], ends[1] - q);
      if (left < AT_LIMIT && !at.has(joint.name)) {
        at.add(joint.name);
        this.mark(row[0], "JOINT_LIMIT", `${joint.name}: limit met`);
      } else if (left > OFF_LIMIT) at.delete(joint.name);
    }
  }

  /** A moment of the run; one that comes again is another time of the same mark. */
  mark(t, kind, label) {
    const { marks } = this.now, same = marks.find((one) => one.label === label);
    if (!same) { if (marks.length < MOST_MARKS) marks.push({ t, kind, label, times: [t] }); } else if (same.times.length < MOST_TIMES) same.times.push(t);
  }

  /** Time has begun anew, or its rows mean something else: what was before stands for itself. */
  leave() {
    this.close();
    for (const run of this.all) run.left = true;
  }

  close() {
    const run = this.now;
    this.now = null;
    if (!run) return;
    run.ended = true;
    this.model.emit("run", run);
  }

  /** The settings in which the runs differ, beside law and gains, by path. */
  differences() {
    if (this.found) return this.found;
    const all = this.all.filter((run) => run.begun).flatMap(({ begun: { values, after } }) => [flat(values), ...(after === values ? [] : [flat(after)])]);
    const paths = new Set(all.flatMap((one) => Object.keys(one)));
    this.found = [...paths].filter((path) => !/^(name|description|servo\.law|servo\.gains_per_s\..*)$/.test(path) && all.some((one) => String(one[path]) !== String(all[0][path])));
    return this.found;
  }

  name(run) {
    return [`run ${run.number}: ${run.ended ? ENDED[run.status] || "ended" : "servoing"} ${(run.to - run.from).toFixed(1)} s`, ...(run.begun ? [this.words(run)] : [])].join(", ");
  }

  /** Law and gains of a run, and what tells it from the others. */
  words(run) {
    const { begun: { values, after }, about } = run, named = [change(values.servo.law, after.servo.law), `gain ${change(gains(values), gains(after))}`];
    let more = this.differences();
    if (more.some((path) => path.startsWith("experiment.start."))) named.push(`start of run ${this.starts(run)}`);
    more = more.filter((path) => !path.startsWith("experiment.start."));
    for (const path of more.slice(0, MOST_NAMED)) {
      const schema = schemaAt(about, path), at = (from) => text(schema, valueAt(from, path) ?? schema?.default);
      named.push(`${words(about, path)} ${change(at(values), at(after))}`);
    }
    if (more.length > MOST_NAMED) named.push(`${more.length - MOST_NAMED} more settings`);
    return named.join(", ");
  }

  /** The number of the first run that began where this one did. */
  starts(run) {
    const start = (one) => JSON.stringify(one.begun?.values.experiment?.start ?? null);
    return this.all.find((one) => start(one) === start(run)).number;
  }
}
