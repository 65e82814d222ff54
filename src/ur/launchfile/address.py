"""The two forms in which `roslaunch` accepts a launch file: a path, or a package and a file name."""

from collections.abc import Sequence

from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.diagnostic import Diagnostic, Note, UserError, error, user_error
from ur.source.suggest import did_you_mean, suggest

_SUFFIXES = (".launch", ".launch.xml", ".test")


def resolve_addresses(names: Sequence[str], world: World) -> list[str]:
    """Return the launch files that a command line names: `[package] file.launch [file ...]`.

    As in roslaunch, a file of that name anywhere in the package takes precedence over a path. `-` stands for the
    standard input. Raises UserError.
    """
    names = list(names)
    if not names:
        return []
    if len(names) >= 2:
        found = _find_in_package(names[0], names[1], world)
        if found:
            return [found, *names[2:]]
    if names[0] == "-" or world.is_file(names[0]):
        return names
    raise UserError(_explain(names, world))


def find_launch_file(package: str, name: str, world: World) -> str:
    """Return the path of a package's launch file.

    Raises UserError with the existing launch files and the nearest name.
    """
    found = _find_in_package(package, name, world)
    if found:
        return found
    names = _list_launch_files(world.find_package(package), world)
    expected = f"expected one of {_shorten(names)}" if names else "which has no launch file"
    help_ = suggest(name, names) or (None if names else "write one: ur new multi")
    raise user_error(
        f"no file '{name}' in package '{package}', {expected}", rule="missing-file", help=help_, subject=name
    )


def join_addresses(words: Sequence[str], world: World) -> list[str]:
    """Return arguments that name files, folders and packages, with each `PACKAGE FILE` replaced by a path.

    An argument that is a path stays one, also after a package. Raises UserError if a package has several such files.
    """
    joined: list[str] = []
    package = ""
    for word in words:
        found = _find_in_package(package, word, world) if package and not _is_path(word, world) else None
        if found:
            joined[-1] = found
        else:
            joined.append(word)
        package = "" if found or "/" in word else word
    return joined


def _is_path(word: str, world: World) -> bool:
    return world.is_file(word) or bool(world.list_folder(word))


def _find_in_package(package: str, name: str, world: World) -> str | None:
    try:
        found = world.find_files(package, name)
    except PackageNotFound:
        return None
    except (OSError, ValueError) as problem:
        raise user_error(f"packages cannot be searched: {problem}", rule="broken-package") from None
    if len(found) > 1:
        raise user_error(
            f"package '{package}' has {len(found)} files named '{name}', expected one",
            rule="ambiguous-file",
            notes=tuple(Note(path) for path in found),
            help=f"give the path: {found[0]}",
        )
    return found[0] if found else None


def _explain(names: list[str], world: World) -> Diagnostic:
    if len(names) == 1 and names[0] in world.package_names():
        files = _list_launch_files(world.find_package(names[0]), world)
        message = f"no launch file given for package {names[0]!r}, expected one of {_shorten(files)}"
        return error(message, rule="missing-file", help=f"ur launch {names[0]} {files[0]}" if files else None)
    if len(names) == 1:
        folder, slash, last = names[0].rpartition("/")
        near = did_you_mean(last, (entry for entry in world.list_folder(folder or ".") if entry.endswith(_SUFFIXES)))
        help_ = f"did you mean {folder}{slash}{near}?" if near else "give a path, or a package and a file name"
        if inside := names[0] and world.list_folder(names[0]):
            files = [f"{names[0].rstrip('/')}/{entry}" for entry in inside if entry.endswith(_SUFFIXES)]
            expected = f"one of {_shorten(files)}" if files else "a launch file"
            message = f"{names[0]} is a folder, expected {expected}"
            return error(message, rule="missing-file", help=f"give a file: {files[0]}" if files else help_)
        if near == last:  # a folder without files may end like a launch file
            return error(f"{names[0]} is a folder, expected a launch file", rule="missing-file")
        return error(f"no file '{names[0]}', expected a launch file", rule="missing-file", help=help_)
    package, name = names[:2]
    known = set(world.package_names())
    if package in known:
        return error(
            f"no file '{name}' in package '{package}', expected a launch file",
            rule="missing-file",
            help=_near_launch_file(package, name, world),
            subject=name,
        )
    near = did_you_mean(package, known)
    help_ = f"did you mean {near}?" if near else "install it, or source the setup.bash of its workspace"
    return error(f"no package or file named '{package}'", rule="unknown-package", help=help_, subject=package)


def _near_launch_file(package: str, name: str, world: World) -> str | None:
    folder = world.find_package(package)
    return suggest(name, _list_launch_files(folder, world)) or f"look into {folder}"


def _shorten(names: Sequence[str], most: int = 6) -> str:
    rest = [f"{len(names) - most} more"] if len(names) > most else []
    return ", ".join([*names[:most], *rest]) or "(none)"


def _list_launch_files(folder: str, world: World, depth: int = 3) -> list[str]:
    """Return the names of the launch files of a package, at most `depth` folders deep."""
    names: set[str] = set()
    for entry in world.list_folder(folder):
        if entry.endswith(_SUFFIXES):
            names.add(entry)
        elif depth and not entry.startswith(".") and "." not in entry:
            names.update(_list_launch_files(f"{folder}/{entry}", world, depth - 1))
    return sorted(names)
