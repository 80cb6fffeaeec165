// Small helpers to make elements.
export const el = (name, attributes = {}, ...children) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key === "class") element.className = value;
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false && value !== undefined && value !== null) element.setAttribute(key, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
};

export const button = (text, title, onclick, more = {}) => el("button", { type: "button", title, onclick, ...more }, text);

/** A symbol such as "x_n" as it is set in a formula. */
export const symbol = (text) => {
  const [letter, below] = text.split(/_(.*)/);
  return el("i", { class: "symbol" }, letter, below ? el("sub", {}, below) : null);
};

/** The names nearest to one that is not known, at most `most`: by letters that differ, then by their order. */
export const nearest = (name, names, most = 4) => {
  const far = (a, b) => {
    let row = Array.from({ length: b.length + 1 }, (_, j) => j);
    for (let i = 1; i <= a.length; i++) row = row.reduce((next, _, j) => [...next, j === 0 ? i : Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1))], []);
    return row[b.length];
  };
  const lower = name.toLowerCase();
  return names.map((one) => ({ one, far: far(lower, one.toLowerCase()) + (one.toLowerCase().startsWith(lower) ? -0.5 : 0) })).sort((a, b) => a.far - b.far).slice(0, most).map(({ one }) => one);
};

/** A card with a head line; returns { card, head, body }. */
export const card = (title, kind = "") => {
  const head = el("div", { class: "head" }, el("h2", {}, title)), body = el("div", { class: "body" });
  return { card: el("section", { class: `card ${kind}` }, head, body), head, body };
};

/** A card that folds. */
export const folding = (title, open = false, hint = "") => {
  const body = el("div", { class: "body" });
  const details = el("details", { class: "card fold", open }, el("summary", {}, el("h2", {}, title), el("small", {}, hint)), body);
  return { card: details, body };
};

const notices = new Map();
/** Shows a line at the top of the page until it is taken back with an empty text. */
export const notice = (about, text) => {
  if (text) notices.set(about, text); else notices.delete(about);
  const line = document.querySelector("#notice");
  line.hidden = notices.size === 0;
  line.textContent = [...notices.values()].join(" · ");
};

export const download = (name, blob) => {
  const link = el("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};

export const isDark = () => {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
};

/** A colour made for white paper, light enough for a dark page. */
export const onPage = (colour) => {
  if (!isDark() || !/^#[0-9a-f]{6}$/i.test(colour)) return colour;
  const rgb = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  const light = (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) / 255, part = Math.max(0, 0.58 - light) / (1 - light);
  return `rgb(${rgb.map((x) => Math.round(x + (255 - x) * part)).join(", ")})`;
};
