"""Which tests run which lines of a package, and how long each takes: a fault is looked for where it can be met.

Tests that run the faulty line come first, the quickest file before the others; then those that run another line of the
same function. A line outside functions is run when its module is loaded: there, all tests that run a line of the file.
"""
import ast
import json
import time


class Recorder:
    """Plugin of pytest: keeps which lines of the files in a folder each test runs. `path`: of what is kept."""

    def __init__(self, folder, path):
        import coverage
        self._coverage = coverage.Coverage(data_file=None, include=[f"{folder}/*"])
        self._path, self._seconds = path, {}

    def pytest_sessionstart(self):
        self._coverage.start()

    def pytest_runtest_logstart(self, nodeid):
        self._seconds[nodeid] = -time.process_time()
        self._coverage.switch_context(nodeid)

    def pytest_runtest_logfinish(self, nodeid):
        self._coverage.switch_context("")
        self._seconds[nodeid] += time.process_time()

    def pytest_sessionfinish(self):
        self._coverage.stop()
        data = self._coverage.get_data()
        lines = {file: {line: [test for test in tests if test] for line, tests in data.contexts_by_lineno(file).items()}
                 for file in data.measured_files()}
        self._path.write_text(json.dumps({"seconds": self._seconds, "lines": lines}))


class Order:
    """Plugin of pytest: only these tests, in this order. `tests`: list of their node ids."""

    def __init__(self, tests):
        self._rank = {test: rank for rank, test in enumerate(tests)}

    def pytest_collection_modifyitems(self, items):
        items[:] = sorted((item for item in items if item.nodeid in self._rank),
                          key=lambda item: self._rank[item.nodeid])


def tests_that_run(recorded, file, source, line):
    """Node ids of the tests for a fault in this line, in their order. Args: recorded: what `Recorder` wrote."""
    lines, seconds = recorded["lines"].get(str(file), {}), recorded["seconds"]
    begin, end = _function(source, line)
    at_once = set(lines.get(str(line), ()))
    around = {test for number, tests in lines.items() if begin <= int(number) <= end for test in tests}
    total = {}  # by file, so that what the tests of a file share is made once
    for test in around:
        name = test.split("::")[0]
        total[name] = total.get(name, 0.0) + seconds[test]
    return sorted(around, key=lambda test: (test not in at_once, total[test.split("::")[0]], test.split("::")[0],
                                            seconds[test], test))


def in_function(source, line):
    """Whether the line stands in a function."""
    return _function(source, line)[0] > 1


def _function(source, line):
    """First and last line of the innermost function's body around a line; of the whole file, if there is none."""
    found = (1, source.count("\n") + 1)
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            begin, end = node.body[0].lineno, node.end_lineno
            if begin <= line <= end and end - begin <= found[1] - found[0]:
                found = (begin, end)
    return found
