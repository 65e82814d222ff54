"""Facts, parameters and log of a node on a `Bus`."""

from collections.abc import Callable
from typing import cast

from ur_nodes.memory.carrier import Carrier


class MemoryFacts:
    """See `ports.facts.Facts`: the bus's."""

    simulated_time = True

    def __init__(self, bus: Carrier) -> None:
        self._facts = bus.facts

    def get(self, name: str, default: object = None) -> object:
        return self._facts.get(name, default)

    def set(self, name: str, value: object) -> None:
        self._facts[name] = value


class MemoryParameters:
    """See `ports.parameters.ParameterStore`: those of the bus, by full names, as on a parameter server."""

    def __init__(self, resolve: Callable[[str], str], parameters: dict[str, object]) -> None:
        self._resolve, self._parameters = resolve, parameters

    def resolve(self, name: str) -> str:
        return self._resolve(name)

    def has(self, name: str) -> bool:
        full = self.resolve(name).rstrip("/")
        return full in self._parameters or any(each.startswith(full + "/") for each in self._parameters)

    def get(self, name: str) -> object:
        full = self.resolve(name).rstrip("/")
        if full in self._parameters:
            return self._parameters[full]
        below = {
            name[len(full) + 1 :]: value for name, value in self._parameters.items() if name.startswith(full + "/")
        }
        if not below:
            raise KeyError(full)
        tree: dict[str, object] = {}
        for path, value in below.items():
            *folders, last = path.split("/")
            place = tree
            for folder in folders:
                place = cast("dict[str, object]", place.setdefault(folder, {}))
            place[last] = value
        return tree

    def set(self, name: str, value: object) -> None:
        self._parameters[self.resolve(name).rstrip("/")] = value


class MemoryLog:
    """See `ports.log.Log`. Writes to `lines`: pairs of a level and a text."""

    def __init__(self, lines: list[tuple[str, str]], now: Callable[[], int]) -> None:
        self._lines, self._now = lines, now
        self._last: dict[str, int] = {}

    def debug(self, text: str) -> None:
        self._lines.append(("debug", text))

    def info(self, text: str) -> None:
        self._lines.append(("info", text))

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """See Log. With `every`, equal texts count as of one place."""
        self._write("warn", text, every)

    def error(self, text: str, *, every: float = 0.0) -> None:
        """As `warn`."""
        self._write("error", text, every)

    def _write(self, level: str, text: str, every: float) -> None:
        now = self._now()
        if every and now - self._last.get(text, -(10**18)) < every * 1e9:
            return
        self._last[text] = now
        self._lines.append((level, text))
