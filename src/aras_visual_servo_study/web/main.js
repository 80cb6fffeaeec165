// The page: connects, then lets every panel of panels/ build itself. A panel is a module that exports `panel`:
//   { place: "stage" | "camera" | "curves" | "controls", order, make(page) -> element }
import { Connection } from "./lib/connection.js";
import { Model } from "./lib/model.js";
import { bar } from "./lib/bar.js";
import { notice } from "./lib/dom.js";
import { Runs } from "./lib/runs.js";
import { why } from "./lib/why.js";

const model = new Model();
const connection = new Connection(model);
// What curves and time share: the run that is shown (null: the newest), one over it, the range, the moment of the past. The
// time panel adds seek(t), to a moment of what is shown, and toNow().
const shared = { window_s: 20, from: null, to: null, paused: false, cursor: null, run: null, over: null, at: null };
const page = { model, connection, runs: new Runs(model), shared, ask: (request) => connection.ask(request) };

window.aras = page;   // for tests, and for the curious
bar(page, document.querySelector("#bar"));
why(page, document.querySelector("#why"));
model.on("connection", (state) => notice("connection", state === "open" ? "" : "No connection to the run. Retrying."));
connection.open();
const top = document.querySelector("#top");
new ResizeObserver(() => document.documentElement.style.setProperty("--top", `${top.offsetHeight}px`)).observe(top);

const names = await (await fetch("panels.json")).json();
await model.first("about");
const found = await Promise.all(names.map(async (name) => {
  try {
    return (await import(`./panels/${name}`)).panel;
  } catch (error) {
    notice(`panel ${name}`, `The panel ${name} cannot be shown: ${error.message}`);
    return null;
  }
}));
for (const panel of found.filter(Boolean).sort((a, b) => a.order - b.order)) {
  try {
    document.querySelector(`#${panel.place}`).append(panel.make(page));
  } catch (error) {
    notice(panel.place, error.message);
  }
}
document.body.classList.add("ready");
