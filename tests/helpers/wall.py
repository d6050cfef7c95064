"""Slides on a wall: how much of each is used, and what of it is cut, in headless Chromium."""

import shutil
from typing import NamedTuple

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
SIZE = {"width": 1280, "height": 720}

MEASURE = """async () => {
    const still = "<style>* { transition: none !important; }</style>";
    document.head.insertAdjacentHTML("beforeend", still);
    Reveal.configure({transition: "none", backgroundTransition: "none"});

    // what is seen of a slide: not its notes, not what is folded, equations as a whole
    const isSeen = (part) => part.checkVisibility({visibilityProperty: true})
        && !part.closest("aside.notes, svg")
        && !part.parentElement.closest("math")
        && !part.closest("details:not([open]) > :not(summary)");
    const fills = (part) => part.matches("img, svg, pre, video, canvas, math, iframe, table")
        || [...part.childNodes].some((node) => node.nodeType == 3 && node.data.trim());
    const isCut = (part) => {
        const {overflowX, overflowY} = getComputedStyle(part);
        return overflowX != "visible" && part.scrollWidth > part.clientWidth + 2
            || overflowY != "visible" && part.scrollHeight > part.clientHeight + 2;
    };
    const rowsCovered = (boxes) => {
        const rows = new Uint8Array(innerHeight);
        for (const {top, bottom} of boxes) {
            const [from, to] = [Math.floor(top), Math.ceil(bottom)];
            rows.fill(1, Math.max(0, from), Math.max(0, Math.min(innerHeight, to)));
        }
        return rows.reduce((sum, row) => sum + row, 0);
    };

    const measured = [];
    for (const slide of Reveal.getSlides()) {
        const {h, v} = Reveal.getIndices(slide);
        Reveal.slide(h, v, slide.querySelectorAll(".fragment").length - 1);
        await fit({currentSlide: slide});
        await new Promise(requestAnimationFrame);
        const seen = [...slide.querySelectorAll("*")].filter(isSeen);
        const boxes = seen.filter(fills).map((part) => part.getBoundingClientRect())
            .filter((box) => box.width && box.height);
        const bottom = Math.max(0, ...boxes.map((box) => box.bottom));
        const right = Math.max(0, ...boxes.map((box) => box.right));
        const title = slide.querySelector("h1, h2, h3, strong") ?? slide;
        measured.push({
            place: `${h}/${v || 0}`,
            begins: title.innerText.trim().slice(0, 60),
            used: rowsCovered(boxes) / innerHeight,
            zoom: Number(slide.style.zoom),
            cut: seen.filter(isCut).map((part) => `${part.tagName} ${part.className}`),
            beyond: Math.max(0, bottom - innerHeight, right - innerWidth),
        });
    }
    return measured;
}"""


class Slide(NamedTuple):
    """A slide as it is on the wall, with everything shown."""

    place: str
    begins: str
    used: float
    """Share of the wall's height that something covers."""
    zoom: float
    """By how much the slide is larger, or smaller, than it was written."""
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
