// @ts-check
/** What the page shows, as the query of its address: a link shows the same elsewhere. */

import { LAYERS, SHOWN_AT_FIRST } from "./wire_numbers.js";

/** Names of all that can be switched: the trail is the page's own. */
export const SWITCHES = [...Object.keys(LAYERS), "trail"];
const DEFAULT = SHOWN_AT_FIRST.join(",");
const NUMBER = /^-?\d{1,6}(\.\d{1,3})?$/;

const PLOT = /^\/[A-Za-z0-9_/]{1,100}:[A-Za-z0-9_]{1,40}(\.[A-Za-z0-9_]{1,40}){0,6}$/; // as in ur.web.wire.requests
const MOST_PLOTS = 8;
const PANEL = /^[a-z_]{1,30}$/;
const MOST_PANELS = 4;

/**
 * `at`: x, y in m, pixels a metre; `turned`: with the x axis upwards. `plots`: null while the plots are closed.
 * `panels`: names of the open ones, the newest last. `dock`: pixels of their width, 0: as it is by itself.
 * @typedef {{layers: Set<string>, at: number[] | null, turned: boolean, follow: boolean, plots: Set<string> | null, panels: string[], dock: number}} LinkState
 */

/** What is malformed is as if it were missing. @param {string} search @returns {LinkState} */
export function readLink(search) {
  const query = new URLSearchParams(search);
  const names = (query.get("layers") ?? DEFAULT).split(",");
  const at = (query.get("at") ?? "").split(",");
  const plots = (query.get("plots") ?? "").split(",");
  const plotted = query.has("plots") ? "plots" : ""; // a link with plots opens them beside what is open
  const panels = [...new Set((query.get("panels") ?? plotted).split(","))].filter((name) => PANEL.test(name));
  const dock = query.get("dock") ?? "";
  return {
    layers: new Set(names.filter((name) => SWITCHES.includes(name))),
    at: at.length === 3 && at.every((part) => NUMBER.test(part)) ? at.map(Number) : null,
    turned: query.get("turned") === "1",
    follow: query.get("follow") === "1",
    plots: query.has("plots") ? new Set(plots.filter((plot) => PLOT.test(plot)).slice(0, MOST_PLOTS)) : null,
    panels: (plotted && !panels.includes(plotted) ? [...panels, plotted] : panels).slice(-MOST_PANELS),
    dock: /^\d{3,4}$/.test(dock) ? Number(dock) : 0,
  };
}

/** Names of the layers that the robot's end is asked for. @param {Set<string>} layers */
export function listLayers(layers) {
  return Object.keys(LAYERS).filter((name) => layers.has(name)).join(",");
}

/** The query; empty for what a page shows at first. @param {LinkState} state */
export function writeLink({ layers, at, turned, follow, plots, panels, dock }) {
  const names = SWITCHES.filter((name) => layers.has(name)).join(",");
  const parts = [];
  if (names !== DEFAULT) parts.push(`layers=${names}`);
  if (follow) parts.push("follow=1");
  if (at) parts.push(`at=${at.map((part) => Number(part.toFixed(2))).join(",")}`);
  if (at && turned) parts.push("turned=1");
  if (panels.some((name) => name !== "plots")) parts.push(`panels=${panels.join(",")}`);
  if (dock) parts.push(`dock=${dock}`);
  if (plots) parts.push(`plots=${[...plots].join(",")}`);
  return parts.length ? `?${parts.join("&")}` : "";
}

/** Have a map show what the address asks for; returns the rest of that. @param {import("./map_view.js").MapView} map */
export function openLink(map) {
  const state = readLink(location.search);
  map.layers = state.layers;
  if (state.at) map.show(state.at, state.turned);
  return state;
}

/** Have the address say what the page shows. @param {import("./main.js").Page} page */
export function keepLink({ map, plots, panels }) {
  if (!panels) return; // the page is being made
  const { layers, view, whole, follow } = map;
  const { turned } = view;
  const at = whole ? null : follow ? [0, 0, view.scale] : [view.x, view.y, view.scale];
  const { shown, dock } = panels;
  const query = writeLink({ layers, at, turned, follow, plots: panels.isOpen("plots") ? plots : null, panels: shown, dock: dock.width });
  if (query !== location.search) history.replaceState(null, "", `/${query}`);
}
