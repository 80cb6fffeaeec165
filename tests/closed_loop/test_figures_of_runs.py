"""The figures of README.md and docs/ that runs in process make are those that the runs make now."""


def test_runs_make_the_figures_that_the_texts_state(docs):
    listed = docs("figures").load()
    made, stated = docs("figure_sources").made_by_runs(listed), listed["figures"]
    off = [f"{name}: found {value:.4g}, stated {stated[name]['value']:g} +-{stated[name]['tolerance']:g}"
           for name, value in made.items() if not abs(value - stated[name]["value"]) <= stated[name]["tolerance"]]
    assert made and not off, "\n".join([*off, "script/figures makes them again"])
