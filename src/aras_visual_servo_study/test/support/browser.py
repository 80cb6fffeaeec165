"""A real browser for tests: headless Chromium, driven over its DevTools protocol.

    with Browser(tmp_path) as browser:
        browser.open(address)
        browser.wait("window.aras && aras.model.state")      # a JavaScript expression that becomes true
        value = browser.value("aras.model.state.t")
        browser.drag((x, y), (x2, y2))
        browser.screenshot(path)
"""

import asyncio
import base64
import itertools
import json
import shutil
import subprocess
import time
import urllib.request
from pathlib import Path

from tornado.websocket import websocket_connect

CHROMIUM = shutil.which("chromium")
FLAGS = ("--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-extensions", "--mute-audio", "--hide-scrollbars",
         "--remote-debugging-port=0", "--remote-allow-origins=*")
#: WebGL without a GPU, and the page around it put together without it: two fifths less work.
SOFTWARE_WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
                  "--disable-gpu-compositing")
NO_WEBGL = ("--disable-gpu", "--disable-3d-apis")
LIMIT_S = 60.0


def end(process):
    """Terminate a process; subprocess.TimeoutExpired if it does not end, and then it is killed."""
    process.terminate()
    try:
        process.wait(LIMIT_S)
    finally:
        process.kill()


class Browser:
    """One page of a browser of its own.

    Args: folder: for its profile.  webgl: drawn by the processor, which takes most of one as long as something moves.
        size: of the window [px].  scale: device pixels of each.
    """

    def __init__(self, folder, webgl=False, size=(1280, 900), scale=1.0):
        self._profile = Path(folder) / "profile"
        self._flags = [*FLAGS, *(SOFTWARE_WEBGL if webgl else NO_WEBGL), f"--window-size={size[0]},{size[1]}"]
        self._size, self._scale = size, scale
        self._loop, self._numbers, self.said = asyncio.new_event_loop(), itertools.count(1), []

    def __enter__(self):
        self._process = subprocess.Popen([CHROMIUM, *self._flags, f"--user-data-dir={self._profile}", "about:blank"],
                                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        port_file, until = self._profile / "DevToolsActivePort", time.monotonic() + LIMIT_S
        while not (port_file.is_file() and port_file.read_text().count("\n")):
            assert time.monotonic() < until and self._process.poll() is None, "chromium did not start"
            time.sleep(0.05)
        port = port_file.read_text().split()[0]
        pages = json.loads(urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=LIMIT_S).read())
        address = next(page["webSocketDebuggerUrl"] for page in pages if page["type"] == "page")
        self._socket = self._loop.run_until_complete(self._connected(address))
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.look(self._size, dark=False)
        return self

    def look(self, size, dark):
        """Another size of the window [px], and the colours that the page is asked for."""
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1],
                  deviceScaleFactor=self._scale, mobile=size[0] < 600)
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    @staticmethod
    async def _connected(address):
        return await websocket_connect(address, max_message_size=1 << 28)

    async def _closed(self):
        self._socket.close()
        await asyncio.sleep(0.05)

    def __exit__(self, *_):
        self._loop.run_until_complete(self._closed())
        end(self._process)
        self._loop.close()

    def call(self, method, **parameters):
        """The result of a method of the DevTools protocol; errors and warnings of the page go to `said`."""
        number = next(self._numbers)

        async def work():
            await self._socket.write_message(json.dumps({"id": number, "method": method, "params": parameters}))
            while True:
                message = json.loads(await self._socket.read_message())
                if message.get("id") == number:
                    return message
                self._note(message)

        answer = self._loop.run_until_complete(asyncio.wait_for(work(), LIMIT_S))
        assert "error" not in answer, f"{method}: {answer.get('error')}"
        return answer["result"]

    def _note(self, message):
        if message.get("method") == "Runtime.exceptionThrown":
            details = message["params"]["exceptionDetails"]
            self.said.append(details.get("exception", {}).get("description") or details.get("text"))
        elif message.get("method") == "Log.entryAdded" and message["params"]["entry"]["level"] == "error":
            self.said.append(message["params"]["entry"]["text"] + " " + message["params"]["entry"].get("url", ""))

    def open(self, address):
        """Go to an address."""
        self.call("Page.navigate", url=address)

    def value(self, expression):
        """What a JavaScript expression gives, a promise's value included; AssertionError where it throws."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer.get("exceptionDetails")
        return answer["result"].get("value")

    def wait(self, expression, limit_s=LIMIT_S):
        """Wait until an expression is true, and give its value; AssertionError after the limit."""
        until = time.monotonic() + limit_s
        while True:
            found = self.value(f"(() => {{ try {{ const found = {expression}; return typeof found === 'object' ? "
                               "found !== null : found; } catch { return false; } })()")
            if found:
                return found
            assert time.monotonic() < until, (f"not within {limit_s} s: {expression}; the page said {self.said}, its "
                                              f"state is {self.value('window.aras?.model?.state ?? null')}")
            time.sleep(0.05)

    def mouse(self, kind, at, button="left", buttons=1):
        """One event: mousePressed, mouseMoved or mouseReleased at (x, y)."""
        self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button=button, buttons=buttons,
                  clickCount=1 if kind != "mouseMoved" else 0)

    def click(self, selector):
        """Click into the middle of an element."""
        box = self.value(f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView("
                         "{block: 'center'}); const b = e.getBoundingClientRect(); "
                         "return [b.x + b.width / 2, b.y + b.height / 2]; })()")
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.mouse(kind, box)

    def drag(self, begin, end, steps=10, release=True):
        """Press at `begin`, move to `end`, and let go."""
        self.mouse("mouseMoved", begin, buttons=0)
        self.mouse("mousePressed", begin)
        for i in range(1, steps + 1):
            self.mouse("mouseMoved", [a + (b - a) * i / steps for a, b in zip(begin, end)])
        if release:
            self.mouse("mouseReleased", end)

    def screenshot(self, path, whole=False):
        """Write a PNG of what is seen, or of the whole page."""
        picture = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        Path(path).write_bytes(base64.b64decode(picture["data"]))

    def printed(self, path):
        """Print the page to a PDF file, and give the text of each of its pages."""
        pdf = self.call("Page.printToPDF", preferCSSPageSize=True)
        Path(path).write_bytes(base64.b64decode(pdf["data"]))
        command = ["pdftotext", "-layout", str(path), "-"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\f")[:-1]
