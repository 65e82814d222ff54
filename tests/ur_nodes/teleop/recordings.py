"""A robot without a black box, and one whose black box answers."""

from ur_nodes.client.saving import Saving, save_recordings
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result

PLACE = "bob:/home/ubuntu/black_box.mcap"
SAVED = f"what happened is saved: {PLACE}"


def no_recordings() -> Saving:
    """Ask a robot without a black box."""
    return save_recordings(Bus().node("client"))


def serve_recordings(bus: Bus) -> None:
    """Start a black box that names a file at once."""
    bus.node("black_box").serve("~write", Trigger, lambda _: Result(True, PLACE))
