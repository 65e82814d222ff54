"""Verbs about runs of launch files."""

from ur.cli.verbs.verb import FILE, START, Trust, Verb

_SECTION = "Launch"
_RUN = "A run, as 'ur ps' lists it, or the beginning of its name; optional where there is only one."
_ASK_RUN = Trust("the answers of a run of yours, over its socket", sends="a request to that run, on this computer")

LAUNCHING = (
    Verb(
        "launch",
        "ur.cli.launch.command",
        "Start a launch file, in place of roslaunch.",
        _SECTION,
        arguments=("launch",),
        descriptions=(f"{FILE} '-' reads the file from standard input.",),
        examples=(
            ("ur launch my_robot m_wander.launch.xml", "Start a launch file of a package."),
            ("ur launch ./test.launch speed:=0.5 --screen", "Start a file by its path, and show what its nodes print."),
            ("ur launch --detach --wait my_robot m_wander.launch.xml", "Start it and return when every node is up."),
            ("ur launch -- ros2 launch my_robot robot.launch.py", "Start another launcher, and leave nothing of it."),
            ("ur launch --ros-args my_robot m_wander.launch.xml", "Print the arguments of the file."),
        ),
        trust=START,
    ),
    Verb(
        "ps",
        "ur.cli.runs.ps",
        "List the runs on this computer.",
        _SECTION,
        examples=(("ur ps", "List the runs."), ("ur ps --json", "List them for a script.")),
        trust=Trust("records of your runs, and who runs on the selected master", sends="questions to the ROS master"),
    ),
    Verb(
        "attach",
        "ur.cli.runs.attach",
        "Show what a run prints, from any terminal.",
        _SECTION,
        arguments=("run",),
        descriptions=(_RUN,),
        examples=(
            ("ur attach", "Show the only run."),
            ("ur attach m_wander --plain", "Print the output of a run as lines."),
        ),
        trust=_ASK_RUN,
    ),
    Verb(
        "logs",
        "ur.cli.runs.logs",
        "Print what a node has printed so far.",
        _SECTION,
        arguments=("node",),
        descriptions=("A node of a run; what the run itself reports unless given.",),
        examples=(
            ("ur logs wander", "Print the output of a node."),
            ("ur logs wander --follow --lines 20", "Print the last 20 lines and what follows them."),
        ),
        trust=Trust("log files of your runs"),
    ),
    Verb(
        "report",
        "ur.cli.runs.report",
        "Write what happened in a run into one archive.",
        _SECTION,
        arguments=("run",),
        descriptions=("A run, active or ended, or the beginning of its name; the latest unless given.",),
        examples=(
            ("ur report", "Report the run that is active, or the latest that has ended."),
            ("ur report m_wander --output why.zip", "Choose among several runs, and name the archive."),
        ),
        trust=Trust(
            "records, logs and recordings of your runs, the answers of the ROS master",
            sends="a request to the black boxes on this computer, questions to the ROS master",
            writes="an archive, without secrets",
        ),
    ),
    Verb(
        "restart",
        "ur.cli.runs.restart",
        "Stop a node and start it again.",
        _SECTION,
        arguments=("node",),
        descriptions=("A node of a run.",),
        examples=(
            ("ur restart wander", "Stop a node and start it again."),
            ("ur restart wander --run m_wander", "Choose among several runs."),
        ),
        trust=_ASK_RUN,
    ),
    Verb(
        "wait",
        "ur.cli.runs.wait",
        "Return when every node of a run is up.",
        _SECTION,
        arguments=("run",),
        descriptions=(_RUN,),
        examples=(
            ("ur wait", "Return when every node of the only run is up."),
            ("ur wait m_wander --timeout-ready 60", "Give the nodes a minute."),
        ),
        trust=_ASK_RUN,
    ),
    Verb(
        "stop",
        "ur.cli.runs.stop",
        "End a run, or one of its nodes.",
        _SECTION,
        arguments=("run",),
        descriptions=(_RUN,),
        examples=(
            ("ur stop", "End the only run."),
            ("ur stop m_wander --node wander", "Stop one node; the run continues."),
            ("ur stop --all", "End every run of this computer."),
        ),
        trust=_ASK_RUN,
    ),
    Verb(
        "replay",
        "ur.cli.runs.replay",
        "Play a recording, into a program if one is named.",
        _SECTION,
        arguments=("files", "program", "program arguments"),
        descriptions=(
            "An MCAP file, of the black box or of another recorder.",
            "A program that 'ur list' names, which starts without the nodes of the robot.",
            "Arguments of the program's launch file.",
        ),
        examples=(
            ("ur replay black_box.mcap --info", "Print what a recording holds."),
            ("ur replay black_box.mcap keyboard_navigate", "See the map, the robot and its goals as they were."),
            (
                "ur replay black_box.mcap --speed 4 --from 60",
                "Publish its messages four times as fast, from a minute on.",
            ),
            ("ur replay", "Show the replay that runs, with keys to pause it, jump, and change its speed."),
        ),
        trust=Trust(
            "a recording of any origin, as MCAP; launch files of the program",
            starts="the nodes of the program that are not the robot's, a ROS master",
            sends="the messages of the recording, to nodes on this computer",
            writes="logs and `~/.ros`",
        ),
    ),
    Verb(
        "record",
        "ur.cli.runs.record",
        "Record topics to MCAP files, for as long as you like.",
        _SECTION,
        descriptions=("Names of topics, in which '*' stands for any characters; all topics unless given.",),
        examples=(
            ("ur record", "Record all topics until Ctrl-C."),
            ("ur record /scan /odom '/camera/*' --to ~/recordings", "Choose the topics and the folder."),
            ("ur record --detach", "Record in the background, until 'ur record --stop'."),
        ),
        trust=Trust(
            "messages of all nodes, as bytes",
            starts="a node, and a ROS master where none runs",
            sends="the command's arguments to a selected robot, by ssh",
            writes="MCAP files, logs and `~/.ros`",
        ),
    ),
)
