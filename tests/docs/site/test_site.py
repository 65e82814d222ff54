"""The site as texts: links, anchors, what a page holds."""

from __future__ import annotations

import re

import pytest
from tests.docs.helpers import LIBRARY, ROVER, document, document_folder
from tests.docs.links import find_dead_links

from ur.docs.site.render import MANIFEST, read_manifest, render_site


@pytest.mark.parametrize("folder", [LIBRARY, ROVER], ids=lambda path: path.name)
def test_every_link_leads_somewhere(folder: object) -> None:
    site = render_site(document_folder(folder))  # type: ignore[arg-type]  # a path, see above
    assert find_dead_links(site) == []
    assert read_manifest(site[MANIFEST]) == sorted(set(site) - {MANIFEST})


def test_link_checker_finds_dead_links_and_anchors() -> None:
    site = {"a.html": '<a href="b.html#x">x</a><a href="c.html">c</a><p id="p"><i id="p">', "b.html": "<p>"}
    assert find_dead_links(site) == ["a.html: id p twice", "a.html: b.html#x", "a.html: c.html"]


def test_site_asks_nothing_of_the_network() -> None:
    site = render_site(document_folder(ROVER))
    for name, text in site.items():
        assert not re.search(r"""(?:src|href)=["'](?:https?:)?//|@import|url\(""", text), name


def test_what_files_say_is_never_markup() -> None:
    evil = "<script>alert(1)</script>"
    site = render_site(
        document(
            {
                "launch/one.launch": f"""<launch>
  <!--Summary: {evil}-->
  <!--Overview: {evil} and ![p](javascript:alert(2)) [l](javascript:alert(3))-->
  <arg name="a" default="{evil.replace("<", "&lt;")}"/>
  <!--a: {evil}-->
  <node name="n" pkg="p" type="&lt;b>t"/>
</launch>"""
            }
        )
    )
    page = next(text for name, text in site.items() if name.startswith("launch/"))
    assert "<script>alert" not in page
    assert "<b>t" not in page
    assert 'href="javascript' not in page
    assert "</script>" not in site["search.js"]


def test_line_numbers_lead_into_the_source() -> None:
    site = render_site(document({"launch/one.launch": '<launch>\n  <arg name="a" default="1"/>\n</launch>\n'}))
    page = site["launch/one.html"]
    assert '<a href="#L2" class="to-line"><code>a</code></a>' in page
    assert '<span class="line" id="L2">' in page


def test_files_of_one_name_get_pages_of_their_own() -> None:
    site = render_site(
        document({"a/one.launch": "<launch/>", "a/One.launch": "<launch/>", "a-one.launch": "<launch/>"})
    )
    assert len([name for name in site if name.startswith("launch/")]) == 3
    assert find_dead_links(site) == []


def test_manifest_never_leads_out_of_the_site() -> None:
    assert read_manifest("index.html\n../../secret\n/etc/passwd\na/../../b\n") == ["index.html"]
