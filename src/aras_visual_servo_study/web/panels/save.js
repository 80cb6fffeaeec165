// What stands there, as a scenario file.
import { button, download, el, folding, notice } from "../lib/dom.js";

const make = (page) => {
  const { card: box, body } = folding("Save as a scenario");
  const name = el("input", { type: "text", value: "live", "aria-label": "name", id: "save-name", spellcheck: "false" }), here = el("input", { type: "checkbox", id: "save-here" });
  const save = button("Save", "Download what stands here as a scenario file", async () => {
    try {
      const answer = await page.ask({ do: "save", name: name.value, start_here: here.checked });
      page.saved = answer.yaml;
      download(`${name.value}.yaml`, new Blob([answer.yaml], { type: "text/yaml" }));
      notice("save", "");
    } catch (error) { notice("save", error.message); }
  }, { id: "save" });
  body.append(el("div", { class: "field" }, el("label", {}, "name"), name),
    el("label", { class: "check" }, here, "the arm's position now becomes the start"),
    el("p", { class: "soft" }, "All settings as they stand, and the target where it is. Run it with ", el("code", {}, "rosrun aras_visual_servo_controller run FILE"), "."), save);
  return box;
};

export const panel = { place: "controls", order: 60, make };
