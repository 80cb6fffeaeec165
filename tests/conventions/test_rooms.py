"""The rooms of the controller's Python package: each imports only what stands below it, and no folder is crowded."""
import ast
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "aras_visual_servo_controller" / "src" / "aras_visual_servo_controller"
#: From the ground up. Rooms of one floor do not import each other.
FLOORS = (("ground",), ("config",), ("features", "arm"), ("laws",), ("servo",), ("run",), ("scenario",),
          ("live",), ("bags", "report"), ("sweep", "nodes"), ("compare",), ("cli",))
FLOOR_OF = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
#: Names in one folder of source or tests that a newcomer can still take in.
MOST_NAMES = 16


def imports_of(path):
    """Dotted names, from the package down, of everything that a module of the package imports from it."""
    place = path.relative_to(PACKAGE).with_suffix("").parts
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            parts = place[:len(place) - node.level] + tuple((node.module or "").split(".") if node.module else ())
            for alias in node.names:
                yield parts + (alias.name,)
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGE.name + "."):
            yield tuple(node.module.split(".")[1:])


def upward(room, imported):
    """Whether a module of `room` may not import this."""
    target = imported[0]
    return target in FLOOR_OF and target != room and FLOOR_OF[target] >= FLOOR_OF[room]


def modules():
    return [path for path in sorted(PACKAGE.rglob("*.py")) if path.parent != PACKAGE]


def test_every_folder_of_the_package_is_a_room_with_a_floor():
    assert {path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name != "__pycache__"} == set(FLOOR_OF)


def test_rooms_import_only_downwards():
    found = [f"{path.relative_to(PACKAGE)} imports {'.'.join(imported)}" for path in modules()
             for imported in imports_of(path) if upward(path.relative_to(PACKAGE).parts[0], imported)]
    assert found == []


def test_the_check_sees_an_import_that_leads_up():
    assert upward("features", ("laws", "base")) and upward("report", ("bags",)) and not upward("laws", ("features",))
    assert ("ground", "errors", "ParameterError") in set(imports_of(PACKAGE / "config" / "files.py"))


def test_no_two_modules_import_each_other():
    """Depth-first through the imports of modules; one made inside a function counts too."""
    graph = {}
    for path in modules():
        name = path.relative_to(PACKAGE).with_suffix("").parts
        graph[name] = {imported[:size] for imported in imports_of(path) for size in (2, 3)
                       if (PACKAGE.joinpath(*imported[:size])).with_suffix(".py").exists()} - {name}
    done, way = set(), []

    def walk(name):
        assert name not in way, "circle: " + " -> ".join(".".join(step) for step in way[way.index(name):] + [name])
        if name in done:
            return
        way.append(name)
        for other in sorted(graph.get(name, ())):
            walk(other)
        way.pop()
        done.add(name)

    for name in sorted(graph):
        walk(name)


def folders():
    tops = [package / top for package in sorted((ROOT / "src").iterdir())
            for top in ("include", "src", "test", "bench", "scripts", "launch")]
    for top in [*tops, ROOT / "tests", ROOT / "script"]:
        for folder in [top, *sorted(top.rglob("*"))]:
            if folder.is_dir() and folder.name != "__pycache__":
                yield folder


@pytest.mark.parametrize("folder", [pytest.param(path, id=str(path.relative_to(ROOT))) for path in folders()])
def test_no_folder_of_source_or_tests_is_crowded(folder):
    names = [path.name for path in folder.iterdir() if path.name != "__pycache__"]
    assert len(names) <= MOST_NAMES, sorted(names)
