"""Ctrl-C while a worker is busy."""

import signal
import threading

import pytest

from sim.interruption import run_interruptibly


def test_the_result_comes_back():
    assert run_interruptibly(lambda: 42) == 42
    assert run_interruptibly(lambda: None) is None


def test_the_work_runs_in_another_thread():
    assert run_interruptibly(threading.current_thread) is not threading.current_thread()


def test_errors_come_back_as_they_are():
    error = ValueError("from the worker")

    def fail():
        raise error

    with pytest.raises(ValueError, match="from the worker") as caught:
        run_interruptibly(fail)
    assert caught.value is error


def test_ctrl_c_does_not_wait_for_the_work():
    release = threading.Event()

    def busy():
        # What the terminal does on Ctrl-C; Python hands it to the main thread.
        signal.raise_signal(signal.SIGINT)
        release.wait()

    try:
        with pytest.raises(KeyboardInterrupt):
            run_interruptibly(busy)
        assert not release.is_set()
    finally:
        release.set()
