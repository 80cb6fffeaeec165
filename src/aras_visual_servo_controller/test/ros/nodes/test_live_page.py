#!/usr/bin/env python3
"""The live page over ROS: the experiment begins with the first page, and what a page asks for reaches the nodes."""
import asyncio
import json
import struct
import sys
import unittest

import rospy
from tornado.websocket import websocket_connect
from wiring import wait_until

LIMIT_S = 60.0


class Page:
    """Reads what comes, as a page does."""

    async def open(self, address):
        self.number = 0
        self.connection = await websocket_connect(address.replace("http", "ws") + "socket")
        return self

    async def until(self, wanted):
        async def work():
            while True:
                message = await self.connection.read_message()
                if isinstance(message, bytes):
                    size, = struct.unpack_from("<I", message)
                    head = json.loads(message[4:4 + size])
                    head["image"] = len(message) > 4 + size
                    if head["type"] == "now":
                        self.connection.write_message(str(head["number"]))
                else:
                    head = json.loads(message)
                if wanted(head):
                    return head
        return await asyncio.wait_for(work(), LIMIT_S)

    async def ask(self, do, **fields):
        self.number += 1
        self.connection.write_message(json.dumps({"do": do, "id": self.number, **fields}))
        return await self.until(lambda head: head["type"] == "answer" and head["id"] == self.number)

    async def state(self, **wanted):
        head = await self.until(lambda head: head["type"] == "now"
                                and all(head["state"][key] == value for key, value in wanted.items()))
        return head["state"]


class LivePage(unittest.TestCase):
    def test_a_page_sees_the_run_and_changes_it(self):
        rospy.init_node("test_live_page")
        address = wait_until(lambda: rospy.get_param("live_page/address", ""), "the page's address")

        async def work():
            page = await Page().open(address)
            about = await page.until(lambda head: head["type"] == "about")
            self.assertEqual(about["scenario"], "experiment_1")
            head = await page.until(lambda head: head["type"] == "now" and head["image"] and head["rows"])
            self.assertEqual(len(head["rows"][0]), len(about["rows"]))
            await page.state(phase="servo")
            answer = await page.ask("set", values={"servo.gains_per_s.xn": 0.5})
            self.assertTrue(answer["ok"], answer)
            self.assertEqual(rospy.get_param("scenario/servo/gains_per_s/xn"), 0.5)
            state = await page.state()
            self.assertEqual((state["phase"], state["taught"]), ("servo", True))  # it went on with the same goal
            answer = await page.ask("set", values={"servo.gains_per_s.xn": -1})
            self.assertFalse(answer["ok"])
            self.assertEqual(rospy.get_param("scenario/servo/gains_per_s/xn"), 0.5)
            refused = await page.ask("set", values={"sim.seed": 3})
            self.assertIn("over ROS", refused["faults"][0])
            answer = await page.ask("set", values={"sim.cameras.0.noise_stddev": 3.0, "sim.cameras.0.latency_s": 0.03})
            self.assertTrue(answer["ok"], answer)
            self.assertEqual(rospy.get_param("scenario/sim/cameras")[0]["latency_s"], 0.03)
            await page.until(lambda head: head["type"] == "now" and head["image"])
            refused = await page.ask("set", values={"sim.cameras.0.sensor": {"gamma": -1.0}})
            self.assertFalse(refused["ok"])
            self.assertNotIn("sensor", rospy.get_param("scenario/sim/cameras")[0])
            self.assertTrue((await page.ask("speed", factor=3.0))["ok"])
            await page.until(lambda head: head["type"] == "now" and 2.0 < head["state"]["factor"] < 4.0)
            self.assertTrue((await page.ask("follow", follow=False))["ok"])
            self.assertTrue((await page.ask("stop"))["ok"])
            await page.state(phase="done", status="STOPPED")
            answer = await page.ask("place_target", position_m=[0.03, 0.08, 0.1934], q_xyzw=[0, 0, 2**-0.5, 2**-0.5])
            self.assertTrue(answer["ok"], answer)
            await page.until(lambda head: head["type"] == "now" and abs(head["state"]["target"][1] - 0.08) < 1e-6)
            self.assertTrue((await page.ask("pause", paused=True))["ok"])
            await page.state(paused=True)
            self.assertTrue((await page.ask("pause", paused=False))["ok"])
            self.assertTrue((await page.ask("start", reference="taught"))["ok"])
            await page.state(phase="servo")
            self.assertIn("gains_per_s", (await page.ask("save"))["yaml"])
            # The servo comes to the target, and to where it is put then.
            calm = {"servo.gains_per_s.xn": 3.0, "sim.cameras.0.noise_stddev": 0.0, "sim.cameras.0.latency_s": 0.0}
            self.assertTrue((await page.ask("set", values=calm))["ok"])
            self.assertTrue((await page.ask("follow", follow=True))["ok"])
            before = (await page.state(phase="done", status="CONVERGED"))["camera"]
            answer = await page.ask("place_target", position_m=[0.03, 0.05, 0.1934], q_xyzw=[0, 0, 2**-0.5, 2**-0.5])
            self.assertTrue(answer["ok"], answer)
            await page.state(phase="servo")
            after = (await page.state(phase="done", status="CONVERGED"))["camera"]
            self.assertAlmostEqual(after[1] - before[1], -0.03, delta=1e-3)

        asyncio.run(work())


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "page_over_ros", LivePage, sys.argv)
