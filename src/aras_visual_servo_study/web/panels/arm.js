// The arm, the target and the camera in three dimensions.
import { button, card, el, isDark, notice } from "../lib/dom.js";
import { meshOf } from "../lib/meshes.js";
import { placeAt } from "../lib/model.js";
import { hasWebGL, World } from "../lib/world.js";

const load = async (about) => Object.fromEntries(await Promise.all(about.robot.meshes.map(async (name) => {
  const answer = await fetch(`mesh/${name}`);
  return [name, answer.ok ? meshOf(await answer.arrayBuffer()) : null];
})));

const make = (page) => {
  const { model } = page, { card: box, head, body } = card("Arm", "view");
  if (!hasWebGL()) {
    body.append(el("p", { class: "absent", id: "no-webgl" }, "This browser has no WebGL, so the arm is not drawn. The camera's image, the curves and all controls work without it."));
    return box;
  }
  const canvas = el("canvas", { id: "world", tabindex: 0, role: "application", "aria-label": "the arm: arrow keys turn the view, plus and minus zoom, Home shows all of it; the target can be moved in the panel Target" });
  const inset = el("button", { class: "inset", type: "button", hidden: true, "aria-label": "swap with the large view", title: "The observer's view; click to swap it with the large view" });
  body.append(canvas, inset, el("p", { class: "hint" }, "Drag to rotate the view, scroll or pinch to zoom, drag with the right button to shift. Drag the target to move it, and its ring to rotate it. The arm can follow where the plane is green. Keys: arrows, + and −, Home."));
  let world = null;
  const toggle = (text, title, on, act) => {
    const control = button(text, title, () => { control.setAttribute("aria-pressed", String(act())); }, { "aria-pressed": String(on), class: "quiet" });
    return control;
  };
  head.append(el("span", { class: "tools" },
    button("Home", "Show the whole arm", () => world?.home(), { class: "quiet" }),
    toggle("Ride along", "Attach the view to the camera", false, () => { world?.follow(!world.follows); return world?.follows; }),
    toggle("Observer", "A second view, from an observer beside the arm", false, () => { if (world) { world.second = !world.second; world.dirty = true; inset.hidden = !world.second; } return world?.second; })));
  inset.onclick = () => { if (world) { world.swapped = !world.swapped; world.dirty = true; } };

  let sent = 0, later = 0;
  const place = (position_m, q_xyzw) => {
    const send = () => { sent = performance.now(); page.ask({ do: "place_target", position_m, q_xyzw }).then(() => notice("target", "")).catch((error) => notice("target", error.message)); };
    clearTimeout(later);
    if (performance.now() - sent > 40) send(); else later = setTimeout(send, 40);
  };

  // Where the arm can follow the target: known ahead, asked anew when plane or attitude of the target have changed.
  let asking = false;
  const askReach = (anew = false) => {
    if (asking || !world || !model.state?.taught || !(anew || world.reachIsOld())) return;
    asking = true;
    page.ask({ do: "reach" }).then((reach) => world?.setReach(reach)).catch(() => world?.setReach(null)).finally(() => { asking = false; });
  };
  let robot = "";
  const build = async (about) => {
    const same = JSON.stringify([about.robot, about.scene, about.camera, about.target]);
    if (same === robot) return;
    robot = same;
    notice("drawn", about.notes.join(" · "));
    const geometries = await load(about);
    const old = world;
    world = new World(canvas, about, geometries, isDark(), old?.renderer);
    if (old) { world.second = old.second; world.eye.position.copy(old.eye.position); world.controls.target.copy(old.controls.target); world.touched = old.touched; old.controls.dispose(); world.controls.update(); }
    world.draggable(place, () => setTimeout(askReach, 100));   // the last place is on its way
    askReach(true);
    page.world = world;
    world.size(canvas.clientWidth, canvas.clientHeight);
    if (model.state) world.show(model.state);
    if (model.goal) world.setGoal(model.goal.pose);
    path(model.rows);
  };
  const path = (rows) => {
    const { x, y, z } = model.column;
    if (world && x !== undefined) world.setPath(rows.filter((row) => row[x] !== null).map((row) => [row[x], row[y], row[z]]));
  };
  model.on("about", (about) => build(about).catch((error) => notice("arm", error.message)));
  model.on("shown", (state) => world?.show(state));
  model.on("picture", ({ bitmap }) => world?.image(bitmap));
  model.on("past", (past) => path(past ? past.rows.slice(0, placeAt(past.rows, past.t) + 1) : model.rows));
  model.on("goal", (goal) => { world?.setGoal(goal ? goal.pose : null); if (goal) askReach(true); else world?.setReach(null); });
  model.on("theme", () => world?.build(isDark()));
  let shown = 0;
  model.on("rows", (rows) => { if (!model.past && performance.now() - shown > 100) { shown = performance.now(); path(rows); } });
  build(model.about).catch((error) => notice("arm", error.message));

  canvas.addEventListener("webglcontextlost", (event) => { event.preventDefault(); notice("webgl", "The browser has closed the 3-D view. Reload the page to restore it."); });
  const frame = () => {
    if (world) {
      world.size(canvas.clientWidth, canvas.clientHeight);
      world.draw();
      const [left, top, width, height] = world.inset();
      Object.assign(inset.style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
  return box;
};

export const panel = { place: "stage", order: 10, make };
