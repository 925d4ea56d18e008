"""The chunks of a map on a `dask.distributed` cluster; they come back to this process, which alone writes."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from importlib.metadata import version
from itertools import islice
from typing import Any

from zerorev.errors import InputError, ZerorevError
from zerorev.maps.cells import Block, answer
from zerorev.maps.chunks import Chunks
from zerorev.maps.run import Answered, Runner
from zerorev.model.map_task import Question

__all__ = ["cluster"]

PATIENCE = 10.0  # [s] for a scheduler to answer
WAIT_FOR_WORKERS = 60.0  # [s] for its first worker
AHEAD = 4  # chunks a thread of the cluster that are handed out and not yet back
LEAST_AHEAD = 16
RETRIES = 3


@contextmanager
def cluster(address: str) -> Iterator[Runner]:
    """The cluster of a scheduler, for as long as the `with` statement lasts.

    Args:
        address: of the scheduler, e.g. tcp://10.0.0.1:8786.

    Raises:
        InputError: no scheduler answers there, or it has no worker.
    """
    from distributed import Client

    client = _client(Client, address)
    try:
        yield partial(_answered, client, address)
    finally:
        client.close(timeout=PATIENCE)


def _answered(
    client: Any, address: str, question: Question, chunks: Chunks, missing: Sequence[int]
) -> Generator[Answered, None, None]:
    from distributed import as_completed

    left = iter(missing)

    def submit(count: int) -> list[Any]:
        # lost workers are the scheduler's business: it gives their chunks to others
        return [
            client.submit(_answer, version("zerorev"), question, chunks.block(n), pure=False, retries=RETRIES)
            for n in islice(left, count)
        ]

    ahead = max(LEAST_AHEAD, AHEAD * sum(client.nthreads().values()))
    running: Any = as_completed(submit(ahead), loop=client.loop)  # type: ignore[no-untyped-call]
    for future in running:
        yield _result(future, address)
        future.release()
        running.update(submit(1))


def _client(make: Any, address: str) -> Any:
    """A client of the scheduler, which has a worker at least.

    Raises:
        InputError: no scheduler answers, or it has no worker.
    """
    accepted = "the address that dask scheduler prints, e.g. tcp://10.0.0.1:8786"
    try:
        client = make(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, ImportError) as error:  # ValueError: no such kind of address
        why = str(error).partition("\n")[0] or type(error).__name__
        raise InputError(
            f"no scheduler answers at {address!r} ({why})", where="--scheduler", accepted=accepted
        ) from None
    try:
        client.wait_for_workers(1, timeout=WAIT_FOR_WORKERS)
    except (OSError, TimeoutError):
        client.close(timeout=PATIENCE)
        what = f"the scheduler at {address} has no worker"
        raise InputError(what, where="--scheduler", accepted=f"dask worker {address}, once or more") from None
    return client


def _result(future: Any, address: str) -> Answered:
    """What became of a chunk.

    Raises:
        ZerorevError: the cluster is lost, or a worker cannot do its work.
    """
    from asyncio import CancelledError

    try:
        answered: Answered = future.result()
    except ZerorevError:
        raise
    except CancelledError:
        raise ZerorevError(f"the scheduler at {address} is lost") from None
    except Exception as error:  # whatever kills a worker or its task, on another machine
        raise ZerorevError(f"the cluster at {address} failed: {type(error).__name__}: {error}") from None
    return answered


def _answer(wanted: str, question: Question, block: Block) -> Answered:
    """Answer a chunk on a worker, which must be of the same version, for a map is the same whoever runs it."""
    here = version("zerorev")
    if here != wanted:
        raise ZerorevError(f"a worker of the cluster has zerorev {here}, and this is {wanted}; install the same on all")
    return block.number, answer(question, block)
