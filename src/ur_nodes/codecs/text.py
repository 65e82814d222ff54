"""Values as JSON in std_msgs/String, where a middleware has no messages for them."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TypeVar

from std_msgs.msg import String

from ur_nodes.codecs.codec import Codec

Read = TypeVar("Read")
Value = TypeVar("Value")


def text_codec(
    name: str, write: Callable[[Value], object], read: Callable[[Read], Value], longest: int = 100_000
) -> Codec[String, Value]:
    """The codec of values called `name`, from and to what JSON has; a message has at most `longest` characters.

    `read` gets what a stranger may have sent. It raises ValueError, KeyError, TypeError or AttributeError.
    """

    def fill(message: String, value: Value) -> None:
        message.data = json.dumps(write(value), allow_nan=False)

    def value_of(message: String) -> Value:
        if len(message.data) > longest:
            raise ValueError(f"{name} of {len(message.data)} characters, expected at most {longest}")
        try:
            return read(json.loads(message.data))
        except (KeyError, TypeError, AttributeError, RecursionError) as problem:
            raise ValueError(f"{name} that cannot be read: {problem!r}") from None

    return Codec(String, fill, value_of)
