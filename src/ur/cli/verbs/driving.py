"""Verbs that drive robots."""

from ur.cli.verbs.verb import SSH, START, Below, Trust, Verb

_SECTION = "Drive"
_MAP = "The name of a map, as 'ur maps' lists it."

DRIVING = (
    Verb(
        "run",
        "ur.cli.launch.run",
        "Run a program on the selected robot.",
        _SECTION,
        arguments=("program", "program arguments"),
        descriptions=(
            "A program that 'ur list' names, PACKAGE/PROGRAM where several packages have one of this name, or FILE.py.",
            "Arguments of the program's launch file; 'ur run PROGRAM --help' describes them.",
        ),
        examples=(
            ("ur run keyboard_navigate", "Send the selected robot to places on a map."),
            ("ur run keyboard_navigate world:=office robot_base:=magni", "Choose the world and the robot."),
            ("ur run keyboard_navigate --help", "Describe the arguments of a program."),
            ("ur run look_around.py", "Run a script of yours, which 'ur new script' has written."),
        ),
        trust=START,
    ),
    Verb(
        "list",
        "ur.cli.launch.list_programs",
        "List the programs that `ur run` knows.",
        _SECTION,
        examples=(
            ("ur list", "List the programs of every package."),
            ("ur help keyboard_drive", "Describe one of them."),
        ),
        trust=Trust(
            "programs of your packages, as text", sends="a question to the ROS master", writes="a cache in `~/.cache`"
        ),
        needs_ros=False,
    ),
    Verb(
        "web",
        "ur.cli.robots.web",
        "Show and drive a robot in a browser.",
        _SECTION,
        arguments=("selection",),
        descriptions=("A robot, written as for 'ur use': ROBOT, or sim; the selected robot unless given.",),
        examples=(
            ("ur web", "Serve the page of the selected robot and print a link to it."),
            ("ur web --phone", "Let a phone in the same network open it; prints a QR code."),
            ("ur web bob --look", "Make a link that allows watching but not driving."),
        ),
        trust=Trust(
            "requests of browsers",
            starts="commands of `ur`, for pages whose login may drive; nodes of the page",
            sends="the page, to browsers with a login; ROS: registrations, to the master of the selected robot",
            writes="sessions as hashes, `web.log`",
        ),
    ),
    Verb(
        "mcp",
        "ur.cli.robots.mcp",
        "Let an assistant look at the robot, and drive it.",
        _SECTION,
        examples=(
            ("ur mcp --install", "Install what assistants need, before one starts it."),
            ("ur mcp log", "Print the requests of assistants."),
            ("ur mcp grant --minutes 30 --speed 0.2", "Let it drive for half an hour."),
        ),
        trust=Trust(
            "requests of the assistant that started it; topics; files that `check`, `find` and `explain` read",
            starts="the robot's end of it, a node; commands of `ur`; pip, to install the SDK with `--install`",
            sends="ROS: within a grant, velocities and goals; to the assistant, what the robot publishes",
            writes="a log of actions, and grants, in `~/.local/state`",
        ),
        below={
            "grant": Below(
                examples=(
                    ("ur mcp grant", "Let the assistant drive as it asks to."),
                    ("ur mcp grant --minutes 30 --speed 0.2", "For half an hour, and slowly."),
                )
            ),
            "end": Below(
                examples=(
                    ("ur mcp end", "Revoke all grants: the robot stops."),
                    ("ur mcp end --of 1f2e3d4c", "Revoke that of one assistant."),
                )
            ),
            "list": Below(
                examples=(
                    ("ur mcp list", "List the assistants that are served, and their grants."),
                    ("ur help mcp grant", "Describe how to let one drive."),
                )
            ),
            "log": Below(
                examples=(
                    ("ur mcp log", "Print the requests of assistants."),
                    ("ur help mcp", "List the other commands."),
                )
            ),
        },
    ),
    Verb(
        "maps",
        "ur.cli.maps.maps",
        "List, show, edit and exchange the maps that robots have made.",
        _SECTION,
        arguments=("maps command", "map", "..."),
        examples=(
            ("ur maps show flat", "Draw a map; 'ur maps' alone lists all."),
            ("ur maps copy flat --from bob", "Copy a map that bob has made to this computer."),
        ),
        trust=Trust("map files and pictures", writes="maps in `~/.local/share/ubiquity_launches/maps`"),
        below={
            "show": Below(
                descriptions=(_MAP,),
                examples=(
                    ("ur maps show flat", "Draw a map."),
                    ("ur maps show latest", "Draw the last map that the robot of this computer has made."),
                ),
            ),
            "rename": Below(
                descriptions=(_MAP, "A name that no map has."),
                examples=(
                    ("ur maps rename map-2026-05-01 flat", "Name a map."),
                    ("ur maps rename flat old-flat", "Free the name for another map."),
                ),
            ),
            "delete": Below(
                descriptions=(_MAP,),
                examples=(
                    ("ur maps delete flat", "Delete a map after a question."),
                    ("ur maps delete flat attic --yes", "Delete two without one."),
                ),
            ),
            "export": Below(
                descriptions=(_MAP, "The path of the files; their ending is .yaml, .png or .pgm, or left out."),
                examples=(
                    ("ur maps export flat ~/flat.yaml", "Write flat.yaml and flat.png."),
                    ("ur maps export flat ~/flat.pgm", "Write flat.yaml and flat.pgm."),
                ),
            ),
            "import": Below(
                descriptions=(
                    "A YAML file of map_server, or the folder of a map.",
                    "Its name here; that of the file unless given.",
                ),
                examples=(
                    ("ur maps import ~/catkin_ws/src/maps/office.yaml", "Import a map under the name office."),
                    ("ur maps import map.yaml flat", "Choose its name."),
                ),
            ),
            "edit": Below(
                descriptions=(
                    _MAP,
                    "The change: rotate, origin, erase, wall, keep-out, zone or place.",
                    "Its numbers, in metres and degrees; before them the name of a place or zone.",
                ),
                examples=(
                    ("ur maps edit flat rotate", "Rotate a map so that its walls are parallel to the axes."),
                    ("ur maps edit flat erase 1.5 2 2.5 3", "Erase a rectangle."),
                    ("ur maps edit flat wall 0 0 0 2.5", "Draw a wall."),
                    ("ur maps edit flat zone stairs keep-out 1 2 3 4", "Keep out of a rectangle."),
                    ("ur maps edit flat zone hall 40 5 0 9 3", "Drive at 40 % of the highest speed there."),
                    ("ur maps edit flat place door 1 2 90", "Name a place."),
                ),
            ),
            "merge": Below(
                descriptions=("The map whose frame the new one has.", "The map that is merged into it."),
                examples=(
                    ("ur maps merge flat attic --as house", "Join two maps that share some floor."),
                    ("ur maps merge flat map-2026-11-01 --as flat-2", "Bring a map up to date with a later one."),
                ),
            ),
            "copy": Below(
                descriptions=(_MAP,),
                examples=(
                    ("ur maps copy flat --from bob", "Copy a map that bob has made to this computer."),
                    ("ur maps copy flat --to alice", "Let another robot navigate on it."),
                ),
                trust=Trust(
                    "an archive from the robot, within limits",
                    sends=f"the map, to {SSH}",
                    writes="a map, here or there",
                ),
            ),
        },
    ),
    Verb(
        "use",
        "ur.cli.robots.use",
        "Select a robot, or show which one is selected.",
        _SECTION,
        arguments=("selection",),
        descriptions=("The robot to select; the selection is printed unless given.",),
        examples=(
            ("ur use sim:magni:lidar", "Select a simulated Magni with a lidar."),
            ("ur use bob", "Select the robot whose computer answers to bob.local."),
            ("ur use --away bob", "Select a robot that is away and was never set up from here."),
        ),
        trust=Trust(
            "records of robots",
            sends="for a robot that is not known yet, a question for its address, to the network",
            writes="the selection",
        ),
    ),
)
