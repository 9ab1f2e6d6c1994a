"""A worker process with a fault, for tests: `kajo worker --stdio`, and between it and whoever asks it this program.

FAULT says which: `unit:N` fails unit N every time, `crash:N` ends the process instead, `flip` changes a byte of the
first part that any worker brings, `version` makes the plan one of another program, `slow` waits before each unit.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

from kajo.farm import _protocol

fault, _, number = os.environ["FAULT"].partition(":")
child = subprocess.Popen([os.environ["REAL_PROGRAM"], *sys.argv[1:]], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
source, out = sys.stdin.buffer, sys.stdout.buffer
while (message := _protocol.receive(source)) is not None:
    request, data = message
    if fault == "version" and request["do"] == "open":
        request["plan"] = request["plan"].replace("determinism epoch 1", "determinism epoch 0")
    if request["do"] == "unit" and str(request["unit"]) == number:
        if fault == "crash":
            os.abort()
        if fault == "unit":
            _protocol.send(out, {"ok": False, "kind": "unit", "message": "this unit cannot be rendered"})
            continue
    if fault == "slow" and request["do"] == "unit":
        time.sleep(0.3)
    _protocol.send(child.stdin, request, data)
    answer, part = _protocol.receive(child.stdout)
    if fault == "flip" and part and not Path("flipped").exists():
        Path("flipped").touch()
        part = part[:-70] + bytes([part[-70] ^ 1]) + part[-69:]
    _protocol.send(out, answer, part)
child.kill()
