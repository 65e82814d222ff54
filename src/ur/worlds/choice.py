"""Launch arguments that choose a world or a map: names, and paths of files."""

import os
from pathlib import Path

from ur.source.diagnostic import UserError, user_error
from ur.source.suggest import did_you_mean

WORLD = "world"
PATHS = (WORLD, "world_file", "map_file")
"""Arguments whose relative paths start at the working folder of the caller."""

_MAKE = "'ur new world NAME' makes a world of your own"
_PICTURES = frozenset({".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".gif", ".tif", ".tiff", ".webp"})
_MARKS = ("./", "../", "~/")


def is_path(value: str) -> bool:
    """Return whether a value of `world` is a path; other values are names of worlds."""
    return "/" in value or value.endswith((".yaml", ".yml"))


def resolve_path(name: str, value: str, folder: Path, *, always: bool = False) -> str:
    """Make the value of an argument absolute if it is a relative path of a world or a map.

    Without `always` this applies only to values that name an existing file, or begin with `./`, `../` or `~/`: in other
    launch files the argument may have another meaning.
    """
    if name not in PATHS or not value or (name == WORLD and not is_path(value)):
        return value
    path = folder / Path(value).expanduser()
    if not (always or value.startswith(_MARKS) or path.is_file()):
        return value
    return os.path.normpath(path)


def list_worlds(package: Path) -> tuple[str, ...]:
    """Return the sorted names of the worlds in a launch package."""
    return tuple(sorted(path.stem for path in (package / "n_simulator" / "worlds").glob("*.yaml")))


def explain_missing_world(path: str, package: Path) -> UserError:
    """Return the error about a missing world file: by its name if it should be in the launch library."""
    names = list_worlds(package)
    folder = package / "n_simulator" / "worlds"
    if Path(path).parent == folder:
        name = Path(path).name.removesuffix(".yaml")
        message = f"unknown world {name!r}, expected one of {', '.join(names)} or the path of a world file"
        near = did_you_mean(name, names)
        help_ = f"did you mean world:={near}?" if near else _MAKE
        if Path(name).suffix.lower() in _PICTURES:
            help_ = f"a picture becomes a world by: ur new world NAME --picture {name} --width METRES"
    else:
        problem = "is a folder" if os.path.isdir(path) else "does not exist"  # noqa: PTH112 - fails nowhere
        message = f"world file {path!r} {problem}, expected the path of a YAML file or one of {', '.join(names)}"
        near = did_you_mean(Path(path).name, _files_beside(path))
        help_ = f"did you mean {near!r}?" if near else _MAKE
    return user_error(message, rule="unknown-world", help=help_)


def explain_missing_map(path: str) -> UserError:
    """Return the error about a missing map file."""
    near = did_you_mean(Path(path).name, _files_beside(path))
    help_ = f"did you mean {near!r}?" if near else "a map is a YAML file in the format of map_server"
    problem = "is a folder" if os.path.isdir(path) else "does not exist"  # noqa: PTH112 - fails nowhere
    message = f"map file {path!r} {problem}, expected the path of a map's YAML file"
    return user_error(message, rule="unknown-map", help=help_)


def _files_beside(path: str) -> list[str]:
    try:
        return [each.name for each in Path(path).parent.iterdir() if each.suffix in (".yaml", ".yml")]
    except OSError:
        return []
