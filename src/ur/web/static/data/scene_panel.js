// @ts-check
/** The panel of the 3D view: what it shows, and its data. three.js is loaded when the panel is opened first. */

import { make, makeNote, replaceRows } from "../elements.js";
import { DATA } from "./data_socket.js";
import { listTree, readCloud, readFrames, readTriangles } from "./scene_data.js";
import { SceneView } from "./scene_view.js";
import { DATA_TEXTS } from "./texts.js";

const MOST = 4; // topics; see ur.web.wire.data_requests
const PERIOD = 500; // ms between two looks at the map

/** @type {import("./data_panels.js").Maker} */
export function makeScenePanel(box, page) {
  const panel = new ScenePanel(box, page);
  Object.assign(page, { scenePanel: panel });
  return { show: (open) => panel.show(open) };
}

/** three.js, which makes a global of its own. The server explains where it cannot be installed. */
async function loadThree() {
  const found = /** @type {any} */ (globalThis);
  if (found.THREE) return found.THREE;
  const answer = await fetch("/three.js").catch(() => null);
  if (!answer?.ok) throw new Error(answer ? await answer.text() : DATA_TEXTS.noAnswer);
  const script = make("script");
  script.src = "/three.js";
  await new Promise((done, fail) => {
    script.onload = done;
    script.onerror = () => fail(new Error(DATA_TEXTS.noAnswer));
    document.head.append(script);
  });
  return found.THREE;
}

class ScenePanel {
  /** @param {HTMLElement} box @param {import("../main.js").Page} page */
  constructor(box, page) {
    this.page = page;
    this.opened = false;
    /** @type {SceneView | null} */
    this.view = null;
    /** @type {Set<string>} */
    this.chosen = new Set();
    this.offered = "";
    this.asked = false;
    this.note = makeNote(DATA_TEXTS.loadingScene);
    this.canvas = make("canvas", "", "scene");
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.ariaLabel = DATA_TEXTS.scenePicture;
    this.problems = make("p");
    this.switches = make("div", "", "ticks");
    this.topics = make("ul");
    this.topicNote = make("p");
    const topics = make("details");
    topics.append(make("summary", DATA_TEXTS.sceneTopics), this.topicNote, this.topics);
    this.tree = make("ul", "", "tree");
    this.treeBox = make("details");
    this.treeBox.append(make("summary", DATA_TEXTS.tree), this.tree);
    this.treeBox.addEventListener("toggle", () => this.showTree());
    box.append(this.note, this.canvas, make("p", DATA_TEXTS.sceneHelp), this.switches, topics, this.treeBox, this.problems);
    DATA.on("tf", ({ frames }) => this.setFrames(readFrames(frames)));
    DATA.on("scene", (message) => this.offer(message.topics));
    DATA.on("markers", ({ topic, markers }) => this.chosen.has(topic) && this.view?.setMarkers(topic, markers));
    DATA.on("binary", (buffer) => {
      const cloud = readCloud(buffer);
      if (cloud && this.chosen.has(cloud.topic)) this.view?.setCloud(cloud);
    });
    DATA.on("state", (end) => {
      this.asked &&= end === "up";
      this.loadModel();
    });
    setInterval(() => this.follow(), PERIOD);
  }

  /** @param {boolean} open */
  async show(open) {
    this.opened = open;
    DATA.use(open);
    this.ask();
    if (this.view) this.view.open = open;
    if (!open) return;
    if (!this.view) await this.start();
    this.loadModel();
    this.view?.request();
  }

  async start() {
    try {
      const THREE = await loadThree();
      this.view = new SceneView(THREE, this.canvas);
      this.note.hidden = true;
    } catch (problem) {
      this.note.textContent = problem instanceof Error && !/webgl/i.test(problem.message) ? problem.message : DATA_TEXTS.noWebgl;
      return;
    }
    this.view.open = this.opened;
    for (const name of Object.keys(this.view.layers)) this.switches.append(this.makeSwitch(name));
    this.ask();
  }

  ask() {
    DATA.show({ scene: this.opened && this.view ? [...this.chosen] : undefined });
  }

  /** @param {string} name */
  makeSwitch(name) {
    const label = make("label");
    const input = make("input");
    input.type = "checkbox";
    input.checked = this.view?.layers[name] ?? false;
    input.addEventListener("change", () => this.view?.setLayer(name, input.checked));
    label.append(input, DATA_TEXTS.layers[/** @type {"map"} */ (name)]);
    return label;
  }

  /** @param {[string, string][]} topics names and types */
  offer(topics) {
    const text = JSON.stringify(topics);
    if (text === this.offered) return;
    this.offered = text;
    this.topicNote.textContent = topics.length ? "" : DATA_TEXTS.noSceneTopics;
    replaceRows(this.topics, topics.map(([name]) => {
      const row = make("li");
      const label = make("label");
      const input = make("input");
      input.type = "checkbox";
      input.checked = this.chosen.has(name);
      input.ariaLabel = name;
      input.addEventListener("change", () => this.choose(name, input));
      label.append(input, name);
      row.append(label);
      return row;
    }));
  }

  /** @param {string} name @param {HTMLInputElement} input */
  choose(name, input) {
    if (input.checked && this.chosen.size >= MOST) {
      input.checked = false;
      this.page.say(DATA_TEXTS.tooMany(MOST));
    } else if (input.checked) this.chosen.add(name);
    else {
      this.chosen.delete(name);
      this.view?.setTopic(name, []);
    }
    this.ask();
  }

  /** @param {Map<string, import("./scene_data.js").Frame>} frames */
  setFrames(frames) {
    this.view?.setFrames(frames);
    this.showTree();
  }

  showTree() {
    if (!this.treeBox.open || !this.view) return;
    const lines = listTree(this.view.frames);
    const text = JSON.stringify(lines);
    if (this.tree.dataset.shown === text) return;
    this.tree.dataset.shown = text;
    this.tree.replaceChildren(...lines.map(([name, depth]) => make("li", `${"\u00a0\u00a0\u00a0".repeat(depth)}${name}`)));
  }

  async loadModel() {
    if (!this.view || !this.opened || this.asked || DATA.end !== "up") return;
    this.asked = true;
    const answer = await DATA.request({ t: "model" });
    this.asked = Boolean(answer);
    this.problems.textContent = answer?.text ?? "";
    if (!answer?.ok || !this.view) return;
    this.view.clearModel();
    /** Meshes by address: the same one may be drawn often. @type {Map<string, any>} */
    const meshes = new Map();
    for (const shape of answer.value) {
      if (shape.mesh && !meshes.has(shape.mesh)) meshes.set(shape.mesh, await this.loadMesh(shape.mesh));
      this.view.addShape(shape, meshes.get(shape.mesh) ?? null);
    }
  }

  /** @param {string} mesh */
  async loadMesh(mesh) {
    const answer = await DATA.request({ t: "mesh", mesh });
    if (!answer?.ok) {
      this.problems.textContent = DATA_TEXTS.noMesh(mesh, answer?.text ?? "");
      return null;
    }
    const { extent, triangles } = answer.value;
    return { extent, triangles: triangles ? readTriangles(triangles) : null };
  }

  /** Take over what the map of the page shows. */
  follow() {
    if (!this.view || !this.opened) return;
    this.view.setMap(this.page.map.tiles);
    if (this.view.layers.scan) this.view.setScan(this.page.map.scan);
  }
}
