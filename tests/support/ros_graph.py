"""A ROS graph of a test's own: a port nobody listens on, processes that end with it, what they said."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time
import xmlrpc.client

import yaml

ASKER = str(pathlib.Path(__file__).resolve().parent / "graph_asker.py")
LIMIT_S = 60.0  # wall time after which something that should happen has not


class Graph:
    """Context manager. `folder`: for logs. `variables`: more of the environment of its processes.

    Attributes:
        environment: of the processes.
    """

    def __init__(self, folder, **variables):
        self.port = free_port()
        self.uri = "http://localhost:%d" % self.port
        self.environment = dict(os.environ, ROS_MASTER_URI=self.uri, ROS_HOSTNAME="localhost",
                                ROS_LOG_DIR=str(folder / "ros_log"), ROSCONSOLE_STDOUT_LINE_BUFFERED="1",
                                PYTHONUNBUFFERED="1", **variables)  # a log that is read while it is written
        self._log_path = folder / "processes.log"
        self._log = open(self._log_path, "wb")
        self._processes, self._asker = [], None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._asker is not None:
            self._asker.stdin.close()  # it ends when nobody asks any more
        for process in reversed(self._processes):
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in [*self._processes, *filter(None, [self._asker])]:
            try:
                process.wait(LIMIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
        self._log.close()

    def start(self, *command):
        """A process of this graph, which ends with it."""
        process = subprocess.Popen(command, env=self.environment, stdout=self._log, stderr=subprocess.STDOUT,
                                   start_new_session=True)
        self._processes.append(process)
        return process

    def output(self, *command):
        """What a program of this graph prints until it ends."""
        return subprocess.run(command, env=self.environment, stdout=subprocess.PIPE, stderr=self._log, check=True,
                              timeout=LIMIT_S).stdout.decode()

    def answer(self, service, request=""):
        """What a service answers to a request, which is YAML: dict. AssertionError with the reason where it fails."""
        return self._ask("call", service, request)

    def message(self, topic):
        """The next message of a topic: dict. AssertionError where none comes."""
        return self._ask("message", topic)

    def _ask(self, kind, name, request=""):
        if self._asker is None:
            self._asker = subprocess.Popen([sys.executable, ASKER], env=self.environment, stdin=subprocess.PIPE,
                                           stdout=subprocess.PIPE, stderr=self._log, text=True, start_new_session=True)
        print(json.dumps([kind, name, request]), file=self._asker.stdin, flush=True)
        line = self._asker.stdout.readline()
        assert line, "who asks has ended\n" + self.log()
        told, fault = json.loads(line)
        assert told is not None, fault
        return yaml.safe_load(told)

    def log(self):
        """What the processes have said so far."""
        return self._log_path.read_text(encoding="utf-8", errors="replace")

    def topics(self):
        """dict topic -> type; empty without a master."""
        try:
            return dict(xmlrpc.client.ServerProxy(self.uri).getTopicTypes("/test")[2])
        except (OSError, xmlrpc.client.Error):
            return {}

    def until(self, condition, what):
        """Waits until condition() is true."""
        until(condition, what, self.log)


def free_port():
    """A TCP port of the loopback nobody listens on."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def until(condition, what, log=lambda: "", limit_s=LIMIT_S):
    """Waits until condition() is true and returns its value; after limit_s it fails with `what` and the log."""
    end = time.monotonic() + limit_s
    while True:
        found = condition()
        if found:
            return found
        assert time.monotonic() < end, "never happened: %s\n%s" % (what, log())
        time.sleep(0.05)
