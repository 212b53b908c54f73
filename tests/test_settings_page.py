"""systemd/linedrawd.toml holds every setting, explained, and says nothing but what holds without it."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from daemon.config import AnyMachine, DobotMachine, EmcoMachine, GrblMachine, Options, Section, Settings, load_settings
from daemon.config.pen import ServoPenSettings
from tests.settings_page import EXAMPLES, PAGE, SYSTEMD, blocks, explained, page, uncommented

OTHERS = ("emco", "dobot", "servo")


def settings(file: Path, text: str) -> Settings:
    file.write_text(text)
    return load_settings(Options(config=file), environment=SYSTEMD, machine_needed=True)


def unset(tree: dict[str, Any]) -> dict[str, Any]:
    """Without the keys of the examples, which hold only where somebody sets them."""
    return {
        key: unset(value) if isinstance(value, dict) else value for key, value in tree.items() if key not in EXAMPLES
    }


def defaults() -> Settings:
    return load_settings(Options(device="grbl"), environment=SYSTEMD)


def test_the_file_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "make it anew: python -m tests.settings_page"


def test_the_file_loads_to_the_defaults(tmp_path: Path) -> None:
    assert settings(tmp_path / "linedrawd.toml", page()) == defaults()


def test_every_key_taken_out_of_its_comment_holds_what_held_before(tmp_path: Path) -> None:
    text = uncommented("\n".join(text for name, text in blocks() if name not in OTHERS))
    said = tomllib.loads(text)
    assert unset(settings(tmp_path / "linedrawd.toml", text).model_dump()) == unset(defaults().model_dump())
    for name, field in Settings.model_fields.items():
        if name != "machines":
            assert said[name].keys() == field.annotation.model_fields.keys()  # type: ignore[union-attr]
    assert said["machines"]["plotter"].keys() == GrblMachine.model_fields.keys()


@pytest.mark.parametrize(("device", "model"), [("emco", EmcoMachine), ("dobot", DobotMachine)])
def test_another_machine_is_there_with_every_key(tmp_path: Path, device: str, model: type[Section]) -> None:
    text = uncommented(dict(blocks())[device])
    (said,) = tomllib.loads(text)["machines"].values()
    loaded: AnyMachine
    (loaded,) = settings(tmp_path / "linedrawd.toml", text).machines.values()
    assert said.keys() == model.model_fields.keys()
    assert unset(loaded.model_dump()) == unset(model.model_validate({"device": device}).model_dump())


def test_a_pen_on_a_servo_is_there_with_every_key(tmp_path: Path) -> None:
    text = uncommented(dict(blocks())["servo"])
    assert tomllib.loads(text)["machines"]["plotter"]["pen"].keys() == ServoPenSettings.model_fields.keys()
    machine = settings(tmp_path / "linedrawd.toml", text).machines["plotter"]
    assert machine.pen == ServoPenSettings(kind="servo")


def test_what_is_no_key_of_this_machine_stays_a_comment() -> None:
    others = {name: text for name, text in blocks() if name in OTHERS}
    assert others.keys() == set(OTHERS)
    assert all(line.startswith("#") for text in others.values() for line in text.splitlines() if line)


def test_a_key_without_a_sentence_cannot_be_printed() -> None:
    class Silent(Section):
        loud_mm: float = 1.0

    with pytest.raises(KeyError, match=r"Silent\.loud_mm has no sentence below it"):
        explained(Silent, "loud_mm")
