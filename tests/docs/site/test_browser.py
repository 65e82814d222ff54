"""The site in a real browser, without network and without a server: seen, typed into, and nothing to complain of."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.docs.chromium import Chromium, find_chromium
from tests.docs.helpers import ROVER, document_folder

from ur.docs.site.render import render_site

PROGRAM = find_chromium()
DESKTOP, PHONE = (1400, 900), (390, 844)
TASK = "launch/m_rover.html"
SEEN = """[...document.querySelectorAll('main *')].filter((e) => e.offsetParent && !e.closest('.scroll, pre, .canvas'))
  .filter((e) => e.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
  .map((e) => e.outerHTML.slice(0, 120))"""

pytestmark = pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("site")
    for name, text in render_site(document_folder(ROVER)).items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder.as_uri()


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path_factory.mktemp("chromium")) as browser:
        yield browser


@pytest.fixture
def browser(running: Chromium, site: str) -> Iterator[Chromium]:
    running.complaints.clear()
    running.resize(*DESKTOP)
    running.open(f"{site}/index.html")
    running.run("localStorage.clear()")
    yield running
    assert running.complaints == []


def active(browser: Chromium) -> str:
    return str(browser.run("document.activeElement.id || document.activeElement.tagName"))


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_fit_their_width_in_both_colours(
    browser: Chromium, site: str, size: tuple[int, int], scheme: str, tmp_path: Path
) -> None:
    browser.resize(*size, phone=size == PHONE)
    browser.prefer(scheme)
    for page in ("index.html", TASK, "program/ur_rover.html"):
        browser.open(f"{site}/{page}")
        assert browser.run("document.documentElement.scrollWidth") <= size[0], page
        assert browser.run(SEEN) == [], page
        picture = browser.screenshot()
        (tmp_path / "page.png").write_bytes(picture)
        assert picture.startswith(b"\x89PNG")
        light = browser.run("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        assert light == (scheme == "light")


def test_texts_stand_out_from_what_is_behind_them(browser: Chromium, site: str) -> None:
    # WCAG asks for a contrast of 4.5.
    script = """(() => {
  const parse = (c) => c.match(/[\\d.]+/g).slice(0, 3).map(Number);
  const light = (c) => parse(c).map((v) => v / 255).map((v) => v <= .03928 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [.2126, .7152, .0722][i], 0);
  const behind = (e) => { while (e) { const c = getComputedStyle(e).backgroundColor;
    if (!c.endsWith(", 0)")) return c; e = e.parentElement; } return "rgb(255, 255, 255)"; };
  return [...document.querySelectorAll("body *")].filter((e) => e.offsetParent && !e.closest("svg")
      && [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()))
    .map((e) => { const [a, b] = [light(getComputedStyle(e).color), light(behind(e))].sort((x, y) => y - x);
      return [(a + .05) / (b + .05), e.outerHTML.slice(0, 100)]; })
    .filter(([ratio]) => ratio < 4.5);
})()"""
    for scheme in ("light", "dark"):
        browser.prefer(scheme)
        browser.open(f"{site}/{TASK}")
        assert browser.run(script) == []


def test_slash_arrows_and_enter_find_a_page(browser: Chromium) -> None:
    browser.press("/")
    assert active(browser) == "search"
    browser.write("driver")
    titles = browser.run("[...document.querySelectorAll('#results b')].map((e) => e.textContent)")
    assert titles[0] == "drivers_loki.launch.xml"
    assert browser.run("document.querySelector('[aria-selected=true] b').textContent") == titles[0]
    browser.press("ArrowDown")
    chosen = browser.run("document.querySelector('[aria-selected=true] b').textContent")
    assert chosen == titles[1]
    assert browser.run("document.getElementById('search').getAttribute('aria-activedescendant')") == "result-1"
    browser.press("ArrowUp")
    browser.press("ArrowUp")
    assert browser.run("document.querySelector('[aria-selected=true] b').textContent") == titles[-1]
    browser.press("ArrowDown")
    browser.press("ArrowDown")
    browser.press("Enter")
    browser.wait_for_load()
    assert browser.run("document.querySelector('h1').textContent") == chosen


def test_escape_closes_the_results_and_then_leaves_the_search(browser: Chromium) -> None:
    browser.press("/")
    browser.write("camera")
    assert browser.run("document.getElementById('results').hidden") is False
    browser.press("Escape")
    assert browser.run("document.getElementById('results').hidden") is True
    assert active(browser) == "search"
    browser.press("Escape")
    assert active(browser) == "BODY"
    assert browser.run("document.getElementById('search').value") == ""


def test_search_finds_arguments_nodes_and_topics(browser: Chromium) -> None:
    for word, title in (
        ("extras", "m_extras.launch.xml"),
        ("odom", "n_driver.launch.xml"),
        ("usb_cam", "n_camera.launch.xml"),
    ):
        browser.press("/")
        browser.run("document.getElementById('search').value = ''")
        browser.write(word)
        titles = browser.run("[...document.querySelectorAll('#results b')].map((e) => e.textContent)")
        assert title in titles, word
        browser.press("Escape")
        browser.press("Escape")
    browser.press("/")
    browser.write("zzz")
    assert "Nothing" in browser.run("document.getElementById('results').textContent")


def test_first_tab_reaches_the_skip_link_and_focus_is_seen(browser: Chromium) -> None:
    browser.press("Tab")
    assert browser.run("document.activeElement.textContent") == "Skip to the content"
    assert browser.run("document.activeElement.getBoundingClientRect().top") >= 0
    assert browser.run("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    browser.press("Enter")
    assert active(browser) == "content"


def test_base_switch_shows_what_is_for_the_base_and_is_remembered(browser: Chromium, site: str) -> None:
    browser.open(f"{site}/{TASK}")
    shown = "[...document.querySelectorAll('#tree ~ div h3')].filter((e) => e.offsetParent).map((e) => e.textContent)"
    choose = "(v) => {const s = document.getElementById('base'); s.value = v; s.dispatchEvent(new Event('change'))}"
    assert len(browser.run(shown)) == 5
    browser.run(f"({choose})('magni:arm')")
    assert browser.run(shown) == ["On magni (arm)"]
    assert (
        browser.run(
            "[...document.querySelectorAll('svg text')].filter((e) => e.getClientRects().length)"
            ".map((e) => e.textContent).includes('drivers_loki.launch.xml')"
        )
        is False
    )
    browser.open(f"{site}/launch/n_sonar.html")
    assert browser.run("document.getElementById('base').value") == "magni:arm"
    browser.run(f"({choose})('stage')")
    assert "stage.yaml: no such file" in browser.run(
        "[...document.querySelectorAll('.problem')].filter((e) => e.offsetParent).map((e) => e.textContent).join()"
    )
    browser.run(f"({choose})('')")
    browser.open(f"{site}/{TASK}")
    assert len(browser.run(shown)) == 5


def test_colours_are_chosen_and_remembered(browser: Chromium, site: str) -> None:
    browser.prefer("light")
    for expected in ("light", "dark"):
        browser.run("document.getElementById('theme').click()")
        assert browser.run("document.documentElement.dataset.theme") == expected
    browser.open(f"{site}/{TASK}")
    assert browser.run("getComputedStyle(document.body).backgroundColor") != "rgb(255, 255, 255)"
    browser.run("document.getElementById('theme').click()")
    assert browser.run("'theme' in document.documentElement.dataset") is False


def test_menu_of_a_phone_opens_and_closes(browser: Chromium) -> None:
    browser.resize(*PHONE, phone=True)
    seen = "Boolean(document.getElementById('nav').offsetParent)"
    assert browser.run(seen) is False
    browser.run("document.getElementById('menu').focus()")
    browser.press("Enter")
    assert browser.run(seen) is True
    assert browser.run("document.getElementById('menu').getAttribute('aria-expanded')") == "true"
    browser.press("Escape")
    assert browser.run(seen) is False


def test_line_of_the_source_is_reached_and_marked(browser: Chromium, site: str) -> None:
    browser.open(f"{site}/{TASK}")
    browser.run("document.querySelector('#arg-camera a').click()")
    line = browser.run("document.querySelector(':target').textContent")
    assert 'name="camera"' in line
    assert browser.run("getComputedStyle(document.querySelector(':target')).backgroundColor") == "rgb(255, 243, 196)"


def test_every_control_has_a_name(browser: Chromium, site: str) -> None:
    browser.open(f"{site}/{TASK}")
    tree = browser.ask("Accessibility.getFullAXTree")["nodes"]
    nameless = [
        node["role"]["value"]
        for node in tree
        if node.get("role", {}).get("value") in ("link", "button", "combobox", "region", "navigation", "listbox")
        and not node.get("name", {}).get("value")
        and not node.get("ignored")
    ]
    assert nameless == []
