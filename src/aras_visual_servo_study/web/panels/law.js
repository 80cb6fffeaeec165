// Law, features, gains and thresholds; below them every other setting of the servo.
import { button, el, folding, notice, symbol } from "../lib/dom.js";
import { Fields } from "../lib/fields.js";

const FIRST = ["law", "features"], TABLES = ["gains_per_s", "thresholds"];

const make = (page) => {
  const { model } = page, { card: box, body } = folding("Law and gains", true), fields = page.fields ||= new Fields(page);
  const offer = el("div", { class: "offer", role: "status", id: "offer" });
  const build = () => {
    const { properties } = model.about.schema.servo, at = (key) => `servo.${key}`;
    const law = model.values.servo.law, own = properties[law];
    body.replaceChildren(
      fields.make(at(FIRST[0]), properties.law), offer, fields.make(at(FIRST[1]), properties.features),
      ...TABLES.map((key) => el("div", { class: "table" }, el("h3", {}, key === "gains_per_s" ? "gains" : key), tableOf(fields, at(key), properties[key], page))),
      ...(own ? [el("div", { class: "table" }, el("h3", {}, `settings of ${law}`), ...Object.entries(own.properties).map(([key, one]) => fields.make(`servo.${law}.${key}`, one)))] : []));
  };
  /** A law that does not work on the features in place offers to take along those that it works on. */
  fields.instead = (path, law) => {
    const works = model.about.works_on[law], names = model.about.features.map(({ name }) => name);
    offer.replaceChildren();
    if (path !== "servo.law" || !works || String(works) === String(names)) return false;
    const leave = () => { offer.replaceChildren(); fields.refresh(["servo.law"]); };
    page.ask({ do: "offer", law }).then(({ features, values, reset }) => {
      const signs = features.flatMap((name, i) => [i ? ", " : "", symbol(model.about.known.find((one) => one.name === name)?.symbol || name)]);
      const more = Object.keys(values).filter((key) => !FIRST.map((one) => `servo.${one}`).includes(key));
      offer.replaceChildren(el("p", {}, `The law ${law} needs other features: `, ...signs, more.length ? `. It also needs ${more.join(", ")}` : "", reset ? ". This restarts the run." : "."),
        button(`Switch to ${features.length === 1 ? "this feature" : `these ${features.length} features`}`, "Set law and features together", () => page.ask({ do: "set", values, reset }).then(leave, (error) => { notice("offer", error.message); leave(); }), { id: "take-offer", class: "primary" }),
        button("Stay", "Keep law and features", leave));
    }, (error) => { offer.replaceChildren(el("p", {}, error.message)); fields.refresh(["servo.law"]); });
    return true;
  };
  model.on("about", build);
  build();
  return box;
};

/** A row for each feature: its symbol, what it is, and the unit in which people read it. */
const tableOf = (fields, path, schema, page) => {
  const table = path.split(".")[1];
  const names = Object.keys(page.model.values.servo[table]), all = { ...schema.additionalProperties, unit: schema.unit, description: "One gain for all features" };
  return el("div", {}, table === "gains_per_s" && names.length > 1 ? fields.number(path, all, "all gains", names.map((name) => `${path}.${name}`)) : null, ...names.map((name) => {
    const feature = page.model.about.features.find((one) => one.name === name);
    const unit = table === "thresholds" && feature ? feature.unit : schema.unit, label = feature ? el("span", {}, symbol(feature.symbol)) : name;
    return fields.make(`${path}.${name}`, { ...schema.additionalProperties, unit, description: feature ? `${feature.label}. ${schema.description}` : schema.description }, label);
  }));
};

export const panel = { place: "controls", order: 10, make };
