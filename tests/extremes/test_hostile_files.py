"""Meshes, heights, masks and EXR files that claim more than they hold, or than may be."""

import json
import struct
import zlib

import numpy as np
import pytest

import scenes
import sim
from sim.errors import FileFormatError
from sim.image import exr_claims
from sim.image.exr import encode_channels
from sim.image.exr_layout import EMISSIVE_UNITS, radiance_channel

PLACE = {"position": (0.0, 0.0, 0.0)}


def refused(path, content, kind=scenes.Mesh, **fields) -> str:
    """What is said of a file that must be refused."""
    path.write_bytes(content)
    with pytest.raises(scenes.SceneError) as caught:
        kind(file=str(path), **fields)
    (problem,) = caught.value.problems
    assert problem.path == "file"
    assert len(problem.message) < 1000
    return problem.message


def ply(count: str) -> bytes:
    return (
        f"ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    ).encode()


def glb(document: object) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunk = struct.pack("<II", len(text), 0x4E4F534A) + text
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunk)) + chunk


@pytest.mark.parametrize("count", ["1000000000000", "9" * 30, "-1", "1e3"])
def test_a_ply_header_that_claims_too_much(tmp_path, count) -> None:
    assert "its header c" in refused(tmp_path / "a.ply", ply(count), **PLACE)


def test_an_stl_header_that_claims_too_much(tmp_path) -> None:
    content = bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(50)
    message = refused(tmp_path / "a.stl", content, **PLACE)
    assert "claims 4294967295 triangles" in message


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ({"buffers": [{"uri": "/etc/passwd", "byteLength": 9}]}, "refers to another file"),
        ({"accessors": [{"count": 10**12, "bufferView": 0}]}, "claims 1000000000000 elements"),
        ({"accessors": [{"count": 9, "type": "VEC3"}]}, "names no data"),
        ({"nodes": [{"children": [1, 1]}, {}]}, "no tree"),
        ({"nodes": [{"children": [1]}, {"children": [0]}]}, "no tree"),
        ({"nodes": [{"children": [i + 1]} for i in range(200)] + [{}]}, "nested 101 deep"),
        ({"nodes": [{}] * 10_001}, "at most 10000"),
        ({"nodes": 1}, "no array"),
        ([], "no array"),
    ],
)
def test_a_glb_that_claims_too_much(tmp_path, document, words) -> None:
    assert words in refused(tmp_path / "a.glb", glb(document), **PLACE)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\n", "not a valid OBJ"),
        ("v 0 0 0\nv 1 0 0\nv 0 1e300 0\nf 1 2 3\n", "it reaches 1e+300 m from its origin"),
        ("f 1 2 3\n", "cannot be used"),
    ],
)
def test_an_obj_that_is_wrong(tmp_path, text, words) -> None:
    assert words in refused(tmp_path / "a.obj", text.encode(), **PLACE)


def test_an_obj_reads_no_other_file_and_counts_from_the_end(tmp_path) -> None:
    # A comment in another encoding is no reason to refuse it.
    text = b"# Gr\xf6\xdfe\nmtllib /dev/zero\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"
    path = tmp_path / "a.obj"
    path.write_bytes(text)
    surface = scenes.Mesh(file=str(path), **PLACE).local_surface()
    assert surface.corners.tolist() == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]


def npy(header: str) -> bytes:
    text = header.encode() + b" " * (-(len(header) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(64)


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000, 1000000)}", "of shape"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 1000)}", "cut off"),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (2, 2)}", "no real numbers"),
        ("{'descr': '<c16', 'fortran_order': False, 'shape': (2, 2)}", "no real numbers"),
        ("{'descr': '<f8'}", "no .npy file"),
    ],
)
def test_heights_that_claim_too_much(tmp_path, header, words) -> None:
    kind = {"kind": scenes.HeightField, "size": (1.0, 1.0)}
    assert words in refused(tmp_path / "a.npy", npy(header), **kind, **PLACE)


def test_a_row_of_heights_without_end(tmp_path) -> None:
    kind = {"kind": scenes.HeightField, "size": (1.0, 1.0)}
    message = refused(tmp_path / "a.txt", b"0 " * 1_000_000, **kind, **PLACE)
    assert "more than 1001 numbers a side" in message


def png(width: int, height: int) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    data = zlib.compress(bytes(1000))
    chunks = chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + chunks


@pytest.mark.parametrize("side", [2049, 12_000, 2**31 - 1])
def test_an_image_bomb(tmp_path, side) -> None:
    # 12,000² is where Pillow only warns, (2³¹ − 1)² where it refuses.
    message = refused(tmp_path / "a.png", png(side, side), scenes.Mask)
    assert "at most 2048 pixels a side" in message


def test_no_image_is_handed_to_another_program(tmp_path) -> None:
    eps = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 8 8\n%%EndComments\nshowpage\n"
    assert "it is no such image" in refused(tmp_path / "a.eps", eps, scenes.Mask)


def exr(attributes=None, shape=(4, 6)) -> bytes:
    channels = {radiance_channel(550.0): np.zeros(shape, dtype=np.float32)}
    return bytes(
        encode_channels(channels, attributes or {}, units=EMISSIVE_UNITS, exposure_stops=0.0)
    )


