"""The topics of a simulated base, held against the contract of all bases."""

from collections.abc import Iterable

from tests.base_contract import list_topics

from ur.robot.base import Base


def find_breaches(base: Base, published: Iterable[tuple[str, str]]) -> list[str]:
    """The topics of the contract, with types, that are not among the `published` pairs of topic and type."""
    known = {topic: kind.replace("/msg/", "/") for topic, kind in published}
    return [f"{topic} ({kind})" for topic, kind in list_topics(base).items() if known.get(topic) != kind]
