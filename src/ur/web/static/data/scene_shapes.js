// @ts-check
/** Shapes of the 3D view: of the robot's model, of markers, and labels. THREE is what three.js defines. */

/** @typedef {any} Three */

const LABEL = 0.25; // m: the height of a label that tells none

/** @param {Three} THREE @param {number[]} rgba @param {boolean} [coloured] each corner has a colour of its own */
export function makeMaterial(THREE, [r, g, b, a], coloured = false) {
  return new THREE.MeshLambertMaterial({
    color: coloured ? 0xffffff : new THREE.Color(r, g, b),
    vertexColors: coloured,
    transparent: a < 1,
    opacity: a,
    side: THREE.DoubleSide,
  });
}

/** A cylinder stands along z here. @param {Three} THREE @param {number} radius @param {number} length @param {number} [top] */
export function makeCylinder(THREE, radius, length, top = radius) {
  return new THREE.CylinderGeometry(top, radius, length, 24).rotateX(Math.PI / 2);
}

/** @param {Three} THREE @param {any} shape of the model, other than a mesh */
export function makeGeometry(THREE, { kind, size }) {
  if (kind === "box") return new THREE.BoxGeometry(...size);
  if (kind === "sphere") return new THREE.SphereGeometry(size[0], 20, 14);
  return makeCylinder(THREE, size[0], size[1]);
}

/** @param {Three} THREE @param {Float32Array} triangles */
export function makeTriangles(THREE, triangles) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(triangles, 3));
  geometry.computeVertexNormals();
  return geometry;
}

/** A text that faces the camera. @param {Three} THREE @param {string} text @param {number[]} rgba @param {number} [height] m */
export function makeLabel(THREE, text, [r, g, b, a], height = LABEL) {
  const canvas = document.createElement("canvas");
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const font = "36px system-ui";
  context.font = font;
  const shown = text.slice(0, 80);
  canvas.width = Math.min(2048, Math.ceil(context.measureText(shown).width) + 8);
  canvas.height = 48;
  context.font = font;
  context.fillStyle = `rgba(${[r, g, b].map((each) => Math.round(255 * each)).join()}, ${a})`;
  context.fillText(shown, 4, 36);
  const material = new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), depthTest: false });
  const sprite = new THREE.Sprite(material);
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  return sprite;
}

/** @param {Three} THREE @param {any} marker see `ur_nodes.web.scene.feed` */
export function makeMarker(THREE, marker) {
  const { kind, pose, scale, color, points = [], colors } = marker;
  const [sx, sy, sz] = scale.map((/** @type {number} */ each) => Math.max(Math.abs(each), 1e-4));
  const flat = new Float32Array(points);
  let made;
  if (kind === "text") made = makeLabel(THREE, marker.text ?? "", color, sz);
  else if (kind === "arrow") made = makeArrow(THREE, flat, [sx, sy], color);
  else if (kind === "triangles") {
    made = new THREE.Mesh(makeTriangles(THREE, flat), makeMaterial(THREE, color, Boolean(colors)));
    if (colors) made.geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(colors), 3));
  } else if (kind === "cube_list" || kind === "sphere_list") {
    const geometry = kind === "cube_list" ? new THREE.BoxGeometry(sx, sy, sz) : new THREE.SphereGeometry(sx / 2, 10, 8);
    made = new THREE.InstancedMesh(geometry, makeMaterial(THREE, colors ? [1, 1, 1, color[3] || 1] : color), flat.length / 3);
    for (let index = 0; index < flat.length / 3; index++) {
      made.setMatrixAt(index, new THREE.Matrix4().setPosition(...flat.slice(3 * index, 3 * index + 3)));
      if (colors) made.setColorAt(index, new THREE.Color(...colors.slice(3 * index, 3 * index + 3)));
    }
  } else if (["points", "line_strip", "line_list"].includes(kind)) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(flat, 3));
    if (colors) geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(colors), 3));
    const look = { color: colors ? 0xffffff : new THREE.Color(...color.slice(0, 3)), vertexColors: Boolean(colors) };
    if (kind === "points") made = new THREE.Points(geometry, new THREE.PointsMaterial({ ...look, size: sx }));
    else made = new THREE[kind === "line_strip" ? "Line" : "LineSegments"](geometry, new THREE.LineBasicMaterial(look));
  } else {
    const geometry = kind === "cube" ? new THREE.BoxGeometry(1, 1, 1) : kind === "sphere" ? new THREE.SphereGeometry(0.5, 20, 14) : makeCylinder(THREE, 0.5, 1);
    made = new THREE.Mesh(geometry, makeMaterial(THREE, color));
    made.scale.set(sx, sy, sz);
  }
  made.position.set(...pose.slice(0, 3));
  if (kind !== "text") made.quaternion.set(...pose.slice(3)).normalize();
  return made;
}

/** An arrow along x, or between two points. @param {Three} THREE @param {Float32Array} points @param {number[]} scale @param {number[]} color */
function makeArrow(THREE, points, [sx, sy], color) {
  const between = points.length >= 6;
  const from = new THREE.Vector3(...(between ? points.slice(0, 3) : [0, 0, 0]));
  const to = new THREE.Vector3(...(between ? points.slice(3, 6) : [sx, 0, 0]));
  const along = to.clone().sub(from);
  const length = along.length() || 1e-4;
  const arrow = new THREE.ArrowHelper(along.normalize(), from, length, new THREE.Color(...color.slice(0, 3)).getHex(), Math.min(0.3 * length, 0.3), Math.max(between ? sy : 2 * sy, 0.02));
  const group = new THREE.Group();
  group.add(arrow);
  return group;
}

/** Free what an object holds on the graphics card. @param {any} object */
export function dispose(object) {
  object.parent?.remove(object);
  object.traverse((/** @type {any} */ each) => {
    each.geometry?.dispose();
    each.material?.map?.dispose();
    each.material?.dispose?.();
  });
}