def with_window(content: bytes, *window: int) -> bytes:
    changed = bytearray(content)
    for name in (b"dataWindow", b"displayWindow"):
        place = content.index(name + b"\0box2i\0") + len(name) + 7 + 4
        struct.pack_into("<4i", changed, place, *window)
    return bytes(changed)


@pytest.mark.parametrize(
    ("window", "words"),
    [
        ((0, 0, 99_999, 99_999), "it claims 40000000000 bytes of pixels in a file of"),
        ((-(2**31), -(2**31), 2**31 - 1, 2**31 - 1), "bytes of pixels in a file of"),
        ((5, 5, 0, 0), "a data window of -4 × -4 pixels"),
    ],
)
def test_an_exr_that_claims_too_much(tmp_path, window, words) -> None:
    path = tmp_path / "a.exr"
    path.write_bytes(with_window(exr(), *window))
    with pytest.raises(FileFormatError) as caught:
        sim.read_exr(path)
    assert words in str(caught.value)


def test_a_black_picture_of_our_own_is_no_bomb(tmp_path, monkeypatch) -> None:
    # As if it were larger than what is read whatever it claims: it shrinks by more than 64 times,
    # and by less than any file can.
    monkeypatch.setattr(exr_claims, "_ALWAYS_READ", 0)
    path = tmp_path / "black.exr"
    path.write_bytes(exr(shape=(1024, 1024)))
    assert 64 < 4 * 1024**2 / path.stat().st_size < 1024
    assert sim.read_exr(path).spectral_radiance.shape == (1024, 1024, 1)
    path.write_bytes(with_window(path.read_bytes(), 0, 0, 99_999, 99_999))
    with pytest.raises(FileFormatError, match="it claims 40000000000 bytes of pixels"):
        sim.read_exr(path)


@pytest.mark.parametrize("text", ["{", "[1]", "[" * 100_000, "NaN", '{"a": '])
def test_attributes_that_are_no_tables_are_told(tmp_path, text, capfd) -> None:
    from sim.cli import main

    path = tmp_path / "a.exr"
    path.write_bytes(exr({"nephroid_settings": text}))
    assert main(["info", str(path)]) == 2
    assert "its attribute 'settings' is not what Nephroid writes there" in capfd.readouterr().err


@pytest.mark.parametrize("text", [
    '[[1, 2]]', '"a"', "[[1, 2, 3, 4, {}]]", "7", f"[[1, 2, 3, 4, {10**400}]]", "[[[1]]]",
    '{"a": 1}',
])  # fmt: skip
def test_books_of_bands_that_are_no_table_are_told(tmp_path, text, capfd) -> None:
    from sim.cli import main

    path = tmp_path / "a.exr"
    path.write_bytes(exr({"nephroid_energy": f'{{"by_band": {text}}}'}))
    assert main(["info", str(path)]) == 2
    assert "by_band of its attribute 'energy' is not a table" in capfd.readouterr().err


@pytest.mark.parametrize("edges", ['"a"', "[1]", "[[1, 2]]", f"[1, {10**400}]", "{", "[1, null]"])
def test_bands_of_books_that_are_no_edges_are_numbered(tmp_path, edges, capfd) -> None:
    from sim.cli import main

    path = tmp_path / "a.exr"
    books = '{"by_band": [[1, 2, 3, 4, 5]]}'
    path.write_bytes(exr({"nephroid_energy": books, "nephroid_film_edges_nm": edges}))
    assert main(["info", str(path)]) == 0
    assert capfd.readouterr().out.splitlines()[-1].split() == ["band", *"112345"]


@pytest.mark.parametrize("depth", [20, 500, 700, 900])
@pytest.mark.parametrize("ends", ["[]", ['{"a":', "}"]])
def test_values_nested_deep_are_cut_short(tmp_path, depth, ends, capfd) -> None:
    from sim.cli import main

    path = tmp_path / "a.exr"
    value = f"{ends[0] * depth}1{ends[1] * depth}"
    path.write_bytes(exr({"nephroid_settings": f'{{"photons": {value}}}'}))
    assert main(["info", str(path)]) in (0, 2)
    told = capfd.readouterr()
    assert "…" in told.out or "not what Nephroid writes there" in told.err


def test_what_a_terminal_would_obey_is_not_printed(tmp_path, capfd) -> None:
    from sim.cli import main

    path = tmp_path / "a.exr"
    path.write_bytes(exr({"nephroid_version": "\x1b[2J1.0"}))
    assert main(["info", str(path)]) == 0
    assert "\x1b" not in capfd.readouterr().out


def test_channels_of_different_sizes_are_told(tmp_path, monkeypatch) -> None:
    # Pictures of luminance and chroma have such; the library reads them, and writes none.
    from sim.image import exr_reading

    pixels = {"S0.450nm": np.zeros((4, 4)), "S0.550nm": np.zeros((2, 2))}
    monkeypatch.setattr(exr_reading, "_read_part", lambda _path: ({}, pixels))
    with pytest.raises(FileFormatError, match="its channels differ in size"):
        sim.read_exr(tmp_path / "a.exr")
