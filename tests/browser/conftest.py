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


@pytest.fixture
def open_tab(chromium: Browser):
    """Return a function that opens tabs, and checks at the end that none had a problem."""
    tabs, contexts = [], []

    def opened(width: int = 1280, height: int = 900, **settings: object) -> Tab:
        context = chromium.new_context(
            offline=True, viewport={"width": width, "height": height}, **settings
        )
        contexts.append(context)
        tabs.append(Tab(context.new_page()))
        return tabs[-1]

    yield opened
    for context in contexts:
        context.close()
    assert [problem for tab in tabs for problem in tab.problems] == []


@pytest.fixture(scope="session")
def report(smoke, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the smoke study's report, away from all other results."""
    alone = tmp_path_factory.mktemp("alone") / "report"
    shutil.copytree(smoke.study / "report", alone)
    return alone
