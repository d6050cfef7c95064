"""The page to drag along a front, in headless Chromium; without one here it is not tested."""

import json
from contextlib import suppress
from math import pi
from pathlib import Path

import numpy as np
import pytest
from in_browser import (
    CROSSED,
    DESK,
    IN_CHROMIUM,
    PHONE,
    api,
    arm,
    curves,
    knob,
    number,
    still,
    swipe,
)

from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import PointToPoint, epsilon_front, evaluate_coefficients
from quietarm.studies.reproduce.paper import paper_points
from quietarm.views import trade_off

pytestmark = IN_CHROMIUM


@pytest.fixture(scope="module")
def fronts():
    link = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8, torque_limit=0.2)
    arm = PointToPoint(ArmOnFlexibleLink(), pi / 2, 0.8)
    return {
        "link": epsilon_front(link, bound=0.2, points=12),
        "arm": epsilon_front(arm, bound=0.5, points=8),
    }


@pytest.fixture(scope="module")
def file(fronts, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "front.html"
    trade_off(fronts, known_points=paper_points).save(path)
    return path


@pytest.fixture
def opened(open_page, file):
    """Open the page, or one around it."""

    def at(address=None, **options):
        return open_page(address or file.as_uri(), **options)

    return at


def test_the_mouse_drags_along_the_front_and_the_arm_follows(opened):
    page = opened(**DESK)
    still(page)
    before = arm(page), curves(page), page.inner_text("#sentence")
    x, y = knob(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 120, y + 30, steps=12)
    page.mouse.up()
    assert number(page) > 4
    after = arm(page), curves(page), page.inner_text("#sentence")
    assert all(then != now for then, now in zip(before, after, strict=True))
    assert "of residual vibration saves" in after[2]
    # a click beside the front takes the nearest point
    now = number(page)
    page.mouse.click(x + 5, y + 60)
    assert number(page) < now


def test_keys_reach_every_point_and_show_the_figures_of_the_front(opened, fronts):
    page = opened(**DESK)
    still(page)
    for place, front in enumerate(fronts.values()):
        page.locator("#moves input").nth(place).check(force=True)
        page.focus("#handle")
        page.keyboard.press("Home")
        for point in front.points:
            residual, energy, *_ = page.locator("#figures td.plan").all_inner_texts()
            if point.residual < 1e-6:
                assert residual == "at rest"
            else:
                assert float(residual) == pytest.approx(1e3 * point.residual, rel=5e-4)
            assert float(energy) == pytest.approx(point.energy, rel=5e-4)
            spoken = page.get_attribute("#handle", "aria-valuetext")
            assert f"{point.energy:#.3g} J" in spoken
            page.keyboard.press("ArrowRight")
        assert number(page) == len(front.points)
        page.keyboard.press("PageUp")
        assert number(page) == len(front.points) - 5
    page.keyboard.press("Space")
    assert page.inner_text("#play") == "Pause"


def test_the_structure_is_drawn_where_the_motion_has_it(opened, fronts):
    page = opened(**DESK)
    still(page)
    for place, front in enumerate(fronts.values()):
        page.locator("#moves input").nth(place).check(force=True)
        page.focus("#handle")
        page.keyboard.press("End")
        scale = page.inner_text("#view").split()[-1]
        factor = 1.0 if scale == "scale" else float(scale)
        plan = evaluate_coefficients(front.task, front.points[-1].coefficients)
        for time in (0.13, 0.4, 0.77, 1.3):
            page.evaluate("time => seek(time)", time)
            drawn = page.evaluate("[...coordinatesAt(ofChosen(state.move.scores), state.time)]")
            sample = plan.sampled([time])
            bodies = front.task.plant.structure(
                float(sample.joint[0, 0]), (factor * sample.tips[0]).tolist()
            )
            points = np.vstack([body.points for body in bodies])
            same = np.array(drawn).reshape(-1, 2)[: len(points)]
            assert same == pytest.approx(points, abs=1.5e-3)


def test_a_finger_drags_scrolls_and_taps_on_a_phone_of_390_pixels(opened):
    page = opened(**PHONE, color_scheme="dark")
    still(page)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    before = arm(page)
    swipe(page, *knob(page), 90, -15)
    dragged = number(page)
    assert dragged > 4
    assert arm(page) != before
    box = page.locator("#front").bounding_box()
    x, y = box["x"] + 0.7 * box["width"], box["y"] + 0.6 * box["height"]
    swipe(page, x, y, 0, 150)
    page.wait_for_function("scrollY > 50")
    assert number(page) == dragged
    page.evaluate("scrollTo(0, 0)")
    page.touchscreen.tap(box["x"] + 60, y)
    assert number(page) != dragged


@pytest.mark.parametrize("width", [320, 390, 736, 1000])
def test_nothing_is_wider_than_the_page(opened, width):
    page = opened(viewport={"width": width, "height": 800})
    still(page)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    # nor does it jump when the motion arrives or another is chosen
    for place in range(2):
        page.locator("#moves input").nth(place).check(force=True)
        heights = set()
        for key in ("Home", "ArrowRight", "End"):
            page.focus("#handle")
            page.keyboard.press(key)
            for time in (0.4, 1.2):
                page.evaluate("time => seek(time)", time)
                heights.add(page.evaluate("document.documentElement.scrollHeight"))
        assert len(heights) == 1


def test_it_plays_by_itself_and_not_where_stillness_is_asked_for(opened):
    page = opened(**DESK)
    api.expect(page.locator("#play")).to_have_text("Pause")
    page.wait_for_function("state.time > 0.1")
    page.click("#play")
    time = page.evaluate("state.time")
    page.evaluate("new Promise(requestAnimationFrame)")
    assert page.evaluate("state.time") == time
    calm = opened(**DESK, reduced_motion="reduce")
    api.expect(calm.locator("#play")).to_have_text("Play")
    shown = calm.evaluate("state.time")
    assert shown > 0.8  # after arrival, where a change of the motion is seen
    calm.wait_for_timeout(300)
    assert calm.evaluate("state.time") == shown


def test_the_curves_over_time_set_the_clock(opened):
    page = opened(**DESK)
    still(page, 0.2)
    box = page.locator("#panels svg").nth(1).bounding_box()
    before = arm(page)
    page.mouse.click(box["x"] + 0.7 * box["width"], box["y"] + 0.5 * box["height"])
    assert 1.0 < page.evaluate("state.time") < 1.8
    assert arm(page) != before


def test_in_a_frame_it_takes_the_colours_of_the_page_around_it(opened, file, tmp_path):
    around = tmp_path / "around.html"
    around.write_text(
        '<!doctype html><link rel="icon" href="data:,"><script>heights = [];'
        'addEventListener("message", ({data}) => heights.push(data.quietarm.height));</script>'
        f'<iframe src="{file.as_uri()}" width="736" height="800"></iframe>'
    )
    page = opened(around.as_uri(), **DESK, color_scheme="light")
    page.wait_for_function("heights.length > 0")
    assert 500 < page.evaluate("heights.at(-1)") < 1200
    frame = page.frames[1]
    colour = "getComputedStyle(document.querySelector('.card')).backgroundColor"
    assert frame.evaluate(colour) == "rgb(255, 255, 255)"
    for theme, dark in (("dark", True), ("light", False), ("auto", False)):
        page.evaluate(f"frames[0].postMessage({json.dumps({'quietarm': {'theme': theme}})}, '*')")
        same = "===" if not dark else "!=="
        frame.wait_for_function(f"{colour} {same} 'rgb(255, 255, 255)'")
    # messages of others are no news
    page.evaluate("frames[0].postMessage('hello', '*'); frames[0].postMessage(null, '*')")


def press_until(page, key, happens):
    """Press a key again, as a user does, where a busy browser has lost it."""
    for _ in range(20):
        page.keyboard.press(key)
        with suppress(api.TimeoutError):
            page.wait_for_function(happens, timeout=5000)
            return
    raise AssertionError(f"{key} does not lead to {happens}")


def test_arrow_keys_reach_a_frame_in_sight_and_up_and_down_scroll_the_page_around(
    opened, file, tmp_path
):
    around = tmp_path / "around.html"
    script = (Path(__file__).parents[3] / "docs" / "_static" / "front.js").as_uri()
    around.write_text(
        '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">'
        '<input value="words"><iframe width="100%" height="800"></iframe>'
        f'<div style="height: 3000px"></div><script src="{script}"></script>'
        f'<script>document.querySelector("iframe").src = "{file.as_uri()}";</script>'
    )
    page = opened(around.as_uri(), **DESK, reduced_motion="reduce")
    frame = page.frame_locator("iframe")
    handle = frame.locator("#handle")
    api.expect(frame.locator("#clock")).not_to_be_empty()

    def stands_at(point):
        api.expect(handle).to_have_attribute("aria-valuenow", str(point))

    api.expect(frame.locator("#spot")).to_have_text("drag, or use the arrow keys")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    stands_at(3)
    ring = "getComputedStyle(document.querySelector('.ring')).stroke"
    ink = "getComputedStyle(document.querySelector('.card')).color"
    # one sees where the keys go
    assert page.frames[1].evaluate(ring) == page.frames[1].evaluate(ink)
    press_until(page, "ArrowDown", "scrollY > 0")
    stands_at(3)
    # who writes keeps the keys
    page.focus("input")
    page.keyboard.press("ArrowRight")
    # after a click into the frame it has the keys itself, but for those that scroll
    box = frame.locator("#front").bounding_box()
    page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + 0.5 * box["height"])
    now = int(handle.get_attribute("aria-valuenow"))
    assert now > 5
    page.keyboard.press("ArrowLeft")
    stands_at(now - 1)
    before = page.evaluate("scrollY")
    press_until(page, "PageDown", f"scrollY > {before} + 100")
    stands_at(now - 1)
    # out of sight nothing moves
    page.evaluate("document.activeElement.blur(); scrollTo(0, 2000)")
    page.mouse.move(5, 5)
    page.keyboard.press("ArrowRight")
    page.evaluate("new Promise(requestAnimationFrame)")
    stands_at(now - 1)


