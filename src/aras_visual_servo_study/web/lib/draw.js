// What every plot needs: elements of a picture, round numbers for axes, and numbers as texts.
const NS = new DOMParser().parseFromString("<svg></svg>", "text/html").body.firstChild.namespaceURI;

export const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
export const minus = (text) => String(text).replace(/-(?=\d)/g, "−");

export const make = (name, attributes, parent, text) => {
  const node = document.createElementNS(NS, name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  parent?.appendChild(node);
  return node;
};

/** About `count` round values within [low, high], and their step. */
export const ticks = (low, high, count) => {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw)), values = [];
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= raw * (1 - 1e-9));
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) values.push(k * step);
  return { values, step };
};

export const tickText = (value, step) => {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return minus(digits < 6 ? value.toFixed(digits) : value.toExponential(1)).replace(/^−(0(\.0*)?)$/, "$1");
};
