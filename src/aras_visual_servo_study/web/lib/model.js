// What the page knows of the run, and who wants to hear of it: about, state, rows, image, goal, values, connection.
// "shown" and "picture" are what views draw: the newest, or the chosen moment of the past.
const MOST_ROWS = 18000;
const CAMERA = ["x", "y", "z", "camera.qx", "camera.qy", "camera.qz", "camera.qw"], TARGET = ["x", "y", "z", "qx", "qy", "qz", "qw"].map((name) => `target.${name}`);

/** The older half of rows in even steps of time, half as many, and the newer half as it is: the whole session stays. */
export const thinned = (rows) => {
  const half = rows.length >> 1, step = 2 * (rows[half][0] - rows[0][0]) / half;
  let last = -Infinity;
  return rows.filter((row, i) => { if (i < half && row[0] - last < step) return false; last = row[0]; return true; });
};

/** The place of the last row at or before a time, 0 if there is none. */
export const placeAt = (rows, t) => {
  let a = 0, b = rows.length;
  while (a < b) { const m = (a + b) >> 1; if (rows[m][0] <= t) a = m + 1; else b = m; }
  return Math.max(0, a - 1);
};

export const valueAt = (values, path) => path.split(".").reduce((node, key) => (node === null || node === undefined ? undefined : node[key]), values);

const put = (values, path, value) => {
  const keys = path.split("."), last = keys.pop();
  const node = keys.reduce((at, key) => (at[key] ??= {}), values);
  if (value === null && !Array.isArray(node)) delete node[last]; else node[last] = value;
};

export class Model {
  constructor() {
    this.listeners = new Map();
    this.rows = [];
    this.column = {};
    this.ends = {};
    this.past = null;
  }

  on(event, listener) {
    if (!this.listeners.has(event)) this.listeners.set(event, []);
    this.listeners.get(event).push(listener);
  }

  emit(event, ...values) { for (const listener of this.listeners.get(event) || []) listener(...values); }

  /** A promise of the first time that something is known. */
  first(event) {
    return this[event] ? Promise.resolve(this[event]) : new Promise((resolve) => { this.on(event, resolve); });
  }

  about_is(about) {
    const same = this.about && String(this.about.rows) === String(about.rows);
    this.about = about;
    this.values = about.values;
    this.waiting = about.waiting;
    this.ends = about.ends;
    this.column = Object.fromEntries(about.rows.map((name, i) => [name, i]));
    if (!same) this.rows = [];
    this.goal = null;
    this.emit("about", about);
    this.emit("rows", this.rows, []);
    this.emit("values", null);
  }

  values_are(values, waiting, ends = this.ends) {
    this.ends = ends;
    for (const [path, value] of Object.entries(values)) put(this.values, path, value);
    this.waiting = waiting;
    this.emit("values", [...Object.keys(values), ...Object.keys(ends)]);   // what is set may move the end of another one
  }

  now_is(head, image) {
    const before = this.state;
    this.state = head.state;
    this.viewers = head.viewers;
    if (head.rows.length) {
      // Time that goes back is a run that began anew.
      let last = this.rows.length ? this.rows[this.rows.length - 1][0] : -Infinity;
      for (const row of head.rows) {
        if (row[0] < last) { this.rows = []; this.emit("anew"); }
        this.rows.push(row);
        last = row[0];
      }
      if (this.rows.length > MOST_ROWS) this.rows = thinned(this.rows);
      this.emit("rows", this.rows, head.rows);
    }
    if (before && before.taught && !head.state.taught) { this.goal = null; this.emit("goal", null); }
    this.emit("state", head.state);
    if (!this.past) this.emit("shown", head.state);
    if (image) createImageBitmap(image).then((bitmap) => {
      this.image = { bitmap, marks: head.marks };
      this.emit("image", this.image);
      if (!this.past) this.emit("picture", this.image);
    }).catch(() => {});
  }

  /** Goes back to a time of some rows, { rows, column, about, t, zero }, zero: from which its time is told; null: to what is now. */
  seek(past) {
    this.past = past;
    this.emit("past", past);
    if (!past) {
      if (this.state) this.emit("shown", this.state);
      if (this.image) this.emit("picture", this.image);
      return;
    }
    const { rows, column, about, t } = past, row = rows[placeAt(rows, t)], pose = (names) => { const found = names.map((name) => row[column[name]]); return found.includes(null) ? null : found; };
    this.emit("shown", { t: row[0], q: about.joints.map((joint) => row[column[`q.${joint.name}`]]), camera: pose(CAMERA), target: pose(TARGET) });
    this.wanted = row[column.image];
    this.fetch();
  }

  /** Gets the picture of the past that is wanted: one at a time, and then the newest wish. */
  async fetch() {
    if (this.fetching) return;
    this.fetching = true;
    try {
      for (let got = null; this.past && got !== this.wanted;) {
        got = this.wanted;
        const answer = await fetch(`picture/${got}`);
        if (!answer.ok) break;   // there were no viewers then
        const data = await answer.arrayBuffer(), size = new DataView(data).getUint32(0, true);
        const bitmap = await createImageBitmap(new Blob([new Uint8Array(data, 4 + size)], { type: "image/jpeg" }));
        if (this.past) this.emit("picture", { bitmap, ...JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size))) });
      }
    } catch { /* the run cannot be reached, which the page says */ } finally { this.fetching = false; }
  }

  goal_is(head, image) {
    createImageBitmap(image).then((bitmap) => {
      this.goal = { bitmap, marks: head.marks, pose: head.pose };
      this.emit("goal", this.goal);
    }).catch(() => {});
  }
}
