"""Values as JSON in std_msgs/String, where a middleware has no messages for them."""

from collections.abc import Callable
from typing import TypeVar

from std_msgs.msg import String

from ur.source.foreign.json_values import BadJsonError, read_json, write_json
from ur_nodes.codecs.codec import Codec

Text = TypeVar("Text")
Value = TypeVar("Value")


def text_codec(name: str, kind: type[Value], longest: int = 100_000) -> Codec[String, Value]:
    """The codec of values called `name`, whose type JSON can be; a message has at most `longest` characters."""
    return converted_codec(name, kind, lambda value: value, lambda value: value, longest)


def converted_codec(
    name: str, kind: type[Text], write: Callable[[Value], Text], read: Callable[[Text], Value], longest: int = 100_000
) -> Codec[String, Value]:
    """As text_codec, for values that are converted to `kind` and back. `read` may raise ValueError."""

    def fill(message: String, value: Value) -> None:
        message.data = write_json(write(value))

    def value_of(message: String) -> Value:
        try:
            return read(read_json(message.data, kind, longest))
        except BadJsonError as problem:
            raise ValueError(f"{name} that cannot be read: {problem}") from None

    return Codec(String, fill, value_of)
