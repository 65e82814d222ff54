from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

import pytest

from ur_nodes.ros1.run import shut_down_aside


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_during_registration_shuts_down_in_a_thread_of_its_own(number: signal.Signals) -> None:
    asked: list[tuple[str, str]] = []
    done = threading.Event()

    def shut_down(reason: str) -> None:
        asked.append((reason, threading.current_thread().name))
        done.set()

    before = signal.getsignal(number)
    with shut_down_aside(shut_down):
        os.kill(os.getpid(), number)
        assert done.wait(60.0)  # the main thread goes on meanwhile
    assert asked == [(f"signal-{number.value}", "shutdown")]
    assert signal.getsignal(number) is before


def test_handlers_are_put_back_after_an_error() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(ValueError, match="oops"), shut_down_aside():
        raise ValueError("oops")
    assert signal.getsignal(signal.SIGTERM) is before


def test_forked_node_has_namespace_and_remappings_of_its_own() -> None:
    script = """import os, rospy
from ur_nodes.fork_server import read_arguments
os.environ["ROS_NAMESPACE"] = "loki"
read_arguments(["module", "odom:=wheels"])
print(rospy.get_namespace(), rospy.names.get_mappings(), rospy.names.resolve_name_without_node_name("scan"))
read_arguments(["module", "__ns:=/magni"])
print(rospy.get_namespace())"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.splitlines() == ["/loki/ {'odom': 'wheels'} /loki/scan", "/magni/"]
