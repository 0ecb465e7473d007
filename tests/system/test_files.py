import os
import stat
import sys
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from garmentimage.errors import OutputError
from garmentimage.system.files import (
    FILE_NAME_BYTES,
    RESERVED_NAMES,
    check_output,
    safe_name,
    write_atomically,
    write_together,
)

any_text = st.text(st.characters(), max_size=300)


def test_text_and_bytes_are_written_as_they_are(tmp_path):
    write_atomically(tmp_path / "a", "naïve ✂")
    write_atomically(tmp_path / "b", b"\x00\xff")
    assert (tmp_path / "a").read_bytes() == "naïve ✂".encode()
    assert (tmp_path / "b").read_bytes() == b"\x00\xff"


@pytest.mark.skipif(sys.platform == "win32", reason="links of Unix")
def test_links_that_go_in_circles_are_refused(tmp_path):
    (tmp_path / "a").symlink_to("a")
    with pytest.raises(OutputError, match="choose another place"):
        write_atomically(tmp_path / "a", "x")


def test_a_file_is_replaced_whole_and_keeps_its_permissions(tmp_path):
    path = tmp_path / "a"
    path.write_text("old and long")
    path.chmod(0o640)
    write_atomically(path, "new")
    assert path.read_text() == "new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [p.name for p in tmp_path.iterdir()] == ["a"]


def test_a_new_file_has_the_permissions_that_the_user_wants(tmp_path):
    (tmp_path / "plain").touch()
    write_atomically(tmp_path / "a", "x")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.skipif(sys.platform == "win32", reason="links and devices of Unix")
def test_links_are_followed_and_devices_stay_devices(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "file")
    write_atomically(tmp_path / "link", "x")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text() == "x"
    write_atomically(os.devnull, "x")
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


def test_what_cannot_be_written_is_named_and_leaves_nothing(tmp_path):
    for path, message in (
        (tmp_path / "none" / "a", "there is no folder .*make it first"),
        (tmp_path, "is a folder"),
        ("a\0b", "cannot be written"),
        (tmp_path / ("x" * 5000), "cannot be written"),
    ):
        with pytest.raises(OutputError, match=message):
            write_atomically(path, "x")
    assert list(tmp_path.iterdir()) == []


@given(any_text, st.lists(any_text, max_size=4))
def test_safe_names_are_portable_and_distinct(name, others):
    taken = []
    for other in [*others, name, name.swapcase(), name]:
        taken.append(safe_name(other, taken))
    assert len({t.casefold() for t in taken}) == len(taken)
    for text in taken:
        assert all(c.isalnum() or c in "-_" for c in text)
        assert 0 < len(text.encode("utf-8")) <= FILE_NAME_BYTES
        assert text.casefold() not in RESERVED_NAMES


@pytest.mark.parametrize(
    "name", ["../../etc/passwd", "CON", "", " ", "a\0b", "<script>", "a/b\\c:d", "..", "\ud800"]
)
def test_a_name_that_is_a_path_stays_in_its_folder(name, tmp_path):
    path = tmp_path / safe_name(name)
    assert path.parent == tmp_path
    path.touch()
    assert [p for p in tmp_path.iterdir()] == [path]


def test_files_written_together_are_all_written_or_none(tmp_path):
    (tmp_path / "old.txt").write_text("old")
    results = {tmp_path / "old.txt": "new", tmp_path / "nowhere" / "b.txt": "b"}
    with pytest.raises(OutputError, match=r"b\.txt: there is no folder"):
        write_together(results)
    assert (tmp_path / "old.txt").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["old.txt"]
    write_together({tmp_path / "old.txt": "new", tmp_path / "b.txt": b"b"})
    assert (tmp_path / "old.txt").read_text() == "new"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["b.txt", "old.txt"]


def test_an_output_that_is_another_by_a_longer_way_is_refused(tmp_path):
    (tmp_path / "sub").mkdir()
    with pytest.raises(OutputError, match="another output"):
        check_output(tmp_path / "sub" / ".." / "a.png", (".png",), [tmp_path / "a.png"])
