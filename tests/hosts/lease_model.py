"""A model of the states that the lease may have after each step of a sequence, apart from the code under test."""

from collections.abc import Mapping
from dataclasses import dataclass, field

Holder = tuple[str, str]  # state, client id
FREE: Holder = ("free", "")


@dataclass(slots=True)
class LeaseHolder:
    """A client that was started; `identity` is its client id."""

    name: str
    identity: str
    conduct: str
    halted: bool = False


@dataclass(slots=True)
class Model:
    """The clients that live, by name, those who ask in order, and who holds the lease (or lost it).

    `names` are the names of all clients that ever were, by id.
    """

    holder: Holder = FREE
    names: Mapping[str, str] = field(default_factory=dict)
    clients: dict[str, LeaseHolder] = field(default_factory=dict)
    asking: list[str] = field(default_factory=list)

    def owns(self, name: str) -> bool:
        """Return whether a client holds the lease, or is the one that lost it."""
        return name in self.clients and self.holder[1] == self.clients[name].identity

    def start(self, client: LeaseHolder) -> set[Holder]:
        """A client starts, with a conduct; all that may be held then."""
        self.clients[client.name] = client
        own: Holder = ("held", client.identity)
        if client.conduct == "take" or (client.conduct in ("drive", "ask") and self._is_available(client.name)):
            return {own}
        if client.conduct == "ask":
            self.asking.append(client.name)
        return {self.holder}

    def take(self, name: str) -> set[Holder]:
        """A client takes over."""
        self._forget(name)
        return {("held", self.clients[name].identity)}

    def ask(self, name: str) -> set[Holder]:
        """A client asks for the lease."""
        if self._is_available(name):
            return {("held", self.clients[name].identity)}
        if not self.owns(name) and name not in self.asking:
            self.asking.append(name)
        return {self.holder}

    def grant(self, name: str) -> set[Holder]:
        """The holder hands over to the first who asks."""
        return self._give() if self.owns(name) and self.asking else {self.holder}

    def end(self, name: str) -> set[Holder]:
        """A client ends properly: the first who asks gets the lease, else whoever drives next."""
        owned = self.owns(name)
        self._forget(name)
        del self.clients[name]
        return self._give() if owned else {self.holder}

    def fall_silent(self, name: str, *, dies: bool) -> set[Holder]:
        """A client is killed or halted; what is held once that has been noticed."""
        owned = self.owns(name)
        self._forget(name)
        if dies:
            del self.clients[name]
        else:
            self.clients[name].halted = True
        return {("lost", self.holder[1])} if owned else {self.holder}

    def resume(self, name: str) -> set[Holder]:
        """A halted client goes on; it has the lease again unless another took it."""
        client = self.clients[name]
        client.halted = False
        if self.holder == FREE and client.conduct != "watch":  # its key is held
            return {("held", client.identity)}
        if self.owns(name):
            return {("held", self.holder[1])}
        return {self.holder}

    def _is_available(self, name: str) -> bool:
        """Return whether a client may acquire the lease: it is free, or an earlier client of its name has lost it."""
        return self.holder[0] == "free" or (self.holder[0] == "lost" and self.names.get(self.holder[1]) == name)

    def _give(self) -> set[Holder]:
        if self.asking:
            return {("held", self.clients[self.asking.pop(0)].identity)}
        keen = [each for each in self._active() if each.conduct != "watch"]  # all hold their keys
        return {("held", each.identity) for each in keen} or {FREE}

    def _active(self) -> list[LeaseHolder]:
        return [each for each in self.clients.values() if not each.halted]

    def _forget(self, name: str) -> None:
        if name in self.asking:
            self.asking.remove(name)
