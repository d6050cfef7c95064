"""Ctrl-C, pressed exactly where it used to be lost, to become another error or to leave a rest."""

import gc
import importlib
import signal
import sys
import threading
import weakref

import casadi as ca
import numpy as np
import pytest
from presses import press, pressed_at

from quietarm.interrupts import interruptible, note_interrupts
from quietarm.models.compiled import Compiled

X = ca.SX.sym("x")
SQUARE = Compiled(lambda: ca.Function("square", [X], [X * X]), side_by_side=True)


@pytest.fixture(autouse=True)
def _nothing_is_left():
    """After each test Python's handler stands, no tracer is left, and the next call works."""
    tracer = sys.gettrace()
    yield
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert sys.gettrace() is tracer
    assert SQUARE([3.0])[0].item() == 9.0


def ended_at_once(work):
    """Do a piece of work within an operation, which must not go on after it."""
    after = []

    @interruptible
    def operation():
        work()
        after.append("went on")

    with pytest.raises(KeyboardInterrupt):
        operation()
    assert after == [], "it was raised when the operation ended, not at once"


# Where Python or CasADi loses what is raised


class Pressing:
    """An argument whose conversion by CasADi's wrapper is pressed."""

    def __DM__(self):  # noqa: N802  # CasADi's name
        press()
        return ca.DM([1.0])


def _steps_in_casadi(frame):
    return str(frame.f_globals.get("__name__")).startswith("casadi")


CALLS = {
    "DM(array)": lambda: ca.DM(np.ones(3)),
    "full": ca.DM([1, 2]).full,
    "as an array": lambda: np.asarray(ca.DM([1, 2])),
    "product": lambda: ca.DM([1.0, 2.0]) * np.array([1.0, 2.0]),
    "sum of symbols": lambda: X + X,
    "vertcat": lambda: ca.vertcat(X, 1.0),
    "jacobian": lambda: ca.jacobian(ca.sin(X), X),
    "function": lambda: SQUARE.function([1.0, 2.0]),
}


@pytest.mark.parametrize("name", CALLS)
def test_no_step_of_casadis_wrapper_loses_it(name):
    call = CALLS[name]
    call()
    with pressed_at(0, _steps_in_casadi) as steps:
        call()
    assert steps[0] > 0
    for number in range(1, steps[0] + 1):
        with pressed_at(number, _steps_in_casadi):
            ended_at_once(call)


def test_what_casadi_converts_is_no_other_error():
    ended_at_once(lambda: ca.DM(Pressing()))


def test_it_is_raised_in_place_of_the_error_that_follows():
    def lose_and_fail():
        try:
            press()
        except KeyboardInterrupt:
            raise AttributeError("'NoneType' object has no attribute 'reshape'") from None

    with pytest.raises(KeyboardInterrupt):
        interruptible(lose_and_fail)()


def test_what_swallows_it_ends_with_it():
    def swallow():
        try:
            press()
        except KeyboardInterrupt:
            return "as if nothing were"

    with pytest.raises(KeyboardInterrupt):
        Compiled.guard(swallow)


class _Thing:
    """Thing of which there are weak references."""


def test_a_callback_of_a_weak_reference_does_not_lose_it():
    def call_back():
        things = weakref.WeakValueDictionary()
        things["one"] = _Thing()  # gone at once: its entry is removed in a callback of `weakref`

    within = []

    def in_a_callback(frame):
        within.append(frame.f_globals.get("__name__") == "weakref")
        return within[-1] and frame.f_code.co_name == "remove"

    with pressed_at(3, in_a_callback):
        ended_at_once(call_back)
    assert any(within)


def test_a_callback_of_anyone_does_not_lose_it_nor_is_a_word_said_of_it(capfd):
    hook = sys.unraisablehook

    def forget():
        thing = _Thing()
        reference = weakref.ref(thing, lambda _: press())
        del thing
        return reference

    ended_at_once(forget)
    assert capfd.readouterr().err == ""
    assert sys.unraisablehook is hook


def test_del_does_not_lose_it():
    class Last:
        def __del__(self):
            press()

    def forget():
        one = Last()
        del one

    ended_at_once(forget)


def test_a_callback_of_the_garbage_collector_does_not_lose_it():
    def timed(phase, info):
        press()

    gc.callbacks.append(timed)
    try:
        ended_at_once(gc.collect)
    finally:
        gc.callbacks.remove(timed)


def test_an_operation_within_a_callback_of_casadi_is_left_as_a_whole():
    class Calls(ca.Callback):
        def __init__(self):
            super().__init__()
            self.construct("calls", {})

        def eval(self, arguments):
            press()
            return [arguments[0]]

    callback = Calls()
    ended_at_once(lambda: callback(1.0))


# Where half of something would stay


