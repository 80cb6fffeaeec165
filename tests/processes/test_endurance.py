"""script/endurance: goals in fresh graphs on a disturbed machine, and what its two commands make of what they find."""
import collections
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent / "endurance"
sys.path.append(str(FOLDER))

import determinism  # noqa: E402
import soak  # noqa: E402


def test_goals_on_a_disturbed_machine_have_the_hash_of_the_run_in_process():
    expected = determinism.reference()
    tally = determinism.determinism(goals=0, graphs=2, seed=1, at_once=1)
    text, same = determinism.report(tally, expected, 0, 2)
    assert same and sum(tally.hashes.values()) == 2 and sum(tally.disturbances.values()) > 10, text


def test_another_hash_or_a_goal_without_one_is_told():
    expected, other = ("1", "2"), ("1", "3")
    for hashes, faults in (([expected, other], []), ([other], []), ([expected], ["a goal that broke off"]), ([], [])):
        tally = determinism.Tally()
        tally.hashes.update(hashes)
        tally.faults = faults
        assert not determinism.report(tally, expected, 2, 0)[1]
    tally = determinism.Tally()
    tally.hashes.update([expected, expected])
    text, same = determinism.report(tally, expected, 2, 0)
    assert same and "different hashes: 0" in text and "2 goals of 2" in text


def uses(**attributes):
    found = soak.Uses()
    found.hashes[("1", "2")] = 3
    for name, value in attributes.items():
        setattr(found, name, value)
    return found


def test_growth_loss_and_repeated_warnings_are_told():
    flat = [("sim_node 1", 100.0, 104.9)]
    assert soak.report(uses(), flat, "")[1]
    for found, growth, fault in ((uses(), [("sim_node 1", 100.0, 105.1)], ""), (uses(lost=["one image"]), flat, ""),
                                 (uses(published=2, recorded=1), flat, ""), (uses(), [], ""), (uses(), flat, "died"),
                                 (uses(warnings=collections.Counter({"late": 2})), flat, ""),
                                 (uses(hashes=collections.Counter({"1": 1, "2": 1})), flat, "")):
        text, well = soak.report(found, growth, fault)
        assert not well and "NOT well" in text


def test_memory_is_compared_after_the_warm_up():
    memory = soak.Memory("nobody")
    memory.samples["grows at first"] = [(t, min(t, 10.0)) for t in range(101)]
    memory.samples["grows"] = [(t, float(t)) for t in range(101)]
    memory.samples["ends early"] = [(t, 1.0) for t in range(50)]
    assert memory.growth(100.0) == [("grows", 25.0, 95.0), ("grows at first", 10.0, 10.0)]
