"""A way to the package servers for commands on a robot: its own, or this computer's over the ssh connection."""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager

from ur.robot.setup.internet.proxy import USER, run_proxy
from ur.robot.setup.internet.servers import find_servers, find_unreached, reaches
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret

Route = Callable[[], Secret]


@contextmanager
def share_internet(shell: SshShell, report: Callable[[str], None]) -> Iterator[Route]:
    """Give a function for `Command.stdin` of commands that fetch packages: two lines, a proxy and exceptions from it.

    Both are empty where the robot reaches its package servers, or this computer does not reach them either. Nothing is
    looked at before the function is called, and the proxy ends with the context.
    """
    found: list[Secret] = []
    with ExitStack() as stack:

        def route() -> Secret:
            if not found:
                found.append(_find_route(shell, stack, report))
            return found[0]

        yield route


def _find_route(shell: SshShell, stack: ExitStack, report: Callable[[str], None]) -> Secret:
    direct = Secret("\n\n")
    servers = find_servers(shell)
    unreached = sorted(find_unreached(shell, servers)) if servers else []
    if not unreached:
        return direct
    with ThreadPoolExecutor(len(unreached)) as pool:
        shared = [server for server, good in zip(unreached, pool.map(reaches, unreached), strict=True) if good]
    if not shared:
        return direct
    password = Secret(secrets.token_hex(16))
    port = stack.enter_context(run_proxy(shared, password))
    there = shell.forward_back(port)
    if not there:
        report("it has no internet, and its ssh server does not allow forwarding (AllowTcpForwarding)")
        return direct
    names = ", ".join(sorted({server.host for server in shared}))
    report(f"it has no internet: it fetches packages over this computer's connection ({names})")
    reached = ",".join(sorted({server.host for server in servers} - {server.host for server in shared}))
    return Secret(f"http://{USER}:{password.reveal()}@127.0.0.1:{there}\n{reached}\n")
