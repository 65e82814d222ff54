"""The topics, services and actions of a node."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Interface:
    """The topics, services and actions of a node."""

    publishes: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()
    services: tuple[str, ...] = ()  # that it offers
    calls: tuple[str, ...] = ()  # services of other nodes
    actions: tuple[str, ...] = ()  # that it offers
    uses_actions: tuple[str, ...] = ()  # of other nodes


def make_interface(
    publishes: str = "",
    subscribes: str = "",
    services: str = "",
    calls: str = "",
    actions: str = "",
    uses: str = "",
) -> Interface:
    """Make an interface of names that are separated by blanks."""
    parts = (publishes, subscribes, services, calls, actions, uses)
    return Interface(*(tuple(part.split()) for part in parts))
