"""Types of messages by the definitions in recordings, with rosbags: decoding, and ROS 1 as ROS 2 and back.

`rosbags` and others open MCAP files of ROS 2 only, so what is given away has ROS 2's types and encoding (CDR).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ur.recordings.mcap_channels import ENCODINGS, Dialect
from ur.recordings.mcap_file import RecordingTopic

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_TIMES = ("std_msgs/msg/Header", "builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")


def full_type_name(type_name: str) -> str:
    """Return the name of a type as ROS 2 has it."""
    package, _, name = type_name.rpartition("/")
    return type_name if package.endswith("/msg") else f"{package}/msg/{name}"


class MessageTypes:
    """The types of topics, each read once. A topic whose definition cannot be read is not converted."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        known = get_typestore(Stores.ROS2_FOXY)
        self._times = {name: known.fielddefs[name] for name in _TIMES}
        self._stores: list[Typestore] = []
        self._found: dict[tuple[str, str], Typestore | None] = {}
        self._definitions: dict[tuple[str, str, Dialect], str] = {}

    def decode(self, topic: RecordingTopic, data: bytes) -> Any:
        """Decode a message. Raises ValueError: it cannot be decoded."""
        store = self._find(topic)
        if store is None:
            raise ValueError(f"{topic.name}: the definition of {topic.type_name} cannot be read")
        full = full_type_name(topic.type_name)
        try:
            return store.deserialize_cdr(data if topic.encoding == "cdr" else store.ros1_to_cdr(data, full), full)
        except Exception as problem:  # of the library, for bytes of any program
            raise ValueError(f"{topic.name}: {problem}") from None

    def convert_topic(self, topic: RecordingTopic, dialect: Dialect) -> RecordingTopic:
        """Return a topic as that ROS has it; the same one where it is of that ROS, or of none."""
        encoding = ENCODINGS[dialect][1]
        if topic.encoding == encoding or topic.encoding not in ("ros1", "cdr"):
            return topic
        store = self._find(topic)
        if store is None:
            return topic
        full = full_type_name(topic.type_name)
        key = (topic.type_name, topic.schema, dialect)
        if key not in self._definitions:
            version = 2 if dialect == "ros2" else 1
            self._definitions[key] = store.generate_msgdef(full, ros_version=version)[0]
        name = full if dialect == "ros2" else full.replace("/msg/", "/")
        return replace(topic, type_name=name, schema=self._definitions[key], encoding=encoding)

    def convert(self, topic: RecordingTopic, target: RecordingTopic, data: bytes) -> bytes:
        """Convert a message of a topic to the encoding of `target`. Raises ValueError: it cannot be converted."""
        if topic.encoding == target.encoding:
            return data
        store = self._find(topic)
        assert store is not None
        change = store.ros1_to_cdr if target.encoding == "cdr" else store.cdr_to_ros1
        try:
            return bytes(change(data, full_type_name(topic.type_name)))
        except Exception as problem:  # of the library, for bytes of any program
            raise ValueError(f"{topic.name}: {problem}") from None

    def _find(self, topic: RecordingTopic) -> Typestore | None:
        key = (topic.type_name, topic.schema)
        if key not in self._found:
            self._found[key] = self._read(*key)
        return self._found[key]

    def _read(self, type_name: str, schema: str) -> Typestore | None:
        """Read a definition into the first store that has none of another kind under its names."""
        from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore

        try:
            types = get_types_from_msg(schema, full_type_name(type_name))
        except Exception:  # of the library, for texts of any program
            return None
        types |= self._times
        for store in (*self._stores, get_typestore(Stores.EMPTY)):
            try:
                store.register(types)
            except TypesysError:
                continue
            except Exception:  # likewise
                return None
            if store not in self._stores:
                self._stores.append(store)
            try:
                store.generate_msgdef(full_type_name(type_name), ros_version=2)
            except TypesysError:  # it lacks the definition of a part
                return None
            return store
        return None
