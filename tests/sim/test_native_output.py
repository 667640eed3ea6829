"""Native printing is silenced, and only while it should be."""

import os
import subprocess
import sys

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


def test_last_words_are_heard_even_if_another_block_never_ends(tmp_path):
    program = (
        "import sys, os, threading, sim.native_output as native\n"
        "inside = threading.Event()\n"
        "def worker():\n"
        "    with native.silenced_native_output():\n"
        "        inside.set(); threading.Event().wait()\n"
        "threading.Thread(target=worker, daemon=True).start()\n"
        "inside.wait()\n"
        "print('unheard', flush=True); os.write(2, b'unheard')\n"
        "native.end_silence()\n"
        "print('heard', flush=True); print('too', file=sys.stderr, flush=True); os._exit(0)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    assert (done.stdout, done.stderr) == ("heard\n", "too\n")


def test_descriptors_are_not_leaked():
    def count():
        return len(os.listdir("/dev/fd"))

    before = count()
    for _ in range(3):
        with silenced_native_output():
            pass
    assert count() == before
