"""Tests reports, frames in notebooks, and the live page."""

from __future__ import annotations

import urllib.error
import urllib.request
from pathlib import Path
from xml.dom import minidom

import pytest
from conftest import CELLS, Run

import sweetspot as ss

HITACHI = CELLS / "hitachi_cell.toml"


def test_the_report_of_a_cell_has_the_verdict_of_the_command(tmp_path: Path, command: Run) -> None:
    cell = ss.Cell.read(HITACHI)
    verdict = cell.report(tmp_path / "ours.html")
    said = command("report", HITACHI, "--json", "-o", tmp_path / "theirs.html")
    assert verdict.to_dict() == said
    ours, theirs = ((tmp_path / name).read_text() for name in ("ours.html", "theirs.html"))
    assert abs(len(ours) - len(theirs)) < 2000, "only the origin of the numbers differs"


def test_the_report_of_a_search(tmp_path: Path) -> None:
    search = ss.Cell.read(HITACHI).search(seed=1, budget=1000)
    verdict = search.report(tmp_path / "report.html")
    assert verdict.answer == "yes" and verdict.headline
    html = (tmp_path / "report.html").read_text()
    assert "search" in html and f"{search.evaluations} layouts" in html


def test_a_page_is_written_only_under_the_name_of_a_page(tmp_path: Path) -> None:
    cell = ss.Cell.read(HITACHI)
    with pytest.raises(ss.InputError, match=".html"):
        cell.report(tmp_path / "cell.toml")
    with pytest.raises(OSError, match="cannot write"):
        cell.report(tmp_path / "none" / "report.html")
    assert not list(tmp_path.iterdir())


def test_notebooks_show_pictures_and_reports() -> None:
    cell = ss.Cell.read(HITACHI)
    map = cell.map()
    minidom.parseString(map.svg)
    assert map.svg in map._repr_html_()
    frame = cell.search(seed=1, budget=500)._repr_html_()
    assert frame.startswith("<iframe srcdoc=") and 'sandbox="allow-scripts"' in frame
    assert "<iframe" in cell._repr_html_()


def test_the_live_page_is_served_until_it_is_stopped() -> None:
    with ss.Cell.read(HITACHI).view() as view:
        assert view.url in view._repr_html_()
        with urllib.request.urlopen(view.url) as page:
            assert page.status == 200 and b"<html" in page.read().lower()
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(view.url.rsplit("/", 2)[0] + "/wrong/")
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(view.url)
