"""Include trees of plans."""

from ur.graph.boxes import Branch
from ur.graph.includes import build_trees, merge_trees
from ur.graph.text import draw_tree
from ur.launchfile.load import load_plan
from ur.launchfile.world.memory import MemoryWorld

NODE = '<node name="{0}" pkg="p" type="t"/>'


def trees(files: dict[str, str], *arguments: str) -> tuple[Branch, ...]:
    texts = {f"/p/{name}": f"<launch>{text}</launch>" for name, text in files.items()}
    plan = load_plan(["/p/top.launch"], list(arguments), MemoryWorld(texts))
    return build_trees(plan, ["/p/top.launch"])


def text(tree: Branch) -> list[str]:
    return ["".join(piece for piece, _ in line) for line in draw_tree(tree)]


def include(name: str, inside: str = "") -> str:
    return f'<include file="/p/{name}">{inside}</include>'


def test_files_and_nodes_stand_in_document_order() -> None:
    (tree,) = trees(
        {
            "top.launch": NODE.format("first") + include("a.launch") + NODE.format("last"),
            "a.launch": f'<group ns="g">{NODE.format("inner")}</group>',
        }
    )
    assert text(tree) == [
        "top.launch",
        "├─ /first  p/t",
        "├─ a.launch",
        "│  └─ /g/inner  p/t",
        "└─ /last  p/t",
    ]


def test_file_included_twice_grows_twice_and_is_one_box() -> None:
    part = '<arg name="n"/><node name="$(arg n)" pkg="p" type="t"/>'
    top = "".join(include("a.launch", f'<arg name="n" value="{name}"/>') for name in ("x", "y"))
    found = trees({"top.launch": top, "a.launch": part})
    assert text(found[0]) == ["top.launch", "├─ a.launch", "│  └─ /x  p/t", "└─ a.launch", "   └─ /y  p/t"]
    graph = merge_trees(found)
    assert sorted(box.label for box in graph.boxes) == ["/x", "/y", "a.launch", "top.launch"]
    assert len(graph.arrows) == 3


def test_missing_file_is_a_fault() -> None:
    found = trees({"top.launch": include("gone.launch")})
    assert [(each.kind, each.note) for each in found[0].children] == [("missing", "no such file: /p/gone.launch")]
    assert [arrow.fault for arrow in merge_trees(found).arrows] == [True]


def test_file_that_includes_itself_is_drawn_once_more_and_ends_there() -> None:
    found = trees({"top.launch": include("a.launch"), "a.launch": include("b.launch"), "b.launch": include("a.launch")})
    assert text(found[0]) == [
        "top.launch",
        "└─ a.launch",
        "   └─ b.launch",
        "      └─ a.launch  includes itself",
    ]
    graph = merge_trees(found)
    assert [(box.label, box.kind) for box in graph.boxes] == [
        ("top.launch", "file"), ("a.launch", "file"), ("b.launch", "file"),
    ]  # fmt: skip
    assert [arrow.label for arrow in graph.arrows if arrow.fault] == ["includes itself"]
