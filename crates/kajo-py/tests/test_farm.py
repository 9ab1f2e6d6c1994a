"""Renders on clusters of Dask, as people run them: to the bytes of one machine, whatever is killed."""

import contextlib
import os
import random
import re
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import CancelledError
from pathlib import Path

import kajo
import pytest

distributed = pytest.importorskip("distributed")
import kajo.farm  # noqa: E402
from kajo.farm import _certificates, _engine, _protocol, _worker  # noqa: E402

PROGRAM = os.environ.get("KAJO_PROGRAM")
pytestmark = pytest.mark.skipif(PROGRAM is None, reason="the program kajo is not there")

DEEP = bool(os.environ.get("KAJO_DEEP"))
HANGS = 600
"""Seconds after which a process is taken to hang. It is no measure of speed."""
SCENE = """
PerspectiveCamera { center 0 1 9  direction 0 -0.1 -1  up 0 1 0  angle 30 }
Background { color 0.2 0.3 0.5 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 } }
include "more.txt"
"""
MORE = """
Materials { Matte gold { color 0.8 0.6 0.2 }  Matte floor { color 0.5 0.5 0.5 } }
Group {
  MaterialIndex gold   Sphere { center 0 0 0  radius 1 }
  MaterialIndex floor  Plane { normal 0 1 0  offset -1 }
}
"""
RENDER = "scene.txt --size 60 44 --samples sobol 16 --integrator path --layers color,depth".split()
UNITS = ["--unit-tile", "24", "--unit-samples", "8"]


