"""Take the pictures of pages: of the front to drag, from a built site, and of `quietarm explore`.

    python docs/screenshots.py build/site

Needs Chromium and what the tests need.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).parent / "images"


def drag(browser, site):
    """The page of the site's front, a fifth of the way along it, while the plain cycloid swings."""
    page = browser.new_page(viewport={"width": 1200, "height": 700}, reduced_motion="reduce")
    page.goto((site / "docs" / "front.html").resolve().as_uri())
    page.focus("#handle")
    for _ in range(11):
        page.keyboard.press("ArrowRight")
    page.evaluate("document.activeElement.blur()")
    page.locator(".cards").screenshot(path=IMAGES / "drag.png")


def explore(browser):
    """The page of `quietarm explore` with a front, and a plan within its box."""
    line = [sys.executable, "-m", "quietarm", "explore", "--no-browser"]
    server = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
    try:
        address = server.stdout.readline().strip()
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.goto(address)
        page.get_by_label("largest |a_n|").fill("0.2")
        page.get_by_label("largest |a_n|").press("Enter")
        page.get_by_role("button", name="Front", exact=True).click()
        page.get_by_text(re.compile("click near the front")).wait_for(timeout=120_000)
        page.get_by_role("button", name="Plan", exact=True).click()
        page.get_by_text("found a local optimum").wait_for(timeout=120_000)
        page.wait_for_timeout(1300)
        page.screenshot(path=IMAGES / "explore.png", full_page=True)
    finally:
        server.terminate()
        server.communicate()


def main(site):
    """Take both with this machine's Chromium."""
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium)
        drag(browser, site)
        explore(browser)
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
