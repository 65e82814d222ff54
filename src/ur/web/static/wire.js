// @ts-check
/** Frames of the server, decoded: see `ur.web.wire.frames`, which writes them. Little endian. */

import { UNIT } from "./wire_numbers.js";

export { KIND, LAYER, TILE } from "./wire_numbers.js";
export const HEAD = 6;

/**
 * @typedef {{x: number, y: number, yaw: number, speed: number, turn: number, age: number, linkAge: number}} Pose
 * @typedef {{generation: number, resolution: number, x: number, y: number, yaw: number, column: number, row: number,
 *   width: number, height: number}} Grid
 * @typedef {{kind: number, layer: number, x: number, y: number, view: DataView<ArrayBuffer>}} Frame
 */

/** @param {ArrayBuffer} buffer @returns {Frame} */
export function readFrame(buffer) {
  const view = new DataView(buffer);
  return {
    kind: view.getUint8(0),
    layer: view.getUint8(1),
    x: view.getInt16(2, true),
    y: view.getInt16(4, true),
    view,
  };
}

/** @param {Frame} frame @returns {any} */
export function readJson(frame) {
  return JSON.parse(new TextDecoder().decode(new Uint8Array(frame.view.buffer, HEAD)));
}

/** @param {Frame} frame @returns {Pose} */
export function readPose(frame) {
  const at = (/** @type {number} */ index) => frame.view.getFloat32(HEAD + 4 * index, true);
  return { x: at(0), y: at(1), yaw: at(2), speed: at(3), turn: at(4), age: at(5), linkAge: at(6) };
}

/** Points as x, y, x, y, ... in metres. @param {Frame} frame @returns {Float32Array<ArrayBuffer>} */
export function readPoints(frame) {
  const count = (frame.view.byteLength - HEAD - 8) >> 1;
  const anchor = [frame.view.getFloat32(HEAD, true), frame.view.getFloat32(HEAD + 4, true)];
  const points = new Float32Array(count);
  for (let index = 0; index < count; index++) {
    points[index] = anchor[index & 1] + UNIT * frame.view.getInt16(HEAD + 8 + 2 * index, true);
  }
  return points;
}

/** @param {Frame} frame @returns {Grid} */
export function readGrid(frame) {
  const { view } = frame;
  const real = (/** @type {number} */ index) => view.getFloat32(HEAD + 4 + 4 * index, true);
  return {
    generation: view.getUint32(HEAD, true),
    resolution: real(0),
    x: real(1),
    y: real(2),
    yaw: real(3),
    column: view.getInt32(HEAD + 20, true),
    row: view.getInt32(HEAD + 24, true),
    width: view.getUint32(HEAD + 28, true),
    height: view.getUint32(HEAD + 32, true),
  };
}

/** The generation of a tile and its cells, row by row from the lower left. @param {Frame} frame */
export async function readTile(frame) {
  const generation = frame.view.getUint32(HEAD, true);
  const packed = new Blob([new Uint8Array(frame.view.buffer, HEAD + 4)]);
  const stream = packed.stream().pipeThrough(new DecompressionStream("deflate"));
  return { generation, cells: new Int8Array(await new Response(stream).arrayBuffer()) };
}