def run(folder, *words, **environment):
    env = {**os.environ, "KAJO_FARM": str(folder / "farm"), "KAJO_PYTHON": sys.executable, **environment}
    return subprocess.run([PROGRAM, *words], cwd=folder, env=env, capture_output=True, text=True, timeout=HANGS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A scene, and the picture of a plain render."""
    folder = tmp_path_factory.mktemp("scene")
    (folder / "scene.txt").write_text(SCENE)
    (folder / "more.txt").write_text(MORE)
    ran = run(folder, "render", *RENDER, "-o", "plain.exr")
    assert ran.returncode == 0, ran.stderr
    return folder


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def kill(process):
    with contextlib.suppress(OSError):
        process.kill()
    process.wait()
    process.stderr.close()


class Cluster:
    """A head and machines that join it, each a process."""

    def __init__(self, folder, workers=1, insecure=False, config="farm"):
        self.folder, self.insecure, self.config = folder, insecure, config
        self.port = free_port()
        self.address = f"{'tcp' if insecure else 'tls'}://127.0.0.1:{self.port}"
        self.head = self.start("head", "--host", "127.0.0.1", "--port", str(self.port))
        self.workers = [self.join(name=f"w{i}") for i in range(workers)]

    def start(self, command, *words, **environment):
        env = {**os.environ, "KAJO_FARM": str(self.folder / self.config), **environment}
        line = [sys.executable, "-m", "kajo.farm", command, *(["--insecure"] if self.insecure else []), *words]
        return subprocess.Popen(line, cwd=self.folder, env=env, stderr=subprocess.PIPE, text=True)

    def join(self, name, fault=None):
        environment = {}
        if fault is not None:
            program = self.folder / "faulty"
            source = Path(__file__).with_name("farm_worker.py")
            program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{source}" "$@"\n')
            program.chmod(0o755)
            environment = {"KAJO_PROGRAM": str(program), "REAL_PROGRAM": PROGRAM, "FAULT": fault}
        return self.start("join", self.address, "--threads", "1", "--name", name, **environment)

    def render(self, *words):
        return run(self.folder, "render", *RENDER, *UNITS, "-o", "out.exr", "--farm", self.address, *words)

    def begin(self, *words):
        """The same without waiting for it."""
        env = {**os.environ, "KAJO_FARM": str(self.folder / self.config), "KAJO_PYTHON": sys.executable}
        line = [PROGRAM, "render", *RENDER, *UNITS, "-o", "out.exr", "--farm", self.address, *words]
        return subprocess.Popen(line, cwd=self.folder, env=env, stderr=subprocess.PIPE, text=True)

    def lose(self, worker):
        self.workers.remove(worker)
        kill(worker)

    def close(self):
        for process in [*self.workers, self.head]:
            kill(process)


@contextlib.contextmanager
def cluster(*arguments, **options):
    made = Cluster(*arguments, **options)
    try:
        yield made
    finally:
        made.close()


@pytest.fixture(scope="module")
def certificates(folder):
    ran = run(folder, "farm", "init", str(folder / "farm"))
    assert ran.returncode == 0 and "kajo farm join tls://HEAD:8786" in ran.stdout, ran.stderr
    assert (folder / "farm" / "key.pem").stat().st_mode & 0o077 == 0
    assert not list((folder / "farm").glob("*ca*key*")), "the authority's key is forgotten"
    again = run(folder, "farm", "init", str(folder / "farm"))
    assert again.returncode == 2 and "already" in again.stderr
    return folder


def same(folder, name="out.exr"):
    equal = (folder / name).read_bytes() == (folder / "plain.exr").read_bytes()
    (folder / name).unlink()
    return equal


def children_of(process):
    told = Path(f"/proc/{process.pid}/task").glob("*/children")
    return [int(word) for path in told for word in path.read_text().split()]


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_any_number_of_workers_and_any_split_make_the_same_bytes(folder, workers, tmp_path):
    rng = random.Random(workers)
    with distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=False, dashboard_address=None, memory_limit=0
    ) as machines, distributed.Client(machines) as client:
        for _ in range(20 if DEEP else 3):
            tile, samples = rng.randrange(9, 70), rng.randrange(1, 17)
            words = [*RENDER, "-o", str(tmp_path / "out.exr"), "--quiet"]
            units = ["--unit-tile", str(tile), "--unit-samples", str(samples)]
            assert kajo.farm.coordinate(client, [*words, *units], folder=folder) == 0
            assert (tmp_path / "out.exr").read_bytes() == (folder / "plain.exr").read_bytes(), (tile, samples)


def test_a_cluster_with_certificates_renders_what_one_command_asks_for(certificates):
    with cluster(certificates, workers=2) as machines:
        ran = machines.render("--preview", "so_far.png", "--preview-every", "0.1")
        assert ran.returncode == 0, ran.stderr
        assert same(certificates) and not (certificates / "out.exr.job").exists()
        # Who brought what: a fast worker may have taken all of it.
        brought = re.findall(r"\b(w[01]-\d+): (\d+) units?\b", ran.stderr)
        assert brought and sum(int(units) for _, units in brought) == 12, ran.stderr
        for goal in [["--adaptive"], ["--noise", "0.3"], ["--integrator", "bidirectional"]]:
            plain = run(certificates, "render", *RENDER, *goal, "-o", "goal.exr")
            assert plain.returncode == 0, plain.stderr
            ran = machines.render(*goal, "-o", "shared.exr")
            assert ran.returncode == 0, ran.stderr
            assert (certificates / "shared.exr").read_bytes() == (certificates / "goal.exr").read_bytes(), goal


def test_scenes_of_python_are_rendered_by_a_client(folder, tmp_path):
    scene = kajo.loads(SCENE, files={"more.txt": MORE.encode()})
    settings = {"size": (30, 22), "samples": ("sobol", 8), "integrator": "path"}
    plain = scene.render(layers=["color", "depth"], **settings)
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None, memory_limit=0
    ) as machines, distributed.Client(machines) as client:
        picture = kajo.farm.render(scene, client=client, layers=["color", "depth"], **settings)
        assert picture.encode() == plain.encode("exr")
        shown = kajo.farm.render(scene, tmp_path / "a.png", client=client, shadows=True, **settings)
        assert shown._repr_png_() == scene.render(shadows=True, **settings).encode("png")
        with pytest.raises(kajo.farm.FarmError, match="integrator"):
            kajo.farm.render(scene, client=client, integrator="pth")
    with pytest.raises(kajo.farm.FarmError, match="client or the address"):
        kajo.farm.render(scene)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="it looks into /proc")
def test_whatever_is_killed_the_same_command_goes_on(certificates):
    """Workers, their children, the coordinator and the scheduler, at times that look random."""
    kills = 500 if DEEP else 8
    rng = random.Random(7)
    job = ["--job", "kept", "--unit-tile", "16", "--unit-samples", "2"]
    with cluster(certificates, workers=2) as machines:
        for i in range(kills):
            command = machines.begin(*job)
            time.sleep(1.5 + rng.uniform(0, 1.5))
            match i % 4:
                case 0:
                    machines.lose(machines.workers[0])
                    machines.workers.append(machines.join(name=f"new{i}"))
                case 1:
                    for child in children_of(machines.workers[0]):
                        with contextlib.suppress(OSError):
                            os.kill(child, signal.SIGKILL)
                case 2:
                    command.kill()
                case 3:
                    machines.head.kill()
                    machines.head.wait()
                    machines.head = machines.start("head", "--host", "127.0.0.1", "--port", str(machines.port))
            if i % 4 < 2:
                # It goes on by itself.
                assert command.wait(HANGS) == 0, command.stderr.read()
                assert same(certificates)
            else:
                code, said = command.wait(HANGS), command.stderr.read()
                # On a busy machine it may not have come to the scheduler before that was killed.
                too_early = i % 4 == 3 and code == 2 and "no scheduler answers" in said
                assert too_early or code in (0, 3, -9, 137), said
            command.stderr.close()
        ran = machines.render(*job)
        assert ran.returncode == 0 and same(certificates), ran.stderr


@pytest.mark.parametrize(
    "fault, code, words",
    [
        ("flip", 0, ["is rendered again"]),
        ("unit:3", 4, ["1 of the picture's units failed three times", "unit 3: ", "this unit cannot be rendered"]),
        ("crash:3", 4, ["unit 3: ", "ended with -6"]),
        ("version", 2, ["no machine of the cluster can render this", "epoch 0", "epoch 1", "take the same version"]),
    ],
)
def test_faults_of_workers_are_told_in_words(folder, fault, code, words, tmp_path):
    for name in ("scene.txt", "more.txt", "plain.exr"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    with cluster(tmp_path, workers=0, insecure=True) as machines:
        machines.workers = [machines.join(name=f"w{i}", fault=fault) for i in range(2)]
        ran = machines.render("--job", "kept")
        assert ran.returncode == code, ran.stderr
        assert all(word in ran.stderr for word in words), ran.stderr
        if code == 4:
            # All others are finished, each try has a log, and where the fault is gone the same command completes it.
            assert len(list((tmp_path / "kept" / "logs").iterdir())) == 3
            for worker in machines.workers:
                worker.kill()
            machines.workers.append(machines.join(name="sound"))
            ran = machines.render("--job", "kept")
            assert ran.returncode == 0 and "1 unit," in ran.stderr, ran.stderr
        if code in (0, 4):
            assert same(tmp_path)


def test_a_machine_with_another_version_is_left_out(folder, tmp_path):
    for name in ("scene.txt", "more.txt", "plain.exr"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    with cluster(tmp_path, workers=1, insecure=True) as machines:
        machines.workers.append(machines.join(name="old", fault="version"))
        time.sleep(3)
        ran = machines.render()
        assert ran.returncode == 0 and same(tmp_path), ran.stderr
        assert "old-" in ran.stderr and "is left out: the plan was made by" in ran.stderr, ran.stderr


def test_strangers_are_refused_before_any_work(certificates, tmp_path):
    _certificates.make(tmp_path / "other")
    with cluster(certificates, workers=1) as machines:
        for config, words in [("other", "refuses these certificates"), ("none", "no ca.pem")]:
            line = ["render", *RENDER, "-o", "no.exr", "--farm", machines.address]
            ran = run(certificates, *line, KAJO_FARM=str(tmp_path / config))
            assert ran.returncode == 2 and words in ran.stderr, ran.stderr
        plain = machines.address.replace("tls", "tcp")
        ran = run(certificates, "render", *RENDER, "-o", "no.exr", "--farm", plain)
        assert ran.returncode == 2 and "no scheduler answers" in ran.stderr, ran.stderr
        stranger = machines.start("join", machines.address, "--config", str(tmp_path / "other"))
        try:
            assert stranger.wait(HANGS) == 2 and "certificates" in stranger.stderr.read()
        finally:
            stranger.kill()
            stranger.stderr.close()
        assert not (certificates / "no.exr").exists()
        # And those who belong to it are served on.
        ran = machines.render()
        assert ran.returncode == 0 and same(certificates), ran.stderr


def test_without_certificates_nobody_from_outside_is_served(folder, tmp_path):
    empty = {"KAJO_FARM": str(tmp_path / "none")}
    ran = run(folder, "farm", "head", "--port", str(free_port()), **empty)
    assert ran.returncode == 2 and "kajo farm init" in ran.stderr, ran.stderr
    ran = run(folder, "farm", "join", "tcp://192.0.2.1:8786", **empty)
    assert ran.returncode == 2 and "--insecure" in ran.stderr, ran.stderr
    ran = run(folder, "farm", "join", "head:8786", **empty)
    assert ran.returncode == 2 and "tls://head:8786" in ran.stderr, ran.stderr
    (tmp_path / "bad").mkdir()
    for name in ("ca.pem", "cert.pem", "key.pem"):
        (tmp_path / "bad" / name).write_text("nothing")
    ran = run(folder, "farm", "head", "--config", str(tmp_path / "bad"))
    assert ran.returncode == 2 and "damaged" in ran.stderr, ran.stderr


def test_nobody_at_the_address_is_told(certificates):
    ran = run(certificates, "render", *RENDER, "-o", "no.exr", "--farm", f"tls://127.0.0.1:{free_port()}")
    assert ran.returncode == 2 and "no scheduler answers" in ran.stderr, ran.stderr


def test_without_dask_the_command_that_installs_it_is_told(folder, tmp_path):
    python = tmp_path / "python"
    python.write_text("#!/bin/sh\nexit 3\n")
    python.chmod(0o755)
    ran = run(folder, "render", *RENDER, "-o", "no.exr", "--farm", "tls://head:8786", KAJO_PYTHON=str(python))
    assert ran.returncode == 2 and 'pip install "kajo[dask]"' in ran.stderr, ran.stderr


def test_machines_join_by_ssh(certificates, tmp_path):
    """With a stand-in for ssh that runs its command here, in a home of its own."""
    ssh = tmp_path / "ssh"
    ssh.write_text(
        '#!/bin/bash\nwhile [[ $1 == -* ]]; do [[ $1 == -o ]] && shift; shift; done\n'
        f'export HOME="{tmp_path}/$1"; mkdir -p "$HOME"; cd "$HOME"; unset KAJO_FARM XDG_CONFIG_HOME; shift\n'
        'exec bash -c "$*"\n'
    )
    ssh.chmod(0o755)
    program = tmp_path / "kajo"
    program.write_text(f'#!/bin/sh\nshift\nexec "{sys.executable}" -m kajo.farm "$@"\n')
    program.chmod(0o755)
    (tmp_path / "hosts.txt").write_text("# two machines\nleft\nright # the other\n")
    with cluster(certificates, workers=0) as machines:
        options = ["--program", str(program), "--ssh", str(ssh)]
        joined = machines.start("ssh", str(tmp_path / "hosts.txt"), machines.address, *options)
        machines.workers.append(joined)
        ran = machines.render()
        assert ran.returncode == 0 and same(certificates), ran.stderr
        assert (tmp_path / "left" / ".config/kajo/farm/key.pem").stat().st_mode & 0o077 == 0
        joined.send_signal(signal.SIGTERM)
        assert joined.wait(HANGS) == 0
    (tmp_path / "hosts.txt").write_text("-oProxyCommand=x\n")
    ran = run(certificates, "farm", "ssh", str(tmp_path / "hosts.txt"), "tls://head:1")
    assert ran.returncode == 2 and "no name of a machine" in ran.stderr, ran.stderr


def test_ctrl_c_keeps_what_is_finished(certificates):
    with cluster(certificates, workers=1) as machines:
        job = ["--job", "stopped", "--unit-tile", "8", "--unit-samples", "4"]
        command = machines.begin(*job)
        parts = certificates / "stopped" / "parts"
        while command.poll() is None and not (parts.is_dir() and any(parts.iterdir())):
            time.sleep(0.05)
        # As a terminal does: to all of them.
        for pid in [command.pid, *children_of(command)]:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGINT)
        told = command.communicate(timeout=HANGS)[1]
        assert command.returncode in (0, 130), told
        assert command.returncode == 0 or "the same command goes on with it" in told, told
        ran = machines.render(*job)
        assert ran.returncode == 0 and same(certificates), ran.stderr


class _Future:
    """A finished Dask future; without a result, one whose worker has died: it ends when it is cancelled."""

    status = "finished"

    def __init__(self, result=None):
        self._result, self._cancelled = result, threading.Event()

    def add_done_callback(self, act):
        act(self)

    def result(self):
        if self._result is None:
            self._cancelled.wait()
            raise CancelledError
        return self._result

    def cancel(self):
        self._cancelled.set()

    def release(self):
        pass


class _Client:
    """A cluster whose worker `a` dies when it has rendered, before anybody has its result; then `b` joins."""

    status = "running"
    worker = "a"

    def scheduler_info(self, n_workers):
        return {"workers": {f"tcp://{self.worker}:1": {"name": self.worker, "nthreads": 1}}}

    def submit(self, function, *arguments, workers, **options):
        if function is _worker.take:
            return _Future(-1)
        if workers == ["tcp://a:1"]:
            self.worker = "b"
            return _Future()
        return _Future(({"ok": True}, b"part"))

    def run(self, *arguments, **options):
        pass


def test_a_result_that_died_with_its_worker_is_rendered_again(tmp_path):
    (tmp_path / "bundle").write_bytes(b"bundle")
    (orders, give), (take, news) = os.pipe(), os.pipe()
    # What is read is not buffered: `select` would not see what a buffer holds.
    with contextlib.ExitStack() as files:
        orders, take = (files.enter_context(open(end, "rb", buffering=0)) for end in (orders, take))
        give, news = (files.enter_context(open(end, "wb")) for end in (give, news))
        engine = threading.Thread(target=_engine.Engine(_Client(), orders, news).run, daemon=True)
        engine.start()

        def until(kind):
            message, data = {"is": ""}, b""
            while message["is"] != kind:
                assert message["is"] in ("", "room", "note"), message
                assert select.select([take], [], [], HANGS)[0], f"nothing is told of a {kind}"
                message, data = _protocol.receive(take)
            return message, data

        _protocol.send(give, {"do": "plan", "plan": "{}", "bundle": str(tmp_path / "bundle")})
        _protocol.send(give, {"do": "stage", "stage": 0})
        _protocol.send(give, {"do": "unit", "stage": 0, "unit": 3, "avoid": []})
        lost, _ = until("lost")
        assert (lost["unit"], lost["kind"]) == (3, "worker") and "a: its worker is gone" in lost["message"]
        _protocol.send(give, {"do": "unit", "stage": 0, "unit": 3, "avoid": ["a"]})
        part, data = until("part")
        assert (part["unit"], part["host"], data) == (3, "b", b"part")
        _protocol.send(give, {"do": "end"})
        engine.join(HANGS)
        assert not engine.is_alive()


def test_bundles_arrive_in_pieces():
    plan, bundle = "{}", os.urandom(1000)
    digest = _worker.digest_of(plan, bundle)
    offset, steps = 0, 0
    while offset >= 0:
        offset = _worker.take(digest, plan, bundle[offset : offset + 300], offset)
        steps += 1
    assert steps == 4 and _worker.take(digest, plan, b"", 0) == -1
    # What came twice, or too early, does no harm.
    other = _worker.digest_of(plan, bundle + b"x")
    assert _worker.take(other, plan, bundle, 0) == 1000 and _worker.take(other, plan, bundle, 0) == 1000
    assert _worker.take(other, plan, b"x", 1000) == -1
    answer, part = _worker.render(digest, 0, 0, b"", 1)
    assert answer["unknown"] and not part


def test_messages_come_back_and_others_are_refused():
    import io

    pipe = io.BytesIO()
    _protocol.send(pipe, {"do": "unit", "unit": 7}, b"abc")
    whole = pipe.getvalue()
    assert _protocol.receive(io.BytesIO(whole)) == ({"do": "unit", "unit": 7}, b"abc")
    assert _protocol.receive(io.BytesIO(b"")) is None
    for cut in range(1, len(whole)):
        with pytest.raises(EOFError):
            _protocol.receive(io.BytesIO(whole[:cut]))
    with pytest.raises(ValueError):
        _protocol.receive(io.BytesIO(b"\xff" * 40))