def test_left_and_right_choose_without_a_click_and_leave_the_sliders_their_keys(opened):
    page = opened(**DESK)
    still(page)
    page.keyboard.press("ArrowRight")
    assert number(page) == 2
    page.focus("#time")
    before = page.evaluate("state.time")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("state.time") > before
    assert number(page) == 2


BOXES = """() => {
    const boxes = (where) => [...document.querySelectorAll(where)].map((element) => {
        const {left, right, top, bottom} = element.getBoundingClientRect();
        return [element.textContent, {left, right, top, bottom}];
    });
    return [boxes("#front text:not(:empty)"), boxes("#plot path[transform], #handle .knob")];
}"""


def common(a, b):
    across = min(a["right"], b["right"]) - max(a["left"], b["left"])
    along = min(a["bottom"], b["bottom"]) - max(a["top"], b["top"])
    return max(0, across) * max(0, along)


@pytest.mark.parametrize("options", [DESK, PHONE], ids=["desk", "phone"])
def test_words_on_the_front_cross_no_mark_and_no_other_words(opened, fronts, options):
    page = opened(**options)
    still(page)
    for place, front in enumerate(fronts.values()):
        page.locator("#moves input").nth(place).check(force=True)
        page.evaluate("chooseBy('Home')")
        for _ in front.points:
            words, marks = page.evaluate(BOXES)
            for k, (text, box) in enumerate(words):
                for other, around in [*words[k + 1 :], *marks]:
                    assert common(box, around) < 8, (text, other)
            page.evaluate("chooseBy('ArrowRight')")


