"""The files of this project in each kind of installation: a clone, a copy on a robot, or an installed wheel.

A clone and a copy have the same folders. A wheel contains the Python packages, and all other files in `_project`, a
folder of the package `ur` that `tools/build_wheel.py` creates. Only this module depends on the difference.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from functools import cache

from ur.source.user_folders import user_folder

TYPE_CHECKING = False
if TYPE_CHECKING:
    from pathlib import Path

# The running files, and those of the set-up: no tests, no documents, no generated files.
PARTS = (
    "src",
    "ubiquity_launches",
    "requirements",
    "tools/set_up.bash",
    "tools/build_wheel.py",
    "tools/debian_root.bash",
    "ur",
    "pyproject.toml",
    "README.md",
    "LICENSE",
)
LIBRARY = "ubiquity_launches"
DISTRIBUTION = "ubiquity-launches"
DATA_FOLDER = "_project"
# Neither a wheel nor an sdist of setuptools holds links: they hold copies, and this list of PATH TARGET, one a line.
LINKS = "links"
STATE_FOLDER = ".local/share/ubiquity_launches"  # in the home folder, unless XDG_DATA_HOME names another
_PYTHON_PACKAGES = ("ur", "ur_nodes")
_LEFT_OUT = ("__pycache__", ".egg-info", ".pyc")


# Tab needs three of these folders, as texts: importing pathlib would take a tenth of its time.
# ruff: noqa: PTH112, PTH118, PTH120


def package_folder() -> Path:
    """Return the folder of the Python package `ur`."""
    from pathlib import Path

    return Path(_package())


@cache
def _package() -> str:
    return os.path.dirname(os.path.dirname(os.path.realpath(__file__)))


def is_installed() -> bool:
    """Return whether this process runs from a wheel."""
    return os.path.isdir(os.path.join(_package(), DATA_FOLDER))


def project_folder() -> Path:
    """Return the folder of the launch library, the locks and the set-up: of a clone or copy, or within the wheel."""
    from pathlib import Path

    return Path(project_path())


def project_path() -> str:
    """Return the project folder as a text."""
    package = _package()
    return os.path.join(package, DATA_FOLDER) if is_installed() else os.path.dirname(os.path.dirname(package))


def project_file(name: str) -> Path:
    """Return the file with this name in a clone: `requirements/run.lock`, `src/ur/system/releases.tsv`."""
    if is_installed() and name.startswith("src/"):
        return package_folder().parent / name.removeprefix("src/")
    return project_folder() / name


def launch_library() -> Path:
    """Return the ROS package of launch files."""
    from pathlib import Path

    return Path(library_path())


def library_path() -> str:
    """Return the launch library as a text."""
    return os.path.join(project_path(), LIBRARY)


def state_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder of `.venv` and `.cache`: the clone or copy, or for a wheel a folder of the user."""
    from pathlib import Path

    return Path(state_path(environment))


def state_path(environment: Mapping[str, str] = os.environ) -> str:
    """Return the state folder as a text."""
    if not is_installed():
        return project_path()
    return f"{user_folder('XDG_DATA_HOME', environment)}/ubiquity_launches"


def list_files(root: Path | None = None) -> Iterator[tuple[str, Path, str]]:
    """Yield the files of a copy of this project, from a clone or a wheel: names as in a clone, sorted by part.

    Each item is the name, the file, and the target if it is a symbolic link. `root` is the clone to list, by default
    the running project.
    """
    if root is None and is_installed():
        yield from _list_wheel()
        return
    folder = root or project_folder()
    links = _read_links(folder)
    for name, path in _walk(folder, PARTS):
        yield name, path, os.fspath(path.readlink()) if path.is_symlink() else links.get(name, "")


def _list_wheel() -> Iterator[tuple[str, Path, str]]:
    package, data = package_folder(), project_folder()
    for name, path in _walk(package.parent, _PYTHON_PACKAGES):
        if not path.is_relative_to(data):
            yield f"src/{name}", path, ""
    links = _read_links(data)
    for name, path in _walk(data, PARTS[1:]):
        yield name, path, links.get(name, "")


def _read_links(folder: Path) -> dict[str, str]:
    file = folder / LINKS
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
    return dict(line.split(" ", 1) for line in lines)


def _walk(root: Path, parts: tuple[str, ...]) -> Iterator[tuple[str, Path]]:
    for part in parts:
        place = root / part
        for path in sorted(place.rglob("*")) if place.is_dir() else [place]:
            name = str(path.relative_to(root))
            if not any(each in name for each in _LEFT_OUT) and (path.is_symlink() or path.is_file()):
                yield name, path


def describe_origin() -> str:
    """Describe the running installation: `clone FOLDER at COMMIT`, `copy FOLDER`, or `wheel in ENVIRONMENT`."""
    if is_installed():
        return f"wheel in {sys.prefix}"
    folder = project_folder()
    if (folder / ".copy").is_file():
        return f"copy {folder}"
    commit = _read_commit(folder)
    return f"clone {folder} at {commit}" if commit else f"folder {folder}"


def _read_commit(folder: Path) -> str:
    """Return the commit of a clone, followed by '+changes' if files differ; empty without git."""
    import subprocess

    command = ["git", "-C", str(folder), "describe", "--always", "--dirty=+changes", "--exclude=*"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 and (folder / ".git").exists() else ""
