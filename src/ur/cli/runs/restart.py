"""`ur restart`: stop a node of a run and start it again."""

import sys

import click

from ur.cli.runs.detached import choose_run, connect, find_node_name
from ur.run.clients.client import iterate_events
from ur.run.clients.protocol import NodeChanged, Notice, Synchronised
from ur.run.supervisor.events import RestartNode


@click.command("restart")
@click.argument("node")
@click.option("--run", metavar="RUN", help="The run it belongs to; may be left out where there is only one.")
def command(node: str, run: str | None) -> int:
    """Stop a node and start it again.

    Also starts one that has ended or was stopped.
    """
    entry = choose_run(run)
    names: list[str] = []
    name = ""
    before: int | None = None
    pids: dict[str, int | None] = {}
    with connect(entry) as client:
        for event in iterate_events(client):
            if isinstance(event, Synchronised):
                name = find_node_name(node, names)
                before = pids[name]
                client.send(RestartNode(name))
            elif isinstance(event, NodeChanged):
                names.append(event.name)
                pids[event.name] = event.pid
                if event.name == name and event.state == "running" and event.pid != before:
                    sys.stderr.write(f"{name} runs again, process {event.pid}\n")
                    return 0
                if event.name == name and event.state == "ended" and event.reason:
                    sys.stderr.write(f"error: {name}: {event.reason}\n")
                    return 1
            elif isinstance(event, Notice) and name and event.text.startswith(f"{name}: "):
                sys.stderr.write(f"error: {event.text}\n")
                return 1
    sys.stderr.write(f"error: run {entry.run} has ended\n")
    return 1
