"""Random edits of launch files, as an editor makes them: nothing is raised, and what is found at the end is right.

    .venv/bin/python -m tests.lsp.random_edits [--edits N] [--seed N]

Texts are cut, doubled and mixed at any place. From time to time everything is found, and compared with a new check.
"""

import argparse
import random
import sys
from pathlib import Path

from ur.check.render.text import render_json
from ur.check.session import check_paths, finish_report
from ur.check.worlds import make_world
from ur.launchfile.world.overlay import OverlayWorld
from ur.lsp.workspace import Workspace, encode_text

PIECES = (
    *(
        "<",
        ">",
        "/>",
        '"',
        "'",
        "$(",
        ")",
        "$(arg ",
        "$(find ",
        "$(eval ",
        "&",
        "&lt;",
        "<!--",
        "-->",
        "\n",
        "ä",
        "\U0001f916",
    ),
    *(
        '<arg name="x" default="1"/>',
        "</launch>",
        "<launch>",
        "</node>",
        '<node pkg="',
        "<group>",
        "</group>",
        "<rosparam>",
    ),
    *('<include file="$(find my_robot)/launch/a.launch"/>', "<!--ur: ignore unknown-tag: why-->", "]]>", "<![CDATA["),
)


def make_package(folder: Path, texts: list[str]) -> list[str]:
    """A package with these launch files; their paths."""
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>my_robot</name></package>")
    paths = []
    for number, text in enumerate(texts):
        path = folder / f"launch/{chr(ord('a') + number % 26)}{number // 26 or ''}.launch"
        path.write_text(text)
        paths.append(str(path))
    return paths


def edit_at_random(text: str, choose: random.Random, limit: int = 3000) -> str:
    """One edit: a cut, a double, a piece of XML, or a letter."""
    start = choose.randint(0, len(text))
    end = min(len(text), start + choose.choice((0, 0, 1, 1, 5, 40)))
    new = choose.choice((choose.choice(PIECES), text[start : end + 5], "", chr(choose.randint(32, 126))))
    return (text[:start] + new + text[end:])[:limit]


def run(folder: Path, texts: list[str], edits: int, seed: int, compare_every: int) -> int:
    """Make the edits; the number of comparisons. Raises AssertionError for a difference."""
    choose = random.Random(seed)
    paths = make_package(folder, texts)
    now = dict(zip(paths, texts, strict=True))
    workspace = Workspace([str(folder)], lambda places: make_world(places, {}))
    compared = 0
    for number in range(1, edits + 1):
        path = choose.choice(paths)
        now[path] = edit_at_random(now[path], choose) if choose.random() > 0.02 else texts[paths.index(path)]
        workspace.set_text(path, now[path])
        for _ in zip(range(choose.choice((0, 1, 3))), workspace.steps([path]), strict=False):
            workspace.findings_of(path)
        if number % compare_every == 0 or number == edits:
            session = workspace.session
            assert session is not None
            world = OverlayWorld(make_world([str(folder)], {}), {each: encode_text(text) for each, text in now.items()})
            found, expected = render_json(finish_report(session)), render_json(check_paths([str(folder)], world))
            assert found == expected, f"edit {number} of seed {seed}"
            compared += 1
    return compared


def main() -> None:
    """Run as often as is asked for."""
    import tempfile

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edits", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    corpus = sorted((Path(__file__).parents[1] / "launchfile/corpus").rglob("*.launch"))
    texts = [path.read_text(encoding="utf-8", errors="replace") for path in corpus]
    texts = [text for text in texts if len(text) < 2000][:12]
    with tempfile.TemporaryDirectory() as folder:
        compared = run(Path(folder) / "my_robot", texts, options.edits, options.seed, 200)
    sys.stdout.write(
        f"{options.edits} edits of {len(texts)} files, {compared} comparisons with a new check: all equal\n"
    )


if __name__ == "__main__":
    main()
