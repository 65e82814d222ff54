// @ts-check
/** Lines above the map about what the user has to know, each with the buttons that change it. */

import { make, makeButton } from "./elements.js";
import { announce } from "./heard.js";
import { TEXTS } from "./texts.js";

/**
 * `subject` names what the text is about where one line tells of it in changing words.
 * @typedef {{text: string, subject?: string, red?: boolean, buttons?: {label: string, act: () => void}[]}} Banner
 */

/**
 * Shows banners, and announces new ones. An element stays while only numbers of its text change, or its subject
 * stays, and a button while its label does, so that neither a press on it nor the focus is lost.
 */
export class Banners {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.box = box;
    this.shown = "";
    /** @type {Map<string, HTMLElement>} */
    this.elements = new Map();
    new ResizeObserver(() => document.body.style.setProperty("--banners", `${box.offsetHeight}px`)).observe(box);
  }

  /** @param {Banner[]} banners */
  show(banners) {
    const key = JSON.stringify(banners);
    if (key === this.shown) return;
    this.shown = key;
    /** @type {Map<string, HTMLElement>} */
    const after = new Map();
    for (const banner of banners) {
      const known = this.elements.get(identify(banner));
      const element = known ?? makeBanner(banner);
      const [text] = element.children;
      if (!known || withoutNumbers(text.textContent ?? "") !== withoutNumbers(banner.text)) announce(banner.text, banner.red);
      if (text.textContent !== banner.text) text.textContent = banner.text;
      if (banner.buttons?.length) fill(/** @type {HTMLElement} */ (element.children[1]), banner.buttons);
      after.set(identify(banner), element);
    }
    for (const [id, element] of this.elements) if (!after.has(id)) element.remove();
    this.elements = after;
    [...after.values()].forEach((element, index) => {
      if (this.box.children[index] !== element) this.box.insertBefore(element, this.box.children[index] ?? null);
    });
  }
}

/** What makes a banner another one: all but its numbers, such as an age, or its subject. @param {Banner} banner */
function identify({ text, subject, red, buttons = [] }) {
  return JSON.stringify([subject ?? withoutNumbers(text), red, subject ? buttons.length : buttons.map(({ label }) => label)]);
}

/** Show buttons; each whose label stays is the same element. @param {HTMLElement} box @param {{label: string, act: () => void}[]} buttons */
function fill(box, buttons) {
  buttons.forEach(({ label, act }, index) => {
    const known = box.children[index];
    if (!known) box.append(makeButton(label, act));
    else if (known.textContent !== label) known.replaceWith(makeButton(label, act));
  });
}

/** @param {string} text */
function withoutNumbers(text) {
  return text.replace(/\d+/g, "0");
}

/** @param {Banner} banner */
function makeBanner(banner) {
  const element = document.createElement("div");
  element.className = banner.red ? "banner red" : "banner";
  const text = document.createElement("span");
  text.textContent = banner.text;
  element.append(text);
  if (banner.buttons?.length) element.append(make("div"));
  return element;
}

/**
 * What is wrong with the connection; an empty list while it is good.
 * @param {{age: number, server: any, pose: import("./wire.js").Pose | null, poseAge: number}} facts
 * @returns {Banner[]}
 */
export function describeLink({ age, server, pose, poseAge }) {
  if (age > 2) return [{ text: Number.isFinite(age) ? TEXTS.lost(age) : TEXTS.connecting }];
  if (!server) return [];
  if (server.moved && (server.end !== "up" || !pose || pose.linkAge > 1)) return [{ text: TEXTS.moved(server.moved) }];
  if (server.end === "no master") return [{ text: TEXTS.noMaster(server.robot) }];
  if (server.end === "starting" && server.problem) return [{ text: TEXTS.robotEndFails(server.problem) }];
  if (server.end === "starting" || !pose || poseAge > 2) return [{ text: TEXTS.starting }];
  if (pose.linkAge > 1) return [{ text: TEXTS.silent(pose.linkAge) }];
  return [];
}

/**
 * Who drives, where that is not this page.
 * @param {any} lease @param {string} client @param {boolean} mayDrive
 * @param {(action: string) => void} request
 * @returns {Banner[]}
 */
export function describeDriver(lease, client, mayDrive, request) {
  if (!lease) return [];
  const mine = client !== "" && lease.client === client;
  const button = (/** @type {string} */ label, /** @type {string} */ action) => ({ label, act: () => request(action) });
  if (mine) {
    return lease.asking.length
      ? [{ text: TEXTS.asks(lease.asking[0].name), buttons: [button(TEXTS.handOver, "grant")] }]
      : [];
  }
  const who = lease.program ? `${lease.name} (${lease.program})` : lease.name;
  if (lease.state === "held") {
    const asks = lease.asking.some((/** @type {any} */ each) => each.client === client);
    const text = TEXTS.drives(who, lease.since) + (asks ? ` ${TEXTS.asked}` : "");
    const buttons = [button(TEXTS.takeOver, "take"), ...(asks ? [] : [button(TEXTS.ask, "ask")])];
    return [{ text, buttons: mayDrive ? buttons : [] }];
  }
  if (lease.state === "lost") {
    return [{ text: TEXTS.away(who, lease.until), buttons: mayDrive ? [button(TEXTS.takeOver, "take")] : [] }];
  }
  if (lease.note) return [{ text: `${lease.note}.`, buttons: [] }];
  return [];
}

/** Who drives and by what, in a few words. @param {any} state @param {string} client */
export function describeDriving(state, client) {
  const lease = state?.lease;
  if (!lease) return "";
  const active = state.mux.active;
  const source = TEXTS.sources[active] ?? active;
  if (lease.state !== "held" && state.exploring?.state === "exploring") return TEXTS.driver(TEXTS.sources.exploring);
  if (lease.state !== "held") return active ? TEXTS.driver(source) : TEXTS.noDriver;
  const who = lease.client === client ? TEXTS.youDrive : TEXTS.driver(lease.name);
  return active ? `${who} (${source})` : who;
}
