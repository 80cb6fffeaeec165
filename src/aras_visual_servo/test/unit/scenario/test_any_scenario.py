"""Whatever stands in a scenario, it is a scenario or refused with the faults; what was found has a test of its own."""
import copy

from hypothesis import given, settings, strategies as st

from aras_visual_servo import ArasError, load_scenario, scenario_from_dict

SHIPPED = {name: load_scenario(name) for name in ("experiment_1", "six_dof_rectangle")}
ODD = st.sampled_from([
    None, True, "", "xn", "..", "a/b", "package://nobody/x", 0, -1, 10**400, 2**63, 1e308, -1e308, 5e-324, float("inf"),
    float("nan"), [], {}, [[]], {"": 1}, {1: 2}, {None: 0}, [{}], "9" * 300])
VALUES = st.recursive(ODD | st.integers() | st.floats() | st.text(max_size=5),
                      lambda inner: st.lists(inner, max_size=4)
                      | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=6)


def places(node, way=()):
    """Ways to everything in a document."""
    for key, value in node.items() if isinstance(node, dict) else enumerate(node):
        yield (*way, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*way, key))


def changed(document, way, value):
    *parents, last = way
    node = document
    for key in parents:
        node = node[key]
    node[last] = value


def outcome(document, base):
    try:
        scenario_from_dict(document, base=base)
    except ArasError as error:
        assert str(error)


@settings(deadline=None, max_examples=200, derandomize=True)
@given(st.data())
def test_any_value_anywhere_is_accepted_or_refused(data):
    scenario = SHIPPED[data.draw(st.sampled_from(sorted(SHIPPED)))]
    document = copy.deepcopy(scenario.as_dict())
    changed(document, data.draw(st.sampled_from(list(places(document)))), data.draw(VALUES))
    outcome(document, scenario.path.parent)


@settings(deadline=None, max_examples=100, derandomize=True)
@given(st.data())
def test_any_override_is_accepted_or_refused(data):
    scenario = SHIPPED["experiment_1"]
    ways = [way for way in places(scenario.as_dict()) if all(isinstance(key, str) for key in way)]
    way = data.draw(st.sampled_from(ways))
    try:
        scenario.with_overrides({".".join(way): data.draw(VALUES)})
    except ArasError as error:
        assert str(error)
