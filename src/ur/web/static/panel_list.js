// @ts-check
/** All panels, in the order of their buttons. */

import { LAYER_PANEL } from "./layers.js";
import { PLACE_PANEL } from "./places.js";

/** @type {readonly import("./panels.js").Panel[]} */
export const PANELS = [PLACE_PANEL, LAYER_PANEL];
