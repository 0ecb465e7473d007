import os
import sys

import pytest

from garmentimage.errors import DrapeError, EncodeError
from garmentimage.system.read import errors_about, read_limited


def refusal(path, **options) -> str:
    with pytest.raises(DrapeError) as caught:
        read_limited(path, 10, DrapeError, kind="GLB file", too_large="make it smaller", **options)
    return str(caught.value)


def test_files_up_to_the_limit_are_read(tmp_path):
    (tmp_path / "a").write_bytes(b"x" * 10)
    read = read_limited(tmp_path / "a", 10, DrapeError, kind="GLB file", too_large="")
    assert read == b"x" * 10


def test_what_cannot_be_read_is_refused_with_a_remedy(tmp_path):
    (tmp_path / "large").write_bytes(b"x" * 11)
    assert refusal(tmp_path / "large").endswith("; make it smaller")
    assert refusal(tmp_path / "none") == "there is no such file; check its name"
    assert refusal(tmp_path) == "is a folder; name a GLB file in it"
    assert "cannot be read" in refusal(tmp_path / ("x" * 5000))
    assert "cannot be read" in refusal("bad\0name")


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of Unix")
def test_a_pipe_is_not_waited_for_where_only_ordinary_files_will_do(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert "not an ordinary file" in refusal(tmp_path / "pipe", must_be_ordinary=True)


def test_errors_name_the_path_once_and_keep_what_they_hold():
    with pytest.raises(EncodeError) as caught, errors_about("a.json"), errors_about("a.json"):
        raise EncodeError("does not fit", grid=32, remedy="either")
    assert str(caught.value) == "a.json: does not fit"
    assert caught.value.grid == 32 and caught.value.remedy == "either"


def test_other_errors_pass_unchanged():
    with pytest.raises(KeyError, match="'x'"), errors_about("a.json"):
        raise KeyError("x")
