"""Meshes from files: four formats, units, normals, and what a dielectric needs."""

import json
import struct

import numpy as np
import pytest

import scenes

# A box of 2 × 3 × 4, corner by corner, its faces counter-clockwise seen from outside.
POINTS = np.array([[x, y, z] for x in (-1, 1) for y in (-1.5, 1.5) for z in (-2, 2)], dtype=float)
FACES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip
VOLUME = 24.0


def obj(faces=FACES, points=POINTS):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    return "\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces)]).encode()


def ply():
    head = (
        f"ply\nformat ascii 1.0\nelement vertex {len(POINTS)}\nproperty float x\n"
        f"property float y\nproperty float z\nelement face {len(FACES)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    rows = [" ".join(map(str, point)) for point in POINTS]
    return (head + "\n".join([*rows, *(f"3 {a} {b} {c}" for a, b, c in FACES)]) + "\n").encode()


def stl():
    rows = b"".join(
        struct.pack("<12fH", 0, 0, 0, *POINTS[face].ravel(), 0) for face in FACES
    )
    return bytes(80) + struct.pack("<I", len(FACES)) + rows


def glb(scale=1.0):
    """The least that a binary glTF can be: one mesh, one node, scaled."""
    points, faces = POINTS.astype("<f4").tobytes(), FACES.astype("<u4").tobytes()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [scale] * 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points) + len(faces)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(faces)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(POINTS), "type": "VEC3",
             "min": POINTS.min(axis=0).tolist(), "max": POINTS.max(axis=0).tolist()},
            {"bufferView": 1, "componentType": 5125, "count": FACES.size, "type": "SCALAR"},
        ],
    }  # fmt: skip
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text
    body += struct.pack("<I4s", len(points + faces), b"BIN\0") + points + faces
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


FILES = {"box.obj": obj, "box.ply": ply, "box.stl": stl, "box.glb": glb}


@pytest.fixture
def write(tmp_path):
    def write_file(name, content):
        (tmp_path / name).write_bytes(content)
        return str(tmp_path / name)

    return write_file


def mesh(file, **fields):
    return scenes.Mesh(position=(0.0, 0.0, 0.0), file=file, **fields)


def glass(shape):
    return scenes.SceneObject(shape=shape, material=scenes.Dielectric(medium="N-BK7"))


@pytest.mark.parametrize("name", FILES)
def test_every_format_is_read_and_its_corners_joined(write, name) -> None:
    surface = mesh(write(name, FILES[name]())).local_surface()
    assert (len(surface.vertices), len(surface.triangles)) == (8, 12)
    assert surface.volume == pytest.approx(VOLUME, rel=1e-15)
    assert surface.corner_normals is None


@pytest.mark.parametrize("header", [b"solid", b"  SOLID of \xb5m, exported"])
def test_the_header_of_a_binary_stl_may_begin_as_text_does(write, header) -> None:
    # As many exporters write it; its length, 84 + 50 n, says that it is none, and no byte may
    # change: 0xb5 is in the header, and bytes beyond 0x7f are in the coordinates.
    content = header.ljust(80) + stl()[80:]
    assert any(byte > 0x7F for byte in content[84:])
    surface = mesh(write("box.stl", content)).local_surface()
    assert (len(surface.vertices), len(surface.triangles)) == (8, 12)
    assert surface.volume == pytest.approx(VOLUME, rel=1e-15)


