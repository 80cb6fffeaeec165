"""The small web server of the live page: its files, the robot's meshes, and one socket for each page.

    address = Server(runner, robot).listen("127.0.0.1", 8765)     # http://127.0.0.1:8765/TOKEN/

Everything lies below a folder with a random name, the token: who does not know the address gets nothing. A socket is
opened only for a page that this server sent (Origin), and only under a name of this machine (Host).
"""

import asyncio
import errno
import hmac
import ipaddress
import json
import secrets
import socket
from typing import Any, List, Optional, Union

import tornado.httpserver
import tornado.ioloop
import tornado.web
import tornado.websocket

from aras_visual_servo import ArasError, ParameterError
from ..files import THREE_FILES, share_dir, three_file
from .foxglove import HOST, Foxglove
from .hub import Hub
from .messages import parse
from .runner import Runner
from .view.robot import mesh_blocks, robot_of

#: Between two looks at the run, while a page is ready for what is new, and while none is [s].
TICK_S, IDLE_S = 1.0 / 60.0, 0.1
#: What the kernel holds of what a page has not read: little, so that nothing old waits there.
SEND_BUFFER_BYTES = 65536
#: A page that has not taken this much is not read to any longer [bytes].
MOST_WAITING_BYTES = 8_000_000
KINDS = {".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8",
         ".css": "text/css; charset=utf-8", ".svg": "image/svg+xml"}
POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
          "base-uri 'none'; form-action 'none'; frame-ancestors 'none'")


class Server:
    """Serves one run.

    Args: runner: `Runner`.  urdf_xml: of its robot.  token: of the address; None: a random one.
    Attributes: hub: `Hub`.  token.  address: of the page, "" before `listen`.
    """

    def __init__(self, runner: Runner, urdf_xml: str, token: Optional[str] = None) -> None:
        self.meshes, notes = mesh_blocks(robot_of(urdf_xml))
        self._urdf_xml = urdf_xml
        self.runner, self.hub, self.address = runner, Hub(runner, notes), ""
        self.token = token or secrets.token_urlsafe(16)
        for name in THREE_FILES:
            three_file(name)  # a missing package is told before anybody opens a page
        self._http = self._hub_task = None
        self._foxglove: Optional[Foxglove] = None
        self.hosts = set()
        self.changed_by = 0

    def mesh(self, name: str) -> bytes:
        """Returns a mesh of the robot that the run has now. Raises HTTPError 404: it has none of that name."""
        urdf_xml = self.runner.urdf_xml()
        if urdf_xml != self._urdf_xml:
            self._urdf_xml, self.meshes = urdf_xml, mesh_blocks(robot_of(urdf_xml))[0]
        if name not in self.meshes:
            raise tornado.web.HTTPError(404)
        return self.meshes[name]

    def listen(self, host: str = "127.0.0.1", port: int = 8765) -> str:
        """Begin to serve, within a running event loop; port 0 takes a free one. Returns the page's address.

        Raises: ParameterError: the port is taken, the host is none of this machine's, or others would reach a run that
        executes what a page writes.
        """
        if self.runner.edits and not is_loopback(host):
            raise ParameterError(f"host: found {host}, with --edit allowed 127.0.0.1, localhost or ::1, because a page "
                                 "may then run any code here")
        application = tornado.web.Application(
            [(r"/([^/]+)/socket", Socket, {"server": self}), (r"/([^/]+)/(.*)", Files, {"server": self}),
             (r".*", Nothing)], websocket_max_message_size=1 << 20, log_function=lambda _handler: None)
        try:
            sockets = [_bound(host, port)]
        except (OSError, OverflowError) as error:
            raise ParameterError(_why_not(host, port, error)) from error
        port = sockets[0].getsockname()[1]
        self._http = tornado.httpserver.HTTPServer(application)
        self._http.add_sockets(sockets)
        shown = "127.0.0.1" if host in ("", "0.0.0.0") else host
        self.hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost", f"[{host}]" if ":" in host else host)} \
            if is_loopback(host) else set()
        self.address = f"http://{shown}:{port}/{self.token}/"
        self._hub_task = asyncio.ensure_future(self._tick())
        return self.address

    def serve_foxglove(self, port: int) -> str:
        """Serves Foxglove too. Returns its address. Raises: those of `Foxglove`."""
        self._foxglove = Foxglove(self.hub, self.runner.urdf_xml, port)
        return f"ws://{HOST}:{self._foxglove.port}"

    async def _tick(self):
        while True:
            # Without a page that is ready there is nothing to look for, and the run has the processor to itself.
            await asyncio.sleep(TICK_S if self.runner.watched else IDLE_S)
            self.hub.tick()
            if self._foxglove is not None:
                self._foxglove.tick()
            self.runner.interrupt_hung()

    def close(self) -> None:
        """Stop serving."""
        if self._http is not None:
            self._http.stop()
            self._hub_task.cancel()
        if self._foxglove is not None:
            self._foxglove.close()


