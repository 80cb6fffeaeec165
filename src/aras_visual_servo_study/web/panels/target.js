// The target: where it is, and a motion for it.
import { button, el, folding, notice } from "../lib/dom.js";
import { kindOf, start } from "../lib/fields.js";
import { keyWords, readIn } from "../lib/units.js";

const make = (page) => {
  const { model } = page, { card: box, body } = folding("Target", true);
  const ask = (request) => page.ask(request).then(() => notice("target", "")).catch((error) => { notice("target", error.message); setTimeout(() => notice("target", ""), 8000); });
  const build = (about) => {
    if (!about.target) { body.replaceChildren(el("p", { class: "soft" }, "The scene has no target.")); return; }
    const where = el("p", { class: "numbers-line", id: "target-at" });
    // Along the target's own axes: x and y lie in its plane.
    const nudge = (dx, dy, turn) => {
      const pose = model.state?.target;
      if (!pose) return;
      const q = pose.slice(3), moved = rotate(q, [dx, dy, 0]).map((x, i) => x + pose[i]);
      ask({ do: "place_target", position_m: moved, q_xyzw: times(q, [0, 0, Math.sin(turn / 2), Math.cos(turn / 2)]) });
    };
    const pad = el("div", { class: "pad" }, button("↺", "Rotate by 5 deg", () => nudge(0, 0, Math.PI / 36)), button("↑", "10 mm along its y", () => nudge(0, 0.01, 0)), button("↻", "Rotate by −5 deg", () => nudge(0, 0, -Math.PI / 36)),
      button("←", "−10 mm along its x", () => nudge(-0.01, 0, 0)), button("↓", "−10 mm along its y", () => nudge(0, -0.01, 0)), button("→", "10 mm along its x", () => nudge(0.01, 0, 0)));
    model.on("state", (state) => {
      if (state.target) where.textContent = `x ${(1e3 * state.target[0]).toFixed(1)}   y ${(1e3 * state.target[1]).toFixed(1)}   z ${(1e3 * state.target[2]).toFixed(1)} mm`;
    });
    const kinds = about.schema.sim.properties.scene.properties.models.items.properties.motion.oneOf;
    const choice = el("select", { id: "motion", "aria-label": "motion of the target", onchange: () => fill() }, el("option", { value: "" }, "at rest"), ...kinds.map((kind) => el("option", { value: kind.properties.type.const }, kind.properties.type.const.replaceAll("_", " "))));
    const form = el("div", { class: "form" });
    const fill = () => {
      const kind = choice.value && kindOf(kinds, { type: choice.value });
      form.replaceChildren(...(kind ? Object.entries(kind.properties).filter(([key]) => key !== "type").map(([key, schema]) => {
        const first = GOOD[choice.value]?.[key] ?? start(schema), { factor, unit } = readIn(schema.unit);
        const input = el("input", { type: "text", value: JSON.stringify(scaled(first, factor)), "data-key": key, "data-factor": factor, spellcheck: "false", "aria-label": `${keyWords(key)} ${unit}` });
        return el("div", { class: "field", title: schema.description }, el("label", {}, keyWords(key), unit ? el("small", {}, ` ${unit}`) : ""), input);
      }) : []));
    };
    const give = button("Start this motion", "Move the target from its current place", () => {
      if (!choice.value) { ask({ do: "move_target", motion: null }); return; }
      const motion = { type: choice.value };
      try {
        for (const input of form.querySelectorAll("input")) motion[input.dataset.key] = scaled(JSON.parse(input.value), 1 / Number(input.dataset.factor));
      } catch (error) { notice("target", `motion: found no JSON: ${error.message}`); return; }
      ask({ do: "move_target", motion });
    }, { id: "give-motion" });
    body.replaceChildren(where, pad, el("h3", {}, "motion"), el("div", { class: "line" }, choice, give), form);
    fill();
  };
  let target;
  model.on("about", (about) => { if (about.target !== target) build(about); target = about.target; });
  target = model.about.target;
  build(model.about);
  return box;
};

/** A number, or a list of them, times a factor; anything else as it is. */
const scaled = (value, factor) => (factor === 1 ? value : Array.isArray(value) ? value.map((one) => scaled(one, factor)) : typeof value === "number" ? Number((factor * value).toPrecision(9)) : value);

/** Motions that one sees and a servo can follow. */
const GOOD = {
  constant_velocity: { linear_m_per_s: [0.01, 0, 0] },
  circle: { radius_m: 0.05, angular_speed_rad_per_s: 0.8 },
  random_walk: { interval_s: 0.5, speed_stddev_m_per_s: [0.03, 0.03, 0], radius_m: 0.08 },
  waypoints: { waypoints: [{ time_s: 0, position_m: [0, 0, 0.2] }, { time_s: 4, position_m: [0.05, 0.05, 0.2] }] },
};
const times = ([x1, y1, z1, w1], [x2, y2, z2, w2]) => [w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2, w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
  w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2, w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2];
const rotate = (q, [x, y, z]) => times(times(q, [x, y, z, 0]), [-q[0], -q[1], -q[2], q[3]]).slice(0, 3);

export const panel = { place: "controls", order: 20, make };
