"""RunRecord from a rosbag written here: topics found under any namespace, rows paired by stamp."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
import rosbag
import rospy
import yaml
from aras_visual_servo_msgs.msg import RecordingCounts
from messages import NAMESPACE, image_message, messages_of, state_message, write
from std_msgs.msg import String
from synthetic import SETTINGS, blob, make_record

from aras_visual_servo import ParameterError, ShapeError, image_of
from aras_visual_servo_controller.bags.bag import BagError, read_bag
from aras_visual_servo.cli.main import main
from aras_visual_servo.features import base as features
from aras_visual_servo import styles
from aras_visual_servo.runs.judge import judge

SERVO_IMAGES = 30
# Through a unit quaternion and back: a few eps.
POSE_TOLERANCE = 1e-14


@pytest.fixture(scope="module")
def original():
    return make_record(servo_images=SERVO_IMAGES)


def test_a_bag_gives_back_the_record_it_was_written_from(tmp_path, original):
    record = read_bag(write(tmp_path / "run.bag", messages_of(original)))
    assert record.scenario == "experiment_1" and record.joint_names == original.joint_names
    assert record.stamp_ns[1:].tolist() == original.stamp_ns[1:].tolist()
    assert record.phase.tolist() == original.phase.tolist()
    for name in ("s", "s_star", "e", "twist", "q", "set_point"):
        np.testing.assert_array_equal(getattr(record, name), getattr(original, name), err_msg=name)
    np.testing.assert_allclose(record.X_WC, original.X_WC, rtol=0, atol=POSE_TOLERANCE)
    assert (record.run_hash, record.real_time_factor, record.opengl) == ("feed", 12.5, "llvmpipe, 4.5")
    assert record.camera_info["K"][0] == 100 and record.notes == ()


def test_the_judgement_from_the_bag_is_that_of_the_run(tmp_path, original):
    from_bag, direct = judge(read_bag(write(tmp_path / "run.bag", messages_of(original)))), judge(original)
    assert from_bag.passed == direct.passed and from_bag.duration_s == direct.duration_s
    assert from_bag.final_error == pytest.approx(direct.final_error, abs=1e-9)


@pytest.mark.parametrize("encoding, padding", [("rgb8", 0), ("rgb8", 5), ("bgr8", 0), ("mono8", 3), ("mono16", 1),
                                               ("rgb16", 0)])
def test_images_are_decoded_whatever_their_encoding_and_row_padding(tmp_path, original, encoding, padding):
    record = read_bag(write(tmp_path / "run.bag", messages_of(original, encoding=encoding, padding=padding)))
    pick = (lambda image: image[..., 0]) if encoding.startswith("mono") else (lambda image: image)
    assert np.array_equal(record.desired_image, pick(blob(0)))
    assert np.array_equal(record.initial_image, pick(blob(8)))


def test_images_of_a_bayer_pattern_are_decoded_and_others_refused_by_name():
    message = image_message(np.kron(np.ones((4, 4), np.uint8), np.uint8([[200, 90], [90, 30]])), rospy.Time(1.0),
                            "bayer_rggb8", 3)
    assert (image_of(message) == [200, 90, 30]).all() and image_of(message).shape == (8, 8, 3)
    message.encoding = "32FC1"
    with pytest.raises(ShapeError, match="found '32FC1', allowed rgb8 | bgr8 .* bayer_grbg8"):
        image_of(message)


@pytest.mark.parametrize("namespace", ["", "/a", "/a/b/c"])
def test_topics_are_found_under_any_namespace(tmp_path, original, namespace):
    assert len(read_bag(write(tmp_path / "run.bag", messages_of(original), namespace))) == len(original)


def test_a_bag_without_the_servos_rows_is_refused_with_what_it_holds(tmp_path, original):
    path = write(tmp_path / "run.bag", messages_of(original), without=("servo_state",))
    with pytest.raises(BagError, match="topics missing: /somewhere/aras/servo_state; found: .*camera/image_raw"):
        read_bag(path)


def test_two_runs_in_a_bag_need_a_choice(tmp_path, original):
    path = tmp_path / "run.bag"
    with rosbag.Bag(str(path), "w") as bag:
        for topic, message, stamp in messages_of(original):
            bag.write(f"/left/{topic}", message, stamp)
            bag.write(f"/right/{topic}", message, stamp)
    with pytest.raises(BagError, match="/left, /right"):
        read_bag(path)
    assert len(read_bag(path, namespace="/right")) == len(original)


def test_a_bag_without_its_scenario_is_not_compared(tmp_path, original):
    from aras_visual_servo_study.compare.side_by_side import read_run
    path = write(tmp_path / "run.bag", messages_of(original, scenario=False))
    with pytest.raises(ParameterError, match=f"{path}: scenario:"):
        read_run(str(path))


def moved(record, by_s, by_m, rows=slice(None)):
    """Messages of these rows of the record, later and elsewhere."""
    X_WC = record.X_WC.copy()
    X_WC[:, :3, 3] += by_m
    names = ("phase", "status", "status_text", "s", "s_star", "e", "twist", "q", "set_point")
    return list(messages_of(replace(record, stamp_ns=record.stamp_ns[rows] + int(1e9 * by_s), X_WC=X_WC[rows],
                                    **{name: getattr(record, name)[rows] for name in names}), scenario=False))


def test_of_two_runs_one_after_the_other_the_first_that_servoed_is_read(tmp_path, original):
    one, later = list(messages_of(original)), moved(original, 100.0, 0.2)
    begin_s = 100.0 + 1e-9 * original.stamp_ns[0]
    alone, both = (read_bag(write(tmp_path / name, messages))
                   for name, messages in (("one.bag", one), ("both.bag", one + later)))
    for name in ("stamp_ns", "phase", "status", "e", "X_WC", "taught_pose", "desired_image", "final_image"):
        np.testing.assert_array_equal(getattr(both, name), getattr(alone, name), err_msg=name)
    assert judge(both).passed and judge(both).final_error == judge(alone).final_error
    [note] = both.notes
    assert f"{begin_s:.3f} s" in note and alone.notes == ()
    teach, servo = original.rows("teach")[0], original.rows("servo")[0]
    no_servo = moved(original, 50.0, 0.2, slice(0, teach + 1))
    shifted = moved(original, 100.0, 0.0)
    record = read_bag(write(tmp_path / "late.bag", one[:2] + no_servo + shifted))
    assert len(record) == len(original) and record.phase[servo] == "servo"
    np.testing.assert_allclose(record.taught_pose, alone.taught_pose, rtol=0, atol=POSE_TOLERANCE)
    end = moved(original, 90.0, 0.2, slice(len(original) - 1, None))  # what a filter leaves of the run before
    record = read_bag(write(tmp_path / "filtered.bag", one[:2] + end + shifted))
    assert record.notes == () and judge(record).final_error == pytest.approx(judge(alone).final_error, abs=1e-9)


def test_rows_without_a_true_pose_are_kept_and_noted(tmp_path, original):
    record = read_bag(write(tmp_path / "run.bag", messages_of(original, skip=(6, 7))))
    assert np.isnan(record.X_WC[[6, 7]]).all() and len(record) == len(original)
    assert any("2 of 36 images" in note for note in record.notes)


def test_images_after_the_end_do_not_change_the_trace(tmp_path, original):
    from aras_visual_servo_study.report.report import trace_csv
    messages = list(messages_of(original))
    topic, last, stamp = [entry for entry in messages if entry[0] == "servo_state"][-1]
    late = rospy.Time(stamp.secs, stamp.nsecs + 1000)
    again = state_message(original, len(original) - 1, late)
    short = read_bag(write(tmp_path / "short.bag", messages))
    long = read_bag(write(tmp_path / "long.bag", messages + [(topic, again, late)]))
    assert last.phase == again.phase == "done" and trace_csv(long) == trace_csv(short)


def counted(messages):
    """The messages, and at the end how many there were of each topic, as the simulator writes it."""
    messages = list(messages)
    counts = RecordingCounts(topics=sorted({f"{NAMESPACE}/{topic}" for topic, *_ in messages}))
    counts.published = [sum(f"{NAMESPACE}/{topic}" == name for topic, *_ in messages) for name in counts.topics]
    return messages + [("sim/recording", counts, messages[-1][2])]


def test_a_whole_recording_is_compared_with_what_was_published(tmp_path, original):
    record = read_bag(write(tmp_path / "run.bag", counted(messages_of(original))))
    assert record.notes == ()
    assert record.recorded[f"{NAMESPACE}/camera/image_raw"] == {"published": len(original), "in_bag": len(original)}


@pytest.mark.parametrize("topic", ["camera/image_raw", "camera/camera_info"])
def test_a_message_that_is_missing_in_the_bag_is_said_plainly(tmp_path, original, topic):
    messages = counted(messages_of(original))
    messages.remove([entry for entry in messages if entry[0] == topic][-1])
    path = write(tmp_path / "run.bag", messages)
    record = read_bag(path)
    count = record.recorded[f"{NAMESPACE}/{topic}"]
    assert count["published"] == count["in_bag"] + 1
    [note] = [note for note in record.notes if note.startswith("LOST in recording")]
    assert f"{NAMESPACE}/{topic}: {count['published']} messages were published, {count['in_bag']} are in" in note
    main(["report", str(path)])
    assert json.loads((tmp_path / "summary.json").read_text())["recorded"] == record.recorded
    page = (tmp_path / "report.html").read_text()
    assert note in page and f"{count['in_bag']} of {count['published']} messages published" in page


def test_a_bag_that_does_not_name_its_scenario_is_read_and_noted(tmp_path, original):
    record = read_bag(write(tmp_path / "run.bag", messages_of(original, scenario=False)))
    assert record.settings == {} and any("which scenario" in note for note in record.notes)


def with_plugin(original, name):
    """Messages of a run whose scenario names a plugin."""
    text = yaml.safe_dump({"name": "mine", **SETTINGS, "servo": {**SETTINGS["servo"], "plugins": [name]}})
    return [(topic, String(data=text) if topic == "scenario" else message, stamp)
            for topic, message, stamp in messages_of(original)]


def test_features_of_a_plugin_are_shown_as_in_the_run(tmp_path, original, monkeypatch):
    (tmp_path / "plugin_of_a_bag.py").write_text(
        "from aras_visual_servo import Feature, register_feature\n"
        "register_feature('bent')(type('Bent', (Feature,), {'unit': '1/m'}))\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    record = read_bag(write(tmp_path / "run.bag", with_plugin(original, "plugin_of_a_bag")))
    assert styles(["bent"])[0].unit == "1/m" and record.notes == ()
    sys.modules.pop("plugin_of_a_bag")
    features.FEATURES.pop("bent")


def test_a_plugin_that_is_not_here_is_noted(tmp_path, original):
    [note] = read_bag(write(tmp_path / "run.bag", with_plugin(original, "not_here"))).notes
    assert "without unit and symbol" in note and "'not_here'" in note


@pytest.mark.parametrize("content", [b"", b"not a bag at all\n"])
def test_a_file_that_is_no_bag_is_an_error_with_its_name(tmp_path, content):
    path = tmp_path / "wrong.bag"
    path.write_bytes(content)
    with pytest.raises(BagError, match="wrong.bag"):
        read_bag(path)


def test_a_missing_file_is_an_error_with_its_name():
    with pytest.raises(BagError, match="no_such.bag': no such file"):
        read_bag("no_such.bag")


def test_the_report_command_rebuilds_every_file_beside_the_bag(tmp_path, original, capsys):
    write(tmp_path / "run.bag", messages_of(original))
    assert main(["report", str(tmp_path / "run.bag")]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"run.bag", "summary.json", "trace.csv", "figure.png",
                                                          "figure.pdf", "report.html"}
    assert "PASSED" in capsys.readouterr().out


def test_a_report_without_images_or_truth_is_made_and_says_what_it_lacks(tmp_path, original, capsys):
    path = write(tmp_path / "run.bag", messages_of(original),
                 without=("camera/image_raw", "ground_truth/camera_pose", "camera/features"))
    assert main(["report", str(path), "--video"]) == 1
    out = capsys.readouterr().out
    for words in ("camera/image_raw (group images)", "ground_truth/camera_pose (group truth)", "unknown",
                  "no video: the record has no images"):
        assert words in out, words
    assert "no image in this record" in (tmp_path / "report.html").read_text()


def test_every_image_of_the_servo_is_kept_when_asked_for(tmp_path, original):
    record = read_bag(write(tmp_path / "run.bag", messages_of(original)), keep_images=True)
    assert sorted(record.images) == record.servo_rows.tolist()
    assert all(np.array_equal(record.images[row], blob(8 - min(8, k))) for k, row in enumerate(record.servo_rows))
    assert read_bag(tmp_path / "run.bag").images == {}


def test_a_recording_that_ends_before_the_run_says_so(tmp_path, original):
    messages = list(messages_of(original))
    record = read_bag(write(tmp_path / "run.bag", messages[:len(messages) // 2]))
    assert any("ends before the run did, in phase servo" in note for note in record.notes)


@pytest.mark.parametrize("same", [True, False])
def test_the_report_command_compares_a_replay_when_asked(tmp_path, original, monkeypatch, capsys, same):
    """A run that passed does not pass with other features than were recorded; without --replay nothing is replayed."""
    asked = []

    class Result:
        def text(self):
            return "what the replay found"

    Result.same = same
    monkeypatch.setattr("aras_visual_servo_controller.bags.replay.replay",
                        lambda *words: asked.append(words) or Result())
    path = str(write(tmp_path / "run.bag", messages_of(original)))
    assert main(["report", path]) == 0 and not asked
    assert "what the replay found" not in capsys.readouterr().out
    assert main(["report", path, "--replay"]) == (0 if same else 1)
    assert "what the replay found" in capsys.readouterr().out and asked[0][0] == [path]
