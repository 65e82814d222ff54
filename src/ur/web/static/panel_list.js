// @ts-check
/** All panels, in the order of their buttons. */

import { CAMERA_PANEL } from "./camera.js";
import { DOCTOR_PANEL } from "./doctor_panel.js";
import { LAYER_PANEL } from "./layers.js";
import { PLACE_PANEL } from "./places.js";
import { PLOT_PANEL } from "./plots.js";
import { PROGRAM_PANEL } from "./program_panel.js";
import { RUN_PANEL } from "./run_panel.js";
import { SPEED_PANEL } from "./speed.js";
import { ZONE_PANEL } from "./zones.js";

/** @type {readonly import("./panels.js").Panel[]} */
export const PANELS = [PLACE_PANEL, ZONE_PANEL, CAMERA_PANEL, SPEED_PANEL, LAYER_PANEL, PLOT_PANEL, PROGRAM_PANEL, RUN_PANEL, DOCTOR_PANEL];
