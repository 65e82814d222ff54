"""The contract of a parser that is fuzzed, and all of them."""

import ast
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path

CORPUS = Path(__file__).with_name("corpus")
_TARGETS = Path(__file__).with_name("targets")


@dataclass(frozen=True, slots=True)
class Target:
    """A parser of foreign input: `run` gets one input and an empty scratch folder that it may use for files.

    `run` suppresses the exceptions that the parser declares and raises any other. `words` are what the format is made
    of, `seeds` give further inputs to start from than those in the corpus.
    """

    kind: str
    run: Callable[[bytes, Path], None]
    words: tuple[bytes, ...] = ()
    seeds: Callable[[], Sequence[bytes]] = field(default=tuple)

    def read_inputs(self) -> list[bytes]:
        """The inputs of the corpus, finds included, and the seeds."""
        kept = [path.read_bytes() for path in sorted((CORPUS / self.kind).glob("*")) if path.is_file()]
        return [*kept, *self.seeds()]


def list_kinds() -> tuple[str, ...]:
    """The kinds of input, in a fixed order."""
    return tuple(_find_modules())


def load_target(kind: str) -> Target:
    """The target of a kind. Imports only what that one needs, since the memory of the process counts."""
    targets: Sequence[Target] = import_module(f"tests.fuzz.targets.{_find_modules()[kind]}").TARGETS
    return next(target for target in targets if target.kind == kind)


@cache
def _find_modules() -> dict[str, str]:
    """The module of each kind, from the texts of the modules."""
    calls = (
        (path.stem, node)
        for path in sorted(_TARGETS.glob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Target"
    )
    return {ast.literal_eval(node.args[0]): module for module, node in calls}
