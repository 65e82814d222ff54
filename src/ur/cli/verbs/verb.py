"""The declaration of a verb of `ur`: its module, its help, the completion of its arguments, and its trust."""

from collections.abc import Mapping
from typing import NamedTuple

NOTHING = "nothing"
PLUMBING = "Plumbing"
"""The section of verbs that scripts call: it is not in the help of `ur`, nor completed."""


class Trust(NamedTuple):
    """Input, started programs, sent data with its receiver, and written files of a command; each a phrase, or NOTHING.

    `starts` are programs other than parts of `ur`.
    """

    reads: str
    starts: str = NOTHING
    sends: str = NOTHING
    writes: str = NOTHING


class Below(NamedTuple):
    """A command below a verb. Without `trust` it has that of the verb."""

    examples: tuple[tuple[str, str], ...]
    descriptions: tuple[str, ...] = ()
    trust: Trust | None = None


class Verb(NamedTuple):
    """A verb: `command` of its module, the first line of its help, and its section there.

    `descriptions` are those of its positional arguments, `examples` commands with their meaning. `arguments` has the
    kind of each positional argument for completion (`ur.complete.verbs`); the last one of a list with an ellipsis is
    repeated. A verb that needs neither ROS nor the locked packages runs in the environment that pipx or uv has created
    from a wheel.
    """

    name: str
    module: str
    summary: str
    section: str
    examples: tuple[tuple[str, str], ...]
    trust: Trust
    descriptions: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    needs_ros: bool = True
    below: Mapping[str, Below] = {}


SSH = "the robot, by ssh with a known host key"
FILE = "A launch file: its path, or a package and the name of a file in it; then its arguments NAME:=VALUE."
LAUNCH = "launch files, YAML files and packages"
START = Trust(
    LAUNCH,
    starts="the nodes of the file, programs of `<param command>`, a ROS master; `sudo apt-get` for missing packages, "
    "after a question",
    sends="ROS: registrations and parameters, to the master; the command's arguments to a selected robot, by ssh",
    writes="logs and `~/.ros`",
)
