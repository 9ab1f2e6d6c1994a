"""`python -m kajo.farm`: what `kajo farm` and `kajo render --farm tls://HOST:PORT` hand over to Python."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from . import connect, coordinate
from ._certificates import FarmError, default_folder

PORT = 8786


def main(words: Sequence[str] | None = None) -> int:
    """Runs a command. Returns its exit code."""
    words = list(sys.argv[1:] if words is None else words)
    try:
        if words[:1] == ["render"]:
            return _render(words[1:])
        arguments = _parser().parse_args(words)
        if arguments.command == "init":
            return _init(arguments.folder or default_folder())
        from . import _cluster

        config = arguments.config or default_folder()
        if arguments.command == "head":
            return _cluster.head(config, arguments.host, arguments.port, arguments.insecure)
        if arguments.command == "join":
            return _cluster.join(config, arguments.address, arguments.threads, arguments.name, arguments.insecure)
        return _cluster.ssh(config, arguments.hosts, arguments.address, arguments.program, arguments.ssh)
    except FarmError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except ImportError as error:
        if (error.name or "").split(".")[0] not in ("distributed", "dask"):
            raise
        print('error: Dask is not installed: pip install "kajo[dask]"', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="kajo farm", description="Renders on a cluster of Dask.")
    commands = parser.add_subparsers(dest="command", required=True)
    init = commands.add_parser("init", help="make the certificates of a cluster")
    init.add_argument("folder", nargs="?", type=Path, metavar="DIR", help="where they go")
    head = commands.add_parser("head", help="run the scheduler of a cluster")
    head.add_argument("--host", default="", help="the address it listens at; by default all of this machine")
    head.add_argument("--port", type=int, default=PORT)
    join = commands.add_parser("join", help="render for a cluster, until it is ended")
    join.add_argument("address", help="of its scheduler: tls://HEAD:8786")
    join.add_argument("--threads", type=int, default=0, help="0 for one on each core")
    join.add_argument("--name", help="what this machine is called; by default its host name")
    ssh = commands.add_parser("ssh", help="let other machines join by ssh, and copy the certificates there")
    ssh.add_argument("hosts", type=Path, metavar="HOSTS.txt", help="a file with the name of a machine on each line")
    ssh.add_argument("address", help="of the scheduler, as those machines see it: tls://HEAD:8786")
    ssh.add_argument("--program", default="kajo", help="the program on those machines")
    ssh.add_argument("--ssh", default="ssh", help="the program ssh, with options")
    for command in (head, join, ssh):
        command.add_argument("--config", type=Path, metavar="DIR", help="the folder of the certificates")
    for command in (head, join):
        command.add_argument(
            "--insecure", action="store_true", help="without certificates: whoever reaches the port runs code here"
        )
    return parser


def _init(folder: Path) -> int:
    from ._certificates import make

    make(folder)
    where = "" if folder == default_folder() else f" --config {folder}"
    print(f"The certificates of the farm are in {folder}. Every machine of it needs a copy of that folder.\n")
    print(f"on one machine:    kajo farm head{where}")
    print(f"on each machine:   kajo farm join{where} tls://HEAD:{PORT}")
    option = "" if not where else f" --farm-config {folder}"
    print(f"a render:          kajo render scene.txt -o out.exr --farm tls://HEAD:{PORT}{option}")
    return 0


def _render(words: Sequence[str]) -> int:
    """`kajo render ... --farm ADDRESS`"""
    address, config, rest = "", None, []
    waiting = iter(words)
    for word in waiting:
        option, equals, value = word.partition("=")
        if option in ("--farm", "--farm-config"):
            value = value if equals else next(waiting, "")
            address, config = (value, config) if option == "--farm" else (address, value)
        else:
            rest.append(word)
    client = connect(address, config=config)
    try:
        return coordinate(client, rest)
    finally:
        # A scheduler that is gone says no good-bye.
        client.close(timeout=2)


if __name__ == "__main__":
    sys.exit(main())
