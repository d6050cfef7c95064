"""The page of a robot in headless Chromium: in space, to be turned; not tested without one here."""

import numpy as np
import pytest
from in_browser import CROSSED, DESK, IN_CHROMIUM, PHONE, arm, number, still, swipe
from small_robots import ARM

import quietarm as qa
from quietarm.ocp import evaluate_coefficients
from quietarm.views import trade_off
from quietarm.views.pictures import Line
from quietarm.views.pictures.space import Camera, Room
from quietarm.views.pictures.structure import structures_of

pytestmark = IN_CHROMIUM
HOSTILE = "</script><img src=x onerror=alert(1)>"
"""A joint's name."""


@pytest.fixture(scope="module")
def plans():
    name = HOSTILE.replace("<", "&lt;").replace(">", "&gt;")
    robot = qa.Robot(
        urdf=ARM.replace('name="a"', f'name="{name}"'), joints=(HOSTILE, "b"), held={"grip": 0.02},
        beam=qa.Beam(
            at="tool", length=0.5, width=0.006, height=0.01, youngs_modulus=70e9, density=2700.0,
            tip_mass=0.3, pieces=2,
        ),
    )  # fmt: skip
    task = robot.task(qa.GeometricPath.line([0.2, -0.1], [1.1, 0.6]), duration=0.8)
    return {f"plan {k}": evaluate_coefficients(task, [0.0, 0.05 * k]) for k in (1, 2)}


@pytest.fixture(scope="module")
def file(plans, tmp_path_factory):
    path = tmp_path_factory.mktemp("robot") / "robot.html"
    trade_off(plans, deflection_scale=4.0).save(path)
    return path


@pytest.fixture
def opened(open_page, file):
    """Open the page."""
    return lambda **options: open_page(file.as_uri(), **options)


def camera(page):
    return page.evaluate("[camera.azimuth, camera.elevation]")


def test_the_page_sees_the_robot_as_the_film_does(opened, plans):
    page = opened(**DESK)
    still(page, 0.5)
    lines = [Line(plan, "", "blue") for plan in plans.values()]
    times = np.array([0.5])
    structure, *_ = structures_of(lines, times, 1.8, 4.0)
    first = min(plans.values(), key=lambda plan: plan.residual)
    chosen = next(s for s in structures_of(lines, times, 1.8, 4.0) if s.line.plan is first)
    room = page.evaluate("state.move.structure.room")
    middle = np.array(room["middle"])
    seen = Camera(Room(middle, room["reach"], room["half"], 0.0), *camera(page)).seen
    expected = np.vstack([seen(part.points[0]) for part in chosen.bent])
    drawn = page.evaluate(
        "() => { const look = viewOf({ width: 600, height: 400, margin: 6 });"
        "return pointsOf(coordinatesAt(ofChosen(state.move.scores), 0.5))"
        ".flatMap(({ line }) => line.map(look)); }"
    )
    x, y, scale = np.array(drawn).T
    pixels = scale.mean() / expected[:, 2].mean()
    assert scale / pixels == pytest.approx(expected[:, 2], abs=3e-3)
    assert (x - 300) / pixels == pytest.approx(expected[:, 0], abs=3e-3)
    # how high the middle of the room stands is the page's own
    assert np.ptp(y / pixels + expected[:, 1]) < 6e-3
    assert structure.scale == 4.0
    assert page.inner_text("#view").endswith("\u00d7 4")


def test_a_drag_and_the_arrow_keys_turn_it_and_a_double_click_sets_it_back(opened):
    page = opened(**DESK)
    still(page, 0.5)
    before, picture = camera(page), arm(page)
    box = page.locator("#scene").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 80, y + 20, steps=8)
    page.mouse.up()
    # a hundredth of a radian a pixel: the side that was left comes to the front
    assert camera(page) == pytest.approx([before[0] - 0.8, before[1] + 0.2])
    assert arm(page) != picture
    page.focus("#scene")
    chosen = number(page)
    page.keyboard.press("ArrowRight")
    assert camera(page)[0] < before[0] - 0.8
    assert number(page) == chosen
    page.mouse.dblclick(x, y)
    assert camera(page) == pytest.approx(before)
    assert arm(page) == picture


@pytest.mark.parametrize("options", [DESK, PHONE], ids=["desk", "phone"])
def test_every_line_has_a_legend_and_all_is_in_the_picture_from_all_sides(opened, options):
    page = opened(**options)
    still(page, 0.4)
    words = page.inner_text("#lines")
    invitation = page.inner_text("#invitation").replace("\u00a0", " ")
    assert page.evaluate("state.move.title") in invitation
    for line in ("robot", "what gives", "plain cycloid", "at the end", "way of the tip", "squares"):
        assert line in words
    assert page.evaluate("document.documentElement.scrollWidth") == options["viewport"]["width"]
    assert page.evaluate(CROSSED) == []
    page.evaluate("drawLines({ ...state.move.structure, on_support: true })")
    assert "support" in page.inner_text("#lines")
    for azimuth in (0.0, 2.0, 4.0):
        for elevation in (0.05, 1.5):
            page.evaluate(
                "([azimuth, elevation]) => { Object.assign(camera, { azimuth, elevation }); "
                "showTime(); }", [azimuth, elevation],
            )  # fmt: skip
            inside = page.evaluate(
                "() => { const { width, height } = byId('scene').getBoundingClientRect();"
                "return [...byId('scene').querySelectorAll('.part')].every((part) => {"
                "const box = part.getBBox(); return box.x >= 0 && box.y >= 0 &&"
                "box.x + box.width <= width && box.y + box.height <= height; }); }"
            )
            assert inside


def test_a_finger_turns_it_and_scrolls(opened):
    page = opened(**PHONE)
    still(page)
    before = camera(page)
    box = page.locator("#scene").bounding_box()
    x, y = box["x"] + 100, box["y"] + box["height"] / 2
    swipe(page, x, y, 90, 0)
    assert camera(page)[0] == pytest.approx(before[0] - 0.9, abs=0.02)
    turned = camera(page)
    swipe(page, x, y, 0, 150)
    page.wait_for_function("scrollY > 50")
    assert camera(page) == pytest.approx(turned)
