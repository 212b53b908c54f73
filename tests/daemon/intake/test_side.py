"""A side file is checked like the settings: each mistake is named with its place and its cure."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from daemon.errors import SettingsError
from daemon.intake.side import LIMIT_BYTES, Wishes, parse, read_bytes, side_name


def test_what_a_side_file_may_say() -> None:
    said = b"size_mm = 80\ncopies = 3\nmachine = 'left'\n[pen]\ndown_mm = -0.2\n"
    wishes = parse(said, "house.toml")
    assert wishes == Wishes(size_mm=80.0, copies=3, machine="left", pen={"down_mm": -0.2})
    assert wishes.box_mm == (80.0, 80.0)
    assert parse(b"size_mm = [80, 60]", "house.toml").box_mm == (80.0, 60.0)
    assert parse(b"", "house.toml").box_mm is None


@pytest.mark.parametrize(
    ("said", "sentence"),
    [
        (b"size_mn = 80", "house.toml: size_mn is unknown: did you mean size_mm?"),
        (b"zzz = 1", "house.toml: zzz is unknown: known are size_mm, copies, machine, approve, pen"),
        (b"size_mm = -1", "house.toml: size_mm: Input should be a length above 0, or two such as [80, 60]"),
        (b"size_mm = [80]", "house.toml: size_mm: Input should be a length above 0, or two such as [80, 60]"),
        (b"size_mm = nan", "house.toml: size_mm: Input should be a length above 0, or two such as [80, 60]"),
        (b"copies = 0", "house.toml: copies: Input should be greater than or equal to 1"),
        (b"copies = 'many'", "house.toml: copies: Input should be a valid integer"),
        (b"pen = 'red'", "house.toml: pen: Input should be a valid dictionary"),
        (b"copies = ", "house.toml is not TOML"),
        (b"\xff\xfe", "house.toml is not TOML"),
        (b"a = " + b"[" * 5000, "house.toml is not TOML"),
        (b"copies = " + b"9" * 5000, "house.toml is not TOML"),
        (b"copies = 0\nsize_mn = 1", "house.toml: copies: "),
    ],
)
def test_what_is_wrong_is_said_with_its_cure(said: bytes, sentence: str) -> None:
    with pytest.raises(SettingsError) as caught:
        parse(said, "house.toml")
    assert sentence in str(caught.value)


def test_every_mistake_is_named_at_once() -> None:
    with pytest.raises(SettingsError, match=r"copies.*; house\.toml: size_mn"):
        parse(b"size_mn = 1\ncopies = 0", "house.toml")


@pytest.mark.parametrize(
    ("picture", "side"), [("a.png", "a.toml"), ("a.tar.gz", "a.tar.toml"), ("noext", "noext.toml")]
)
def test_it_is_called_like_its_picture(picture: str, side: str) -> None:
    assert side_name(picture) == side


def test_one_that_is_too_large_or_a_link_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"#" * (LIMIT_BYTES + 1))
    with pytest.raises(SettingsError, match="a few lines of TOML"):
        read_bytes(path)
    os.symlink(path, tmp_path / "b.toml")
    with pytest.raises(OSError, match="symbolic links"):
        read_bytes(tmp_path / "b.toml")
