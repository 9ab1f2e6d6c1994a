from collections.abc import Callable

__version__: str
LAYERS: list[str]

class KajoError(Exception): ...
class SceneError(KajoError):
    lines: list[str]
class RenderError(KajoError): ...

class Scene:
    @property
    def warnings(self) -> list[str]: ...
    @property
    def objects(self) -> int: ...
    def render(
        self,
        settings: str,
        layers: list[str],
        threads: int,
        noise: float | None,
        time: float | None,
        adaptive: bool,
        crop: tuple[int, int, int, int] | None,
        progress: Callable[[float], object] | None,
    ) -> Image: ...

class Image:
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def layers(self) -> list[str]: ...
    @property
    def samples(self) -> float: ...
    @property
    def noise(self) -> float | None: ...
    @property
    def rays(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    def layer(self, name: str) -> tuple[int, int, int, bytes]: ...
    def encode(self, layers: list[str], format: str, bits: int) -> bytes: ...
    def write(self, path: str, data: bytes) -> None: ...

def build_identity() -> str: ...
def load(
    path: str,
    folders: list[str],
    allow_outside: bool,
    camera: str | None,
    dialect: str | None,
    aspect: float | None,
) -> Scene: ...
def loads(
    text: str,
    name: str,
    files: dict[str, bytes],
    camera: str | None,
    dialect: str | None,
    aspect: float | None,
) -> Scene: ...
