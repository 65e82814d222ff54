"""The plan of `ur get` as text."""

from collections.abc import Iterator

from ur.get.steps import GetPlan, InstallStep, SourceRepository
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
    yield "  ur build"


def _name(step: InstallStep) -> str:
    missing = step.missing
    return f"{missing.package} ({missing.program})" if missing.program else missing.package
