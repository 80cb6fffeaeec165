// What the page knows of the run, and who wants to hear of it: about, state, rows, image, goal, values, connection.
const MOST_ROWS = 18000;

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
    this.about = about;
    this.values = about.values;
    this.waiting = about.waiting;
    this.column = Object.fromEntries(about.rows.map((name, i) => [name, i]));
    this.rows = [];
    this.goal = null;
    this.emit("about", about);
    this.emit("rows", this.rows);
    this.emit("values", null);
  }

  values_are(values, waiting) {
    for (const [path, value] of Object.entries(values)) put(this.values, path, value);
    this.waiting = waiting;
    this.emit("values", Object.keys(values));
  }

  now_is(head, image) {
    const before = this.state;
    this.state = head.state;
    this.viewers = head.viewers;
    if (head.rows.length) {
      // Time that goes back is a run that began anew.
      if (this.rows.length && head.rows[head.rows.length - 1][0] < this.rows[this.rows.length - 1][0]) this.rows = [];
      for (const row of head.rows)
        if (!this.rows.length || row[0] >= this.rows[this.rows.length - 1][0]) this.rows.push(row); else this.rows = [row];
      if (this.rows.length > MOST_ROWS) this.rows.splice(0, this.rows.length - MOST_ROWS);
      this.emit("rows", this.rows);
    }
    if (before && before.taught && !head.state.taught) { this.goal = null; this.emit("goal", null); }
    this.emit("state", head.state);
    if (image) createImageBitmap(image).then((bitmap) => {
      this.image = { bitmap, marks: head.marks };
      this.emit("image", this.image);
    }).catch(() => {});
  }

  goal_is(head, image) {
    createImageBitmap(image).then((bitmap) => {
      this.goal = { bitmap, marks: head.marks, pose: head.pose };
      this.emit("goal", this.goal);
    }).catch(() => {});
  }
}
