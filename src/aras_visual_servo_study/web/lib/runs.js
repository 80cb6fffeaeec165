// The servos of this session, each with its rows and the moments that matter, also after a reset.
import { thinned } from "./model.js";

const MOST_RUNS = 20, MOST_ROWS = 3000, MOST_MARKS = 12;
const MARKED = { JOINT_LIMIT: "limit met", NEAR_SINGULARITY: "near singularity", OUT_OF_REACH: "out of reach", TARGET_LOST: "target lost", STALE_INPUT: "no input" };
const ENDED = { ...MARKED, CONVERGED: "converged", SETTLED: "settled", TIMED_OUT: "timed out", STOPPED: "stopped", STOPPED_BY_RULE: "stopped by rule", FAULT: "fault" };
/** A joint counts as being at its limit within this part of its way. */
const NEAR = 0.02;

/** The joint of a row that is nearest to a limit, if it is near, with a blank behind it. */
const limited = (about, column, row) => {
  let best = NEAR, found = "";
  for (const { name, lower, upper } of about.joints) {
    if (lower === null || upper === null) continue;
    const q = row[column[`q.${name}`]], part = Math.min(q - lower, upper - q) / (upper - lower);
    if (part < best) { best = part; found = `${name}: `; }
  }
  return found;
};

/** What tells one run from another: the law and its gains. */
const settings = (values) => {
  const gains = Object.values(values.servo.gains_per_s || {}), same = gains.every((gain) => gain === gains[0]);
  return `${values.servo.law}, gain ${same ? gains[0] : gains.join(", ")}`;
};

export class Runs {
  constructor(model) {
    this.model = model;
    this.all = [];
    this.now = null;
    this.count = 0;
    model.on("rows", (_, added) => { for (const row of added) this.take(row); });
    model.on("anew", () => this.leave());
    model.on("about", (about) => { if (this.names && this.names !== String(about.rows)) this.leave(); this.names = String(about.rows); });
  }

  take(row) {
    const { column, about, values } = this.model, servo = row[column.servo], status = about.statuses[row[column.status]];
    if (!this.now && !servo) return;
    if (!this.now) {
      // A page that was away is sent all rows again.
      const image = row[column.image];
      if (this.all.some((run) => run.images[0] <= image && image <= run.images[1] && Math.abs(run.from - row[0]) <= run.to - run.from)) return;
      this.now = { rows: [], column, about, settings: settings(values), number: ++this.count, from: row[0], to: row[0], images: [image, image], marks: [{ t: row[0], label: "began", kind: "began" }], status: "SERVOING", ended: false };
      this.all.push(this.now);
      if (this.all.length > MOST_RUNS) this.all.shift();
      this.last = "";
      this.model.emit("run", this.now);
    }
    const run = this.now;
    run.rows.push(row);
    if (run.rows.length > MOST_ROWS) run.rows = thinned(run.rows);
    run.to = row[0];
    run.images[1] = row[column.image];
    run.status = status;
    if (MARKED[status] && status !== this.last && run.marks.length < MOST_MARKS)
      run.marks.push({ t: row[0], kind: status, label: `${status === "JOINT_LIMIT" ? limited(about, column, row) : ""}${MARKED[status]}` });
    this.last = status;
    if (servo) return;
    run.marks.push({ t: row[0], label: ENDED[status] || "ended", kind: status });
    this.close();
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

  name(run) { return `run ${run.number}: ${run.settings}, ${run.ended ? ENDED[run.status] || "ended" : "servoing"}, ${(run.to - run.from).toFixed(1)} s`; }
}
