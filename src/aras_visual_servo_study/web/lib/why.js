// The line below the head: how the run is, why in one whole sentence, and what to do now.
import { el } from "./dom.js";

const WORDS = { IDLE: "idle", SERVOING: "servoing", CONVERGED: "converged", TARGET_LOST: "target lost", STALE_INPUT: "no input",
  JOINT_LIMIT: "joint limit", NEAR_SINGULARITY: "near singularity", TIMED_OUT: "timed out", STOPPED: "stopped", FAULT: "fault",
  STOPPED_BY_RULE: "stopped by rule", SETTLED: "settled", OUT_OF_REACH: "out of reach" };
const KIND = { SERVOING: "busy", CONVERGED: "good", STOPPED_BY_RULE: "good", SETTLED: "warn", TARGET_LOST: "bad", STALE_INPUT: "bad", FAULT: "bad",
  JOINT_LIMIT: "warn", NEAR_SINGULARITY: "warn", OUT_OF_REACH: "warn", TIMED_OUT: "warn" };
const PHASES = { to_goal: "driving to the goal", settle_goal: "settling at the goal", teach: "teaching", to_start: "driving to the start",
  settle_start: "settling at the start" };
/** A sentence whose numbers change with every image can be read at this pace. */
const READ_MS = 400;

/** What a status is called, and the colour that goes with it. */
export const statusWords = (status) => WORDS[status] || status;
export const statusKind = (status) => KIND[status] || "";

/** How the last servo ended and what has changed since, by the number that its run has in this page. */
const since = (runs, { ended, since: change, text }) => {
  const last = runs.all[runs.all.length - 1];
  return change && last?.ended ? `run ${last.number}: ${statusWords(ended)}; ${change} since` : text;
};

const sentence = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.!?]\s*$/.test(text) ? "" : ".") : "");

export const why = (page, place) => {
  const pill = el("span", { class: "pill", id: "status" }, "…"), text = el("span", { id: "text" }), advice = el("span", { id: "advice" });
  const told = el("p", { class: "visually-hidden", role: "status" });
  place.append(pill, el("p", {}, text, " ", advice), page.clock, told);
  let shown = {}, at = 0;
  page.model.on("state", (state) => {
    const driving = PHASES[state.phase], now = performance.now();
    const same = state.status === shown.status && state.phase === shown.phase;
    if (same && (now - at < READ_MS || (state.text === shown.text && state.advice === shown.advice))) return;
    at = now;
    shown = state;
    const word = driving || statusWords(state.status);
    pill.textContent = word;
    pill.className = `pill ${driving ? "busy" : statusKind(state.status)}`;
    pill.dataset.status = state.status;
    text.textContent = state.text === word || state.text === state.phase ? "" : sentence(since(page.runs, state));
    advice.textContent = state.advice;
    place.dataset.kind = state.kind;
    if (!same) told.textContent = `${word}. ${text.textContent} ${state.advice}`;   // a reader hears what has changed, not every number
  });
};
