"""The nodes of a run as its events report them: their states as text, and their unmet conditions. Pure."""

from __future__ import annotations

from dataclasses import dataclass, field

from ur.run.clients.protocol import NodeChanged, NodeReadiness, RunEvent, RunStopping
from ur.run.output.messages import describe_status
from ur.run.supervisor.state import ExitStatus


@dataclass(slots=True)
class ReadinessView:
    """The nodes of a run, and the unmet conditions of each. `cause` is set when the run ends."""

    cause: str | None = None
    nodes: dict[str, NodeChanged] = field(default_factory=dict)
    _lacks: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def take(self, event: RunEvent) -> None:
        """Process one event."""
        if isinstance(event, NodeChanged) and not event.core:
            self.nodes[event.name] = event
            self._lacks.setdefault(event.name, ("it is not looked at yet",))
            if event.state != "running":
                log = f" (log: {event.log})" if event.log else ""
                self._lacks[event.name] = (f"it does not run: {describe_node(event)}{log}",)
        elif isinstance(event, NodeReadiness) and event.name in self.nodes:
            self._lacks[event.name] = event.missing
        elif isinstance(event, RunStopping):
            self.cause = event.cause

    def list_missing(self) -> dict[str, tuple[str, ...]]:
        """List the nodes that are not ready, each with its unmet conditions.

        A program that has ended successfully is no longer waited for.
        """
        return {
            name: self._lacks[name]
            for name, node in self.nodes.items()
            if self._lacks[name] and not (node.state == "ended" and node.exit_code == 0)
        }


def describe_node(node: NodeChanged) -> str:
    """Describe the state of a node briefly."""
    if node.pid is not None:
        text = f"{node.state}, process {node.pid}"
    elif node.state == "waiting" and node.restart_in is not None:
        text = f"starts again in {node.restart_in:.0f} s"
    elif node.held:
        text = "stopped by hand"
    elif node.signal is not None or node.exit_code is not None:
        text = describe_status(ExitStatus(node.exit_code, node.signal))
        text = f"{node.state}, {text}"
    else:
        text = node.state
    text += f", restarted {node.restarts} times" if node.restarts else ""
    return f"{text}: {node.reason}" if node.reason else text
