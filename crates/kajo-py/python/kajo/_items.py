"""What scenes are built of in Python: items, blocks and values, and the text of the scene language that they are."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, SupportsFloat, TypeAlias, TypeVar

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._arrays import ArrayFile

    Array = npt.NDArray[np.floating[Any]] | npt.NDArray[np.integer[Any]]

    Number = float | np.floating[Any] | np.integer[Any]
    """A number: finite."""

    Vector = Sequence[Number] | Array
    """Some numbers: of a place or a direction three, of a colour linear red, green and blue."""

    Texture: TypeAlias = "str | os.PathLike[str] | PictureValue | Function | TextureBlock | Raw"
    """What differs from place to place: a picture or a function of the place."""

    File = str | os.PathLike[str] | ArrayFile
    """The name of a file, or arrays in place of one."""

    PictureFile: TypeAlias = "str | os.PathLike[str] | ArrayFile | npt.NDArray[Any]"
    """The name of the file of a picture, or an array in place of one."""

    Reflectance: TypeAlias = "Vector | str | Spectrum | Raw"
    """The colour of a surface: linear RGB, a spectrum, or the name of a file that holds one."""

    Emission: TypeAlias = "Number | Vector | str | Spectrum | Blackbody | LightSource | Raw"
    """Light: linear RGB, a number for white of that luminance, a spectrum, a black body, or a light by its name."""

    MaterialName: TypeAlias = "MaterialBlock | str | int"
    """A material: its block, or its name or number."""

    MediumName: TypeAlias = "MediumBlock | str"
    """A medium: its block, or its name."""

_BlockType = TypeVar("_BlockType", bound="Block")
_INDENT = "  "


class Raw:
    """A piece of scene text that is taken as it is: an expression, or whatever has no class."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __repr__(self) -> str:
        return f"Raw({self.text!r})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and vars(other) == vars(self)

    __hash__ = None  # type: ignore[assignment]


class Function(Raw):
    """A function of the place: Function("0.5 + 0.5 * sin(12 * x)"), with x, y and z."""

    def __repr__(self) -> str:
        return f"Function({self.text!r})"


