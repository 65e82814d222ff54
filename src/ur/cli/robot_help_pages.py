"""Arguments and examples of the verbs for robots, and for this computer."""

from __future__ import annotations

from collections.abc import Mapping

from ur.cli.verbs import HelpPage

_ROBOT = "A robot's name, HOST or USER@HOST; the selected robot unless given."

ROBOT_PAGES: Mapping[str, HelpPage] = {
    "setup": HelpPage(
        (),
        (("ur setup", "Set this computer up."), ("ur setup --dry-run", "Show what that would change.")),
    ),
    "web": HelpPage(
        ("A robot, written as for 'ur use': ROBOT, or sim; the selected robot unless given.",),
        (
            ("ur web", "Serve the page of the selected robot and print a link to it."),
            ("ur web --phone", "Let a phone in the same network open it; prints a QR code."),
            ("ur web bob --look", "Make a link that may look but not drive."),
            ("ur web --sessions", "List the devices that are logged in."),
            ("ur web --end 'Linux 2'", "Log one of them out."),
        ),
    ),
    "completion": HelpPage(
        ("bash, zsh or fish; this user's shell unless given.",),
        (
            ('eval "$(ur completion bash)"', "Complete in this shell."),
            ("ur completion fish", "Print the lines for another shell."),
        ),
    ),
    "debian": HelpPage(
        (),
        (
            ("ur debian status", "Print where the root is, and its size."),
            ("ur debian remove", "Delete it."),
        ),
    ),
    "debian status": HelpPage(
        (),
        (
            ("ur debian status", "Print where the root is, and its size."),
            ("ur help debian", "List the other commands."),
        ),
    ),
    "debian shell": HelpPage(
        ("A program with its arguments. Without it: your shell, or bash where the root does not have it.",),
        (
            ("ur debian shell", "Open a shell in the root."),
            ("ur debian shell rosbag info drive.bag", "Run one command there."),
        ),
    ),
    "debian install": HelpPage(
        ("Names of packages of Debian 13.",),
        (
            ("ur debian install gdb", "Install a debugger in the root."),
            ("ur debian install rviz rqt-graph", "Install several packages."),
        ),
    ),
    "debian update": HelpPage(
        (),
        (
            ("ur debian update", "Install newer versions of what is in the root."),
            ("ur help debian install", "Describe how to install other packages."),
        ),
    ),
    "debian remove": HelpPage(
        (),
        (
            ("ur debian remove", "Delete the root."),
            ("ur help debian", "List the other commands."),
        ),
    ),
    "env": HelpPage(
        (),
        (('eval "$(ur env)"', "Make this shell follow the selection."), ("ur env", "Print what that sets.")),
    ),
    "robots": HelpPage(
        ("Names of robots; all of them unless given.",),
        (("ur robots", "List the robots."), ("ur robots bob eve", "List these two as soon as they have answered.")),
    ),
    "robot": HelpPage(
        (),
        (
            ("ur robot setup ubuntu@ubuntu.local", "Set a freshly flashed robot up."),
            ("ur robot wifi bob", "Show the wireless networks of a robot."),
        ),
    ),
    "robot setup": HelpPage(
        ("Robots as they answer now; found on the network unless given.",),
        (
            ("ur robot setup ubuntu@ubuntu.local --name bob --base magni", "Set one robot up."),
            ("ur robot setup --from robots.yaml", "Set up every robot that a file names."),
        ),
    ),
    "robot rename": HelpPage(
        ("The robot's present name.", "Its new name."),
        (
            ("ur robot rename bob alice", "Rename a robot."),
            ("ur robot rename bob alice --dry-run", "Show what that would change."),
        ),
    ),
    "robot wifi": HelpPage(
        (_ROBOT,),
        (
            ("ur robot wifi bob", "Show the wireless networks of a robot."),
            ("ur robot wifi bob --ssid Lab", "Join a network."),
        ),
    ),
    "robot network": HelpPage(
        (_ROBOT,),
        (
            ("ur robot network bob", "Show the network devices of a robot."),
            ("ur robot network bob --address 192.168.1.7/24", "Give it a fixed address."),
        ),
    ),
    "image": HelpPage(
        (),
        (
            ("ur image prepare ubuntu.img --name bob", "Prepare an image file."),
            ("ur help image prepare", "Describe every option."),
        ),
    ),
    "image prepare": HelpPage(
        ("An image file, or the device of a flashed card.",),
        (
            ("ur image prepare ubuntu.img.xz --output bob.img --name bob", "Prepare a compressed image."),
            ("ur image prepare /dev/sdb --name bob --ssid Lab", "Prepare a card that is flashed already."),
        ),
    ),
    "doctor": HelpPage(
        ("Robots: names, HOST or USER@HOST; the selected robot unless given.",),
        (
            ("ur doctor", "Check the selected robot and this computer."),
            ("ur doctor bob eve", "Check two other robots, side by side."),
            ("ur doctor --all", "Check every robot that was set up from this computer."),
        ),
    ),
    "devices": HelpPage(
        (),
        (
            ("ur devices", "List what is plugged into this computer."),
            ("ur devices --robot bob", "List the robot's, and what its base lacks."),
            ("ur devices --robot bob --probe", "Also ask lidars which model they are."),
        ),
    ),
    "get": HelpPage(
        ("Launch files, packages, or folders with launch files (a path with a /), and arguments of a launch file.",),
        (
            ("ur get my_robot bringup.launch", "Install what a launch file needs."),
            ("ur get xacro --yes", "Install a package without a question."),
            ("ur get --missing --dry-run", "Show what the workspace needs."),
            ("ur get --missing --ask-servers", "Also ask GitHub and others for what no index has."),
            ("ur get --undo", "Remove what was installed."),
        ),
    ),
    "wifi": HelpPage(
        (_ROBOT,),
        (("ur wifi", "Measure the route to the selected robot."), ("ur wifi bob", "Measure the one to another robot.")),
    ),
    "shell": HelpPage(
        (_ROBOT, "A command to run there; a shell is opened unless given."),
        (("ur shell bob", "Open a shell on a robot."), ("ur shell bob rosnode list", "Run one command there.")),
    ),
    "x": HelpPage(
        ("A robot's name, HOST or USER@HOST.", "The program and its arguments."),
        (("ur x bob xterm", "Open a window of a robot here."), ("ur x bob --check", "Find out whether that works.")),
    ),
    "boot": HelpPage(
        (),
        (
            ("ur boot install robot_base", "Start a program whenever the selected robot boots."),
            ("ur boot status --robot bob", "Show what a robot starts."),
        ),
    ),
    "boot install": HelpPage(
        ("A package and a launch file of it, a program, or a command; then arguments NAME:=VALUE.",),
        (
            ("ur boot install robot_base", "Start a program."),
            ("ur boot install --robot bob my_robot m_wander.launch.xml", "Start a launch file on another robot."),
            ("ur boot install web", "Serve the page, and print a link to it."),
        ),
    ),
    "boot status": HelpPage(
        (),
        (
            ("ur boot status", "Show what the selected robot starts."),
            ("ur boot status --all", "Show what every robot starts that was set up from here."),
        ),
    ),
    "boot link": HelpPage(
        (),
        (
            ("ur boot link --robot bob", "Print a link to the page of bob, and its QR code."),
            ("ur boot link --look", "Print one that may look but not drive."),
        ),
    ),
    "boot log": HelpPage(
        ("A boot service, as 'ur boot status' shows it.",),
        (
            ("ur boot log robot_base", "Print its last lines."),
            ("ur boot log robot_base --follow", "Print what follows as well."),
        ),
    ),
    "boot remove": HelpPage(
        ("Boot services, as 'ur boot status' shows them; all of them unless given.",),
        (
            ("ur boot remove robot_base", "Remove one boot service."),
            ("ur boot remove --robot bob", "Remove all of a robot."),
        ),
    ),
    "sync": HelpPage(
        (
            "A robot's name, HOST or USER@HOST, or several joined by commas; the selected robot unless given.",
            "Files and folders of the workspace; everything unless given.",
        ),
        (
            ("ur sync bob --dry-run", "Show what would be copied."),
            ("ur sync bob", "Copy in both directions."),
            ("ur sync bob,eve --to my_package", "Bring a package to two robots."),
        ),
    ),
    "build": HelpPage(
        ("Robots: names, HOST or USER@HOST; this computer unless given.",),
        (
            ("ur build", "Build the workspace of this computer."),
            ("ur build bob -j 2", "Build that of a robot."),
            ("ur build bob eve", "Build those of two robots, side by side."),
        ),
    ),
    "mount": HelpPage(
        (_ROBOT,),
        (("ur mount bob", "Mount a robot's workspace at ~/robots/bob."), ("ur mount bob --at /tmp/bob", "Elsewhere.")),
    ),
    "unmount": HelpPage(
        (_ROBOT,),
        (
            ("ur unmount", "Unmount the folders of the selected robot."),
            ("ur unmount bob", "Unmount those of another robot."),
        ),
    ),
}
