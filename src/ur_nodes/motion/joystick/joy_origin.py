"""Origin of `joy`: its messages have no proof of their age, so they must not come over a network."""

import time
from collections.abc import Callable
from functools import partial

from ur_nodes.ports.node import Location, Node, Sender

_AGAIN = 5.0  # s: then a publisher that could not be found is looked up again
_LATE = 150_000_000  # ns: older input moves nothing
_OTHER_CLOCK = 86_400_000_000_000  # ns: so far apart are simulated time and the computer's
_EARLY = 50_000_000  # ns: a computer has one clock, so what is sent later than now was sent by another computer
_MOST = 100  # publishers that are remembered
_REMEDY = "start this node where the joystick is, or set ~remote_joy"


class JoyOrigin:
    """Finds out which publishers run on this computer.

    Where the middleware stamps messages, this computer's `clock` (ns) shows the age of what it has sent itself. Another
    computer's clock may differ by any amount: a publisher that once was ahead is refused from then on.
    """

    def __init__(
        self,
        node: Node,
        *,
        remote: bool,
        clock: Callable[[], int] = time.time_ns,
        locate: Callable[[str], Location | None] | None = None,
    ) -> None:
        """`remote`: publishers on other computers are wanted. `locate` finds nodes; by default the node does."""
        self._locate = locate or node.locate
        self._node = node
        self._remote = remote
        self._clock = clock
        self._accepted: set[str] = set()
        self._ahead: dict[str, None] = {}
        self._asked_at: dict[str, float] = {}

    def accepts(self, sender: Sender | None, stamp: int = 0) -> bool:
        """Return whether a message may move the robot; False until the publisher's computer is known.

        `stamp` is its own, 0 for none: it shows the age where the middleware does not, as after a halt of this node.
        """
        if self._remote:
            return True
        if sender is not None and sender.sent is not None:
            return self._check(sender, sender.sent)
        ages = [age for age in (self._clock() - stamp, self._node.now() - stamp) if abs(age) < _OTHER_CLOCK]
        if stamp and ages and min(ages) > _LATE:
            self._report(sender.name if sender else "its publisher", min(ages))
            return False
        return self._find(sender.name if sender else "")

    def _check(self, sender: Sender, sent: int) -> bool:
        age = self._clock() - sent
        if age < -_EARLY:
            self._ahead[sender.id] = None
            del (known := list(self._ahead))[-_MOST:]
            for each in known:
                del self._ahead[each]
        if sender.id in self._ahead or age > _LATE:
            self._report(sender.name, age)
            return False
        return True

    def _report(self, name: str, age: int) -> None:
        text = f"joy: a message of {name} was sent {age * 1e-9:.2f} s ago by this computer's clock"
        self._node.log.error(f"{text}, expected less than {_LATE * 1e-9:g} s; {_REMEDY}", every=_AGAIN)

    def _find(self, publisher: str) -> bool:
        if publisher in self._accepted:
            return True
        now = self._node.steady()
        if now - self._asked_at.get(publisher, float("-inf")) >= _AGAIN:
            self._asked_at[publisher] = now
            self._node.work(partial(self._locate, publisher), partial(self._on_origin, publisher), "origin")
        return False

    def _on_origin(self, publisher: str, place: Location | None) -> None:
        if place is not None and place.here:
            self._accepted.add(publisher)
            return
        where = place.host if place else "an unknown computer"
        self._node.log.error(
            f"joy: {publisher} runs on {where}, expected it on this computer: what a network holds back would move the "
            f"robot late; {_REMEDY}"
        )
