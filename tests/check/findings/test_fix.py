from ur.check.catalogue import load_rules
from ur.check.findings.suppress import plan_repairs
from ur.check.session import check_paths
from ur.launchfile.world import MemoryWorld


def repair(text: str) -> str:
    report = check_paths(["/w"], MemoryWorld({"/w/a.launch": text}))
    repairs = plan_repairs(report.findings, load_rules())
    assert len(repairs) <= 1
    return repairs[0].text if repairs else text


def test_booleans_are_repaired_and_the_rest_stays() -> None:
    text = '<launch>\n  <group if="yes" >\n    <param name="é" value="1" unless="0ff"/>\n  </group>\n</launch>\n'
    assert repair(text) == text.replace('"yes"', '"true"')


def test_unused_suppression_goes_with_its_line() -> None:
    text = "<launch>\n  <!--ur: ignore bad-xml: it was-->\n  <param name='a' value='1'/>\n</launch>\n"
    assert repair(text) == "<launch>\n  <param name='a' value='1'/>\n</launch>\n"


def test_nothing_to_repair_changes_nothing() -> None:
    text = "<launch>\n  <param name='a' value='$(arg b)'/>\n</launch>\n"
    assert repair(text) == text
