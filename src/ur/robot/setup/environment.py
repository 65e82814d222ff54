"""The ROS environment of a user's shells: ~/.ros_setup, sourced by the first line of their start-up files."""

from pathlib import Path

from ur.robot.setup.wanted import Wanted, WantedFile, WantedFolder, WantedLine
from ur.robot.ssh.shell import quote

SETUP_LINE = '[ ! -r "$HOME/.ros_setup" ] || . "$HOME/.ros_setup" # ubiquity_launches'
_HEAD = """\
# The ROS environment of this user's shells, written by `ur`: it is written again, so your own lines belong elsewhere.
# Every shell reads it, scripts and remote commands too: it must say nothing and be quick.
ubiquity="${ROS_MASTER_URI-}"
[ ! -r "$HOME/catkin_ws/devel/setup.sh" ] || . "$HOME/catkin_ws/devel/setup.sh"
[ -n "$ubiquity" ] || unset ROS_MASTER_URI # catkin fills in localhost, which nobody chose
unset ubiquity
# Packages of the workspace are found before it is built, too: launch files need no building.
case ":${ROS_PACKAGE_PATH-}:" in *:/usr/share:*) ;; *)
  ROS_PACKAGE_PATH="${ROS_PACKAGE_PATH:+$ROS_PACKAGE_PATH:}/usr/share" ;; esac
case ":$ROS_PACKAGE_PATH:" in *":$HOME/catkin_ws/src:"*) ;; *)
  ROS_PACKAGE_PATH="$HOME/catkin_ws/src:$ROS_PACKAGE_PATH" ;; esac
export ROS_PACKAGE_PATH
"""
# Where this project may be on a robot; one in the workspace comes before one in the home folder.
_LIBRARY = """\
for ubiquity in "$HOME/ubiquity_launches" "$HOME/catkin_ws/src/ubiquity_launches"; do
  ubiquity="$ubiquity/ubiquity_launches"
  [ ! -d "$ubiquity" ] || case ":$PATH:" in *":$ubiquity/bin:"*) ;; *)
    PATH="$ubiquity/bin:$PATH" ROS_PACKAGE_PATH="$ubiquity:$ROS_PACKAGE_PATH" ;; esac
done
unset ubiquity
"""


def viewer_environment(repository: Path) -> list[Wanted]:
    """Return the states for shells that follow the selection (`ur use`), with `ur` on PATH."""
    python = quote(str(repository / ".venv/bin/python"))
    return _shells(_HEAD + f'[ ! -x {python} ] || eval "$({python} -I -m ur env 2>/dev/null)"\n')


def robot_environment() -> list[Wanted]:
    """Return the states for shells that use the robot's own master, under the name by which others reach it."""
    return _shells(robot_setup_text())


def robot_setup_text() -> str:
    """Return the text of a robot's ~/.ros_setup."""
    return (
        f"{_HEAD}{_LIBRARY}"
        'read -r ROS_HOSTNAME </proc/sys/kernel/hostname\nexport ROS_HOSTNAME="${ROS_HOSTNAME%%.*}.local"\n'
        'export ROS_MASTER_URI="http://$ROS_HOSTNAME:11311"\n'
    )


def _shells(text: str) -> list[Wanted]:
    return [
        WantedFile("ROS environment", "~/.ros_setup", text),
        # First in the file: Debian's .bashrc skips later lines in shells that are not interactive.
        WantedLine("bash reads it", "~/.bashrc", SETUP_LINE, first=True),
        WantedLine("login shells read it", "~/.profile", SETUP_LINE, first=True),
        WantedLine("zsh reads it", "~/.zshenv", SETUP_LINE, first=True),
        WantedFolder("catkin workspace", "~/catkin_ws/src"),
    ]
