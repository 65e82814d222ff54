"""Types that requests of pages share: numbers, names and poses from a browser, with their limits."""

from typing import Annotated, Any

from msgspec import Meta

from ur.source.foreign.json_values import BadJsonError, PrintableValue, convert_json, read_json

BadRequestError = BadJsonError
"""A message that is no request; its text says why, in a line."""

LONGEST_NAME = 64
"""Characters of the longest name of a place."""

FARTHEST = 1e5
"""m: the largest coordinate."""

Name = Annotated[
    str, Meta(min_length=1, max_length=LONGEST_NAME, description=f"a name of at most {LONGEST_NAME} characters")
]
Coordinate = Annotated[float, Meta(ge=-FARTHEST, le=FARTHEST)]
Heading = Annotated[float, Meta(ge=-7.0, le=7.0)]


class PageRequest(PrintableValue, frozen=True, forbid_unknown_fields=False, tag_field="t", tag=""):
    """A request of a driving page. Unknown fields are ignored, so that a newer page can always stop the robot."""


_HEAD: tuple[str, ...] = ("n", "id")


def read_numbered(text: object, kind: object, longest: int) -> tuple[Any, dict[str, object]]:
    """Decode a request of a type, and its fields `n` and `id` as given. Raises BadRequestError."""
    value = read_json(text, dict[str, object], longest)
    head = {name: value.pop(name) for name in _HEAD if name in value}
    return convert_json(value, kind), head
