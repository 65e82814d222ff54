"""From the options of `ur launch` to a run: its plan, its interface, its limits."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from ur.request.options import Wishes
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, Severity, UserError, error

if TYPE_CHECKING:
    from ur.launchfile.plan.model import Plan
    from ur.launchfile.world.protocol import World
    from ur.request.plan_files import Loaded
    from ur.run.clients.protocol import Severity as EventSeverity
    from ur.run.launch import Options
    from ur.run.output.console import Console
    from ur.run.process.detach import LetGo
    from ur.run.record.registry import RunEntry
    from ur.run.startup.timings import Timings
    from ur.tui.start import Viewer


def load_wanted(words: Sequence[str], selection: Selection, wishes: Wishes) -> Loaded:
    """What a command line means with the options that choose nodes; errors in it are shown.

    Raises UserError, as `load_words` does, and for nodes that options name wrongly.
    """
    from ur.request.plan_files import Loaded, load_words

    if wishes.core:
        from ur.launchfile.plan.model import Plan
        from ur.launchfile.world.system import SystemWorld

        return Loaded(Plan((), (), (), (), (), ("core",)), SystemWorld(os.environ))
    loaded = load_words(words, selection, wishes.part)
    plan = loaded.plan
    if plan is None:
        return loaded
    if wishes.local:
        from ur.run.paths import is_local_address
        from ur.run.startup.machine_assignment import split_plan

        plan, away = split_plan(plan, is_local_address)
        for each in away:
            names = ", ".join(node.full_name for node in each.nodes)
            wishes.say("warning", f"--local: {names} for {each.machine.name} ({each.machine.address}) left out")
    if wishes.only or wishes.except_ or wishes.prefix:
        from ur.request.node_choice import choose_nodes

        plan = choose_nodes(plan, wishes.only, wishes.except_, wishes.prefix)
    for node in plan.nodes if wishes.required else ():
        if node.respawn:
            message = f"--required: {node.full_name} is to be respawned, expected a node that may end"
            raise UserError(error(message, node.origin.span, rule="required-respawn"))
    if wishes.verbose:
        wishes.say("info", "\n".join(_list_contents(plan)))
    if wishes.part is not None:
        from ur.run.startup.machine_assignment import take_part

        mine = {node.full_name for node in plan.nodes if node.machine == wishes.part} - set(wishes.runs_already)
        plan = take_part(plan, mine)
        plan = replace(plan, commands=tuple(each for each in plan.commands if each.command != "dump"))
    return replace(loaded, plan=plan)


def _list_contents(plan: Plan) -> Iterator[str]:
    yield from (f"file {path}" for path in plan.files)
    yield from (f"parameter {each.name}: {each.command or each.value!r}" for each in plan.params)
    yield from (f"node {node.full_name} ({node.package}/{node.type})" for node in plan.nodes)


def describe_finding(finding: Diagnostic) -> tuple[EventSeverity, str]:
    """A finding in a launch file as severity and text for the interface's log."""
    from ur.source.render import render_human

    severity: EventSeverity = "warning" if finding.severity is Severity.WARNING else "info"
    return severity, render_human([finding], colour=False).rstrip()


def run_launch(words: Sequence[str], selection: Selection, wishes: Wishes, let_go: LetGo | None) -> int:
    """Start what a command line asks for, and return the exit code once it has ended. Raises UserError."""
    from ur.run.process.host_client import start_host  # now, not before: help and completion need none of it

    host = start_host()  # its start overlaps with the reading of the launch file
    stack = ExitStack()
    try:
        from ur.cli.launch.joining import Joined, join
        from ur.request.running import begin_launch
        from ur.run.launch import run_plan

        lock, words = begin_launch(words, wishes, stack)
        loaded = load_wanted(words, selection, wishes)
        plan, world = loaded.plan, loaded.world
        if plan is None:
            _report(loaded.findings, wishes)
            return 1
        if wishes.core:
            _refuse_second_master()
        world = _prepare(loaded.files, plan, world, wishes)
        restart_share = None
        client = os.urandom(8).hex()
        joined = Joined(plan, {})
        if wishes.part is None:
            found = join(loaded, words, selection, wishes, client)
            if found is None:
                return 0
            joined = found
            plan = joined.plan
            if not selection.simulated:
                from ur.run.remote.own_clients import clients_folder, hold_client

                stack.enter_context(hold_client(client, clients_folder(os.environ, os.getuid())))
        if loaded.robot and any(node.machine == loaded.robot for node in plan.nodes):
            from ur.request.on_robot import start_there  # ssh, and what comes with it: only where it is needed

            part = stack.enter_context(start_there(replace(loaded, plan=plan), words, wishes, client))
            plan, restart_share = part.here, part.again.start
            if not plan.nodes:
                lock.release()
                return part.follow()
        if wishes.debug:
            from ur.cli.launch import debugging

            terminal = not (wishes.detach or wishes.json) and debugging.has_terminal()
            plan, told = debugging.debug_nodes(plan, wishes.debug, world, terminal=terminal)
            if told:
                wishes.say("warning", "\n".join(told))
        with _pid_file(wishes.pid), _viewer(plan, wishes) as viewer:
            console = _make_console(viewer)
            try:
                options = _options(words, selection, wishes, console, let_go)
                options = replace(
                    options,
                    environment=joined.environment,
                    restart_share=restart_share,
                    owners=joined.owners,
                    call_registered=lock.release,
                )
                if viewer is not None:
                    options = replace(options, viewer=viewer.link)
                return run_plan(plan, world, host, console, options)
            finally:
                console.finish(1.0)
    finally:
        host.close()
        stack.close()


