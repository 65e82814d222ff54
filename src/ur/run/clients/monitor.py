"""Clients of a run, served by its loop. Their modules are imported when the first one connects."""

from __future__ import annotations

import select
from typing import TYPE_CHECKING

from ur.run.supervisor.events import Event, KillNode, RestartNode, StartNode, StopNode, StopRequested
from ur.run.supervisor.state import State

if TYPE_CHECKING:
    from ur.run.clients.protocol import OutputSource, RunCommand, Severity
    from ur.run.clients.publisher import RunPublisher
    from ur.run.output.console import Console
    from ur.run.output.router import NodeOutputs
    from ur.run.process.terminal import Terminal
    from ur.run.run import Run, RunClients


class Monitor:
    """Subscribers over the run's socket, the interface on the run's terminal, and a file that gets every event."""

    def __init__(self, plan: RunClients, poll: select.poll, console: Console, terminal: Terminal | None) -> None:
        self._plan = plan
        self._poll = poll
        self._console = console
        self._terminal = terminal
        self._publisher: RunPublisher | None = None  # imported late: most runs have no subscriber
        self._viewer: int | None = None
        self._polled: dict[int, int] = {}
        if plan.listener is not None:
            self._polled = {plan.listener.fileno(): select.POLLIN}
            poll.register(plan.listener, select.POLLIN)

    def open(self, run: Run, state: State, outputs: NodeOutputs, now: float) -> None:
        """Add the clients that are connected from the start."""
        self._run, self._state, self._outputs = run, state, outputs
        if self._plan.events is None and self._plan.viewer is None:
            return
        from ur.run.clients.protocol import Watch

        publisher = self._begin(now)
        self._console.silent = True
        if self._plan.events is not None:
            publisher.subscribers.add_output(self._plan.events, Watch(output=True, stats=False, readiness=True))
        if self._plan.viewer is not None:
            self._viewer = publisher.subscribers.add_socket(self._plan.viewer)
            if self._terminal is not None:
                self._terminal.mark_lent()  # the viewer is the foreground group, for Ctrl-C in its pager
        publisher.update_subscriptions(now)

    @property
    def wants_readiness(self) -> bool:
        """True while a subscriber asks for the readiness of nodes."""
        return self._publisher is not None and self._publisher.wants_readiness

    @property
    def due(self) -> float | None:
        """Return the time at which `work` is due next; None: only on events."""
        return None if self._publisher is None else self._publisher.due

    def serves(self, descriptor: int) -> bool:
        """Test for a descriptor of a subscriber, or of the socket on which new subscribers connect."""
        return descriptor in self._polled

    def note_state(self, state: State, now: float) -> None:
        """Publish the changes of the run's state."""
        self._state = state
        if self._publisher is not None:
            self._publisher.note_state(state, now)

    def note_readiness(self, name: str, missing: tuple[str, ...]) -> None:
        """Publish a node's unmet readiness conditions."""
        if self._publisher is not None:
            self._publisher.note_readiness(name, missing)

    def publish_output(self, name: str, source: OutputSource, text: str) -> None:
        """Publish a line that a node printed."""
        if self._publisher is not None:
            self._publisher.publish_output(name, source, text)

    def publish_notice(self, severity: Severity, text: str) -> None:
        """Publish a message of the run itself."""
        if self._publisher is not None:
            self._publisher.publish_notice(severity, text)

    def publish_link(self, robot: str, seconds: float, *, lost: bool) -> None:
        """Publish the state of the link to the robot."""
        if self._publisher is not None:
            self._publisher.publish_link(robot, seconds, lost=lost)

    def attend(self, descriptor: int, now: float) -> list[Event]:
        """Serve the client that is ready; return the events for the supervisor."""
        publisher = self._publisher or self._begin(now)
        wanted = [translate_command(command) for command in publisher.attend(descriptor, now)]
        if self._viewer is not None and not publisher.subscribers.holds(self._viewer):
            self._viewer = None
            self._console.silent = False
            if self._terminal is not None:
                self._terminal.reclaim(reset=True)
        return wanted

    def work(self, now: float) -> None:
        """Sample statistics and read logs back if they are due."""
        if self._publisher is not None:
            self._publisher.work(now)

    def flush(self) -> None:
        """Write pending data without blocking, and update the poll events of subscribers."""
        if self._publisher is None:
            return
        self._publisher.subscribers.flush()
        wanted = self._publisher.subscribers.descriptors()
        if wanted == self._polled:
            return
        for descriptor in self._polled.keys() - wanted.keys():
            self._poll.unregister(descriptor)
        for descriptor, events in wanted.items():
            self._poll.register(descriptor, events)
        self._polled = wanted

    def close(self, exit_code: int) -> None:
        """Publish the end, and disconnect all subscribers."""
        if self._publisher is not None:
            self._publisher.end(exit_code)
        elif self._plan.listener is not None:
            self._plan.listener.close()

    def _begin(self, now: float) -> RunPublisher:
        from ur.run.clients.protocol import RunStarted
        from ur.run.clients.publisher import NodeConstants, RunPublisher

        describe = self._plan.describe
        started = RunStarted("", 0, "", "", "", 0.0) if describe is None else describe()
        outputs = self._outputs
        self._publisher = RunPublisher(
            started,
            self._plan.listener,
            {
                each.unit.name: NodeConstants(outputs.find_path(each), each.executable or each.argv[0])
                for each in self._run.programs
            },
            lambda anew: outputs.skip_back() if anew else outputs.read_back(),
            self._state,
            now,
        )
        self._publisher.subscribers.on_removed = self._forget
        return self._publisher

    def _forget(self, descriptor: int) -> None:
        if self._polled.pop(descriptor, None) is not None:
            self._poll.unregister(descriptor)


def translate_command(command: RunCommand) -> Event:
    """Translate a client's command into an event of the supervisor."""
    from ur.run.clients.protocol import StopRun

    match command:
        case StartNode() | StopNode() | RestartNode() | KillNode():
            return command
        case StopRun(reason):
            return StopRequested(reason)
    raise ValueError(command)  # Watch, which Subscribers handle themselves
