"""Whatever a YAML file holds, it is read or refused by name; and what was found by trying has a test of its own."""
import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import load_yaml, ParameterError

#: Pieces that YAML gives a meaning to.
PIECES = st.sampled_from([
    "a", "b: ", "- ", "{", "}", "[", "]", ",", "? ", ": ", "\n", "\n  ", "&x ", "*x", "<<: ", "!!int ", "!!float ",
    "!!timestamp ", "!!binary ", "!!set ", "!!python/name:os.system ", "2001-99-99", "1e999", "0x", "9" * 5000, ".inf",
    "~", "'", '"', "|\n", ">\n", "---\n", "%TAG", "# ", "\t", "\ufeff", "12:61"])
TEXTS = st.one_of(st.lists(PIECES, max_size=30).map("".join), st.text(max_size=200))


def load(folder, data):
    path = folder / "any.yaml"
    path.write_bytes(data)
    try:
        found = load_yaml(path)
    except ParameterError as error:
        assert str(path) in str(error)
        return error
    assert isinstance(found, dict)
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("yaml")


@settings(deadline=None, max_examples=1000, derandomize=True)
@given(TEXTS)
def test_any_text_is_a_mapping_or_refused_by_the_name_of_its_file(folder, text):
    load(folder, text.encode("utf-8", "surrogatepass"))


@settings(deadline=None, max_examples=300, derandomize=True)
@given(st.binary(max_size=200))
def test_any_bytes_are_a_mapping_or_refused_by_the_name_of_their_file(folder, data):
    load(folder, data)


@pytest.mark.parametrize("text", ["a: 2001-99-99", "a: " + "9" * 5000, "a: !!int b", "a: !!float b", "a: !!timestamp b",
                                  "a: 2001-01-01 00:00:00 +99", "[a]: b", "? {a: b}\n: c", "a: !!set {[b]}"])
def test_a_value_that_does_not_exist_is_refused_with_its_line(folder, text):
    error = load(folder, f"first: 1\n{text}\n".encode())
    assert isinstance(error, ParameterError), f"found {error}"
    assert str(error).startswith(f"{folder}/any.yaml:2: ")


@pytest.mark.parametrize("text", ["a:\n\tb: 1", "a:\n  b: 1\n\tc: 2", "a: 1\n\tb: 2"])
def test_a_tab_in_the_indentation_is_called_a_tab(folder, text):
    error = load(folder, text.encode())
    line = 1 + text[:text.index("\t")].count("\n")
    assert str(error).startswith(f"{folder}/any.yaml:{line}: ") and "tab" in str(error)


def test_other_tabs_and_other_faults_are_not_blamed_on_tabs(folder):
    assert load(folder, b"a:\tb # \t\n") == {"a": "b"}
    assert "tab" not in str(load(folder, b"a: [\n"))
