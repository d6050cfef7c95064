"""Small dense algebra runs on one thread, and the process has its own number afterwards."""

import threading

import numpy as np
import pytest
from threadpoolctl import ThreadpoolController, threadpool_limits

import quietarm as qa
from quietarm.models.one_thread import on_one_thread

BLAS = ThreadpoolController().select(user_api="blas")


def threads():
    """Return how many threads each library of linear algebra has."""
    return [library.num_threads for library in BLAS.lib_controllers]


@pytest.fixture(autouse=True)
def three_threads():
    with threadpool_limits(3, user_api="blas"):
        if 3 not in threads():
            pytest.skip("numpy's linear algebra has one thread here")
        yield


def test_one_within_and_as_before_outside():
    before = threads()
    inner = on_one_thread(threads)
    outer = on_one_thread(lambda: (inner(), threads()))
    assert outer() == ([1] * len(before), [1] * len(before))
    assert threads() == before


def test_an_error_restores_them():
    before = threads()

    @on_one_thread
    def fails():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fails()
    assert threads() == before


def test_the_last_of_two_threads_restores_them():
    before = threads()
    begun = threading.Event()
    may_end = threading.Event()

    @on_one_thread
    def waits():
        begun.set()
        assert may_end.wait(30)

    other = threading.Thread(target=waits)
    other.start()
    assert begun.wait(30)
    on_one_thread(lambda: None)()
    assert set(threads()) == {1}  # the other is not done
    may_end.set()
    other.join()
    assert threads() == before


def test_a_number_that_is_chosen_meanwhile_stays():
    with threadpool_limits(3, user_api="blas"):
        on_one_thread(lambda: [library.set_num_threads(2) for library in BLAS.lib_controllers])()
        assert 2 in threads()


def test_digits_do_not_depend_on_the_number_of_threads():
    task = qa.PointToPoint(qa.SingleLinkManipulator(), qa.deg(30), 0.8, torque_limit=0.3)
    digits = []
    for count in (1, 3):
        with threadpool_limits(count, user_api="blas"):
            plan = qa.plan_move(task, qa.CycloidPolynomial(18), starts=1)
            digits.append(np.array([*plan.coefficients, plan.energy, plan.residual]).tobytes())
            assert max(threads()) == count
    assert digits[0] == digits[1]
