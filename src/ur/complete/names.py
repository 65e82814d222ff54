"""Names on this computer for completion: programs, robots, runs, maps, and the values of arguments."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

from ur.complete.completions import Completion
from ur.source.diagnostic import UserError


def list_programs(environment: Mapping[str, str]) -> Iterator[Completion]:
    """Yield the programs, qualified by their package if two have the same name."""
    from ur.request.programs import PACKAGE, index_programs

    found = index_programs(PACKAGE, environment).programs
    names = [each.name for each in found]
    for each in found:
        qualified = f"{each.package}/{each.name}" if names.count(each.name) > 1 else each.name
        yield Completion(qualified, each.summary)


def program_launch_file(name: str, environment: Mapping[str, str]) -> str | None:
    """Return the launch file that a program starts, or None."""
    from ur.request.programs import PACKAGE, find_launch_file, find_program

    with suppress(UserError):
        path = find_launch_file(find_program(PACKAGE, name, environment))
        return str(path) if path else None
    return None


def follow_selection(environment: dict[str, str]) -> dict[str, str]:
    """Add the variables of the selected robot to an environment, and return it."""
    from ur.request.environment import current_selection, environment_changes

    with suppress(UserError):
        environment.update(environment_changes(current_selection(environment), environment))
    return environment


def list_robots(environment: Mapping[str, str]) -> Iterator[Completion]:
    """Yield the robots that were set up from this computer."""
    from ur.robot.discovery.record import load_records, records_folder

    for record in load_records(records_folder(environment)):
        yield Completion(record.name, " ".join(part for part in (record.base, record.variant) if part))


def list_selections() -> Iterator[Completion]:
    """Yield the simulated robots that `ur use` accepts."""
    yield Completion("sim", "a simulated robot on this computer")
    for base in _bases():
        yield Completion(f"sim:{base.text}", base.help)
        for variant in _variants(base.text):
            yield Completion(f"sim:{base.text}:{variant.text}", base.help)


def _bases() -> Iterator[Completion]:
    from ur.source.project import library_path

    folder = f"{library_path()}/bases"
    for name in sorted(os.listdir(folder)):  # noqa: PTH208 - pathlib is not worth its import here
        with suppress(OSError), open(f"{folder}/{name}/base.yaml", encoding="utf-8") as file:  # noqa: PTH123 - likewise
            summary = next((line for line in file if line.startswith("summary:")), "").partition(":")[2].strip()
            yield Completion(name, summary)


def _variants(base: str) -> Iterable[Completion]:
    from ur.request.programs import PACKAGE
    from ur.robot.base import list_variants

    with suppress(UserError):
        return [Completion(name) for name in list_variants(PACKAGE, base)]
    return []


def list_values(name: str, given: Mapping[str, str], environment: Mapping[str, str]) -> Iterable[Completion]:
    """Return the values of a launch argument by its name; empty for other names."""
    from ur.request.environment import current_selection

    if name == "robot_base":
        return _bases()
    if name == "robot_variant":
        with suppress(UserError):
            return _variants(given.get("robot_base") or current_selection(environment).base)
    if name == "world":
        from ur.request.programs import PACKAGE
        from ur.worlds.choice import list_worlds

        return map(Completion, list_worlds(PACKAGE))
    if name == "map":
        return [*list_maps(environment), Completion("latest", "the last one of this robot")]
    if name == "localisation":
        from ur.request.bases.localisation import METHODS

        return [Completion(each) for each in METHODS]
    if name == "machine" or name.endswith("_machine"):
        return [Completion("localhost", "this computer"), *list_robots(environment)]
    return ()


def list_maps(environment: Mapping[str, str]) -> Iterator[Completion]:
    """Yield the stored maps."""
    from ur.maps.store import own_store

    yield from (Completion(name, "a stored map") for name in own_store(environment).names())


def list_rules() -> Iterator[Completion]:
    """Yield the rules of `ur check`, and their groups."""
    from ur.check.catalogue import load_rules

    rules = load_rules()
    yield from (Completion(rule.id, rule.summary) for rule in rules.values())
    yield from (Completion(name, "a group of rules") for name in sorted({rule.group.value for rule in rules.values()}))


def list_file_names(path: str, argv: Sequence[str], environment: Mapping[str, str]) -> Iterator[Completion]:
    """Yield the parameters, arguments, remaps and nodes of a launch file with its arguments. Raises UserError."""
    from ur.check.worlds import make_world
    from ur.launchfile.query.explain import list_names
    from ur.request.environment import current_selection
    from ur.request.launch_request import make_request
    from ur.request.plan_files import complete_arguments, texts
    from ur.source.arguments import split_argv

    world = make_world([path], environment)
    request = make_request(split_argv(argv)._replace(names=(path,)), world, current_selection(environment))
    files, arguments = request.files, texts(complete_arguments(request, local=True))
    yield from (
        Completion(name, kind) for name, kind in list_names(files.paths, arguments, world, files.parsed).items()
    )


def list_run_names(environment: Mapping[str, str]) -> Iterator[Completion]:
    """Yield the runs of this user."""
    from ur.run.record.registry import list_runs, read_computer

    for entry in list_runs(environment, os.getuid(), read_computer()):
        yield Completion(entry.run, entry.title)


def list_running_nodes(environment: Mapping[str, str]) -> Iterator[Completion]:
    """Yield the nodes of this user's runs that have log files."""
    from ur.run.record.registry import list_runs, read_computer

    for entry in list_runs(environment, os.getuid(), read_computer()):
        for log in sorted(os.listdir(entry.log_folder)) if os.path.isdir(entry.log_folder) else ():  # noqa: PTH112, PTH208 - pathlib is not worth its import here
            name, dash, rest = log.rpartition("-")
            if dash and rest.endswith("stdout.log"):
                yield Completion(name, entry.title)
