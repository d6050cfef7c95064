"""The page in headless Chromium; without one on this machine it is not tested."""

import re
import shutil
import signal
import subprocess
import sys
from contextlib import suppress

import pytest

api = pytest.importorskip("playwright.sync_api")
CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here"),
]
GUARD = 240
"""Seconds after which what does not come has hung, on any machine."""
api.expect.set_options(1e3 * GUARD)
LOUD = ("warning", "error")
# Where a point of the front is on the page.
PLACE = """number => {
    const {id, renderers} = Bokeh.documents[0].get_model_by_name("front");
    const view = Bokeh.index.find_one_by_id(id), points = renderers[1].data_source.data;
    const {x, y} = view.canvas_view.el.getBoundingClientRect();
    const {x_scale, y_scale} = view.frame;
    return [x + x_scale.compute(points.x[number]), y + y_scale.compute(points.y[number])];
}"""


@pytest.fixture(scope="module")
def address():
    """Of the page, until Ctrl-C."""
    of_tornado = "ignore:There is no current event loop:DeprecationWarning"  # from Python 3.12 on
    strict = ["-W", "error", "-W", of_tornado]
    line = [sys.executable, *strict, "-m", "quietarm", "explore", "--no-browser"]
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
def chromium():
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM)
        yield browser
        browser.close()


@pytest.fixture
def page(address, chromium):
    """The page as it begins; nothing is asked of another machine, and no script fails or warns."""
    page, wrong = chromium.new_page(viewport={"width": 1280, "height": 800}), []
    page.set_default_timeout(1e3 * GUARD)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda said: said.type in LOUD and wrong.append(said.text))
    page.on("request", lambda request: wrong.append(request.url))
    page.goto(address)
    api.expect(figures(page)).to_contain_text("single-link, 0 to 30 deg in 0.8 s")
    yield page
    assert [one for one in wrong if not one.startswith((address, "blob:", "data:"))] == []
    page.close()


def figures(page):
    return page.locator(".figures .bk-clearfix")


def said_of_energy(page):
    return re.search(r"energy \(F2\) [\d.]+ J", figures(page).inner_text())[0]


def energy(page):
    return float(said_of_energy(page).split()[-2])


def button(page, name):
    return page.get_by_role("button", name=name, exact=True)


def test_slider_gradient_and_menu_change_the_figures_and_all_fits_a_phone(page):
    cycloid, first = energy(page), said_of_energy(page)
    assert cycloid == pytest.approx(0.0911, abs=5e-5)  # README
    page.locator(".shape .noUi-handle").nth(1).press("ArrowLeft")
    api.expect(figures(page)).to_contain_text("coefficients 0, -0.0001, 0")
    assert energy(page) < cycloid
    button(page, "Plan").click()
    api.expect(figures(page)).to_contain_text("found a local optimum")
    assert energy(page) == pytest.approx(0.0237, abs=5e-5)  # README
    api.expect(page.get_by_label("a6")).not_to_have_value("0")
    button(page, "Plain cycloid").click()
    api.expect(page.get_by_label("a6")).to_have_value("0")
    api.expect(figures(page)).to_contain_text(first)  # the figures come after the sliders
    page.set_viewport_size({"width": 390, "height": 844})
    page.get_by_label("plant").select_option("dual-link")
    api.expect(figures(page)).to_contain_text("dual-link, 0 to 30 deg")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    slider, curve = page.locator(".shape .noUi-handle").nth(5), page.locator(".deflection")
    slider.hover()  # which scrolls to it
    beside = curve.bounding_box(), slider.bounding_box()
    assert 0 <= beside[0]["y"] < beside[0]["y"] + beside[0]["height"] <= beside[1]["y"] <= 844


def test_from_the_start_the_motion_is_beside_the_front_and_the_key_has_what_is_seen(page):
    front = "Bokeh.documents[0].get_model_by_name('front')"
    key = "Bokeh.documents[0].get_model_by_name('key').text"
    cycloid, here = (
        page.evaluate(f"Object.values({front}.renderers[{k}].data_source.data).map(x => [...x])")
        for k in (2, 3)
    )
    for [residual], [energy] in (cycloid, here):
        # README: 77 mm and 0.0911 J
        assert (residual, energy) == (
            pytest.approx(77.1, abs=0.05),
            pytest.approx(0.0911, abs=5e-5),
        )
    title = page.evaluate(f"{front}.title.text")
    assert title == "press Front for the least energy of each residual"
    words = page.evaluate(key)
    assert "still is the plain cycloid" in words
    assert all(unseen not in words for unseen in ("grey", "red", "limits"))
    button(page, "Keep curve").click()
    page.locator(".shape .noUi-handle").nth(1).press("ArrowLeft")
    page.wait_for_function(f"{key}.includes('grey: the plain cycloid')")
    words = page.evaluate(key)
    assert "red, dashed: the curve that was kept" in words
    assert "still is" not in words
    api.expect(page.locator(".shape")).to_contain_text("faster in one part of the move")


