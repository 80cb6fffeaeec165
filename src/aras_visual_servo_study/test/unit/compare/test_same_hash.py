"""Every protocol gives the same bytes when it is run again, in this process or in others."""

import pytest

from aras_visual_servo_study.cli.benchmark import benchmark_main
from aras_visual_servo_study.compare.protocols import known_protocols, protocol_named

pytest.importorskip("aras_visual_servo_sim")


@pytest.mark.parametrize("name", [protocol.name for protocol in known_protocols()])
def test_a_protocol_that_is_run_twice_gives_the_same_bytes(name, tmp_path, capsys):
    first = protocol_named(name).cases(tmp_path / "files", 1)[0].name  # the others take long
    written, printed = [], []
    for workers in ("0", "1"):  # this process, and one of its own
        assert benchmark_main([name, "--starts", "1", "--cases", first, "--workers", workers, "--name", "once",
                               "--output", str(tmp_path / workers)]) == 0
        folder = tmp_path / workers / "benchmarks" / name / "once"
        written.append({path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()})
        printed += [line.split()[1] for line in capsys.readouterr().out.splitlines() if line.startswith("hash ")]
    assert written[0] == written[1] and "benchmark.md" in written[0]
    assert len(printed) == 2 and printed[0] == printed[1] and len(printed[0]) == 16
