"""Make the pictures of the pages anew.

    python docs/make_pictures.py [NAME.png ...]       all, if none is named

A picture `images/NAME.png` of a page is what a command, or a block of Python, on a page writes as
NAME.png, word for word; some have other makers (`MAKERS`). `images/NAME-narrow.png` is the same
with its panels below each other, which the site shows on a phone. Beside them `images/shown.json`
says what each of them shows: its command, its words, its lines with their looks and some of their
values. A test makes them again without writing, and names those that are older than what they show.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from matplotlib.text import Text
from PIL import Image

import quietarm as qa
from quietarm.studies.cli import main
from quietarm.views.pictures.axes import (
    NARROW,
    TITLE,
    head,
    legend_below,
    logarithmic,
    new_figure,
    side_by_side,
)

DOCS = Path(__file__).parent
IMAGES = DOCS / "images"
SHOWN = IMAGES / "shown.json"
OF_COMMAND = {
    "acts.png": "bought/motions.png",
    "compared.png": "compared/motions.png",
    "robot.png": "move.png",
}
"""Files of commands that have another name as pictures."""
SAMPLES = 9
"""Of a line, whose values are kept."""
NEAR = 0.02
"""Share of the range of an axis by which a value may differ on another machine."""
FRAMES = 16
"""Of a film of the page to drag, in a second."""
BY_CHANCE = ("search", "front.png")
"""Their values depend on the last digits of libraries, by way of the random numbers."""

_IMAGE = re.compile(r"images/([\w.-]+)\)")
Shown = dict[str, Any]


class Picture(NamedTuple):
    """A picture, what it shows, and the same picture for a phone, where there is one."""

    content: bytes
    shown: Shown
    narrow: bytes | None = None


class Command(NamedTuple):
    """A line of a page, and the lines before it that write files which it reads."""

    page: str
    line: str
    before: tuple[str, ...]


# Which pictures there are, and what makes them


def names() -> list[str]:
    """Pictures that a page shows."""
    pages = [*DOCS.glob("*.md"), DOCS.parent / "README.md"]
    return sorted({name for page in pages for name in _IMAGE.findall(page.read_text())})


def narrow_name(name: str) -> str:
    """Of the same picture for a phone."""
    return f"{Path(name).stem}-narrow.png"


@cache
def command_of(name: str) -> Command | None:
    """The command that writes a picture: on the page that shows it, or on another one."""
    pages = sorted(DOCS.glob("*.md"), key=lambda page: f"images/{name})" not in page.read_text())
    output = OF_COMMAND.get(name, name)
    for page in pages:
        lines = re.findall(r"^\.venv/bin/(quietarm .*)$", page.read_text(), re.MULTILINE)
        for number, line in enumerate(lines):
            if any(output in (word, f"{word}/motions.png") for word in outputs_of(line)):
                return Command(page.stem, line, tuple(_needed(line, lines[:number])))
    return None


def outputs_of(line: str) -> list[str]:
    """Files that a command writes."""
    words = shlex.split(line)
    return [file for option, file in pairwise(words) if option == "--output"]


def _needed(line: str, before: list[str]) -> Iterator[str]:
    """Commands before a line that write what it reads, first ones first, each once."""
    unread = set(shlex.split(line)[2:]) - set(outputs_of(line))
    needed = list[str]()
    for earlier in reversed(before):
        if unread & set(outputs_of(earlier)):
            needed.append(earlier)
            unread -= set(outputs_of(earlier))
    for earlier in reversed(needed):
        yield from _needed(earlier, before[: before.index(earlier)])
        yield earlier


# How they are made


def made_by_command(command: Command, name: str, quick: bool) -> Picture:
    """Run a command in the folder where one stands; its picture, and what that shows."""
    _put_files_of_page(command.page)
    figure = None
    for line in (*command.before, command.line):
        with drawn_figures() as figures, ending_well():
            main([*(_quicker(line) if quick else shlex.split(line))[1:], "--quiet"])
        figure = figures[-1] if figures else figure
    assert figure is not None
    return _picture_of(figure, name, Path(OF_COMMAND.get(name, name)), quick)


def _picture_of(figure: Figure, name: str, path: Path, quick: bool) -> Picture:
    """A picture's file, what its figure shows, and the figure for a phone."""
    narrow = None
    stacked = None
    if not quick and path.suffix != ".gif":
        stacked = FOR_PHONES.get(name, qa.pictures.stack)(figure)
    if stacked is not None:
        content = io.BytesIO()
        stacked.savefig(content, format="png", dpi=150)
        narrow = content.getvalue()
    return Picture(path.read_bytes(), shown_by(figure), narrow)