def test_with_the_shift_key_a_slider_goes_a_tenth_as_far(page):
    handle = page.locator(".shape .noUi-handle").nth(1)

    def drag(across):
        handle.scroll_into_view_if_needed()
        box = handle.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        before = float(page.get_by_label("a2").input_value())
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + across, y, steps=10)
        page.mouse.up()
        page.wait_for_function(
            "before => Math.abs(Bokeh.documents[0].get_model_by_name('shape').children[1]"
            ".children[1].value - before) > 1e-9", arg=before,
        )  # fmt: skip
        return (
            page.evaluate(
                "Bokeh.documents[0].get_model_by_name('shape').children[1].children[1].value"
            )
            - before
        )

    coarse = drag(-40)
    # the box of the paper, from -0.2 to 0.2, is some 200 pixels wide
    assert -0.12 < coarse < -0.04
    page.keyboard.down("Shift")
    fine = drag(-40)
    page.keyboard.up("Shift")
    assert fine == pytest.approx(coarse / 10, abs=3e-4)
    api.expect(figures(page)).not_to_contain_text("coefficients 0, 0, 0")


def test_where_stillness_is_asked_for_the_structure_stands_as_it_arrived(address, chromium):
    page = chromium.new_page(reduced_motion="reduce")
    page.set_default_timeout(1e3 * GUARD)
    page.goto(address)
    title = "Bokeh.documents[0]?.get_model_by_name('stage')?.title.text ?? ''"
    page.wait_for_function(f"({title}).endsWith('t = 2.00 s')")
    page.wait_for_timeout(300)
    assert page.evaluate(title).endswith("residual: 77.1 mm; to scale, t = 2.00 s")
    page.close()


def test_a_hundred_moves_of_a_slider_end_where_the_last_one_is(page):
    slider = page.locator(".shape .noUi-handle").nth(1)
    for _ in range(100):
        slider.press("ArrowLeft")
    api.expect(figures(page)).to_contain_text("coefficients 0, -0.01, 0")


def test_profile_and_terms_are_chosen_and_a_curve_is_kept(page):
    button(page, "Keep curve").click()
    api.expect(button(page, "Drop curve")).to_be_visible()
    page.get_by_label("profile").select_option("spline")
    api.expect(figures(page)).to_contain_text("cycloid-spline of 6 control points")
    page.get_by_label("terms").fill("8")
    page.get_by_label("terms").press("Enter")
    api.expect(page.get_by_label("a8")).to_be_visible()
    button(page, "Plan").click()
    api.expect(figures(page)).to_contain_text("found a local optimum")
    drawn = "Bokeh.documents[0].get_model_by_name('deflection').renderers[0].data_source.data"
    # the plain cycloid, that it is kept as, and the plan; then these after arrival; the arrival
    looks = page.evaluate(f"{drawn}.colour.map((colour, k) => [colour, {drawn}.dash[k]])")
    # docs/pictures.md; the curve that is kept has a colour without a meaning
    moving = [["#8B939C", "solid"], ["#B3203F", "dashed"], ["#0072B2", "solid"]]
    assert looks == [*moving, *moving, ["#8B939C", "dashed"]]
    assert page.evaluate(f"{drawn}.alpha") == [1, 1, 1, 0.45, 0.45, 0.45, 1]
    # and a limit that the torque comes near is dark and dotted
    page.get_by_label("torque [N m]").fill("0.2")
    page.get_by_label("torque [N m]").press("Enter")
    api.expect(figures(page)).to_contain_text("torque 0.2 N m")
    torque = drawn.replace("deflection", "torque")
    page.wait_for_function(f"{torque}.dash.at(-2) === 'dotted'")
    assert page.evaluate(f"{torque}.colour.at(-2)") == "#333333"


def test_a_click_on_the_front_shows_its_motion_and_it_is_downloaded(page):
    button(page, "Front").click()
    title = "Bokeh.documents[0].get_model_by_name('front').title.text"
    page.wait_for_function(f"{title}.startsWith('front: click near it')")
    shown = re.compile(r"residual \(F1\) 1\d\.\d mm")
    for _ in range(20):  # a busy browser may not have drawn the front yet
        x, y = page.evaluate(PLACE, 10)
        page.mouse.click(x + 2, y - 25)  # near it
        with suppress(AssertionError):
            api.expect(figures(page)).to_contain_text(shown, timeout=5000)
            break
    api.expect(figures(page)).to_contain_text(shown, timeout=5000)
    api.expect(figures(page)).to_contain_text("enter what the drive can do under Limits")
    api.expect(figures(page)).to_contain_text("a point of the front")
    begins = {"plan.json": '{\n  "format": "quietarm-plan"', "move.csv": "time_s,"}
    begins |= dict.fromkeys(("move.c", "move.h"), "/* move: ")
    for name in (*begins, "move.h"):  # the last one twice
        with page.expect_download() as download:
            button(page, name).click()
        assert download.value.suggested_filename == name
        assert download.value.path().read_text().startswith(begins[name])
