"""Folders of a user for state, configuration, data and caches: the XDG base directory specification."""

import os
from collections.abc import Mapping
from typing import Literal

MARKER = ".catkin"
"""The file that makes a folder a workspace, whose packages extend others of the same names."""

_DEFAULTS = {
    "XDG_STATE_HOME": ".local/state",
    "XDG_CONFIG_HOME": ".config",
    "XDG_DATA_HOME": ".local/share",
    "XDG_CACHE_HOME": ".cache",
}


def user_folder(
    variable: Literal["XDG_STATE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"],
    environment: Mapping[str, str],
) -> str:
    """Return the folder that an XDG variable names, or its default in the home folder.

    A value that is not an absolute path is ignored, as the specification demands. The result is a plain text, because
    importing pathlib would slow down the start of `ur`.
    """
    folder = environment.get(variable, "")
    if folder.startswith("/"):
        return folder
    home = environment.get("HOME") or os.path.expanduser("~")  # noqa: PTH111 - see above
    return f"{home}/{_DEFAULTS[variable]}"


def runtime_folder(environment: Mapping[str, str], logins: str = "/run/user") -> str:
    """Return the folder for files by which a user's programs find each other on this computer.

    System units lack XDG_RUNTIME_DIR, and use the same folder as logins; the state folder serves where there is none.
    """
    folder = environment.get("XDG_RUNTIME_DIR", "")
    if folder.startswith("/"):
        return folder
    folder = f"{logins}/{os.getuid()}"
    return folder if os.path.isdir(folder) else user_folder("XDG_STATE_HOME", environment)  # noqa: PTH112 - see above


def list_workspaces(environment: Mapping[str, str]) -> list[str]:
    """Return the folders of CMAKE_PREFIX_PATH, then the workspaces that `ur new base` has made, the newest first."""
    folders = [folder for folder in environment.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if folder]
    path = _remembered(environment)
    if not os.path.exists(path):  # noqa: PTH110 - this runs at each Tab
        return folders
    from ur.source.foreign.files import read_text

    try:
        made = read_text(path).splitlines()
    except OSError:
        return folders
    there = [each for each in reversed(made) if os.path.exists(f"{each}/{MARKER}")]  # noqa: PTH110 - likewise
    return list(dict.fromkeys([*folders, *there]))


def remember_workspace(folder: str, environment: Mapping[str, str]) -> None:
    """Remember a workspace for this user. Raises OSError."""
    if folder not in list_workspaces({**environment, "CMAKE_PREFIX_PATH": ""}):
        path = _remembered(environment)
        os.makedirs(os.path.dirname(path), exist_ok=True)  # noqa: PTH103, PTH120 - see above
        with open(path, "a", encoding="utf-8") as file:  # noqa: PTH123 - see above
            file.write(f"{folder}\n")


def _remembered(environment: Mapping[str, str]) -> str:
    return f"{user_folder('XDG_CONFIG_HOME', environment)}/ubiquity_launches/workspaces"
