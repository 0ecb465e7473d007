"""Tasks run by Dask workers, on this machine or those of a scheduler."""

import asyncio
import importlib.metadata
import logging
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import Any, TypeVar

from garmentimage.errors import DatasetError, quoted
from garmentimage.system import ctrl_c_held

MAX_QUEUED = 2
"""Tasks queued for each worker."""
TIMEOUT_S = 20.0
"""For the answer of a scheduler."""
RESUME_HINT = "finished shards are kept; run the same command again"

Work = TypeVar("Work")
Result = TypeVar("Result")


def run_tasks(
    do: Callable[[Work], Result],
    tasks: Sequence[Work],
    scheduler: str | None,
    workers: int,
) -> Iterator[tuple[Work, Result]]:
    """Tasks with their results, in order of completion; only a few are queued at any time.

    Args:
        do: a function that workers can import.
        tasks: its arguments.
        scheduler: address of a running Dask scheduler; None for processes on this machine.
        workers: processes on this machine.

    Raises:
        DatasetError: the scheduler does not answer or stops, its workers have another version of
            garmentimage, or a task kills its workers repeatedly.
    """
    from distributed import KilledWorker, as_completed
    from distributed.client import FutureCancelledError
    from distributed.comm.core import CommClosedError

    with _client(scheduler, min(workers, len(tasks))) as client:
        waiting = iter(tasks)
        most = MAX_QUEUED * max(len(client.scheduler_info(n_workers=-1)["workers"]), 1)
        of_future = {}
        running = as_completed()

        def submit(task: Work) -> None:
            future = client.submit(do, task, pure=False)
            of_future[future.key] = task
            running.add(future)

        try:
            for task in islice(waiting, most):
                submit(task)
            for future in running:
                result = future.result()
                yield of_future.pop(future.key), result
                future.release()
                for task in islice(waiting, 1):
                    submit(task)
        except KilledWorker:
            raise DatasetError(
                f"workers died repeatedly over one shard, perhaps out of memory; {RESUME_HINT}"
            ) from None
        except (FutureCancelledError, CommClosedError):
            raise DatasetError(f"the scheduler stopped; {RESUME_HINT}") from None


def check_scheduler(address: str) -> None:
    """Refuse the address of a scheduler that does not answer."""
    from distributed.comm.core import connect

    async def knock() -> None:
        comm = await connect(address, timeout=TIMEOUT_S)
        comm.abort()

    try:
        asyncio.run(asyncio.wait_for(knock(), TIMEOUT_S))
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise DatasetError(
            f"no scheduler answers at {quoted(address)} ({type(error).__name__}); start one with "
            "`dask scheduler`, and give the address that it prints, such as tcp://host:8786"
        ) from None


@contextmanager
def _client(scheduler: str | None, workers: int) -> Iterator[Any]:
    from distributed import Client, LocalCluster

    if scheduler is not None:
        check_scheduler(scheduler)
        with Client(scheduler, timeout=TIMEOUT_S) as client:
            _check_workers(client, scheduler)
            yield client
        return
    with ctrl_c_held():
        cluster = LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            memory_limit=0,
            dashboard_address="127.0.0.1:0",
            host="127.0.0.1",
            silence_logs=logging.CRITICAL,
        )
        client = Client(cluster)
    try:
        yield client
    finally:
        with _interrupts_ignored():
            client.close()
            cluster.close()


def _check_workers(client: Any, scheduler: str) -> None:
    """Refuse a scheduler without workers, or with another version of garmentimage."""
    ours = importlib.metadata.version("garmentimage")
    try:
        theirs = client.run(importlib.metadata.version, "garmentimage")
    except importlib.metadata.PackageNotFoundError:
        theirs = {"": "none"}
    if not theirs:
        raise DatasetError(
            f"the scheduler {scheduler} has no workers; start some with `dask worker {scheduler}`"
        )
    for version in theirs.values():
        if version != ours:
            raise DatasetError(
                f"workers of {scheduler} have garmentimage {version}, not {ours}; install it there"
            )


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Ignore Ctrl-C while workers are stopped."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
