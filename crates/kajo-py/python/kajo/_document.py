"""Scene files that are edited: every byte stays that nobody meant to change, comments and blanks among them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from typing import Any

from . import _native
from ._items import Function, Item, Raw
from ._scene import Scene


def edit(
    path: str | os.PathLike[str],
    *,
    assets: Iterable[str | os.PathLike[str]] = (),
    allow_outside: bool = False,
    dialect: str | None = None,
) -> Document:
    """Opens a scene file to be changed and saved. Mistakes in it are told by `Document.scene`.

    Args:
        path: the file; of a model, the scene that shows it, which has no file yet.
        assets: folders besides the scene's own whose files it may name.
        allow_outside: let it name files anywhere.
        dialect: the lineage of the format, where it is not to be the scene's own choice.

    Raises:
        OSError: when the file cannot be read, or is no text.
    """
    folders = [os.fspath(folder) for folder in assets]
    return Document(_native.Document(os.fspath(path), None, folders, allow_outside, dialect))


class Document:
    """A scene file that is edited.

    >>> document = kajo.edit("scene.txt")
    >>> document.find("Sphere", "ball")["radius"] = 2.5
    >>> document.save()
    """

    def __init__(self, native: _native.Document) -> None:
        self._native = native

    @property
    def text(self) -> str:
        """The scene's text as it is now. Setting it is an edit as well."""
        return self._native.text

    @text.setter
    def text(self, text: str) -> None:
        self._native.rewrite(text)

    @property
    def path(self) -> str | None:
        """The scene's file; None until it is saved for the first time."""
        path = self._native.path
        return None if path is None else os.fspath(path)

    @property
    def is_changed(self) -> bool:
        """Whether any text differs from its file."""
        return self._native.is_dirty

    def __iter__(self) -> Iterator[Node]:
        """The blocks in the order of the text, each before what it holds."""
        return (Node(self, *node) for node in self._native.nodes())

    def find(self, keyword: str, name: str | None = None) -> Node:
        """The first block with this keyword, and with this name unless that is None.

        Raises:
            KeyError: when there is none.
        """
        found = next(iter(self.find_all(keyword, name)), None)
        if found is None:
            wanted = keyword if name is None else f"{keyword} {name}"
            raise KeyError(f"there is no {wanted}")
        return found

    def find_all(self, keyword: str, name: str | None = None) -> list[Node]:
        """All blocks with this keyword, and with this name unless that is None."""
        return [node for node in self if node.keyword == keyword and name in (None, node.name)]

    def add(self, block: Item | str, into: Node | None = None) -> Node:
        """Adds a block, as an object or as its text, where such blocks stand, or to the end of a group."""
        created = self._native.add(None if into is None else into._id, str(block))
        found = next((node for node in self if node._id == created), None)
        if found is None:
            raise _native.EditError("nothing was added")
        return found

    def undo(self) -> bool:
        """Takes the last edit back; whether there was any."""
        return self._native.undo()

    def redo(self) -> bool:
        """Does what was taken back once more; whether there was anything."""
        return self._native.redo()

    def save(self, path: str | os.PathLike[str] | None = None) -> None:
        """Writes every text that has changed, each whole or not at all; to another file where one is given."""
        self._native.save(None if path is None else os.fspath(path))

    def scene(self) -> Scene:
        """The scene that the texts make as they are now.

        Raises:
            SceneError: with every mistake, its place and a caret.
        """
        return Scene._of(self._native.scene(), (None, None, None), None)

    def __repr__(self) -> str:
        return f"<kajo.Document {self.path or 'without a file'}{', changed' if self.is_changed else ''}>"


class Node:
    """A block of a document. Its values are read and set by their keys in the scene language.

    `node["radius"]` is what holds, be it written or the default: a number, a word, or a list of both; None where no
    value says what holds. `del node["radius"]` takes the value out.
    """

    def __init__(
        self,
        document: Document,
        id: _native.NodeId,
        keyword: str,
        name: str | None,
        parent: _native.NodeId | None,
    ) -> None:
        self._document = document
        self._id = id
        self._parent = parent
        self.keyword = keyword
        self.name = name

    @property
    def text(self) -> str | None:
        """Its piece of the text; None of one that is gone."""
        return self._document._native.text_of(self._id)

    @property
    def parent(self) -> Node | None:
        """The block that it stands in."""
        return next((node for node in self._document if node._id == self._parent), None)

    def keys(self) -> list[str]:
        """The keys that it may have."""
        return list(dict.fromkeys(key for key, *_ in self._document._native.fields(self._id)))

    def __contains__(self, key: str) -> bool:
        """Whether a value is written."""
        return any(name == key and written for name, _, _, written, _ in self._document._native.fields(self._id))

    def __getitem__(self, key: str) -> Any:
        values = [value for name, _, value, _, _ in self._document._native.fields(self._id) if name == key]
        if not values:
            raise KeyError(key)
        if values[-1] is None:
            return None
        word, numbers = values[-1]
        parts: list[Any] = [*([] if word is None else [word]), *numbers]
        if parts in (["on"], ["off"]):
            return parts == ["on"]
        return parts[0] if len(parts) == 1 else parts

    def __setitem__(self, key: str, value: Any) -> None:
        self._document._native.set(self._id, key, _word_and_numbers(value), None)

    def __delitem__(self, key: str) -> None:
        self._document._native.unset(self._id, key, None)

    def rename(self, name: str | None) -> None:
        """Gives it another name, or none. References to it follow."""
        self._document._native.rename(self._id, name)
        self.name = name

    def duplicate(self) -> Node:
        """Puts a copy after it."""
        created = self._document._native.duplicate(self._id)
        found = next((node for node in self._document if node._id == created), None)
        if found is None:
            raise _native.EditError("nothing was duplicated")
        return found

    def delete(self) -> None:
        """Takes it out."""
        self._document._native.delete(self._id)

    def paint(self, material: Node) -> None:
        """Gives an object or a group another material."""
        self._document._native.paint(self._id, material._id)

    def move_into(self, group: Node) -> None:
        """Moves an object to the end of a group, a definition or a transform. It keeps its material."""
        self._document._native.move_into(self._id, group._id)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Node) and other._document is self._document and other._id == self._id

    def __hash__(self) -> int:
        return hash(self._id)

    def __repr__(self) -> str:
        return f"<kajo.Node {self.keyword}{'' if self.name is None else ' ' + self.name}>"


def _word_and_numbers(value: Any) -> tuple[str | None, list[float]]:
    if isinstance(value, bool):
        return ("on" if value else "off"), []
    if isinstance(value, Function):
        return f"= {value.text}", []
    if isinstance(value, Raw):
        raise TypeError("set the text of the document to write an expression")
    if isinstance(value, str):
        return value, []
    parts = list(value) if hasattr(value, "__iter__") else [value]
    word = parts.pop(0) if parts and isinstance(parts[0], str) else None
    return word, [float(part) for part in parts]
