"""The house's rules, read off the source: floors, cycles, light imports, public names."""

import ast
import importlib
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FLOORS = ("spectra", "scenes", "sim")
"""From the ground up: a package may import itself and what is before it."""

HEAVY = ("warp", "colour", "scipy", "matplotlib", "OpenEXR")
"""What the light packages must not load."""

STRANGERS = ("sim.geometry", "sim.optics")
"""Rooms that never import each other; `sim.transport` joins them."""

STUDY = ("sim.study", "sim.commands", "sim.cli")
"""The top floor of `sim`, and those who may call it."""


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


SOURCES = {
    module_name(path): path for floor in FLOORS for path in sorted((ROOT / floor).rglob("*.py"))
}
PACKAGES = [name for name, path in SOURCES.items() if path.name == "__init__.py"]


@cache
def tree(module: str) -> ast.Module:
    return ast.parse(SOURCES[module].read_text(encoding="utf-8"))


@cache
def imports(module: str) -> frozenset[str]:
    """Modules of ours that a module imports, in functions too, as deep as the import names them."""
    found = set()
    for node in statements(tree(module)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import in line {node.lineno}"
            parent = node.module or ""
            found |= {
                full if (full := f"{parent}.{alias.name}") in SOURCES else parent
                for alias in node.names
            }
    return frozenset(name for name in found if name in SOURCES)


def statements(root: ast.AST) -> Iterator[ast.AST]:
    """Everything that may run, which leaves out what is for type checkers only."""
    for node in ast.iter_child_nodes(root):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        yield node
        yield from statements(node)


def belongs_to(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


@pytest.mark.parametrize("module", SOURCES)
def test_imports_only_go_down_a_floor(module: str) -> None:
    height = FLOORS.index(module.split(".", maxsplit=1)[0])
    above = {name for name in imports(module) if FLOORS.index(name.split(".")[0]) > height}
    assert not above


def test_no_module_imports_itself_in_a_circle() -> None:
    # A package's __init__ re-exports its modules, which may import the package's siblings
    # directly: the edges are those between the modules that an import names.
    finished: set[str] = set()

    def visit(module: str, trail: tuple[str, ...]) -> None:
        assert module not in trail, " -> ".join([*trail[trail.index(module) :], module])
        if module in finished:
            return
        for imported in sorted(imports(module)):
            visit(imported, (*trail, module))
        finished.add(module)

    for module in SOURCES:
        visit(module, ())


@pytest.mark.parametrize(("one", "other"), [STRANGERS, STRANGERS[::-1]])
def test_geometry_and_optics_do_not_know_each_other(one: str, other: str) -> None:
    acquainted = {
        module: sorted(name for name in imports(module) if belongs_to(name, other))
        for module in SOURCES
        if belongs_to(module, one)
    }
    assert not {module: names for module, names in acquainted.items() if names}


def test_only_commands_know_the_study_which_knows_no_command() -> None:
    for module in SOURCES:
        strangers = STUDY[1:] if belongs_to(module, STUDY[0]) else STUDY[:1]
        if not any(belongs_to(module, one) for one in STUDY[1:]):
            known = [n for n in imports(module) if any(belongs_to(n, one) for one in strangers)]
            assert not known, module


@pytest.mark.parametrize("package", ["spectra", "scenes", "sim"])
def test_a_light_import_stays_light(package: str) -> None:
    script = (
        f"import sys, {package}\n"
        f"print(*sorted({set(HEAVY)!r} & {{name.split('.')[0] for name in sys.modules}}))"
    )
    result = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert result.stdout.split() == []


@pytest.mark.parametrize("package", PACKAGES)
def test_public_names_are_sorted_and_exist(package: str) -> None:
    names = declared_names(package)
    if not any(defined_names(tree(package))):
        return  # a folder of modules that are imported one by one
    assert names is not None, f"{package} has no __all__"
    assert list(names) == sort_as_ruff(names)
    module = importlib.import_module(package)
    assert [name for name in names if not hasattr(module, name)] == []


@pytest.mark.parametrize("module", sorted(set(SOURCES) - set(PACKAGES)))
def test_a_modules_public_names_are_its_own(module: str) -> None:
    names = declared_names(module)
    if names is None:
        return
    assert list(names) == sort_as_ruff(names)
    assert set(names) <= set(defined_names(tree(module)))


def sort_as_ruff(names: tuple[str, ...]) -> list[str]:
    """Constants, then classes, then the rest: the order that the linter keeps."""
    kinds = {
        name: 0 if name.isupper() and len(name) > 1 else 1 + name[0].islower() for name in names
    }
    return sorted(names, key=lambda name: (kinds[name], name))


def declared_names(module: str) -> tuple[str, ...] | None:
    """What `__all__` lists, or None if there is none."""
    for node in tree(module).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        if any(isinstance(target, ast.Name) and target.id == "__all__" for target in targets):
            return tuple(ast.literal_eval(node.value))
    return None


def defined_names(root: ast.AST) -> Iterator[str]:
    """Names that a module binds at its top, in any branch."""
    for node in ast.iter_child_nodes(root):
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.Import | ast.ImportFrom):
            yield from ((alias.asname or alias.name) for alias in node.names)
        else:
            yield from defined_names(node)
