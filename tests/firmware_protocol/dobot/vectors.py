"""Captured requests of other people's clients with their replies, and what both mean."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

GOLDEN: dict[str, list[Any]] = json.loads(
    (Path(__file__).parents[2] / "golden" / "dobot_vectors.json").read_text(encoding="ascii")
)
VECTORS: list[dict[str, Any]] = GOLDEN["vectors"]


def sound() -> list[dict[str, Any]]:
    """Those whose request has the right checksum."""
    return [vector for vector in VECTORS if vector.get("sound", True)]


def numbered(vectors: list[dict[str, Any]]) -> list[str]:
    return [vector["id"] for vector in vectors]