def _prepare(files: Sequence[str], plan: Plan, world: World, wishes: Wishes) -> World:
    """Install what the plan needs, and return a world that knows it. Raises UserError."""
    from ur.request.preparation import prepare
    from ur.run.startup.node_selection import check_display, is_view

    if wishes.part is None:
        check_display(files, plan.nodes, world.environment)
    if not prepare(plan, world, view=is_view(files)):
        return world
    from ur.launchfile.world.system import SystemWorld

    return SystemWorld(world.environment)


def _report(findings: Sequence[Diagnostic], wishes: Wishes) -> None:
    if wishes.report is not None:
        from ur.cli.launch.act import write_report

        write_report(findings, wishes.report)


def _refuse_second_master() -> None:
    from ur.run.master.client import parse_master_uri
    from ur.run.master.xml_rpc import Unanswered

    master = parse_master_uri(os.environ["ROS_MASTER_URI"])
    try:
        master.get_run_id()
    except Unanswered:
        return
    raise UserError(error(f"--core: a master runs already at {master.uri}", rule="second-master", help="ur ps"))


def _make_console(viewer: Viewer | None) -> Console:
    """The console; what it says before the interface opens is the beginning of the interface's log too."""
    from ur.run.output.console import Console

    if viewer is None:
        return Console()

    note = viewer.note

    class Noting(Console):
        def warn(self, text: str) -> None:
            if not self.silent:
                note("error" if text.startswith("error") else "warning", text)
            super().warn(text)

    return Noting()


@contextmanager
def _viewer(plan: Plan, wishes: Wishes) -> Iterator[Viewer | None]:
    """The interface, where there is a terminal that no node needs. It begins with what was said so far."""
    if wishes.plain or wishes.json or wishes.detach or any(node.terminal for node in plan.nodes):
        yield None
        return
    from ur.tui.start import Viewer, look_for_mode

    mode = look_for_mode(os.environ, calm=wishes.calm)
    if mode == "plain":
        yield None
        return
    with Viewer(mode) as viewer:
        for note in (*map(describe_finding, plan.diagnostics), *wishes.notes):
            viewer.note(*note)
        yield viewer


def _options(
    words: Sequence[str], selection: Selection, wishes: Wishes, console: Console, let_go: LetGo | None
) -> Options:
    from ur.run.launch import Options
    from ur.run.supervisor.model import Limits

    given = dict(word.split(":=", 1) for word in words if ":=" in word)
    base = given.get("robot_base", selection.base)
    defaults = Limits()

    def leave(entry: RunEntry) -> None:
        console.finish(1.0)
        console.calm()
        if let_go is not None:
            let_go(entry)

    master_words = []
    if wishes.timeout is not None:
        master_words += ["-t", str(wishes.timeout)]
    if wishes.master_logger_level is not None:
        master_words += ["--master-logger-level", wishes.master_logger_level]
    return Options(
        limits=Limits(
            interrupt=wishes.sigint_timeout or defaults.interrupt,
            terminate=wishes.sigterm_timeout or defaults.terminate,
            quick_deaths=defaults.quick_deaths if wishes.respawn_limit is None else wishes.respawn_limit,
        ),
        force_screen=wishes.screen,
        force_log=wishes.log,
        force_required=wishes.required,
        wait_for_master=wishes.wait and not wishes.detach,
        port=wishes.port,
        workers=wishes.numworkers,
        master_words=tuple(master_words),
        base=base,
        variant=given.get("robot_variant", selection.variant if base == selection.base else ""),
        events=1 if wishes.json else None,
        timings=_begin_timings() if wishes.timings else None,
        call_started=None if let_go is None else leave,
    )


def _begin_timings() -> Timings:
    from ur.run.startup.timings import begin_timings

    timings = begin_timings()
    timings.mark("launch file")
    return timings


class _pid_file:  # noqa: N801 - used like a function: with _pid_file(path)
    """A file with our process id, for as long as we run."""

    def __init__(self, path: str | None) -> None:
        self._path = path

    def __enter__(self) -> None:
        if self._path:
            from pathlib import Path

            try:
                Path(self._path).expanduser().write_text(str(os.getpid()), encoding="ascii")
            except OSError as problem:
                reason = (problem.strerror or str(problem)).lower()
                raise UserError(
                    error(f"--pid {self._path}: cannot be written: {reason}", rule="bad-pid-file")
                ) from None

    def __exit__(self, *_: object) -> None:
        if self._path:
            from pathlib import Path

            Path(self._path).expanduser().unlink(missing_ok=True)
