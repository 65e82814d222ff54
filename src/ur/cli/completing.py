"""What `ur __complete SHELL LINE` answers: a line for each candidate, `open|done<TAB>text<TAB>help`.

It stands beside click: most answers need no more than the names of files, and a person is waiting.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

from ur.complete.line import split_line
from ur.complete.model import Candidate, Known, Option, Source
from ur.complete.verbs import complete_line
from ur.source.diagnostic import UserError

_RUN_COMMANDS = {
    "robot command": "ur.cli.robot",
    "boot command": "ur.cli.boot",
    "new command": "ur.cli.new",
    "image command": "ur.cli.image",
}


def answer_completion(words: Sequence[str]) -> int:
    """Print what fits a command line up to the cursor. Whatever goes wrong: nothing is offered."""
    with suppress(Exception):
        from ur.launchfile.world.system import SystemWorld

        environment = _follow_selection(dict(os.environ))
        line = split_line(words[1] if len(words) > 1 else "")
        found = complete_line(line, SystemWorld(environment), make_known(environment))
        rows = (f"{'open' if each.open else 'done'}\t{each.text}\t{_flat(each.help)}\n" for each in found)
        sys.stdout.write("".join(rows))
    return 0


def make_known(environment: Mapping[str, str]) -> Known:
    """Where this computer's names come from."""
    from ur.cli.environment import PACKAGE

    def programs() -> Iterator[Candidate]:
        from ur.cli.programs import list_programs

        yield from (Candidate(each.name, each.summary) for each in list_programs(PACKAGE / "bin"))

    def launch_file(name: str) -> str | None:
        from ur.cli.programs import find_launch_file, find_program

        with suppress(UserError):
            path = find_launch_file(find_program(PACKAGE / "bin", name), PACKAGE)
            return str(path) if path else None
        return None

    return Known(
        {
            "verb": _verbs,
            "program": programs,
            "robot": lambda: _robots(environment),
            "selection": lambda: [*_selections(environment), *_robots(environment)],
            "run": lambda: _runs(environment),
            "node": lambda: _nodes(environment),
            "shell": lambda: [Candidate(each) for each in ("bash", "zsh", "fish")],
            **{kind: _commands(module) for kind, module in _RUN_COMMANDS.items()},
        },
        _options,
        launch_file,
        lambda name, given: _values(name, given, environment),
    )


def _follow_selection(environment: dict[str, str]) -> dict[str, str]:
    from ur.cli.environment import current_selection, environment_changes

    with suppress(UserError):
        environment.update(environment_changes(current_selection(environment), environment))
    return environment


def _verbs() -> Iterator[Candidate]:
    from ur.cli.main import VERBS

    yield from (Candidate(name, summary) for name, (_, summary) in VERBS.items())


def _options(verb: str) -> tuple[Option, ...]:
    import click

    from ur.cli.main import VERBS, load_verb

    if verb not in VERBS:
        return ()
    command = load_verb(verb)
    commands = list(command.commands.values()) if isinstance(command, click.Group) else []
    found = [
        Option(
            (*parameter.opts, *parameter.secondary_opts),
            parameter.help or "",
            not parameter.is_flag and not parameter.count,
            tuple(map(str, parameter.type.choices)) if isinstance(parameter.type, click.Choice) else (),
        )
        for parameter in {each.name: each for one in (command, *commands) for each in one.params}.values()
        if isinstance(parameter, click.Option) and not parameter.hidden
    ]
    return (*found, Option(("--help",), "Show this page."))


def _robots(environment: Mapping[str, str]) -> Iterator[Candidate]:
    from ur.robot.record import load_records, records_folder

    for record in load_records(records_folder(environment)):
        yield Candidate(record.name, " ".join(part for part in (record.base, record.variant) if part))


def _selections(environment: Mapping[str, str]) -> Iterator[Candidate]:
    yield Candidate("sim", "a simulated robot on this computer")
    for base in _bases():
        yield Candidate(f"sim:{base.text}", base.help)
        for variant in _variants(base.text):
            yield Candidate(f"sim:{base.text}:{variant.text}", base.help)
    del environment


def _bases() -> Iterator[Candidate]:
    from ur.cli.environment import PACKAGE

    for path in sorted((PACKAGE / "bases").glob("*/base.yaml")):
        with path.open(encoding="utf-8") as file:
            summary = next((line for line in file if line.startswith("summary:")), "").partition(":")[2].strip()
        yield Candidate(path.parent.name, summary)


def _variants(base: str) -> Iterable[Candidate]:
    from ur.cli.environment import PACKAGE
    from ur.robot.base import list_variants

    with suppress(UserError):
        return [Candidate(name) for name in list_variants(PACKAGE, base)]
    return []


def _values(name: str, given: Mapping[str, str], environment: Mapping[str, str]) -> Iterable[Candidate]:
    from ur.cli.environment import PACKAGE, current_selection

    if name == "robot_base":
        return _bases()
    if name == "robot_variant":
        with suppress(UserError):
            return _variants(given.get("robot_base") or current_selection(environment).base)
    if name == "world":
        return [Candidate(path.stem) for path in sorted((PACKAGE / "n_simulator" / "worlds").glob("*.yaml"))]
    if name == "machine" or name.endswith("_machine"):
        return [Candidate("localhost", "this computer"), *_robots(environment)]
    return ()


def _runs(environment: Mapping[str, str]) -> Iterator[Candidate]:
    from ur.run.registry import list_runs

    for entry in list_runs(environment, os.getuid(), os.uname().nodename):
        yield Candidate(entry.run, entry.title)


def _nodes(environment: Mapping[str, str]) -> Iterator[Candidate]:
    from ur.run.registry import list_runs

    for entry in list_runs(environment, os.getuid(), os.uname().nodename):
        for log in sorted(os.listdir(entry.log_folder)) if os.path.isdir(entry.log_folder) else ():  # noqa: PTH112, PTH208 - pathlib is not worth its import here
            name, dash, rest = log.rpartition("-")
            if dash and rest.endswith("stdout.log"):
                yield Candidate(name, entry.title)


def _commands(module: str) -> Source:
    def source() -> Iterator[Candidate]:
        from importlib import import_module

        import click

        group = import_module(module).command
        if isinstance(group, click.Group):
            yield from (Candidate(name, each.get_short_help_str(80)) for name, each in group.commands.items())

    return source


def _flat(text: str) -> str:
    return " ".join(text.replace("`", "").split())
