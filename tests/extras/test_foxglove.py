"""Foxglove's websocket protocol, spoken to a live run by a small client: what comes is what the run holds."""
import asyncio
import json
import re
import struct

import foxglove.layouts
import numpy as np
import pytest
from tornado.websocket import websocket_connect

from aras_visual_servo import load_scenario, package_path, ParameterError, spatial
from aras_visual_servo_study.live.foxglove import CAMERA, Foxglove, TARGET, TOPICS, WORLD
from aras_visual_servo_study.live.hub import Hub
from aras_visual_servo_study.live.messages import Pause, Set, Start, Stop
from aras_visual_servo_study.live.run import LiveRun
from aras_visual_servo_study.live.runner import Runner
from aras_visual_servo_study.live.settings import changed

LIMIT_S = 60.0
LAYOUT = package_path("aras_visual_servo_study") / "config" / "foxglove_layout.json"


def fields(data):
    """Field number -> values of a protobuf message: numbers or bytes."""
    found, at = {}, 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            value, shift, at = value | (byte & 127) << shift, shift + 7, at + 1
            if byte < 128:
                return value

    while at < len(data):
        key = varint()
        kind = key & 7
        if kind == 0:
            value = varint()
        else:
            size = {1: 8, 5: 4}.get(kind) or varint()
            value, at = data[at:at + size], at + size
            if kind != 2:
                value = struct.unpack({1: "<d", 5: "<I"}[kind], value)[0]
        found.setdefault(key >> 3, []).append(value)
    return found


def vector(data, size):
    """Numbers of a Vector3 or Quaternion; a zero is left out on the wire."""
    return [fields(data).get(i + 1, [0.0])[0] for i in range(size)]


class Client:
    def __init__(self, connection):
        self.connection, self.channels, self.got = connection, {}, {}

    async def read(self):
        message = await asyncio.wait_for(self.connection.read_message(), LIMIT_S)
        assert message is not None, "the server closed the socket"
        if isinstance(message, str):
            told = json.loads(message)
            for channel in told.get("channels", ()):
                if channel["topic"] not in self.channels:
                    self.channels[channel["topic"]] = channel
                    self.connection.write_message(json.dumps(
                        {"op": "subscribe", "subscriptions": [{"id": channel["id"], "channelId": channel["id"]}]}))
        elif message[0] == 1:
            number, stamp_ns = struct.unpack_from("<IQ", message, 1)
            topic = next(name for name, channel in self.channels.items() if channel["id"] == number)
            self.got.setdefault(topic, []).append((stamp_ns, message[13:]))

    async def until(self, wanted):
        while not wanted(self.got):
            await self.read()


def served(work):
    run = LiveRun(changed(load_scenario("experiment_1"), {"servo.hold_s": 500.0, "servo.time_limit_s": 1000.0}))
    runner = Runner(run, 0.0)
    runner.start()

    async def serve():
        hub = Hub(runner)
        peer = Foxglove(hub, runner.urdf_xml, 0)

        async def tick():
            while True:
                await asyncio.sleep(0.01)
                hub.tick()
                peer.tick()

        task = asyncio.ensure_future(tick())
        try:
            await asyncio.wait_for(work(run, runner, hub, peer), 2 * LIMIT_S)
        finally:
            task.cancel()
            peer.close()
            runner.close()

    asyncio.run(serve())


