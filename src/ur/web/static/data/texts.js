// @ts-check
/** English texts of the panels with data of the robot; see `../texts.js`. */

export const DATA_TEXTS = {
  topics: "Topics",
  filter: "Filter by name or type",
  columns: ["Topic", "Type", "Rate", "Bandwidth"],
  notConnected: "Waiting for the robot. Start a program of it.",
  connecting: "Connecting ...",
  noneYet: "Nothing yet. Start a program.",
  noAnswer: "No connection to the server: nothing was done.",
  /** @param {number} shown @param {number} all */
  count: (shown, all) => (shown === all ? `${all}` : `${shown} of ${all}`),
  /** @param {number} publishers @param {number} subscribers */
  ends: (publishers, subscribers) => `${publishers} ${publishers === 1 ? "publisher" : "publishers"}, ${subscribers} ${subscribers === 1 ? "subscriber" : "subscribers"}`,
  back: "Back to the list",
  waiting: "Waiting for a message ...",
  /** @param {number} size @param {number} count */
  message: (size, count) => `Message ${count}, ${bytes(size)}.`,
  pause: "Pause",
  resume: "Continue",
  status: "Status",
  levels: /** @type {Record<string, string>} */ ({ ok: "OK", warn: "Warning", error: "Error", stale: "No word" }),
  noDiagnostics: "No node publishes diagnostics (/diagnostics).",
  /** @param {number} bad @param {number} all */
  components: (bad, all) => (bad ? `${bad} of ${all} components need attention.` : `${all} components are OK.`),
  percent: /** @param {number} share */ (share) => `${Math.round(100 * share)} %`,
  battery: "Battery since the page was opened",
  noBattery: "No battery state yet.",
  /** @param {number} minutes */
  ago: (minutes) => (minutes ? `-${minutes} min` : "now"),
  scene: "3D view",
  sceneHelp: "Drag to turn, drag with Shift or two fingers to move, scroll or pinch to zoom. With the keyboard: arrows, + and -.",
  scenePicture: "Robot, map and sensors in three dimensions",
  loadingScene: "Loading the 3D view. The first time it is installed (1 MB).",
  noWebgl: "This browser shows no 3D (WebGL): switch on hardware acceleration.",
  layers: { model: "Robot", frames: "Frames", map: "Map", scan: "Lidar", follow: "Follow the robot" },
  sceneTopics: "Point clouds and markers",
  noSceneTopics: "No topic with point clouds or markers.",
  /** @param {number} most */
  tooMany: (most) => `At most ${most} topics: untick one first.`,
  tree: "Tree of frames",
  /** @param {string} name @param {string} problem */
  noMesh: (name, problem) => `${name} is drawn as a box. ${problem}`,
  recordings: "Recording",
  happened: "What happened",
  saveHappened: "Save what happened",
  happenedHelp: "The robot keeps the last two minutes in memory. This writes them to a file on its computer, with the next 5 s.",
  savingHappened: "Saving what happened ...",
  /** @param {string} place */
  happenedSaved: (place) => `Saved: ${place}`,
  /** @param {string} why */
  happenedNotSaved: (why) => `Not saved: ${why}`,
  record: "Record for longer",
  replay: "Replay",
  pauseReplay: "Pause",
  playReplay: "Play",
  backReplay: "Back 10 s",
  aheadReplay: "Ahead 10 s",
  replaySpeed: "Speed",
  replayPosition: "Position in seconds",
  /** @param {number} position @param {number} length @param {boolean} ended */
  replayState: (position, length, ended) => `${duration(position)} of ${duration(length)}${ended ? ", ended" : ""}`,
  recordingHelp: "All topics but pictures and point clouds are recorded, unless you choose some. At most 60 minutes, and 2 GB in all.",
  nothingRecorded: "Nothing is recorded.",
  /** @param {number} size @param {number} seconds @param {number} topics */
  recording: (size, seconds, topics) => `Recording ${topics === 0 ? "all topics but pictures and point clouds" : topics === 1 ? "1 topic" : `${topics} topics`}: ${duration(seconds)}, ${bytes(size)}.`,
  /** @param {string} reason */
  lastRecording: (reason) => `The last recording has ended: ${reason}.`,
  startRecording: "Start",
  stopRecording: "Stop",
  chooseTopics: "Choose topics",
  finished: "Finished",
  noRecordings: "No recordings yet.",
  /** @param {{size: number, started: number, part: number, cut: boolean}} file */
  recorded: ({ size, started, part, cut }) => [new Date(1000 * started).toLocaleString(), part > 1 ? `part ${part}` : "", bytes(size), cut ? "incomplete: its last seconds are missing" : ""].filter(Boolean).join(", "),
  download: "Download",
  delete: "Delete",
  /** @param {string} verb @param {string} name */
  of: (verb, name) => `${verb} ${name}`,
  rate: /** @param {number | undefined} rate */ (rate) => (rate === undefined ? "" : `${rate.toFixed(rate < 10 ? 1 : 0)} Hz`),
  bandwidth: /** @param {number | undefined} size */ (size) => (size === undefined ? "" : `${bytes(size)}/s`),
};

/** @param {number} size */
function bytes(size) {
  if (size < 1000) return `${Math.round(size)} B`;
  if (size < 1e6) return `${(size / 1e3).toFixed(1)} kB`;
  return size < 1e9 ? `${(size / 1e6).toFixed(1)} MB` : `${(size / 1e9).toFixed(1)} GB`;
}

/** @param {number} seconds */
function duration(seconds) {
  return `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;
}
