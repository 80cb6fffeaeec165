"""The rooms of the Python packages: each imports only what stands below it."""
import ast
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: The folders of each package from the ground up. Rooms of one floor do not import each other.
FLOORS = {
    "aras_visual_servo": (("ground",), ("config",), ("features", "arm"), ("laws",), ("servo",), ("runs",),
                          ("scenario",), ("cli",)),
    "aras_visual_servo_controller": (("bags", "calibration", "real"), ("identification",), ("nodes",), ("ros2",),
                                     ("cli",)),
    "aras_visual_servo_study": (("live",), ("report",), ("sweep",), ("compare",), ("cli",)),
}
#: A Python package imports itself and those before it. Only the table of verbs names those after it, as text.
PACKAGES = tuple(FLOORS)


def folder_of(package):
    return ROOT / "src" / package / "src" / package


def imports_of(path):
    """Dotted names of all that a module imports, relative imports included; the first part is the package."""
    place = path.relative_to(ROOT / "src").with_suffix("").parts[2:]
    tree = ast.parse(path.read_text())
    tree.body = [node for node in tree.body if "TYPE_CHECKING" not in ast.dump(getattr(node, "test", node))
                 or not isinstance(node, ast.If)]  # what only type checkers read is no import
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            above = place[:len(place) - node.level] if node.level else ()
            for alias in node.names:
                yield above + tuple(node.module.split(".") if node.module else ()) + (alias.name,)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                yield tuple(alias.name.split("."))


def upward(package, room, imported):
    """Whether a module of a room may not import this."""
    if imported[0] not in PACKAGES:
        return False
    if imported[0] != package:
        return PACKAGES.index(imported[0]) > PACKAGES.index(package)
    floor_of = {name: floor for floor, rooms in enumerate(FLOORS[package]) for name in rooms}
    target = imported[1]
    return target in floor_of and target != room and floor_of[target] >= floor_of[room]


def modules(package):
    return [path for path in sorted(folder_of(package).rglob("*.py")) if path.parent != folder_of(package)]


@pytest.mark.parametrize("package", PACKAGES)
def test_every_folder_of_the_package_is_a_room_with_a_floor(package):
    rooms = {path.name for path in folder_of(package).iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert rooms == set().union(*FLOORS[package])


@pytest.mark.parametrize("package", PACKAGES)
def test_rooms_import_only_downwards(package):
    found = [f"{path.relative_to(folder_of(package))} imports {'.'.join(imported)}" for path in modules(package)
             for imported in imports_of(path)
             if upward(package, path.relative_to(folder_of(package)).parts[0], imported)]
    assert found == []


def test_the_check_sees_an_import_that_leads_up():
    core = "aras_visual_servo"
    assert upward(core, "features", (core, "laws", "base")) and not upward(core, "laws", (core, "features"))
    assert upward(core, "run", ("aras_visual_servo_study", "sweep"))
    assert (core, "ground", "errors", "ParameterError") in set(imports_of(folder_of(core) / "config" / "files.py"))


@pytest.mark.parametrize("package", PACKAGES)
def test_no_two_modules_import_each_other(package):
    """Depth-first through the imports of modules; one made inside a function counts too."""
    graph = {}
    for path in modules(package):
        name = path.relative_to(folder_of(package).parent).with_suffix("").parts
        graph[name] = {imported[:size] for imported in imports_of(path) for size in (3, 4)
                       if folder_of(package).parent.joinpath(*imported[:size]).with_suffix(".py").exists()} - {name}
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
