"""The server as a process: as `ur boot install web` has a robot run it."""

import contextlib
import http.client
import json
import os
import pty
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from tests.ros_session import free_port

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from ur.source.diagnostic import UserError
from ur.web.access.roles import Role
from ur.web.server.links import admit_script, make_token
from ur.web.server.serve import open_port


class Service:
    """The page of a robot that boots, with a home of its own."""

    def __init__(self, home: Path) -> None:
        self.port = free_port()
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG", "ROS"))}
        self.env = kept | {"HOME": str(home), "ROS_MASTER_URI": f"http://localhost:{free_port()}"}

    def start(self, *prefix: str) -> None:
        command = [*prefix, sys.executable, "-I", "-m", "ur", "web", "--service", "--port", str(self.port)]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, env=self.env, stdout=pipe, stderr=subprocess.STDOUT, text=True)
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline()

    def stop(self) -> None:
        self.process.send_signal(signal.SIGINT)  # as the unit does
        assert self.process.wait(20) == 0

    def ask(self, method: str, path: str, body: str = "", cookie: str = "") -> tuple[int, str, str]:
        """Code, text and cookie of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        headers = {"Origin": f"http://127.0.0.1:{self.port}", "Cookie": cookie}
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text, (answer.getheader("Set-Cookie") or "").partition(";")[0]


def test_service_prints_no_link_and_admits_one_that_was_made_beside_it_also_after_a_reboot(tmp_path: Path) -> None:
    service, token, later = Service(tmp_path), make_token(), make_token()
    for each in (token, later):
        subprocess.run(["sh", "-c", admit_script(each, Role.LOOK)], env=service.env, check=True)
    service.start()
    try:
        assert "#" not in service.said
        assert f"port {service.port}" in service.said
        code, _, cookie = service.ask("POST", "/login", json.dumps({"token": token}))
        assert code == 200
        assert service.ask("POST", "/login", json.dumps({"token": token}))[0] == 403
        me = json.loads(service.ask("GET", "/api/me", cookie=cookie)[1])
        assert me == {"role": "look", "name": "a browser", "robot": os.uname().nodename.split(".")[0]}
        service.stop()
        service.start()
        assert service.ask("GET", "/api/me", cookie=cookie)[0] == 200
        assert service.ask("POST", "/login", json.dumps({"token": later}))[0] == 200
    finally:
        service.stop()
    files = [each for each in tmp_path.rglob("*") if each.is_file()]
    assert files
    assert not any(each in path.read_text() for path in files for each in (token, later))


def test_enter_in_the_terminal_prints_another_link_and_logins_are_told_there(tmp_path: Path) -> None:
    ours, its = pty.openpty()
    service, shown = Service(tmp_path), ""
    command = [sys.executable, "-I", "-m", "ur", "web", "--no-browser", "--look", "--port", str(service.port)]
    process = subprocess.Popen(command, env=service.env, stdin=its, stdout=its, stderr=its, start_new_session=True)
    os.close(its)

    def read_until(pattern: str) -> re.Match[str]:
        nonlocal shown
        while not (found := re.search(pattern, shown)):
            assert select.select([ours], [], [], 60.0)[0], shown
            shown += os.read(ours, 4096).decode()
        return found

    try:
        first = read_until(r"login#(\S+)\s")[1]
        read_until("Enter prints another one")
        os.write(ours, b"\n")
        second = read_until(r"login#\S+\s[\s\S]*login#(\S+)\s")[1]
        assert first != second
        for token in (first, second):
            assert service.ask("POST", "/login", json.dumps({"token": token}))[0] == 200
        read_until(r"\d\d:\d\d:\d\d a browser 2 logged in from \S+ and may look")
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        os.close(ours)


def test_servers_that_start_in_one_moment_get_different_ports() -> None:
    ports = range(first := free_port(), first + 3)
    with contextlib.ExitStack() as stack:
        # In use on one of the addresses of localhost only, as while another server opens them one by one.
        family, *_, address = socket.getaddrinfo("localhost", ports[0], type=socket.SOCK_STREAM)[-1]
        other = stack.enter_context(socket.socket(family))
        other.bind(address)
        other.listen()
        for port in ports[1:]:
            found, listening = open_port("localhost", ports)
            for each in listening:
                stack.enter_context(each)
            assert found == port
            assert {each.getsockname()[1] for each in listening} == {port}
        with pytest.raises(UserError, match=f"ports {ports[0]} to {ports[-1]} are in use"):
            open_port("localhost", ports)
        with pytest.raises(UserError, match=f"port {ports[0]}: address already in use"):
            open_port("localhost", ports[:1])


@pytest.mark.skipif(shutil.which("prlimit") is None, reason="prlimit is not installed")
def test_server_without_descriptors_drops_what_waits_and_logs_one_line(tmp_path: Path) -> None:
    service, token = Service(tmp_path), make_token()
    subprocess.run(["sh", "-c", admit_script(token, Role.LOOK)], env=service.env, check=True)
    service.start("prlimit", "--nofile=48")
    idle: list[socket.socket] = []
    try:
        idle += [socket.create_connection(("127.0.0.1", service.port), 60) for _ in range(200)]
        code, _, cookie = service.ask("POST", "/login", json.dumps({"token": token}))
        assert code == 200
        assert service.ask("GET", "/api/me", cookie=cookie)[0] == 200
    finally:
        for each in idle:
            each.close()
        service.stop()
    log = (tmp_path / ".local/state/ubiquity_launches/web/web.log").read_text()
    assert log.count("connections cannot be accepted: too many open files") == 1
    assert len(log) < 2000
