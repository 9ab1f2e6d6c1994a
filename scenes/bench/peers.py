"""What the scripts that render one scene by kajo and by other programs have in common."""

import pathlib
import resource
import subprocess

import numpy as np

HEADER = "| program | squared error | of 99 % | seconds | error x s | of 99 % x s | mean as it came |\n|---|---|---|---|---|---|---|"


def numbers(values):
    return " ".join(f"{v:g}" for v in values)


def row(name, errors, seconds, mean):
    """A row below `HEADER`: squared errors of all values, and of all but the largest one in a hundred."""
    errors = np.sort(errors, axis=None)
    error, most = errors.mean(), errors[: -errors.size // 100].mean()
    return f"| {name} | {error:.3e} | {most:.3e} | {seconds:.2f} | {error * seconds:.3e} | {most * seconds:.3e} | {mean:.5f} |"


class Kajo:
    """A scene of kajo's language, rendered on one thread into a square."""

    def __init__(self, program, folder, name, size, text, arguments):
        self.program, self.name, self.size, self.arguments = program, pathlib.Path(program).name, size, list(map(str, arguments))
        self.file, self.out = folder / f"{name}.txt", folder / f"{name}.pfm"
        self.file.write_text(text)

    def render(self, samples, seed):
        """The picture, from its top row down, and the processor time of the whole program."""
        command = [self.program, "render", str(self.file), "-o", str(self.out), "--size", f"{self.size}x{self.size}", "--samples", "sobol", str(samples)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([*command, "--seed", str(seed), "--threads", "1", "--quiet", *self.arguments], check=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        content = self.out.read_bytes().split(b"\n", 3)[3]
        return np.frombuffer(content, "<f4").reshape(self.size, self.size, 3)[::-1].astype(float), seconds

    def run(self, samples, seed):
        """The same with the time that samples take alone."""
        _, start = self.render(1, seed)
        picture, seconds = self.render(samples, seed)
        return picture, (seconds - start) * samples / (samples - 1)
