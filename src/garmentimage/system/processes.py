"""Work spread over processes, where one item may hang or crash without harm to the others."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from time import monotonic
from typing import Any, Generic, TypeVar

from garmentimage.system.interrupts import ctrl_c_held

Item = TypeVar("Item")
Result = TypeVar("Result")

START_ALLOWANCE_S = 120.0
"""Added to the time limit of a process's first item, which also pays for imports and compiling."""


BLAS_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Set to 1 for the workers: every core has a process already, and the matrices are small."""


@dataclass(frozen=True)
class TimedOut:
    """What stands for the result of an item whose process hung or died."""

    reason: str


@dataclass(frozen=True)
class Outcome(Generic[Result]):
    """What became of one item."""

    number: int
    """Which item."""
    result: Result | TimedOut
    is_first: bool
    """The first item of its process, which also paid for imports and compiling."""


@dataclass
class _Worker:
    """One process and the item that it is busy with."""

    process: BaseProcess
    connection: Connection
    item: int | None = None
    deadline: float = 0.0
    given: int = 0  # items so far

    def give(self, number: int, item: object, time_limit: float) -> None:
        self.item = number
        self.deadline = monotonic() + time_limit + (0.0 if self.given else START_ALLOWANCE_S)
        self.given += 1
        self.connection.send(item)

    def stop(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


def map_in_processes(
    work: Callable[[Item], Result], items: Sequence[Item], *, workers: int, time_limit: float
) -> Iterator[Outcome[Result]]:
    """Apply `work` to every item; yield its outcome as outcomes come.

    Args:
        work: a function that a fresh process can import; it should not raise.
        items: what it is applied to; must survive pickling.
        workers: number of processes, at least 1.
        time_limit: an item that takes longer [s] is abandoned and its process replaced.
    """
    queue = list(enumerate(items))[::-1]
    crew = [_hire(work) for _ in range(min(workers, len(items)))]
    try:
        while True:
            for worker in crew:
                if worker.item is None and queue:
                    worker.give(*queue.pop(), time_limit)
            busy = [w for w in crew if w.item is not None]
            if not busy:
                return
            patience = max(0.0, min(w.deadline for w in busy) - monotonic())
            ready = wait([w.connection for w in busy], timeout=patience)
            for worker in busy:
                if worker.connection in ready:
                    outcome: Any = _receive(worker)
                elif monotonic() > worker.deadline:
                    outcome = TimedOut(f"took longer than {time_limit:g} s and was stopped")
                else:
                    continue
                number, worker.item = worker.item, None
                assert number is not None
                if isinstance(outcome, TimedOut):
                    worker.stop()
                    crew[crew.index(worker)] = _hire(work)
                yield Outcome(number, outcome, is_first=worker.given == 1)
    finally:
        for worker in crew:
            worker.stop()


def _hire(work: Callable[[Any], object]) -> _Worker:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(work, theirs), daemon=True)
    before = {name: os.environ.get(name) for name in BLAS_THREADS}
    os.environ.update(dict.fromkeys(BLAS_THREADS, "1"))  # a fresh process reads it as it starts
    try:
        with ctrl_c_held():
            process.start()
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
    theirs.close()
    return _Worker(process, ours)


def _serve(work: Callable[[Any], object], connection: Connection) -> None:
    """Life of a worker process: take an item, send its result, until the other end is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            item = connection.recv()
        except EOFError:
            return
        connection.send(work(item))


def _receive(worker: _Worker) -> Any:
    try:
        return worker.connection.recv()
    except (EOFError, ConnectionError):
        worker.process.join()
        return TimedOut(f"the process died (exit code {worker.process.exitcode})")
