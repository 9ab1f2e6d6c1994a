"""What runs on the machines of a cluster, in the process of a Dask worker.

There a child renders, `kajo worker --stdio`: it keeps the scene from unit to unit, its crash costs a unit and no
worker, and it goes when the worker does. Plans and bundles are handed over once for each job, in pieces, and kept by
their digest.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import signal
import subprocess
import sysconfig
import tempfile
import threading
from pathlib import Path
from typing import IO, Any

from . import _protocol

Answer = tuple[dict[str, Any], bytes]
"""What became of a unit, and its part."""


def program() -> str:
    """The program kajo of this installation.

    Raises:
        FileNotFoundError: when there is none.
    """
    named = os.environ.get("KAJO_PROGRAM")
    beside = Path(sysconfig.get_path("scripts")) / ("kajo.exe" if os.name == "nt" else "kajo")
    found = named or (str(beside) if beside.exists() else shutil.which("kajo"))
    if not found:
        raise FileNotFoundError("the program kajo is not installed here: pip install kajo")
    return found


class _Child:
    """A process that renders units of one plan."""

    def __init__(self, digest: str, plan: str, bundle: bytes, threads: int) -> None:
        self.digest = digest
        self.said: IO[bytes] = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            [program(), "worker", "--stdio", "--threads", str(threads)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.said,
        )
        assert self.process.stdin is not None and self.process.stdout is not None
        self.input, self.output = self.process.stdin, self.process.stdout
        self.opened, _ = self.ask({"do": "open", "plan": plan}, bundle)

    def ask(self, message: dict[str, Any], data: bytes) -> Answer:
        """Asks it for something; the answer says what went wrong, the end of the process among it."""
        try:
            _protocol.send(self.input, message, data)
            answer = _protocol.receive(self.output)
            if answer is not None:
                return answer
        except (OSError, EOFError, ValueError):
            pass
        return self.ended(), b""

    def ended(self) -> dict[str, Any]:
        """Why the process is gone."""
        self.end(patience=2)
        code = self.process.returncode
        self.said.seek(max(0, self.said.seek(0, os.SEEK_END) - 2000))
        said = self.said.read().decode(errors="replace").strip()
        outside = {-signal.SIGTERM, -signal.SIGINT, -9, -1, 75, 129, 130, 143}
        kind = "worker" if code in outside else "unit"
        message = f"its process ended with {code}" + (f": {said}" if said else "")
        return {"ok": False, "kind": kind, "message": message, "gone": True}

    def end(self, patience: float = 0.0) -> None:
        """Ends it."""
        if patience:
            try:
                self.process.wait(patience)
                return
            except subprocess.TimeoutExpired:
                pass
        self.process.kill()
        self.process.wait()


class _Slot:
    """One worker: there may be several in a process."""

    def __init__(self) -> None:
        self.rendering = threading.Lock()
        self.child: _Child | None = None


_lock = threading.Lock()
_slots: dict[str, _Slot] = {}
_jobs: dict[str, tuple[str, bytes]] = {}
_pieces: dict[str, list[bytes]] = {}


def _slot(address: str) -> _Slot:
    with _lock:
        return _slots.setdefault(address, _Slot())


def take(digest: str, plan: str, piece: bytes, offset: int) -> int:
    """Takes a piece of a bundle. Returns how many bytes of it are there now; -1 once it is whole.

    Args:
        digest: of plan and bundle together.
        plan: the text of the plan.
        piece: some bytes.
        offset: where they belong.
    """
    with _lock:
        if digest in _jobs:
            return -1
        pieces = _pieces.setdefault(digest, [])
        have = sum(map(len, pieces))
        if offset == have and piece:
            pieces.append(piece)
            have += len(piece)
        whole = b"".join(pieces)
        if digest_of(plan, whole) == digest:
            # Of other jobs nothing is kept, so that memory is bounded.
            _jobs.clear()
            _pieces.clear()
            _jobs[digest] = (plan, whole)
            return -1
        return have


def digest_of(plan: str, bundle: bytes) -> str:
    """What plan and bundle are known by."""
    digest = hashlib.sha256(len(plan.encode()).to_bytes(8, "little") + plan.encode())
    digest.update(bundle)
    return digest.hexdigest()


def render(digest: str, stage: int, unit: int, position: bytes, threads: int) -> Answer:
    """Renders a unit. Fields of the answer are those of `kajo worker`; its kind may also be `refused`, of the worker.

    Args:
        digest: of the job, as `take` was told.
        stage, unit: what to render.
        position: where the stage begins.
        threads: of the child.
    """
    slot = _slot(_address())
    # One after the other: the child has all threads.
    with slot.rendering:
        return _render(slot, digest, stage, unit, position, threads)


def _address() -> str:
    """The address of the worker whose task this is."""
    from distributed import get_worker

    try:
        return str(get_worker().address)
    except ValueError:
        return ""


def _render(slot: _Slot, digest: str, stage: int, unit: int, position: bytes, threads: int) -> Answer:
    with _lock:
        job = _jobs.get(digest)
    if job is None:
        return {"ok": False, "kind": "worker", "message": "it does not know the job", "unknown": True}, b""
    child = slot.child
    if child is None or child.digest != digest or child.process.poll() is not None:
        if child is not None:
            child.end()
        try:
            child = slot.child = _Child(digest, *job, threads)
        except OSError as error:
            return {"ok": False, "kind": "refused", "message": str(error)}, b""
        if not child.opened.get("ok"):
            kind = "worker" if child.opened.get("gone") else "refused"
            child.end()
            return {**child.opened, "kind": kind}, b""
    answer, part = child.ask({"do": "unit", "stage": stage, "unit": unit}, position)
    if not answer.get("ok") and answer.get("kind") != "input":
        # Whatever went wrong, the next unit begins afresh.
        child.end()
    return answer, part


async def drop(dask_worker: Any) -> None:
    """Ends the child of a worker, so that what it renders comes back."""
    child = _slot(str(dask_worker.address)).child
    if child is not None:
        child.process.kill()


def _at_exit() -> None:
    for slot in _slots.values():
        if slot.child is not None:
            slot.child.process.kill()


atexit.register(_at_exit)
