"""Documentation of launch files and their arguments, as their authors write it."""

from ur.check.queries.layout import comments_after, find_heading, heading_of
from ur.check.rule import LaunchView
from ur.lsp.workspace import Workspace


def document_of(name: str, view: LaunchView) -> str:
    """The documentation of an argument: `doc=`, else the comment `<!--NAME: text-->` that follows."""
    launch = view.tree.launch
    for element in view.declared.get(name, ()):
        if element.attributes.get("doc"):
            return element.attributes["doc"]
        if launch is None or element not in launch.children:
            continue
        for heading in map(heading_of, comments_after(launch, element)):
            if heading is not None and heading[0] == name:
                return " ".join(heading[1].split())
    return ""


def summary_of(path: str, workspace: Workspace) -> str:
    """The `<!--Summary: ...-->` of a launch file; empty without one."""
    if not path.endswith((".launch", ".xml", ".test")):
        return ""
    view = workspace.view(path)
    return find_heading(view, "Summary") or "" if view is not None else ""