class Guarded:
    """Asks every request for token and host before anything else; mixed into the handlers."""

    def initialize(self, server: Server) -> None:
        """Args: server: `Server`."""
        self.server = server

    def prepare(self) -> None:
        """Refuse what does not come by the page's address."""
        token = self.path_args[0] if self.path_args else ""
        if self.server.hosts and self.request.host not in self.server.hosts:
            raise tornado.web.HTTPError(403)
        if not hmac.compare_digest(token.encode(), self.server.token.encode()):
            raise tornado.web.HTTPError(404)

    def write_error(self, status_code: int, **_: Any) -> None:
        """A line of text."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish("nothing here: the address of the page is the one that was printed when the run began\n")


class Nothing(Guarded, tornado.web.RequestHandler):
    """Whatever lies outside the folder of the token."""

    def initialize(self) -> None:
        """Without a server."""

    def prepare(self) -> None:
        """Always refused."""
        raise tornado.web.HTTPError(404)


class Files(Guarded, tornado.web.RequestHandler):
    """The page's files, three.js, the list of panels, and the meshes."""

    def get(self, _token: Any, name: str) -> Any:
        """One of them."""
        self.set_header("Content-Security-Policy", POLICY)
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Cache-Control", "no-cache")
        folder, _, rest = name.partition("/")
        if name == "panels.json":
            self.set_header("Content-Type", "application/json")
            return self.finish(json.dumps(panels()))
        if folder == "mesh":
            self.set_header("Content-Type", "application/octet-stream")
            return self.finish(self.server.mesh(rest))
        if folder == "picture" and rest.isdigit() and len(rest) < 16:
            picture = self.server.hub.pictures.at(int(rest))
            if picture is None:
                raise tornado.web.HTTPError(404)
            self.set_header("Content-Type", "application/octet-stream")
            return self.finish(picture)
        if folder == "three" and rest in THREE_FILES:
            return self._send(three_file(rest))
        root = (share_dir() / "web").resolve()
        path = (root / (name or "index.html")).resolve()
        if root not in path.parents or not path.is_file() or path.suffix not in KINDS:
            raise tornado.web.HTTPError(404)
        return self._send(path)

    def _send(self, path):
        self.set_header("Content-Type", KINDS[path.suffix])
        return self.finish(path.read_bytes())


class Socket(Guarded, tornado.websocket.WebSocketHandler):
    """One page."""

    def open(self, _token: Any) -> None:
        """It has come."""
        stream = self.ws_connection.stream
        stream.set_nodelay(True)
        stream.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        self._waiting = 0
        self.server.changed_by += 1
        self.name = self.server.changed_by
        self.server.hub.add(self)

    def send(self, message: Union[str, bytes]) -> None:
        """Send without waiting. A page that has gone or takes nothing is let go."""
        size = len(message)
        if self._waiting + size > MOST_WAITING_BYTES:
            self.close(1013, "too slow")
            return
        self._waiting += size
        try:
            task = asyncio.ensure_future(self._write(message, size))
            task.add_done_callback(lambda done: done.cancelled() or done.exception())
        except tornado.websocket.WebSocketClosedError:
            self.server.hub.remove(self)

    async def _write(self, message, size):
        try:
            await self.write_message(message, binary=isinstance(message, bytes))
        except (tornado.websocket.WebSocketClosedError, tornado.iostream.StreamClosedError):
            self.server.hub.remove(self)
        finally:
            self._waiting -= size

    async def on_message(self, message: Union[str, bytes]) -> None:
        """A request, or the number of the last message that the page has seen."""
        if isinstance(message, str) and message.isdigit():
            self.behind = max(0, self.behind - 1)
            return
        number = None
        try:
            number, request = parse(message)
            answer = await asyncio.wrap_future(self.server.runner.submit(request))
            if request.do == "set":  # told before it is answered: who has the answer knows the values
                self.server.hub.tell({"type": "set", "by": self.name, "values": request.values,
                                      **{key: self.server.runner.about[key] for key in ("waiting", "ends")}})
            self.send(json.dumps({"type": "answer", "id": number, "ok": True, **answer}))
        except RuntimeError as error:  # ours, and the simulator's
            if isinstance(error, ArasError) and number is None:
                number = getattr(error, "id", None)
            faults = getattr(error, "faults", None) or str(error).splitlines()
            self.send(json.dumps({"type": "answer", "id": number, "ok": False, "faults": list(faults)}))

    def on_close(self) -> None:
        """It has gone."""
        self.server.hub.remove(self)


def panels() -> List[str]:
    """Names of the page's panels: the files of web/panels, sorted. A new panel is a new file there."""
    return sorted(path.name for path in (share_dir() / "web" / "panels").glob("*.js"))


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches the host."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _bound(host, port):
    six = ":" in host
    listener = socket.create_server((host, port), family=socket.AF_INET6 if six else socket.AF_INET, backlog=64,
                                    dualstack_ipv6=six)
    listener.setblocking(False)
    return listener


def _why_not(host, port, error):
    if getattr(error, "errno", None) == errno.EADDRINUSE:
        return f"port: found {port}, which another program on {host} has taken; allowed a free one, or 0 for any"
    return f"host, port: found {host}, {port}: {error}; allowed an address of this machine and a port 0 to 65535"
