"""`python -m benchmarks.explorer`: how fast the explorer follows a drag of ν_s, in Chromium.

A page of the paper's study is opened without a network. ν_s goes through its range in small steps,
one in each frame, as a hand on the slider does; each frame integrates 105 mesh periods, draws all
pictures and writes the numbers.
"""

import shutil
import statistics
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

PAGE = Path("results/paper/report/explorer.html")
VARIANTS = ("c-lubricant", "c-material", "g-both", "a-conservative")
FRAMES = 200

DRAG = f"""
async () => {{
  const slider = document.getElementById("nu"), [low, high] = [+slider.min, +slider.max];
  const spent = [];
  for (let i = 0; i < {FRAMES}; i++) {{
    slider.value = low + (high - low) * i / {FRAMES};
    const start = performance.now();
    slider.dispatchEvent(new Event("input"));
    await new Promise(requestAnimationFrame);
    spent.push(performance.now() - start);
  }}
  return spent;
}}
"""


def frames(page: Page, variant: str) -> list[float]:
    """Return the milliseconds of each frame while ν_s is dragged."""
    page.select_option("#variant", variant)
    page.evaluate(DRAG)  # once to let the browser compile the scripts
    return page.evaluate(DRAG)


def main() -> int:
    """Measure and print."""
    chromium = shutil.which("chromium")
    if chromium is None or not PAGE.exists():
        print(f"benchmarks: needs Chromium and {PAGE}, which 'make reproduce' writes")
        return 2
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_context(offline=True).new_page()
        page.goto(PAGE.resolve().as_uri())
        print(f"{PAGE.stat().st_size / 1e6:.2f} MB")
        for variant in VARIANTS:
            spent = frames(page, variant)
            median, slow = statistics.median(spent), statistics.quantiles(spent, n=20)[-1]
            print(f"{variant}: {1e3 / median:.0f} frames a second; 95 % within {slow:.0f} ms")
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
