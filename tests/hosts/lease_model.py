"""A model of the states that the lease may have after each step of a sequence, apart from the code under test."""

from __future__ import annotations

from dataclasses import dataclass, field

Holder = tuple[str, str]  # state, client id
FREE: Holder = ("free", "")
RECENT = 8.0  # s: so long after its start a client may still try to acquire the lease


@dataclass(slots=True)
class Client:
    """A client that was started; `identity` is its client id."""

    name: str
    identity: str
    conduct: str
    started: float
    halted: bool = False


@dataclass(slots=True)
class Model:
    """The clients that live, by name, those who ask in order, and who holds the lease (or lost it)."""

    holder: Holder = FREE
    clients: dict[str, Client] = field(default_factory=dict)
    asking: list[str] = field(default_factory=list)

    def owns(self, name: str) -> bool:
        """Return whether a client holds the lease, or is the one that lost it."""
        return name in self.clients and self.holder[1] == self.clients[name].identity

    def start(self, client: Client) -> set[Holder]:
        """A client starts, with a conduct; all that may be held then."""
        self.clients[client.name] = client
        own: Holder = ("held", client.identity)
        held = self.holder[0] == "held"
        if client.conduct == "take" or (client.conduct in ("drive", "ask") and not held):
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
        if self.holder[0] != "held":
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

    def fall_silent(self, name: str, now: float, *, dies: bool) -> set[Holder]:
        """A client is killed or halted; what is held once that has been noticed."""
        owned = self.owns(name)
        self._forget(name)
        if dies:
            del self.clients[name]
        else:
            self.clients[name].halted = True
        if not owned:
            return {self.holder}
        return {("lost", self.holder[1]), *self._list_keen(now)}

    def resume(self, name: str, now: float) -> set[Holder]:
        """A halted client goes on; it has the lease again unless another acquired it."""
        client = self.clients[name]
        client.halted = False
        if self.holder == FREE and client.conduct != "watch":  # its key is held
            return {("held", client.identity)}
        if self.owns(name):
            return {("held", self.holder[1])}
        return {self.holder, *self._list_keen(now)} if self.holder[0] == "lost" else {self.holder}

    def _list_keen(self, now: float) -> set[Holder]:
        """The clients that acquire what they find lost, each as a holder."""
        keen = [each for each in self._active() if each.conduct == "drive" and now - each.started < RECENT]
        return {("held", each.identity) for each in keen}

    def _give(self) -> set[Holder]:
        if self.asking:
            return {("held", self.clients[self.asking.pop(0)].identity)}
        keen = [each for each in self._active() if each.conduct != "watch"]  # all hold their keys
        return {("held", each.identity) for each in keen} or {FREE}

    def _active(self) -> list[Client]:
        return [each for each in self.clients.values() if not each.halted]

    def _forget(self, name: str) -> None:
        if name in self.asking:
            self.asking.remove(name)
