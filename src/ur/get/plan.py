"""The plan of `ur get`, from missing packages and tables: a pure function; and the plan as text."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from ur.get.index import ROS2, Index
from ur.get.steps import (
    PACKAGE_NAME,
    PYPI,
    SPLIT,
    DebianPackage,
    GetPlan,
    InstallStep,
    Missing,
    SourceRepository,
    possible_names,
)
from ur.source.printable import printable

WORKSPACE = "~/catkin_ws"


def render_plan(plan: GetPlan) -> str:
    """Return the packages to install, those to build, and unknown ones; each part ends with a summary line."""
    return "".join(f"{printable(line)}\n" for line in _lines(plan))


def clone_command(repository: SourceRepository) -> str:
    """Return the command that clones a repository into the workspace."""
    target = f"{WORKSPACE}/src/{repository.name}"
    version = repository.version
    if repository.type == "git":
        return f"git clone{f' -b {version}' if version else ''} {repository.url} {target}"
    if repository.type == "hg":
        return f"hg clone{f' -u {version}' if version else ''} {repository.url} {target}"
    return f"svn checkout{f' -r {version}' if version.isdigit() else ''} {repository.url} {target}"


def _lines(plan: GetPlan) -> Iterator[str]:
    for title, steps in (
        ("Debian packages:", plan.steps_by("debian")),
        ("other Debian packages, which are not of ROS:", plan.steps_by("other")),
        ("from PyPI:", plan.steps_by("pypi")),
    ):
        if steps:
            yield title
            yield from (f"  {_name(step)}: {' '.join(step.names)}" for step in steps)
    yield from _sources(plan.steps_by("source"))
    unknown = plan.steps_by("unknown")
    if unknown:
        yield "not found:"
        yield from (f"  {_name(step)}: {step.reason}" for step in unknown)
    yield from (f"note: {note}" for note in plan.notes)


def _sources(steps: tuple[InstallStep, ...]) -> Iterator[str]:
    if not steps:
        return
    yield "to be built from source:"
    commands: dict[str, str] = {}
    for step in steps:
        assert step.repository is not None
        if step.needs is None:
            needs = "its dependencies are known once it is here"
        else:
            needs = f"it also needs {', '.join(step.needs)}" if step.needs else "all that it needs is installed"
        old = step.repository.distribution
        if step.reason:
            needs = f"{step.reason}; {needs}"
        elif old:
            needs = f"last in ROS {old}, and may need changes for noetic; {needs}"
        yield f"  {_name(step)}: {step.repository.url}; {needs}"
        commands.setdefault(clone_command(step.repository), f"{WORKSPACE}/src/{step.repository.name}")
    yield f"these commands put them into {WORKSPACE} and build them:"
    for command, folder in commands.items():
        yield f"  {command}"
        yield f"  ur get {folder}"
    yield "  cd ~/catkin_ws && catkin_make"


def _name(step: InstallStep) -> str:
    missing = step.missing
    return f"{missing.package} ({missing.program})" if missing.program else missing.package


NO_INDEX = "no index of sources is here"
ONLY_ROS2 = "only in ROS 2 {}, and has to be ported to ROS 1"
_NEAR = 0.93  # likeness of a misspelt name; related packages have similar ones, too


@dataclass(frozen=True, slots=True)
class Tables:
    """The inputs of a plan.

    `rosdep`: Debian names by ROS package. `candidates`: the queried packages that apt can install; None without apt,
    where rosdep's table is trusted. `installed`: names of Debian packages. `index`: sources; None if not available.
    `distribution`: that of packages.ros.org, "" without it. `known`: repositories of packages that are in no index.
    `ros2`: the index of ROS 2. `names`: installed packages.
    """

    rosdep: Mapping[str, tuple[str, ...]]
    candidates: Mapping[str, DebianPackage] | None
    installed: frozenset[str] = frozenset()
    index: Index | None = None
    distribution: str = ""
    known: Mapping[str, SourceRepository] = field(default_factory=dict)
    ros2: Index | None = None
    names: frozenset[str] = frozenset()


def make_plan(
    missing: Iterable[Missing], tables: Tables, is_there: Callable[[str], bool], notes: Iterable[str] = ()
) -> GetPlan:
    """Determine the source of each missing package. `is_there` returns whether a ROS package is installed."""
    wanted: dict[str, Missing] = {}
    for each in missing:
        wanted.setdefault(each.package, each)
    steps = tuple(_find_method(wanted[name], tables, is_there) for name in sorted(wanted))
    return GetPlan(steps, tuple(notes))


def _find_method(missing: Missing, tables: Tables, is_there: Callable[[str], bool]) -> InstallStep:
    package = missing.package
    if not PACKAGE_NAME.fullmatch(package):
        return InstallStep(missing, "unknown", reason="that is not the name of a package")
    names = _debian_names(package, tables)
    if names:
        return InstallStep(missing, "debian" if _is_of_ros(package, names, tables) else "other", names)
    if package in PYPI:
        return InstallStep(missing, "pypi", (PYPI[package],))
    if missing.program:
        return InstallStep(missing, "unknown", reason=f"{package} is installed and has no program {missing.program}")
    repository, origin = _find_source(package, tables)
    if repository is None:
        return InstallStep(missing, "unknown", reason=_explain(missing, tables))
    depends = None if origin or tables.index is None else tables.index.dependencies.get(package)
    needs = None if depends is None else tuple(name for name in depends if not is_there(name))
    return InstallStep(missing, "source", repository=repository, needs=needs, reason=origin)


def _find_source(package: str, tables: Tables) -> tuple[SourceRepository | None, str]:
    indexed = tables.index.repositories.get(package) if tables.index else None
    if indexed and indexed.distribution not in ROS2:
        return indexed, ""
    if package in tables.known:
        return tables.known[package], "no index has it"
    newer = indexed or (tables.ros2.repositories.get(package) if tables.ros2 else None)
    return newer, ONLY_ROS2.format(newer.distribution) if newer else ""


def _explain(missing: Missing, tables: Tables) -> str:
    place = f", which {missing.named_in} names" if missing.named_in else ""
    if tables.index is None:
        return f"no package of this release has it{place}, and {NO_INDEX}"
    from difflib import get_close_matches  # seldom needed

    near = get_close_matches(missing.package, tables.names, 1, _NEAR) or _swapped(missing.package, tables.index)
    if near:
        return f"no package has this name{place}; did you mean {near[0]}?"
    return f"neither this release nor an index of ROS has it{place}: it is private or withdrawn, ask its author"


def _swapped(name: str, index: Index) -> list[str]:
    # Of thousands of names in an index some are like any other: only one with the same letters is a misspelt one.
    return [each for each in index.repositories if sorted(each) == sorted(name)][:1]


def _debian_names(package: str, tables: Tables) -> tuple[str, ...]:
    # Names that are only similar, such as a game with the name of a robot, are no candidates: they must belong to ROS.
    known = tables.rosdep.get(package)
    sets = possible_names(package, tables.distribution)
    if tables.candidates is None:
        return _only_missing(known, tables) if known else ()
    if "-" in package and package in tables.candidates:  # of a package.xml: a library, by its own name
        return _only_missing((package,), tables)
    by_ros = {name for name, each in tables.candidates.items() if each.for_ros}
    # The first rules name packages that hold programs, which rosdep's table, made for building, leaves out.
    if package in SPLIT and tables.candidates.keys() >= set(SPLIT[package]):
        return _only_missing(SPLIT[package], tables)
    for names in sets[:-2] if known else sets:
        if by_ros.issuperset(names) and (missing := _only_missing(names, tables)):
            return tuple(dict.fromkeys((*missing, *_also(known, tables))))
    if known and tables.candidates.keys() >= set(known):
        return _only_missing(known, tables)
    return ()


def _is_of_ros(package: str, names: tuple[str, ...], tables: Tables) -> bool:
    # By its own name any package of Debian can be meant, a server as well as a library.
    if "-" not in package or package in tables.rosdep or tables.candidates is None:
        return True
    return all(name in tables.candidates and tables.candidates[name].for_ros for name in names)


def _also(known: tuple[str, ...] | None, tables: Tables) -> tuple[str, ...]:
    # A package that makes ROS find the program's package: Debian has package.xml in the -dev package of some.
    if not known or tables.candidates is None or not tables.candidates.keys() >= set(known):
        return ()
    return _only_missing(known, tables)


def _only_missing(names: tuple[str, ...], tables: Tables) -> tuple[str, ...]:
    return tuple(name for name in names if name not in tables.installed)
