// Every setting of the scenario, made from its schema: a new key or law appears here by itself.
import { el, folding } from "../lib/dom.js";
import { Fields } from "../lib/fields.js";

const SECTIONS = ["servo", "experiment", "vision", "sim"];

const make = (page) => {
  const { card: box, body } = folding("All settings"), fields = page.fields ||= new Fields(page);
  body.append(el("p", { class: "soft" }, "Settings of servo and experiment apply at once. Settings that need a Reset are marked."));
  for (const name of SECTIONS) body.append(fields.section(name, page.model.about.schema[name], name));
  return box;
};

export const panel = { place: "controls", order: 70, make };