def test_a_client_gets_what_the_session_holds():
    async def work(run, runner, hub, peer):
        assert not runner.watched
        client = Client(await websocket_connect(f"ws://127.0.0.1:{peer.port}", subprotocols=["foxglove.sdk.v1"]))
        await client.until(lambda got: "/tf" in got)
        await asyncio.wrap_future(runner.submit(Start()))
        # It servoes until somebody shortens `hold_s`: a paused run has one set of features.
        await client.until(lambda got: "/features" in got)
        await asyncio.wrap_future(runner.submit(Pause(True)))
        assert run.phase == "servo"
        wanted = pytest.approx(dict(zip(run.servo.feature_names, run.record.s)), rel=1e-5, abs=1e-9)
        await client.until(lambda got: json.loads(got["/features"][-1][1]) == wanted)
        await asyncio.wrap_future(runner.submit(Set({"servo.hold_s": 0.1})))
        await asyncio.wrap_future(runner.submit(Pause(False)))
        # The log is the last that is sent of an image's numbers.
        await client.until(lambda got: {*TOPICS, "/servo", "/features"} <= set(got) and any(
            fields(data)[3][0].startswith(b"CONVERGED: ") for _, data in got["/log"]))
        await asyncio.wrap_future(runner.submit(Stop()))
        # Numbers are those of the rows that a page is sent, at their simulated times.
        rows = {round(1e9 * row[0]): row for _, row in runner.rows}
        names = runner.about["rows"]
        compared = 0
        for stamp_ns, data in client.got["/servo"]:
            row = next((row for t, row in rows.items() if abs(t - stamp_ns) < 1e6), None)
            told = json.loads(data)
            for key, prefix in (("errors", "e."), ("twist", "v."), ("joints", "q.")) if row is not None else ():
                for name, value in told[key].items():
                    assert value == pytest.approx(row[names.index(prefix + name)], rel=1e-5, abs=1e-9)
                    compared += 1
            assert told["timestamp"]["sec"] * 10**9 + told["timestamp"]["nsec"] == stamp_ns
        assert compared > 100
        schema = json.loads(client.channels["/servo"]["schema"])
        assert list(schema["properties"]["errors"]["properties"]) == ["xn", "yn", "an", "alpha"]
        # The robot's tree, moved by the joints, leads to the camera.
        transforms = {}
        for transform in fields(client.got["/tf"][-1][1])[1]:
            parts = fields(transform)
            X = spatial.pose_from_quaternion(vector(parts[4][0], 3), vector(parts[5][0], 4))
            transforms[parts[3][0].decode()] = parts[2][0].decode(), X
        link, X_WL = run.scenario.robot["tip_link"], np.eye(4)
        while link != WORLD:
            link, X = transforms[link]
            X_WL = X @ X_WL
        assert transforms[CAMERA][0] == WORLD and X_WL == pytest.approx(transforms[CAMERA][1], abs=1e-5)
        assert transforms[TARGET][1][:3, 3] == pytest.approx(run.target_pose()[:3, 3], abs=1e-5)
        # The image is the session's, and so is the calibration.
        image, calibration = (fields(client.got[f"/camera/{name}"][-1][1]) for name in ("image", "calibration"))
        assert image[2][0].startswith(b"\xff\xd8") and image[3] == [b"jpeg"] and image[4] == [CAMERA.encode()]
        assert np.frombuffer(calibration[6][0], "<f8").tolist() == list(run.camera_info["K"])
        assert [calibration[2], calibration[3]] == [[run.camera_info["width"]], [run.camera_info["height"]]]
        entities = [fields(entity) for entity in fields(client.got["/scene"][-1][1])[2]]
        named = {entity[3][0].decode(): entity for entity in entities}
        assert sum(12 in entity for entity in entities) > 5 and 11 in named[f"model {run.target}"]  # triangles, lines
        client.connection.close()
        while runner.watched:
            await asyncio.sleep(0.01)

    served(work)


def test_a_port_that_is_taken_is_named():
    async def work(_run, runner, hub, peer):
        with pytest.raises(ParameterError, match=f"--foxglove: found {peer.port}"):
            Foxglove(hub, runner.urdf_xml, peer.port)

    served(work)


def test_the_layout_names_topics_that_are_served_and_keys_that_panels_have():
    layout = json.loads(LAYOUT.read_text())
    kinds = {"3D": foxglove.layouts.ThreeDeeConfig, "Image": foxglove.layouts.ImageConfig,
             "Plot": foxglove.layouts.PlotConfig, "Log": foxglove.layouts.LogConfig}
    topics, columns = {*TOPICS, "/servo"}, LiveRun(load_scenario("experiment_1")).about()["rows"]
    assert set(layout) == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}

    def leaves(node):
        if isinstance(node, str):
            return [node]
        assert set(node) <= {"first", "second", "direction", "splitPercentage"}
        assert node["direction"] in ("row", "column")
        return leaves(node["first"]) + leaves(node["second"])

    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
    for name, config in layout["configById"].items():
        kind, config = name.split("!")[0], dict(config)
        config.pop("foxglovePanelTitle", None)
        assert set(config) <= set(kinds[kind]()._to_dict()), name
        mode = config.get("imageMode", {})
        assert set(mode) <= set(foxglove.layouts.ImageModeConfig()._to_dict())
        assert {*config.get("topics", {}), *(mode[key] for key in mode if key.endswith("Topic"))} <= topics
        assert config.get("topicToRender", "/log") in topics
        for path in config.get("paths", ()):
            assert set(path) <= set(foxglove.layouts.PlotSeries()._to_dict())
            group, column = re.fullmatch(r"/servo\.(\w+)\.(\w+)", path["value"]).groups()
            assert {"errors": "e.", "twist": "v.", "joints": "q."}[group] + column in columns
