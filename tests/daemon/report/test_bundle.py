"""The zip for a report of a mistake: what is in it, and what is not."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from daemon.errors import DiskTrouble
from daemon.report.bundle import folder_files, tail, without_secrets, write_bundle


@pytest.mark.parametrize(
    ("line", "hidden"),
    [
        ('password = "hunter2"', "hunter2"),
        ('api_token="abc"', "abc"),
        ('#wifi-passphrase = "abc"', "abc"),
        ('"secret": "abc",', "abc"),
        ('url = "tcp://me:hunter2@plotter:23"', "hunter2"),
    ],
)
def test_secrets_are_left_out(line: str, hidden: str) -> None:
    said = without_secrets(f'a = 1\n{line}\nurl = "tcp://plotter:23"\n')
    assert hidden not in said
    assert said.startswith("a = 1\n")
    assert said.endswith('url = "tcp://plotter:23"\n')


def test_the_end_of_a_log_begins_with_a_whole_line(tmp_path: Path) -> None:
    (tmp_path / "log").write_text("one\ntwo\nthree\n")
    assert tail(tmp_path / "log", most_mb=8e-6) == b"three\n"
    assert tail(tmp_path / "log") == b"one\ntwo\nthree\n"
    assert tail(tmp_path / "nothing") == b""


def test_links_lead_to_nothing_in_the_bundle(tmp_path: Path) -> None:
    (tmp_path / "job.log").write_text("x")
    (tmp_path / "shadow").symlink_to("/etc/passwd")
    assert list(folder_files(tmp_path, below="7-x")) == ["7-x/job.log"]


def test_a_bundle_says_what_is_in_it_and_is_its_owners_alone(tmp_path: Path) -> None:
    (tmp_path / "job.log").write_text("drawn\n")
    bundle = tmp_path / "b.zip"
    told = write_bundle(bundle, {"a.txt": "one", "b.bin": b"12345", "job.log": tmp_path / "job.log"})
    assert told == [("a.txt", 3), ("b.bin", 5), ("job.log", 6)]
    with zipfile.ZipFile(bundle) as read:
        assert {name: read.read(name) for name in read.namelist()} == {
            "a.txt": b"one", "b.bin": b"12345", "job.log": b"drawn\n",
        }  # fmt: skip
    assert bundle.stat().st_mode & 0o777 == 0o600


def test_nothing_is_overwritten_and_nothing_half_written_left(tmp_path: Path) -> None:
    (tmp_path / "b.zip").write_text("mine")
    with pytest.raises(DiskTrouble, match="another name"):
        write_bundle(tmp_path / "b.zip", {})
    assert (tmp_path / "b.zip").read_text() == "mine"
    with pytest.raises(DiskTrouble, match="another place"):
        write_bundle(tmp_path / "c.zip", {"a": tmp_path / "gone"})
    assert not (tmp_path / "c.zip").exists()
