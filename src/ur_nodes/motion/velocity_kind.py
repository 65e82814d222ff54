"""The type of velocities at the other end of a topic: Twist, or TwistStamped as on many bases and programs of ROS 2."""

from collections.abc import Callable

from ur_nodes.motion.writes import AsideLog
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import StampedTwist, Twist

NAMES: dict[type, str] = {Twist: "Twist", StampedTwist: "TwistStamped"}
KINDS = tuple(NAMES)
_LOOK, _LOOK_AGAIN = 0.125, 1.0  # s: how often the graph is asked while there is no other end, and after one is found


def choose_kind(current: type | None, found: frozenset[type]) -> type | None:
    """The kind to use where these were found at the other end: the current one while it is there, or there is none.

    A topic has one kind at each end: on ROS 2 a program cannot have two.
    """
    if current in found or not found:
        return current
    return StampedTwist if StampedTwist in found else Twist


class KindWatch:
    """Polls the types at the other end of a topic, and calls `use` when the one to use changes.

    If the middleware does not report them, it is Twist.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        ask: Callable[[str, tuple[type, ...]], frozenset[type] | None],
        use: Callable[[type], None],
        text: str,
        silent: Callable[[], bool] = lambda: False,
    ) -> None:
        """`text` is logged after each change, with NAME in place of the kind's name.

        A kind that appears beside the one in use replaces that while it is `silent`, as after the death of its program.
        """
        self._node, self._topic, self._full, self._text = node, topic, node.resolve(topic), text
        self._ask, self._use = ask, use
        self._log, self._silent = AsideLog(node), silent
        self._kind: type | None = None
        self._found: frozenset[type] = frozenset()
        self._mixed = False
        if ask(topic, KINDS) is None:
            use(Twist)
            return
        self._look()

    def _look(self) -> None:
        found = self._ask(self._topic, KINDS) or frozenset()
        self._node.after(_LOOK_AGAIN if found else _LOOK, self._look, steady=True)
        new, self._found = found - self._found, found
        kind = choose_kind(self._kind, new if new and self._silent() else found)
        if kind is not None and kind is not self._kind:
            self._kind = kind
            self._use(kind)
            self._log.info(f"{self._full}: {self._text.replace('NAME', NAMES[kind])}")
        mixed = len(found) > 1
        if mixed and not self._mixed and kind is not None:
            both = " and ".join(NAMES.values())
            self._log.warn(f"{self._full}: programs use {both} here, expected one of them; this one uses {NAMES[kind]}")
        self._mixed = mixed
