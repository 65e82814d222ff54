// @ts-check
/** Data of the 3D view, read from frames: see `ur_nodes.web.scene`. */

/** @typedef {{topic: string, frame: string, positions: Float32Array, colours: Float32Array | null}} Cloud */

/** @param {ArrayBuffer} buffer @returns {Cloud | null} null: of another version */
export function readCloud(buffer) {
  const view = new DataView(buffer);
  if (view.getUint8(0) !== 1) return null;
  let at = 1;
  const readText = () => {
    const length = view.getUint8(at);
    const text = new TextDecoder().decode(new Uint8Array(buffer, at + 1, length));
    at += 1 + length;
    return text;
  };
  const [topic, frame] = [readText(), readText()];
  const unit = view.getFloat32(at, true);
  const middle = [4, 8, 12].map((offset) => view.getFloat32(at + offset, true));
  const count = view.getUint32(at + 16, true);
  const coloured = view.getUint8(at + 20) !== 0;
  at += 21;
  const positions = new Float32Array(3 * count);
  for (let index = 0; index < 3 * count; index++) positions[index] = middle[index % 3] + unit * view.getInt16(at + 2 * index, true);
  at += 6 * count;
  const colours = coloured ? Float32Array.from(new Uint8Array(buffer, at, 3 * count), (each) => each / 255) : null;
  return { topic, frame, positions, colours };
}

/** A frame: its parent, and its pose in it: x, y, z, and a quaternion x, y, z, w. @typedef {{parent: string, pose: number[]}} Frame */

/** @param {any[][]} rows @returns {Map<string, Frame>} */
export function readFrames(rows) {
  return new Map(rows.map(([child, parent, ...pose]) => [child, { parent, pose }]));
}

/** The frame that everything is drawn in: the map, or what is highest. @param {Map<string, Frame>} frames */
export function chooseRoot(frames) {
  const parents = new Set([...frames.values()].map(({ parent }) => parent));
  for (const name of ["map", "odom"]) if (frames.has(name) || parents.has(name)) return name;
  return [...parents].find((name) => !frames.has(name)) ?? "";
}

/** The tree of frames as lines, each with its depth. @param {Map<string, Frame>} frames @returns {[string, number][]} */
export function listTree(frames) {
  /** @type {Map<string, string[]>} */
  const children = new Map();
  for (const [name, { parent }] of frames) children.set(parent, [...(children.get(parent) ?? []), name]);
  /** @type {[string, number][]} */
  const lines = [];
  const seen = new Set();
  const walk = (/** @type {string} */ name, /** @type {number} */ depth) => {
    if (seen.has(name) || depth > 50) return; // a loop
    seen.add(name);
    lines.push([name, depth]);
    for (const child of (children.get(name) ?? []).sort()) walk(child, depth + 1);
  };
  for (const name of [...children.keys()].sort()) if (!frames.has(name)) walk(name, 0);
  return lines;
}

/** Triangles (x, y, z of each corner) of a text in base 64. @param {string} text */
export function readTriangles(text) {
  return new Float32Array(Uint8Array.from(atob(text), (each) => each.charCodeAt(0)).buffer);
}
