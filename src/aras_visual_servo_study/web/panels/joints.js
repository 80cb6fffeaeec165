// Joints by hand, while nothing is servoed.
import { el, folding, notice } from "../lib/dom.js";
import { readIn } from "../lib/units.js";

const make = (page) => {
  const { model } = page, { card: box, body } = folding("Joints by hand"), note = el("p", { class: "soft" });
  let rows = [];
  const build = (about) => {
    rows = about.joints.map((joint, i) => {
      const low = joint.lower ?? -Math.PI, high = joint.upper ?? Math.PI;
      const slider = el("input", { type: "range", min: low, max: high, step: (high - low) / 1000, "aria-label": joint.name, "data-joint": joint.name }), output = el("output");
      const read = readIn(about.robot.joints.find(({ name }) => name === joint.name)?.type === "prismatic" ? "m" : "rad");
      let held = false, sent = 0;
      const send = (always) => {
        if (!always && performance.now() - sent < 50) return;
        sent = performance.now();
        page.ask({ do: "joint", name: joint.name, position: Number(slider.value) }).then(() => notice("joint", "")).catch((error) => { notice("joint", error.message); setTimeout(() => notice("joint", ""), 8000); });
      };
      slider.oninput = () => { held = true; send(false); };
      slider.onchange = () => { send(true); held = false; };
      return { i, slider, output, show: (state, quiet) => {
        slider.disabled = !quiet;
        if (!held && document.activeElement !== slider) slider.value = state.q[i];
        output.textContent = `${(read.factor * state.q[i]).toFixed(1).replace("-", "−")} ${read.unit}`;
        slider.setAttribute("aria-valuetext", output.textContent);
      }, field: el("div", { class: "field" }, el("label", {}, joint.name), slider, output) };
    });
    body.replaceChildren(note, ...rows.map((row) => row.field));
    note.textContent = "The joint moves at a fifth of its maximum speed. Stop the servo first.";
  };
  model.on("about", build);
  model.on("state", (state) => { if (box.open) rows.forEach((row) => row.show(state, state.phase === "idle" || state.phase === "done")); });
  build(model.about);
  return box;
};

export const panel = { place: "controls", order: 40, make };
