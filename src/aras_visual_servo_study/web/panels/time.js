// Time: a slider over all that was kept, the runs of this session, one over another, and once more.
import { button, card, el, notice } from "../lib/dom.js";
import { statusKind } from "../lib/why.js";

const SLOW = 0.1;
const PLAY_MS = 40;

const make = (page) => {
  const { model, runs, shared } = page, { card: box, head, body } = card("Time", "time");
  const act = (work) => () => { shared.toNow(); return work().then(() => notice("again", "")).catch((error) => { notice("again", error.message); setTimeout(() => notice("again", ""), 8000); }); };
  const slider = el("input", { type: "range", id: "time", min: 0, max: 1, step: 0.01, "aria-label": "time in seconds: go back to a moment of the session" });
  const ticks = el("div", { class: "ticks", "aria-hidden": "true" }), output = el("output", { id: "time-at" }), unit = el("small", { id: "time-unit" }), marks = el("div", { class: "marks" });
  const play = button("▶", "Replay the selection", () => (playing ? stop() : begin()), { id: "play", "aria-label": "play" });
  const live = button("Live", "Return to the present", () => shared.toNow(), { id: "live-now" });
  const which = el("select", { id: "run", "aria-label": "run that slider and curves show", onchange: () => { stop(); const { past } = model; select(found(which.value)); if (past) seek(span()[0]); } });
  const over = el("select", { id: "over", "aria-label": "run to compare with, drawn dashed", onchange: () => { shared.over = found(over.value); page.redraw?.(); } });
  const again = button("Again", "Drive to the start and servo to the taught goal", act(() => page.ask({ do: "again" })), { id: "again" });
  const another = button("Another start", "The same from a random start, which is kept in the settings", act(async () => {
    const { start } = await page.ask({ do: "draw_start" });
    await page.ask({ do: "set", values: { "experiment.start": start } });
    await page.ask({ do: "again" });
  }), { id: "another" });
  const slow = button("Again, 0.1 ×", "The same, with the servo at a tenth of the speed", act(async () => { await page.ask({ do: "again" }); pace = "waits"; }), { id: "slow" });
  head.append(el("span", { class: "tools" }, again, another, slow));
  body.append(el("div", { class: "scrub" }, play, el("div", { class: "track" }, slider, ticks), output, live), unit, marks,
    el("div", { class: "choose" }, el("label", {}, el("span", {}, "show"), which), el("label", {}, el("span", {}, "compare with"), over)));

  const found = (value) => runs.all.find((run) => String(run.number) === value) || null;
  /** What is shown: a run, or the whole time line. */
  const source = () => (shared.run ? shared.run : { rows: model.rows, column: model.column, about: model.about });
  /** Where the times of what is shown begin to count: at its servo, or with simulated time. */
  const zero = () => (shared.run ? shared.run.from : 0);
  const span = () => { const { rows } = source(); return rows.length ? [rows[0][0], rows[rows.length - 1][0]] : [0, 0]; };
  const seek = (t) => { const { rows, column, about } = source(); if (rows.length) model.seek({ rows, column, about, t, zero: zero() }); };
  shared.seek = (t) => { const [from, to] = span(); stop(); seek(Math.max(from, Math.min(to, t))); };
  const select = (run) => { shared.run = run; shared.from = shared.to = null; list(); page.redraw?.(); };

  let playing = 0, pace = "";
  const stop = () => { clearInterval(playing); playing = 0; play.textContent = "▶"; play.setAttribute("aria-label", "play"); };
  const begin = () => {
    const [from, to] = span(), at = model.past && model.past.t < to - 0.05 ? model.past.t : from, since = performance.now();
    play.textContent = "❚❚";
    play.setAttribute("aria-label", "stop playing");
    playing = setInterval(() => { const t = at + 1e-3 * (performance.now() - since); seek(Math.min(t, to)); if (t >= to) stop(); }, PLAY_MS);
  };
  shared.toNow = () => { stop(); if (model.past) model.seek(null); };
  slider.oninput = () => { stop(); seek(Number(slider.value)); };

  let ticked = "";
  const show = () => {
    const [from, to] = span(), { past } = model;
    slider.min = from;
    slider.max = Math.max(to, from + 0.01);
    slider.value = past ? past.t : to;
    const at = past ? past.t : to;
    output.textContent = `${(at - zero()).toFixed(2)} s${past ? "" : shared.run ? ", end of run" : ", now"}`;
    slider.setAttribute("aria-valuetext", output.textContent);
    unit.textContent = shared.run ? "s since the servo began" : "s of simulated time";
    live.disabled = !past;
    box.classList.toggle("past", Boolean(past));
    const moments = runs.all.filter((run) => (shared.run ? run === shared.run : !run.left)).flatMap((run) => run.marks);
    const now = [from, (to - from).toFixed(shared.run ? 2 : 0), moments.length, moments.reduce((sum, { times }) => sum + times.length, 0), shared.run?.number].join();
    if (now === ticked) return;
    ticked = now;
    const look = (kind) => (kind === "began" ? "busy" : statusKind(kind));
    ticks.replaceChildren(...moments.flatMap(({ times, kind }) => times.map((t) => {
      const tick = el("i", { class: look(kind) });
      tick.style.left = `${100 * (t - from) / Math.max(to - from, 1e-9)}%`;
      return tick;
    })));
    // A moment that came several times is one button, which goes from one to the next.
    marks.replaceChildren(...(shared.run ? moments : moments.slice(-8)).map(({ t, times, kind, label }) => button(
      `${label} ${(t - zero()).toFixed(2)} s${times.length > 1 ? `, ${times.length} times` : ""}`, times.length > 1 ? `Go to the next: ${times.map((one) => (one - zero()).toFixed(2)).join(", ")} s` : "Go to this moment",
      () => shared.seek(times.find((one) => model.past && one > model.past.t + 1e-6) ?? t), { class: `quiet ${look(kind)}`, "data-kind": kind })));
  };
  const list = () => {
    const options = (first, mine) => [el("option", { value: "" }, first), ...runs.all.filter((run) => run !== mine).map((run) => el("option", { value: run.number }, runs.name(run))).reverse()];
    which.replaceChildren(...options("the whole time since the last reset", null));
    which.value = shared.run ? String(shared.run.number) : "";
    if (shared.over === shared.run || !runs.all.includes(shared.over)) shared.over = null;
    over.replaceChildren(...options("no other run", shared.run));
    over.value = shared.over ? String(shared.over.number) : "";
    over.disabled = !shared.run || runs.all.length < 2;
    ticked = "";
    show();
  };
  model.on("run", (run) => {
    if (!model.past) select(run.ended ? run : null); else list();
    if (pace === "waits" && !run.ended) { pace = model.state?.speed ?? 1; page.ask({ do: "speed", factor: SLOW }).catch(() => {}); }
    else if (run.ended && typeof pace === "number") { page.ask({ do: "speed", factor: pace }).catch(() => {}); pace = ""; }
  });
  model.on("past", (past) => { shared.at = past ? past.t : null; document.body.classList.toggle("past", Boolean(past)); show(); page.redraw?.(); });
  model.on("anew", () => { if (model.past && !shared.run) model.seek(null); });
  let shown = 0;
  model.on("rows", () => { if (performance.now() - shown > 150) { shown = performance.now(); show(); } });
  model.on("state", (state) => {
    again.disabled = slow.disabled = !state.taught;
    another.disabled = !state.taught || !model.about.draws_starts;
  });
  const last = runs.all[runs.all.length - 1];   // a page that is reloaded has them before this panel
  select(last?.ended && model.state?.phase === "done" ? last : null);
  return box;
};

export const panel = { place: "stage", order: 20, make };
