"""Answers of `ur __complete SHELL LINE [REPLACED]`: a line for each candidate, `open|done<TAB>text<TAB>help`.

For bash, `text` is quoted and replaces REPLACED, the end of LINE; zsh and fish quote by themselves. Names with control
characters are not offered, since shells insert them incorrectly. It does not import click: most answers need only file
names, and the user is waiting.
"""

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache

from ur.complete import names
from ur.complete.completions import Completion, NameSources, Option, Source
from ur.complete.line import quote_insertion, split_line
from ur.complete.verbs import complete_line

_RUN_COMMANDS = {
    "robot command": "ur.cli.robot_setup.robot",
    "boot command": "ur.cli.robots.boot",
    "setup command": "ur.cli.computer.set_up",
    "new command": "ur.cli.files.new",
    "maps command": "ur.cli.maps.maps",
    "image command": "ur.cli.robot_setup.image",
}


_HELP = Option(("--help",), "Show this page.")


def answer_completion(words: Sequence[str]) -> int:
    """Print the candidates for a command line up to the cursor; none if an error occurs."""
    with suppress(Exception):
        from ur.launchfile.world.system import SystemWorld

        environment = names.follow_selection(dict(os.environ))
        line = split_line(words[1] if len(words) > 1 else "")
        found = complete_line(line, SystemWorld(environment), make_known(environment))
        sys.stdout.write("".join(_row(each, *words) for each in found if each.text.isprintable()))
        sys.stdout.flush()
    return 0


def _row(candidate: Completion, shell: str, line: str = "", replaced: str | None = None) -> str:
    text: str | None = candidate.text
    if shell == "bash":
        text = quote_insertion(line, replaced, candidate.text)
    return f"{'open' if candidate.open else 'done'}\t{text}\t{_flat(candidate.help)}\n" if text else ""


def make_known(environment: Mapping[str, str]) -> NameSources:
    """Return the sources of names on this computer."""
    return NameSources(
        {
            "verb": _verbs,
            "program": lambda: names.list_programs(environment),
            "help topic": lambda: [*_verbs(), *names.list_programs(environment)],
            "robot": lambda: names.list_robots(environment),
            "selection": lambda: [*names.list_selections(), *names.list_robots(environment)],
            "run": lambda: names.list_run_names(environment),
            "node": lambda: names.list_running_nodes(environment),
            "rule": names.list_rules,
            "map": lambda: names.list_maps(environment),
            "shell": lambda: [Completion(each) for each in ("bash", "zsh", "fish")],
            **{kind: _commands(module) for kind, module in _RUN_COMMANDS.items()},
        },
        _kinds,
        _options,
        lambda program: names.program_launch_file(program, environment),
        lambda name, given: names.list_values(name, given, environment),
        lambda path, words: names.list_file_names(path, words, environment),
    )


def _verbs() -> Iterator[Completion]:
    from ur.cli.verbs import VERBS
    from ur.cli.verbs.verb import PLUMBING

    yield from (Completion(verb.name, verb.summary) for verb in VERBS.values() if verb.section != PLUMBING)


def _kinds(verb: str) -> tuple[str, ...]:
    if verb == "launch":  # as its row has it: importing all rows takes as long as reading a hundred packages
        return ("launch",)
    from ur.cli.verbs import VERBS

    if verb == "help":
        return ("help topic",)
    return VERBS[verb].arguments if verb in VERBS else ()


def _options(verb: str) -> tuple[Option, ...]:
    if verb == "launch":
        from ur.cli.launch.options import GROUPS

        shown = (option for options in GROUPS.values() for option in options)
        found = [Option(each.names, each.help, each.kind != "flag", each.choices) for each in shown]
        return (*found, _HELP)
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
    return (*found, _HELP)


def _commands(module: str) -> Source:
    def source() -> Iterator[Completion]:
        from importlib import import_module

        import click

        group = import_module(module).command
        if isinstance(group, click.Group):
            yield from (Completion(name, each.get_short_help_str(80)) for name, each in group.commands.items())

    return source


@lru_cache  # one for most of them: "package"
def _flat(text: str) -> str:
    return "".join(each for each in " ".join(text.replace("`", "").split()) if each.isprintable())
