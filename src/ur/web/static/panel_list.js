// @ts-check
/** All panels, in groups by what a person wants; each in one of them. */

import { ASSISTANT_PANEL } from "./assistants.js";
import { CAMERA_PANEL } from "./camera.js";
import { RECORDING_PANEL, SCENE_PANEL, STATUS_PANEL, TOPIC_PANEL } from "./data/data_panels.js";
import { DEVICE_PANEL } from "./devices.js";
import { DOCTOR_PANEL } from "./doctor_panel.js";
import { LAYER_PANEL } from "./layers.js";
import { MAP_LIST_PANEL } from "./map_list.js";
import { MAP_PANEL } from "./map_panel.js";
import { PLACE_PANEL } from "./places.js";
import { PLOT_PANEL } from "./plots.js";
import { PROGRAM_PANEL } from "./program_panel.js";
import { ROUTE_PANEL } from "./route.js";
import { RUN_PANEL } from "./run_panel.js";
import { SPEED_PANEL } from "./speed.js";
import { TEXTS } from "./texts.js";
import { ZONE_PANEL } from "./zones.js";

/** @type {readonly import("./panels.js").Group[]} */
export const GROUPS = [
  { label: TEXTS.groups.drive, icon: "M12 3l7 17-7-4-7 4z", panels: [PLACE_PANEL, ROUTE_PANEL, SPEED_PANEL, ASSISTANT_PANEL, DEVICE_PANEL] },
  { label: TEXTS.groups.map, icon: "M3 6l6-2 6 2 6-2v14l-6 2-6-2-6 2zM9 4v14M15 6v14", panels: [MAP_PANEL, MAP_LIST_PANEL, ZONE_PANEL, LAYER_PANEL] },
  { label: TEXTS.groups.sensors, icon: "M4 20a16 16 0 0 1 16-16M4 20a10 10 0 0 1 10-10M4 20l3-3", panels: [CAMERA_PANEL, SCENE_PANEL, PLOT_PANEL] },
  { label: TEXTS.groups.programs, icon: "M4 5h16v14H4zM8 10l3 2.5-3 2.5M13 15h4", panels: [PROGRAM_PANEL, RUN_PANEL, RECORDING_PANEL] },
  { label: TEXTS.groups.diagnostics, icon: "M3 12h4l3-7 4 14 3-7h4", panels: [STATUS_PANEL, DOCTOR_PANEL, TOPIC_PANEL] },
];