def torques_of_joints(whole: Figure) -> Figure:
    """The torques of the saved plan's joints, below each other, with the head of the whole."""
    plan = qa.Plan.load("move.json")
    names = plan.task.plant.joint_names
    figure = new_figure(NARROW, 2.0 + 1.7 * len(names))
    axes = list(figure.subplots(len(names), 1))
    for joint, (name, ax) in enumerate(zip(names, axes)):
        title = qa.pictures.draw_quantity(plan, "torque", ax, curve=joint).get_title(loc="left")
        ax.set_title(f"{title}, {name}", **TITLE)
    for ax in axes[:-1]:
        ax.set_xlabel("")
    title_of_whole = whole._suptitle  # pyright: ignore[reportAttributeAccessIssue]
    head(figure, *title_of_whole.get_label().split("\n"))
    legend_below(figure, axes, 2, 9)
    return figure


FOR_PHONES: Mapping[str, Callable[[Figure], Figure | None]] = {"robot.png": torques_of_joints}
"""Pictures with too many panels for a phone, and what is drawn there of them."""


def _quicker(line: str) -> list[str]:
    """Words of a command; those of a film are such that it shows the same in less time."""
    words = shlex.split(line)
    if not line.endswith(".gif"):
        return words
    quick = {"--rate": "4", "--width": "240"}
    given = {place for place, word in enumerate(words) if word in quick}
    kept = [word for place, word in enumerate(words) if not {place, place - 1} & given]
    return [*kept, *(word for option in quick.items() for word in option)]


def python_of(name: str) -> str | None:
    """The block of Python that saves a picture of this name, on a page that shows it."""
    for page in DOCS.glob("*.md"):
        text = page.read_text()
        for block in re.findall(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
            if f'savefig("{name}")' in block and f"images/{name})" in text:
                return block
    return None


def made_by_python(block: str, name: str, quick: bool) -> Picture:
    """Run a block of Python in the folder where one stands."""
    with drawn_figures() as figures:
        exec(compile(block, name, "exec"), {"__name__": "__main__"})
    return _picture_of(figures[-1], name, Path(name), quick)


@contextmanager
def ending_well() -> Iterator[None]:
    """A command's exit: good, or an error of this script."""
    try:
        yield
    except SystemExit as ended:
        if ended.code:
            raise RuntimeError(f"the command ended with {ended.code}") from ended


@contextmanager
def drawn_figures() -> Iterator[list[Figure]]:
    """The figure that is saved last meanwhile."""
    drawn = list[Figure]()
    save = Figure.savefig

    def keep(figure: Figure, *arguments: Any, **settings: Any) -> None:
        save(figure, *arguments, **settings)
        drawn[:] = [figure]

    Figure.savefig = keep  # pyright: ignore[reportAttributeAccessIssue]
    try:
        yield drawn
    finally:
        Figure.savefig = save


def _put_files_of_page(page: str) -> None:
    """Files that a page shows by a name in their first line, and the URDF that it speaks of."""
    text = (DOCS / f"{page}.md").read_text()
    for block in re.findall(r"^```text\n(# [\w.]+\n.*?)^```$", text, re.DOTALL | re.MULTILINE):
        Path(block.split(maxsplit=2)[1]).write_text(block)
    if "ur5_robot.urdf" in text:
        import importlib.metadata

        files = importlib.metadata.files("example-robot-data") or []
        urdf = next(file.locate() for file in files if file.name == "ur5_robot.urdf")
        Path("ur5_robot.urdf").write_bytes(Path(str(urdf)).read_bytes())


def fronts_compared(quick: bool) -> Picture:
    """Fronts of the arm's first move: five seeds of the paper's searches, and the gradient's."""
    from quietarm.studies.compare import compare_fronts
    from quietarm.studies.reproduce.paper import ARM_HALF, paper_points
    from quietarm.views.pictures import comparison_figure

    task = ARM_HALF.task
    fewer = {"generations": 60} if quick else {}  # by then every method comes within 1 mm
    fronts = [qa.epsilon_front(task, bound=ARM_HALF.bound, points=50)]
    fronts += [
        qa.search(task, algorithm=method, bound=ARM_HALF.bound, seed=seed, **fewer)
        for method in ("vepso", "nsga2-paper")
        for seed in range(5)
    ]
    comparison = replace(compare_fronts(fronts), floor=qa.energy_floor(task).energy)
    figure = comparison_figure(comparison, paper_points(task, {6}))
    figure.savefig("front.png", dpi=150)
    return _picture_of(figure, "front.png", Path("front.png"), quick)


@contextmanager
def a_page(width: int, height: int, **settings: Any) -> Iterator[Any]:
    """An empty page of the machine's own Chromium, which waits as long as a slow machine takes."""
    from playwright.sync_api import expect, sync_playwright

    milliseconds = 240_000
    expect.set_options(milliseconds)
    browsers = map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=next(filter(None, browsers)))
        page = browser.new_page(viewport={"width": width, "height": height}, **settings)
        page.set_default_timeout(milliseconds)
        yield page
        browser.close()


