"""Renders on a cluster of Dask, to the bytes of one machine.

>>> from distributed import Client
>>> import kajo, kajo.farm
>>> image = kajo.farm.render(scene, client=Client("tcp://head:8786"), size=(800, 600), samples=("sobol", 1024))

The package `kajo` with its program is needed on every machine, and Dask: pip install "kajo[dask]".
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import IO, Any

from .._scene import Scene, Value, _value
from ._certificates import FarmError, default_folder

__all__ = ["FarmError", "Picture", "connect", "coordinate", "default_folder", "render"]


class Picture:
    """The file of a picture that a farm has rendered."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._bytes = path.read_bytes()

    def encode(self) -> bytes:
        """Its bytes."""
        return self._bytes

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a copy."""
        Path(path).write_bytes(self._bytes)

    def _repr_png_(self) -> bytes | None:
        return self._bytes if self._bytes.startswith(b"\x89PNG") else None

    def __repr__(self) -> str:
        return f"<kajo.farm.Picture {self.path.name}: {len(self._bytes)} bytes>"


def connect(address: str, *, config: str | os.PathLike[str] | None = None, timeout: float = 20.0) -> Any:
    """A Dask client of the farm whose scheduler has this address.

    Args:
        address: tls://HOST:PORT, or tcp:// of a cluster without certificates.
        config: the folder of the certificates; by default that of `default_folder`.
        timeout: seconds until it is given up.

    Raises:
        FarmError: when there is no Dask, no certificates, or nobody answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise FarmError('Dask is not installed: pip install "kajo[dask]"') from None
    from ._certificates import security

    arguments: dict[str, Any] = {"timeout": timeout, "set_as_default": False, "name": "kajo"}
    if address.startswith("tls://"):
        arguments["security"] = security(Path(config) if config is not None else default_folder())
    try:
        with _quiet_logs():
            return Client(address, **arguments)
    except (OSError, ValueError, RuntimeError) as error:
        cause = error.__cause__ or error
        raise FarmError(f"no scheduler answers at {address}, or it refuses these certificates: {cause}") from None


def coordinate(
    client: Any,
    arguments: Sequence[str],
    *,
    folder: str | os.PathLike[str] | None = None,
    stderr: IO[bytes] | int | None = None,
) -> int:
    """Runs `kajo render` with these words, whose units a cluster renders. Returns its exit code.

    Args:
        client: of the cluster.
        arguments: words behind `kajo render`, without --farm.
        folder: the folder that names in them are looked up in.
        stderr: where the program talks to; the process's own by default.
    """
    from ._engine import Engine
    from ._worker import program

    process = subprocess.Popen(
        [program(), "render", *arguments, "--farm", "stdio"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=stderr,
        cwd=folder,
    )
    assert process.stdin is not None and process.stdout is not None
    with process, _patient():
        try:
            with _quiet_logs():
                Engine(client, process.stdout, process.stdin).run()
        finally:
            # The end of its input ends it, if all else did not.
            with contextlib.suppress(OSError):
                process.stdin.close()
            code = process.wait()
    return code


@contextlib.contextmanager
def _patient() -> Iterator[None]:
    """Leaves Ctrl-C to the program, which keeps what is finished and then ends."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:
        # Not on the main thread: then it does not come here.
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def _quiet_logs() -> Iterator[None]:
    """Keeps Dask from telling of every lost connection, which is told once, in words, anyway."""
    import logging

    logger = logging.getLogger("distributed")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(level)


def render(
    scene: Scene | str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    *,
    client: Any = None,
    address: str | None = None,
    config: str | os.PathLike[str] | None = None,
    layers: Iterable[str] = ("color",),
    job: str | os.PathLike[str] | None = None,
    preview: str | os.PathLike[str] | None = None,
    options: Sequence[str] = (),
    log: Callable[[str], object] | None = None,
    **settings: Value,
) -> Picture:
    """Renders a scene on a cluster, to the bytes of one machine.

    Args:
        scene: a scene, or the path of its file.
        output: the picture's file: .exr or .png. By default a temporary one, in OpenEXR.
        client: a Dask client of the cluster, such as that of a LocalCluster.
        address: of the cluster's scheduler, in place of a client.
        config: the folder of the certificates, for an address.
        layers: what the file shows; only OpenEXR shows several.
        job: the folder of what is finished. With the same one the same render goes on where it was ended.
        preview: a file that shows the picture so far.
        options: further words of the command line of `kajo render`.
        log: takes lines that the program says.
        settings: as for `Scene.render`: size=(800, 600), samples=("sobol", 64), integrator="path"; also noise=0.01 and
            adaptive=True.

    Raises:
        FarmError: with what the program said, when there is no picture.
    """
    own = client is None
    if own:
        if address is None:
            raise FarmError("name a client or the address of a cluster")
        client = connect(address, config=config)
    keep = Path(tempfile.mkdtemp(prefix="kajo-farm-"))
    try:
        path = Path(output) if output is not None else keep / "out.exr"
        source = Path(scene) if not isinstance(scene, Scene) else keep / "scene.kbundle"
        if isinstance(scene, Scene):
            source.write_bytes(scene.bundle())
        words = [str(source), "-o", str(path), "--quiet", *_words(settings)]
        names = [name for name in layers if name != "color"]
        words += ["--layers", ",".join(["color", *names])] if names else []
        words += ["--job", str(job)] if job is not None else []
        words += ["--preview", str(preview)] if preview is not None else []
        with tempfile.TemporaryFile() as said:
            code = coordinate(client, [*words, *options], stderr=said)
            said.seek(0)
            text = said.read().decode(errors="replace").strip()
        for line in text.splitlines() if log is not None else ():
            log(line)  # type: ignore[misc]
        if code == 130:
            raise KeyboardInterrupt
        if code != 0:
            raise FarmError(text or f"the program ended with {code}")
        return Picture(path)
    finally:
        shutil.rmtree(keep, ignore_errors=True)
        if own:
            client.close(timeout=2)


def _words(settings: dict[str, Value]) -> list[str]:
    """Settings as options of the command line."""
    words: list[str] = []
    for key, value in settings.items():
        option = "--" + key.replace("_", "-")
        if key == "samples" and isinstance(value, int):
            value = ("jittered", value)
        if key != "adaptive":
            words += [option, *_value(value).split(" ")]
        elif value:
            words.append(option)
    return words

