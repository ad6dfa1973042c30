"""Work that is shared with copies of this process."""

import os
import time

import pytest

from flexapod.processes import started


def slow_square(x):
    time.sleep(0.05)
    return x * x, os.getpid()


def test_results_keep_their_order_and_several_processes_work():
    found = started(slow_square, range(8), 2)()
    assert [square for square, _ in found] == [x * x for x in range(8)]
    assert len({process for _, process in found}) == 2


@pytest.mark.parametrize("processes", [1, 2, 5])
def test_what_fails_is_raised_here(processes):
    def fails(x):
        if x == 2:
            raise ValueError("two")
        return x

    with pytest.raises(ValueError, match="two"):
        started(fails, range(4), processes)()


def test_a_copy_that_dies_is_made_good():
    here = os.getpid()

    def dies(x):
        time.sleep(0.02)
        if os.getpid() != here:
            os._exit(9)
        return x

    assert started(dies, range(5), 2)() == list(range(5))


def test_copies_work_before_they_are_waited_for():
    joined = started(slow_square, range(3), 2)
    time.sleep(1.5)  # ten times what the copy needs
    assert os.getpid() not in {process for _, process in joined()}


def test_nothing_to_do():
    assert started(slow_square, (), 2)() == []