def page_of_sliders(quick: bool) -> Picture:
    """The page of explore, with a front, and a plan within its box."""
    from playwright.sync_api import expect

    line = [sys.executable, "-m", "quietarm", "explore", "--no-browser"]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        address = process.stdout.readline().strip()
        with a_page(1200, 900, reduced_motion="reduce", device_scale_factor=2) as page:
            page.goto(address)
            figures = page.locator("#rows")
            expect(figures).to_contain_text("0 to 30 deg")
            page.locator("#limits summary").click()
            box = page.get_by_label("largest |a_n|")
            box.fill("0.2")
            box.press("Enter")
            page.get_by_role("button", name="Front", exact=True).click()
            expect(page.locator("#said")).to_have_text("drag the ring along the front")
            page.get_by_role("button", name="Plan", exact=True).click()
            expect(figures).to_contain_text("found a local optimum")
            page.locator("#limits summary").click()
            expect(page.locator("#robustness path")).to_have_count(1)
            words = page.evaluate("document.body.innerText").splitlines()
            picture = _with_dots(page.screenshot(full_page=True), 192)
            narrow = None if quick else _first_cards(page)
    finally:
        process.terminate()
        process.communicate(timeout=240)
    shown: Shown = {"words": masked(words), "lines": [], "areas": []}
    return Picture(picture, shown, narrow)


def _first_cards(page: Any) -> bytes:
    """The page of explore on a phone: the arm, the front and the sliders."""
    page.set_viewport_size({"width": 370, "height": 1200})
    page.wait_for_timeout(500)
    last = page.locator("#hand").bounding_box()
    around = 8
    clip = {"x": 0, "y": 0, "width": 370, "height": last["y"] + last["height"] + around}
    return _with_dots(page.screenshot(clip=clip, full_page=True), 192)


def film_of_the_page(quick: bool) -> Picture:
    """The page to drag as it moves: the arm at rest, then along the front to where it swings."""
    _page_of_fronts()
    played = np.arange(0.0, 2.0, 1.0 if quick else 1 / FRAMES)
    swinging = 1.0  # the time at which the plain cycloid swings farthest
    with a_page(700, 700, reduced_motion="reduce") as page:
        page.goto(Path("front.html").resolve().as_uri())
        page.locator("header").evaluate("header => header.remove()")
        page.focus("#handle")
        page.keyboard.press("Home")
        frames = [_first_two_cards(page, time) for time in played]
        for key, presses in (("ArrowRight", 36), ("ArrowLeft", 36)):
            for press in range(presses):
                page.keyboard.press(key)
                if press % 3 == 2 and not quick:
                    frames.append(_first_two_cards(page, swinging))
            if key == "ArrowRight":
                frames += [_first_two_cards(page, time) for time in played]
        words = page.evaluate("document.body.innerText").splitlines()
    shown: Shown = {"words": masked(words), "lines": [], "areas": []}
    return Picture(_film(frames), shown)


def _page_of_fronts() -> None:
    """Write front.html, the page that the site shows first."""
    sys.path.insert(0, str(DOCS / "_extensions"))
    from site_front import page_of_fronts

    page_of_fronts().save("front.html")


def _first_two_cards(page: Any, time: float) -> Image.Image:
    """The front and the arm at a time of the motion [s], as they are on the screen."""
    page.evaluate(f"seek({time})")
    boxes = [page.locator(card).bounding_box() for card in ("#trade-off", "#arm")]
    right = max(box["x"] + box["width"] for box in boxes)
    bottom = max(box["y"] + box["height"] for box in boxes)
    left, top = boxes[0]["x"], boxes[0]["y"]
    clip = {"x": left, "y": top, "width": right - left, "height": bottom - top}
    return Image.open(io.BytesIO(page.screenshot(clip=clip, full_page=True)))


