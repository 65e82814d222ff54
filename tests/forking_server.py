"""Run programs in forks of this interpreter, which has imported modules already: forking_server.py MODULE ...

Each line on standard input is a request as JSON: `program`, a file or the name of a module; `arguments`, `environment`,
`folder`, and `streams`, the files to be standard input, output and errors. The answer is a line with its exit code,
negative for a signal. For /usr/bin/python3 as well, so without any package.
"""

from __future__ import annotations

import importlib
import json
import os
import runpy
import sys
from typing import Any


def become(request: dict[str, Any]) -> None:
    """Make this process the one that a request describes, up to its program."""
    for number, (path, mode) in enumerate(
        zip(request["streams"], (os.O_RDONLY, os.O_WRONLY, os.O_WRONLY), strict=True)
    ):
        file = os.open(path, mode)
        os.dup2(file, number)
        os.close(file)
    os.environ.clear()
    os.environ.update(request["environment"])
    os.chdir(request["folder"])
    sys.argv[:] = [request["program"], *request["arguments"]]  # a default argument may be this list


def serve(requests: int, answers: int) -> dict[str, Any]:
    """Answer requests; return one of them where it is to be run, in a fork."""
    with os.fdopen(requests) as lines:
        for line in lines:
            request: dict[str, Any] = json.loads(line)
            child = os.fork()
            if child == 0:
                os.close(answers)
                return request
            _, status = os.waitpid(child, 0)
            os.write(answers, b"%d\n" % os.waitstatus_to_exitcode(status))
    sys.exit()


if __name__ == "__main__":
    for name in sys.argv[1:]:
        importlib.import_module(name)
    if not sys.flags.isolated:
        sys.path.pop(0)  # the folder of this file
    wanted = serve(os.dup(0), os.dup(1))
    become(wanted)
    run = runpy.run_path if "/" in wanted["program"] else runpy.run_module
    run(wanted["program"], run_name="__main__")
