"""A mapping in YAML has the same key twice."""

from __future__ import annotations

from collections.abc import Iterable

import yaml

from ur.check.model import Example, Found, Group, Rule, YamlView
from ur.check.yaml_nodes import compose_documents, is_plain_yaml, mappings_in, span_at
from ur.source.diagnostic import Note, Severity


def _find_duplicate_keys(view: YamlView) -> Iterable[Found]:
    if not is_plain_yaml(view.source):
        return
    try:
        documents = compose_documents(view.source)
    except yaml.YAMLError:
        return  # bad-yaml speaks of it
    for mapping in (mapping for document in documents for mapping in mappings_in(document)):
        first: dict[str, yaml.Node] = {}
        for key, _ in mapping.value:
            if not isinstance(key, yaml.ScalarNode) or key.value == "<<":
                continue
            name = str(key.value)
            if name in first:
                place = span_at(view.source, first[name].start_mark, first[name].end_mark)
                yield Found(
                    span_at(view.source, key.start_mark, key.end_mark),
                    f"key '{name}' is given twice, expected once: only the last value counts",
                    "remove one of the two",
                    (Note(f"the first '{name}' is here", place),),
                )
            first.setdefault(name, key)


RULE = Rule(
    id="duplicate-key",
    group=Group.YAML,
    severity=Severity.WARNING,
    summary="A mapping in YAML has the same key twice.",
    explanation="""
YAML readers take the last value and say nothing, so whoever changes the first one wonders why nothing happens.
""",
    bad=(Example({"params/magni.yaml": "speed: 0.3\nradius: 0.1\n«speed»: 0.5\n"}),),
    good=(Example({"params/magni.yaml": "left: {speed: 0.3}\nright: {speed: 0.5}\n"}),),
    yaml_file=_find_duplicate_keys,
)