def _film(frames: list[Image.Image]) -> bytes:
    """A GIF of frames, all in the colours of the first."""
    first = frames[0].convert("RGB").quantize(64, dither=Image.Dither.NONE)
    alike = [
        frame.convert("RGB").quantize(palette=first, dither=Image.Dither.NONE) for frame in frames
    ]
    content = io.BytesIO()
    alike[0].save(
        content,
        format="GIF",
        save_all=True,
        append_images=alike[1:],
        duration=1000 // FRAMES,
        loop=0,
        optimize=True,
    )
    return content.getvalue()


def _with_dots(picture: bytes, an_inch: int) -> bytes:
    """A picture that says how large it is, as matplotlib's do."""
    content = io.BytesIO()
    with Image.open(io.BytesIO(picture)) as image:
        image.save(content, format="PNG", dpi=(an_inch, an_inch))
    return content.getvalue()


def residual_over_moves(quick: bool) -> Picture:
    """What two machines leave by move, while plans are learned: of benchmarks/learning.py."""
    with (DOCS.parent / "benchmarks" / "results" / "learning.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    machines = list(dict.fromkeys(row["machine"] for row in rows))
    figure, axes = side_by_side(
        len(machines),
        "Three moves take away what model and drive leave",
        "median of the seeds; by a tip sensor, and by the joint and its force alone",
    )
    cases = {
        ("right model", "tip+angle"): "right model",
        ("model 8 % too slow", "tip+angle"): "8 % too slow",
        ("model 8 % too fast", "tip+angle"): "8 % too fast",
        ("model 8 % too slow", "angle+torque"): "8 % too slow, by the force",
    }
    for name, ax in zip(machines, axes):
        largest = list[float]()
        for number, ((case, signals), label) in enumerate(cases.items()):
            own = [
                row
                for row in rows
                if (row["machine"], row["case"], row["signals"]) == (name, case, signals)
            ]
            columns = [name for name in rows[0] if name.startswith("mm_")]
            moves = [int(name.removeprefix("mm_")) for name in columns]
            left = [float(np.median([float(row[name]) for row in own])) for name in columns]
            largest += left
            how = qa.pictures.COLOURS[number]
            ax.plot(moves, left, "o-", color=how, label=label, markersize=4)
        ax.set_title(name, **TITLE)
        ax.set(xlabel="moves learned from", ylabel="residual [mm]", xticks=range(4))
        ax.grid(alpha=0.25)
        logarithmic(ax, largest, "y")
    legend_below(figure, axes, 2, 9)
    figure.savefig("learned.png", dpi=150)
    return _picture_of(figure, "learned.png", Path("learned.png"), quick)


STEEL, DARK, SENSOR = "#b8bec6", "#4a5058", "#d55e00"
"""Colours of a drawing: what swings, what holds it, and where the sensor is."""


def place_of_the_sensor(quick: bool) -> Picture:
    """Where the sensor goes on an arm and on a linear axis, and a recording that will do."""
    figure = new_figure(10.4, 4.0)
    arm, axis, recording = figure.subplots(1, 3)
    head(
        figure,
        "Hold the joint, put the sensor where the tool is, push, let go",
        "orange: the sensor, and the direction that it measures; x: too close to the joint",
    )
    _draw_arm(arm)
    _draw_axis(axis)
    _draw_recording(recording)
    for ax in (arm, axis):
        ax.set_aspect("equal")
        ax.set_axis_off()
    figure.savefig("sensor.png", dpi=150)
    return _picture_of(figure, "sensor.png", Path("sensor.png"), quick)


def _draw_arm(ax: Axes) -> None:
    """A beam on a motor, from above, bent by a push."""
    ax.set_title("An arm that turns, from above", **TITLE)
    along = np.linspace(0.0, 1.0, 60)
    bent = 0.55 * along**2 * (3 - along) / 2
    for share, opacity in ((-1.0, 0.2), (0.0, 0.35), (1.0, 1.0)):
        ax.plot(3 * along, share * bent, color=STEEL, linewidth=7, alpha=opacity, zorder=1)
    ax.add_patch(Rectangle((-0.62, -0.62), 1.24, 1.24, color="#d9dde2", zorder=1))
    ax.add_patch(Circle((0.0, 0.0), 0.42, color=DARK, zorder=2))
    ax.add_patch(Circle((0.0, 0.0), 0.14, color=STEEL, zorder=3))
    ax.plot([0.75], [0.0], "x", color=DARK, markersize=9, markeredgewidth=2, zorder=4)
    _put_sensor(ax, 3.0, 0.55, (0.0, 0.62))
    ax.text(0.0, -0.78, "joint, held\nby its brake", ha="center", va="top", fontsize=8)
    ax.text(2.9, -0.78, "sensor at the tip,\nacross the arm", ha="center", va="top", fontsize=8)
    ax.set(xlim=(-0.9, 3.9), ylim=(-1.4, 1.3))


def _draw_axis(ax: Axes) -> None:
    """A carriage on its rail with a mast and a tool, from the side."""
    ax.set_title("A linear axis, from the side", **TITLE)
    ax.add_patch(Rectangle((-1.7, 1.22), 3.4, 0.16, color=DARK, zorder=1))
    ax.add_patch(Rectangle((-0.55, 0.72), 1.1, 0.5, color="#8d949d", zorder=2))
    down = np.linspace(0.0, 1.0, 60)
    bent = 0.4 * down**2 * (3 - down) / 2
    for share, opacity in ((-1.0, 0.2), (0.0, 0.35), (1.0, 1.0)):
        ax.plot(share * bent, 0.72 - 2.0 * down, color=STEEL, linewidth=7, alpha=opacity, zorder=1)
    ax.plot([0.0], [0.97], "x", color="white", markersize=9, markeredgewidth=2, zorder=4)
    _put_sensor(ax, 0.4, -1.28, (0.62, 0.0))
    ax.text(-0.65, 0.97, "carriage, held", ha="right", va="center", fontsize=8)
    ax.text(0.75, -0.6, "sensor at the tool,\nalong the axis", ha="left", va="center", fontsize=8)
    ax.set(xlim=(-2.0, 2.6), ylim=(-1.8, 1.6))


def _put_sensor(ax: Axes, x: float, y: float, way: tuple[float, float]) -> None:
    """A tool with a sensor on it, and the direction in which it measures."""
    ax.add_patch(Rectangle((x - 0.24, y - 0.24), 0.48, 0.48, color=DARK, zorder=3))
    ax.add_patch(Rectangle((x - 0.13, y - 0.13), 0.26, 0.26, color=SENSOR, zorder=4))
    ends = {"xy": (x + way[0], y + way[1]), "xytext": (x - way[0], y - way[1])}
    ax.annotate("", arrowprops={"arrowstyle": "<->", "color": SENSOR, "lw": 1.8}, zorder=2, **ends)


def _draw_recording(ax: Axes) -> None:
    """A push, and the swing after it for twenty periods."""
    ax.set_title("A recording that will do", **TITLE)
    period, ratio = 1 / 3.2, 0.01
    time = np.arange(-0.6, 20 * period, period / 40)
    swing = np.exp(-ratio * 2 * np.pi / period * time) * np.cos(2 * np.pi / period * time)
    pushed = 0.5 * (1 - np.cos(np.pi * np.clip((time + 0.5) / 0.4, 0.0, 1.0)))
    ax.plot(time, np.where(time < 0, pushed, swing), color=SENSOR, linewidth=1)
    ax.set(xlabel="time [s]", ylabel="tip, any unit", ylim=(-1.25, 1.55), yticks=[0.0])
    ax.text(-0.55, 1.2, "push", fontsize=8)
    ax.text(1.0, 1.2, "let go: 20 swings or more", fontsize=8)
    ax.grid(alpha=0.25)


MAKERS: Mapping[str, Callable[[bool], Picture]] = {
    "front.png": fronts_compared,
    "dragged.gif": film_of_the_page,
    "explore.png": page_of_sliders,
    "learned.png": residual_over_moves,
    "sensor.png": place_of_the_sensor,
}
"""Makers of pictures that no command writes; told whether less will do."""


def make(name: str, quick: bool = False) -> Picture:
    """A picture, made in a folder of its own."""
    home = Path.cwd()
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        os.chdir(folder)
        try:
            if name in MAKERS:
                return MAKERS[name](quick)
            if block := python_of(name):
                return made_by_python(block, name, quick)
            command = command_of(name)
            if command is None:
                raise ValueError(f"no command on a page writes {name}; add it there, or to MAKERS")
            return made_by_command(command, name, quick)
        finally:
            os.chdir(home)


# What they show


def shown_by(figure: Figure) -> Shown:
    """Words, lines with looks and values, and areas of a figure."""
    texts = [text.get_text() for text in figure.findobj(Text) if text.get_visible()]
    lines = [
        [
            line.get_label() if not str(line.get_label()).startswith("_") else "",
            to_hex(line.get_color()),
            str(line.get_linestyle()),
            str(line.get_marker()),
            _sampled(line.get_xdata(), ax.get_xlim()),
            _sampled(line.get_ydata(), ax.get_ylim()),
        ]
        for ax in figure.axes
        for line in ax.get_lines()
    ]
    areas = [
        _sampled(np.ravel(mesh.get_array()), (0.0, 1.0))
        for mesh in figure.findobj(QuadMesh)
        if mesh.axes is not None and not mesh.axes.get_label().startswith("<colorbar")
    ]
    return {"words": masked(texts), "lines": lines, "areas": areas}


def masked(texts: list[str]) -> list[str]:
    """Words without their numbers, which stand in the values; those with letters, once each."""
    lines = {
        re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", line).strip()
        for text in texts
        for line in text.splitlines()
    }
    return sorted(line for line in lines if re.search(r"[a-zA-Z]", line))


def _sampled(values: Any, span: tuple[float, float]) -> list[float]:
    """Some values along a line, as shares of its axis."""
    numbers = np.asarray(values, dtype=float)
    if not numbers.size:  # a part of a film before its first frame
        return []
    places = np.linspace(0, len(numbers) - 1, SAMPLES).round().astype(int)
    shares = (numbers[places] - span[0]) / ((span[1] - span[0]) or 1.0)
    return [float(f"{share:.4g}") for share in np.nan_to_num(shares, nan=-1.0)]


def differences(before: Shown, now: Shown, with_values: bool) -> list[str]:
    """What a picture shows and would not show now, or the other way round."""
    said = [f"no longer: {word}" for word in before["words"] if word not in now["words"]]
    said += [f"new: {word}" for word in now["words"] if word not in before["words"]]
    looks = [[line[:4] for line in shown["lines"]] for shown in (before, now)]
    if looks[0] != looks[1]:
        said.append("lines with other looks")
    elif with_values:
        said += [
            f"other values of {line[0] or 'a line'}"
            for line, again in zip(before["lines"], now["lines"])
            if not np.allclose(line[4:], again[4:], rtol=0, atol=NEAR)
        ]
        for area, again in zip(before["areas"], now["areas"]):
            if not np.allclose(area, again, rtol=NEAR, atol=1e-9):
                said.append("other values of an area")
    return said


def digest(content: bytes) -> str:
    """Of a picture's file."""
    return hashlib.sha256(content).hexdigest()[:16]


def recorded() -> dict[str, Shown]:
    """What the pictures show, as it was when they were made."""
    return json.loads(SHOWN.read_text()) if SHOWN.exists() else {}


def has_values(name: str) -> bool:
    """Whether a picture made quickly has the same values, on every machine.

    A film has fewer frames then, and so other points along its trails.
    """
    if name.endswith(".gif"):
        return False
    command = command_of(name)
    by_chance = command is not None and command.line.split()[1] in BY_CHANCE
    return not by_chance and name not in BY_CHANCE


def _smaller(picture: bytes) -> bytes:
    """The same picture in as many colours as can be seen in it, a third of the size."""
    colours = 128
    small = io.BytesIO()
    with Image.open(io.BytesIO(picture)) as image:
        few = image.convert("RGB").quantize(colours, dither=Image.Dither.NONE)
        # by its size on paper the site knows how high its letters are
        few.save(small, format="PNG", optimize=True, dpi=image.info.get("dpi"))
    return small.getvalue()


def write(name: str) -> None:
    """Make a picture, write it, and what it shows."""
    picture = make(name)
    content = _smaller(picture.content) if name.endswith(".png") else picture.content
    command = command_of(name) if name not in MAKERS else None
    line = command.line if command else ""
    shown = {"command": line, "file": digest(content), **picture.shown}
    (IMAGES / name).write_bytes(content)
    narrow_place = IMAGES / narrow_name(name)
    narrow_place.unlink(missing_ok=True)
    if picture.narrow is not None:
        narrow = _smaller(picture.narrow)
        shown["narrow"] = digest(narrow)
        narrow_place.write_bytes(narrow)
    entries = {**recorded(), name: shown}
    lines = [f"{json.dumps(key)}: {json.dumps(entries[key])}" for key in sorted(entries)]
    SHOWN.write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    for picture_name in sys.argv[1:] or names():
        print(picture_name, flush=True)
        write(picture_name)
