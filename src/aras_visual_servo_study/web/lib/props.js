// What stands around the robot: flat models, solids, frames, the camera's frustum.
import { material } from "./robot.js";

const linear = (rgb) => new THREE.Color(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255).convertSRGBToLinear();

export const setPose = (object, pose) => {
  object.position.set(pose[0], pose[1], pose[2]);
  object.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
};

/** A flat model: board, picture, outlines, each a little above the one before. Its userData.radius encloses it. */
export const flatModel = (model) => {
  const group = new THREE.Group();
  let radius = 0.02;
  const flat = (geometry, look, z) => {
    const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -2 * z, polygonOffsetUnits: -2 * z, ...look }));
    mesh.position.z = 2e-4 * z;
    group.add(mesh);
  };
  const within = (x, y) => { radius = Math.max(radius, Math.hypot(x, y)); };
  if (model.board) { flat(new THREE.PlaneBufferGeometry(...model.board.size), { color: linear(model.board.color) }, 1); within(model.board.size[0] / 2, model.board.size[1] / 2); }
  if (model.image && model.image.src) {
    const texture = new THREE.TextureLoader().load(model.image.src, () => group.userData.changed && group.userData.changed());
    texture.encoding = THREE.sRGBEncoding;
    texture.anisotropy = 4;
    flat(new THREE.PlaneBufferGeometry(...model.image.size), { map: texture }, 2);
    within(model.image.size[0] / 2, model.image.size[1] / 2);
  }
  for (const outline of model.outlines) {
    flat(new THREE.ShapeBufferGeometry(new THREE.Shape(outline.map(([x, y]) => new THREE.Vector2(x, y)))), { color: linear(model.color) }, 3);
    outline.forEach(([x, y]) => within(x, y));
  }
  setPose(group, model.pose);
  group.userData.radius = radius;
  return group;
};

export const solid = (entry) => {
  const geometry = entry.box ? new THREE.BoxBufferGeometry(...entry.box) : entry.sphere ? new THREE.SphereBufferGeometry(entry.sphere, 32, 20)
    : new THREE.CylinderBufferGeometry(entry.cylinder[0], entry.cylinder[0], entry.cylinder[1], 40).rotateX(Math.PI / 2);
  const mesh = new THREE.Mesh(geometry, material([...entry.color.map((x) => x / 255), 1]));
  mesh.castShadow = mesh.receiveShadow = true;
  setPose(mesh, entry.pose);
  return mesh;
};

const AXES = [["x", 0xd1495b], ["y", 0x3f9e5f], ["z", 0x3573c4]];

const letter = (text, color) => {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  pen.font = "600 46px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = `#${color.toString(16).padStart(6, "0")}`;
  pen.fillText(text, 32, 34);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), transparent: true, depthTest: false }));
  return sprite;
};

/** The three axes of a frame, `size` long, with letters where wanted. */
export const frame = (size, letters = false, opacity = 1) => {
  const group = new THREE.Group();
  AXES.forEach(([name, color], i) => {
    const rod = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.022 * size, 0.022 * size, size, 10),
      new THREE.MeshBasicMaterial({ color: new THREE.Color(color).convertSRGBToLinear(), transparent: opacity < 1, opacity }));
    if (i === 0) rod.rotation.z = -Math.PI / 2;
    if (i === 2) rod.rotation.x = Math.PI / 2;
    rod.position.setComponent(i, size / 2);
    group.add(rod);
    if (letters) {
      const sprite = letter(name, color);
      sprite.scale.setScalar(0.42 * size);
      sprite.position.setComponent(i, 1.2 * size);
      group.add(sprite);
    }
  });
  return group;
};

/** The corners of the image at a depth, in the camera's frame. */
const corners = ({ width, height, K }, depth) =>
  [[-0.5, -0.5], [width - 0.5, -0.5], [width - 0.5, height - 0.5], [-0.5, height - 0.5]]
    .map(([u, v]) => new THREE.Vector3((u - K[2]) / K[0] * depth, (v - K[5]) / K[4] * depth, depth));

/** The camera's frustum; with a texture, what it sees hangs at its end. */
export const frustum = (camera, depth, color, texture = null) => {
  const group = new THREE.Group(), ends = corners(camera, depth), centre = new THREE.Vector3(), points = [];
  ends.forEach((end, i) => points.push(centre, end, end, ends[(i + 1) % 4]));
  group.add(new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color: new THREE.Color(color).convertSRGBToLinear() })));
  if (texture) {
    const plane = new THREE.BufferGeometry();
    plane.setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends.flatMap((end) => [end.x, end.y, end.z])), 3));
    plane.setAttribute("uv", new THREE.BufferAttribute(new Float32Array([0, 1, 1, 1, 1, 0, 0, 0]), 2));
    plane.setIndex([0, 1, 2, 0, 2, 3]);
    const picture = new THREE.Mesh(plane, new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide, transparent: true, opacity: 0.94 }));
    group.add(picture);
  }
  return group;
};

/** A line through points that are added one after another. */
export class Trail {
  constructor(color, most = 6000) {
    this.most = most;
    this.positions = new Float32Array(3 * most);
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    this.line = new THREE.Line(this.geometry, new THREE.LineBasicMaterial({ color: new THREE.Color(color).convertSRGBToLinear() }));
    this.line.frustumCulled = false;
  }

  set(points) {
    const step = Math.ceil(points.length / this.most) || 1;
    let count = 0;
    for (let i = points.length - 1; i >= 0; i -= step) this.positions.set(points[i], 3 * count++);
    this.geometry.setDrawRange(0, count);
    this.geometry.attributes.position.needsUpdate = true;
  }
}
