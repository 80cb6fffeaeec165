// What stands there, as a scenario file.
import { button, download, el, folding, notice } from "../lib/dom.js";

const make = (page) => {
  const { card: box, body } = folding("Save as a scenario");
  const name = el("input", { type: "text", value: "live", "aria-label": "name", id: "save-name", spellcheck: "false" }), here = el("input", { type: "checkbox", id: "save-here" });
  const save = button("Save", "Download the current settings as a scenario file", async () => {
    try {
      const answer = await page.ask({ do: "save", name: name.value, start_here: here.checked });
      page.saved = answer.yaml;
      download(`${name.value}.yaml`, new Blob([answer.yaml], { type: "text/yaml" }));
      notice("save", "");
    } catch (error) { notice("save", error.message); }
  }, { id: "save" });
  body.append(el("div", { class: "field" }, el("label", {}, "name"), name),
    el("label", { class: "check" }, here, "use the arm's current position as the start"),
    el("p", { class: "soft" }, "The file has all current settings and the target's place. Run it with ", el("code", {}, "aras-servo run FILE"), "."), save);
  return box;
};

export const panel = { place: "controls", order: 60, make };
