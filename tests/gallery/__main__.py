"""The gallery, from the daemon with a simulated plotter and no settings: `python -m tests.gallery [docs]`.

Writes gallery.md and gallery/*.jpg into the folder, in some ten minutes. The seconds are the simulated plotter's.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from daemon.config import Options, Settings, load_settings
from daemon.jobs.folder import warnings_of
from daemon.jobs.planner import plan_picture
from daemon.report import canvas
from daemon.report.canvas import Picture
from daemon.report.contact_sheet import Row, contact_sheet
from daemon.report.preview import in_words
from tests.demo import Seen, daemon, drop, row_of, wait_for
from tests.drawings.colours import SECTION
from tests.gallery.inputs import DRAWINGS, Input, kinds

_DOCS = Path(__file__).parents[2] / "docs"
_QUALITY = 84
_PENS, _SIDE_PX = "with-pens.jpg", 640
_TAIL = f"""## With pens set

![Three colours: given, and the drawing in its three pens with the travel between](gallery/{_PENS})

`three_colours.png` with `[pens]` in the settings, as it is planned: [pens.md](pens.md).
"""
_HEAD = """# Gallery: given, understood, drawn

{count} inputs of {kinds} kinds, drawn by the daemon on the simulated plotter without a single setting, those that go
wrong among them. Left what was given, in the middle the strokes that were understood, each in its colour and with a
ring where it begins, right the ink that was drawn. F1 says how well that ink covers the lines of the page and no more;
the time is the plotter's. What still goes wrong is told in [limits.md](limits.md). All drawings are our own:
`python -m tests.gallery` draws them again and writes this page.
"""


def main(docs: Path) -> None:
    """Everything anew. Raises SystemExit when the daemon ends before all is drawn or refused."""
    with tempfile.TemporaryDirectory() as folder:
        rows, said = _drawn(Path(folder), [each for kind in kinds().values() for each in kind])
    shutil.rmtree(docs / "gallery", ignore_errors=True)
    (docs / "gallery").mkdir(parents=True)
    for title, inputs in kinds().items():
        sheet = contact_sheet([rows[each.file] for each in inputs], title=title)
        (docs / "gallery" / _file(title)).write_bytes(_jpeg(sheet))
    (docs / "gallery" / _PENS).write_bytes(_jpeg(with_pens()))
    (docs / "gallery.md").write_text(page(rows, said), encoding="utf-8")


def page(rows: dict[str, Row], said: dict[str, Sequence[str]]) -> str:
    """The text of gallery.md. rows, said: of each file what became of it, and the warnings of its plan."""
    parts = [_HEAD.format(count=sum(map(len, kinds().values())), kinds=len(kinds()))]
    for title, inputs in kinds().items():
        parts.append(f"## {title}\n\n![{title}: given, understood, drawn](gallery/{_file(title)})\n")
        parts.append("| file | what it is | strokes | F1 | time |\n|---|---|---:|---:|---:|")
        parts += [_line(each, rows[each.file], said[each.file]) for each in inputs]
        parts.append("")
    return "\n".join([*parts, _TAIL])


def with_pens() -> Picture:
    """A drawing in three colours, and what its preview shows where pens of these colours are set."""
    given = DRAWINGS / "three_colours.png"
    with tempfile.TemporaryDirectory() as folder:
        toml = Path(folder) / "pens.toml"
        toml.write_text(SECTION, encoding="utf-8")
        settings = load_settings(Options(config=toml, device="sim", state_dir=Path(folder)))
        plan_picture(given, Path(folder), settings, *settings.machines)
        pictures = [cv2.imread(str(path), cv2.IMREAD_COLOR) for path in (given, Path(folder) / "preview.png")]
    tiles = [canvas.fit(np.asarray(picture, np.uint8), _SIDE_PX, _SIDE_PX) for picture in pictures]
    return np.asarray(np.hstack(tiles), np.uint8)


def _line(given: Input, row: Row, said: Sequence[str]) -> str:
    words = [given.words, *(f"*Warned: {each}.*" for each in said)]
    if row.trouble:
        return f"| `{given.file}` | {' '.join(words)} **Refused:** {row.trouble}. | – | – | – |"
    f1 = "–" if row.f1 is None else f"{row.f1:.3f}"
    return f"| `{given.file}` | {' '.join(words)} | {len(row.understood)} | {f1} | {in_words(row.seconds or 0.0)} |"


def _drawn(folder: Path, inputs: Sequence[Input]) -> tuple[dict[str, Row], dict[str, Sequence[str]]]:
    """For each file its row, and what its plan warns of."""
    for path in (folder / "given", folder / "state"):
        path.mkdir()
    pictures = [folder / "given" / each.file for each in inputs]
    for each, picture in zip(inputs, pictures, strict=True):
        picture.write_bytes(each.make())
    settings = load_settings(Options(device="sim", state_dir=folder / "state"))
    with daemon(folder) as process:
        drop(pictures, settings.paths.inbox)
        jobs = {job.name: job for job in wait_for(len(pictures), settings, process, folder)}
    rows = {picture.name: _row(settings, jobs[picture.name], picture) for picture in pictures}
    return rows, {name: warnings_of(settings.paths.jobs / job.id) for name, job in jobs.items()}


def _row(settings: Settings, job: Seen, picture: Path) -> Row:
    """In its colours where it has any."""
    row, seen = row_of(settings, job), cv2.imread(str(picture), cv2.IMREAD_COLOR)
    return row if seen is None else replace(row, given=np.asarray(seen, np.uint8))


def _file(title: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in title.lower()).replace("--", "-") + ".jpg"


def _jpeg(picture: Picture) -> bytes:
    return bytes(cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1])


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else _DOCS)
