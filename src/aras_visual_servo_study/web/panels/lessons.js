// Lessons: each sets a scene, asks a question, lets one thing be changed, and checks the answer against the run.
import { button, el, folding } from "../lib/dom.js";

const make = (page) => {
  const { model } = page, { card: box, body } = folding("Lessons", false, "predict and check");
  const fault = el("p", { role: "alert", class: "fault", hidden: true });
  const ask = (request) => page.ask(request).then(() => { fault.hidden = true; }, (error) => { fault.textContent = error.message; fault.hidden = false; });
  const which = el("select", { id: "lesson", "aria-label": "lesson" });
  const set = button("Set the scene", "Restart the run with the scenario of the lesson", () => ask({ do: "lesson", name: which.value }), { id: "lesson-set", class: "primary" });
  const leave = button("Leave", "Return to the previous scenario and restart the run", () => ask({ do: "lesson" }), { id: "lesson-leave" });
  const place = el("div", { class: "lesson" }), told = el("div", { class: "told", role: "status", id: "lesson-told" });
  let shown = "", change, answer, attempt;
  const lesson = () => model.about.lessons.find((one) => one.name === shown);
  const ready = () => { attempt.disabled = !model.state.lesson?.ready || model.state.lesson.running || !answer; };

  /** The scene, the question, and what a student chooses. */
  const build = () => {
    const one = lesson();
    place.replaceChildren();
    told.replaceChildren();
    if (!one) return;
    answer = "";
    change = el("select", { id: "lesson-change", "aria-label": "change" }, ...one.changes.map((label) => el("option", { value: label }, label)));
    attempt = button("Try it", "Run the scene with this change, and check the answer against the run", () => ask({ do: "try_lesson", change: change.value, answer }), { id: "lesson-try", class: "primary" });
    const choose = (key) => el("input", { type: "radio", name: "lesson-answer", value: key, onchange: () => { answer = key; ready(); } });
    place.append(el("p", {}, one.scene), el("p", {}, el("b", {}, one.question)),
      el("div", { class: "field" }, el("label", { for: "lesson-change" }, "change"), change),
      el("fieldset", {}, el("legend", {}, "prediction"), ...Object.entries(one.answers).map(([key, text]) => el("label", { class: "check" }, choose(key), text))), attempt);
  };
  const list = () => {
    const { lessons } = model.about, before = which.value;
    box.hidden = !lessons.length;
    which.replaceChildren(...lessons.map(({ name, title }, i) => el("option", { value: name }, `${i + 1}. ${title}`)));
    if (lessons.some(({ name }) => name === before)) which.value = before;
  };
  let last = "";
  const show = (state) => {
    const now = state.lesson, text = JSON.stringify(now || null);
    if (text === last) return;
    last = text;
    leave.disabled = !now;
    if ((now?.name || "") !== shown) {
      shown = now?.name || "";
      if (now) { which.value = now.name; box.open = true; }
      build();
    }
    if (!now) return;
    ready();
    const verdict = now.right === null ? "" : now.right ? "Yes. " : "No. ";
    told.dataset.right = String(now.right);
    told.replaceChildren(...(now.running ? [now.change ? `The run with ${now.change} is in progress. The check follows when the servo ends.` : "The first run is in progress. Watch it, then answer."]
      : [el("p", {}, el("b", {}, verdict), now.found && `${now.found} `, now.text)]));
  };
  body.append(which, el("div", { class: "line" }, set, leave), fault, place, told);
  model.on("about", list);
  model.on("state", show);
  list();
  if (model.state) show(model.state);
  return box;
};

export const panel = { place: "controls", order: 5, make };
