"""The pages in a real browser: no error, no request, readable when narrow, keyboard and contrast.

Skipped where no Chromium is installed.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, sync_playwright

from orchestrator.report.page import write
from orchestrator.results.metrics import metrics
from orchestrator.results.recorded import recorded
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.run_page import page as run_page
from orchestrator.studies.paper.animation import flight
from orchestrator.studies.paper.cached_runs import CachedRuns
from orchestrator.studies.paper.figure7 import figure7
from orchestrator.studies.paper.figure13 import figure13
from orchestrator.studies.paper.page import figures, page
from orchestrator.studies.paper.reproduction import Reproduction
from orchestrator.studies.run_cache import RunCache

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed")
WIDTHS = (400, 1600)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as driver:
        made = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield made
        made.close()


@pytest.fixture(scope="module")
def found(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Reproduction:
    """A report of a few runs with all kinds of parts: tables, plots, the animation."""
    with CachedRuns(library, RunCache(tmp_path_factory.mktemp("runs")), workers=1) as runs:
        return Reproduction([figure7(runs), figure13(runs), flight(runs)], 0, 0.0)


@pytest.fixture(scope="module")
def report(found: Reproduction, library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(page(found, library), tmp_path_factory.mktemp("page") / "report.html")


@pytest.fixture
def opened(browser: Browser, report: Path) -> Iterator[Page]:
    """The report at rest; in the end its only event has been the request of its file."""
    context = browser.new_context(viewport={"width": 1600, "height": 1000}, reduced_motion="reduce")
    made = context.new_page()
    events = watched(made)
    made.goto(report.as_uri())
    made.wait_for_selector(".plot .curve", state="attached")
    yield made
    context.close()
    assert events == [report.as_uri()]


def watched(made: Page) -> list[str]:
    """Requests, errors and messages of a page, as they come."""
    events: list[str] = []
    made.on("request", lambda request: events.append(request.url))
    made.on("console", lambda message: events.append(f"console: {message.text}"))
    made.on("pageerror", lambda error: events.append(f"error: {error}"))
    return events


def test_every_plot_is_drawn(opened: Page, found: Reproduction) -> None:
    plots = [plot for figure in figures(found) for plot in figure.plots]
    films = [extra for item in found.items for extra in item.extras]
    plots += [plot for film in films for plot in film.plots]  # type: ignore[union-attr]
    wanted = sum(len(plot.curves) for plot in plots)
    lines = opened.locator("g > path.curve, g > path.stated")
    assert opened.locator(".plot:not(.view)").count() == len(plots)
    assert lines.count() == wanted
    assert all("L" in str(lines.nth(k).get_attribute("d")) for k in range(wanted))


def test_the_table_is_sorted_by_its_heading(opened: Page) -> None:
    fold = opened.locator("#summary details").first
    head = fold.locator("th button", has_text="Error")
    assert not head.is_visible()
    fold.locator("summary").click()
    head.click()
    sizes = fold.locator("tbody tr td:nth-child(4)").evaluate_all(
        "cells => cells.filter(c => c.dataset.sort !== undefined).map(c => Number(c.dataset.sort))"
    )
    assert len(sizes) > 5
    assert sizes == sorted(sizes)
    head.click()
    assert fold.locator("th[aria-sort='descending']").count() == 1


def test_a_plot_is_zoomed_by_keys(opened: Page) -> None:
    plot = opened.locator("figure.plots .drawing > svg").first
    texts = "svg => [...svg.querySelectorAll('text')].map(t => t.textContent)"
    before = plot.evaluate(texts)
    plot.focus()
    opened.keyboard.press("+")
    assert plot.evaluate(texts) != before
    opened.keyboard.press("0")
    assert plot.evaluate(texts) == before


def place(made: Page) -> float:
    return float(made.locator("figure.film .clock").inner_text().split()[0])


def outline(made: Page) -> str:
    return str(made.locator("path.body.wing").first.get_attribute("d"))


def test_the_animation_is_scrubbed_by_keys(opened: Page) -> None:
    slider = opened.get_by_label("Time")
    slider.focus()
    opened.keyboard.press("Home")
    rest = outline(opened)
    for _ in range(30):
        opened.keyboard.press("ArrowRight")
    assert slider.input_value() == "30"
    assert place(opened) == pytest.approx(1000.0 / 18.0 * 30 / 120, abs=0.06)
    assert outline(opened) != rest
    opened.keyboard.press("Home")
    assert outline(opened) == rest


def test_the_animation_plays_slowly_and_stops(opened: Page) -> None:
    """However long the page takes to answer, and however often the cycle begins anew meanwhile."""
    opened.get_by_label("Time").press("Home")
    hand = opened.locator("figure.film .hand").last
    begin = float(hand.get_attribute("x1") or 0.0)
    opened.locator("figure.film select").select_option("10")
    opened.get_by_role("button", name="Play").click()
    while place(opened) <= 3.0:
        opened.wait_for_timeout(20)
    opened.get_by_role("button", name="Pause").click()
    there = place(opened)
    opened.wait_for_timeout(120)
    assert place(opened) == there
    assert (float(hand.get_attribute("x1") or 0.0) > begin) == (there > 0.0)


def test_the_animation_plays_by_itself(browser: Browser, report: Path) -> None:
    """It comes first, is whole in the first window, and can be stopped."""
    context = browser.new_context(
        viewport={"width": 1600, "height": 1000}, reduced_motion="no-preference"
    )
    made = context.new_page()
    made.goto(report.as_uri())
    film = made.locator("main > section").first.locator("figure.film .views")
    box = film.bounding_box()
    assert box is not None
    assert box["y"] + box["height"] <= 1000.0
    begin = place(made)
    made.wait_for_function(
        "begin => parseFloat(document.querySelector('.clock').textContent) !== begin", arg=begin
    )
    made.get_by_role("button", name="Pause").click()
    assert made.get_by_role("button", name="Play").is_visible()
    context.close()


@pytest.mark.parametrize("width", WIDTHS)
def test_names_and_scale_stand_within_the_views(browser: Browser, report: Path, width: int) -> None:
    """No name is cut off or lies on another, and none is too small to read."""
    made = browser.new_page(viewport={"width": width, "height": 1000}, reduced_motion="reduce")
    made.goto(report.as_uri())
    for view in made.locator(".view svg").all():
        frame = view.bounding_box()
        texts = view.locator("text").all()
        assert frame is not None
        assert any(re.fullmatch(r"\d+ mm", each.text_content() or "") for each in texts)
        boxes = [box for each in texts if (box := each.bounding_box()) is not None]
        assert len(boxes) == len(texts)
        for k, box in enumerate(boxes):
            assert box["height"] > 10.0
            assert frame["x"] <= box["x"]
            assert box["x"] + box["width"] <= frame["x"] + frame["width"]
            assert frame["y"] <= box["y"]
            assert box["y"] + box["height"] <= frame["y"] + frame["height"]
            assert not any(overlap(box, other) for other in boxes[:k])
    made.close()


def overlap(one: Any, other: Any) -> bool:
    across = abs(one["x"] - other["x"]) < (one if one["x"] < other["x"] else other)["width"]
    upright = abs(one["y"] - other["y"]) < (one if one["y"] < other["y"] else other)["height"]
    return across and upright


def test_paper_has_no_folds(opened: Page) -> None:
    shut = "[...document.querySelectorAll('details')].filter(each => !each.open).length"
    before = opened.evaluate(shut)
    assert before > 2
    opened.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert opened.evaluate(shut) == 0
    opened.evaluate("dispatchEvent(new Event('afterprint'))")
    assert opened.evaluate(shut) == before


def test_the_contents_stay_in_sight(opened: Page) -> None:
    contents = opened.get_by_role("navigation", name="Sections")
    opened.evaluate("scrollTo(0, document.documentElement.scrollHeight / 2)")
    opened.wait_for_function("scrollY > 0")
    box = contents.bounding_box()
    assert box is not None
    assert 0.0 <= box["y"] < 20.0


@pytest.fixture(scope="module")
def of_a_run(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a run, with the diagram, which the paper's page does not have."""
    plan = load("oscillator-1", None, library, time={"stop": "6 cycles"})
    outcome = run(plan, estimate=True).checked()
    data = recorded(outcome)
    made = replace(run_page(outcome, data, metrics(data)), alarms=["Not to be used: no reason."])
    return write(made, tmp_path_factory.mktemp("run") / "run.html")


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("kind", ["report", "of_a_run"])
def test_it_is_readable_and_accessible(
    browser: Browser, request: pytest.FixtureRequest, width: int, scheme: Any, kind: str
) -> None:
    """Nothing wider than the window, and nothing that axe finds; axe needs the policy off."""
    report: Path = request.getfixturevalue(kind)
    context = browser.new_context(
        viewport={"width": width, "height": 900}, color_scheme=scheme, bypass_csp=True
    )
    made = context.new_page()
    made.goto(report.as_uri())
    made.wait_for_selector(".plot .curve", state="attached")
    assert made.evaluate("document.documentElement.scrollWidth") <= width
    violations = Axe().run(made).response["violations"]
    context.close()
    assert [(v["id"], v["nodes"][0]["html"]) for v in violations] == []


def test_a_card_uses_its_width(browser: Browser, of_a_run: Path) -> None:
    """On a narrow screen a value takes one line, unless it is longer than its card is wide."""
    made = browser.new_page(viewport={"width": 400, "height": 900})
    made.goto(of_a_run.as_uri())
    cells = made.locator("#metrics td > div, #made-of td > div")
    heights = [box["height"] for each in cells.all() if (box := each.bounding_box()) is not None]
    texts = cells.all_text_contents()
    made.close()
    line = min(heights)
    broken = {text for text, high in zip(texts, heights, strict=True) if high > 1.5 * line}
    assert {len(text) for text in broken} == {64}, "only digests are"
    assert max(heights) < 2.5 * line


@pytest.mark.parametrize("text", ["</script><script>alert(1)</script>", "<img src=x onerror=a()>"])
def test_hostile_text_stays_text(browser: Browser, tmp_path: Path, text: str) -> None:
    from tests.orchestrator.report.test_page import page as hostile

    made = browser.new_page()
    events = watched(made)
    path = write(hostile(text), tmp_path / "page.html")
    made.goto(path.as_uri())
    made.wait_for_selector(".plot .mark", state="attached")
    assert made.title() == text
    made.close()
    assert events == [path.as_uri()]
