"""Report, notebook pages and explorer in Chromium: for everybody, on every screen, in print."""

import base64
import re
import zlib

import pytest
from axe_playwright_python.sync_playwright import Axe

from gearmesh.data.paths import FIGURE_NAMES

PAGES = ("index.html", "explorer.html", "notebooks/fig4.html")
SCREENS = {
    "wide, light": {"width": 1280, "color_scheme": "light"},
    "narrow, dark": {"width": 390, "color_scheme": "dark", "has_touch": True},
}

ONLY_VIOLATIONS = {"resultTypes": ["violations"]}
"""What passes is not listed: the lists take longest on long pages."""

UNNAMED = """[...document.querySelectorAll(".stack tr")].filter((row) =>
    [...row.querySelectorAll("td:not([data-label])")].filter((cell) =>
        /^[−-]?\\d/.test(cell.innerText)).length > 1).length"""
"""Rows with several numbers that no label tells apart once their cells are stacked."""

BROKEN = "[...document.images].filter((image) => !image.complete || !image.naturalWidth).length"


@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("name", PAGES)
def test_everybody_can_read_the_pages_on_every_screen(open_tab, report, name, screen):
    page = open_tab(**SCREENS[screen]).open(report / name)
    assert page.evaluate(BROKEN) == 0
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert page.evaluate(UNNAMED) == 0
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    light = sum(map(int, re.findall(r"\d+", ground)[:3])) > 3 * 128
    assert light == (SCREENS[screen]["color_scheme"] == "light")
    found = Axe().run(page, options=ONLY_VIOLATIONS)
    assert found.violations_count == 0, found.generate_report()


def test_axe_would_find_something(open_tab, report):
    page = open_tab().open(report / "explorer.html")
    page.evaluate("document.querySelector('#plane').removeAttribute('aria-label')")
    assert Axe().run(page, options=ONLY_VIOLATIONS).violations_count == 1


def test_links_of_the_report_lead_into_the_explorer(open_tab, report):
    page = open_tab().open(report / "index.html")
    links = page.locator("a[href^='explorer.html#']")
    assert links.count() > 25
    targets = links.evaluate_all("all => [...new Set(all.map((a) => a.getAttribute('href')))]")
    explorer_tab = open_tab()
    for target in targets[::7]:
        explorer = explorer_tab.open(report / "explorer.html", target.removeprefix("explorer.html"))
        asked, shown = target.partition("#")[2], explorer.evaluate("location.hash.slice(1)")
        explorer.wait_for_function("gearmesh.result().status === 'ok'")
        assert asked == shown


def test_the_keyboard_reaches_wide_equations_and_tables(open_tab, report):
    page = open_tab(width=390).open(report / "index.html")
    wide = (
        "[...document.querySelectorAll('.scroll, .equation .line')]"
        ".filter((box) => box.scrollWidth > box.clientWidth + 1)"
    )
    assert page.evaluate(f"{wide}.length") > 0
    assert page.evaluate(f"{wide}.every((box) => box.tabIndex === 0)")


def contents(pdf: bytes) -> list[bytes]:
    """Return what is drawn on each page of a PDF that Chromium made."""
    objects = dict(re.findall(rb"\n(\d+) 0 obj\n(.*?)endobj", pdf, re.DOTALL))
    pages = []
    for body in objects.values():
        if re.search(rb"/Type /Page\b", body):
            [number] = re.findall(rb"/Contents (\d+) 0 R", body)
            stream = re.search(rb"stream\n(.*)\nendstream", objects[number], re.DOTALL)
            pages.append(zlib.decompress(stream.group(1)))
    return pages


@pytest.mark.parametrize("name", PAGES)
def test_no_printed_page_is_empty(open_tab, report, name):
    page = open_tab(color_scheme="dark").open(report / name)
    pages = contents(page.pdf(format="A4"))
    assert pages
    drawn = [len(re.findall(rb"\bT[jJ]\b|\bDo\b", content)) for content in pages]
    assert min(drawn) > 0, drawn


def test_the_report_of_snakemake_shows_the_same_pictures(smoke, open_tab, tmp_path):
    written = tmp_path / "report.html"
    made = smoke.run("all", options=("--report", str(written)))
    assert made.returncode == 0, made.stdout
    page = open_tab().open(written)
    page.get_by_role("link", name="Figures").first.click()
    views = page.locator("[iconname=eye]")
    assert views.count() == len(FIGURE_NAMES)
    for i, name in enumerate(FIGURE_NAMES):
        views.nth(i).click()
        image = page.locator(f"img[src*='filename={name}.png']")
        image.wait_for()
        assert page.evaluate(BROKEN) == 0
        drawn = base64.b64decode(image.get_attribute("src").partition("base64,")[2])
        assert drawn == (smoke.study / "figures" / f"{name}.png").read_bytes()
    held = page.evaluate(
        "Object.values(results).find((r) => r.name.endsWith('index.html')).data_uri"
    )
    report = tmp_path / "index.html"
    report.write_bytes(base64.b64decode(held.partition("base64,")[2]))
    assert open_tab().open(report).evaluate(BROKEN) == 0
