"""The server without a browser: who gets in, who gets what, and that nobody waits for a slow page."""

import asyncio
import json
import socket
import struct
import time

import pytest
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from aras_visual_servo import load_scenario, ParameterError
from aras_visual_servo_study.live.hub import Hub, MOST_ROWS, WINDOW
from aras_visual_servo_study.live.messages import Start
from aras_visual_servo_study.live.run import LiveRun
from aras_visual_servo_study.live.runner import Runner
from aras_visual_servo_study.live.server import is_loopback, Server

LIMIT_S = 60.0


class Page:
    """A page as the server sees it; reads all that comes, and says so."""

    def __init__(self, connection):
        self.connection, self.messages, self.number = connection, [], 0

    async def read(self):
        message = await asyncio.wait_for(self.connection.read_message(), LIMIT_S)
        assert message is not None, "the server closed the socket"
        if isinstance(message, bytes):
            size, = struct.unpack_from("<I", message)
            head = json.loads(message[4:4 + size])
            head["image"] = message[4 + size:]
            if head["type"] == "now":
                self.connection.write_message(str(head["number"]))
        else:
            head = json.loads(message)
        self.messages.append(head)
        return head

    async def until(self, wanted):
        while True:
            message = await self.read()
            if wanted(message):
                return message

    async def ask(self, do, **fields):
        self.number += 1
        self.connection.write_message(json.dumps({"do": do, "id": self.number, **fields}))
        return await self.until(lambda message: message["type"] == "answer" and message["id"] == self.number)


def served(work, speed=1.0, scenario="experiment_1"):
    """Run the coroutine work(server) against a server with a run."""
    run = LiveRun(load_scenario(scenario))
    runner = Runner(run, speed, Start())

    async def serve():
        server = Server(runner, run.scenario.urdf_xml())
        server.listen("127.0.0.1", 0)
        runner.start()
        try:
            return await asyncio.wait_for(work(server), 4 * LIMIT_S)
        finally:
            server.close()
            runner.close()

    return asyncio.run(serve())


async def page(server, **headers):
    address = server.address.replace("http", "ws") + "socket"
    return Page(await websocket_connect(HTTPRequest(address, headers=headers)))


async def status(address, **headers):
    try:
        return (await AsyncHTTPClient().fetch(HTTPRequest(address, headers=headers))).code
    except HTTPClientError as error:
        return error.code


def test_only_who_knows_the_address_gets_anything():
    async def work(server):
        address = server.address
        assert await status(address) == 200
        for name in ("main.js", "style.css", "three/three.min.js", "panels.json", "panels/arm.js", "lib/world.js"):
            assert await status(address + name) == 200, name
        assert await status(address + "mesh/" + next(iter(server.meshes))) == 200
        for name in ("../package.xml", "%2e%2e/package.xml", "mesh/nothing", "picture/x", "three/three.js",
                     "nothing.js", "lib"):
            assert await status(address + name) == 404, name
        wrong = address.replace(server.token, "x" * len(server.token))
        assert await status(wrong) == 404 and await status(wrong + "socket") == 404
        assert await status(address.replace(server.token + "/", "")) == 404
        assert await status(address, Host="evil.example:80") == 403

    served(work)


def test_a_page_of_another_origin_gets_no_socket():
    async def work(server):
        with pytest.raises(HTTPClientError, match="403"):
            await page(server, Origin="http://evil.example")
        assert await page(server, Origin=server.address.rpartition("/" + server.token)[0])

    served(work)


def test_a_page_gets_what_it_draws_and_the_run_begins():
    async def work(server):
        viewer = await page(server)
        about = await viewer.until(lambda message: message["type"] == "about")
        assert about["scenario"] == "experiment_1" and about["joints"] and about["schema"]["servo"]["properties"]
        first = await viewer.until(lambda message: message["type"] == "now" and message["image"])
        assert first["image"].startswith(b"\xff\xd8") and first["marks"]["centre"]
        moving = await viewer.until(lambda message: message["type"] == "now" and message["state"]["phase"] == "to_goal")
        pictured = await AsyncHTTPClient().fetch(server.address + "picture/1000000000")
        size, = struct.unpack_from("<I", pictured.body)
        assert json.loads(pictured.body[4:4 + size])["marks"] and pictured.body[4 + size:].startswith(b"\xff\xd8")
        row = (await viewer.until(lambda message: message["type"] == "now" and message["rows"]))["rows"][0]
        assert len(row) == len(about["rows"]) and len(moving["state"]["q"]) == len(about["joints"])

    served(work)