def test_an_stl_of_text_is_read(write) -> None:
    rows = ["solid box"]
    for face in FACES:
        corners = "".join(f"vertex {x} {y} {z}\n" for x, y, z in POINTS[face])
        rows.append(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet")
    text = "\n".join([*rows, "endsolid box\n"]).encode()
    assert mesh(write("box.stl", text)).local_surface().volume == pytest.approx(VOLUME, rel=1e-15)


def test_a_node_of_a_glb_is_where_its_transform_puts_it(write) -> None:
    surface = mesh(write("box.glb", glb(scale=0.5))).local_surface()
    assert surface.volume == pytest.approx(VOLUME / 8.0, rel=1e-15)


def test_the_unit_scales_the_file(write, tmp_path) -> None:
    file = write("box.obj", obj())
    assert mesh(file, unit=0.01).local_surface().volume == pytest.approx(VOLUME * 1e-6, rel=1e-14)
    text = """
    length_unit = "mm"
    [[objects]]
    shape = { type = "mesh", position = [0, 0, 0], file = "box.obj" }
    material = { type = "absorber" }
    """
    shape = scenes.loads(text, folder=tmp_path).objects[0].shape
    assert shape.unit == 0.001
    assert shape.local_surface().volume == pytest.approx(VOLUME * 1e-9, rel=1e-14)


def test_a_scene_comes_back_from_its_own_text(write, tmp_path) -> None:
    write("box.obj", obj())
    text = """
    length_unit = "mm"
    [[objects]]
    shape = { type = "mesh", position = [0, 0, 0], file = "box.obj", normals = "smooth" }
    material = { type = "absorber" }
    """
    scene = scenes.loads(text, folder=tmp_path)
    again = scenes.loads(scene.to_toml(), folder=tmp_path)
    assert again.model_dump() == scene.model_dump()
    one, other = (each.objects[0].shape.local_surface() for each in (scene, again))
    np.testing.assert_array_equal(one.vertices, other.vertices)


def test_the_files_normals_are_taken_toward_the_outside(write) -> None:
    tilted = np.array([0.6, 0.0, 0.8])
    text = (
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0 0.8\nvn -0.6 0 -0.8\nvn 0 0 1\nf 1//1 2//2 3//3\n"
    )
    normals = mesh(write("one.obj", text.encode())).local_surface().corner_normals
    assert normals is not None
    # By their places: the corners' order is the file's, whatever became of the vertices'.
    np.testing.assert_allclose(normals[0], [tilted, tilted, [0.0, 0.0, 1.0]], atol=1e-15)
    flat = mesh(write("one.obj", text.encode()), normals="flat").local_surface()
    assert flat.corner_normals is None


def test_glass_needs_a_closed_mesh_and_counts_what_is_open(write) -> None:
    assert glass(mesh(write("box.obj", obj()))).shape.is_closed
    with pytest.raises(scenes.SceneError, match="not watertight: 4 open edges") as caught:
        # Two triangles that share an edge of their three each.
        glass(mesh(write("open.obj", obj(np.delete(FACES, [0, 5], axis=0)))))
    assert caught.value.problems[0].path == "material.type"


def test_glass_refuses_a_mesh_that_is_inside_out_until_it_is_turned(write) -> None:
    file = write("inverted.obj", obj(FACES[:, ::-1]))
    with pytest.raises(scenes.SceneError, match="inside out"):
        glass(mesh(file))
    assert glass(mesh(file, turned=True)).shape.local_surface().volume == pytest.approx(VOLUME)


def test_glass_refuses_triangles_that_disagree(write) -> None:
    mixed = FACES.copy()
    mixed[4] = mixed[4, ::-1]
    with pytest.raises(scenes.SceneError, match="3 turned edges"):
        glass(mesh(write("mixed.obj", obj(mixed))))


def test_an_opaque_mesh_may_be_open(write) -> None:
    shape = mesh(write("open.obj", obj(FACES[:-1])))
    assert scenes.SceneObject(shape=shape, material=scenes.Absorber()).shape is shape


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.ply", b"junk", "not a valid PLY file"),
        ("a.glb", b"glTF", "not a valid GLB file"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n", "cannot be used"),
        ("a.stl", b"", "cannot be used"),
        ("a.obj", b"v 0 0 0\n", "holds no triangles"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "not finite"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n", "no triangle"),
        ("a.txt", b"solid", "must end in one of: ply, obj, stl, glb"),
    ],
)
def test_what_is_wrong_with_a_file_is_said(write, name, content, words) -> None:
    with pytest.raises(scenes.SceneError, match=words) as caught:
        mesh(write(name, content))
    assert caught.value.problems[0].path == "file"
    assert "a file of triangles" in caught.value.problems[0].allowed


def test_every_byte_cut_off_a_file_ends_in_a_scene_error_or_a_mesh(write) -> None:
    for name, make in FILES.items():
        content = make()
        for length in range(0, len(content), max(1, len(content) // 40)):
            try:
                mesh(write(name, content[:length]))
            except scenes.SceneError:
                continue


def test_a_changed_file_is_read_again(write) -> None:
    assert len(mesh(write("box.obj", obj())).local_surface().triangles) == 12
    assert len(mesh(write("box.obj", obj(FACES[:-1]))).local_surface().triangles) == 11


def test_the_bounds_hold_every_corner(write) -> None:
    shape = scenes.Mesh(
        position=(5.0, 1.0, -2.0), rotation_deg=(10.0, 20.0, 30.0), file=write("box.obj", obj())
    )
    centre, radius = shape.bounding_sphere()
    distances = np.linalg.norm(shape.vertices_world() - centre, axis=1)
    assert distances.max() == pytest.approx(radius, rel=1e-14)
