"""The machines of a farm: the scheduler, workers, and those that are reached by ssh."""

from __future__ import annotations

import asyncio
import ipaddress
import logging
import os
import shlex
import signal
import socket
import subprocess
import sys
import tarfile
import threading
import time
from io import BytesIO
from pathlib import Path
from typing import Any

import dask
from distributed import Scheduler, Worker
from distributed.comm import connect

from ._certificates import CA, CERTIFICATE, KEY, FarmError, security
from ._worker import program

SETTINGS = {
    # A machine that was cut off is given up soon; its unit is rendered elsewhere.
    "distributed.scheduler.worker-ttl": "15s",
    # Whether a unit is at fault is judged by who hands units out.
    "distributed.scheduler.allowed-failures": 1_000_000,
    "distributed.comm.timeouts.connect": "10s",
    "distributed.comm.timeouts.tcp": "20s",
    "distributed.comm.retry.count": 2,
    "distributed.worker.memory.terminate": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.target": False,
    "distributed.admin.low-level-log-length": 100,
}


# Lost connections are told of once, in words.
logging.getLogger("distributed").setLevel(logging.CRITICAL)


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


async def _until_signal(work: asyncio.Future[Any] | asyncio.Task[Any]) -> int:
    """Waits for the end of some work, or for a signal; returns the number of that."""
    loop, heard = asyncio.get_running_loop(), asyncio.Event()
    numbers: list[int] = []

    def hear(number: int) -> None:
        numbers.append(number)
        heard.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, hear, number)
    waiting = asyncio.ensure_future(heard.wait())
    await asyncio.wait([work, waiting], return_when=asyncio.FIRST_COMPLETED)
    waiting.cancel()
    return numbers[0] if numbers else 0


def head(config: Path, host: str, port: int, insecure: bool) -> int:
    """Runs the scheduler until it is ended. Returns the exit code."""
    if insecure:
        secure, protocol = None, "tcp"
    elif (config / CA).exists() or not _is_loopback(host or "0.0.0.0"):
        secure, protocol = security(config), "tls"
    else:
        secure, protocol = None, "tcp"

    async def serve() -> int:
        options: dict[str, Any] = {"security": secure} if secure is not None else {}
        listening = Scheduler(
            host=host or None, port=port, protocol=protocol, dashboard=False, dashboard_address=None, **options
        )
        async with listening as scheduler:
            shown = scheduler.address
            _say(f"the scheduler listens at {shown}")
            number = await _until_signal(asyncio.ensure_future(scheduler.finished()))
            return 128 + number if number else 0

    with dask.config.set(SETTINGS):
        try:
            return asyncio.run(serve())
        except OSError as error:
            raise FarmError(f"it cannot listen at port {port}: {error}") from None


def join(config: Path, address: str, threads: int, name: str | None, insecure: bool) -> int:
    """Renders for a cluster until it is ended, and comes back when the scheduler does. Returns the exit code."""
    if not address.startswith(("tls://", "tcp://")):
        raise FarmError(f"expected the address of a scheduler such as tls://head:8786, found {address}")
    place = address.split("://")[1].rsplit(":", 1)[0]
    if address.startswith("tcp://") and not (insecure or _is_loopback(place)):
        raise FarmError(
            "a cluster without certificates runs the code of whoever reaches it: take tls://, or say --insecure"
        )
    try:
        program()
    except FileNotFoundError as error:
        raise FarmError(str(error)) from None
    secure = security(config) if address.startswith("tls://") else None
    cores = threads or len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else threads or os.cpu_count()
    called = name or socket.gethostname()

    async def once() -> int:
        options: dict[str, Any] = {"security": secure} if secure is not None else {}
        # A worker would try for ever; who is refused is told so.
        trust = secure.get_connection_args("worker") if secure is not None else {}
        await (await connect(address, timeout=5, **trust)).close()
        worker = Worker(
            address,
            nthreads=cores or 1,
            name=f"{called}-{os.getpid()}",
            memory_limit=0,
            dashboard=False,
            dashboard_address=None,
            **options,
        )
        starting = asyncio.ensure_future(_begun(worker))
        number = await _until_signal(starting)
        if number:
            starting.cancel()
            return 128 + number
        # Raises what went wrong.
        starting.result()
        _say(f"{called} renders for {address} with {cores} threads")
        number = await _until_signal(asyncio.ensure_future(worker.finished()))
        await worker.close(timeout=2)
        return 128 + number if number else 0

    told = False
    with dask.config.set(SETTINGS):
        while True:
            try:
                code = asyncio.run(once())
                if code:
                    return code
                _say(f"{address} is gone; {called} comes back when it does")
                told = True
            except Exception as error:
                why = _refusal(error)
                if why is not None:
                    raise FarmError(f"{address} refuses these certificates, or is refused by them: {why}") from None
                if not told:
                    _say(f"nobody answers at {address} yet; trying again: {error}")
                    told = True
            time.sleep(1)


async def _begun(worker: Worker) -> None:
    await worker


def _refusal(error: BaseException | None) -> str | None:
    """Why the other end does not trust this one, if that is what an error says."""
    import ssl

    while error is not None:
        if isinstance(error, ssl.SSLError) or "certificate" in str(error).lower():
            return str(error)
        error = error.__cause__ or error.__context__
    return None


def ssh(config: Path, hosts: Path, address: str, program: str, command: str) -> int:
    """Lets machines join, and keeps them at it, until it is ended. Returns the exit code."""
    try:
        lines = [line.split("#")[0].strip() for line in hosts.read_text().splitlines()]
    except OSError as error:
        raise FarmError(f"{hosts} cannot be read: {error}") from None
    names = [line for line in lines if line]
    if not names:
        raise FarmError(f"{hosts} names no machine")
    wrong = next((name for name in names if name.startswith("-") or len(name.split()) != 1), None)
    if wrong is not None:
        raise FarmError(f"{hosts}: {wrong!r} is no name of a machine")
    security(config)
    archive = BytesIO()
    with tarfile.open(fileobj=archive, mode="w") as tar:
        for name in (CA, CERTIFICATE, KEY):
            tar.add(config / name, name)
    over = threading.Event()
    running: dict[str, subprocess.Popen[bytes]] = {}
    base = [*shlex.split(command), "-o", "BatchMode=yes"]

    def keep(host: str) -> None:
        where = ".config/kajo/farm"
        copy = f"umask 077; mkdir -p {where} && tar -xf - -C {where}"
        begin = f"{shlex.quote(program)} farm join --config {where} {shlex.quote(address)}"
        while not over.is_set():
            copied = subprocess.run([*base, host, copy], input=archive.getvalue(), capture_output=True)
            if copied.returncode == 0:
                process = subprocess.Popen([*base, "-tt", host, begin], stdin=subprocess.DEVNULL, stdout=sys.stderr)
                running[host] = process
                code = process.wait()
                if code == 2:
                    _say(f"{host}: is left out, see above")
                    return
                why = f"ended with {code}"
            else:
                why = copied.stderr.decode(errors="replace").strip() or f"ended with {copied.returncode}"
            if not over.is_set():
                _say(f"{host}: {why}; trying again in 10 s")
                over.wait(10)

    threads = [threading.Thread(target=keep, args=(host,), daemon=True) for host in names]
    for thread in threads:
        thread.start()
    before = signal.signal(signal.SIGTERM, lambda *_: over.set())
    try:
        while not over.is_set() and any(thread.is_alive() for thread in threads):
            over.wait(0.2)
        return 0 if over.is_set() else 2
    finally:
        over.set()
        signal.signal(signal.SIGTERM, before)
        for process in running.values():
            process.terminate()
