"""Slides on a wall: how much of each is used, and what of it is cut, in headless Chromium."""

import shutil
from typing import NamedTuple

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
SIZE = {"width": 1280, "height": 720}

MEASURE = """async () => {
    Reveal.configure({transition: "none", backgroundTransition: "none"});
    document.head.insertAdjacentHTML("beforeend", "<style>* { transition: none !important; }</style>");
    const shown = [];
    for (const slide of Reveal.getSlides()) {
        const {h, v} = Reveal.getIndices(slide);
        const last = slide.querySelectorAll(".fragment").length - 1;
        Reveal.slide(h, v, last);
        await fit({currentSlide: slide});
        await new Promise(requestAnimationFrame);
        const wall = {width: innerWidth, height: innerHeight};
        const parts = [...slide.querySelectorAll("*")].filter((part) =>
            part.checkVisibility({visibilityProperty: true}) && !part.closest("aside.notes, math, svg")
            && !part.closest("details:not([open]) > :not(summary)"));
        const leaves = parts.filter((part) => part.matches("img, svg, pre, video, canvas, math, iframe, table")
            || [...part.childNodes].some((node) => node.nodeType == 3 && node.data.trim()));
        const boxes = leaves.map((part) => part.getBoundingClientRect())
            .filter((box) => box.width && box.height);
        const cut = parts.filter((part) => {
            const {overflowX, overflowY} = getComputedStyle(part);
            return overflowX != "visible" && part.scrollWidth > part.clientWidth + 2
                || overflowY != "visible" && part.scrollHeight > part.clientHeight + 2;
        }).map((part) => `${part.tagName} ${part.className} ${part.scrollWidth}x${part.scrollHeight} in ${part.clientWidth}x${part.clientHeight}`);
        const bottom = Math.max(0, ...boxes.map((box) => box.bottom));
        const right = Math.max(0, ...boxes.map((box) => box.right));
        // lines of the wall that something covers
        const rows = new Uint8Array(wall.height);
        for (const box of boxes)
            rows.fill(1, Math.max(0, Math.floor(box.top)), Math.max(0, Math.min(wall.height, Math.ceil(box.bottom))));
        shown.push({
            place: `${h}/${v || 0}`,
            begins: (slide.querySelector("h1, h2, h3, strong") ?? slide).innerText.trim().slice(0, 60),
            used: rows.reduce((sum, row) => sum + row, 0) / wall.height,
            zoom: Number(slide.style.zoom),
            cut: cut,
            beyond: Math.max(0, bottom - wall.height, right - wall.width),
        });
    }
    return shown;
}"""


class Slide(NamedTuple):
    """A slide as it is on the wall, with everything shown."""

    place: str
    begins: str
    used: float
    """Share of the wall's height that something covers."""
    zoom: float
    cut: list
    """What has more content than is seen of it."""
    beyond: float
    """Pixels by which something leaves the wall."""


def measured(browser, file):
    """Measure every slide of a file."""
    page = browser.new_page(viewport=SIZE)
    page.goto(file.resolve().as_uri())
    page.wait_for_function("Reveal.isReady()")
    slides = [Slide(**slide) for slide in page.evaluate(MEASURE)]
    page.close()
    return slides
