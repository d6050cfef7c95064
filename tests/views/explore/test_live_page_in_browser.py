"""The page alive in headless Chromium; without one on this machine it is not tested."""

import re
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager

import pytest
from hostile import NAMES, Hostile
from in_browser import (
    CROSSED,
    DESK,
    GUARD,
    IN_CHROMIUM,
    PHONE,
    api,
    arm,
    curves,
    number,
    still,
    swipe,
)

import quietarm as qa
from quietarm.ocp.escapes import one_line
from quietarm.views.explore.by_hand import MoveByHand
from quietarm.views.explore.live_page import LivePage
from quietarm.views.explore.server import Desk, Listener

pytestmark = IN_CHROMIUM
CALM = {"reduced_motion": "reduce"}


@contextmanager
def explore(*words):
    """The address of the page, until Ctrl-C."""
    line = [sys.executable, "-W", "error", "-m", "quietarm", "explore", "--no-browser", *words]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        said, how_to_end = process.stdout.readline(), process.stdout.readline()
        assert how_to_end == "Ctrl-C ends it\n"
        yield said.strip()
        process.send_signal(signal.SIGINT)
        assert (*process.communicate(timeout=GUARD), process.returncode) == ("", "", 0)
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def address():
    with explore() as place:
        yield place


@pytest.fixture
def opened(open_page, address):
    """Open the page; its figures are there."""

    def at(**options):
        page = open_page(address, **{**CALM, **options})
        has(page, "move", "single-link, 0 to 30 deg in 0.8 s")
        becomes(page, "robustness.now !== null")
        return page

    return at


def has(page, name, words):
    """Wait until one of all figures has some words."""
    row = page.locator("#rows div").filter(has=page.locator(f"dt:text-is('{name}')"))
    api.expect(row).to_contain_text(words)


def becomes(page, what):
    """Wait until something holds; the page itself may not evaluate strings, so not within it."""
    for _ in range(20 * GUARD):
        if page.evaluate(what):
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"it does not become {what}")


def energy(page):
    return float(page.locator("#figures td.plan").nth(1).inner_text())


def press(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def slider(page, name):
    return page.locator(f"input[type=range][aria-label={name}]")


def field(page, name):
    return page.locator(f'input[type=number][aria-label="{name}"]')


def plan(page):
    press(page, "Plan")
    has(page, "status", "The solver found a local optimum.")


def test_slider_gradient_and_menu_change_the_motion(opened):
    page = opened(**DESK)
    first = energy(page), arm(page), curves(page)
    assert first[0] == pytest.approx(0.0911, abs=5e-5)  # README
    slider(page, "a2").press("ArrowLeft")
    has(page, "coefficients", "0, -0.0001, 0")
    assert energy(page) < first[0]
    plan(page)
    assert energy(page) == pytest.approx(0.0237, abs=5e-5)  # README
    assert all(then != now for then, now in zip(first[1:], (arm(page), curves(page)), strict=True))
    assert float(field(page, "a6").input_value()) < -1
    press(page, "Plain cycloid")
    has(page, "coefficients", "0, 0, 0, 0, 0, 0")
    assert energy(page) == first[0]
    page.get_by_label("plant").select_option("dual-link")
    has(page, "move", "dual-link, 0 to 30 deg")
    field(page, "duration [s]").fill("1.5")
    field(page, "duration [s]").press("Enter")
    has(page, "move", "dual-link, 0 to 30 deg in 1.5 s")
    assert page.evaluate("state.move.duration") == 1.5


def test_from_the_start_the_motion_is_beside_the_front_and_a_curve_is_kept(opened):
    page = opened(**DESK)
    still(page)
    (point,) = page.evaluate("state.move.points")
    # README: 77 mm and 0.0911 J
    assert (point["residual"], point["energy"]) == (
        pytest.approx(0.0771, abs=5e-5),
        pytest.approx(0.0911, abs=5e-5),
    )
    assert "this is the plain cycloid itself" in page.inner_text("#sentence")
    # the front of the first move is there before anything is set
    becomes(page, "state.front !== null")
    assert page.evaluate("isByHand() && state.front.points.length > 10")
    press(page, "Keep curve")
    slider(page, "a2").press("ArrowLeft")
    has(page, "coefficients", "0, -0.0001, 0")
    assert "the curve that was kept" in page.inner_text("#key")
    # docs/pictures.md: what is kept has a colour without a meaning, and dashes
    kept = '#panels path[stroke="var(--other-0)"]'
    assert page.locator(f"{kept}[stroke-dasharray]").count() == 2 * 7 + 1
    press(page, "Drop curve")
    assert page.locator(kept).count() == 0
    assert "kept" not in page.inner_text("#key")


def test_with_the_shift_key_a_slider_goes_a_tenth_as_far(opened):
    page = opened(**DESK)

    def drag(across):
        box = slider(page, "a2").bounding_box()
        before = float(field(page, "a2").input_value())
        # the thumb of Chromium is 16 pixels wide
        share = (before + 0.2) / 0.4
        x, y = box["x"] + 8 + share * (box["width"] - 16), box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + across, y, steps=10)
        page.mouse.up()
        return float(field(page, "a2").input_value()) - before

    coarse = drag(-40)
    # the box of the paper, from -0.2 to 0.2, is some 150 pixels wide
    assert -0.15 < coarse < -0.06
    page.keyboard.down("Shift")
    fine = drag(-40)
    page.keyboard.up("Shift")
    assert fine == pytest.approx(coarse / 10, abs=1e-3)