def test_the_axis_ends_beyond_all_marks_and_the_key_has_the_marks_of_the_front(opened, fronts):
    page = opened(**DESK)
    still(page)
    for place in range(len(fronts)):
        page.locator("#moves input").nth(place).check(force=True)
        inside = page.evaluate(
            "[...document.querySelectorAll('#plot path[transform]')].every((mark) => {"
            "const {e, f} = mark.transform.baseVal.consolidate().matrix;"
            "const {left, right, top, bottom} = front.box;"
            "return left <= e && e <= right + 1 && top - 1 <= f && f <= bottom; })"
        )
        assert inside
        drawn, named = (
            page.evaluate(
                "where => [...new Set([...document.querySelectorAll(where)].map((mark) => "
                "mark.getAttribute('d') + mark.getAttribute('fill')))].sort()", where,
            )
            for where in ("#plot path[transform]", "#key path[transform]")
        )  # fmt: skip
        assert drawn == named
    key = page.inner_text("#key")
    assert "gradient (epsilon constraint)" in key
    assert "the paper's best (6 terms)" in key


@pytest.mark.parametrize("options", [DESK, PHONE], ids=["desk", "phone"])
def test_nothing_crosses_the_words_of_a_picture(opened, fronts, options):
    page = opened(**options)
    still(page, 0.48)
    for place, front in enumerate(fronts.values()):
        page.locator("#moves input").nth(place).check(force=True)
        for share in (0.0, 0.1, 0.5, 1.0):
            page.evaluate("number => choose(number)", round(share * (len(front.points) - 1)))
            assert page.evaluate(CROSSED) == []
    # and the check sees a curve where one crosses a word
    page.evaluate("panels[0].svg.querySelector('text').setAttribute('y', panels[0].box.y(0))")
    page.evaluate("panels[0].svg.querySelector('text').setAttribute('x', panels[0].box.right)")
    assert page.evaluate(CROSSED) != []


