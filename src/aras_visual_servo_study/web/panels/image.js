// What disturbs the image: noise, latency, exposure, lost frames; and the light.
import { el, folding } from "../lib/dom.js";
import { Fields } from "../lib/fields.js";

const CAMERA = ["noise_stddev", "latency_s", "exposure_s", "drop_probability"], SCENE = ["light_direction", "background_rgb"];

const make = (page) => {
  const { card: box, body } = folding("Noise, latency, exposure, light"), fields = page.fields ||= new Fields(page);
  const build = () => {
    const { properties } = page.model.about.schema.sim, cameras = page.model.values.sim.cameras || [];
    body.replaceChildren(
      ...(cameras.length ? CAMERA.map((key) => fields.make(`sim.cameras.0.${key}`, properties.cameras.items.properties[key])) : [el("p", { class: "soft" }, "The camera is described in the URDF; it has no settings here.")]),
      ...SCENE.map((key) => fields.make(`sim.scene.${key}`, properties.scene.properties[key])),
      fields.make("sim.scene.lighting", properties.scene.properties.lighting, "lighting (OpenGL renderer)"));
  };
  build();
  return box;
};

export const panel = { place: "controls", order: 30, make };
