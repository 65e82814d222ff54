"""`ur attach`: show the output of a run, from any terminal."""

import os
import select
import signal
import sys
import threading
from collections.abc import Callable

import click

from ur.cli.runs.detached import choose_run, connect
from ur.run.clients.client import iterate_events
from ur.run.clients.protocol import (
    NodeChanged,
    Notice,
    OutputLine,
    RunEnded,
    RunEvent,
    RunStarted,
    Synchronised,
    Watch,
    dump_line,
)
from ur.run.clients.run_state import describe_node
from ur.run.record.registry import RunEntry
from ur.source.render import shows_colour


@click.command("attach")
@click.argument("run", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print all events as lines of JSON.")
@click.option("--plain", "--no-ui", is_flag=True, help="Print lines, also on a terminal.")
@click.option("--calm", is_flag=True, help="Show one line with the state of the run, and warnings and errors.")
def command(run: str | None, as_json: bool, plain: bool, calm: bool) -> int:
    """Show what a run prints, from any terminal.

    Returns the run's exit code when it ends. Ctrl-C leaves it running.
    """
    entry = choose_run(run)
    if not (as_json or plain):
        from ur.tui.start import look_for_mode

        mode = look_for_mode(os.environ, calm=calm)
        if mode != "plain":
            return _watch(entry, mode)
    end_with_reader(sys.stdout.fileno())
    show = show_json if as_json else make_printer(colour=shows_colour(sys.stdout))
    try:
        with connect(entry) as client:
            client.send(Watch(output=True, readiness=as_json))
            for event in iterate_events(client):
                show(event)
                if isinstance(event, RunEnded):
                    return event.exit_code
    except KeyboardInterrupt:
        sys.stderr.write(f"\n{entry.run} runs on; 'ur stop {entry.run}' ends it\n")
        return 0
    sys.stderr.write(f"error: run {entry.run} was killed\n")
    return 1


def end_with_reader(descriptor: int) -> None:
    """End this process once its output has no reader, for instance when its ssh connection has ended.

    Without output it would not notice, and a robot would consider its laptop connected (see `ur.run.remote.signs`).
    """

    def wait() -> None:
        poll = select.poll()
        poll.register(descriptor, 0)  # errors and hang-ups are always reported
        poll.poll()
        os._exit(128 + signal.SIGPIPE)

    threading.Thread(target=wait, daemon=True).start()


def _watch(entry: RunEntry, mode: str) -> int:
    from ur.tui.watch import watch_run

    with connect(entry) as client:
        how, code = watch_run(client, mode, os.environ, ours=False)
    if how == "detached":
        sys.stderr.write(f"{entry.run} runs on; 'ur stop {entry.run}' ends it\n")
        return 0
    if how == "killed":
        sys.stderr.write(f"error: run {entry.run} was killed\n")
        return 1
    return code


def show_json(event: RunEvent) -> None:
    """Print an event as a line of JSON."""
    sys.stdout.buffer.write(dump_line(event))
    sys.stdout.buffer.flush()


def make_printer(*, colour: bool) -> Callable[[RunEvent], None]:
    """Return a printer of events as `ur launch` prints them: output of nodes on standard output, the rest on error."""
    nodes: list[NodeChanged] = []
    live = False

    def show(event: RunEvent) -> None:
        nonlocal live
        match event:
            case RunStarted():
                _print(f"{event.run}, ROS_MASTER_URI={event.master_uri}, log files in {event.log_folder}")
            case NodeChanged() if not live:
                nodes.append(event)
            case Synchronised():
                live = True
                for node in nodes:
                    _print(f"[{node.name}] {describe_node(node)}")
            case OutputLine():
                head = f"\x1b[1m[{event.name}]\x1b[0m" if colour else f"[{event.name}]"
                tail = "\x1b[0m" if "\x1b" in event.text else ""
                sys.stdout.write(f"{head} {event.text}{tail}\n")
                sys.stdout.flush()
            case Notice():
                _print(f"error: {event.text}" if event.severity == "error" else event.text)

    return show


def _print(text: str) -> None:
    sys.stderr.write(text + "\n")
