"""Ctrl-C where processes are started: these never hear of it, and are ended by who started them."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def ctrl_c_held() -> Iterator[None]:
    """Ctrl-C waits until the end of the block; what is started in it never hears of it.

    A terminal sends it to every process of a command. Ours ends its workers then; they would only
    tell where they were. Where signals cannot be held (Windows), nothing is done.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Started with the first process else, and its start would let Ctrl-C through again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
