"""Options of a run from the command line, besides the launch file."""

from __future__ import annotations

import socket
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from ur.run.supervisor.state import TimeLimits
from ur.source.data_classes import dataclass, field

if TYPE_CHECKING:
    from ur.run.record.registry import RunEntry


@dataclass(frozen=True, slots=True)
class RunOptions:
    """Options of the command line besides the launch file.

    `base` and `variant` are those of the selected robot. `environment` overrides that of the nodes.
    """

    limits: TimeLimits = field(default_factory=TimeLimits)
    force_screen: bool = False
    force_log: bool = False
    force_required: bool = False
    wait_for_master: bool = False
    port: int | None = None
    workers: int | None = None
    master_words: tuple[str, ...] = ()  # more options for rosmaster
    base: str = ""
    variant: str = ""
    viewer: socket.socket | None = None  # see ur.run.run.RunClients
    events: int | None = None
    # Has the robot start its nodes again; returns '' or the reason of a failure
    restart_share: Callable[[], str] | None = None
    environment: Mapping[str, str] = field(default_factory=dict)
    owners: tuple[RunEntry, ...] = ()  # see ur.run.run.Run
    call_registered: Callable[[], None] | None = None  # called when other launches can see the nodes of this run
    call_started: Callable[[RunEntry], None] | None = None  # the run is detached: called once every node was started
