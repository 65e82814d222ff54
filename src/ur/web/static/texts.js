// @ts-check
/** English texts of the page: the only file with words for people, so that it can be translated. */

export const TEXTS = {
  title: "Robot",
  modes: { look: "Look", goal: "Goal", drive: "Drive", pose: "Pose" },
  modeHelp: {
    look: "Drag to move the map, pinch or scroll to zoom.",
    goal: "Press where the robot is to go, drag to where it is to face, let go.",
    drive: "Hold the stick, or the arrow keys. The robot stops when you let go.",
    pose: "Press where the robot is, drag to where it faces, let go.",
  },
  stop: "Stop",
  stopHelp: "Emergency stop",
  release: "Release",
  takeOver: "Take over",
  ask: "Ask",
  handOver: "Hand over",
  cancel: "Cancel",
  resume: "Continue",
  zoomIn: "Zoom in",
  zoomOut: "Zoom out",
  follow: "Follow the robot",
  fit: "Show the whole map",
  panels: "Panels",
  layers: "Layers",
  layerNames: {
    scan: "Lidar",
    plan: "Planned path",
    local: "Obstacles near the robot",
    global: "Obstacles on the map",
    particles: "Possible positions (particles)",
    covariance: "Uncertainty of the position",
    sonars: "Sonars",
    fiducials: "Fiducials",
    robots: "Other robots",
    trail: "Trail",
  },
  plots: {
    title: "Plots",
    topic: "Topic",
    field: "Field",
    add: "Plot",
    none: "No topic with numbers yet. Start a program.",
    tick: "Tick what to plot, or choose any other number below.",
    names: {
      "/odom:twist.twist.linear.x": "Speed (m/s)",
      "/odom:twist.twist.angular.z": "Turn rate (rad/s)",
      "/cmd_vel:linear.x": "Commanded speed (m/s)",
      "/cmd_vel:angular.z": "Commanded turn rate (rad/s)",
      "/battery_state:percentage": "Battery (1: full)",
      "/battery_state:voltage": "Battery (V)",
    },
    /** @param {number} most */
    full: (most) => `At most ${most} plots: remove one first.`,
    /** @param {string} name */
    remove: (name) => `Remove the plot of ${name}`,
    /** @param {string} name */
    picture: (name) => `${name} during the last minute`,
    /** @param {number} seconds */
    ago: (seconds) => (seconds ? `-${seconds} s` : "now"),
  },
  /** @param {string[]} names */
  bumpers: (names) => `Bumper pressed: ${names.join(", ")}`,
  /** @param {string[]} names @param {string} active */
  commandSources: (names, active) =>
    `Commands, the most urgent first: ${names.map((name) => (name === active ? `${name} (drives)` : name)).join(", ")}.`,
  places: "Places",
  placeName: "Name of a place",
  nameHere: "Name here",
  noPlaces: "No place has a name yet. Name the place where the robot is.",
  noName: "Not named: type a name first.",
  noPose: "Not named: the place of the robot is not known.",
  badName: "Not named: a name has at most 40 letters, digits, '_', '-' and '.', without spaces, and begins with a letter or digit.",
  /** @param {string} name */
  placeTaken: (name) => `There is a place ${name}. Press again to move it to the robot.`,
  noMapName: "Places belong to a map with a name. Start a program that navigates, or save the map that is being made.",
  remove: "Delete",
  sure: "Sure?",
  /** @param {string} name */
  removePlace: (name) => `Delete the place ${name}`,
  /** @param {string} name */
  driveTo: (name) => `Drive to ${name}`,
  patrol: {
    start: "Start the patrol",
    end: "End the patrol",
    repeat: "Again and again",
    /** @param {string} name */
    include: (name) => `Patrol: ${name}`,
    /** @param {string[]} names */
    chosen: (names) => (names.length ? `Patrol: ${names.join(", ")}` : "Tick places to drive to one after the other."),
    /** @param {string} place @param {string[]} places */
    drives: (place, places) => `Patrol: drives to ${place} (${places.join(", ")}). It ends with this page.`,
    /** @type {Record<import("./patrol.js").PatrolEnd, (place: string, text: string) => string>} */
    over: {
      late: (place) => `The patrol ended: the goal ${place} could not be sent. Start it again.`,
      failed: (place, text) => `The patrol ended: ${place} was not reached. ${text}`,
      replaced: () => "The patrol ended: another goal was sent.",
      refused: (place, text) => `The patrol ended before ${place}. ${text}`,
      emergency: () => "The patrol ended: emergency stop.",
      ended: () => "The patrol ended.",
      done: () => "The patrol is done.",
    },
  },
  camera: {
    title: "Camera",
    picture: "Picture of the robot's camera",
    waiting: "Waiting for a picture. If none comes, the robot has no camera, or no program that runs starts it.",
    old: "No new picture: the camera or the connection paused.",
  },
  speedLimit: {
    title: "Speed limit",
    unknown: "The limit is known when the robot is connected.",
    help: "Nothing drives faster, neither by hand nor to a goal.",
    none: "This robot takes no speed limit: its copy of the project is older than this page. Update it.",
    /** @param {number} percent @param {number} speed */
    value: (percent, speed) => `${percent} %${speed ? `, ${speed.toFixed(2)} m/s` : ""}`,
    /** @param {string} name */
    gamepad: (name) => `Gamepad: ${name}. Press Drive, then use its left stick; B stops everything.`,
  },
  zones: {
    title: "Zones",
    name: "Name of the zone",
    kind: "Rule of the zone",
    keepOut: "Keep out",
    /** @param {number} percent */
    slow: (percent) => `At most ${percent} % speed`,
    draw: "Draw a zone",
    undo: "Undo",
    done: "Done",
    cancel: "Cancel",
    none: "This map has no zones yet.",
    notServed: "Zones need a program that navigates on a map.",
    /** @param {number} corners */
    help: (corners) =>
      corners < 3 ? "Tap the corners of the zone on the map, or type those of a rectangle." : "Tap more corners, or press Done.",
    rectangle: "Type a rectangle",
    /** @param {number} x @param {number} y */
    robotAt: (x, y) => `The robot is at x ${x.toFixed(2)}, y ${y.toFixed(2)} m.`,
    sides: ["x from", "x to", "y from", "y to"],
    /** @param {string} name */
    taken: (name) => `There is a zone ${name}. Press Done again to replace it.`,
    /** @param {string} name @param {number} percent */
    row: (name, percent) => `${name}: ${percent ? `at most ${percent} % speed` : "keep out"}`,
    /** @param {string} name @param {number} percent */
    label: (name, percent) => (percent ? `${name} ${percent} %` : name),
    /** @param {string} name */
    remove: (name) => `Delete the zone ${name}`,
  },
  stick: "Stick",
  map: "Map with the robot",
  lookOnly: "This link shows the robot and can stop it. To drive, open one of 'ur web' without --look.",
  emergency: "Emergency stop: nothing drives.",
  stopAsked: "Stopping ...",
  stopFailed: "NOT STOPPED: no connection to the robot. Use its own switch.",
  waitingForMap: "Waiting for a map ...",
  over: {
    late: "The connection paused. Let go, then drive again.",
    driver: "Somebody else drives. Let go, take over, then drive.",
    "no mux": "This robot takes no commands of the page: its copy of the project is older. Update it.",
  },
  /** @param {number} age */
  lost: (age) =>
    `No connection to the server. What you see is ${seconds(age)} old.${age > 10 ? " Does 'ur web' run, in the network of this device?" : ""}`,
  connecting: "Connecting ...",
  /** @param {string} robot */
  noMaster: (robot) => `Nothing runs on the ${robot}. Start a program.`,
  starting: "Connecting to the robot ...",
  /** @param {number} age */
  silent: (age) =>
    Number.isFinite(age) ? `No word from the robot for ${seconds(age)}.` : "No word from the robot's base yet.",
  /** @param {string} who @param {number} since */
  drives: (who, since) => `${who} drives since ${clock(since)}.`,
  /** @param {string} who @param {number | null} until */
  away: (who, until) => `${who} drove${until ? ` until ${clock(until)}` : ""} and is out of reach.`,
  /** @param {string} who */
  asks: (who) => `${who} asks to drive.`,
  asked: "Asked to hand over ...",
  /** @param {string} who */
  driver: (who) => `${who} drives`,
  youDrive: "You drive",
  nobodyDrives: "Nobody drives",
  /** @param {string} what */
  missing: (what) => `Waiting for ${what}.`,
  goalStates: {
    none: "",
    waiting: "Goal sent",
    driving: "Driving",
    held: "Goal held",
    asking: "Goal waits for you",
    unknown: "Goal: unknown, no word from navigation",
    reached: "Goal reached",
    stopped: "Goal cancelled",
    failed: "Goal not reached",
  },
  /** @param {number} metres */
  left: (metres) => `${metres.toFixed(1)} m left`,
  refused: {
    late: "Not sent: the connection was too slow. Try again.",
    away: "Not sent: the robot is not connected.",
    driver: "Not sent: somebody else drives.",
    name: "Not named: expected at most 40 letters, digits, '_', '-' and '.'.",
    full: "Not named: this map has 200 places, expected fewer.",
    "no map": "Not named: the map has no name yet.",
    "no place": "Not sent: the map has no place of this name any more.",
    "no zones": "Not changed: no map server that has zones runs.",
    "no mux": "Not sent: the robot takes no commands of the page.",
  },
  sources: /** @type {Record<string, string>} */ ({
    joystick: "joystick",
    keyboard: "keyboard",
    web: "page",
    navigation: "navigation",
  }),
  speed: /** @param {number} speed */ (speed) => `${Math.abs(speed) < 0.005 ? "0.00" : speed.toFixed(2)} m/s`,
  battery: "Battery",
  percent: /** @param {number} share */ (share) => `${Math.round(100 * share)} %`,
  volts: /** @param {number} volts */ (volts) => `${volts} V`,
  close: "Close",
  loading: "Loading ...",
  noAnswer: "No connection to the server: nothing was done.",
  programs: "Programs",
  start: "Start",
  /** @param {string} name */
  started: (name) => `${name} started.`,
  startingProgram: "Starting ...",
  whatItStarts: "What it starts",
  startsNodes: "It starts these nodes:",
  /** @param {string} name */
  graphOf: (name) => `What ${name} includes and starts; the list below names the nodes`,
  why: "Why?",
  /** @param {string} name */
  whyNode: (name) => `Why ${name} is started`,
  /** @param {number} count */
  moreArguments: (count) => `${count} more arguments`,
  /** @param {string} value */
  byDefault: (value) => (value ? `${value} (default)` : "default"),
  required: "required",
  nodes: "Nodes",
  nodeColumns: ["Node", "State", "Use", ""],
  run: "Run",
  /** @param {string} title @param {number} since */
  runName: (title, since) => `${title.replace(/^m_/, "")}, since ${clock(since)}`,
  noRuns: "Nothing runs. Start a program.",
  endRun: "End",
  /** @param {string} cause */
  runEnds: (cause) => (cause ? `Ends: ${cause}` : "Ends ..."),
  /** @param {number} age */
  robotLost: (age) => `No connection to the robot for ${seconds(age)}.`,
  endedRuns: "Ended",
  /** @param {string} title @param {number} when @param {number | null} code @param {string} cause */
  endedRun: (title, when, code, cause) =>
    `${title.replace(/^m_/, "")}, ${clock(when)}: ${cause || (code ? `exit code ${code}` : "ended")}`,
  restart: "Restart",
  stopNode: "Stop",
  startNode: "Start",
  /** @param {string} name */
  restartNode: (name) => `Restart ${name}`,
  /** @param {string} name */
  stopNodeOf: (name) => `Stop the node ${name}`,
  /** @param {string} name */
  startNodeOf: (name) => `Start ${name}`,
  nodeStates: {
    up: "up",
    running: "not ready",
    waiting: "waiting",
    starting: "starting",
    stopping: "stopping",
    ended: "ended",
    held: "stopped",
  },
  bySignal: /** @param {number} number */ (number) => `signal ${number}`,
  withCode: /** @param {number} code */ (code) => `exit code ${code}`,
  restartIn: /** @param {number} time */ (time) => `again in ${time} s`,
  restarted: /** @param {number} count */ (count) => (count === 1 ? "restarted once" : `restarted ${count} times`),
  /** @param {number} cores @param {number} bytes */
  usage: (cores, bytes) => `${Math.round(100 * cores)} % \u00b7 ${Math.round(bytes / 1e6)} MB`,
  log: "Log",
  logOf: "Show the log of",
  logFrom: "Show lines from this severity on",
  allNodes: "all nodes",
  levels: { debug: "everything", info: "info and above", warning: "warnings and errors", error: "errors" },
  clockTime: clockSeconds,
  noLines: "No line.",
  noLinesShown: "No line of this severity yet.",
  doctor: "Doctor",
  diagnosing: "Examining this computer and the robot ...",
  again: "Examine again",
  /** @param {number} count */
  findings: (count) => (count ? `${count} ${count === 1 ? "problem" : "problems"} found.` : "All is well."),
  /** @param {string} where */
  commandOn: (where) => `Type on ${where}:`,
  /** @param {string} where */
  commandFix: (where) => `Type on ${where}, or run "ur doctor --fix":`,
  loggingIn: "Logging in ...",
  noToken: "Open the link that 'ur web' has printed. A link is good for one login: start 'ur web' again for another one.",
  loginFailed: "This link was used before, or is too old. Start 'ur web' again for a new one, or 'ur boot link' for a page on a robot.",
  loginOffline: "The server does not answer. Does 'ur web' run?",
};

/** @param {number} age seconds */
function seconds(age) {
  return age < 120 ? `${Math.round(age)} s` : `${Math.round(age / 60)} min`;
}

/** @param {number} unix seconds since 1970 */
function clockSeconds(unix) {
  return new Date(1000 * unix).toLocaleTimeString();
}

/** @param {number} unix seconds since 1970 */
function clock(unix) {
  return new Date(1000 * unix).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
}
