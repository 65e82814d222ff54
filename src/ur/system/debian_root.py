"""The Debian root, as a process sees it: whether it runs in the root, and how packages are installed.

`tools/debian_root.bash` creates, enters and removes the root, from outside and before a Python environment exists.
"""

import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ur.source.user_folders import user_folder
from ur.system.ros import Ros, note_support

MARK = "/etc/ubiquity_debian"  # exists in the root only
_VERSION = "/etc/debian_version"


class DebianRoot(NamedTuple):
    """A Debian root. `folder` contains the root file system itself (`root`) and programs that enter it (`bin`)."""

    folder: str
    version: str

    @property
    def programs(self) -> str:
        """Return the folder of the ROS programs that can be started from outside."""
        return f"{self.folder}/bin"


def find_root(environment: Mapping[str, str], *, mark: str = MARK) -> DebianRoot | None:
    """Return the Debian root that this process runs in; None if ROS is installed on the computer itself."""
    if not os.path.exists(mark):  # noqa: PTH110 - pathlib is not worth its import here
        return None
    return DebianRoot(data_folder(environment), _read_version())


def data_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of a user's Debian root, whether it exists or not."""
    return f"{user_folder('XDG_DATA_HOME', environment)}/ubiquity_launches/debian-13"


def install_command(packages: str | Sequence[str], *, mark: str = MARK) -> str:
    """Return the command that installs Debian packages where `ur` finds them."""
    names = packages if isinstance(packages, str) else " ".join(packages)
    inside = os.path.exists(mark)  # noqa: PTH110 - likewise
    return f"ur setup debian install {names}" if inside else f"sudo apt-get install {names}"


def describe_system(root: DebianRoot | None, ros: Ros | None = None) -> str:
    """Return one line that names the ROS of simulated robots; `ros` is None if it is not installed."""
    if ros is not None and ros.version != 1:
        return f"ROS: {ros}{note_support(ros.distro)}"
    if root is None:
        return "ROS: the packages of this computer"
    return f"ROS: Debian {root.version} in {root.folder}, since this computer's release has no ROS 1"


def _read_version() -> str:
    try:
        with open(_VERSION, encoding="utf-8") as file:  # noqa: PTH123 - likewise
            return file.read().strip()
    except OSError:
        return "13"
