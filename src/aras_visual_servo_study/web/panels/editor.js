// A law that is written in the page: a text with line numbers, used from the next servo on; faults with their line.
import { button, download, el, folding } from "../lib/dom.js";

const LINE = /law\.py:(\d+):?\s*/, INDENT = 4;

const make = (page) => {
  const { model } = page, { card: box, body } = folding("Law editor", false, "a law of your own, used from the next servo on");
  if (!model.about.editor) { box.hidden = true; return box; }
  const numbers = el("pre", { class: "gutter", "aria-hidden": "true" }), told = el("p", { role: "status", id: "law-told" });
  const faults = el("div", { class: "fault", role: "alert", id: "law-faults" });
  const text = el("textarea", { id: "law-text", "aria-label": "law in Python", "aria-describedby": "law-told law-faults", spellcheck: "false", autocapitalize: "off", autocomplete: "off", wrap: "off" });
  text.value = model.about.editor.text;
  const apply = button("Use it", "Check the text, and use its law from the next servo on (Ctrl+Enter)", () => send(), { id: "law-apply", class: "primary" });
  const save = button("Save as a file", "Download the text as law.py, for aras-servo run --law NAME --plugins law", () => download("law.py", new Blob([text.value], { type: "text/x-python" })), { id: "law-save" });

  const lines = () => text.value.split("\n");
  let bad = [], refused = false, edits = 0;
  const number = () => {
    numbers.replaceChildren(...lines().map((_, i) => el("span", { class: bad.includes(i + 1) ? "bad" : "" }, `${i + 1}\n`)));
    text.rows = Math.min(24, Math.max(10, lines().length + 1));
    numbers.scrollTop = text.scrollTop;
  };
  const go = (line) => {
    const before = lines().slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    text.focus();
    text.setSelectionRange(before, before + (lines()[line - 1] || "").length);
  };
  /** Faults, each a button that leads to its line where it has one. */
  const show = (found) => {
    const told = found.map((fault) => [fault, Number(LINE.exec(fault)?.[1])]);
    bad = told.map(([, line]) => line).filter(Boolean);
    text.setAttribute("aria-invalid", String(found.length > 0));
    faults.replaceChildren(el("ul", {}, ...told.map(([fault, line]) => el("li", {}, line ? button(`Line ${line}`, "Go to this line", () => go(line), { class: "quiet", "data-line": line }) : null, ` ${fault.replace(LINE, "")}`))));
    number();
  };
  /** What is true of the text as it stands here: the run knows the newest one that it accepted only. */
  const tell = () => {
    const { editor, taught } = model.state || {}, inUse = `The law ${model.values.servo.law} is in use.`, press = `Press ${taught ? "Again" : "Run all"} to servo with it.`;
    const say = (is, words) => { told.dataset.is = is; told.textContent = words; };
    if (!editor) say("", "");
    else if (refused) say("refused", `This text was rejected, and nothing has changed. ${inUse}`);
    else if (text.value !== model.about.editor.text) say("edited", `This text has not been checked yet. ${inUse}`);
    else if (editor.waits) say("waits", `Accepted. ${press}`);
    else if (editor.law) say("used", `The law ${editor.law} of this text is in use. ${press}`);
    else if (editor.again) say("left", `The servo with this text ended with the fault below. The law ${editor.again} is in use again.`);
    else say("other", inUse);
  };
  const send = () => {
    const sent = edits, judged = (faults) => { if (sent === edits) { refused = faults.length > 0; show(faults); } };   // an answer to an older text says nothing about this one
    page.ask({ do: "write_law", text: text.value }).then(() => judged([]), (error) => judged(error.faults || [error.message])).then(tell);
  };

  text.addEventListener("input", () => { edits += 1; refused = false; show([]); tell(); });
  text.addEventListener("scroll", () => { numbers.scrollTop = text.scrollTop; });
  text.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    if (event.ctrlKey || event.metaKey) { event.preventDefault(); send(); return; }
    // The next line begins as far in as this one, and farther after a colon.
    event.preventDefault();
    const line = text.value.slice(0, text.selectionStart).split("\n").pop(), far = /^ */.exec(line)[0].length + (/:\s*$/.test(line) ? INDENT : 0);
    text.setRangeText(`\n${" ".repeat(far)}`, text.selectionStart, text.selectionEnd, "end");
    number();
  });
  let last = "", faulty = "[]";
  model.on("state", ({ editor }) => {
    const now = JSON.stringify([editor || null, model.state.taught]), found = JSON.stringify(editor?.faults || []);
    if (!editor || now === last) return;
    if (editor.faults.length && found !== faulty && text.value === model.about.editor.text) { box.open = true; show(editor.faults); }
    last = now;
    faulty = found;
    tell();
  });
  model.on("values", tell);
  body.append(el("p", { class: "soft" }, "Write a law in Python, press Use it, then Again. A law gives the camera's velocity from the features s and their errors e. Its code runs in the program on this machine."),
    el("div", { class: "editor" }, numbers, text), el("div", { class: "line" }, apply, save), told, faults);
  number();
  return box;
};

export const panel = { place: "stage", order: 30, make };   // wide: a line of code has its place in it
