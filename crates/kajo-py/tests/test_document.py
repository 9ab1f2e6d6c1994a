"""Scene files that are edited."""

import kajo
import pytest

TEXT = """# the scene
PerspectiveCamera { center 0 1 9  direction 0 -0.1 -1  up 0 1 0  angle 30 }
Materials { Matte gold { color 1 1 0 }  Metal copper { metal copper } }
Group {
  MaterialIndex gold
  Sphere ball { center 0 0 0 /* the middle */  radius 1 }  // one
}
"""


@pytest.fixture
def document(tmp_path):
    (tmp_path / "s.txt").write_text(TEXT)
    return kajo.edit(tmp_path / "s.txt")


def test_only_what_was_meant_changes(document, tmp_path):
    ball = document.find("Sphere", "ball")
    assert ball["radius"] == 1 and ball["center"] == [0, 0, 0]
    assert "radius" in ball and ball.keys() == ["center", "radius"]
    ball["radius"] = 2.5
    document.find("Matte")["color"] = (0, 1, 0)
    expected = TEXT.replace("radius 1 ", "radius 2.5 ").replace("1 1 0 }  Metal", "0 1 0 }  Metal")
    assert document.text == expected and document.is_changed
    document.save()
    assert (tmp_path / "s.txt").read_text() == expected and not document.is_changed
    assert document.undo() and document.undo() and not document.undo()
    assert document.text == TEXT and document.redo()


def test_blocks_are_added_painted_moved_and_taken_out(document):
    ball = document.find("Sphere", "ball")
    added = document.add(kajo.Sphere(center=(1, 2, 3), radius=0.5))
    assert added.keyword == "Sphere" and added.parent.keyword == "Group" and document.scene().objects == 2
    added.paint(document.find("Metal"))
    copy = ball.duplicate()
    copy.rename("second")
    assert document.find("Sphere", "second") == copy and len(document.find_all("Sphere")) == 3
    group = document.add("Group { }")
    copy.move_into(group)
    assert document.find("Sphere", "second").parent.keyword == "Group"
    ball.delete()
    assert document.scene().objects == 2
    with pytest.raises(KeyError):
        document.find("Sphere", "ball")
    assert ball.text is None and document.text.startswith("# the scene\n")


def test_the_text_can_be_set_and_mistakes_are_told(document):
    document.text = document.text.replace("radius 1", "radius 1 spikes 3")
    with pytest.raises(kajo.SceneError) as caught:
        document.scene()
    assert "spikes" in str(caught.value) and "s.txt:6:57: error" in caught.value.lines[0]
    document.undo()
    image = document.scene().render(size=(8, 8))
    assert image.size == (8, 8)


def test_what_cannot_be_done_is_refused(document, tmp_path):
    camera = document.find("PerspectiveCamera")
    with pytest.raises(kajo.EditError):
        camera.paint(document.find("Matte"))
    with pytest.raises(kajo.EditError):
        document.add("no block at all")
    with pytest.raises(KeyError):
        camera["radius"]
    with pytest.raises(TypeError):
        camera["angle"] = kajo.Raw("2 * 15")
    with pytest.raises(OSError):
        kajo.edit(tmp_path / "nowhere.txt")
    with pytest.raises(OSError):
        document.save(tmp_path / "no" / "folder.txt")
    assert document.text == TEXT


def test_a_document_is_saved_elsewhere(document, tmp_path):
    document.find("Sphere")["radius"] = 3
    document.save(tmp_path / "t.txt")
    assert (tmp_path / "s.txt").read_text() == TEXT and "radius 3" in (tmp_path / "t.txt").read_text()
    assert document.path == str(tmp_path / "t.txt") and "changed" not in repr(document)
