// Law, features, gains and thresholds; below them every other setting of the servo.
import { el, folding } from "../lib/dom.js";
import { Fields } from "../lib/fields.js";

const FIRST = ["law", "features"], TABLES = ["gains_per_s", "thresholds"];

const make = (page) => {
  const { card: box, body } = folding("Law and gains", true), fields = page.fields ||= new Fields(page);
  const build = () => {
    const { properties } = page.model.about.schema.servo, at = (key) => `servo.${key}`;
    const law = page.model.values.servo.law, own = properties[law];
    body.replaceChildren(
      ...FIRST.map((key) => fields.make(at(key), properties[key])),
      ...TABLES.map((key) => el("div", { class: "table" }, el("h3", {}, key === "gains_per_s" ? "gains" : key), tableOf(fields, at(key), properties[key], page))),
      ...(own ? [el("div", { class: "table" }, el("h3", {}, `settings of ${law}`), ...Object.entries(own.properties).map(([key, one]) => fields.make(`servo.${law}.${key}`, one)))] : []));
  };
  page.model.on("about", build);
  build();
  return box;
};

const tableOf = (fields, path, schema, page) =>
  el("div", {}, ...Object.keys(page.model.values.servo[path.split(".")[1]]).map((name) => fields.make(`${path}.${name}`, { ...schema.additionalProperties, unit: schema.unit, description: schema.description }, name)));

export const panel = { place: "controls", order: 10, make };
