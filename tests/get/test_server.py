"""Questions to a server of git: a real one, on this computer only."""

import os
import shutil
import subprocess
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from ur.get.owners import ask_server, confirm_guesses
from ur.get.steps import Missing

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
ABSENT = {"asks": 401, "tells": 404}  # owners whose missing repositories are answered for as GitHub and GitLab do


class AptServer(BaseHTTPRequestHandler):
    """`git http-backend` for the folder `root`."""

    root = Path()

    def do_GET(self) -> None:
        self.answer()

    def do_POST(self) -> None:
        self.answer()

    def answer(self) -> None:
        path, _, query = self.path.partition("?")
        owner = path.split("/")[1]
        if not (self.root / path.split(".git/")[0].lstrip("/")).with_suffix(".git").is_dir():
            self.send_response(ABSENT[owner])
            self.send_header("WWW-Authenticate", 'Basic realm="x"')
            self.end_headers()
            return
        environment = {
            **os.environ,
            "GIT_PROJECT_ROOT": str(self.root),
            "GIT_HTTP_EXPORT_ALL": "1",
            "GIT_PROTOCOL": self.headers.get("Git-Protocol", ""),
            "PATH_INFO": path,
            "QUERY_STRING": query,
            "REQUEST_METHOD": self.command,
            "CONTENT_TYPE": self.headers.get("Content-Type", ""),
            "CONTENT_LENGTH": self.headers.get("Content-Length", "0"),
        }
        body = self.rfile.read(int(environment["CONTENT_LENGTH"]))
        done = subprocess.run(["git", "http-backend"], input=body, capture_output=True, check=True, env=environment)
        head, _, content = done.stdout.partition(b"\r\n\r\n")
        self.send_response(200)
        for line in head.decode().splitlines():
            self.send_header(*line.split(": ", 1))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        """Print nothing."""


def run(command: list[str]) -> str:
    return subprocess.run(command, input="", capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture
def owners(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, str]]:
    for owner in ABSENT:
        for repository in ("robot-arm", "empty"):
            folder = str(tmp_path / owner / f"{repository}.git")
            subprocess.run(["git", "init", "-q", "--bare", "-b", "ros2", folder], check=True)
        robot = ["git", f"--git-dir={tmp_path / owner / 'robot-arm.git'}"]
        tree = run([*robot, "mktree"])
        commit = run([*robot, "-c", "user.name=x", "-c", "user.email=x@example.com", "commit-tree", "-m", "x", tree])
        for branch in ("ros2", "melodic-devel"):
            run([*robot, "update-ref", f"refs/heads/{branch}", commit])
    monkeypatch.setenv("no_proxy", "127.0.0.1")

    class Here(AptServer):
        root = tmp_path

    server = ThreadingHTTPServer(("127.0.0.1", 0), Here)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield {owner: f"http://127.0.0.1:{server.server_port}/{owner}" for owner in ABSENT}
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.parametrize("owner", list(ABSENT))
def test_server_confirms_a_repository_that_exists_and_denies_another(owner: str, owners: dict[str, str]) -> None:
    assert ask_server(f"{owners[owner]}/robot-arm.git") == ("ros2", "melodic-devel")
    assert ask_server(f"{owners[owner]}/empty.git") == ()
    assert ask_server(f"{owners[owner]}/secret.git") == ()


def test_guess_with_dashes_is_confirmed_by_the_server_with_its_branch_for_ros_1(owners: dict[str, str]) -> None:
    found = confirm_guesses([Missing("robot_arm", owners=(owners["tells"],))], ask_server)
    assert {name: each and (each.url, each.version) for name, each in found.items()} == {
        "robot_arm": (f"{owners['tells']}/robot-arm.git", "melodic-devel")
    }


def test_server_that_does_not_answer_tells_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    with ThreadingHTTPServer(("127.0.0.1", 0), AptServer) as closed:
        port = closed.server_port
    assert ask_server(f"http://127.0.0.1:{port}/me/robot.git") is None