def test_an_import_is_finished(tmp_path, monkeypatch):
    (tmp_path / "pressed_module.py").write_text(
        "from presses import press\npress()\nwhole = True\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "pressed_module", raising=False)
    ended_at_once(lambda: importlib.import_module("pressed_module"))
    assert sys.modules["pressed_module"].whole


def test_an_import_outside_of_the_operation_does_not_wait(tmp_path, monkeypatch):
    (tmp_path / "works_when_imported.py").write_text(
        "from presses import press\n"
        "from quietarm.interrupts import interruptible\n"
        "interruptible(press)()\n"
        "whole = True\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        importlib.import_module("works_when_imported")
    assert "works_when_imported" not in sys.modules


def test_what_a_block_enters_and_leaves_is_done_whole():
    class Door:
        opened = closed = False

        def __enter__(self):
            press()
            self.opened = True

        def __exit__(self, *_):
            self.closed = True

    door = Door()

    def through():
        with door:
            pass

    ended_at_once(through)
    assert door.opened
    assert door.closed


# The edges of an operation


def _edges(frame):
    return frame.f_globals.get("__name__") == "quietarm.interrupts"


def _quiet():
    """An operation that does nothing."""


def test_no_step_of_the_edges_leaves_the_handler_behind():
    quiet = interruptible(_quiet)
    with pressed_at(0, _edges) as steps:
        quiet()
    assert steps[0] > 50
    for number in range(1, steps[0] + 1):
        with pytest.raises(KeyboardInterrupt), pressed_at(number, _edges):
            quiet()
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler, number
        quiet()  # nothing is kept from before


def _block(came):
    try:
        with note_interrupts() as noted:
            came.append("begun")
            came.append("whole")
    finally:
        came += noted if "whole" in came else []


@pytest.mark.parametrize("within_an_operation", [False, True])
def test_no_step_of_a_block_that_is_finished_leaves_anything_behind(within_an_operation):
    block = interruptible(_block) if within_an_operation else _block
    with pressed_at(0, _edges) as steps:
        block([])
    for number in range(1, steps[0] + 1):
        came = []
        raised = False
        try:
            with pressed_at(number, _edges):
                block(came)
        except KeyboardInterrupt:
            raised = True
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler, number
        # pressed once: raised, or noted for the caller
        assert raised or any(isinstance(one, KeyboardInterrupt) for one in came), number
        if not within_an_operation:
            interruptible(_quiet)()


def test_what_is_being_written_is_finished_also_within_another_block():
    done = []
    with note_interrupts() as outer:
        with note_interrupts() as inner:
            press()
            done.append("inner")
        done.append("outer")
    assert done == ["inner", "outer"]
    assert inner == []
    assert [type(one) for one in outer] == [KeyboardInterrupt]


# Other handlers, threads and tracers


def test_a_handler_of_the_users_is_called_and_put_back():
    class AlarmError(Exception):
        pass

    def alarm(number, frame):
        raise AlarmError(number)

    signal.signal(signal.SIGINT, alarm)
    try:
        with pytest.raises(AlarmError):
            interruptible(lambda: ca.DM(Pressing()))()
        assert signal.getsignal(signal.SIGINT) is alarm
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def test_a_handler_that_raises_nothing_stops_nothing():
    came = []
    signal.signal(signal.SIGINT, lambda *_: came.append("pressed"))
    try:
        assert interruptible(lambda: [press(), "done"])() == [None, "done"]
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    assert came == ["pressed"]


@pytest.mark.parametrize("handler", [signal.SIG_IGN, signal.SIG_DFL])
def test_where_no_handler_stands_none_is_installed(handler):
    signal.signal(signal.SIGINT, handler)
    try:
        assert interruptible(lambda: signal.getsignal(signal.SIGINT))() is handler
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def test_other_threads_install_nothing_and_go_on():
    seen = []
    thread = threading.Thread(
        target=interruptible(lambda: seen.append(signal.getsignal(signal.SIGINT)))
    )
    thread.start()
    thread.join()
    assert seen == [signal.default_int_handler]


def test_a_debugger_traces_again_afterwards():
    def tracer(frame, event, argument):
        return None

    sys.settrace(tracer)
    try:
        ended_at_once(lambda: ca.DM(Pressing()))
        assert sys.gettrace() is tracer
    finally:
        sys.settrace(None)


def test_a_second_press_does_not_wait(monkeypatch):
    monkeypatch.setattr("quietarm.interrupts._IMPATIENT_SECONDS", 0.0)
    after = []

    class Slow:
        def __enter__(self):
            press()
            press()
            after.append("went on")

        def __exit__(self, *_):
            pass

    def through():
        with Slow():
            pass

    ended_at_once(through)
    assert after == []
