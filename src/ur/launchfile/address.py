"""`roslaunch`'s two ways to name a launch file: a path, or a package and a file name."""

from __future__ import annotations

from collections.abc import Sequence

from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.diagnostic import Diagnostic, Note, UserError, error
from ur.source.suggest import did_you_mean


def resolve_addresses(words: Sequence[str], world: World) -> list[str]:
    """The launch files that the words of a command line name: `[package] file.launch [file ...]`.

    Words with `:=` are arguments and are left out. As in roslaunch, a file of that name anywhere in the package wins
    over a path. `-` stands for the standard input. Raises UserError.
    """
    names = [word for word in words if ":=" not in word]
    if not names:
        return []
    if len(names) >= 2:
        found = _find_in_package(names[0], names[1], world)
        if found:
            return [found, *names[2:]]
    if names[0] == "-" or world.is_file(names[0]):
        return names
    raise UserError(_explain(names, world))


def _find_in_package(package: str, name: str, world: World) -> str | None:
    try:
        found = world.find_files(package, name)
    except PackageNotFound:
        return None
    except (OSError, ValueError) as problem:
        raise UserError(error(f"packages cannot be searched: {problem}", rule="broken-package")) from None
    if len(found) > 1:
        raise UserError(
            error(
                f"package {package} holds {len(found)} files named {name}, expected one",
                rule="ambiguous-file",
                notes=tuple(Note(path) for path in found),
                help=f"give the path: {found[0]}",
            )
        )
    return found[0] if found else None


def _explain(names: list[str], world: World) -> Diagnostic:
    if len(names) == 1:
        folder, slash, last = names[0].rpartition("/")
        near = did_you_mean(last, world.list_folder(folder or "."))
        help_ = f"did you mean {folder}{slash}{near}?" if near else "give a path, or a package and a file name"
        return error(f"{names[0]} is no file, expected a launch file", rule="missing-file", help=help_)
    package, name = names[:2]
    known = set(world.package_names())
    if package in known:
        return error(
            f"package {package} holds no file named {name}, expected a launch file",
            rule="missing-file",
            help=_near_launch_file(package, name, world),
        )
    near = did_you_mean(package, known)
    help_ = f"did you mean {near}?" if near else "install it, or source the setup.bash of its workspace"
    return error(f"{package} is neither a package nor a file, expected one of them", rule="unknown-package", help=help_)


def _near_launch_file(package: str, name: str, world: World) -> str | None:
    folder = world.find_package(package)
    names = {entry for place in (folder, f"{folder}/launch") for entry in world.list_folder(place)}
    near = did_you_mean(name, (entry for entry in names if entry.endswith((".launch", ".xml", ".test"))))
    return f"did you mean {near}?" if near else f"look into {folder}"
