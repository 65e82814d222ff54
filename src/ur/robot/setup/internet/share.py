"""Access to package servers for commands on a robot: direct, or by this computer over the ssh connection."""

import importlib
import re
import secrets
import socket
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager

from ur.robot.setup.internet.proxy import USER, Server, find_addresses, parse_server, run_proxy
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Shell, quote

PROBE_SECONDS = 4
# A line for each: `apt URL`, `pip URL`, `index` if pip has a configured index, `proxy` if there is one.
SCRIPT = """\
apt-get indextargets --format 'apt $(REPO_URI)' 2>/dev/null | sort -u
apt-config dump 2>/dev/null | grep -qiE '^Acquire::(http|https)::Proxy(::[^ ]+)? "[^"]' && echo proxy
set -- /etc/pip.conf /etc/xdg/pip/pip.conf "$HOME/.pip/pip.conf" "$HOME/.config/pip/pip.conf"
cat "$@" 2>/dev/null | grep -qE '^[[:space:]]*proxy[[:space:]]*[=:]' && echo proxy
cat "$@" 2>/dev/null | grep -qE '^[[:space:]]*index[-_]url[[:space:]]*[=:]' && echo index
cat "$@" 2>/dev/null | grep -v '^[[:space:]]*[#;]' | grep -oE 'https?://[^"[:space:]]+' | sed 's/^/pip /'
echo end"""

Route = Callable[[], Secret]


@contextmanager
def share_internet(shell: SshShell, report: Callable[[str], None]) -> Iterator[Route]:
    """Yield a function that returns the standard input of commands that download packages: a proxy and its exceptions.

    Both lines are empty if the robot reaches its package servers, or if this computer does not reach them either.
    Servers are tested only when the function is called, and the proxy ends with the context.
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


def find_servers(shell: Shell) -> frozenset[Server]:
    """Return the servers that apt and pip use on the robot; none if they use a proxy already."""
    return parse_servers(shell.run(SCRIPT).out, default_index_servers())


def parse_servers(text: str, default_index: Iterable[Server]) -> frozenset[Server]:
    """Parse the output of SCRIPT. `default_index` are the servers of pip without a configured index."""
    lines = text.splitlines()
    if "proxy" in lines:
        return frozenset()
    found = {parse_server(line.partition(" ")[2]) for line in lines if line.startswith(("apt ", "pip "))}
    if "index" not in lines:
        found |= set(default_index)
    return frozenset(server for server in found if server is not None)


def default_index_servers() -> frozenset[Server]:
    """Return the servers of pip's default index, as the pip of this environment names them."""
    try:
        index = importlib.import_module("pip._internal.models.index").PyPI
        hosts = (str(index.netloc), str(index.file_storage_domain))
    except (ImportError, AttributeError):
        return frozenset()
    return frozenset(server for host in hosts if (server := parse_server(f"https://{host}/")))


def find_unreached(shell: Shell, servers: Iterable[Server]) -> frozenset[Server]:
    """Return the servers that the robot cannot reach."""
    asked = {f"{server.host}:{server.port}": server for server in servers}
    probes = "".join(
        f"(timeout {PROBE_SECONDS} bash -c {quote(f'exec 3<>/dev/tcp/{each.host}/{each.port}')} 2>/dev/null || "
        f"echo {quote(f'no {name}')}) & "
        for name, each in sorted(asked.items())
    )
    reported = shell.run(f"{probes} wait", timeout=60.0).out
    return frozenset(asked[name] for name in re.findall(r"(?m)^no (\S+)$", reported) if name in asked)


def reaches(server: Server) -> bool:
    """Return whether a server answers this computer."""
    for address in find_addresses(server):
        try:
            socket.create_connection((address, server.port), timeout=PROBE_SECONDS).close()
        except OSError:
            continue
        return True
    return False
