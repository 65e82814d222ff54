// @ts-check
/** Made by tools/make_wire_numbers.py: edit src/ur/web/wire/frames.py or layers.py instead. */

export const KIND = { SERVER: 0, STATE: 1, POSE: 2, POINTS: 3, GRID: 4, TILE: 5, PLACES: 6, OVERLAY: 7, VALUES: 8, FIELDS: 9, ZONES: 16, CAMERA: 17 };
export const LAYER = { NONE: 0, MAP: 1, SCAN: 2, PLAN: 3, GLOBAL: 4, LOCAL: 5, PARTICLES: 6, SONARS: 7, COVARIANCE: 8, FIDUCIALS: 9, ROBOTS: 10, PLOTS: 11, FRONTIERS: 12, CAMERA: 16 };
export const TILE = 256;
export const UNIT = 0.005;
/** Labels of the layers over the map, by name. @type {Record<string, string>} */
export const LAYERS = {
  "scan": "Lidar",
  "plan": "Planned path",
  "local": "Obstacles near the robot",
  "global": "Obstacles on the map",
  "particles": "Possible positions (particles)",
  "covariance": "Uncertainty of the position",
  "sonars": "Sonars",
  "fiducials": "Fiducials",
  "robots": "Other robots",
  "frontiers": "Frontiers (grey: given up)"
};
export const SHOWN_AT_FIRST = ["scan", "plan", "frontiers"];
