// Reads the mesh blocks of view/robot.py; edges sharper than CREASE stay sharp, others are shaded round.
const CREASE = Math.cos(0.6);

/** A BufferGeometry of the bytes of a block (ArrayBuffer). */
export const meshOf = (buffer) => {
  const view = new DataView(buffer), vertices = view.getUint32(0, true), triangles = view.getUint32(4, true);
  const number = (i) => view.getFloat32(8 + 4 * i, true);
  const low = [number(0), number(1), number(2)], step = [number(3), number(4), number(5)];
  const cells = new Uint16Array(buffer, 32, 3 * vertices), at = 32 + 6 * vertices + (-6 * vertices & 3);
  const index = new Uint32Array(buffer, at, 3 * triangles);
  const positions = new Float32Array(9 * triangles), flat = new Float32Array(3 * triangles);
  for (let i = 0; i < index.length; i++)
    for (let k = 0; k < 3; k++) positions[3 * i + k] = low[k] + step[k] * cells[3 * index[i] + k];
  const users = Array.from({ length: vertices }, () => []);
  for (let t = 0; t < triangles; t++) {
    const p = (i, k) => positions[9 * t + 3 * i + k];
    const a = [0, 1, 2].map((k) => p(1, k) - p(0, k)), b = [0, 1, 2].map((k) => p(2, k) - p(0, k));
    const n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], size = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; k++) { flat[3 * t + k] = n[k] / size; users[index[3 * t + k]].push(t); }
  }
  const normals = new Float32Array(9 * triangles);
  for (let i = 0; i < index.length; i++) {
    const own = 3 * Math.floor(i / 3);
    let x = 0, y = 0, z = 0;
    for (const t of users[index[i]]) {
      const u = flat[3 * t], v = flat[3 * t + 1], w = flat[3 * t + 2];
      if (u * flat[own] + v * flat[own + 1] + w * flat[own + 2] > CREASE) { x += u; y += v; z += w; }
    }
    const size = Math.hypot(x, y, z) || 1;
    normals.set([x / size, y / size, z / size], 3 * i);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  return geometry;
};
