// @ts-check
/** What the page shows, as the query of its address: a link shows the same elsewhere. */

/** Names of the layers over the map; see `ur.web.wire.layers`. */
export const LAYERS = ["scan", "plan", "local", "global", "particles"];
const DEFAULT = "scan,plan";
const NUMBER = /^-?\d{1,6}(\.\d{1,3})?$/;

/** @typedef {{layers: Set<string>, at: number[] | null, follow: boolean}} LinkState `at`: x, y in m, pixels a metre */

/** What is malformed is as if it were missing. @param {string} search @returns {LinkState} */
export function readLink(search) {
  const query = new URLSearchParams(search);
  const names = (query.get("layers") ?? DEFAULT).split(",");
  const at = (query.get("at") ?? "").split(",");
  return {
    layers: new Set(names.filter((name) => LAYERS.includes(name))),
    at: at.length === 3 && at.every((part) => NUMBER.test(part)) ? at.map(Number) : null,
    follow: query.get("follow") === "1",
  };
}

/** @param {Set<string>} layers */
export function listLayers(layers) {
  return LAYERS.filter((name) => layers.has(name)).join(",");
}

/** The query; empty for what a page shows at first. @param {LinkState} state */
export function writeLink({ layers, at, follow }) {
  const names = listLayers(layers);
  const parts = [];
  if (names !== DEFAULT) parts.push(`layers=${names}`);
  if (follow) parts.push("follow=1");
  if (at) parts.push(`at=${at.map((part) => Number(part.toFixed(2))).join(",")}`);
  return parts.length ? `?${parts.join("&")}` : "";
}

/** Have a map show what the address asks for; returns whether it follows the robot. @param {import("./map_view.js").MapView} map */
export function openLink(map) {
  const { layers, at, follow } = readLink(location.search);
  map.layers = layers;
  if (at) map.show(at);
  return follow;
}

/** Have the address say what a map shows. @param {import("./map_view.js").MapView} map */
export function keepLink({ layers, view, whole, follow }) {
  const at = whole ? null : follow ? [0, 0, view.scale] : [view.x, view.y, view.scale];
  const query = writeLink({ layers, at, follow });
  if (query !== location.search) history.replaceState(null, "", `/${query}`);
}
