"""Answers of `ur __complete SHELL LINE [REPLACED]`: a line for each candidate, `open|done<TAB>text<TAB>help`.

For bash, `text` is quoted and takes the place of REPLACED, the end of LINE; zsh and fish quote by themselves. Names
that hold control characters are not offered: no shell inserts them without surprises.

It does without click: most answers need only names of files, and a person is waiting.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

from ur.complete.completions import Completion, NameSources, Option, Source
from ur.complete.line import split_line
from ur.complete.verbs import complete_line
from ur.source.diagnostic import UserError

_RUN_COMMANDS = {
    "robot command": "ur.cli.robot_setup.robot",
    "boot command": "ur.cli.robots.boot",
    "debian command": "ur.cli.computer.debian",
    "new command": "ur.cli.files.new",
    "maps command": "ur.cli.maps.maps",
    "image command": "ur.cli.robot_setup.image",
}


def answer_completion(words: Sequence[str]) -> int:
    """Print the candidates for a command line up to the cursor; none when anything fails."""
    gc.disable()  # nothing lives long enough to be worth collecting
    with suppress(Exception):
        from ur.launchfile.world.system import SystemWorld

        environment = _follow_selection(dict(os.environ))
        line = split_line(words[1] if len(words) > 1 else "")
        found = complete_line(line, SystemWorld(environment), make_known(environment))
        sys.stdout.write("".join(_row(each, *words) for each in found if each.text.isprintable()))
    return 0


def _row(candidate: Completion, shell: str, line: str = "", replaced: str | None = None) -> str:
    text: str | None = candidate.text
    if shell == "bash":
        from ur.complete.quoting import quote_insertion

        text = quote_insertion(line, replaced, candidate.text)
    return f"{'open' if candidate.open else 'done'}\t{text}\t{_flat(candidate.help)}\n" if text else ""


def make_known(environment: Mapping[str, str]) -> NameSources:
    """The sources of names on this computer."""
    from ur.request.environment import PACKAGE

    def programs() -> Iterator[Completion]:
        from ur.request.programs import index_programs

        found = index_programs(PACKAGE, environment).programs
        names = [each.name for each in found]
        for each in found:
            qualified = f"{each.package}/{each.name}" if names.count(each.name) > 1 else each.name
            yield Completion(qualified, each.summary)

    def launch_file(name: str) -> str | None:
        from ur.request.programs import find_launch_file, find_program

        with suppress(UserError):
            path = find_launch_file(find_program(PACKAGE, name, environment))
            return str(path) if path else None
        return None

    return NameSources(
        {
            "verb": _verbs,
            "program": programs,
            "help topic": lambda: [*_verbs(), *programs()],
            "robot": lambda: _robots(environment),
            "selection": lambda: [*_selections(environment), *_robots(environment)],
            "run": lambda: _runs(environment),
            "node": lambda: _nodes(environment),
            "rule": _rules,
            "map": lambda: _maps(environment),
            "shell": lambda: [Completion(each) for each in ("bash", "zsh", "fish")],
            **{kind: _commands(module) for kind, module in _RUN_COMMANDS.items()},
        },
        _kinds,
        _options,
        launch_file,
        lambda name, given: list_values(name, given, environment),
        lambda path, words: _names(path, words, environment),
    )


def _follow_selection(environment: dict[str, str]) -> dict[str, str]:
    from ur.request.environment import current_selection, environment_changes

    with suppress(UserError):
        environment.update(environment_changes(current_selection(environment), environment))
    return environment


def _verbs() -> Iterator[Completion]:
    from ur.cli.verbs import VERBS

    yield from (Completion(verb.name, verb.summary) for verb in VERBS.values())


def _kinds(verb: str) -> tuple[str, ...]:
    from ur.cli.verbs import VERBS

    if verb == "help":
        return ("help topic",)
    return VERBS[verb].arguments if verb in VERBS else ()


def _options(verb: str) -> tuple[Option, ...]:
    import click

    from ur.cli.verbs import VERBS, load_verb

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


def _robots(environment: Mapping[str, str]) -> Iterator[Completion]:
    from ur.robot.discovery.record import load_records, records_folder

    for record in load_records(records_folder(environment)):
        yield Completion(record.name, " ".join(part for part in (record.base, record.variant) if part))


def _selections(environment: Mapping[str, str]) -> Iterator[Completion]:
    yield Completion("sim", "a simulated robot on this computer")
    for base in _bases():
        yield Completion(f"sim:{base.text}", base.help)
        for variant in _variants(base.text):
            yield Completion(f"sim:{base.text}:{variant.text}", base.help)
    del environment


def _bases() -> Iterator[Completion]:
    from ur.request.environment import PACKAGE

    for path in sorted((PACKAGE / "bases").glob("*/base.yaml")):
        with path.open(encoding="utf-8") as file:
            summary = next((line for line in file if line.startswith("summary:")), "").partition(":")[2].strip()
        yield Completion(path.parent.name, summary)


def _variants(base: str) -> Iterable[Completion]:
    from ur.request.environment import PACKAGE
    from ur.robot.base import list_variants

    with suppress(UserError):
        return [Completion(name) for name in list_variants(PACKAGE, base)]
    return []


def list_values(name: str, given: Mapping[str, str], environment: Mapping[str, str]) -> Iterable[Completion]:
    """The values that an argument of a launch file may have, from its name; nothing for other names."""
    from ur.request.environment import PACKAGE, current_selection

    if name == "robot_base":
        return _bases()
    if name == "robot_variant":
        with suppress(UserError):
            return _variants(given.get("robot_base") or current_selection(environment).base)
    if name == "world":
        from ur.worlds.choice import list_worlds

        return map(Completion, list_worlds(PACKAGE))
    if name == "map":
        return [*_maps(environment), Completion("latest", "the last one of this robot")]
    if name == "localisation":
        from ur.request.bases.localisation import METHODS

        return [Completion(each) for each in METHODS]
    if name == "machine" or name.endswith("_machine"):
        return [Completion("localhost", "this computer"), *_robots(environment)]
    return ()


def _maps(environment: Mapping[str, str]) -> Iterator[Completion]:
    from ur.maps.store import own_store

    yield from (Completion(name, "a stored map") for name in own_store(environment).names())


def _rules() -> Iterator[Completion]:
    from ur.check.catalogue import load_rules

    rules = load_rules()
    yield from (Completion(rule.id, rule.summary) for rule in rules.values())
    yield from (Completion(name, "a group of rules") for name in sorted({rule.group.value for rule in rules.values()}))


def _names(path: str, argv: Sequence[str], environment: Mapping[str, str]) -> Iterator[Completion]:
    from ur.check.computer import make_world
    from ur.launchfile.query.explain import list_names
    from ur.request.arguments import split_argv
    from ur.request.environment import current_selection
    from ur.request.launch_request import make_request
    from ur.request.plan_files import complete_arguments, texts

    world = make_world([path], environment)
    request = make_request([path, *texts(split_argv(argv)[1])], world, current_selection(environment))
    files, arguments = request.files, texts(complete_arguments(request, local=True))
    yield from (
        Completion(name, kind) for name, kind in list_names(files.paths, arguments, world, files.parsed).items()
    )


def _runs(environment: Mapping[str, str]) -> Iterator[Completion]:
    from ur.run.record.computer import read_computer
    from ur.run.record.registry import list_runs

    for entry in list_runs(environment, os.getuid(), read_computer()):
        yield Completion(entry.run, entry.title)


def _nodes(environment: Mapping[str, str]) -> Iterator[Completion]:
    from ur.run.record.computer import read_computer
    from ur.run.record.registry import list_runs

    for entry in list_runs(environment, os.getuid(), read_computer()):
        for log in sorted(os.listdir(entry.log_folder)) if os.path.isdir(entry.log_folder) else ():  # noqa: PTH112, PTH208 - pathlib is not worth its import here
            name, dash, rest = log.rpartition("-")
            if dash and rest.endswith("stdout.log"):
                yield Completion(name, entry.title)


def _commands(module: str) -> Source:
    def source() -> Iterator[Completion]:
        from importlib import import_module

        import click

        group = import_module(module).command
        if isinstance(group, click.Group):
            yield from (Completion(name, each.get_short_help_str(80)) for name, each in group.commands.items())

    return source


def _flat(text: str) -> str:
    return "".join(each for each in " ".join(text.replace("`", "").split()) if each.isprintable())
