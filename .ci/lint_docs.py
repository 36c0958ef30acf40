"""Check that a built site loads nothing from a network; exits 1 and names what would be loaded.

Links that a reader may follow are allowed. Scripts, styles, pictures and fonts are not.
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

LOADED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src"}
REMOTE = re.compile(r"(?:https?:)?//", re.IGNORECASE)
IN_STYLES = re.compile(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\"')\s]+)", re.IGNORECASE)


class Page(HTMLParser):
    """Collects the remote addresses that a page loads."""

    def __init__(self) -> None:
        super().__init__()
        self.remote: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element loads."""
        address = dict(attrs).get(LOADED.get(tag, ""))
        if address and REMOTE.match(address):
            self.remote.append(address)


def remote(path: Path) -> list[str]:
    """Return the remote addresses that a file of the site loads."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".css":
        return IN_STYLES.findall(text)
    page = Page()
    page.feed(text)
    return page.remote + IN_STYLES.findall(text)


def main(folder: Path) -> int:
    """Check all pages and styles below a folder; returns the exit status."""
    files = [path for path in sorted(folder.rglob("*")) if path.suffix in (".html", ".css")]
    if not files:
        print(f"{folder}: no page is there")
        return 1
    found = [f"{path}: loads {address}" for path in files for address in remote(path)]
    print("\n".join(found) or f"{folder}: {len(files)} pages and styles, none needs a network")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
