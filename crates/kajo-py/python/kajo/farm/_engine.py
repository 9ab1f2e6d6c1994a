"""Between a coordinator, `kajo render --farm stdio`, and a cluster of Dask: which worker has which unit.

Truth about what is finished is in the folder of the job, which the coordinator keeps. Here nothing is known but what
is out. A unit is one task, pinned to a worker that has none; tasks do not depend on each other, and each result is
gathered and released at once. Dask is a way to machines here, and no more: whatever it loses, the coordinator orders
again.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import CancelledError
from pathlib import Path
from typing import IO, Any

from . import _protocol, _worker

PIECE = 16 << 20
"""Bytes of a bundle that are sent at once."""

MOST_FAULTS = 5
"""Units that a worker may lose or fail in a row, before it is left out."""


class _Host:
    """A worker of the cluster."""

    def __init__(self, address: str, name: str, threads: int) -> None:
        self.address = address
        self.name = name
        self.threads = threads
        self.ready = False
        self.refused = False
        self.unit: tuple[int, int] | None = None
        self.faults = 0
        self.since = time.monotonic()


class Engine:
    """Serves one coordinator.

    Args:
        client: of the cluster.
        orders: what the coordinator writes.
        news: what it reads.
        tell: takes lines for the user.
    """

    def __init__(
        self, client: Any, orders: IO[bytes], news: IO[bytes], tell: Callable[[str], None] | None = None
    ) -> None:
        self._client = client
        self._orders = orders
        self._news = news
        self._tell = tell
        self._events: queue.Queue[tuple[Any, ...]] = queue.Queue()
        self._hosts: dict[str, _Host] = {}
        self._waiting: list[tuple[int, int, list[str]]] = []
        self._futures: dict[tuple[str, int, int], Any] = {}
        self._plan = ""
        self._bundle = b""
        self._digest = ""
        self._stage = 0
        self._position = b""
        self._room = -1
        self._over = False
        self._refusals: list[str] = []
        self._started = time.monotonic()
        self._warned = False

    def run(self) -> None:
        """Serves until the coordinator ends or says that all is done."""
        for target in (self._hear, self._watch):
            threading.Thread(target=target, daemon=True).start()
        try:
            while not self._over:
                kind, *values = self._events.get()
                getattr(self, f"_on_{kind}")(*values)
        finally:
            self._over = True
            for future in list(self._futures.values()):
                future.cancel()
            busy = [host.address for host in self._hosts.values() if host.unit is not None]
            if busy:
                # A moment, so that the message is out before the client closes.
                self._end_children(busy).join(2.0)

    def _hear(self) -> None:
        """Hears the coordinator, on a thread of its own."""
        try:
            while (message := _protocol.receive(self._orders)) is not None:
                self._events.put(("order", *message))
        except (OSError, EOFError, ValueError):
            pass
        self._events.put(("end",))

    def _watch(self) -> None:
        """Looks which workers there are, on a thread of its own."""
        silent = time.monotonic()
        while not self._over:
            try:
                known = _workers_of(self._client.scheduler_info(n_workers=-1))
                silent = time.monotonic()
                self._events.put(("workers", known))
            except Exception as error:
                if time.monotonic() - silent > 10 or self._client.status == "closed":
                    self._events.put(("lost_scheduler", str(error)))
                    return
            time.sleep(0.3 if len(self._hosts) < 20 else 1.0)

    def _say(self, message: dict[str, Any], data: bytes = b"") -> None:
        try:
            _protocol.send(self._news, message, data)
        except OSError:
            self._over = True

    def _note(self, text: str) -> None:
        self._say({"is": "note", "message": text})

    def _on_end(self) -> None:
        self._over = True

    def _on_lost_scheduler(self, why: str) -> None:
        self._say({"is": "over", "wrong": False, "message": f"the scheduler does not answer: {why}"})

    def _on_order(self, order: dict[str, Any], data: bytes) -> None:
        match order["do"]:
            case "plan":
                self._plan = order["plan"]
                self._bundle = Path(order["bundle"]).read_bytes()
                self._digest = _worker.digest_of(self._plan, self._bundle)
            case "stage":
                self._stage, self._position = order["stage"], data
                self._waiting.clear()
            case "unit":
                self._waiting.append((order["stage"], order["unit"], order["avoid"]))
            case "drop":
                self._drop(order["stage"], order["unit"])
            case "end":
                self._over = True
        self._hand_out()

    def _on_workers(self, known: dict[str, tuple[str, int]]) -> None:
        """Workers have come or gone."""
        for address in self._hosts.keys() - known.keys():
            host = self._hosts.pop(address)
            if host.unit is not None:
                self._lost(host, "worker", "its worker is gone")
        for address in known.keys() - self._hosts.keys():
            name, threads = known[address]
            host = self._hosts[address] = _Host(address, name, threads)
            threading.Thread(target=self._prepare, args=(host,), daemon=True).start()
        if not self._hosts and not self._warned and time.monotonic() - self._started > 5:
            self._warned = True
            self._note("no worker has joined the cluster yet; waiting (kajo farm join, on each machine)")
        self._make_room()
        self._hand_out()

    def _prepare(self, host: _Host) -> None:
        """Gives a worker the plan and the bundle, on a thread of its own."""
        while not self._digest and not self._over:
            time.sleep(0.01)
        try:
            offset = 0
            while offset >= 0 and not self._over:
                piece = self._bundle[offset : offset + PIECE]
                task = self._client.submit(
                    _worker.take,
                    self._digest,
                    self._plan,
                    piece,
                    offset,
                    workers=[host.address],
                    pure=False,
                    retries=0,
                )
                offset = task.result()
                task.release()
            self._events.put(("ready", host.address))
        except CancelledError:
            # The scheduler was lost, and with it the task; of the worker that says nothing.
            self._events.put(("unprepared", host.address, ""))
        except Exception as error:
            self._events.put(("unprepared", host.address, f"{type(error).__name__}: {error}"))

    def _on_ready(self, address: str) -> None:
        if address in self._hosts:
            self._hosts[address].ready = True
            self._make_room()
            self._hand_out()

    def _on_unprepared(self, address: str, why: str) -> None:
        if address not in self._hosts:
            return
        if why:
            self._refuse(self._hosts[address], f"it cannot take the job: {why}")
        else:
            # It is met anew, if it is still there.
            del self._hosts[address]

    def _refuse(self, host: _Host, why: str) -> None:
        """A worker is left out."""
        host.refused = True
        self._refusals.append(f"{host.name}: {why}")
        self._note(f"{host.name} is left out: {why}")
        if all(known.refused for known in self._hosts.values()):
            told = "\n  ".join(self._refusals[-10:])
            self._say({"is": "over", "wrong": True, "message": f"no machine of the cluster can render this:\n  {told}"})
        self._make_room()

    def _make_room(self) -> None:
        room = sum(host.ready and not host.refused for host in self._hosts.values())
        if room != self._room:
            self._room = room
            self._say({"is": "room", "units": room})

    def _hand_out(self) -> None:
        """Gives waiting units to workers that have none: one where it has not failed, if there is any."""
        free = [host for host in self._hosts.values() if host.ready and not host.refused and host.unit is None]
        held: list[tuple[int, int, list[str]]] = []
        for stage, unit, avoid in self._waiting:
            having = {host.name for host in self._hosts.values() if host.unit == (stage, unit)}
            fresh = [host for host in free if host.name not in avoid and host.name not in having]
            others = any(
                host.name not in avoid and host.ready and not host.refused for host in self._hosts.values()
            )
            # Better late on another machine than at once where it failed.
            chosen = fresh[0] if fresh else (free[0] if free and not others and not having else None)
            if chosen is None:
                held.append((stage, unit, avoid))
                continue
            free.remove(chosen)
            self._start(chosen, stage, unit)
        self._waiting = held

    def _start(self, host: _Host, stage: int, unit: int) -> None:
        host.unit, host.since = (stage, unit), time.monotonic()
        position = self._position
        future = self._client.submit(
            _worker.render,
            self._digest,
            stage,
            unit,
            position,
            host.threads,
            workers=[host.address],
            pure=False,
            retries=0,
        )
        self._futures[host.address, stage, unit] = future
        future.add_done_callback(lambda future: self._events.put(("done", host, stage, unit, future)))

    def _on_done(self, host: _Host, stage: int, unit: int, future: Any) -> None:
        """A task has ended, somehow."""
        known: Any = self._futures.get((host.address, stage, unit))
        if known is not future:
            return
        if future.status == "finished":
            threading.Thread(target=self._gather, args=(host, stage, unit, future), daemon=True).start()
            return
        why = self._quietly(lambda: str(future.exception())) or "its task was lost"
        self._on_gathered(host, stage, unit, future, None, why)

    def _gather(self, host: _Host, stage: int, unit: int, future: Any) -> None:
        """Fetches a result, on a thread of its own: of a worker that is gone it comes when the task is cancelled."""
        try:
            result, why = future.result(), ""
        except Exception as error:
            result, why = None, f"{type(error).__name__}: {error}"
        self._events.put(("gathered", host, stage, unit, future, result, why))

    def _on_gathered(
        self, host: _Host, stage: int, unit: int, future: Any, result: tuple[dict[str, Any], bytes] | None, why: str
    ) -> None:
        """A result has been fetched, or there is none."""
        key = (host.address, stage, unit)
        known: Any = self._futures.get(key)
        if known is not future:
            return
        del self._futures[key]
        future.release()
        if result is None:
            self._lost(host, "worker", why)
        else:
            self._answered(host, stage, unit, *result)
        self._hand_out()

    def _answered(self, host: _Host, stage: int, unit: int, answer: dict[str, Any], part: bytes) -> None:
        if answer.get("ok"):
            host.unit, host.faults = None, 0
            news = {key: answer.get(key, 0) for key in ("samples", "rays", "seconds")}
            self._say({"is": "part", "stage": stage, "unit": unit, "host": host.name, **news}, part)
            return
        message = answer.get("message") or "it gave no reason"
        if answer.get("unknown"):
            host.ready = False
            threading.Thread(target=self._prepare, args=(host,), daemon=True).start()
            self._make_room()
        if answer.get("kind") == "refused":
            self._lost(host, "worker", message)
            self._refuse(host, message)
            return
        self._lost(host, answer.get("kind") or "unit", message)

    def _lost(self, host: _Host, kind: str, message: str) -> None:
        """A unit comes back without a part."""
        if host.unit is None:
            return
        stage, unit = host.unit
        future = self._futures.pop((host.address, stage, unit), None)
        if future is not None:
            future.cancel()
        host.unit = None
        host.faults += 1
        self._say(
            {
                "is": "lost",
                "stage": stage,
                "unit": unit,
                "host": host.name,
                "kind": kind,
                "message": f"{host.name}: {message}",
            }
        )
        alone = sum(known.ready and not known.refused for known in self._hosts.values()) <= 1
        if host.faults >= MOST_FAULTS and not alone:
            self._refuse(host, f"it lost {MOST_FAULTS} units in a row, the last: {message}")

    def _drop(self, stage: int, unit: int) -> None:
        """A unit is not wanted any more."""
        self._waiting = [waiting for waiting in self._waiting if waiting[:2] != (stage, unit)]
        for host in self._hosts.values():
            if host.unit == (stage, unit):
                host.unit = None
                future = self._futures.pop((host.address, stage, unit), None)
                if future is not None:
                    future.cancel()
                self._end_children([host.address])

    def _end_children(self, addresses: list[str]) -> threading.Thread:
        """Has workers end what they render, on a thread of its own: one that was just killed is called for long."""

        def act() -> None:
            self._quietly(lambda: self._client.run(_worker.drop, workers=addresses, on_error="ignore"))

        thread = threading.Thread(target=act, daemon=True)
        thread.start()
        return thread

    @staticmethod
    def _quietly(act: Callable[[], Any]) -> Any:
        try:
            return act()
        except Exception:
            return None


def _workers_of(info: dict[str, Any]) -> dict[str, tuple[str, int]]:
    """Address, name and threads of each worker."""
    workers: dict[str, tuple[str, int]] = {}
    for address, worker in info["workers"].items():
        if worker.get("status", "running") not in ("running", "paused"):
            continue
        name = str(worker.get("name", ""))
        port = address.rsplit(":", 1)[-1]
        is_name = name and "://" not in name and not name.isdigit()
        workers[address] = (name if is_name else f"{worker.get('host', address)}:{port}", worker.get("nthreads", 1))
    return workers
