"""The robot's share of a run whose other nodes run on a laptop: start it, find it, end it after its last client.

`python -I -m ur.run.remote.share` reads a request as JSON from standard input and prints an answer as JSON. The share
is a separate detached run: it survives the connection that requested it, and the laptop. It is found by its command
line; its clients are registered in its control folder.
"""

import os
import subprocess
import sys
import time
from collections.abc import Collection, Iterable
from contextlib import suppress
from dataclasses import replace

from ur.robot.remote_run import MODULE
from ur.run.master.client import Master, parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.record.registry import Computer, RunEntry, list_runs, read_computer
from ur.run.remote.local_runs import (
    HoldingRun,
    RequestBusyError,
    find_holders,
    find_share,
    is_stopping,
    lock_shares,
    wait_exit,
)
from ur.run.remote.names import choose_names
from ur.run.remote.own_clients import (
    TooManyClientsError,
    add_client,
    is_shared,
    read_clients,
    remove_clients,
    remove_dead,
    write_clients,
)
from ur.run.remote.protocol import MAX_BYTES, Client, Problem, ShareAnswer, ShareRequest, dump, parse_request
from ur.run.remote.signs import Sign, read_signs
from ur.run.remote.start import scope, start_share
from ur.source.diagnostic import UserError

END_SECONDS = 25.0
SILENCE_SECONDS = 60.0  # s in which clients without a sign, when the last other one left, may give one
_AGAIN_SECONDS = 2.0
_WAIT = "--end-when-silent"


def begin(request: ShareRequest) -> ShareAnswer:
    """Find or start the share, and register its client with it and with every shared run that it depends on."""
    with lock_shares(os.environ, os.getuid(), END_SECONDS):
        computer = read_computer()
        runs = list_runs(os.environ, os.getuid(), computer)
        entry = find_share(runs, request)
        if entry is not None and is_stopping(entry):
            wait_exit(entry, time.monotonic() + END_SECONDS)
            runs = list_runs(os.environ, os.getuid(), computer)
            entry = find_share(runs, request)
        renamed_from = ""
        if entry is not None and entry.host != computer.host:
            # Its nodes and its master are registered under a name that can no longer be resolved.
            renamed_from = entry.host
            if not _stop(entry):
                return ShareAnswer(problem=_not_ended(entry.run, request.machine))
            runs = [each for each in runs if each.run != entry.run]
            entry = None
        return _begin(request, entry, runs, computer, renamed_from)


def _begin(
    request: ShareRequest, entry: RunEntry | None, runs: list[RunEntry], computer: Computer, renamed_from: str
) -> ShareAnswer:
    if request.master_uri:
        os.environ.update({"ROS_MASTER_URI": request.master_uri, "ROS_HOSTNAME": request.host})
        os.environ.pop("ROS_IP", None)
    others = [each for each in runs if entry is None or each.run != entry.run]
    holders = find_holders(others, request.nodes, _own_master().port)
    for holder in holders:
        if holder.entry.host != computer.host:
            return ShareAnswer(problem=_renamed(holder, computer, request.machine))
    relied = [holder.entry for holder in holders if is_shared(holder.entry.folder)]
    held = {name for holder in holders for name in holder.nodes}
    if entry is not None:
        return _register(
            [entry, *relied], request, ShareAnswer(entry.run, found=True, running=_in_order(request, held))
        )
    running = _in_order(request, held | set(_find_live(request)))
    if request.nodes and len(running) == len(request.nodes):
        return _register(relied, request, ShareAnswer(running=running, renamed_from=renamed_from))
    run, problem = start_share(request, running)
    if problem is not None:
        return ShareAnswer(running=running, problem=problem)
    started = [each for each in list_runs(os.environ, os.getuid(), computer) if each.run == run]
    return _register([*started, *relied], request, ShareAnswer(run, running=running, renamed_from=renamed_from))


def end(request: ShareRequest) -> ShareAnswer:
    """Unregister a client from every share that it uses; end those without another client."""
    ended, kept, names, problem = [], [], set[str](), None
    with lock_shares(os.environ, os.getuid(), END_SECONDS):
        runs = list_runs(os.environ, os.getuid(), read_computer())
        own = find_share(runs, request)
        for entry in runs:
            clients = read_clients(entry.folder)
            identity = request.client.client if request.client else ""
            if entry is not own and all(each.client != identity for each in clients):
                continue
            clients, signs = _look_for_signs(entry, remove_clients(_without_dead(clients, request), {identity}))
            with suppress(OSError):
                write_clients(entry.folder, clients)
            if clients:
                kept.append(entry.run)
                names |= {client.name for client in clients}
                if Sign.PRESENT not in signs:
                    _wait_for_sign(entry)
            elif _stop(entry):
                ended.append(entry.run)
            else:
                problem = _not_ended(entry.run, request.machine)
    return ShareAnswer(ended=tuple(ended), kept=tuple(kept), clients=tuple(sorted(names)), problem=problem)


