"""A real node in which a thread fails: it ends, so that it can be started again."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import RosSession

pytestmark = [pytest.mark.ros, pytest.mark.timeout(300)]

NODE = """
import sys, threading
from ur_nodes.ros1.run import run_node

def start():
    threading.Thread(target=TARGET, name="view", daemon=True).start()

sys.exit(run_node("failing", start, own_terminal=True))
"""


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosSession]:
    session = RosSession(tmp_path_factory.mktemp("failing"))
    try:
        yield session
    finally:
        session.close()


def run(session: RosSession, target: str) -> tuple[int, str]:
    node = session.start(sys.executable, "-c", NODE.replace("TARGET", target))
    _, errors = node.communicate(timeout=120)
    session.running.remove(node)
    return node.returncode, errors


def test_node_ends_with_one_line_when_a_thread_of_ours_fails(session: RosSession) -> None:
    code, errors = run(session, "lambda: 1 // 0")
    assert code == 1
    assert errors.count("\n") == 1
    assert "thread 'view' failed and ends the node: ZeroDivisionError" in errors
    logs = [each.read_text() for each in Path(session.env["ROS_LOG_DIR"]).rglob("failing*.log")]
    assert any("Traceback" in text and "1 // 0" not in text.partition("Traceback")[0] for text in logs)


def test_node_outlives_threads_of_libraries_that_fail(session: RosSession) -> None:
    node = session.start(sys.executable, "-c", NODE.replace("TARGET", "int, args=('x',)"))
    assert node.stderr is not None
    lines = iter(node.stderr.readline, "")
    assert any("ValueError" in line for line in lines)
    assert node.poll() is None
    session.stop(node)
    assert node.returncode == 0
