"""The parts of a launch file's page: arguments, nodes, parameters, names, includes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from html import escape

from ur.docs.documents import ArgumentDoc, IncludeDoc, LaunchDoc, NodeDoc, ParamDoc, ParamFileDoc
from ur.docs.site.html import cases_attribute, code, inline, link, show_values, table
from ur.docs.vary import name_cases

_SOURCES = {"ready": "ready comment", "table": "documentation of the program", "base": "base", "remap": "remap"}


class Parts:
    """Tables about one launch file. `place`: the location of a path's page, None for no page."""

    def __init__(self, doc: LaunchDoc, place: Callable[[str], str | None]) -> None:
        self.doc = doc
        self.place = place

    def sections(self) -> list[tuple[str, str, str]]:
        """Return anchor, title and content of the parts that are not empty."""
        doc = self.doc
        found: list[tuple[str, str, str]] = []
        if doc.arguments:
            rows = [self.argument_row(each) for each in doc.arguments]
            found.append(("arguments", "Arguments", table(("Name", "Type", "Default", "Meaning"), rows, "Arguments")))
        if doc.nodes:
            rows = [self.node_row(each) for each in doc.nodes]
            found.append(("nodes", "Nodes", table(("Name", "Program", "Machine", "When", "Notes"), rows, "Nodes")))
        if rows := list(self.param_rows()):
            found.append(("parameters", "Parameters", table(("Parameter", "Value", "Of"), rows, "Parameters")))
        if rows := list(self.topic_rows()):
            found.append(("names", "Topics and services", table(("Node", "", "Name", "From"), rows, "Topics")))
        if doc.includes:
            rows = [self.include_row(each) for each in doc.includes]
            found.append(("includes", "Includes", table(("File", "When", "Passes"), rows, "Includes")))
        return found

    def argument_row(self, argument: ArgumentDoc) -> tuple[str, ...]:
        """Return the row of an argument; its name links to the line that declares it."""
        shown = {
            "required": '<strong class="required">required</strong>',
            "optional": code(argument.default),
            "convenience": f'<span class="quiet">always</span> {code(argument.default)}',
        }[argument.kind]
        condition = f'<div class="where">{inline(argument.condition)}</div>' if argument.condition else ""
        name = f'<span id="arg-{escape(argument.name)}">{_line_link(argument.line, code(argument.name))}</span>'
        return (name, escape(argument.type), shown + condition, inline(argument.doc))

    def node_row(self, node: NodeDoc) -> tuple[str, ...]:
        """Return the row of a node; its name links to its tag."""
        return (
            _line_link(node.line, show_values(node.names)),
            f"{show_values(node.package)} {show_values(node.type)}",
            code(node.machine) if node.machine else "",
            _when(node.conditions, node.only_with),
            escape("; ".join(node.traits)),
        )

    def param_rows(self) -> Iterable[tuple[str, ...]]:
        """Return parameters of nodes, then those of the file."""
        for node in self.doc.nodes:
            yield from self.rows_of(node.names[0].text, node.params, node.param_files)
        yield from self.rows_of("", self.doc.params, self.doc.param_files)

    def rows_of(
        self, owner: str, params: Iterable[ParamDoc], files: Iterable[ParamFileDoc]
    ) -> Iterable[tuple[str, ...]]:
        """Return the parameters of a node; those of a YAML file can be folded."""
        of = code(owner) if owner else ""
        for file in files:
            names = ", ".join(f"<code>{escape(name)}</code>" for name in file.names)
            count = f"{len(file.names)} parameters" if len(file.names) != 1 else "1 parameter"
            folded = f"<details><summary>{count}</summary>{names}</details>" if names else "parameters"
            yield (folded, "from " + show_values(file.files), of)
        for param in params:
            yield (_line_link(param.line, code(param.name)), show_values(param.values), of)

    def topic_rows(self) -> Iterable[tuple[str, ...]]:
        """Table rows of the names that nodes use."""
        for node in self.doc.nodes:
            name = code(node.names[0].text)
            for topic in node.topics:
                rate = f" at {escape(topic.detail)}" if topic.detail else ""
                yield (name, escape(topic.kind), code(topic.name) + rate, _SOURCES[topic.source])
            for old, new in node.remaps:
                yield (name, "remaps", f"{code(old)} to {code(new)}", "")

    def include_row(self, include: IncludeDoc) -> tuple[str, ...]:
        """Return the row of an include with the files that it refers to."""
        targets = []
        for target in include.targets:
            page = self.place(target.path) if target.path else None
            shown = link(page, escape(target.name)) if page else code(target.path or target.name)
            extra = {"missing": " is missing", "elsewhere": " elsewhere", "candidate": " perhaps"}.get(target.state, "")
            names = name_cases(target.cases)
            where = f' <span class="where">{escape(names)}</span>' if names.strip() else ""
            quiet = f'<span class="quiet">{extra}</span>' if extra else ""
            targets.append(f"<div{cases_attribute(target.cases)}>{shown}{quiet}{where}</div>")
        passes = " ".join(
            f"<code>{escape(name if value == f'$(arg {name})' else f'{name}:={value}')}</code>"
            for name, value in include.passes
        )
        first = "".join(targets) or code(include.written)
        line = f'<div class="where">{_line_link(include.line, f"line {include.line}")}</div>'
        return (first + line, _when(include.conditions, include.only_with), passes)


def _line_link(line: int, content: str) -> str:
    # Blocks inside a link are fine in HTML.
    return link(f"#L{line}", content, ' class="to-line"')


def _when(conditions: tuple[str, ...], only_with: str) -> str:
    return f"only with {code(only_with)}" if only_with else inline(" and ".join(conditions))
