"""The page in headless Chromium, by itself or alive; without one here it is not tested."""

import shutil

import pytest

try:
    from playwright import sync_api as api
except ImportError:  # of the extra `slow`
    api = None
CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
IN_CHROMIUM = [
    pytest.mark.slow,
    pytest.mark.skipif(not (api and CHROMIUM), reason="there is no Chromium or driver here"),
]
GUARD = 240
"""Seconds after which what does not come has hung, on any machine."""
if api:
    api.expect.set_options(1e3 * GUARD)
DESK = {"viewport": {"width": 1400, "height": 900}}
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}

# Of every picture the words that are cut, that other words cover, or that a curve or a mark
# crosses; lines of a grid are behind the words, which have a halo.
CROSSED = """() => {
    const boxOf = (element) => {
        const {left, right, top, bottom} = element.getBoundingClientRect();
        return {left, right, top: top + 2.5, bottom: bottom - 2.5};
    };
    const overlap = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
        && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
    const isSeen = (line) => {
        const {stroke, fill} = getComputedStyle(line);
        const shows = (paint) => !["none", "transparent", "rgba(0, 0, 0, 0)"].includes(paint);
        return line.getTotalLength() > 0 && line.getAttribute("stroke") !== "var(--grid)"
            && (shows(stroke) || shows(fill));
    };
    const faults = [];
    for (const svg of document.querySelectorAll("main svg")) {
        const texts = [...svg.querySelectorAll("text")].filter(({textContent}) => textContent);
        const boxes = texts.map(boxOf);
        boxes.forEach((box, k) => {
            const words = texts[k].textContent;
            if (box.left < 0 || box.right > innerWidth) faults.push([words, "cut"]);
            boxes.slice(0, k).forEach((other, n) => {
                if (overlap(box, other)) faults.push([words, texts[n].textContent]);
            });
        });
        for (const line of [...svg.querySelectorAll("path, line, circle")].filter(isSeen)) {
            const matrix = line.getScreenCTM();
            const length = line.getTotalLength();
            for (let at = 0; at <= length; at += 4) {
                const {x, y} = line.getPointAtLength(at).matrixTransform(matrix);
                const crossed = boxes.findIndex(({left, right, top, bottom}) =>
                    left < x && x < right && top < y && y < bottom);
                if (crossed >= 0) {
                    faults.push([texts[crossed].textContent, line.outerHTML.slice(0, 90)]);
                    break;
                }
            }
        }
    }
    return faults;
}"""


@pytest.fixture(scope="module")
def chromium():
    """A browser for the tests of a file."""
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM)
        yield browser
        browser.close()


@pytest.fixture
def open_page(chromium):
    """Open an address; at the end its page has said nothing, failed nowhere, asked nobody else."""
    contexts = []
    wrong = []
    admitted = ["file:", "data:", "blob:"]

    def open_at(address, **options):
        admitted.append(address)
        contexts.append(chromium.new_context(**options))
        page = contexts[-1].new_page()
        page.set_default_timeout(1e3 * GUARD)
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda request: wrong.append(request.url))
        page.goto(address)
        return page

    yield open_at
    assert [words for words in wrong if not words.startswith(tuple(admitted))] == []
    for context in contexts:
        context.close()


def still(page, time=1.0):
    """Stop the clock at a time."""
    api.expect(page.locator("#clock")).not_to_be_empty()
    page.evaluate("time => { play(false); seek(time); }", time)


def arm(page):
    """Return what is drawn of the structure."""
    return page.evaluate(
        "[...document.querySelectorAll('#scene path')].map(x => x.outerHTML).join()"
    )


def curves(page):
    """Return what is drawn over time."""
    return page.evaluate(
        "[...document.querySelectorAll('#panels path')].map(x => x.outerHTML).join()"
    )


def knob(page):
    """The middle of the ring."""
    box = page.locator("#handle .knob").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def number(page):
    """The number of the point that is chosen, from 1."""
    return int(page.get_attribute("#handle", "aria-valuenow"))


def swipe(page, x, y, across, up):
    """Drag a finger over a phone."""
    finger = page.context.new_cdp_session(page)
    points = [{"x": x + across * k / 12, "y": y - up * k / 12} for k in range(13)]
    finger.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": points[:1]})
    for point in points[1:]:
        finger.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": [point]})
        page.wait_for_timeout(16)
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