def test_a_hundred_moves_of_a_slider_end_where_the_last_one_is(opened):
    page = opened(**DESK)
    for _ in range(100):
        slider(page, "a2").press("ArrowLeft")
    has(page, "coefficients", "0, -0.01, 0")
    becomes(page, "!isAsking")
    assert field(page, "a2").input_value() == "-0.01"


def test_profile_terms_and_limits_are_set(opened):
    page = opened(**DESK)
    still(page)
    page.get_by_label("profile").select_option("spline")
    has(page, "profile", "cycloid-spline of 6 control points")
    page.get_by_label("terms").fill("8")
    page.get_by_label("terms").press("Enter")
    api.expect(field(page, "a8")).to_be_visible()
    plan(page)
    page.locator("#limits summary").click()
    field(page, "torque [N m]").fill("0.2")
    field(page, "torque [N m]").press("Enter")
    has(page, "limits", "torque 0.2 N m")
    # a limit that a motion comes near is dotted
    torque = page.locator("#panels > div").nth(1)
    assert torque.locator('line[stroke="var(--limit)"]').count() == 3  # two, and the key
    field(page, "torque [N m]").fill("")
    field(page, "torque [N m]").press("Enter")
    api.expect(torque.locator('line[stroke="var(--limit)"]')).to_have_count(0)


def test_a_motion_that_is_none_is_said_in_a_line_and_the_next_one_is_shown(opened):
    page = opened(**DESK)
    before = curves(page)
    field(page, "target [deg]").fill("0")
    field(page, "target [deg]").press("Enter")
    api.expect(page.locator("#said.wrong")).to_contain_text("there is no move")
    assert curves(page) == before
    field(page, "target [deg]").fill("20")
    field(page, "target [deg]").press("Enter")
    has(page, "move", "0 to 20 deg")
    api.expect(page.locator("#said")).to_have_text("")
    page.locator("#limits summary").click()
    field(page, "torque [N m]").fill("0.001")
    field(page, "torque [N m]").press("Enter")
    press(page, "Plan")
    api.expect(page.locator("#said.wrong")).to_contain_text("feasible with all else unchanged")
    api.expect(slider(page, "a2")).to_be_enabled()


def test_the_ring_is_dragged_along_the_front_and_files_are_saved(opened):
    page = opened(**DESK)
    press(page, "Front")
    api.expect(page.locator("#said")).to_have_text("drag the ring along the front")
    # the motion in hand is beside the front still
    assert page.evaluate("isByHand()")
    x, y = page.evaluate("placeOf(state.front.points[10])")
    box = page.locator("#front").bounding_box()
    page.mouse.click(box["x"] + x + 1, box["y"] + y - 20)  # near it
    assert not page.evaluate("isByHand()")
    chosen = number(page)
    assert 8 < chosen < 14
    has(page, "status", "a point of the front")
    coefficients = page.evaluate(f"state.front.coefficients[{chosen - 1}]")
    assert float(field(page, "a2").input_value()) == pytest.approx(coefficients[1], rel=1e-4)
    page.keyboard.press("ArrowRight")
    assert number(page) == chosen + 1
    has(page, "peak jerk", "enter what the drive can do under Limits")
    # by hand it leaves the front, which stays where it is
    slider(page, "a2").press("ArrowLeft")
    becomes(page, "isByHand()")
    assert page.evaluate("state.front !== null")
    begins = {"plan.json": '{\n  "format": "quietarm-plan"', "move.csv": "time_s,"}
    begins |= dict.fromkeys(("move.c", "move.h"), "/* move: ")
    page.locator("#download summary").click()
    for name in (*begins, "move.h"):  # the last one twice
        with page.expect_download() as download:
            press(page, name)
        assert download.value.suggested_filename == name
        assert download.value.path().read_text().startswith(begins[name])
    # another move has another front
    field(page, "duration [s]").fill("0.9")
    field(page, "duration [s]").press("Enter")
    becomes(page, "state.front === null")


