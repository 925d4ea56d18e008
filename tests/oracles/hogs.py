"""Tasks that misbehave, for the tests of what has tasks done in other processes."""

from __future__ import annotations

import os
import sys
import time


def echo(given):
    """Gives back what it is given; what is printed meanwhile is not a result."""
    for thing in given:
        print("noise")  # noqa: T201
        yield thing


def spin(given):
    """Keeps Python's lock for as long as it can, and comes to no end."""
    yield os.getpid()
    number = 10**10**6
    while True:
        number % 7919


def hoard(given):
    """Takes more memory than there may be."""
    held = [bytes(2**30) for _ in range(64)]
    yield len(held)


def die(given):
    """Ends in the middle of things."""
    yield 1
    sys.stdout.flush()
    os._exit(3)


def sleep(given):
    """Waits."""
    yield os.getpid()
    time.sleep(600)
