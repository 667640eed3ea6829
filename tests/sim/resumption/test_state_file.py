"""State files come back as they went, or say that they are not whole; nothing else happens."""

import hashlib
import json

import numpy as np
import pytest

from sim.errors import FileFormatError
from sim.resumption import state_file
from sim.resumption.state_file import MAGIC, encode_state, read_state

NUMBERS = {"passes": 3, "seconds": 0.1, "fingerprint": {"scene": {"film": [1, 2.5, "ü"]}}}
ARRAYS = {
    "mean": np.random.default_rng(1).normal(size=(5, 4)),
    "count": np.array(7, dtype=np.int64),
    "lot": np.float32([0.25, np.nan, np.inf]),
    "none": np.zeros((0, 3)),
    "row": np.arange(12, dtype=np.int32).reshape(3, 4).T,  # not contiguous
}


def content(numbers=NUMBERS, arrays=ARRAYS):
    return b"".join(bytes(piece) for piece in encode_state(numbers, arrays))


def read(tmp_path, data):
    (tmp_path / "file").write_bytes(data)
    return read_state(tmp_path / "file")


@pytest.mark.parametrize("piece", [1, 7, 1 << 22])
def test_everything_comes_back_bit_by_bit(tmp_path, monkeypatch, piece):
    monkeypatch.setattr(state_file, "PIECE", piece)
    stored = read(tmp_path, content())
    assert stored.numbers == NUMBERS
    assert list(stored.arrays) == list(ARRAYS)
    for name, array in ARRAYS.items():
        back = stored.arrays[name]
        assert back.dtype == array.dtype
        assert back.shape == array.shape
        assert back.tobytes() == np.ascontiguousarray(array).tobytes()


def test_a_file_cut_short_anywhere_is_an_error(tmp_path):
    data = content()
    for length in range(len(data)):
        with pytest.raises(FileFormatError, match=r"cut short|no checkpoint"):
            read(tmp_path, data[:length])


def test_a_flipped_bit_anywhere_is_an_error(tmp_path):
    data = content()
    for place in range(len(data)):
        damaged = bytearray(data)
        damaged[place] ^= 1 << (place % 8)
        with pytest.raises(FileFormatError):
            read(tmp_path, bytes(damaged))


def forged(header, body=b"", length=None):
    """A file whose digest is right, whatever its header says."""
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    size = len(text) if length is None else length
    data = MAGIC + size.to_bytes(8, "little") + text + body
    return data + hashlib.sha256(data).digest()


@pytest.mark.parametrize(
    "data",
    [
        forged(b"not JSON"), forged(b"\xff\xfe"), forged(b"[" * 100_000), forged(b"9" * 5000),
        forged([]), forged({}), forged({"numbers": {}}), forged({"numbers": [], "arrays": []}),
        forged({"numbers": {}, "arrays": [["a", "|O", [1]]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [["a", "<f8", [2**62, 4]]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [["a", "<f8", [-1, -1]]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [["a", "<f8", [True]]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [["a", "<f8", 1]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [["a", "<f8", ["1"]]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [[["a"], "<f8", [1]]]}, bytes(8)),
        forged({"numbers": {}, "arrays": [["a", "<f8", [1]], ["a", "<f8", [1]]]}, bytes(16)),
        forged({"numbers": {}, "arrays": [["a", "<f8", [0] * 100]]}),
        forged({"numbers": {}, "arrays": [["a", "<f8", [1]]]}, bytes(9)),
        forged({"numbers": {}, "arrays": []}, length=2**63), forged(b"", length=1),
        b"", b"PK\x03\x04" + bytes(100), bytes(1000),
    ],
)  # fmt: skip
def test_hostile_files_are_errors(tmp_path, data):
    with pytest.raises(FileFormatError, match="cannot read"):
        read(tmp_path, data)


def test_only_plain_numbers_go_in():
    with pytest.raises(TypeError):
        content(arrays={"a": np.array(["text"])})
