"""Native printing is silenced, and only while it should be."""

import os

from sim.native_output import silenced_native_output


def test_what_native_code_prints_is_discarded_and_the_rest_is_not(capfd):
    os.write(1, b"before ")
    print("python", end=" ")
    with silenced_native_output():
        print("a binding that prints through Python")
        os.write(1, b"native output")
        os.write(2, b"native error")
    os.write(1, b"after")
    captured = capfd.readouterr()
    assert captured.out == "before python after"
    assert captured.err == ""


def test_it_comes_back_after_an_error(capfd):
    try:
        with silenced_native_output():
            raise ValueError
    except ValueError:
        os.write(2, b"heard")
    assert capfd.readouterr().err == "heard"


def test_descriptors_are_not_leaked():
    def count():
        return len(os.listdir("/dev/fd"))

    before = count()
    for _ in range(3):
        with silenced_native_output():
            pass
    assert count() == before
