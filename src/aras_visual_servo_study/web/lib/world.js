// The 3-D view: robot, target, camera with its image, path, goal; the same for the live page and for a report.
// THREE (three.js) and THREE.OrbitControls are scripts of the page.
import { flatModel, frame, frustum, setPose, solid, Trail } from "./props.js";
import { reachPlane } from "./reach.js";
import { Robot } from "./robot.js";

const FRUSTUM_M = 0.16;
/** A reach counts for planes and attitudes that differ by less. */
const SAME_RAD = 0.01, SAME_M = 0.001;
/** Part of the view that the arm may fill. */
const FILLED = 0.92;
/** Keys of the view: turn around, turn over [rad], factor of the distance. */
const KEYS = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1], "+": [0, 0, 0.85], "-": [0, 0, 1.18], Home: [] };
const COLOURS = {
  light: { sky: 0xeef1f4, floor: 0xd3d9df, grid: 0xb4bdc7, plate: 0xf4f4f1, path: 0x0b6e99, goal: 0x00805a, seen: 0x36454f, within: 0x00805a, beyond: 0xb3261e },
  dark: { sky: 0x14181d, floor: 0x232a32, grid: 0x3a444f, plate: 0xc9ccce, path: 0x56b6e0, goal: 0x3fc795, seen: 0xaeb9c4, within: 0x3fc795, beyond: 0xff8a70 } };

export const hasWebGL = () => {
  if (!window.THREE) return false;
  try {
    const canvas = document.createElement("canvas");
    return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
  } catch { return false; }
};

