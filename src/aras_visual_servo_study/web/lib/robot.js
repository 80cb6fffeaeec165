// The robot as three.js objects: a tree of links, moved by joint positions.
const place = (object, { xyz, rpy }) => {
  object.position.set(...xyz);
  object.rotation.set(rpy[0], rpy[1], rpy[2], "ZYX");   // fixed axes x, y, z, as in a URDF
  return object;
};

export const material = (rgba) => {
  const color = new THREE.Color(rgba[0], rgba[1], rgba[2]).convertSRGBToLinear();
  return new THREE.MeshStandardMaterial({ color, roughness: 0.62, metalness: 0.08, transparent: rgba[3] < 1, opacity: rgba[3] });
};

export class Robot {
  /** about: what the run says of itself.  geometries: mesh name -> BufferGeometry. */
  constructor(about, geometries) {
    const { robot } = about;
    this.names = about.joints.map((joint) => joint.name);
    this.root = new THREE.Group();
    this.links = {};
    this.moved = {};
    const children = {};
    for (const joint of robot.joints) (children[joint.parent] ||= []).push(joint);
    const grow = (name) => {
      const link = this.links[name] = new THREE.Group();
      for (const visual of robot.links[name] || []) {
        const shape = this.shape(visual, geometries);
        if (shape) link.add(shape);
      }
      for (const joint of children[name] || []) {
        const origin = place(new THREE.Group(), joint), motion = new THREE.Group();
        this.moved[joint.name] = { joint, motion, axis: new THREE.Vector3(...joint.axis).normalize() };
        motion.add(grow(joint.child));
        origin.add(motion);
        link.add(origin);
      }
      return link;
    };
    this.root.add(grow(robot.root));
    this.tip = this.links[about.tip];
    this.floating = about.floating;
  }

  shape(visual, geometries) {
    let geometry = null;
    if (visual.mesh) geometry = geometries[visual.mesh] || null;
    else if (visual.box) geometry = new THREE.BoxBufferGeometry(...visual.box);
    else if (visual.sphere) geometry = new THREE.SphereBufferGeometry(visual.sphere, 32, 20);
    else if (visual.cylinder) geometry = new THREE.CylinderBufferGeometry(visual.cylinder[0], visual.cylinder[0], visual.cylinder[1], 40).rotateX(Math.PI / 2);
    if (!geometry) return null;
    const mesh = place(new THREE.Mesh(geometry, material(visual.color)), visual);
    if (visual.scale) mesh.scale.set(...visual.scale);
    mesh.castShadow = mesh.receiveShadow = true;
    return mesh;
  }

  /** q: joint positions in the order of about.joints.  camera: pose numbers, which place a robot that floats. */
  pose(q, camera) {
    q.forEach((value, i) => {
      const moved = this.moved[this.names[i]];
      if (!moved || value === null) return;
      if (moved.joint.type === "prismatic") moved.motion.position.copy(moved.axis).multiplyScalar(value);
      else moved.motion.quaternion.setFromAxisAngle(moved.axis, value);
    });
    if (this.floating && camera && this.tip) {
      this.root.position.set(0, 0, 0);
      this.root.quaternion.set(0, 0, 0, 1);
      this.root.updateMatrixWorld(true);
      const X = new THREE.Matrix4().compose(new THREE.Vector3(...camera.slice(0, 3)), new THREE.Quaternion(...camera.slice(3)), new THREE.Vector3(1, 1, 1));
      X.multiply(new THREE.Matrix4().getInverse(this.tip.matrixWorld)).decompose(this.root.position, this.root.quaternion, new THREE.Vector3());
    }
  }
}
