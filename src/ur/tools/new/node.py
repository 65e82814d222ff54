"""A launch directory for one node: n_<name>."""

import re
from collections.abc import Iterator, Mapping

from ur.launchfile.plan.names import is_legal_name
from ur.tools.new.group import LOCALHOST, MACHINE, attribute, write_launch
from ur.tools.new.parts import NewArgument, NewFile, NodeRequest, NodeTopic

_ORDINARY = re.compile(r"\W+")


def plan_node(request: NodeRequest, package: str) -> tuple[NewFile, ...]:
    """Plan the launch file, and the parameter files that it loads."""
    folder = f"n_{request.name}"
    files = [NewFile(f"{folder}/launch/{folder}.launch.xml", _launch(request, package))]
    if request.observed.parameters:
        files.append(NewFile(f"{folder}/params/{request.name}.yaml", _parameters(request)))
    return tuple(files)


def _launch(request: NodeRequest, package: str) -> str:
    own = f"{request.name}_pkg"
    topics = list(_arguments_of(request.observed.topics))
    arguments = [
        MACHINE,
        NewArgument("node_name", "The name of the node.", default=request.name),
        NewArgument(own, f"The package that holds the executable `{request.type}`.", default=request.package),
        *(argument for _, argument in topics),
    ]
    attributes = " ".join(
        (
            attribute("machine", "$(arg machine)"),
            attribute("name", "$(arg node_name)"),
            attribute("pkg", f"$(arg {own})"),
            attribute("type", request.type),
        )
    )
    inside = [*_inside(request, package), *(_remap(topic, argument) for topic, argument in topics)]
    node = (
        [f"<node {attributes}>", *(f"  {line}" for line in inside), "</node>"] if inside else [f"<node {attributes}/>"]
    )
    parts = [f"It runs `{request.type}` of the package `{request.package}`."]
    if request.observed.services:
        parts.append(f"It offers {', '.join(f'`{name}`' for name in request.observed.services)}.")
    return write_launch(request.summary, " ".join(parts), arguments, (*LOCALHOST, *node))


def _inside(request: NodeRequest, package: str) -> Iterator[str]:
    if request.observed.parameters:
        yield f'<rosparam command="load" file="$(find {package})/n_{request.name}/params/{request.name}.yaml"/>'
    for use, published in (("publishes", True), ("subscribes", False)):
        if names := [
            topic.name
            for topic in request.observed.topics
            if topic.published is published and is_legal_name(topic.name)
        ]:
            yield f"<!--{use}: {' '.join(names)}-->"


def _arguments_of(topics: tuple[NodeTopic, ...]) -> Iterator[tuple[NodeTopic, NewArgument]]:
    taken = {"machine", "node_name", "robot_base"}
    for topic in topics:
        name = _ORDINARY.sub("_", topic.name).strip("_") or "topic"
        while name in taken:
            name += "_topic"
        taken.add(name)
        verb = "publishes" if topic.published else "subscribes"
        kind = f" (`{topic.message}`)" if topic.message else ""
        yield topic, NewArgument(name, f"The topic that it {verb} as `{topic.name}`{kind}.", default=topic.name)


def _remap(topic: NodeTopic, argument: NewArgument) -> str:
    return f'<remap {attribute("from", topic.name)} to="$(arg {argument.name})"/>'


def _parameters(request: NodeRequest) -> str:
    from yaml import safe_dump

    known: dict[str, object] = {}
    unknown = []
    for name, value in sorted(request.observed.parameters.items()):
        if value is None:
            unknown.append(name)
        else:
            _put(known, name.split("/"), value)
    text = f"# Parameters of {request.package}/{request.type}.\n"
    if known:
        text += safe_dump(known, default_flow_style=False, sort_keys=True)
    if unknown:
        text += "# The node also reads these parameters; to set one, add a line such as 'NAME: VALUE':\n" + "".join(
            f"#   {name}\n" for name in unknown
        )
    return text


def _put(tree: dict[str, object], path: list[str], value: object) -> None:
    for step in path[:-1]:
        inner = tree.setdefault(step, {})
        if not isinstance(inner, dict):
            return
        tree = inner
    tree[path[-1]] = dict(value) if isinstance(value, Mapping) else value
