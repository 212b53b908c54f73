"""A setting that is changed holds from when the table says, or is named as one that needs a restart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from daemon.config import Options, Settings, load_settings
from daemon.config.reread import AT_ONCE, reread, since


def settings(tmp_path: Path, text: str) -> Settings:
    file = tmp_path / "linedrawd.toml"
    file.write_text(text)
    return load_settings(Options(config=file, state_dir=tmp_path), environment={"HOME": "/nonexistent"})


def test_what_can_be_reread_holds_and_the_rest_is_named(tmp_path: Path) -> None:
    old = settings(tmp_path, "[sheet]\nrotate = 90\n[intake]\npoll_s = 3\n")
    new = settings(tmp_path, "[sheet]\nrotate = 180\n[intake]\npoll_s = 4\n[machines.plotter]\ndraw_mm_s = 30\n")
    held, words = reread(old, new)
    assert (held.sheet.rotate, held.intake.poll_s, held.machines["plotter"].draw_mm_s) == (180, 3.0, 30.0)
    assert words == [
        "intake.poll_s = 4.0 needs a restart: restart linedrawd",
        "machines.plotter.draw_mm_s = 30.0 holds from the next picture that is planned on",
        "sheet.rotate = 180 holds from the next picture that is planned on",
    ]


def test_what_is_the_same_is_not_named(tmp_path: Path) -> None:
    old = settings(tmp_path, "[sheet]\nrotate = 90\n")
    assert reread(old, settings(tmp_path, "[sheet]\nrotate = 90\n")) == (old, [])


@pytest.mark.parametrize("text", ["[machines.other]\n", "[machines.plotter]\ndevice = 'dobot'\n"])
def test_another_machine_needs_a_restart(tmp_path: Path, text: str) -> None:
    old = settings(tmp_path, "")
    assert reread(old, settings(tmp_path, text + "[sheet]\nrotate = 90\n")) == (
        old,
        ["machines has changed to other machines: restart linedrawd"],
    )


def test_a_pen_of_another_kind_needs_a_restart(tmp_path: Path) -> None:
    old = settings(tmp_path, "")
    held, words = reread(old, settings(tmp_path, "[machines.plotter]\npen = { kind = 'servo' }\n"))
    assert held == old
    assert "machines.plotter.pen.kind = servo needs a restart: restart linedrawd" in words
    assert "machines.plotter.pen.up_mm, which is no longer set, needs a restart: restart linedrawd" in words


def leaves(tree: dict[str, Any], above: str = "") -> list[str]:
    return [
        leaf
        for key, value in tree.items()
        for leaf in (leaves(value, f"{above}{key}.") if isinstance(value, dict) and value else [above + key])
    ]


def test_every_key_of_the_table_is_a_key_of_the_settings(tmp_path: Path) -> None:
    keys = leaves(settings(tmp_path, "").model_dump())
    unknown = [pattern for pattern in AT_ONCE if not any(since(key) == AT_ONCE[pattern] for key in keys)]
    assert unknown == []
    assert sum(bool(since(key)) for key in keys) == 33, "look whether the new key can be reread, and say so here"
