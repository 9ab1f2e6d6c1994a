"""kajo, a ray tracer: scenes, renders and layers as numpy arrays.

>>> import kajo
>>> scene = kajo.load("scene.txt")
>>> image = scene.render(size=(320, 240), samples=("sobol", 16), layers=["color", "depth"])
>>> image["color"].shape
(240, 320, 3)
>>> image.save("out.exr")
"""

from __future__ import annotations

from . import blocks as _blocks
from ._arrays import ArrayFile, mesh_file, picture_file
from ._document import Document, Node, edit
from ._image import Image
from ._items import Blackbody, Block, Function, Item, LightSource, Raw, Spectrum
from ._measures import Comparison, TestRow, compare, selftest
from ._native import (
    LAYERS,
    EditError,
    KajoError,
    RenderError,
    SceneError,
    __version__,
    build_identity,
)
from ._scene import Scene, Value, load, loads
from .blocks import *  # noqa: F403

__all__ = [
    "LAYERS",
    "ArrayFile",
    "Blackbody",
    "Block",
    "Comparison",
    "Document",
    "EditError",
    "Function",
    "Image",
    "Item",
    "KajoError",
    "LightSource",
    "Node",
    "Raw",
    "RenderError",
    "Scene",
    "SceneError",
    "Spectrum",
    "TestRow",
    "Value",
    "__version__",
    "build_identity",
    "compare",
    "edit",
    "load",
    "loads",
    "mesh_file",
    "picture_file",
    "selftest",
    *_blocks.__all__,
]
