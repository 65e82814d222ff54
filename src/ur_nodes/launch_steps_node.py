"""The program that calls services for a launch file, one after the other: launch_steps_node FILE.

The file is a list in JSON. Each entry has `service`, `fields` of its request, and `about`: what it does. With `until`
the call is repeated until the answer has this state ('' : any other than at first). A service that no node offers yet
is waited for.
"""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from ur.source.foreign.files import read_text
from ur.source.foreign.json_values import read_json
from ur_nodes.ports.node import Node
from ur_nodes.ports.raw import ServiceAnswer, ServiceCaller
from ur_nodes.ports.values import Result
from ur_nodes.run import run

_AGAIN = 0.05  # s between two calls
_MISSING = "no node offers it now"
_MOST = 16 << 20  # characters of a file: the description of a robot is a parameter


@dataclass(frozen=True, slots=True)
class Step:
    """An entry of the file."""

    service: str
    fields: dict[str, object]
    about: str = ""
    until: str | None = None


class LaunchSteps:
    """Makes the calls, and ends the node behind the last one, or the first that fails."""

    def __init__(self, node: Node, steps: list[Step]) -> None:
        self._node, self._steps = node, steps
        self._first: object = None
        node.post(self._call)

    def _call(self) -> None:
        if not self._steps:
            self._node.end("all is done")
            return
        step = self._steps[0]
        cast(ServiceCaller, self._node.raw).call(step.service, step.fields, self._on_result)

    def _on_result(self, result: Result) -> None:
        step = self._steps[0]
        answer = result.value.fields if isinstance(result.value, ServiceAnswer) else {}
        if not result.success and _MISSING in result.text:
            self._node.after(_AGAIN, self._call, steady=True)
        elif not result.success:
            self._node.end(f"{step.about}: {result.text}", failed=True)
        elif step.until is not None:
            found = answer.get("current_state")
            state = found.get("label") if isinstance(found, Mapping) else None
            self._first = self._first or state
            if state == step.until or (not step.until and state != self._first):
                self._steps.pop(0)
                self._call()
            else:
                self._node.after(_AGAIN, self._call, steady=True)
        elif answer.get("success") is False:
            reason = answer.get("error_message") or "it is refused"
            self._node.end(f"{step.about} by {step.service}: {reason}", failed=True)
        else:
            self._node.log.info(f"{step.about}: done")
            self._first = None
            self._steps.pop(0)
            self._call()


if __name__ == "__main__":
    found = read_json(read_text(sys.argv[1], _MOST), list[Step], _MOST)
    sys.exit(run("launch_steps", lambda node: LaunchSteps(node, found)))
