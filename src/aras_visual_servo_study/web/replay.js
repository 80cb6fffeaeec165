// The replay of a report: the run in the 3-D view, with a slider of time that the curves of the page share.
import { meshOf } from "./lib/meshes.js";
import { readIn } from "./lib/units.js";
import { hasWebGL, World } from "./lib/world.js";

const section = document.querySelector("#replay"), source = document.querySelector("#replay-data");
const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const at = (id) => document.querySelector(`#replay-${id}`);

const start = () => {
  const data = JSON.parse(source.textContent), { about, moments } = data;
  section.hidden = false;
  const canvas = at("world"), picture = at("image"), slider = at("time"), output = at("at"), play = at("play"), joints = at("joints");
  const values = about.joints.map((joint) => {
    const value = document.createElement("b"), chip = document.createElement("span");
    chip.append(`${joint.name} `, value);
    joints.append(chip);
    const type = about.robot.joints.find(({ name }) => name === joint.name)?.type;
    return { value, read: readIn(type === "prismatic" ? "m" : "rad") };
  });
  at("note").textContent = (data.again ? "The camera's images were drawn again from the recorded joint positions. " : "") + data.notes.join(" ");
  let world = null;
  if (hasWebGL()) {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    world = new World(canvas, about, Object.fromEntries(Object.entries(data.meshes).map(([name, block]) => [name, meshOf(bytes(block).buffer)])), dark.matches);
    dark.addEventListener("change", () => { world.build(dark.matches); world.setGoal(data.goal); show(moments[slider.value].t); });
  } else { canvas.remove(); picture.style.position = "static"; at("note").textContent += " This browser has no WebGL, so the arm is not drawn."; }
  picture.width = about.camera.width;
  picture.height = about.camera.height;
  const pen = picture.getContext("2d"), images = data.images.map(({ t, jpeg }) => {
    const image = new Image();
    image.src = `data:image/jpeg;base64,${jpeg}`;
    return { t, image };
  });
  const nearest = (list, t) => list.reduce((best, one, i) => (Math.abs(one.t - t) < Math.abs(list[best].t - t) ? i : best), 0);
  slider.max = moments.length - 1;
  let shown = null, told = false;   // the plots show the start until a moment is chosen
  const show = (t) => {
    const index = nearest(moments, t), moment = moments[index];
    slider.value = index;
    output.textContent = `${moment.t.toFixed(2)} s`;
    values.forEach(({ value, read }, i) => { value.textContent = `${(read.factor * moment.q[i]).toFixed(1).replace("-", "−")} ${read.unit}`; });
    const { image } = images[nearest(images, moment.t)];
    if (image !== shown) {
      shown = image;
      image.decode().then(() => {
        pen.drawImage(image, 0, 0);
        world?.image(image);
        if (told) document.dispatchEvent(new CustomEvent("picture", { detail: image }));
      }).catch(() => {});
    }
    if (!world) return;
    world.show(moment);
    world.setPath(moments.slice(0, index + 1).filter((one) => one.camera).map((one) => one.camera.slice(0, 3)));
  };
  const seek = (t) => { show(t); document.dispatchEvent(new CustomEvent("seek", { detail: t })); };
  slider.oninput = () => { stop(); seek(moments[slider.value].t); };
  document.addEventListener("moment", (event) => show(event.detail));
  let begun = null;
  const stop = () => { begun = null; play.textContent = "▶"; };
  play.onclick = () => {
    if (begun !== null) { stop(); return; }
    const from = Number(slider.value) >= moments.length - 1 ? 0 : moments[slider.value].t;
    begun = performance.now() - 1e3 * from;
    play.textContent = "❚❚";
  };
  if (world) { world.setGoal(data.goal); world.second = false; }
  show(0);
  told = true;
  window.replay = { world, show, moments };   // for tests
  const frame = () => {
    if (begun !== null) {
      const t = 1e-3 * (performance.now() - begun);
      seek(Math.min(t, moments[moments.length - 1].t));
      if (t >= moments[moments.length - 1].t) stop();
    }
    if (world) { world.size(canvas.clientWidth, canvas.clientHeight); world.draw(); }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
};

if (section && source) start();
