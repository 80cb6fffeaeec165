"""Bags in parts, compressed, cut, left by a killed recorder: read back as one run."""

import numpy as np
import pytest
from synthetic import make_record

rosbag = pytest.importorskip("rosbag")
from messages import NAMESPACE, messages_of

from aras_visual_servo_controller.bags.bag import read_bag  # noqa: E402
from aras_visual_servo_controller.bags.files import BagError, find_bags  # noqa: E402
from aras_visual_servo_study.report.report import trace_csv  # noqa: E402

PARTS = 3


@pytest.fixture(scope="module")
def messages():
    return list(messages_of(make_record(servo_images=30)))


def write(path, messages, **options):
    with rosbag.Bag(str(path), "w", **options) as bag:
        for topic, message, stamp in messages:
            bag.write(f"{NAMESPACE}/{topic}", message, stamp)
    return path


def write_parts(folder, messages, name="run", skip=(), **options):
    """As `rosbag record --split` does: parts that follow each other in time."""
    bounds = [round(k * len(messages) / PARTS) for k in range(PARTS + 1)]
    return [write(folder / f"{name}_{k}.bag", messages[bounds[k]:bounds[k + 1]], **options)
            for k in range(PARTS) if k not in skip]


@pytest.fixture(scope="module")
def trace(messages, tmp_path_factory):
    return trace_csv(read_bag(write(tmp_path_factory.mktemp("whole") / "run.bag", messages)))


def cut(path, share, unindexed):
    """Leave this share of a bag's chunks, and no index."""
    whole = path.read_bytes()
    at = whole.index(b"index_pos=") + len(b"index_pos=")
    end = int.from_bytes(whole[at:at + 8], "little")
    if unindexed:  # what a killed recorder leaves: the position of the index in the header is still 0
        whole = whole[:at] + bytes(8) + whole[at + 8:]
    path.write_bytes(whole[:4096 + int((end - 4096) * share)])


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_split_and_compressed_bags_are_one_run(tmp_path, messages, trace, compression):
    parts = write_parts(tmp_path, messages, compression=compression)
    for paths in (tmp_path, parts, parts[::-1], parts[1]):
        assert trace_csv(read_bag(paths)) == trace, paths
    assert any("read as one run: run_0.bag, run_1.bag, run_2.bag" in note for note in read_bag(parts[1]).notes)


def test_a_missing_part_is_noted(tmp_path, messages):
    write_parts(tmp_path, messages, skip=(1,))
    assert any("parts of the split bag are missing: 1" in note for note in read_bag(tmp_path).notes)


def test_bags_of_two_runs_with_like_names_are_not_joined(tmp_path, messages, trace):
    write(tmp_path / "run_1.bag", messages)
    assert trace_csv(read_bag(write(tmp_path / "run_0.bag", messages))) == trace
    assert find_bags([tmp_path / "run_0.bag"]) == ([tmp_path / "run_0.bag"], [])


@pytest.mark.parametrize("unindexed", [True, False])
@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_a_cut_bag_is_indexed_on_a_copy_and_read_as_far_as_it_goes(tmp_path, messages, trace, compression, unindexed):
    path = write(tmp_path / "run.bag", messages, compression=compression, chunk_threshold=20000)
    cut(path, 0.6, unindexed)
    before = path.read_bytes()
    record = read_bag(path)
    assert 5 < len(record) < len(trace.splitlines()) - 1
    assert trace_csv(record).splitlines() == trace.splitlines()[:len(record) + 1]
    assert any("run.bag was not closed, or was cut: a copy was indexed" in note for note in record.notes)
    assert path.read_bytes() == before


def test_the_last_part_may_be_one_that_was_not_closed(tmp_path, messages):
    parts = write_parts(tmp_path, messages, chunk_threshold=20000)
    active = parts[-1].rename(tmp_path / "run_2.bag.active")
    cut(active, 0.6, unindexed=True)
    record = read_bag(parts[0])
    assert len(record) > 20 and np.all(np.diff(record.stamp_ns) > 0)
    assert {"read as one run: run_0.bag, run_1.bag, run_2.bag.active"} <= set(record.notes)


def test_what_is_not_there_is_named_with_what_is(tmp_path, messages):
    with pytest.raises(BagError, match="holds no bag"):
        read_bag(tmp_path)
    write(tmp_path / "run.bag.active", messages)
    with pytest.raises(BagError, match="run.bag': no such file; there is run.bag.active"):
        read_bag(tmp_path / "run.bag")
    write_parts(tmp_path, messages, name="other")
    with pytest.raises(BagError, match="there are other_0.bag, other_1.bag, other_2.bag"):
        read_bag(tmp_path / "other.bag")


def test_a_bag_with_nothing_behind_its_header_is_an_error_with_its_name(tmp_path, messages):
    path = write(tmp_path / "run.bag", messages)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(BagError, match="run.bag"):
        read_bag(path)
