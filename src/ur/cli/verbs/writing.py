"""Verbs that check, write and explain launch files."""

from ur.cli.verbs.verb import FILE, LAUNCH, Below, Trust, Verb

_SECTION = "Write"
_PATHS = "Files, folders or packages; the current folder unless given."
_NEW = "The name, in lower-case letters, digits and _; asked for unless given."

WRITING = (
    Verb(
        "check",
        "ur.cli.files.check",
        "Check launch files, YAML files and programs.",
        _SECTION,
        arguments=("files", "..."),
        descriptions=(f"{_PATHS} NAME:=VALUE checks with that value of an argument only.",),
        examples=(
            ("ur check", "Check everything below this folder."),
            ("ur check my_robot robot_base:=magni", "Check a package for one base."),
            ("ur check --explain unknown-argument", "Print the page of a rule."),
            ("ur check --package --fix", "Add what package.xml and CMakeLists.txt lack."),
        ),
        trust=Trust(LAUNCH, writes="a cache in `~/.cache`; with `--fix`, the files, package.xml and CMakeLists.txt"),
        needs_ros=False,
    ),
    Verb(
        "new",
        "ur.cli.files.new",
        "Write a node, group, script, base, package or world.",
        _SECTION,
        arguments=("new command",),
        examples=(
            ("ur new package my_robot", "Write a package for launch files."),
            ("ur new world home --picture plan.png --width 12", "Make a world of a floor plan that is 12 m wide."),
        ),
        trust=Trust(
            "your packages, and what you answer", starts="`git config`, for your name", writes="new files of a package"
        ),
        needs_ros=False,
        below={
            "node": Below(
                descriptions=(f"{_NEW} Without n_.", "Arguments of the node's own command line, while it is observed."),
                examples=(
                    ("ur new node wander --from-package my_robot --type wander.py", "Write a launch file for a node."),
                    (
                        "ur new node joy --from-package joy --type joy_node --no-look",
                        "Write one without starting the node.",
                    ),
                ),
                trust=Trust(
                    "packages, and the topics of the observed node",
                    starts="the node, to observe it, unless `--no-look` is given",
                    writes="new files of a package",
                ),
            ),
            "multi": Below(
                descriptions=(f"{_NEW} Without m_.",),
                examples=(
                    ("ur new multi wander --include m_robot_base --include n_wander", "Include two launch files."),
                    ("ur new multi wander --include n_wander --no-program", "Write no program that starts it."),
                ),
            ),
            "base": Below(
                descriptions=(_NEW, "Arguments of the xacro file that --from names; the others have its defaults."),
                examples=(
                    ("ur new base rover --length 0.5 --width 0.4 --lidar", "Describe a robot with a lidar."),
                    ("ur new base rover --like magni", "Begin with the parameter files of another base."),
                    (
                        "ur new base rover --from rover.urdf --workspace ~/rover",
                        "Read it from the description of a robot.",
                    ),
                    ("ur new base rover --from rover.urdf.xacro colour:=red", "Expand it with an argument."),
                ),
                trust=Trust(
                    "with `--from`, a description and the meshes that it names",
                    starts="with `--from FILE.xacro`, xacro, in a process that can only compute",
                    writes="new files of a package",
                ),
            ),
            "package": Below(
                descriptions=(_NEW,),
                examples=(
                    ("ur new package my_robot", "Write a package, and ask for the rest."),
                    ('ur new package my_robot --summary "Programs for my robot."', "Give the summary as an option."),
                ),
            ),
            "script": Below(
                descriptions=("The name of the file, in lower-case letters, digits and _.",),
                examples=(
                    ("ur new script look_around", "Write look_around.py, which drives the selected robot."),
                    ("ur new script tour --summary 'Visit the doors'", "Give the summary as an option."),
                ),
            ),
            "world": Below(
                descriptions=("The name, in letters, digits, - and _; asked for unless given.",),
                examples=(
                    ("ur new world room --size 8x6", "Make an empty room of 8 x 6 m."),
                    (
                        "ur new world home --picture plan.png --width 12",
                        "Make a world of a floor plan that is 12 m wide.",
                    ),
                ),
            ),
        },
    ),
    Verb(
        "format",
        "ur.cli.files.format",
        "Format launch files: a standard order and layout.",
        _SECTION,
        arguments=("files", "..."),
        descriptions=(f"{_PATHS} '-' formats standard input to standard output.",),
        examples=(("ur format --diff", "Print what would change."), ("ur format my_robot", "Format a package.")),
        trust=Trust(LAUNCH, writes="the files, unless `--check` or `--diff` is given"),
        needs_ros=False,
    ),
    Verb(
        "convert",
        "ur.cli.workspace.convert",
        "Convert launch files of ROS 1 or Python to XML or YAML.",
        _SECTION,
        arguments=("files",),
        descriptions=("A launch file, which is printed, or a package or a folder.",),
        examples=(
            ("ur convert wander.launch", "Print a launch file as one of ROS 2."),
            ("ur convert my_robot --output ~/ros2_ws/src/my_robot", "Convert the launch files of a package."),
            ("ur convert slam.launch.py --to yaml", "Print a Python launch file of ROS 2 in YAML."),
            ("ur convert ubiquity_launches --prefix ~/ur_ros2", "Start this project's programs with ros2 launch."),
        ),
        trust=Trust(LAUNCH, writes="with `--output` and `--prefix`, the converted files"),
        needs_ros=False,
    ),
    Verb(
        "find",
        "ur.cli.files.find",
        "Find where a name in launch files is defined and used.",
        _SECTION,
        arguments=("", "files", "..."),
        descriptions=("The name of an argument, node, topic, parameter or file; * stands for any characters.", _PATHS),
        examples=(
            ("ur find scan", "Find a topic, or anything else of this name."),
            ("ur find 'robot_*' my_robot --kind arg", "Find arguments of a package."),
        ),
        trust=Trust(LAUNCH),
        needs_ros=False,
    ),
    Verb(
        "lsp",
        "ur.cli.files.lsp",
        "Serve an editor: findings while you type, completion, definitions.",
        _SECTION,
        examples=(
            ("ur lsp", "Serve the editor that started it; see docs/how-to/edit-launch-files.md."),
            ("ur lsp --stdio", "The same, for editors that pass this option."),
        ),
        trust=Trust(
            f"{LAUNCH}; requests of the editor that started it",
            starts="pip, to install pygls when it is used first",
            writes="nothing: the editor changes files",
        ),
        needs_ros=False,
    ),
    Verb(
        "docs",
        "ur.cli.files.docs",
        "Write a page of documents of launch files.",
        _SECTION,
        arguments=("files",),
        descriptions=("A package or a folder; the current folder unless given.",),
        examples=(
            ("ur docs my_robot", "Write launches.md of a package."),
            ("ur docs my_robot --check", "Fail if launches.md is out of date."),
        ),
        trust=Trust(LAUNCH, writes="the documents"),
        needs_ros=False,
    ),
    Verb(
        "graph",
        "ur.cli.files.graph",
        "Draw what a launch file includes and starts, or what runs.",
        _SECTION,
        arguments=("launch",),
        descriptions=(f"{FILE} With --live: nodes whose neighbours are drawn.",),
        examples=(
            ("ur graph my_robot m_wander.launch.xml", "Draw what a launch file includes."),
            ("ur graph --topics my_robot m_wander.launch.xml -o wander.svg", "Draw its nodes and topics."),
        ),
        trust=Trust(
            LAUNCH, sends="without FILE, questions to the ROS master and its nodes", writes="with `--output`, a file"
        ),
        needs_ros=False,
    ),
    Verb(
        "explain",
        "ur.cli.files.explain",
        "Explain where a name in a launch file got its value.",
        _SECTION,
        arguments=("explain",),
        descriptions=(
            "A launch file, the name of a parameter, argument, remap or node in it, and arguments NAME:=VALUE.",
        ),
        examples=(
            ("ur explain my_robot m_wander.launch.xml near", "Explain the value of a parameter."),
            ("ur explain ./test.launch /talker/rate speed:=2", "Explain it for given arguments."),
        ),
        trust=Trust(LAUNCH),
        needs_ros=False,
    ),
)
