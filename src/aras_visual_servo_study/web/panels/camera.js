// What the camera sees: the live image with its features, the goal image beside it and blended over it, trajectories.
import { button, card, el } from "../lib/dom.js";
import { placeAt } from "../lib/model.js";

const SEEN = "#e4572e", WANTED = "#00a878", TRAIL = "#0b8fd0", MOST = 900;

const mark = (pen, marks, colour, k, wanted) => {
  if (!marks) return;
  pen.strokeStyle = colour;
  pen.fillStyle = colour;
  pen.lineWidth = 2;
  for (const [u, v] of marks.points) {
    pen.beginPath();
    pen.arc((u + 0.5) * k, (v + 0.5) * k, 4.5, 0, 2 * Math.PI);
    if (wanted) pen.stroke(); else pen.fill();
  }
  if (!marks.centre) return;
  const [x, y] = marks.centre.map((c) => (c + 0.5) * k), long = 34 * k / 2;
  if (marks.axis !== null) {
    const dx = Math.cos(marks.axis) * long, dy = Math.sin(marks.axis) * long;
    pen.beginPath();
    pen.moveTo(wanted ? x - 0.6 * dx : x - dx, wanted ? y - 0.6 * dy : y - dy);
    pen.lineTo(x + dx, y + dy);
    pen.stroke();
  }
  pen.beginPath();
  if (wanted) pen.arc(x, y, 7, 0, 2 * Math.PI);
  else { pen.moveTo(x - 7, y); pen.lineTo(x + 7, y); pen.moveTo(x, y - 7); pen.lineTo(x, y + 7); }
  pen.stroke();
};

const make = (page) => {
  const { model } = page, { card: box, head, body } = card("Camera", "camera");
  const live = el("canvas", { id: "live" }), caption = el("figcaption", {}, "live"), goal = el("canvas", { id: "goal" });
  const blend = el("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0, id: "blend", "aria-label": "opacity of the goal image over the live image" });
  const show = { features: true, trails: true };
  const toggle = (name, title) => {
    const control = button(name[0].toUpperCase() + name.slice(1), title, () => { show[name] = !show[name]; control.setAttribute("aria-pressed", String(show[name])); draw(); }, { "aria-pressed": "true", class: "quiet" });
    return control;
  };
  head.append(el("span", { class: "tools" }, toggle("features", "Draw measured features (cross) and goal features (ring)"), toggle("trails", "Draw the path of each point in the image")));
  body.append(
    el("div", { class: "pictures" },
      el("figure", {}, live, caption),
      el("figure", {}, goal, el("figcaption", {}, "goal"))),
    el("label", { class: "blend" }, el("span", {}, "goal over live"), blend));
  let trails = [], last = -1, shown = null, trail = [];   // trail: of the target's centre, up to a moment of the past

  const fit = (canvas) => {
    const { width, height } = model.about.camera, k = Math.max(1, Math.min(4, Math.round((canvas.clientWidth || width) * Math.min(devicePixelRatio || 1, 2) / width)));
    if (canvas.width !== width * k || canvas.height !== height * k) { canvas.width = width * k; canvas.height = height * k; }
    const pen = canvas.getContext("2d");
    pen.imageSmoothingEnabled = false;
    return { pen, k };
  };
  const draw = () => {
    if (shown) {
      const { pen, k } = fit(live);
      pen.drawImage(shown.bitmap, 0, 0, live.width, live.height);
      if (model.goal && Number(blend.value) > 0) {
        pen.globalAlpha = Number(blend.value);
        pen.drawImage(model.goal.bitmap, 0, 0, live.width, live.height);
        pen.globalAlpha = 1;
      }
      if (show.trails) {
        pen.lineWidth = 1.6;
        pen.strokeStyle = TRAIL;
        for (const way of model.past ? [trail] : trails) {
          pen.beginPath();
          let on = false;
          for (const p of way) {
            if (!p) { on = false; continue; }
            if (on) pen.lineTo((p[0] + 0.5) * k, (p[1] + 0.5) * k); else pen.moveTo((p[0] + 0.5) * k, (p[1] + 0.5) * k);
            on = true;
          }
          pen.stroke();
        }
      }
      if (show.features) { mark(pen, model.goal?.marks, WANTED, k, true); mark(pen, shown.marks, SEEN, k, false); }
    }
    const { pen, k } = fit(goal);
    if (model.goal) { pen.drawImage(model.goal.bitmap, 0, 0, goal.width, goal.height); if (show.features) mark(pen, model.goal.marks, WANTED, k, true); }
    else {
      pen.clearRect(0, 0, goal.width, goal.height);
      pen.fillStyle = getComputedStyle(box).getPropertyValue("--soft");
      pen.font = `${11 * goal.width / Math.max(goal.clientWidth, 1)}px system-ui, sans-serif`;
      pen.textAlign = "center";
      pen.fillText("nothing taught yet", goal.width / 2, goal.height / 2);
    }
  };
  const remember = (marks) => {
    const points = marks.points.length ? marks.points : [marks.centre];
    if (trails.length !== points.length) trails = points.map(() => []);
    points.forEach((p, i) => { trails[i].push(p); if (trails[i].length > MOST) trails[i].shift(); });
  };
  model.on("state", (state) => {
    if (state.t < last || (state.phase === "servo" && page.phase !== "servo")) trails = [];
    last = state.t;
    page.phase = state.phase;
  });
  model.on("image", ({ marks }) => { if (marks) remember(marks); });
  model.on("picture", (picture) => { shown = picture; draw(); });
  model.on("past", (past) => {
    caption.textContent = past ? `at ${(past.t - past.zero).toFixed(2)} s` : "live";
    if (!past) return;
    const { u, v } = past.column, end = placeAt(past.rows, past.t) + 1;
    trail = past.rows.slice(Math.max(0, end - MOST), end).map((row) => (row[u] === null ? null : [row[u], row[v]]));
  });
  model.on("goal", draw);
  model.on("theme", draw);
  model.on("about", () => { trails = []; });
  blend.oninput = draw;
  new ResizeObserver(draw).observe(live);
  return box;
};

export const panel = { place: "camera", order: 10, make };
