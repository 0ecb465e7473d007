"""The command line: what it writes, what it says, and how it ends."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from garmentimage import __version__, load_image, load_pattern
from garmentimage.cli.app import main
from garmentimage.cli.terminal import Exit
from garmentimage.errors import PatternError
from garmentimage.examples import example_path
from garmentimage.metrics import summary_table
from garmentimage.metrics.roundtrip import TIME_LIMIT_S
from garmentimage.pattern.files.spec import read_pattern
from tests.corpus import unpacked

DRESS = str(example_path("dress"))


@pytest.fixture
def bad(tmp_path):
    """A pattern whose stitch 0 names no panel."""
    data = json.loads(example_path("dress").read_text())
    data["pattern"]["stitches"][0][0]["panel"] = "nowhere"
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(data))
    return path


@pytest.fixture
def image(tmp_path):
    path = tmp_path / "dress.npz"
    assert main(["encode", DRESS, "-o", str(path)]) == 0
    return path


def run(*arguments, capsys):
    capsys.readouterr()
    code = main([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return code, out, err


def assert_one_sentence(err, *words):
    assert err.count("\n") == 1
    assert "Traceback" not in err
    for word in words:
        assert str(word) in err


def test_version(capsys):
    assert run("--version", capsys=capsys) == (0, f"garmentimage {__version__}\n", "")


def test_the_module_is_the_command():
    command = [sys.executable, "-m", "garmentimage", "--version"]
    assert __version__ in subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_check_tells_what_files_hold(image, capsys):
    code, out, err = run("check", DRESS, image, capsys=capsys)
    assert (code, err) == (0, "")
    first, second = out.splitlines()
    assert first.startswith(f"{DRESS}: ok, panels 6")
    assert second.startswith(f"{image}: ok, grid 16")


def test_check_goes_on_after_a_bad_file(bad, capsys):
    code, out, err = run("check", bad, DRESS, capsys=capsys)
    assert code == 2
    assert out.startswith(DRESS)
    assert_one_sentence(err, bad, "stitch 0", "nowhere")


def test_check_as_json(bad, capsys):
    code, out, _ = run("check", "--json", bad, DRESS, capsys=capsys)
    first, second = json.loads(out)["files"]
    assert code == 2
    assert (first["ok"], first["error"]) == (False, "StitchError")
    assert (second["ok"], second["panels"], second["warnings"]) == (True, 6, [])


def test_remarks_about_a_file_go_to_stderr(tmp_path, capsys):
    data = json.loads(example_path("dress").read_text())
    data["pattern"]["stitches"] = []
    path = tmp_path / "loose.json"
    path.write_text(json.dumps(data))
    code, out, err = run("check", path, capsys=capsys)
    assert code == 0
    assert "ok" in out
    assert err
    assert all(line.startswith(f"warning: {path}") for line in err.splitlines())


def test_encode_then_decode_gives_the_panels_back(image, tmp_path, capsys):
    again = tmp_path / "again.json"
    code, out, err = run("decode", image, "-o", again, capsys=capsys)
    assert (code, err) == (0, "")
    assert str(again) in out
    names = {p.name for p in load_pattern(DRESS).panels}
    assert {p.name for p in load_pattern(again).panels} == names


def test_the_authors_npy_is_written_and_decoded(image, tmp_path, capsys):
    theirs, again = tmp_path / "dress.npy", tmp_path / "again.json"
    assert run("encode", DRESS, "-o", theirs, capsys=capsys)[0] == 0
    assert load_image(theirs).inside.sum() == load_image(image).inside.sum()
    assert run("decode", theirs, "-o", again, capsys=capsys)[0] == 0
    assert len(load_pattern(again).panels) == len(load_pattern(DRESS).panels)


def test_repairs_are_told(image, tmp_path, capsys):
    """A sewn grid edge whose other layer is bare is what a network gets wrong."""
    channels = load_image(image).to_channels()
    sewn = channels[17 + 3] > 0.5
    assert sewn.any()
    channels[17 + 2][sewn], channels[17 + 3][sewn] = 1, 0
    np.save(tmp_path / "wrong.npy", channels)
    out = tmp_path / "again.json"
    code, text, err = run("decode", tmp_path / "wrong.npy", "-o", out, "--json", capsys=capsys)
    facts = json.loads(text)
    assert code == 0
    assert facts["panels"] == 6
    assert all(count > 0 for count in facts["repaired"].values())
    assert_one_sentence(err, "repaired", "wrong.npy", *facts["repaired"])
    code, text, err = run("decode", image, "-o", out, "--json", capsys=capsys)
    assert (json.loads(text)["repaired"], err) == ({}, "")


def test_results_as_json(tmp_path, capsys):
    out = tmp_path / "dress.npz"
    code, text, _ = run("encode", DRESS, "-o", out, "--grid", 32, "--json", capsys=capsys)
    facts = json.loads(text)
    assert code == 0
    assert (facts["out"], facts["grid"], facts["layers"]) == (str(out), 32, 2)


def test_files_taken_for_patterns_are_told_what_they_are(image, tmp_path, capsys):
    channels, picture = tmp_path / "a.npy", tmp_path / "a.png"
    assert run("encode", DRESS, "-o", channels, capsys=capsys)[0] == 0
    assert run("show", image, "-o", picture, capsys=capsys)[0] == 0
    for path, word in ((image, "decode"), (channels, "decode")):
        code, _, err = run("encode", path, "-o", tmp_path / "b.npz", capsys=capsys)
        assert code == 2
        assert_one_sentence(err, path, "image", word)
    code, _, err = run("check", picture, capsys=capsys)
    assert code == 2
    assert_one_sentence(err, picture, "picture")
    code, _, err = run("decode", DRESS, "-o", tmp_path / "b.json", capsys=capsys)
    assert code == 2
    assert_one_sentence(err, DRESS, "encode")


@pytest.mark.parametrize("command", ["encode", "show"])
def test_bad_input_leaves_no_output(command, bad, tmp_path, capsys):
    out = tmp_path / ("out.npz" if command == "encode" else "out.png")
    code, text, err = run(command, bad, "-o", out, capsys=capsys)
    assert (code, text) == (2, "")
    assert_one_sentence(err, bad, "stitch 0")
    assert not out.exists()


def test_errors_as_json(bad, tmp_path, capsys):
    code, text, _ = run("encode", bad, "-o", tmp_path / "a.npz", "--json", capsys=capsys)
    assert code == 2
    assert json.loads(text)["error"] == "StitchError"


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["encode", DRESS, "-o", "{}/a.txt"], ".npz"),
        (["encode", DRESS, "-o", "{}/no/a.npz"], "folder {}/no;"),
        (
            ["encode", DRESS, "-o", "{}/a.npz", "--gird", "16"],
            "did you mean --grid; see garmentimage encode --help",
        ),
        (["encode", DRESS, DRESS, "-o", "{}/a.npz"], "one argument too many"),
        (["encode", "{}/none.json", "-o", "{}/a.npz"], "none.json"),
        (["encode", DRESS], "--out is missing"),
        (["encode", DRESS, "-o", "{}/a.npz", "--grid", "17"], "17"),
        (["encode", DRESS, "-o", "{}/a.npz", "--grid", "many"], "many"),
        (["decode", DRESS, "-o", "{}/a.json"], "dress.json"),
        (["decode", "{}/a.npy", "-o", "{}/a.npy"], ".json"),
        (["show", DRESS, "-o", "{}/a.gif"], ".png"),
        (["show", DRESS, DRESS, "--round-trip", "-o", "{}/a.png"], "--round-trip"),
        (["roundtrip", "{}"], "no .json"),
        (["roundtrip", "{}/none"], "none"),
        (["roundtrip", DRESS, "--report", "{}/no/a.json"], "folder"),
        (["encode", DRESS, "-o", "{}/" + "x" * 300 + ".npz"], "xxx.npz"),
        (["roundtrip", "{}/" + "x" * 300], "xxx"),
        (["roundtrip", DRESS, "--workers", "-1"], "-1"),
        (["sew", DRESS], "sew"),
        ([], "COMMAND"),
    ],
)
def test_a_call_that_will_not_do_gets_one_sentence(arguments, word, tmp_path, capsys):
    *arguments, word = (a.replace("{}", str(tmp_path)) for a in [*arguments, word])
    code, out, err = run(*arguments, capsys=capsys)
    assert (code, out) == (2, "")
    assert_one_sentence(err, word)
    assert list(tmp_path.iterdir()) == []


def test_an_input_is_never_overwritten(tmp_path, capsys):
    path = tmp_path / "a.json"
    path.write_bytes(example_path("dress").read_bytes())
    code, _, err = run("decode", path, "-o", path, capsys=capsys)
    assert code == 2
    assert_one_sentence(err, "input")
    assert path.read_bytes() == example_path("dress").read_bytes()


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_show_draws_files_beside_each_other(ending, image, tmp_path, capsys):
    out = tmp_path / f"picture.{ending}"
    assert run("show", DRESS, image, "-o", out, capsys=capsys)[0] == 0
    assert out.stat().st_size > 10_000


def test_show_draws_the_way_there_and_back(tmp_path, capsys):
    out = tmp_path / "picture.svg"
    assert run("show", "--round-trip", DRESS, "-o", out, capsys=capsys)[0] == 0
    assert out.stat().st_size > 10_000


def test_roundtrip_of_a_folder(tmp_path, capsys):
    (tmp_path / "dresses").mkdir()
    (tmp_path / "dresses" / "a.json").write_bytes(example_path("dress").read_bytes())
    (tmp_path / "dresses" / "dresses_manifest.json").write_text("[]")
    (tmp_path / "dresses" / "properties.json").write_text('{"size": 1}')
    report = tmp_path / "report.json"
    code, out, err = run(
        "roundtrip", tmp_path / "dresses", "--report", report, "--workers", 0, capsys=capsys
    )
    assert code == 0
    assert "dresses" in out
    assert_one_sentence(err, tmp_path / "dresses", "2 files hold no pattern, skipped")
    data = json.loads(report.read_text())
    assert [f["file"] for f in data["files"]] == ["dresses/a.json"]
    assert data["grid"] == 16


def test_a_file_named_by_itself_is_never_skipped(tmp_path, capsys):
    path = tmp_path / "properties.json"
    path.write_text('{"size": 1}')
    code, _, err = run("roundtrip", path, "--workers", 0, capsys=capsys)
    assert code == 1
    assert_one_sentence(err, "properties.json", "pattern")


def test_roundtrip_ends_with_1_where_a_pattern_does_not_come_back(bad, capsys):
    code, out, err = run("roundtrip", bad, DRESS, "--workers", 0, "--json", capsys=capsys)
    assert code == 1
    assert [f["with_marks"]["success"] for f in json.loads(out)["files"]] == [False, True]
    assert "bad.json" in err


def test_a_bug_of_ours_asks_for_a_report(monkeypatch, capsys):
    def broken(path):
        raise KeyError("inner")

    monkeypatch.setattr("garmentimage.pattern.files.read_pattern", broken)
    monkeypatch.delenv("GARMENTIMAGE_DEBUG", raising=False)
    code, out, err = run("check", DRESS, capsys=capsys)
    assert (code, out) == (3, "")
    assert_one_sentence(err, "report", "KeyError")
    monkeypatch.setenv("GARMENTIMAGE_DEBUG", "1")
    with pytest.raises(KeyError):
        main(["check", DRESS])


def test_ctrl_c_ends_with_130(monkeypatch, capsys):
    def interrupted(path):
        raise KeyboardInterrupt

    monkeypatch.setattr("garmentimage.pattern.files.read_pattern", interrupted)
    code, _, err = run("check", DRESS, capsys=capsys)
    assert code == 130
    assert_one_sentence(err, "stopped")


def test_names_that_the_terminal_cannot_show_are_escaped(tmp_path):
    data = json.loads(example_path("dress").read_text())
    data["pattern"]["stitches"][0][0]["panel"] = "kein \N{GRINNING FACE}\n\ud800"
    path = tmp_path / "schön.json"
    path.write_text(json.dumps(data))
    done = subprocess.run(
        [sys.executable, "-X", "utf8=0", "-m", "garmentimage", "check", str(path)],
        capture_output=True,
        env={**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": "ascii"},
    )
    assert done.returncode == 2
    assert_one_sentence(done.stderr.decode("ascii"), "stitch 0")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="process groups of Unix")
@pytest.mark.parametrize("wait_s", [0.3, 1, 2, 3])
def test_ctrl_c_ends_a_run_in_processes_without_a_traceback(wait_s, tmp_path):
    """A terminal sends Ctrl-C to the workers, too, whatever they are at: starting, say."""
    for k in range(200):
        (tmp_path / f"{k}.json").write_bytes(example_path("dress").read_bytes())
    arguments = ["roundtrip", str(tmp_path), "--workers", "2"]
    # Where tests run in the background, as shells start it, Ctrl-C is ignored from the start.
    code = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from garmentimage.cli.app import main; print('here', flush=True); "
        f"sys.exit(main({arguments!r}))"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout.readline() == "here\n"
    time.sleep(wait_s)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (Exit.INTERRUPTED, "")
    assert_one_sentence(err, "stopped")


def test_the_help_of_roundtrip_explains_every_column_of_its_table(capsys):
    code, out, _ = run("roundtrip", "--help", capsys=capsys)
    head = summary_table([])
    assert code == 0
    for column in (
        "kind",
        "success",
        "no marks",
        "wraps",
        "IoU",
        "gap cm",
        "seams",
        "ms",
        "errors",
    ):
        assert column in head
        assert f"\n  {column}  " in out
    assert "Lost" in out
    assert f"{TIME_LIMIT_S:g} s" in out


@pytest.mark.corpus
def test_nasty_files_end_with_one_sentence_or_as_patterns(tmp_path, capsys):
    folder = unpacked("nasty/nasty_patterns.tar.xz", tmp_path)
    files = sorted(folder.rglob("*.json"))
    assert len(files) > 70
    for path in files:
        try:
            read_pattern(path)
            expected = 0
        except PatternError:
            expected = 2
        out = tmp_path / "out.svg"
        code, _, err = run("check", path, capsys=capsys)
        assert code == expected, path.name
        assert "Traceback" not in err
        if expected == 2:
            assert_one_sentence(err, path.name)
            code, _, err = run("show", path, "-o", out, capsys=capsys)
            assert code == 2
            assert_one_sentence(err, path.name)
            assert not out.exists()
