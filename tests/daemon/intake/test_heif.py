"""HEIC photographs: upright and grey, or refused with a sentence."""

from __future__ import annotations

import base64
import sys
from pathlib import Path

import pytest

from daemon.errors import BadPicture
from daemon.intake.picture import open_picture
from daemon.shapes import PageImage

INK_TOP_LEFT = base64.b85decode(
    "0000SW^{RQXk}@500000ZE0pPXk}@5ZE0a<0003_ZDn*}000000000XXk=`10000000000aA{+700000000000000000000B57=IV*mgE07O6l0RRC"
    "200001asUAU00000001Wd001LtX>Mi!000000RR916=`l}WdZ;I000310BCk&F#rGn01j|zbZr0t000010002aX>f9I00025X>en20001TXm(>m0R#"
    "vD005u(000009`FGC{P_3)01pFT0096OKmiN^|NjIC00093pZEX(0{{RXx&lC90096dLID8;2mk;B0H62(00RI39>Br`7F($#rn#^n00096AOHXZ03"
    "l)k0RRU?0l{*xB0vBD025<xY;ta6Y<K_x01W^JfB*mh6lrsCWdHyG00000U;qFBKmY&$4sdCBX#fBK009U9000+haBX1#00000000310R({p0|Wp70"
    "55H1VRQfh03#>?t~2+!|MgbNp>BZN3W|I_#{$4;HQLYHWuH3Jb-3c_H~"
)
"""96 x 64 px, black in the left quarter of the upper third."""


def refusal(tmp_path: Path, data: bytes, *, max_megapixels: float = 10.0) -> str:
    (tmp_path / "a.heic").write_bytes(data)
    with pytest.raises(BadPicture) as caught:
        open_picture(tmp_path / "a.heic", name="a.heic", max_megapixels=max_megapixels)
    return str(caught.value)


def test_a_photograph_is_read_whatever_its_name(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(INK_TOP_LEFT)
    found = open_picture(tmp_path / "a.jpg")
    assert isinstance(found, PageImage)
    assert found.grey.shape == (64, 96)
    assert found.grey[2:18, 2:22].max() < 40
    assert found.grey[:, 28:].min() > 215
    assert found.grey[24:].min() > 215


@pytest.mark.parametrize("kept", [30, 100, 300, len(INK_TOP_LEFT) - 1])
def test_one_that_is_cut_short_is_refused(tmp_path: Path, kept: int) -> None:
    said = refusal(tmp_path, INK_TOP_LEFT[:kept])
    assert said.startswith("a.heic is a HEIC that cannot be read (")
    assert said.endswith("): copy it again, or save it as JPEG")


def test_one_of_too_many_pixels_is_refused(tmp_path: Path) -> None:
    words = "a.heic is a HEIC that has 96 x 64 px, at most 0.006 megapixels are read: make it smaller, or raise "
    assert refusal(tmp_path, INK_TOP_LEFT, max_megapixels=0.006) == words + "max_megapixels"


def test_without_the_library_the_command_that_installs_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pi_heif", None)
    assert "pi_heif is not installed: save it as JPEG; where" in refusal(tmp_path, INK_TOP_LEFT)
