"""README's examples work: its Python runs, its TOML loads, its commands parse."""

import re
import shlex
from pathlib import Path

import pytest

import scenes
from sim.cli import parse_arguments

README = Path(__file__).parent.parent / "README.md"
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", README.read_text("utf-8"), re.DOTALL | re.MULTILINE)


def blocks(language):
    return [text for kind, text in BLOCKS if kind == language]


def commands():
    """Every command line that starts with `nephroid`, without its comment."""
    lines = "".join(blocks("sh")).splitlines()
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("nephroid")]


def test_there_are_examples_of_each_kind():
    assert len(blocks("toml")) >= 1
    assert len(blocks("python")) >= 3
    assert len(commands()) >= 6


@pytest.mark.parametrize("text", blocks("toml"))
def test_scene_files_load_and_can_be_rendered(text):
    scenes.loads(text, name="README").require_renderable()


@pytest.mark.parametrize("arguments", commands(), ids=" ".join)
def test_commands_parse(arguments):
    assert parse_arguments(arguments).command == arguments[0]


def test_python_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball_on_table.toml").write_text(blocks("toml")[0], "utf-8")
    namespace = {}
    for text in blocks("python"):
        exec(compile(text, "README.md", "exec"), namespace)
    printed = capsys.readouterr().out
    # What the comments in README say is printed.
    assert printed.startswith("1.51680")
    assert "64.16" in printed.splitlines()[0]
    assert "('refract', 'refract', 'deposit')\n67.163" in printed
    assert (tmp_path / "ball.exr").exists()
    assert (tmp_path / "ball.png").exists()