def test_front_and_arm_are_in_sight_together_on_a_phone(opened, fronts):
    page = opened(**PHONE)
    still(page)
    for place in range(len(fronts)):
        page.locator("#moves input").nth(place).check(force=True)
        page.evaluate("scrollTo(0, 0)")
        scene = page.locator("#scene").bounding_box()
        front = page.locator("#front").bounding_box()
        # without a scroll, and the arm is above the finger
        assert 0 < scene["y"] < scene["y"] + scene["height"] < front["y"]
        assert front["y"] + front["height"] < PHONE["viewport"]["height"]
        # below 272 pixels of the site's first page the ring is within 800
        ring = page.locator("#handle .ring").bounding_box()
        above = page.locator("#invitation").bounding_box()["y"]
        assert ring["y"] + ring["height"] - above < 800 - 272
        assert not page.locator(".keys").is_visible()
        # a browser with its bars shows 664 of 844 pixels
        assert front["y"] + front["height"] - scene["y"] < 600


def test_two_presses_of_tab_and_enter_lead_from_the_start_of_a_site_to_the_ring(
    opened, file, tmp_path
):
    script = (Path(__file__).parents[3] / "docs" / "_static" / "front.js").as_uri()
    around = tmp_path / "around.html"
    around.write_text(
        '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">'
        '<a class="skip-to-content" href="#content">Skip to content</a>'
        f'{50 * "<a href=x>page</a> "}<p id="content"></p>'
        f'<iframe width="100%" height="800" src="{file.as_uri()}"></iframe>'
        f'<script src="{script}"></script>'
    )
    page = opened(around.as_uri(), **DESK, reduced_motion="reduce")
    frame = page.frame_locator("iframe")
    api.expect(frame.locator("#clock")).not_to_be_empty()
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Skip to the front to drag"
    page.keyboard.press("Enter")
    handle = frame.locator("#handle")
    api.expect(handle).to_be_focused()
    # one sees where the keys go
    api.expect(frame.locator("#handle.keyed")).to_have_count(1)
    page.keyboard.press("End")
    api.expect(handle).to_have_attribute("aria-valuenow", "12")
