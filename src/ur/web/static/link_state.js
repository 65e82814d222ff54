// @ts-check
/** What the page shows, as the query of its address: a link shows the same elsewhere. */

/** Names of the layers over the map; see `ur.web.wire.layers`. */
export const LAYERS = ["scan", "plan", "local", "global", "particles", "covariance", "sonars", "fiducials", "robots"];
/** All that can be switched: the trail is the page's own. */
export const SWITCHES = [...LAYERS, "trail"];
const DEFAULT = "scan,plan";
const NUMBER = /^-?\d{1,6}(\.\d{1,3})?$/;

const PLOT = /^\/[A-Za-z0-9_/]{1,100}:[A-Za-z0-9_]{1,40}(\.[A-Za-z0-9_]{1,40}){0,6}$/; // as in ur.web.wire.plots
const MOST_PLOTS = 8;

/**
 * `at`: x, y in m, pixels a metre. `plots`: null while the plots are closed.
 * @typedef {{layers: Set<string>, at: number[] | null, follow: boolean, plots: Set<string> | null}} LinkState
 */

/** What is malformed is as if it were missing. @param {string} search @returns {LinkState} */
export function readLink(search) {
  const query = new URLSearchParams(search);
  const names = (query.get("layers") ?? DEFAULT).split(",");
  const at = (query.get("at") ?? "").split(",");
  const plots = (query.get("plots") ?? "").split(",");
  return {
    layers: new Set(names.filter((name) => SWITCHES.includes(name))),
    at: at.length === 3 && at.every((part) => NUMBER.test(part)) ? at.map(Number) : null,
    follow: query.get("follow") === "1",
    plots: query.has("plots") ? new Set(plots.filter((plot) => PLOT.test(plot)).slice(0, MOST_PLOTS)) : null,
  };
}

/** Names of the layers that the robot's end is asked for. @param {Set<string>} layers */
export function listLayers(layers) {
  return LAYERS.filter((name) => layers.has(name)).join(",");
}

/** The query; empty for what a page shows at first. @param {LinkState} state */
export function writeLink({ layers, at, follow, plots }) {
  const names = SWITCHES.filter((name) => layers.has(name)).join(",");
  const parts = [];
  if (names !== DEFAULT) parts.push(`layers=${names}`);
  if (follow) parts.push("follow=1");
  if (at) parts.push(`at=${at.map((part) => Number(part.toFixed(2))).join(",")}`);
  if (plots) parts.push(`plots=${[...plots].join(",")}`);
  return parts.length ? `?${parts.join("&")}` : "";
}

/** Have a map show what the address asks for; returns the rest of that. @param {import("./map_view.js").MapView} map */
export function openLink(map) {
  const state = readLink(location.search);
  map.layers = state.layers;
  if (state.at) map.show(state.at);
  return state;
}

/** Have the address say what the page shows. @param {import("./main.js").Page} page */
export function keepLink({ map, plots, plotting }) {
  const { layers, view, whole, follow } = map;
  const at = whole ? null : follow ? [0, 0, view.scale] : [view.x, view.y, view.scale];
  const query = writeLink({ layers, at, follow, plots: plotting ? plots : null });
  if (query !== location.search) history.replaceState(null, "", `/${query}`);
}
