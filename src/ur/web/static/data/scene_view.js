// @ts-check
/** The 3D view: objects in their frames, drawn when something has changed. THREE is what three.js defines. */

import { TILE } from "../wire.js";
import { Orbit } from "./orbit.js";
import { chooseRoot } from "./scene_data.js";
import { dispose, makeGeometry, makeLabel, makeMarker, makeMaterial, makeTriangles } from "./scene_shapes.js";

const DEEPEST = 60; // frames between one and the root
const MANY_TILES = 64; // above it, tiles are drawn coarsely
const BASES = ["base_footprint", "base_link"];

export class SceneView {
  /** @param {any} THREE @param {HTMLCanvasElement} canvas */
  constructor(THREE, canvas) {
    this.THREE = THREE;
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.05, 1000);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1));
    const sun = new THREE.DirectionalLight(0xffffff, 0.5);
    sun.position.set(3, -2, 6);
    this.scene.add(sun);
    this.orbit = new Orbit(canvas, () => this.request());
    /** @type {Map<string, import("./scene_data.js").Frame>} */
    this.frames = new Map();
    this.root = "";
    /** Groups of objects by the frame that they are in. @type {Map<string, any>} */
    this.groups = new Map();
    /** @type {Map<string, any[]>} */
    this.topics = new Map();
    /** @type {Map<string, any>} */
    this.axes = new Map();
    this.mapGroup = new THREE.Group();
    this.scene.add(this.mapGroup);
    this.mapVersion = -1;
    this.scan = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({ color: 0xd6336c, size: 4, sizeAttenuation: false }));
    this.scan.frustumCulled = false;
    this.scene.add(this.scan);
    /** @type {Record<string, boolean>} */
    this.layers = { model: true, frames: false, map: true, scan: true, follow: true };
    /** @type {any[]} */
    this.model = [];
    this.open = false;
    this.due = false;
    /** Pictures drawn so far. */
    this.drawn = 0;
    new ResizeObserver(() => this.request()).observe(canvas);
  }

  /** Draw soon. */
  request() {
    if (this.due || !this.open || document.hidden) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draw();
    });
  }

  /** @param {Map<string, import("./scene_data.js").Frame>} frames */
  setFrames(frames) {
    this.frames = frames;
    this.root = chooseRoot(frames);
    for (const [name, group] of this.groups) this.place(name, group);
    this.showAxes();
    const base = BASES.find((name) => frames.has(name));
    if (base && this.layers.follow) {
      const pose = this.find(base);
      if (pose) this.orbit.target = [pose.elements[12], pose.elements[13], pose.elements[14]];
    }
    this.request();
  }

  /** The pose of a frame in the root; null where none leads there. @param {string} name */
  find(name) {
    const pose = new this.THREE.Matrix4();
    for (let depth = 0, at = name; at !== this.root; depth++) {
      const frame = this.frames.get(at);
      if (!frame || depth > DEEPEST) return null;
      const [x, y, z, ...turn] = frame.pose;
      const quaternion = new this.THREE.Quaternion(...turn).normalize();
      pose.premultiply(new this.THREE.Matrix4().compose(new this.THREE.Vector3(x, y, z), quaternion, new this.THREE.Vector3(1, 1, 1)));
      at = frame.parent;
    }
    return pose;
  }

  /** @param {string} name @param {any} group */
  place(name, group) {
    const pose = this.find(name);
    group.visible = pose !== null;
    if (pose) group.matrix.copy(pose);
    group.matrixWorldNeedsUpdate = true;
  }

  /** The group of what is in a frame. @param {string} name */
  groupOf(name) {
    let group = this.groups.get(name);
    if (!group) {
      group = new this.THREE.Group();
      group.matrixAutoUpdate = false;
      this.groups.set(name, group);
      this.scene.add(group);
      this.place(name, group);
    }
    return group;
  }

  showAxes() {
    for (const [name, axes] of this.axes) {
      if (this.layers.frames && this.frames.has(name)) continue;
      dispose(axes);
      this.axes.delete(name);
    }
    if (!this.layers.frames) return;
    for (const name of this.frames.keys()) {
      if (this.axes.has(name)) continue;
      const axes = new this.THREE.AxesHelper(0.15);
      const label = makeLabel(this.THREE, name, [0.3, 0.4, 0.55, 1], 0.05);
      label.position.set(0, 0, 0.08);
      axes.add(label);
      this.axes.set(name, axes);
      this.groupOf(name).add(axes);
    }
  }

  /** @param {any} shape @param {{extent: number[][], triangles: Float32Array | null} | null} mesh of a mesh */
  addShape(shape, mesh) {
    const { THREE } = this;
    let geometry;
    if (shape.kind !== "mesh") geometry = makeGeometry(THREE, shape);
    else if (mesh?.triangles) geometry = makeTriangles(THREE, mesh.triangles);
    else {
      const [low, high] = mesh?.extent ?? [[-0.05, -0.05, -0.05], [0.05, 0.05, 0.05]];
      geometry = new THREE.BoxGeometry(...low.map((each, index) => Math.max(high[index] - each, 0.001)));
      geometry.translate(...low.map((each, index) => (high[index] + each) / 2));
    }
    const made = new THREE.Mesh(geometry, makeMaterial(THREE, shape.rgba));
    made.position.set(...shape.xyz);
    made.rotation.set(...shape.rpy, "ZYX");
    if (shape.kind === "mesh") made.scale.set(...shape.size);
    made.visible = this.layers.model;
    this.model.push(made);
    this.groupOf(shape.link).add(made);
    this.request();
  }

  clearModel() {
    this.model.forEach(dispose);
    this.model = [];
  }

  /** Show objects of a topic, each in its frame, in place of those before. @param {string} topic @param {[string, any][]} objects */
  setTopic(topic, objects) {
    this.topics.get(topic)?.forEach(dispose);
    for (const [frame, made] of objects) this.groupOf(frame).add(made);
    this.topics.set(topic, objects.map(([, made]) => made));
    this.request();
  }

  /** @param {import("./scene_data.js").Cloud} cloud */
  setCloud({ topic, frame, positions, colours }) {
    const { THREE } = this;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    if (colours) geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    const look = colours ? { vertexColors: true } : { color: 0x0b7285 };
    this.setTopic(topic, [[frame, new THREE.Points(geometry, new THREE.PointsMaterial({ ...look, size: 3, sizeAttenuation: false }))]]);
  }

  /** @param {string} topic @param {any[]} markers */
  setMarkers(topic, markers) {
    this.setTopic(topic, markers.map((each) => [each.frame, makeMarker(this.THREE, each)]));
  }

  /** Points of the lidar in the map: x, y, x, y, ... @param {Float32Array} points */
  setScan(points) {
    const flat = new Float32Array((points.length / 2) * 3);
    for (let index = 0; index < points.length / 2; index++) {
      [flat[3 * index], flat[3 * index + 1], flat[3 * index + 2]] = [points[2 * index], points[2 * index + 1], 0.15];
    }
    this.scan.geometry.dispose();
    this.scan.geometry = new this.THREE.BufferGeometry();
    this.scan.geometry.setAttribute("position", new this.THREE.BufferAttribute(flat, 3));
    this.request();
  }

  /** Take over the tiles of the map where they have changed. @param {import("../map_tiles.js").MapTiles} tiles */
  setMap(tiles) {
    if (tiles.version === this.mapVersion || !tiles.grid) return;
    const { THREE } = this;
    this.mapVersion = tiles.version;
    for (const each of [...this.mapGroup.children]) dispose(each);
    const { x, y, yaw, resolution } = tiles.grid;
    this.mapGroup.position.set(x, y, 0);
    this.mapGroup.rotation.set(0, 0, yaw);
    const side = TILE * resolution;
    for (const tile of tiles.tiles.values()) {
      const picture = tile.pictures[tiles.tiles.size > MANY_TILES ? 0 : tile.pictures.length - 1];
      const material = new THREE.MeshBasicMaterial({ map: new THREE.CanvasTexture(picture), side: THREE.DoubleSide });
      const plane = new THREE.Mesh(new THREE.PlaneGeometry(side, side), material);
      plane.position.set((tile.column + 0.5) * side, (tile.row + 0.5) * side, -0.005);
      this.mapGroup.add(plane);
    }
    this.request();
  }

  /** @param {string} name @param {boolean} on */
  setLayer(name, on) {
    this.layers[name] = on;
    for (const each of this.model) each.visible = this.layers.model;
    this.showAxes();
    this.request();
  }

  draw() {
    const { canvas, camera, renderer } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    renderer.setSize(width, height, false);
    renderer.setClearColor(getComputedStyle(canvas).getPropertyValue("--back").trim());
    this.mapGroup.visible = this.layers.map && ["map", ""].includes(this.root);
    this.scan.visible = this.layers.scan && this.root === "map";
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    camera.position.set(...this.orbit.place);
    camera.lookAt(...this.orbit.target);
    renderer.render(this.scene, camera);
    this.drawn += 1;
  }
}