class _Value:
    """Something with a text of its own behind a key."""

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and _equal(vars(self), vars(other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        shown = ", ".join(f"{key}={value!r}" for key, value in vars(self).items() if value is not None)
        return f"{type(self).__name__}({shown})"

    def _text(self, writer: Writer) -> str:
        raise NotImplementedError


class Spectrum(_Value):
    """A spectrum by its values at some wavelengths, joined by lines.

    Args:
        wavelengths: nanometres, growing.
        values: as many: radiances, or reflectances from 0 to 1.
    """

    def __init__(self, wavelengths: Vector, values: Vector) -> None:
        self.wavelengths = [_finite(number) for number in wavelengths]
        self.values = [_finite(number) for number in values]
        if len(self.wavelengths) != len(self.values) or not self.values:
            raise ValueError(
                f"a spectrum has one value for each wavelength, at least one: {len(self.wavelengths)} wavelengths "
                f"and {len(self.values)} values"
            )
        if any(b <= a for a, b in itertools.pairwise(self.wavelengths)):
            raise ValueError("the wavelengths of a spectrum grow")

    def _text(self, writer: Writer) -> str:
        pairs = zip(self.wavelengths, self.values, strict=True)
        return "spectrum " + "  ".join(f"{number_text(nm)} {number_text(value)}" for nm, value in pairs)


class Blackbody(_Value):
    """The light of a black body.

    Args:
        kelvin: its temperature, from 300 to 1,000,000.
        luminance: how bright it is.
    """

    def __init__(self, kelvin: Number, luminance: Number = 1.0) -> None:
        self.kelvin = kelvin
        self.luminance = luminance

    def _text(self, writer: Writer) -> str:
        return f"blackbody {number_text(self.kelvin)} {number_text(self.luminance)}"


class LightSource(_Value):
    """The light of a source by its name, such as "D65" or "F11", or of a measured spectrum by its file's.

    Args:
        name: of the source or the file.
        factor: its luminance, or what the values of the file are multiplied by.
    """

    def __init__(self, name: str, factor: Number = 1.0) -> None:
        self.name = name
        self.factor = factor

    def _text(self, writer: Writer) -> str:
        return f"{quoted(self.name)} {number_text(self.factor)}"


class PictureValue(_Value):
    """The name of a picture, and what is said behind it; its keys are those of `Picture`."""

    keys: ClassVar[dict[str, str]] = {}

    def __init__(self, source: PictureFile, factor: Number | None) -> None:
        self.source: File
        if isinstance(source, (str, os.PathLike)) or hasattr(source, "_parts"):
            self.source = source  # type: ignore[assignment]
        else:
            from ._arrays import picture_file

            self.source = picture_file(source)
        self.factor = factor

    def _text(self, writer: Writer) -> str:
        words = [writer.file(self.source)]
        if self.factor is not None:
            words.append(number_text(self.factor))
        said = {key: getattr(self, name) for name, key in self.keys.items()}
        items = [f"{key} {writer.value(value)}" for key, value in said.items() if value is not None]
        if items:
            words.append("{ " + "  ".join(items) + " }")
        return " ".join(words)


class Item:
    """Any item of the scene language: a keyword, at most one word, numbers, and perhaps a block.

    >>> print(Item("outline", children=[Item("line", 0, 0, 2, 0, 2, 1)]))
    outline {
      line 0 0 2 0 2 1
    }

    Args:
        keyword: the word it begins with.
        values: what stands behind it.
        children: what stands in its block; None where it has none.
    """

    keyword: str

    def __init__(self, keyword: str, *values: Any, children: Sequence[Item] | None = None) -> None:
        if quoted(keyword) != keyword:
            raise ValueError(f"{keyword!r} is no keyword")
        self.keyword = keyword
        self.arguments = values
        self.children: list[Item] | None = None if children is None else list(children)

    def __str__(self) -> str:
        """The text of the scene language that it is."""
        writer = Writer()
        writer.item(self)
        return "\n".join(writer.lines)

    def __repr__(self) -> str:
        shown = [repr(self.keyword), *map(repr, self.arguments)]
        if self.children is not None:
            shown.append(f"children={self.children!r}")
        return f"Item({', '.join(shown)})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and _equal(vars(self), vars(other))

    __hash__ = None  # type: ignore[assignment]

    def _write(self, writer: Writer) -> None:
        head = " ".join([self.keyword, *(writer.value(value) for value in self.arguments)])
        writer.block(head, self.children)


class Operation(Item):
    """An operation of a `Transform`, an `Instance` or a `Key`; they act in reverse order, the last one first."""

    keyword = ""

    def __init__(self, *values: Number) -> None:
        self.arguments = tuple(_finite(value) for value in values)
        self.children = None

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.arguments))})"


