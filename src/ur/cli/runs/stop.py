"""`ur stop`: end a run, or one of its nodes."""

import os
import select
import sys
import time

import click

from ur.cli.runs.detached import choose_run, connect, find_node_name, leave_out_joined, list_own_runs
from ur.run.clients.client import RunClient
from ur.run.clients.protocol import NodeChanged, OutputLine, RunEnded, StopRun, Synchronised, Watch
from ur.run.join.owner import describe_joined, list_joined
from ur.run.remote.local_runs import wait_exit
from ur.run.supervisor.events import StopNode
from ur.source.diagnostic import user_error
from ur.source.progress_line import show_progress

JOINED_SECONDS = 10.0  # s for runs that end because they had joined this one
IMPATIENCE = 8.0  # s after which the request is repeated, which sends stronger signals


@click.command("stop")
@click.argument("run", required=False)
@click.option("--node", metavar="NODE", help="Stop only this node; the run continues.")
@click.option("--all", "every", is_flag=True, help="Stop every run.")
def command(run: str | None, node: str | None, every: bool) -> int:
    """End a run, or one of its nodes.

    A run ends as with Ctrl-C; the command returns when all of its processes have ended.
    """
    return stop_run(run, node, every=every)


def stop_run(run: str | None, node: str | None = None, *, every: bool = False, output: bool = False) -> int:
    """End a run of this computer, one of its nodes, or all runs. Returns the exit code.

    With `output`, what the nodes of the run print until their end is printed.
    """
    if every:
        if run or node:
            raise user_error("--all cannot be used with RUN or --node", rule="bad-options")
        runs = list_own_runs()
        last = leave_out_joined(runs)
        for entry in [*(each for each in runs if each not in last), *last]:
            with connect(entry) as client, show_progress(f"waiting for {entry.run} to end"):
                _stop_run(client)
            sys.stderr.write(f"{entry.run} has ended\n")
        return 0
    entry = choose_run(run)
    with connect(entry) as client:
        if node is not None:
            return _stop_node(client, node)
        names = list_joined(entry.run, os.environ, os.getuid())
        joined = [each for each in list_own_runs() if each.run in names]
        with show_progress(f"waiting for {entry.run} to end"):
            _stop_run(client, output=output)
    until = time.monotonic() + JOINED_SECONDS
    for each in joined:
        with show_progress(f"waiting for {each.run} to end"):
            wait_exit(each, until)
    also = f"; {text}" if (text := describe_joined(names)) else ""
    sys.stderr.write(f"{entry.run} has ended{also}\n")
    return 0


def _stop_run(client: RunClient, *, output: bool = False) -> None:
    if output:
        client.send(Watch(output=True))
    client.send(StopRun("asked by 'ur stop'"))
    asked = time.monotonic()
    while True:
        if not select.select([client], [], [], max(0.0, asked + IMPATIENCE - time.monotonic()))[0]:
            client.send(StopRun("asked by 'ur stop'"))
            asked = time.monotonic()
            continue
        events = client.receive()
        lines = [event.text for event in events or () if isinstance(event, OutputLine)]
        sys.stdout.write("".join(f"{line}\n" for line in lines))
        if events is None or any(isinstance(event, RunEnded) for event in events):
            break
    while client.receive() is not None:  # the process ends after its last event
        select.select([client], [], [], 1.0)


def _stop_node(client: RunClient, given: str) -> int:
    name = ""
    names: list[str] = []
    while (events := client.receive()) is not None:
        for event in events:
            if isinstance(event, NodeChanged):
                names.append(event.name)
                if name and event.name == name and event.state == "ended":
                    return 0
            elif isinstance(event, Synchronised):
                name = find_node_name(given, names)
                client.send(StopNode(name))
        select.select([client], [], [])
    return 0
