"""What has to hold for any file at all."""

from pathlib import Path

from ur.launchfile.dump import dump_plan
from ur.launchfile.load import load_plan
from ur.launchfile.plan.commands import refuse_command
from ur.launchfile.world.system import SystemWorld
from ur.source import render_human

CORPUS = Path(__file__).parents[1] / "corpus"
WORDS = (  # what an editor, a merge, a bad disk or a hostile author leaves in a launch file
    *(b"<", b">", b"/>", b"</", b'"', b"'", b"&", b"&amp;", b"&#0;", b"&#10;", b"$(", b")", b"$(arg a)", b"$(anon n)"),
    *(b"$(eval ", b"$(find corpus_pkg)", b"<!--", b"-->", b"<![CDATA[", b"]]>", b"<?xml", b"?>", b"\xff", b"\xc3"),
    *(b"$(dirname)", b"$(env HOME)", b"$(optenv A b)", b"1e999", b"-1", b"true", b' if="', b' unless="', b' ns="'),
    *(b"<group>", b"</group>", b"<rosparam>", b"</rosparam>", b"<node ", b"<include ", b'<arg name="a" default="1"/>'),
    *(
        b" ** 9",
        b" * 99999999",
        b"[0] * ",
        b"'a' * ",
        b".format(",
        b"{0.real}",
        b"{:9999999d}",
        b" for a in ",
        b"str(",
        b"<<",
    ),
    *(
        b"<!DOCTYPE a [",
        b"<!ENTITY a 'b'>]>",
        b"&a;",
        b"&b [*b]",
        b"<!--Needs: lidar-->",
        b"<!--ready: topic a 5 Hz-->",
    ),
    *(b"<!--ur: ignore bad-name: x-->", b"<!--a: text-->", b"<!--Summary: x-->", b'type="yaml"', b'command="dump"'),
)


def read_corpus() -> list[bytes]:
    """Every launch file of the corpus."""
    return [path.read_bytes() for path in sorted(CORPUS.rglob("*.launch*"))]


def check_survives(path: Path, environment: dict[str, str]) -> None:
    """Raise whatever a file makes us raise; every finding has a place that can be shown, and the plan is JSON."""
    plan = load_plan([str(path)], ["a:=1"], SystemWorld(environment))
    text = render_human(plan.diagnostics)
    assert "Traceback" not in text
    dump_plan(plan, with_origins=True, run=refuse_command)
