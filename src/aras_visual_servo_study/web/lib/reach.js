// The plane on which the target lies, shaded by where the arm can bring the camera to the taught view.

/** How dark the shading is within reach, and out of it. */
const WITHIN = 0.34, BEYOND = 0.22;
/** Out of reach the shading grows to its full strength until so much is missing [mm]. */
const FULL_MM = 60;

/** Line segments, [x, y, x, y, ...] in places of the grid, between places within reach (0) and others: marching squares. */
export const limits = (missing) => {
  const out = [], cut = (a, b) => (a === 0) !== (b === 0);
  for (let y = 0; y + 1 < missing.length; y++) for (let x = 0; x + 1 < missing[y].length; x++) {
    const corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]], values = corners.map(([i, j]) => missing[j][i]), ends = [];
    for (let k = 0; k < 4; k++) {
      const next = (k + 1) % 4;
      if (cut(values[k], values[next])) ends.push((corners[k][0] + corners[next][0]) / 2, (corners[k][1] + corners[next][1]) / 2);
    }
    out.push(...ends);
  }
  return out;
};

/** The shaded plane. reach: as the run answers `reach`.  colours: { within, beyond }. */
export const reachPlane = ({ pose, first_m, step_m, missing_mm }, colours) => {
  const rows = missing_mm.length, columns = missing_mm[0].length, picture = document.createElement("canvas");
  picture.width = columns;
  picture.height = rows;
  const pen = picture.getContext("2d"), pixels = pen.createImageData(columns, rows);
  missing_mm.forEach((row, y) => row.forEach((mm, x) => {
    const color = mm === 0 ? colours.within : colours.beyond, alpha = mm === 0 ? WITHIN : BEYOND * (0.5 + 0.5 * Math.min(1, mm / FULL_MM));
    pixels.data.set([color >> 16, (color >> 8) & 255, color & 255, Math.round(255 * alpha)], 4 * ((rows - 1 - y) * columns + x));
  }));
  pen.putImageData(pixels, 0, 0);
  const texture = new THREE.CanvasTexture(picture);
  texture.encoding = THREE.sRGBEncoding;
  texture.generateMipmaps = false;
  texture.minFilter = THREE.LinearFilter;
  texture.magFilter = THREE.LinearFilter;
  const group = new THREE.Group(), plane = new THREE.Mesh(new THREE.PlaneBufferGeometry(columns * step_m[0], rows * step_m[1]),
    new THREE.MeshBasicMaterial({ map: texture, transparent: true, side: THREE.DoubleSide, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
  plane.position.set(first_m[0] + (columns - 1) / 2 * step_m[0], first_m[1] + (rows - 1) / 2 * step_m[1], 0);
  const ends = limits(missing_mm), points = [];
  for (let i = 0; i < ends.length; i += 2) points.push(new THREE.Vector3(first_m[0] + ends[i] * step_m[0], first_m[1] + ends[i + 1] * step_m[1], 0.0005));
  const line = new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color: new THREE.Color(colours.within).convertSRGBToLinear() }));
  group.add(plane, line);
  group.position.set(...pose.slice(0, 3));
  group.quaternion.set(...pose.slice(3));
  group.visible = false;
  return group;
};