def test_it_plays_by_itself_and_not_where_stillness_is_asked_for(opened):
    page = opened(**DESK, reduced_motion="no-preference")
    becomes(page, "state.time > 0.1")
    slider(page, "a2").press("ArrowLeft")  # and goes on when another motion is shown
    becomes(page, "state.point === 0 && state.playing && state.time > 0.3")
    calm = opened(**DESK)
    shown = calm.evaluate("state.time")
    assert shown > 0.8  # after arrival, where a change of the motion is seen
    slider(calm, "a2").press("ArrowLeft")
    has(calm, "coefficients", "0, -0.0001, 0")
    assert calm.evaluate("state.time") == shown


def test_on_a_phone_a_finger_sets_a_slider_with_the_arm_in_sight(opened):
    page = opened(**PHONE, color_scheme="dark")
    handle = slider(page, "a2")
    handle.evaluate("range => range.scrollIntoView()")
    becomes(page, "scrollY > 200")
    box, scene = handle.bounding_box(), page.locator("#arm").bounding_box()
    assert scene["y"] == 0
    assert scene["height"] < box["y"] < 844 - box["height"]
    assert box["height"] >= 30
    before = arm(page)
    swipe(page, box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, -60, 0)
    becomes(page, "fields.get('a2').value < -0.02 && !isAsking")
    assert arm(page) != before


@pytest.mark.parametrize("width", [320, 390, 736, 1000, 1200])
def test_nothing_is_wider_than_the_page(opened, width):
    page = opened(viewport={"width": width, "height": 800})
    for summary in page.locator("#hand summary").all():
        summary.click()
    assert page.evaluate("document.documentElement.scrollWidth") == width
    plan(page)
    assert page.evaluate("document.documentElement.scrollWidth") == width


@pytest.mark.parametrize("options", [DESK, PHONE], ids=["desk", "phone"])
def test_nothing_crosses_the_words_of_a_picture(opened, options):
    page = opened(**options)
    still(page, 0.48)
    press(page, "Front")
    api.expect(page.locator("#said")).to_have_text("drag the ring along the front")
    plan(page)
    becomes(page, "robustness.now !== null && !isAsking")
    page.evaluate("scrollTo(0, 0)")
    assert page.evaluate(CROSSED) == []
    page.evaluate("choose(lastPoint())")
    assert page.evaluate(CROSSED) == []


def test_where_the_server_has_ended_the_page_says_so(chromium):
    with explore() as place:
        page = chromium.new_page()
        page.set_default_timeout(1e3 * GUARD)
        page.goto(place)
        has(page, "move", "single-link")
    slider(page, "a2").press("ArrowLeft")
    api.expect(page.locator("#said.wrong")).to_contain_text("start quietarm explore again")
    page.close()


def test_a_front_of_a_file_is_dragged_from_the_start(open_page, tmp_path):
    task = qa.PointToPoint(qa.SingleLinkManipulator(), qa.deg(30), 0.8)
    front = qa.epsilon_front(task, bound=0.2, points=6)
    front.save(tmp_path / "front.json")
    with explore(str(tmp_path / "front.json")) as place:
        page = open_page(place, **DESK, **CALM)
        has(page, "status", "a point of the front")
        page.focus("#handle")
        page.keyboard.press("End")
        assert number(page) == len(front.points)
        last = front.points[-1]
        assert energy(page) == pytest.approx(last.energy, rel=5e-4)
        shown = float(field(page, "a2").input_value())
        assert shown == pytest.approx(last.coefficients[1], rel=1e-4)
        has(page, "energy", f"{last.energy:.4g}"[:5])


def test_names_of_a_file_are_texts_on_the_page(open_page):
    motion = qa.evaluate_coefficients(qa.PointToPoint(Hostile(), 1.0, 1.0), [])
    desk = Desk(LivePage(MoveByHand.of_plan(motion)))
    stop = threading.Event()

    def work():
        while not stop.is_set():
            desk.work()

    with Listener(desk) as listener:
        threads = [threading.Thread(target=run) for run in (work, listener.serve_forever)]
        for thread in threads:
            thread.start()
        try:
            page = open_page(f"http://127.0.0.1:{listener.server_address[1]}/", **DESK, **CALM)
            has(page, "coefficients", "none: the plain cycloid")
            options = page.locator("#panels select").nth(0).locator("option").all_text_contents()
            assert len(options) == len(NAMES)
            assert page.locator("img, b[onclick], #hand b, #rows b, script[src]").count() == 0
            names = page.locator("#plant option").all_text_contents()
            assert one_line(Hostile().label) in names
        finally:
            stop.set()
            listener.shutdown()
            for thread in threads:
                thread.join()


def test_no_message_is_of_more_than_a_line(opened):
    page = opened(**DESK)
    field(page, "target [deg]").fill("0")
    field(page, "target [deg]").press("Enter")
    words = page.locator("#said.wrong")
    api.expect(words).not_to_be_empty()
    assert re.fullmatch(r"[^\n]+", words.text_content())
