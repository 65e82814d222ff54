"""Clients that try to silence a page on this computer: `python -m bench.web_parts.attackers KIND PORT`.

They have no login but for the kind `member`, which reads its cookie from standard input. They run at the lowest
priority, take loopback addresses only, hold at most 1100 connections, and end after `--seconds`.
"""

import argparse
import json
import os
import resource
import select
import socket
import sys
import tempfile
import threading
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

MOST_IDLE, MOST_SLOW, THREADS = 1100, 200, 8
HEAD = "{line} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://localhost:{port}\r\n{more}Content-Length: {size}\r\n\r\n"
# A page of another site: 30 loops of requests, as far as a browser lets it.
SITE = """<!doctype html><script>
for (let loop = 0; loop < 30; loop++) (async () => {
  for (;;) await fetch("http://localhost:%d/x?" + Math.random(), { mode: "no-cors" }).catch(() => null);
})();
</script>"""


class Attack:
    """One kind of attack on a port until a time of time.monotonic()."""

    def __init__(self, port: int, until: float, cookie: str = "") -> None:
        self._port, self._until, self._cookie = port, until, cookie

    @property
    def over(self) -> bool:
        """Return whether the time is up."""
        return time.monotonic() > self._until

    def none(self) -> None:
        """Do nothing, for comparison."""
        while not self.over:
            time.sleep(0.1)

    def packed(self) -> None:
        """Send a body of 1 GiB of zeros, packed to 1 MB, also under another host's name."""
        packer = zlib.compressobj(9, wbits=-15)
        block = packer.compress(bytes(1 << 20)) + packer.flush(zlib.Z_FULL_FLUSH)  # can be repeated
        heads = {"gzip": b"\x1f\x8b\x08" + bytes(6) + b"\xff", "deflate": b"\x78\xda"}
        packed = {name: head + 1024 * block for name, head in heads.items()}
        cases = [(name, host) for name in packed for host in (f"localhost:{self._port}", "evil.example")]

        def send(number: int) -> None:
            name, host = cases[number % len(cases)]
            more = f"Content-Encoding: {name}\r\n"
            self._ask(self._head("POST /login", len(packed[name]), more=more, host=host) + packed[name])

        self._repeat(send, 2)

    def idle(self) -> None:
        """Hold connections that send nothing."""
        self._hold(b"", MOST_IDLE)

    def half(self) -> None:
        """Hold connections that have sent half a head."""
        self._hold(b"GET /login HTTP/1.1\r\nHost: loc", MOST_IDLE)

    def slow(self) -> None:
        """Send heads by one byte in a tenth of a second."""
        self._hold(b"GET /login HTTP/1.1\r\nX: ", MOST_SLOW, drip=b"y")

    def body(self) -> None:
        """Announce a body that never comes."""
        self._hold(self._head("POST /login", 2000), MOST_IDLE)

    def requests(self) -> None:
        """Send requests, each over a connection of its own."""
        self._repeat(lambda _: self._ask(self._head("GET /main.js")), THREADS)

    def pipeline(self) -> None:
        """Send thousands of requests at once over each connection."""
        many = self._head("GET /login") * 2000
        self._repeat(lambda _: self._ask(many), THREADS)

    def member(self) -> None:
        """Send requests of a session that may look, 50 at a time over each of 8 connections, and read the answers."""
        more = f"Cookie: {self._cookie}\r\n"
        many = b"".join(self._head(line, more=more) for line in ("POST /api/stop", "GET /nope", "GET /main.js")) * 50
        self._repeat(lambda _: self._pour(many), THREADS)

    def heads(self) -> None:
        """Send heads of 31 kB with cookies that almost are those of a session."""
        large = self._head_of_cookies()
        self._repeat(lambda _: self._ask(large), THREADS)

    def addresses(self) -> None:
        """Connect from 200 addresses: large heads, logins and sockets without a session."""
        wrong = json.dumps({"token": "x" * 24}).encode()
        upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\n"
        kinds = [
            self._head_of_cookies(), self._head("POST /login", len(wrong)) + wrong,
            self._head("GET /ws/drive", more=upgrade),
        ]  # fmt: skip
        self._repeat(lambda number: self._ask(kinds[number % len(kinds)], f"127.0.1.{1 + number % 200}"), THREADS)

    def _head_of_cookies(self) -> bytes:
        near = "; ".join([f"ur_web_{self._port}={129 * 'a'}"] * 220)
        return self._head("GET /login", more=f"Cookie: {near}\r\n")

    def logins(self) -> None:
        """Log in with tokens that are wrong."""
        wrong = json.dumps({"token": "x" * 24}).encode()
        self._repeat(lambda _: self._ask(self._head("POST /login", len(wrong)) + wrong), THREADS)

    def site(self) -> None:
        """Open a page of another site in Chromium that asks again and again."""
        from tests.chromium import Chromium, find_chromium

        page = (SITE % self._port).encode()

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(page)

            def log_message(self, *_: object) -> None:
                pass

        program = find_chromium()
        assert program is not None, "Chromium is not installed"
        server = HTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with (
            tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder,
            Chromium(program, Path(folder)) as browser,
        ):
            browser.ask("Page.navigate", url=f"http://127.0.0.1:{server.server_address[1]}/")
            self.none()
        server.shutdown()

    def _head(self, line: str, size: int = 0, *, more: str = "", host: str = "") -> bytes:
        host = host or f"localhost:{self._port}"
        return HEAD.format(line=line, host=host, port=self._port, more=more, size=size).encode()

    def _ask(self, data: bytes, source: str = "127.0.0.1") -> None:
        with suppress(OSError), socket.create_connection(("127.0.0.1", self._port), 5.0, (source, 0)) as sock:
            with suppress(OSError):
                sock.sendall(data)
            while sock.recv(1 << 16):
                pass

    def _pour(self, data: bytes) -> None:
        """Send data again and again over one connection while the answers are read."""
        with suppress(OSError), socket.create_connection(("127.0.0.1", self._port), 5.0) as sock:
            sock.setblocking(False)
            left = memoryview(data)
            while not self.over:
                selected = select.select([sock], [sock], [], 0.1)
                if selected[0] and not sock.recv(1 << 18):
                    return
                if selected[1]:
                    left = left[sock.send(left) :] or memoryview(data)

    def _repeat(self, act: Callable[[int], None], threads: int) -> None:
        def run(number: int) -> None:
            while not self.over:
                act(number)
                number += threads

        started = [threading.Thread(target=run, args=(number,)) for number in range(threads)]
        for each in started:
            each.start()
        for each in started:
            each.join()

    def _hold(self, data: bytes, most: int, *, drip: bytes = b"") -> None:
        """Hold connections, and open another one for each that the server closes."""
        held: list[socket.socket] = []
        while not self.over:
            for _ in range(min(50, most - len(held))):
                with suppress(OSError):
                    sock = socket.create_connection(("127.0.0.1", self._port), 1.0)
                    held.append(sock)
                    sock.setblocking(False)
                    sock.send(data)
            held = [each for each in held if _is_open(each, drip)]
            time.sleep(0.1 if drip or len(held) == most else 0.01)
        for each in held:
            each.close()


def _is_open(sock: socket.socket, drip: bytes) -> bool:
    try:
        if drip:
            sock.send(drip)
        if sock.recv(1024):
            return True
    except BlockingIOError:
        return True
    except OSError:
        pass
    sock.close()
    return False


KINDS = (
    "none",
    "packed",
    "idle",
    "half",
    "slow",
    "body",
    "requests",
    "pipeline",
    "member",
    "heads",
    "addresses",
    "logins",
    "site",
)


def main() -> None:
    """Attack."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("port", type=int)
    parser.add_argument("--seconds", type=float, default=10.0)
    options = parser.parse_args()
    os.nice(19)
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
    cookie = sys.stdin.readline().strip()
    getattr(Attack(options.port, time.monotonic() + options.seconds, cookie), options.kind)()


if __name__ == "__main__":
    main()
