// @ts-check
/** All panels, in the order of their buttons. */

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
import { ROBOT_PANEL } from "./robot_panel.js";
import { ROUTE_PANEL } from "./route.js";
import { RUN_PANEL } from "./run_panel.js";
import { SPEED_PANEL } from "./speed.js";
import { ZONE_PANEL } from "./zones.js";

/** @type {readonly import("./panels.js").Panel[]} */
export const PANELS = [
  PLACE_PANEL,
  ROUTE_PANEL,
  MAP_PANEL,
  MAP_LIST_PANEL,
  ZONE_PANEL,
  CAMERA_PANEL,
  SPEED_PANEL,
  LAYER_PANEL,
  PLOT_PANEL,
  PROGRAM_PANEL,
  RUN_PANEL,
  TOPIC_PANEL,
  RECORDING_PANEL,
  SCENE_PANEL,
  STATUS_PANEL,
  DOCTOR_PANEL,
  ASSISTANT_PANEL,
  DEVICE_PANEL,
  ROBOT_PANEL,
];
