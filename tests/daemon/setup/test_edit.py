"""A settings file is changed where it must be, and nowhere else."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from daemon.errors import SettingsError
from daemon.setup.edit import lines_of, put_back, replace_file, with_keys, without_keys

PAGE = Path(__file__).parents[3] / "systemd" / "linedrawd.toml"
MINE = """# my plotter

[machines.left]   # on the left
device = "grbl"
#scale_x = 1.0
url = "auto"  # found

[machines.left.pen]
up_mm = 4

[sheet]
box_mm = [60, 60]
"""


def test_a_key_is_set_where_it_stands() -> None:
    assert with_keys(MINE, {"machines.left": {"url": "sim://grbl"}}) == MINE.replace(
        'url = "auto"  # found', 'url = "sim://grbl"'
    )


def test_a_key_behind_a_comment_sign_comes_forward() -> None:
    changed = with_keys(MINE, {"machines.left": {"scale_x": 1.01}})
    assert changed == MINE.replace("#scale_x = 1.0", "scale_x = 1.01")


def test_a_new_key_stands_behind_the_last_of_its_section() -> None:
    changed = with_keys(MINE, {"machines.left": {"backlash_mm": [0.1, 0.0]}})
    assert changed == MINE.replace('"auto"  # found\n', '"auto"  # found\nbacklash_mm = [0.1, 0.0]\n')


def test_a_new_section_stands_at_the_end() -> None:
    assert with_keys(MINE, {"keep": {"jobs_days": 3}}) == MINE + "\n[keep]\njobs_days = 3\n"
    assert with_keys("", {"keep": {"jobs_days": 3}}) == "[keep]\njobs_days = 3\n"


def test_the_page_of_all_settings_takes_every_change_and_keeps_its_words() -> None:
    text = PAGE.read_text(encoding="utf-8")
    values = {
        "machines.plotter": {"url": "usb://1-1", "scale_x": 1.01, "home": "start"},
        "machines.plotter.pen": {"kind": "servo", "up_s": 200.0},
        "sheet": {"box_mm": [180.0, 260.0]},
    }
    changed = with_keys(text, values)
    read = tomllib.loads(changed)
    assert read["machines"]["plotter"]["scale_x"] == 1.01
    assert read["machines"]["plotter"]["pen"] == {"kind": "servo", "up_s": 200.0}
    assert read["sheet"]["box_mm"] == [180.0, 260.0]
    gone, come = set(text.splitlines()) - set(changed.splitlines()), set(changed.splitlines()) - set(text.splitlines())
    assert all(line.startswith("#") and "=" in line for line in gone)
    assert len(come) == 6


@pytest.mark.parametrize(
    "text",
    ['machines.left.url = "auto"\n', '[machines]\nleft = {url = "auto"}\n', "[machines.left]\nreach_mm = [\n1,\n2]\n"],
)
def test_a_file_written_in_another_way_is_left_to_its_owner(text: str) -> None:
    with pytest.raises(SettingsError, match=r"write into them\n\[machines.left\]\nreach_mm"):
        with_keys(text, {"machines.left": {"reach_mm": [1, 2]}})


def test_what_belonged_to_another_kind_is_put_behind_a_comment_sign() -> None:
    changed = without_keys(MINE, "machines.left.pen")
    assert changed == MINE.replace("up_mm = 4", "#up_mm = 4")
    assert without_keys(MINE, "machines.right") == MINE


def test_each_file_of_before_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "new" / "linedrawd.toml"
    assert replace_file(file, "one") is None
    assert replace_file(file, "two") == file.with_name("linedrawd.toml.before")
    third = replace_file(file, "three")
    assert third == file.with_name("linedrawd.toml.before2")
    assert (file.read_text(), file.with_name("linedrawd.toml.before").read_text()) == ("three", "one")
    put_back(file, third)
    assert (file.read_text(), sorted(path.name for path in file.parent.iterdir())) == (
        "two", ["linedrawd.toml", "linedrawd.toml.before"],
    )  # fmt: skip


def test_a_file_that_may_not_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(SettingsError, match="with sudo, or give --config"):
        replace_file(tmp_path / "file" / "linedrawd.toml", "x")


def test_values_are_shown_as_somebody_would_write_them() -> None:
    assert lines_of({"a.b": {"x": "y", "n": [1.0, 2.5]}, "c": {"t": True}}) == (
        '[a.b]\nx = "y"\nn = [1.0, 2.5]\n\n[c]\nt = true'
    )
