"""The tests' ROS clients answer a JSON request a line with a JSON answer a line: the half that runs in the client.

rospy can be started only once in a process, so a client is a process of its own; `tests/ros_session.py` is the other
half. A client is started with the root of this repository on its path.
"""

import json
import os
import sys
import time
from collections.abc import Callable
from typing import TextIO


def wait_until(condition: Callable[[], object], seconds: float, what: str, pause: float = 0.02) -> None:
    """Poll until a condition holds. Raises TimeoutError, which names what was waited for."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(f"waited {seconds:g} s for {what}")
        time.sleep(pause)


def claim_output() -> TextIO:
    """Standard output for answers alone: what prints from now on, as rospy does, goes to standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return answers


def answer_requests(answers: TextIO, client: object, prefix: str = "") -> None:
    """Answer each line of standard input until it ends.

    `{"do": name, ...}` calls the client's method `prefix` + name with the rest as keywords. The answer is
    `{"answer": what it returned}`, or `{"error": "Type: text"}` of what it raised.
    """
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = {"answer": getattr(client, prefix + request.pop("do"))(**request)}
        except Exception as problem:  # the test that asked is told, whatever it was
            answer = {"error": f"{type(problem).__name__}: {problem}"}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
