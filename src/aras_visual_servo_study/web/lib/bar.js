// The head of the page: what runs, how it is, and the buttons that everybody needs.
import { button, el, isDark, notice } from "./dom.js";

const SPEEDS = [[0.1, "0.1 ×"], [0.25, "0.25 ×"], [0.5, "0.5 ×"], [1, "1 ×"], [2, "2 ×"], [5, "5 ×"], [0, "fastest"]];

export const bar = (page, place) => {
  const { model } = page;
  const act = (request) => () => page.ask(request)
    .then(() => notice("action", ""))
    .catch((error) => { notice("action", error.message); setTimeout(() => notice("action", ""), 8000); });
  const servo = (reference) => () => { page.shared.toNow?.(); return act({ do: "start", reference })(); };   // whoever begins a servo wants to see it
  const name = el("h1");
  const pause = button("Pause", "Pause or continue simulated time (space)", () => act({ do: "pause", paused: !model.state?.paused })(), { id: "pause" });
  const step = button("Step", "Advance by one image", act({ do: "step" }), { id: "step" });
  const speed = el("select", { title: "Simulated time per wall time", "aria-label": "simulated time per wall time", id: "speed", onchange: () => act({ do: "speed", factor: Number(speed.value) })() },
    ...SPEEDS.map(([value, label]) => el("option", { value }, label)));
  const follow = el("input", { type: "checkbox", id: "follow", onchange: () => act({ do: "follow", follow: follow.checked })() });
  const theme = button("◐", "Light or dark", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    try { localStorage.setItem("theme", document.documentElement.dataset.theme); } catch { /* a private window */ }
    model.emit("theme");
  }, { class: "quiet", id: "theme", "aria-label": "light or dark" });
  try { const kept = localStorage.getItem("theme"); if (kept) document.documentElement.dataset.theme = kept; } catch { /* as above */ }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => model.emit("theme"));
  const buttons = {
    start: button("Run all", "Drive to the goal, teach it, drive to the start, servo", servo("experiment"), { class: "primary", id: "start" }),
    servo: button("Servo from here", "Servo from the current place to the taught goal", servo("taught"), { id: "servo" }),
    stop: button("Stop", "Stop the arm", act({ do: "stop" }), { id: "stop" }),
    teach: button("Teach here", "Make this view the goal", act({ do: "teach" }), { id: "teach" }),
    reset: button("Reset", "Restart with the current settings", act({ do: "reset" }), { id: "reset" }),
  };
  const clock = el("span", { class: "clock" });
  place.append(
    name,
    el("div", { class: "buttons" }, buttons.start, buttons.servo, buttons.stop, buttons.teach, el("i"), pause, step, speed, el("i"), buttons.reset,
      el("label", { class: "check", title: "Restart the servo when the target moves after its end" }, follow, "follow the target")),
    theme);
  page.clock = clock;
  model.on("about", (about) => {
    name.textContent = about.scenario;
    name.title = about.description;
    document.title = `${about.scenario}, live`;
  });
  model.on("state", (state) => {
    const quiet = state.phase === "idle" || state.phase === "done";
    buttons.stop.disabled = quiet;
    buttons.servo.disabled = !state.taught;
    buttons.teach.disabled = !quiet;
    pause.textContent = state.paused ? "Continue" : "Pause";
    step.disabled = !state.paused;
    if (![...speed.options].some((one) => one.value === String(state.speed))) speed.append(el("option", { value: state.speed }, `${state.speed} ×`));
    if (document.activeElement !== speed) speed.value = String(state.speed);
    follow.checked = state.follow;
    clock.textContent = `${state.t.toFixed(2)} s · ${state.factor.toFixed(state.factor < 10 ? 2 : 0)} ×${model.viewers > 1 ? ` · ${model.viewers} viewers` : ""}`;
  });
  addEventListener("keydown", (event) => {
    if (event.key !== " " || event.target.closest("input, select, textarea, button, summary, [tabindex]")) return;
    event.preventDefault();
    pause.click();
  });
};