export class World {
  /** canvas: to draw on.  about: as the run sends it.  geometries: mesh name -> BufferGeometry.  dark: colours.  renderer: of the canvas, if it has one. */
  constructor(canvas, about, geometries, dark = false, renderer = null) {
    this.canvas = canvas;
    this.about = about;
    this.renderer = renderer || new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: false });
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.renderer.autoClear = false;
    this.scene = new THREE.Scene();
    this.picture = document.createElement("canvas");
    this.picture.width = about.camera.width;
    this.picture.height = about.camera.height;
    this.pen = this.picture.getContext("2d");
    this.texture = new THREE.CanvasTexture(this.picture);
    this.texture.encoding = THREE.sRGBEncoding;
    this.texture.minFilter = THREE.LinearFilter;
    this.texture.generateMipmaps = false;
    this.eye = new THREE.PerspectiveCamera(40, 1, 0.01, 60);
    this.observer = new THREE.PerspectiveCamera(42, 4 / 3, 0.05, 60);
    for (const camera of [this.eye, this.observer]) camera.up.set(0, 0, 1);
    this.observer.position.set(...about.observer.eye);
    this.observer.lookAt(...about.observer.look_at);
    this.controls = new THREE.OrbitControls(this.eye, canvas);
    this.controls.screenSpacePanning = true;
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 20;
    this.controls.addEventListener("change", () => { this.dirty = true; });
    this.controls.addEventListener("start", () => { this.touched = true; });
    this.controls.enableKeys = false;
    canvas.addEventListener("wheel", () => { this.touched = true; });
    canvas.addEventListener("keydown", (event) => {
      const way = KEYS[event.key];
      if (!way) return;
      event.preventDefault();
      if (event.key === "Home") this.home(); else this.turn(...way);
    });
    this.robot = new Robot(about, geometries);
    this.follows = false;
    this.second = false;
    this.swapped = false;
    this.build(dark);
    this.home();
  }

  build(dark) {
    const scene = this.scene, colours = this.colours = COLOURS[dark ? "dark" : "light"];
    while (scene.children.length) scene.remove(scene.children[0]);
    scene.background = new THREE.Color(colours.sky);   // three.js r111 does not convert it
    scene.add(new THREE.HemisphereLight(0xffffff, dark ? 0x30343a : 0x8e97a1, dark ? 0.55 : 0.66));
    const sun = new THREE.DirectionalLight(0xffffff, dark ? 0.7 : 0.5), [x, y, z] = this.about.observer.look_at;
    sun.position.set(x + 1.4, y - 1.1, z + 2.6);
    sun.target.position.set(x, y, z);
    sun.castShadow = !this.plain;
    sun.shadow.mapSize.set(1024, 1024);
    Object.assign(sun.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 0.3, far: 7 });
    sun.shadow.bias = -0.0004;
    scene.add(sun, sun.target);
    const models = this.about.scene.models, low = Math.min(0, ...models.map((model) => model.pose[2] - 0.002));
    const floor = new THREE.Mesh(new THREE.CircleBufferGeometry(4, 72), new THREE.MeshLambertMaterial({ color: new THREE.Color(colours.floor).convertSRGBToLinear() }));
    floor.position.set(x, y, low - 0.001);
    floor.receiveShadow = true;
    const grid = new THREE.GridHelper(6, 24, colours.grid, colours.grid);
    grid.rotation.x = Math.PI / 2;
    grid.position.set(Math.round(4 * x) / 4, Math.round(4 * y) / 4, low);
    grid.material.transparent = true;
    grid.material.opacity = 0.55;
    scene.add(floor, grid, frame(0.18, true), this.robot.root);
    this.models = {};
    for (const model of models) {
      const group = flatModel(model);
      group.userData.changed = () => { this.dirty = true; };
      this.models[model.name] = group;
      scene.add(group);
    }
    const first = models.find((model) => model.name === this.about.target);
    if (first) {   // what the target lies on: it shows where that is in the room
      const half = Math.max(0.17, 1.9 * this.models[first.name].userData.radius), plate = new THREE.Group();
      const top = new THREE.Mesh(new THREE.BoxBufferGeometry(2 * half, 2 * half, 0.012), new THREE.MeshLambertMaterial({ color: new THREE.Color(colours.plate).convertSRGBToLinear() }));
      top.position.z = -0.0085;
      top.castShadow = top.receiveShadow = true;
      plate.add(top);
      this.models[first.name].add(plate);   // it goes with the target
    }
    for (const entry of this.about.scene.solids) scene.add(solid(entry));
    this.camera = new THREE.Group();
    this.camera.add(frustum(this.about.camera, FRUSTUM_M, colours.seen, this.texture), frame(0.06));
    this.goal = new THREE.Group();
    this.goal.add(frustum(this.about.camera, FRUSTUM_M, colours.goal), frame(0.08, false, 0.7));
    this.goal.visible = false;
    this.trail = new Trail(colours.path);
    scene.add(this.camera, this.goal, this.trail.line);
    this.target = this.models[this.about.target] || null;
    if (this.target) {
      const radius = this.target.userData.radius;
      this.ring = new THREE.Mesh(new THREE.RingBufferGeometry(1.22 * radius, 1.36 * radius, 72),
        new THREE.MeshBasicMaterial({ color: new THREE.Color(colours.path).convertSRGBToLinear(), transparent: true, opacity: 0.55, side: THREE.DoubleSide, depthWrite: false }));
      this.ring.position.z = 0.001;
      this.ring.visible = false;
      this.target.add(this.ring);
    }
    this.plane = null;
    if (this.reach) this.setReach(this.reach);
    if (this.last) this.show(this.last);
    if (this.goalPose) this.setGoal(this.goalPose);
    if (this.path) this.trail.set(this.path);
    this.dirty = true;
  }

  /** The view from where everything is seen. */
  home() {
    this.touched = false;
    const { eye, look_at } = this.about.observer, at = new THREE.Vector3(...look_at), corners = this.corners();
    const way = new THREE.Vector3(...eye).sub(at).applyAxisAngle(new THREE.Vector3(0, 0, 1), 0.5);
    way.z += 0.3;
    way.normalize();
    if (corners.length) new THREE.Box3().setFromPoints(corners).getCenter(at);
    // As near as every corner allows: its place across the view, and how far it lies in front of the centre.
    const up = new THREE.Vector3(0, 0, 1).addScaledVector(way, -way.z).normalize(), right = new THREE.Vector3().crossVectors(up, way);
    const high = Math.tan(0.5 * this.eye.fov * Math.PI / 180) * FILLED, wide = high * (this.w && this.h ? this.w / this.h : 1.5);
    const far = corners.reduce((most, corner) => {
      const d = corner.clone().sub(at);
      return Math.max(most, d.dot(way) + Math.max(Math.abs(d.dot(right)) / wide, Math.abs(d.dot(up)) / high));
    }, 0.3);
    this.controls.target.copy(at);
    this.eye.position.copy(at).addScaledVector(way, far);
    this.controls.update();
    this.dirty = true;
  }

  /** Corners of all that has to be seen: what moves of the arm, the camera, the goal and the target. */
  corners() {
    const points = [], box = new THREE.Box3();
    this.scene.updateMatrixWorld(true);
    const add = (object) => {
      if (box.setFromObject(object).isEmpty()) return;
      for (let i = 0; i < 8; i++) points.push(new THREE.Vector3(box[i & 1 ? "max" : "min"].x, box[i & 2 ? "max" : "min"].y, box[i & 4 ? "max" : "min"].z));
    };
    for (const name of this.robot.names) {
      const { motion } = this.robot.moved[name] || {};
      if (motion) motion.children[0].children.forEach((one) => { if (one.isMesh) add(one); });
    }
    if (this.camera) add(this.camera);
    if (this.target) add(this.target);
    return points;
  }

  /** Turns the view about what is looked at, and moves nearer or farther. Args: angles [rad]; factor of the distance. */
  turn(around, over, factor = 1) {
    const { target } = this.controls, place = new THREE.Spherical(), up = new THREE.Quaternion().setFromUnitVectors(this.eye.up, new THREE.Vector3(0, 1, 0));
    const way = this.eye.position.clone().sub(target).applyQuaternion(up);
    place.setFromVector3(way);
    place.theta += around;
    place.phi += over;
    place.radius *= factor;
    place.makeSafe();
    this.eye.position.setFromSpherical(place).applyQuaternion(up.conjugate()).add(target);
    this.touched = true;
    this.controls.update();
  }

  /** state: q, camera and target as pose numbers. */
  show(state) {
    const first = !this.last;
    this.last = state;
    this.robot.pose(state.q, state.camera);
    if (first) requestAnimationFrame(() => { if (!this.touched) this.home(); });
    if (state.camera) {
      setPose(this.camera, state.camera);
      if (this.follows) {
        const moved = this.camera.position.clone().sub(this.controls.target);
        this.controls.target.add(moved);
        this.eye.position.add(moved);
        this.controls.update();
      }
    }
    if (this.target && state.target && !this.held) setPose(this.target, state.target);
    this.shade();
    this.dirty = true;
  }

  image(bitmap) {
    this.pen.drawImage(bitmap, 0, 0, this.picture.width, this.picture.height);
    this.texture.needsUpdate = true;
    this.dirty = true;
  }

  setGoal(pose) {
    this.goalPose = pose;
    this.goal.visible = Boolean(pose);
    if (pose) setPose(this.goal, pose);
    this.dirty = true;
  }

  /** reach: where the target may lie, as the run answers; null: not known. */
  setReach(reach) {
    this.reach = reach;
    if (this.plane) this.scene.remove(this.plane);
    this.plane = reach && reachPlane(reach, this.colours);
    if (this.plane) this.scene.add(this.plane);
    this.shade();
    this.dirty = true;
  }

  /** Shades the plane while the target is dragged, and while it lies out of reach. */
  shade() {
    const shown = Boolean(this.held) || this.last?.kind === "out_of_reach";
    if (this.plane && this.plane.visible !== shown) { this.plane.visible = shown; this.dirty = true; }
  }

  /** Whether the reach that is known is of another plane or attitude than the target's. */
  reachIsOld() {
    if (!this.reach || !this.target) return true;
    const [x, y, z, ...q] = this.reach.pose, plane = new THREE.Quaternion(...q), normal = new THREE.Vector3(0, 0, 1).applyQuaternion(plane);
    return plane.angleTo(this.target.quaternion) > SAME_RAD || Math.abs(this.target.position.clone().sub(new THREE.Vector3(x, y, z)).dot(normal)) > SAME_M;
  }

  /** points: [x, y, z] of the camera. */
  setPath(points) { this.path = points; this.trail.set(points); this.dirty = true; }

  follow(on) { this.follows = on; if (on && this.last) this.show(this.last); }

  size(width, height) {
    const ratio = this.plain >= 2 ? 0.6 : Math.min(devicePixelRatio || 1, 2);
    const same = this.w === width && this.h === height;
    if (same && this.ratio === ratio) return;
    Object.assign(this, { w: width, h: height, ratio, dirty: true });
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    if (!same && !this.touched && !this.held) this.home();   // the view stays where it is under a hand
  }

  /** Where the second view lies: [left, top, width, height] in px of the canvas. */
  inset() {
    const width = Math.round(Math.min(300, Math.max(116, 0.3 * this.w)));
    return [this.w - width - 10, 10, width, Math.round(0.75 * width)];
  }

  /** Draws, if anything has changed. */
  draw() {
    if (!this.dirty || !this.w || !this.h) return;
    this.dirty = false;
    this.pace();
    const { renderer, scene } = this;
    const view = (camera, left, top, width, height) => {
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      renderer.setViewport(left, this.h - top - height, width, height);
      renderer.setScissor(left, this.h - top - height, width, height);
      renderer.setScissorTest(true);
      renderer.clear();
      renderer.render(scene, camera);
    };
    const [main, other] = this.swapped ? [this.observer, this.eye] : [this.eye, this.observer];
    view(main, 0, 0, this.w, this.h);
    if (this.second) view(other, ...this.inset());
  }

  /** Where pictures come slowly, first the shadows go, then resolution (`size`): whoever has no graphics card still sees it move. */
  pace() {
    const now = performance.now(), took = now - (this.drawn || now);
    this.drawn = now;
    this.slow = took > 70 && took < 2000 ? (this.slow || 0) + 1 : Math.max(0, (this.slow || 0) - 1);
    if (this.slow < 8 || this.plain >= 2) return;
    this.slow = 0;
    this.plain = (this.plain || 0) + 1;
    if (this.plain === 1) this.scene.traverse((one) => { if (one.isLight) one.castShadow = false; });
  }

  // --- the target by hand -------------------------------------------------------------------------------------------

  ray(event) {
    const box = this.canvas.getBoundingClientRect(), caster = new THREE.Raycaster();
    const at = { x: (event.clientX - box.left) / box.width * 2 - 1, y: 1 - (event.clientY - box.top) / box.height * 2 };
    const camera = this.swapped ? this.observer : this.eye;
    camera.aspect = box.width / box.height;
    camera.updateProjectionMatrix();
    caster.setFromCamera(at, camera);
    return caster.ray;
  }

  /** Where a pointer meets the target's plane, THREE.Vector3 in the world, or null. */
  onPlane(event) {
    const normal = new THREE.Vector3(0, 0, 1).applyQuaternion(this.target.quaternion);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, this.held ? this.held.origin : this.target.position);
    return this.ray(event).intersectPlane(plane, new THREE.Vector3());
  }

  /** "move", "turn" or null: what a pointer here would do to the target. */
  grip(event) {
    const at = this.target && this.onPlane(event);
    if (!at) return null;
    const far = at.distanceTo(this.target.position) / this.target.userData.radius;
    return far < 1.12 ? "move" : far < 1.45 ? "turn" : null;
  }

  /** Lets the target be dragged and turned; place(position, quaternion) is called while it goes on, ended() after it. */
  draggable(place, ended = () => {}) {
    const canvas = this.canvas, axis = new THREE.Vector3(0, 0, 1);
    const angle = (at) => {
      const local = at.clone().sub(this.held.origin).applyQuaternion(this.held.turned.clone().conjugate());
      return Math.atan2(local.y, local.x);
    };
    const carry = (event) => {
      const at = this.onPlane(event), { pointer } = this.held;
      if (!at || (event.clientX === pointer[0] && event.clientY === pointer[1])) return;
      this.held.pointer = [event.clientX, event.clientY];
      if (this.held.kind === "move") this.target.position.copy(this.held.origin).add(at.sub(this.held.from));
      else this.target.quaternion.copy(this.held.turned).multiply(new THREE.Quaternion().setFromAxisAngle(axis, angle(at) - this.held.angle));
      place(this.target.position.toArray(), this.target.quaternion.toArray());
      this.dirty = true;
    };
    canvas.addEventListener("pointermove", (event) => {
      if (this.held) { carry(event); return; }
      const grip = this.grip(event);
      canvas.style.cursor = grip === "move" ? "move" : grip === "turn" ? "grab" : "";
      if (this.ring && this.ring.visible !== Boolean(grip)) { this.ring.visible = Boolean(grip); this.dirty = true; }
    });
    // Before the orbit, so that it does not turn the view as well.
    canvas.addEventListener("pointerdown", (event) => {
      const kind = event.button === 0 && this.grip(event);
      if (!kind) return;
      this.held = { kind, origin: this.target.position.clone(), turned: this.target.quaternion.clone(), from: this.onPlane(event), pointer: [event.clientX, event.clientY] };
      this.held.angle = angle(this.held.from);
      this.ring.visible = true;
      this.shade();
      this.controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
    }, true);
    const end = () => {
      if (!this.held) return;
      this.held = null;
      this.controls.enabled = true;
      this.ring.visible = false;
      this.shade();
      ended();
      this.dirty = true;
    };
    // Where it is let go counts, also where no move was seen to lead there.
    canvas.addEventListener("pointerup", (event) => { if (this.held) carry(event); end(); });
    canvas.addEventListener("pointercancel", end);
  }
}