@pytest.mark.parametrize("nonsense", ["", "{", "[]", '{"do": 5}', b"\x00\xff", '{"do": "set", "values": 3}', "9" * 400])
def test_nonsense_is_answered_and_the_page_stays(nonsense):
    async def work(server):
        viewer = await page(server)
        viewer.connection.write_message(nonsense, binary=isinstance(nonsense, bytes))
        answer = await viewer.ask("pause", paused=True)
        assert answer["ok"]
        refused = [message for message in viewer.messages if message["type"] == "answer" and not message["ok"]]
        assert len(refused) == (0 if nonsense.isdigit() else 1) and all(one["faults"] for one in refused)

    if isinstance(nonsense, bytes):
        nonsense = nonsense.decode("latin1")
    served(work)


def test_two_pages_that_fight_over_a_slider_end_with_the_same_value():
    async def work(server):
        pages = [await page(server), await page(server)]

        async def fight(viewer, values):
            for value in values:
                await viewer.ask("set", values={"servo.gains_per_s.xn": value})

        await asyncio.gather(fight(pages[0], [1.0, 1.1, 1.2, 1.3]), fight(pages[1], [2.0, 2.1, 2.2, 2.3]))
        for viewer in pages:
            await viewer.ask("speed", factor=1)
            heard = [message["values"] for message in viewer.messages if message["type"] == "set"]
            assert len(heard) == 8
            viewer.last = heard[-1]["servo.gains_per_s.xn"]
        assert pages[0].last == pages[1].last == server.runner.about["values"]["servo"]["gains_per_s"]["xn"]

    served(work)


def test_a_page_is_told_of_its_value_before_it_has_the_answer():
    async def work(server):
        viewer = await page(server)
        await viewer.ask("set", values={"servo.gains_per_s.xn": 1.5})
        kinds = [message["type"] for message in viewer.messages if message["type"] in ("set", "answer")]
        assert kinds[-2:] == ["set", "answer"]

    served(work)


def test_a_page_that_closes_in_the_middle_leaves_the_others_alone():
    async def work(server):
        stays, goes = await page(server), await page(server)
        goes.connection.write_message(json.dumps({"do": "speed", "factor": 1, "id": 1}))
        goes.connection.stream = None
        goes.connection.protocol.stream.socket.shutdown(socket.SHUT_RDWR)
        await stays.until(lambda message: message["type"] == "now" and message["viewers"] == 1)
        assert server.hub.viewers == 1

    served(work)


def test_a_page_that_reads_nothing_gets_little_and_holds_nobody_up():
    async def work(server):
        quick, slow = await page(server), await page(server)
        begin = server.runner.sample.number if server.runner.sample else 0
        await quick.until(lambda message: message["type"] == "now" and message["number"] > begin + 60)
        got = [message for message in quick.messages if message["type"] == "now"]
        behind = [viewer.behind for viewer in server.hub._viewers]
        assert len(got) >= 20 and max(behind) == WINDOW
        assert slow.messages == []

    served(work)


def test_without_a_page_nothing_is_made_for_one():
    async def work(server):
        viewer = await page(server)
        await viewer.until(lambda message: message["type"] == "now")
        viewer.connection.close()
        until = time.monotonic() + LIMIT_S
        while server.runner.watched:
            assert time.monotonic() < until
            await asyncio.sleep(0.01)
        number = server.runner.sample.number
        await asyncio.sleep(0.3)
        assert server.runner.sample.number <= number + 1

    served(work)


def test_a_port_that_is_taken_is_named():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]

        async def work(server):
            with pytest.raises(ParameterError, match=f"port: found {port}, which another program .* has taken"):
                server.listen("127.0.0.1", port)
            with pytest.raises(ParameterError, match="allowed an address of this machine"):
                server.listen("192.0.2.1", 0)

        served(work)


@pytest.mark.parametrize("host, only_here", [("127.0.0.1", True), ("localhost", True), ("::1", True),
                                             ("0.0.0.0", False), ("example.org", False)])
def test_it_is_known_who_can_reach_an_address(host, only_here):
    assert is_loopback(host) is only_here


class FakeRunner:
    """What a hub looks at."""

    def __init__(self, rows):
        self.rows, self.sample, self.watched, self.about = rows, None, False, {"version": 1}


def test_rows_that_a_page_has_missed_are_thinned_evenly():
    hub = Hub(FakeRunner([(i, [i]) for i in range(10000)]))
    rows = hub._rows(100)
    assert rows[-1] == (9999, [9999]) and len(rows) <= MOST_ROWS and rows[0][0] >= 100


def test_a_page_is_told_what_cannot_be_drawn():
    class Viewer:
        def __init__(self):
            self.got = []

        def send(self, message):
            self.got.append(json.loads(message))

    runner, viewer = FakeRunner([]), Viewer()
    Hub(runner, ["not drawn: mesh 'a.dae': gone"]).add(viewer)
    assert viewer.got[0]["type"] == "about" and viewer.got[0]["notes"] == ["not drawn: mesh 'a.dae': gone"]
