"""A program that answers like scanimage, as it has been told to: plan.json beside it, one turn a scan.

A turn: {"pages": how many, "status": exit code, "words": what it says on stderr, "then": "hang" | "crash" | "page half
written" | "child stays"}. Every call is noted in calls.txt; "died" in it says that SIGINT has ended a scan.
"""

import json
import os
import signal
import sys
from pathlib import Path

HERE = Path(__file__).parent
PLAN = json.loads((HERE / "plan.json").read_text())


def note(words: str) -> None:
    with (HERE / "calls.txt").open("a") as calls:
        calls.write(words + "\n")


def turn() -> dict[str, object]:
    """The next one; the last stays."""
    done = HERE / "done.txt"
    number = int(done.read_text()) if done.exists() else 0
    done.write_text(str(number + 1))
    turns: list[dict[str, object]] = PLAN["turns"]
    return turns[min(number, len(turns) - 1)]


def interrupted(number: int, _: object) -> None:
    note("died" if number == signal.SIGINT else "died without stopping the scanner")
    sys.exit(2)


def scan(batch: str) -> None:
    told = turn()
    for number in range(1, int(str(told.get("pages", 1))) + 1):
        page = Path(batch % number)
        part = page.with_name(page.name + ".part")
        part.write_bytes(bytes.fromhex(PLAN["page"]))
        part.rename(page)
        print(page, flush=True)
    print(told.get("words", ""), file=sys.stderr, flush=True)
    then = told.get("then")
    if then == "page half written":
        Path(batch % 99).with_suffix(".tiff.part").write_bytes(b"II")
    if then == "child stays":
        if (child := os.fork()) == 0:
            signal.pause()
        note(f"child {child}")
    if then == "crash":
        signal.signal(signal.SIGABRT, signal.SIG_DFL)
        os.abort()
    if then in {"hang", "hang deaf"}:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN if then == "hang deaf" else interrupted)
        note("hangs")
        while True:
            signal.pause()
    sys.exit(int(str(told.get("status", 0))))


def main() -> None:
    note(" ".join(sys.argv[1:]))
    if any("list" in word for word in sys.argv):
        print("\n".join(PLAN.get("devices", ["fake:0"])))
    elif "-A" in sys.argv:
        print(turn()["options"])
    else:
        scan(next(word for word in sys.argv if word.startswith("--batch=")).removeprefix("--batch="))


main()
