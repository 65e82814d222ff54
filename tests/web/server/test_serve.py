"""The server as a process: as `ur boot install web` has a robot run it."""

from __future__ import annotations

import http.client
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from tests.ros_session import free_port

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from ur.web.access.roles import Role
from ur.web.server.link_files import admit_script, make_token


class Service:
    """The page of a robot that boots, with a home of its own."""

    def __init__(self, home: Path) -> None:
        self.port = free_port()
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG", "ROS"))}
        self.env = kept | {"HOME": str(home), "ROS_MASTER_URI": f"http://localhost:{free_port()}"}

    def start(self) -> None:
        command = [sys.executable, "-I", "-m", "ur", "web", "--service", "--port", str(self.port)]
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