def end_when_silent(run: str) -> None:
    """End a run unless one of its clients gives a sign of life within SILENCE_SECONDS."""
    until = time.monotonic() + SILENCE_SECONDS
    while True:
        entry = next((each for each in list_runs(os.environ, os.getuid(), read_computer()) if each.run == run), None)
        if entry is None:
            return
        with suppress(RequestBusyError), lock_shares(os.environ, os.getuid(), END_SECONDS):
            clients, signs = _look_for_signs(entry, read_clients(entry.folder))
            if Sign.PRESENT in signs:
                return
            if not clients or time.monotonic() > until:
                _stop(entry)
                return
        time.sleep(_AGAIN_SECONDS)


def _register(entries: Iterable[RunEntry], request: ShareRequest, answer: ShareAnswer) -> ShareAnswer:
    """Register the client with runs; the answer names other clients, and new names for nodes that they have too."""
    if request.client is None:
        return answer
    found = [
        (entry, _look_for_signs(entry, _without_dead(read_clients(entry.folder), request))[0]) for entry in entries
    ]
    others = [each for _, clients in found for each in clients if each.client != request.client.client]
    held = {node for each in others for node in each.nodes}
    names = choose_names(request.client.nodes, request.client.name, held.intersection)
    nodes = tuple(names.get(node, node) for node in request.client.nodes)
    client = replace(request.client, nodes=nodes, since=time.time())
    for entry, clients in found:
        with suppress(OSError, TooManyClientsError):
            write_clients(entry.folder, add_client(clients, client))
    # A detached run of the same computer is taken over.
    left = [each for each in others if not (each.detached and each.machine == client.machine)]
    return replace(answer, clients=tuple(dict.fromkeys(each.name for each in left)), names=names)


def _look_for_signs(entry: RunEntry, clients: Collection[Client]) -> tuple[tuple[Client, ...], list[Sign]]:
    """Return the clients that have not ended, and the sign of each."""
    signs = read_signs(clients, _master_of(entry), time.time())
    left = tuple(client for client in clients if signs[client.client] is not Sign.ENDED)
    return left, [signs[client.client] for client in left]


def _without_dead(clients: tuple[Client, ...], request: ShareRequest) -> tuple[Client, ...]:
    asking = request.client
    return clients if asking is None else remove_dead(clients, asking.machine, (asking.client, *request.alive))


def _wait_for_sign(entry: RunEntry) -> None:
    subprocess.Popen(
        [*scope(), sys.executable, "-I", "-m", MODULE, _WAIT, entry.run],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def _stop(entry: RunEntry) -> bool:
    """End a run and wait until its process has ended, a little after its last event."""
    until = time.monotonic() + END_SECONDS
    with suppress(subprocess.TimeoutExpired):
        command = [sys.executable, "-I", "-m", "ur", "stop", entry.run]
        subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=END_SECONDS, check=False)
    return wait_exit(entry, until)


def _find_live(request: ShareRequest) -> tuple[str, ...]:
    try:
        return tuple(_own_master().find_live_nodes(request.nodes)) if request.nodes else ()
    except (Unanswered, CallRefused):
        return ()


def _own_master() -> Master:
    return parse_master_uri(os.environ.get("ROS_MASTER_URI", "http://localhost:11311"))


def _master_of(entry: RunEntry) -> Master:
    """Return the master of a run; that of this computer if the host name may be outdated."""
    try:
        return Master(entry.master_uri, "localhost", parse_master_uri(entry.master_uri).port, 1.0)
    except UserError:
        return Master("", "localhost", 11311, 1.0)


def _in_order(request: ShareRequest, names: Iterable[str]) -> tuple[str, ...]:
    found = set(names)
    return tuple(name for name in request.nodes if name in found)


def _not_ended(run: str, robot: str) -> Problem:
    return Problem(f"run {run} has not ended within {END_SECONDS:g} s", f"ur shell {robot} ur stop {run}", "not-ended")


def _renamed(holder: HoldingRun, computer: Computer, robot: str) -> Problem:
    entry, names = holder.entry, ", ".join(holder.nodes)
    return Problem(
        f"run {entry.run} started {names} when {robot} was called {entry.host.split('.')[0]}, "
        f"expected nodes that are registered as {computer.host.split('.')[0]}",
        f"ur shell {robot} ur stop {entry.run}; then start it again",
        "old-name",
    )


def main() -> None:
    """Answer the request on standard input, or wait for silent clients."""
    if sys.argv[1:2] == [_WAIT]:
        end_when_silent(sys.argv[2])
        return
    try:
        request = parse_request(sys.stdin.read(MAX_BYTES + 1))
        answer = begin(request) if request.action == "begin" else end(request)
    except (ValueError, TypeError) as problem:
        answer = ShareAnswer(problem=Problem(f"the request cannot be read: {problem}", rule="bad-request"))
    except RequestBusyError:
        answer = ShareAnswer(problem=Problem("another program is being started or ended there", "try again", "busy"))
    sys.stdout.write("\n" + dump(answer) + "\n")


if __name__ == "__main__":
    main()
