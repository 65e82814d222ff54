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
  stop: "STOP",
  stopHelp: "Emergency stop (space bar)",
  release: "Release",
  takeOver: "Take over",
  ask: "Ask",
  handOver: "Hand over",
  handBack: "Hand back",
  handBackHelp: "Let others drive: a client, or the exploration",
  cancel: "Cancel",
  resume: "Continue",
  zoomIn: "Zoom in",
  zoomOut: "Zoom out",
  follow: "Follow the robot",
  sideways: "Drive sideways in place of turning",
  fit: "Show the whole map",
  panels: "Panels",
  groups: { drive: "Drive", map: "Map", sensors: "Sensors", programs: "Programs", diagnostics: "Diagnostics" },
  dockWidth: "Width of the panels",
  /** @param {string} label */
  closePanel: (label) => `Close ${label}`,
  layers: "Layers",
  trail: "Trail",
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
  nameOnMap: "On the map",
  nameOnMapHelp: "On the map: name a place",
  /** @param {string} name */
  pickPlace: (name) => `Press where ${name} is, drag to where the robot is to face there, let go.`,
  editPlace: "Edit",
  /** @param {string} name */
  editPlaceOf: (name) => `Edit the place ${name}`,
  rename: "Rename",
  /** @param {string} name */
  newName: (name) => `New name of ${name}`,
  moveOnMap: "Move on the map",
  moveHere: "Move to the robot",
  /** @param {string} name */
  nameTaken: (name) => `Not renamed: there is a place ${name}.`,
  noPlaces: "No place has a name yet. Name the place where the robot is.",
  noName: "Not named: type a name first.",
  noPose: "Not named: the place of the robot is not known.",
  badName: "Not named: a name has at most 40 letters, digits, spaces, '_', '-' and '.', and begins with a letter or digit.",
  /** @param {string} name */
  placeTaken: (name) => `There is a place ${name}. Press again to move it to the robot.`,
  noMapName: "Places belong to a map with a name. Start a program that navigates, or save the map that is being made.",
  remove: "Delete",
  sure: "Sure?",
  /** @param {string} name */
  removePlace: (name) => `Delete the place ${name}`,
  /** @param {string} name */
  driveTo: (name) => `${name}: drive there`,
  patrol: {
    start: "Start the patrol",
    end: "End the patrol",
    pause: "Pause",
    repeat: "Again and again",
    /** @param {string} name */
    include: (name) => `Patrol: ${name}`,
    /** @param {string[]} names */
    chosen: (names) => (names.length ? `Patrol: ${names.join(", ")}` : "Tick places to drive to one after the other."),
  },
  route: {
    title: "Route",
    tap: "Tap a route",
    help: "Tap points of the map, and the robot drives to them in turn.",
    /** @param {number} count @param {number} most */
    points: (count, most) =>
      count >= most ? `A route has at most ${most} points. Press Start.` : count < 2 ? "Tap the points of the route on the map, two or more." : `Route of ${count} points. Tap more, or press Start.`,
    undo: "Undo",
    clear: "Clear",
  },
  camera: {
    title: "Camera",
    picture: "Picture of the robot's camera",
    waiting: "Waiting for a picture. If none comes, the robot has no camera, or no program that runs starts it.",
    old: "No new picture: the camera or the connection paused.",
    choose: "Camera",
    larger: "Full screen",
    smaller: "Leave full screen",
  },
  obstacles: {
    name: "the obstacle stop",
    clear: "Stops before obstacles",
    off: "Does not stop before obstacles",
    turnOn: "Turn on",
    turnOff: "Turn off",
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
    /** @param {number} x @param {number} y */
    robotAt: (x, y) => `The robot is at x ${x.toFixed(2)}, y ${y.toFixed(2)} m.`,
    rectangle: { title: "Type a rectangle", sides: ["x from", "x to", "y from", "y to"] },
    /** @param {string} name */
    taken: (name) => `There is a zone ${name}. Press Done again to replace it.`,
    /** @param {string} name @param {number} percent */
    row: (name, percent) => `${name}: ${percent ? `at most ${percent} % speed` : "keep out"}`,
    /** @param {string} name @param {number} percent */
    label: (name, percent) => (percent ? `${name} ${percent} %` : name),
    /** @param {string} name */
    remove: (name) => `Delete the zone ${name}`,
  },
  mapTools: {
    title: "Map tools",
    help: "Measure a distance, or turn the map by 90 degrees.",
    measure: "Measure",
    tap: "Tap points of the map.",
    undo: "Undo",
    done: "Done",
    turn: "Turn the map",
    helpDriver: "Measure a distance, turn the map by 90 degrees, or draw and erase its walls.",
    /** @param {number} metres */
    length: (metres) => `Length of the line: ${metres.toFixed(2)} m.`,
  },
  walls: {
    begin: "Walls",
    restore: "Restore walls",
    draw: "Wall",
    erase: "Erase",
    width: "Width of the brush",
    save: "Save",
    add: "Add the line",
    line: { title: "Type a line", sides: ["from x", "from y", "to x", "to y"] },
    /** @param {boolean} erases @param {number} count */
    help: (erases, count) =>
      `${erases ? "Drag over walls that are none." : "Drag from one end of a wall to the other."} ${count ? lines(count) : "Two fingers move the map."}`,
    /** @param {number} count */
    unsaved: (count) => `${lines(count)} Press Walls to go on.`,
    saving: "Saving the map ...",
    saved: "Saved. Navigation uses the new walls.",
    restored: "Restored. Navigation uses the walls of before.",
    late: "No answer from the map server. Look at the map, then try again.",
    full: "Not drawn: this is as much as fits into one change. Press Save, then go on.",
    otherMap: "Another map is in use. The walls that were not saved are dropped.",
    why: /** @type {Record<string, string>} */ ({
      "no server": "Walls can be changed while a program navigates on a stored map. Start one on a map of the list Maps.",
      made: "The map is being made: what the robot sees would draw over it. Save it, end that program, then navigate on the map.",
      file: "The map in use is a file, which stays as it is. Import it as a stored map: ur maps import FILE NAME.",
    }),
  },
  mapList: {
    title: "Maps",
    none: "This computer has no maps yet. Start the program that makes one.",
    /** @param {{width: number | null, height: number | null, changed: number, places: number, latest: boolean, problem: string}} map */
    facts: ({ width, height, changed, places, latest, problem }) =>
      problem
        ? `damaged: ${problem}`
        : [
            width === null || height === null ? "" : `${width.toFixed(1)} x ${height.toFixed(1)} m`,
            changed ? new Date(1000 * changed).toLocaleDateString() : "",
            places ? `${places} ${places === 1 ? "place" : "places"}` : "",
            latest ? "the last one of this robot" : "",
          ].filter(Boolean).join(" \u00b7 "),
    inUse: "in use",
    drive: "Drive on this map",
    /** @param {string} name */
    driveOn: (name) => `Drive on this map: ${name}`,
    /** @param {string} name */
    picture: (name) => `Picture of the map ${name}`,
    makes: "A map is being made.",
    makesStill: "A run makes a map. It saves that map when it ends.",
    endFirst: "Not started: a map is being made. End the program that makes it where it was started.",
    save: "Save",
    saving: "Saving the map ...",
    /** @param {string} name */
    saved: (name) => `Saved as ${name}.`,
    /** @param {string} why */
    notSaved: (why) => `Not saved: ${why}.`,
    why: /** @type {Record<string, string>} */ ({ "no map": "no map is being made", busy: "it is being saved already" }),
  },
  /** @param {number} metres */
  metres: (metres) => `${metres.toFixed(2)} m`,
  /** @param {number} metres */
  length: (metres) => (metres < 1 ? `${Math.round(100 * metres)} cm` : `${metres} m`),
  /** @param {number} x @param {number} y m */
  coordinates: (x, y) => `x ${x.toFixed(2)}  y ${y.toFixed(2)} m`,
  stick: "Stick",
  map: "Map with the robot",
  lookOnly: "This link shows the robot and can stop it. To drive, open one of 'ur web' without --look.",
  emergency: "Emergency stop: nothing drives.",
  stopAsked: "Stopping ...",
  stopFailed: "NOT STOPPED: no connection to the robot. Use its own switch.",
  waitingForMap: "Waiting for a map ...",
  /** @param {number} delay ms */
  slowLink: (delay) => `The connection takes ${delay} ms; driving by hand needs less than 150. Send goals, or go nearer.`,
  over: {
    late: "The connection paused. Let go, then drive again.",
    driver: "Another client drives. Let go, take over, then drive.",
    "no mux": "This robot takes no commands of the page: its copy of the project is older. Update it.",
  },
  /** @param {number} age */
  lost: (age) =>
    `No connection to the server. What you see is ${seconds(age)} old.${age > 10 ? " Does 'ur web' run, in the network of this device?" : ""}`,
  connecting: "Connecting ...",
  /** @param {string} robot */
  noMaster: (robot) => `Nothing runs on ${robot === "simulated robot" ? "the simulated robot" : robot}. Start a program.`,
  /** @param {string} selection */
  moved: (selection) => `'ur use' has selected '${selection}' since this page was started. Start 'ur web' again to see what runs there.`,
  starting: "Connecting to the robot ...",
  /** @param {string} problem */
  robotEndFails: (problem) => `The page's node on the robot ends again and again: ${problem}`,
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
  noDriver: "No client drives",
  /** @param {string} what */
  missing: (what) => `Waiting for ${what}.`,
  goalStates: {
    none: "",
    waiting: "Goal sent",
    driving: "Driving",
    held: "Goal held",
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
    driver: "Not sent: another client drives.",
    name: "Not named: expected at most 40 letters, digits, spaces, '_', '-' and '.'.",
    full: "Not named: this map has 200 places, expected fewer.",
    "no map": "Not named: the map has no name yet.",
    "no place": "Not sent: the map has no place of this name any more.",
    "no zones": "Not changed: no map server that has zones runs.",
    "no walls": "Not changed: no map server that can change walls runs.",
    "no patrol": "This robot drives no patrols. Start a program that navigates.",
    "no mux": "Not sent: the robot takes no commands of the page.",
  },
  sources: /** @type {Record<string, string>} */ ({
    joystick: "joystick",
    keyboard: "keyboard",
    web: "page",
    navigation: "navigation",
    exploring: "exploring",
  }),
  speed: /** @param {number} speed */ (speed) => `${Math.abs(speed) < 0.005 ? "0.00" : speed.toFixed(2)} m/s`,
  battery: "Battery",
  percent: /** @param {number} share */ (share) => `${Math.round(100 * share)} %`,
  volts: /** @param {number} volts */ (volts) => `${volts} V`,
  loading: "Loading ...",
  noAnswer: "No connection to the server: nothing was done.",
  programs: "Programs",
  start: "Start",
  /** @param {string} name */
  started: (name) => `The program ${name} started.`,
  startingProgram: "Starting ...",
  /** Programs that most people want, in words. @type {Record<string, string>} */
  programNames: { keyboard_navigate: "Navigate", make_map: "Make a map", raspicam: "Camera" },
  otherPrograms: "Other programs",
  /** @param {string} name */
  endAndStart: (name) => `End ${name} and start this`,
  runInTheWay: "A run that is in the way has nodes of the same names.",
  /** @param {string} name */
  endingRun: (name) => `${name} ends ...`,
  runStays: "The run has not ended. Try again, or end it in Nodes.",
  whatItStarts: "What it starts",
  startsNodes: "It starts these nodes:",
  /** @param {string} name */
  graphOf: (name) => `What ${name} includes and starts; the list below names the nodes`,
  why: "Why?",
  /** @param {string} name */
  whyNode: (name) => `Why? The start of ${name}`,
  /** @param {number} count */
  moreArguments: (count) => `${count} more arguments`,
  /** @param {string} value */
  byDefault: (value) => (value ? `${value} (default)` : "default"),
  required: "required",
  argumentNames: /** @type {Record<string, string>} */ ({ bring_up: "Start the base", simulate: "Simulate the robot" }),
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
  copy: "Copy",
  copied: "Copied",
  notCopied: "Selected: copy it with Ctrl-C",
  /** @param {string} command */
  copyCommand: (command) => `Copy ${command}`,
  devices: {
    title: "Devices",
    /** @param {{role: "look" | "drive", address: string, last: number, until: number, own: boolean, open: boolean}} device @param {number} now seconds since 1970 */
    facts: ({ role, address, last, until, own, open }, now) =>
      [
        own ? "this device" : address,
        role === "drive" ? "may drive" : "may look",
        own ? "" : open ? "page open" : last ? `seen ${seconds(Math.max(0, now - last))} ago` : "",
        `until ${new Date(1000 * until).toLocaleDateString()}`,
      ].filter(Boolean).join(" \u00b7 "),
    end: "Log out",
    /** @param {string} name */
    endOf: (name) => `Log out ${name}`,
    endOthers: "Log out all others",
    ownName: "Name of this device",
    name: "Name it",
    /** @param {string} name */
    named: (name) => `This device is called ${name}.`,
    invite: "Another device",
    inviteLook: "Invite to look",
    inviteDrive: "Invite to drive",
    /** @param {"look" | "drive"} role */
    invited: (role) => `Scan this with the device. It may ${role === "drive" ? "drive, and start programs" : "look, and press Stop"}. Good for one login within an hour.`,
    code: "QR code of the link",
    local: "Only this computer reaches this page: start it with 'ur web --phone' for other devices.",
  },
  assistants: {
    title: "Assistants",
    none: "No assistant is connected.",
    looks: "may look",
    /** @param {{minutes: number, speed: number, reason: string}} asks */
    wants: ({ minutes, speed, reason }) => `asks for ${minutes} minutes at ${speed} m/s${reason ? `: ${reason}` : ""}`,
    /** @param {string} name @param {{minutes: number, speed: number, reason: string}} asks */
    asks: (name, asks) => `${name} asks to drive for ${asks.minutes} minutes at ${asks.speed} m/s${asks.reason ? `: ${asks.reason}` : "."}`,
    answer: "Answer",
    /** @param {string} name @param {{text: string}} grant */
    mayDrive: (name, { text }) => `${name} may drive: ${text.replace(/^assistant, /, "")}.`,
    takeBack: "Take back",
    /** @param {string} name */
    takeBackOf: (name) => `Take back the grant of ${name}`,
    letDrive: "Let it drive",
    /** @param {string} name */
    letDriveOf: (name) => `Let it drive: ${name}`,
    /** @param {number} left seconds */
    left: (left) => `${left < 120 ? `${Math.round(left)} s` : `${Math.round(left / 60)} min`} left`,
    minutes: "Minutes",
    speed: "Highest speed, m/s",
    area: "Where",
    areaName: "Name, such as kitchen",
    pick: "Point at two corners",
    firstCorner: "Point at one corner of the area.",
    secondCorner: "Point at the opposite corner.",
    onlyHere: "Only here",
    notHere: "Not here",
    /** @param {{left: number, bottom: number, right: number, top: number, name: string}} area */
    only: (area) => `only in ${nameArea(area)}`,
    /** @param {{left: number, bottom: number, right: number, top: number, name: string}} area */
    not: (area) => `not in ${nameArea(area)}`,
    programs: "It may start and end programs, too",
    give: "Let it drive",
    refuse: "Refuse",
    noNumbers: "Minutes and speed have to be numbers above 0.",
  },
  loggingIn: "Logging in ...",
  noToken: "Open the link that 'ur web' has printed. A link is good for one login: press Enter there for another one.",
  loginFailed: "This link was used before, or is too old. Press Enter where 'ur web' runs for a new one, or type 'ur boot link' for a page on a robot.",
  loginOffline: "The server does not answer. Does 'ur web' run?",
};

/** @param {{left: number, bottom: number, right: number, top: number, name: string}} area */
function nameArea({ left, bottom, right, top, name }) {
  return `${name || "an area"} (${left} ${bottom} to ${right} ${top})`;
}

/** @param {number} count */
function lines(count) {
  return `${count} ${count === 1 ? "line is" : "lines are"} not saved yet.`;
}

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
