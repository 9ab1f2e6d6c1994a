"""How far pictures are apart, and whether the program renders what formulas say."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _native
from ._image import Image, _empty

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


@dataclass(frozen=True)
class Comparison:
    """How far two pictures are apart, number by number and for the eye.

    Attributes:
        mse: mean squared error.
        rmse: its root, in the units of the pictures.
        psnr: peak signal to noise ratio in decibels, for values in [0, 1]; infinite for equal pictures.
        rel_mse: mean squared error relative to the reference.
        max_abs: largest absolute difference of any value.
        flip: mean of the FLIP error over all pixels, 0 to 1.
        map: FLIP error of each pixel, height x width, 0 to 1.
    """

    mse: float
    rmse: float
    psnr: float
    rel_mse: float
    max_abs: float
    flip: float
    map: npt.NDArray[np.float32]

    def __repr__(self) -> str:
        return f"<kajo.Comparison rmse {self.rmse:.4g}, psnr {self.psnr:.4g} dB, flip {self.flip:.4g}>"


def compare(
    reference: Image | npt.NDArray[Any], test: Image | npt.NDArray[Any], *, display: bool = False
) -> Comparison:
    """Compares a picture with a reference, as `kajo diff` does.

    Args:
        reference, test: pictures, or arrays of height x width x 3 or 1.
        display: whether the values are those of a screen, from 0 to 1, and not light.

    Raises:
        ValueError: when their sizes differ.
    """
    import numpy as np

    def pixels(picture: Image | npt.NDArray[Any]) -> npt.NDArray[np.float32]:
        array = np.asarray(picture["color"] if isinstance(picture, Image) else picture)
        if array.ndim == 2:
            array = array[:, :, np.newaxis]
        if array.ndim != 3 or array.dtype.kind not in "fiu":
            raise ValueError(
                f"an array of height x width x channels is wanted, and this one is of shape {array.shape}"
                f" and type {array.dtype}"
            )
        return np.ascontiguousarray(array, dtype=np.float32)

    a, b = pixels(reference), pixels(test)
    figures, flip = _native.compare((a, b), (a.shape, b.shape), display, _empty)
    return Comparison(**dict(figures), map=flip)


@dataclass(frozen=True)
class TestRow:
    """One scene whose light is known by a formula.

    Attributes:
        name: what was shown.
        method: the integrator and how it was set.
        expected: the value of the formula.
        measured: what the program says.
        sigma: standard error of that; 0 where nothing is random.
        samples: camera rays it took.
        verdict: "pass", "wrong", "noisy", or why there is no picture.
    """

    __test__ = False

    name: str
    method: str
    expected: float
    measured: float
    sigma: float
    samples: int
    verdict: str


def selftest(
    only: str = "",
    *,
    seed: int | None = None,
    full: bool = False,
    threads: int = 0,
    progress: Callable[[TestRow], object] | None = None,
) -> list[TestRow]:
    """Renders scenes whose light is known by a formula, and compares, as `kajo selftest` does.

    Args:
        only: rows whose name or method holds this text.
        seed: of the random numbers; another one every time by default.
        full: with the accuracy of `kajo selftest`, in place of that of `--quick`.
        threads: 0 for one on each core.
        progress: called with each row as it is done.
    """
    rows: list[TestRow] = []

    def tell(*row: Any) -> None:
        rows.append(TestRow(*row))
        if progress is not None:
            progress(rows[-1])

    _native.selftest(only, int(time.time()) if seed is None else seed, not full, threads, tell)
    return rows
