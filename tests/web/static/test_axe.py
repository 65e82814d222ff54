"""The page as axe-core sees it, with each panel open, on a phone and on a desk: no serious finding."""

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.npm_packages import PAGE
from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import PlayedRobot
from tests.web.static.test_accessibility import PANELS, browser, open_panel  # noqa: F401 - a fixture
from tests.web.static.test_layout import BUSY, set_size

from ur.web.wire.frames import Kind

AXE = PAGE / "node_modules/axe-core/axe.min.js"
pytestmark = [
    *MARKS,
    pytest.mark.skipif(not AXE.exists(), reason="axe-core is not installed: bash tools/set_up.bash test"),
]
# What is wrong and how much, with the elements; a colour is judged where the picture of the map is not behind it.
FINDINGS = """axe.run({ resultTypes: ["violations"] }).then(({ violations }) => violations
  .filter(({ impact }) => ["serious", "critical"].includes(impact))
  .map(({ id, nodes }) => `${id}: ${nodes.map((each) => `${each.html} ${each.failureSummary}`).join("; ")}`))"""


def find_serious(browser: Chromium) -> list[str]:  # noqa: F811
    browser.run("document.getAnimations().forEach((each) => each.finish()); 0")  # no colour is between two others
    found: list[str] = browser.run(FINDINGS)
    return found


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_axe_has_no_serious_finding_in_any_panel(
    robot: PlayedRobot,
    browser: Chromium,  # noqa: F811
    size: tuple[int, int],
    scheme: str,
) -> None:
    browser.run(f"if (!globalThis.axe) {{ {AXE.read_text()} }} 0")
    browser.run("document.querySelector('h1').insertAdjacentHTML('afterend', '<button id=nameless></button>'); 0")
    assert [each.partition(":")[0] for each in find_serious(browser)] == ["button-name"], "it does see what is wrong"
    browser.run("document.getElementById('nameless').remove(); 0")
    browser.prefer(scheme)
    set_size(browser, size)
    robot.show(Kind.STATE, BUSY)
    found = {}
    for name in ["", *PANELS]:
        browser.run("page.panels.show([]); 0")
        if name:
            open_panel(browser, name)
        else:
            browser.run("page.panels.openMenu(true); 0")
        if serious := find_serious(browser):
            found[name] = serious
        browser.run("page.panels.openMenu(false); 0")
    assert found == {}
