"""Chromium without a network, and the pages of a run that it opens."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

ARGUMENTS = ("--no-sandbox", "--disable-dev-shm-usage")
"""Chromium as root, and in containers with little shared memory."""


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """Debian's Chromium, headless."""
    found = shutil.which("chromium")
    if found is None:
        pytest.skip("chromium is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=list(ARGUMENTS))
        yield browser
        browser.close()


class Tab:
    """A page of the browser; `problems` holds errors of its console and requests that it made."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.problems: list[str] = []
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("console", self._hear)
        page.on("request", self._see)

    def _hear(self, message) -> None:
        if message.type == "error":
            self.problems.append(message.text)

    def _see(self, request) -> None:
        if not request.url.startswith(("file:", "data:", "blob:")):
            self.problems.append(f"asks for {request.url}")

    def open(self, path: Path, hash_: str = "") -> Page:
        # A hash alone would not load the page again.
        self.page.goto("about:blank")
        self.page.goto(path.resolve().as_uri() + hash_)
        return self.page


@pytest.fixture(scope="session")
def idle_tabs() -> dict[str, list[Tab]]:
    """Tabs that no test uses at present, by their settings: a new tab is a new process."""
    return {}


@pytest.fixture
def open_tab(chromium: Browser, idle_tabs: dict[str, list[Tab]]):
    """Return a function that gives blank tabs, and checks at the end that none had a problem."""
    used: list[tuple[list[Tab], Tab]] = []

    def opened(width: int = 1280, height: int = 900, **settings: object) -> Tab:
        settings["viewport"] = {"width": width, "height": height}
        idle = idle_tabs.setdefault(repr(settings), [])
        if not idle:
            idle.append(Tab(chromium.new_context(offline=True, **settings).new_page()))
        used.append((idle, idle.pop()))
        return used[-1][1]

    yield opened
    problems = [problem for _, tab in used for problem in tab.problems]
    for idle, tab in used:
        tab.page.goto("about:blank")
        tab.problems.clear()
        idle.append(tab)
    assert problems == []


@pytest.fixture(scope="session")
def report(smoke, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the smoke study's report, away from all other results."""
    alone = tmp_path_factory.mktemp("alone") / "report"
    shutil.copytree(smoke.study / "report", alone)
    return alone
