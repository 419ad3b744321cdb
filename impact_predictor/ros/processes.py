"""Programs of this package as processes that are watched: started, asked to end, and heard when they fail."""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
from typing import IO, Final

from ..errors import InputError

PATIENCE: Final = 10.0
"""Seconds that a process gets to end."""

_DOMAINS: Final = range(1, 102)
"""ROS domains whose ports are clear of those that Linux hands to ordinary sockets."""

_PARTICIPANTS: Final = 10
"""Processes of a ROS domain whose ports are looked at: each takes the first that is free."""


def ros_environment() -> dict[str, str]:
    """The environment of processes that see each other on this machine, and nobody else; InputError where every ROS
    domain is in use.
    """
    for domain in random.sample(_DOMAINS, len(_DOMAINS)):
        if is_free(domain):
            return {**os.environ, "ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    raise InputError("every ROS domain of this machine is in use; end some of the processes that use ROS")


def is_free(domain: int) -> bool:
    """Whether nobody listens on the ports of a ROS domain, as RTPS 2.3, section 9.6.1.1, numbers them.

    Where ROS keeps to this machine nobody need listen for the others of a domain at its first port: then the ports of
    the first participants tell.
    """
    first = 7400 + 250 * domain
    return all(map(_can_listen, (first, *range(first + 10, first + 10 + 2 * _PARTICIPANTS, 2))))


def _can_listen(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        try:
            listener.bind(("", port))
        except OSError:
            return False
    return True


class Child:
    """A Python process; a context manager that leaves nothing running."""

    def __init__(self, name: str, environment: dict[str, str], *arguments: str) -> None:
        """Prepare the Python of this process with some arguments; `name` is for error messages."""
        self.name = name
        self._environment = environment
        self._arguments = arguments

    def __enter__(self) -> Child:
        self._output = tempfile.TemporaryFile()
        self._errors = tempfile.TemporaryFile()
        self._process = subprocess.Popen(
            [sys.executable, *self._arguments],
            env=self._environment,
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=self._errors,
            # Ctrl-C is for this process alone, which ends its children in order.
            start_new_session=True,
        )
        return self

    def __exit__(self, *_: object) -> None:
        if not self.ended:
            self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._output.close()
        self._errors.close()

    @property
    def process_id(self) -> int:
        return self._process.pid

    @property
    def ended(self) -> bool:
        return self._process.poll() is not None

    def said(self) -> str:
        """What it has printed so far."""
        return _content(self._output)

    def complained(self) -> str:
        """What it has printed to standard error so far."""
        return _content(self._errors)

    def check(self) -> None:
        """See that it runs; InputError where it has ended."""
        if self.ended:
            raise self._failure()

    def end(self) -> None:
        """Ask it to end, and wait until it has; InputError where it ended with another status than 0, or not at all."""
        if not self.ended:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"the process of the {self.name} does not end within {PATIENCE:.0f} s") from error
        if self._process.returncode:
            raise self._failure()

    def _failure(self) -> InputError:
        said = " / ".join(line for line in self.complained().splitlines() if line.strip()) or "without a word"
        return InputError(f"the process of the {self.name} ended with status {self._process.returncode}: {said}")


def _content(file: IO[bytes]) -> str:
    # The place in the file is shared with the process that writes, so it must not be moved.
    return os.pread(file.fileno(), os.fstat(file.fileno()).st_size, 0).decode(errors="replace")