class Block(Item):
    """A block of the scene language, with an attribute for each of its fields."""

    keyword = ""
    several: ClassVar[tuple[str, ...]] = ()
    functions: ClassVar[tuple[str, ...]] = ()
    spelled: ClassVar[dict[str, str]] = {}

    name: str | None
    children: list[Item]

    def __init__(self, *children: Item, name: str | None = None) -> None:
        for child in children:
            if not isinstance(child, Item):
                raise TypeError(
                    f"{type(self).__name__} holds blocks and items, not {child!r}; its fields are given by their names"
                )
        self.children = list(children)
        self.name = name

    def replace(self: _BlockType, **changes: Any) -> _BlockType:
        """A copy with other values of some fields."""
        copy = object.__new__(type(self))
        vars(copy).update(vars(self))
        copy.children = list(self.children)
        for key, value in changes.items():
            if key not in vars(self):
                raise TypeError(f"{type(self).__name__} has no field {key!r}")
            setattr(copy, key, value)
        return copy

    @classmethod
    def fields(cls) -> list[str]:
        """Names of the fields that such a block may have."""
        taken = ("children", "parts", "name", "material", "return")
        return [name for name in cls.__init__.__annotations__ if name not in taken]

    def values_of_fields(self) -> Iterator[tuple[str, Any]]:
        """The fields that are set, by their names."""
        for field in self.fields():
            value = getattr(self, field)
            if value is not None:
                yield field, value

    def __repr__(self) -> str:
        shown = [repr(child) for child in self.children]
        shown += [f"name={self.name!r}"] if self.name is not None else []
        shown += [f"{key}={value!r}" for key, value in self.values_of_fields()]
        return f"{type(self).__name__}({', '.join(shown)})"

    def __setattr__(self, key: str, value: Any) -> None:
        fields = self.fields()
        if key not in fields and key not in ("name", "children", "material"):
            close = [field for field in fields if field[:3] == key[:3]] or fields
            hint = f"; it has {', '.join(close)}" if fields else ""
            raise AttributeError(f"{type(self).__name__} has no field {key!r}{hint}")
        object.__setattr__(self, key, value)

    def _head(self, writer: Writer) -> str:
        name = writer.name_of(self)
        return self.keyword if name is None else f"{self.keyword} {quoted(name)}"

    def _write(self, writer: Writer) -> None:
        items = [writer.field(self, field, value) for field, value in self.values_of_fields()]
        writer.block(self._head(writer), self.children, [line for lines in items for line in lines])


class CameraBlock(Block):
    """From where the picture is taken."""


class LightBlock(Block):
    """A light."""


class MediumBlock(Block):
    """What bodies and the air may be filled with."""


class MaterialBlock(Block):
    """How a surface looks."""


class TextureBlock(Block):
    """A texture that may have a name: a pattern, or what is made of others."""


class PartBlock(Block):
    """A block within another one.

    Args:
        parts: the items in it, and numbers that stand behind its keyword, such as the time of a `Key`.
    """

    def __init__(self, *parts: Item | Number, name: str | None = None) -> None:
        super().__init__(*(part for part in parts if isinstance(part, Item)), name=name)
        numbers = [part for part in parts if not isinstance(part, Item)]
        object.__setattr__(self, "_numbers", [_finite(number) for number in numbers])

    def _head(self, writer: Writer) -> str:
        numbers: list[float] = vars(self)["_numbers"]
        return " ".join([super()._head(writer), *map(number_text, numbers)])


class ObjectBlock(Block):
    """An object, or several together.

    Args:
        material: its material. Without one it has that of the object before it, as in a scene's text.
    """

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None
    ) -> None:
        super().__init__(*children, name=name)
        self.material = material

    def __repr__(self) -> str:
        shown = super().__repr__()
        if self.material is None:
            return shown
        name = self.material if isinstance(self.material, (str, int)) else self.material.name
        return f"{shown[:-1]}{'' if shown.endswith('()') else ', '}material={name!r})"

    def _write(self, writer: Writer) -> None:
        if self.material is not None:
            writer.lines.append(f"{writer.indent}MaterialIndex {writer.value(self.material)}")
        super()._write(writer)


