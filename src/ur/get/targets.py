"""Missing packages of a command line's targets: launch files, packages, folders."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.get.folder import SUFFIXES, folder_needs, text_of, with_folders
from ur.get.index import read_dependencies
from ur.get.missing import is_installed, missing_of_names, missing_of_plan
from ur.get.steps import PACKAGE_NAME, Missing, Needs
from ur.launchfile.load import load_plan
from ur.launchfile.world.system import SystemWorld
from ur.request.launch_request import make_request
from ur.source.arguments import split_argv
from ur.source.diagnostic import Severity, UserError, error


def find_needs(words: Sequence[str], environment: Mapping[str, str]) -> Needs:
    """Find the missing packages of a launch file with its arguments, of folders, or of packages. Raises UserError."""
    world = SystemWorld(environment)
    named = [word for word in words if ":=" not in word]
    if any(word.endswith(SUFFIXES) for word in named) or (len(named) == 1 and Path(named[0]).is_file()):
        return _file_needs(words, world)
    if len(named) != len(words):
        raise UserError(
            error("NAME:=VALUE is given, expected it after a launch file", rule="usage", help="ur get --help")
        )
    found: dict[str, Missing] = {}
    notes: tuple[str, ...] = ()
    for word in words:
        if "/" in word or word in (".", ".."):
            needs = folder_needs([word], environment)
            world, notes = SystemWorld(with_folders([word], environment)), (*notes, *needs.notes)
            found.update((each.package, each) for each in needs.missing)
        elif not PACKAGE_NAME.fullmatch(word):
            message = f"{word!r} is neither a launch file nor the name of a package"
            raise UserError(error(message, rule="unknown-package", help="ur get --help"))
        elif is_installed(word, world):
            text = text_of(Path(world.find_package(word)) / "package.xml")
            try:
                needed = missing_of_names(read_dependencies(text, environment), world)
                found.update((each.package, each) for each in needed)
            except ValueError as problem:
                notes = (*notes, f"the package.xml of {word} was not read: {problem}")
        else:
            found[word] = Missing(word)
    names = tuple(world.package_names())
    return Needs(tuple(found.values()), lambda name: is_installed(name, world), notes, names)


def _file_needs(words: Sequence[str], world: SystemWorld) -> Needs:
    request = make_request(split_argv(words), world)
    plan = load_plan(request.files.paths, [str(each) for each in request.arguments], world, parsed=request.files.parsed)
    others = [
        each for each in plan.diagnostics if each.severity is Severity.ERROR and each.rule not in
        ("unknown-package", "missing-executable")
    ]  # fmt: skip
    file = Path(request.files.paths[0]).resolve()
    unreadable = [each for each in others if each.rule in ("bad-xml", "wrong-ros-version")]
    if any(each.span and Path(each.span.file.path).resolve() == file for each in unreadable):
        raise UserError(*unreadable)
    notes = (f"not everything was read: {others[0].span or file}: {others[0].message}",) if others else ()
    missing = missing_of_plan(plan, world)
    names = tuple(world.package_names()) if missing else ()
    return Needs(missing, lambda name: is_installed(name, world), notes, names)
