"""Signals raise once, wait where they must, and are not lost; temporary folders go; children go with their parent."""

import asyncio
import contextlib
import multiprocessing
import os
import pathlib
import signal
import subprocess
import sys
import time

import psutil
import pytest

from aras_visual_servo import processes
from aras_visual_servo.processes import (EXIT_SIGNALLED, SIGNALS, Interrupted, check_signals, marked,
                                                           processes_of, run_until_signal, signals_held,
                                                           signals_let_through, signals_raise, temporary_folder)

PATIENCE_S = 60.0


@pytest.mark.usefixtures("hang_up_is_heard")
@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_a_signal_raises_and_says_what_to_end_with(number):
    before = signal.getsignal(number)
    with pytest.raises(Interrupted) as caught, signals_raise():
        signal.raise_signal(number)
    assert caught.value.exit_code == EXIT_SIGNALLED + number and str(caught.value) == f"interrupted by {number.name}"
    assert signal.getsignal(number) == before


def test_a_second_signal_does_not_cut_the_closing_short(monkeypatch):
    closed = []
    with pytest.raises(Interrupted), signals_raise():
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            signal.raise_signal(signal.SIGINT)
            closed.append(True)
    assert closed


def test_a_second_signal_counts_when_closing_takes_too_long(monkeypatch):
    monkeypatch.setattr(processes, "CLOSING_S", 0.0)
    with pytest.raises(Interrupted) as caught, signals_raise():
        try:
            signal.raise_signal(signal.SIGTERM)
        except Interrupted:
            signal.raise_signal(signal.SIGINT)
    assert caught.value.exit_code == EXIT_SIGNALLED + signal.SIGINT


@pytest.mark.usefixtures("hang_up_is_heard")
def test_what_was_swallowed_is_raised_when_asked():
    with pytest.raises(Interrupted) as caught, signals_raise():
        check_signals()
        try:
            signal.raise_signal(signal.SIGHUP)
        except BaseException:
            pass
        check_signals()
    assert caught.value.exit_code == EXIT_SIGNALLED + signal.SIGHUP


def test_a_held_signal_comes_when_the_block_ends_and_inside_where_it_is_let_through():
    steps = []
    with pytest.raises(Interrupted), signals_raise(), signals_held():
        with signals_held():
            signal.raise_signal(signal.SIGINT)
            steps.append("held")
        steps.append("still held by the outer one")
        with signals_let_through():
            steps.append("never")
    assert steps == ["held", "still held by the outer one"]


def test_a_hang_up_that_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with signals_raise():
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
@pytest.mark.usefixtures("hang_up_is_heard")
def test_a_signal_between_a_task_and_its_wake_up_ends_an_event_loop(number, monkeypatch):
    closed, run = [], asyncio.Handle._run

    def signalled(handle):
        if "wakeup" in repr(handle) and not isinstance(handle, asyncio.TimerHandle) and not closed:
            closed.append("signalled")
            signal.raise_signal(number)
        run(handle)
    monkeypatch.setattr(asyncio.Handle, "_run", signalled)

    async def works_on():
        while True:
            await asyncio.sleep(0.001)

    async def work(came):
        task = asyncio.ensure_future(works_on())
        try:
            assert await asyncio.wait_for(came, PATIENCE_S) == number
        finally:
            task.cancel()
            closed.append("closed")

    with pytest.raises(Interrupted) as caught, signals_raise():
        run_until_signal(work)
    assert closed == ["signalled", "closed"] and caught.value.exit_code == EXIT_SIGNALLED + number


def test_a_signal_before_the_event_loop_begins_is_heard_in_it():
    async def work(came):
        await asyncio.wait_for(came, PATIENCE_S)

    with pytest.raises(Interrupted), signals_raise(), signals_held():
        signal.raise_signal(signal.SIGTERM)
        run_until_signal(work)


@pytest.mark.parametrize("place", ["inside", "at the end"])
def test_a_temporary_folder_goes_whenever_the_signal_comes(place, monkeypatch):
    if place == "at the end":
        rmtree = processes.shutil.rmtree

        def interrupted(*arguments, **options):
            signal.raise_signal(signal.SIGTERM)
            rmtree(*arguments, **options)
        monkeypatch.setattr(processes.shutil, "rmtree", interrupted)
    with pytest.raises(Interrupted), signals_raise(), temporary_folder("aras_test_") as folder:
        assert pathlib.Path(folder).is_dir()
        if place == "inside":
            signal.raise_signal(signal.SIGTERM)
    assert not pathlib.Path(folder).exists()


def test_processes_are_found_by_their_mark_also_when_their_parent_is_gone():
    environment = marked(os.environ)
    mark = environment[processes.MARK]
    subprocess.run(["sh", "-c", "sleep 600 & exit 0"], env=environment, check=True)
    end_s = time.monotonic() + PATIENCE_S
    while "sleep" not in processes_of(mark).values():  # while it becomes that program it has no environment
        assert time.monotonic() < end_s
        time.sleep(0.01)
    [pid] = processes_of(mark)
    os.kill(pid, signal.SIGKILL)
    while processes_of(mark):
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_a_child_ends_with_its_parent():
    environment = marked(os.environ)
    mark = environment[processes.MARK]
    code = ("import subprocess, sys, time\n"
            "from aras_visual_servo.processes import end_with_parent\n"
            "subprocess.Popen(['sleep', '600'], preexec_fn=end_with_parent)\n"
            "print('started', flush=True)\n"
            "time.sleep(600)")
    parent = subprocess.Popen([sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, text=True)
    assert parent.stdout.readline() == "started\n" and len(processes_of(mark)) == 2
    parent.kill()
    parent.communicate()
    end_s = time.monotonic() + PATIENCE_S
    while processes_of(mark):
        assert time.monotonic() < end_s
        time.sleep(0.01)


def orphan(path):
    """Of a process whose parent has died before it asks to end with it."""
    while os.getppid() == multiprocessing.parent_process().pid:
        time.sleep(0.001)
    processes.end_with_parent()
    path.touch()


def test_a_child_whose_parent_has_died_already_ends(tmp_path):
    context = multiprocessing.get_context("fork")

    def parent(path):
        child = context.Process(target=orphan, args=(path / "on",))
        child.start()
        (path / "pid").write_text(str(child.pid))
        os._exit(0)
    between = context.Process(target=parent, args=(tmp_path,))
    between.start()
    between.join(PATIENCE_S)
    with contextlib.suppress(psutil.NoSuchProcess):
        psutil.Process(int((tmp_path / "pid").read_text())).wait(PATIENCE_S)
    assert not (tmp_path / "on").exists()