class Writer:
    """Writes items, and remembers the blocks and the files that these refer to."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.indent = ""
        self.files: dict[str, ArrayFile] = {}
        self.referred: list[Block] = []
        self._names: dict[int, str] = {}
        self._taken: set[str] = set()

    def take(self, name: str) -> None:
        """Keeps blocks without a name from being called so."""
        self._taken.add(name)

    def item(self, item: Item) -> None:
        """Writes an item."""
        item._write(self)

    def block(self, head: str, children: Sequence[Item] | None, items: Sequence[str] = ()) -> None:
        """Writes a block with some lines and items in it; no block for no children at all."""
        if children is None:
            self.lines.append(self.indent + head)
            return
        if not children and sum(map(len, items)) < 70:
            inside = "  ".join(items)
            self.lines.append(f"{self.indent}{head} {{ {inside} }}" if inside else f"{self.indent}{head} {{ }}")
            return
        self.lines.append(f"{self.indent}{head} {{")
        outer, self.indent = self.indent, self.indent + _INDENT
        self.lines.extend(self.indent + line for line in items)
        for child in children:
            self.item(child)
        self.indent = outer
        self.lines.append(f"{self.indent}}}")

    def field(self, block: Block, field: str, value: Any) -> list[str]:
        """The lines of a field."""
        first, *rest = field.rstrip("_").split("_")
        key = block.spelled.get(field) or first + "".join(word.capitalize() for word in rest)
        try:
            if field in block.several:
                return [f"{key} {self.value(each)}" for each in value]
            if field in block.functions and isinstance(value, str):
                value = Function(value)
            return [f"{key} {self.value(value)}"]
        except (TypeError, ValueError) as error:
            raise type(error)(f"{type(block).__name__}.{field}: {error}") from None

    def value(self, value: Any) -> str:
        """What stands behind a key."""
        if isinstance(value, bool):
            return "on" if value else "off"
        if isinstance(value, (int, float)):
            return number_text(value)
        if isinstance(value, str):
            return quoted(value)
        if isinstance(value, Function):
            return f"= {value.text}"
        if isinstance(value, Raw):
            return value.text
        if isinstance(value, _Value):
            return value._text(self)
        if isinstance(value, Block):
            return self.reference(value)
        if isinstance(value, os.PathLike) or hasattr(value, "_parts"):
            return self.file(value)
        if type(value).__module__ == "numpy":
            return self.value(value.tolist())
        if isinstance(value, Sequence):
            return " ".join(self.value(part) for part in value)
        if isinstance(value, SupportsFloat):
            return number_text(value)
        raise TypeError(f"{value!r} has no text in a scene")

    def file(self, file: File) -> str:
        """The name of a file; of arrays, one that they are given."""
        if isinstance(file, (str, os.PathLike)):
            return quoted(os.fspath(file))
        for name, known in self.files.items():
            if known is file:
                return quoted(name)
        name = f"array{len(self.files)}.{file.ending}"
        self.files[name] = file
        return quoted(name)

    def reference(self, block: Block) -> str:
        """The name of a block that stands elsewhere."""
        if not isinstance(block, (MaterialBlock, MediumBlock, TextureBlock)) and block.name is None:
            raise TypeError(f"a {type(block).__name__} without a name cannot be referred to")
        if not any(block is known for known in self.referred):
            self.referred.append(block)
        if block.name is not None:
            return quoted(block.name)
        if id(block) not in self._names:
            number = 1
            while f"{block.keyword.lower()}{number}" in self._taken:
                number += 1
            self._names[id(block)] = f"{block.keyword.lower()}{number}"
            self._taken.add(self._names[id(block)])
        return quoted(self._names[id(block)])

    def name_of(self, block: Block) -> str | None:
        """The name of a block, be it one that it was given here."""
        return block.name if block.name is not None else self._names.get(id(block))


def _finite(number: Any) -> float:
    if isinstance(number, bool) or not isinstance(number, SupportsFloat):
        raise TypeError(f"{number!r} is no number")
    value = number if isinstance(number, int) else float(number)
    if not math.isfinite(value):
        raise ValueError(f"{value!r}: a scene has finite numbers only")
    return value


def number_text(number: SupportsFloat) -> str:
    """The shortest text that reads back as the same number."""
    return repr(_finite(number))


def quoted(word: str) -> str:
    """A word as scenes have it: in quotes where it needs them."""
    if any(ord(c) < 32 for c in word):
        raise ValueError(f"{word!r} holds a control character")
    plain = word.isascii() and word.replace("_", "a").isalnum() and word[0].isalpha()
    if plain and word not in ("include", "let", "repeat"):
        return word
    escaped = word.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _equal(a: Any, b: Any) -> bool:
    """Whether two values are equal, arrays among them or not."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_equal(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(_equal, a, b))
    equal = a == b
    return bool(equal.all()) if hasattr(equal, "all") else bool(equal)
