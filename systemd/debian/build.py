"""Build dist/linedrawd_VERSION_ARCH.deb: wheels for the Pythons of Debian 12 and 13, and every file in its place."""

from __future__ import annotations

import argparse
import gzip
import hashlib
import os
import shutil
import subprocess
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from email.utils import formatdate
from functools import partial
from pathlib import Path

from papers import copyright_of, sbom, texts
from wheels import PLATFORMS, Part, differences, fetch, own_wheel, repack

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
PYTHONS = ("3.11", "3.13")
MAINTAINER = "linedrawd contributors <linedrawd@linedrawd.invalid>"
PLACES = {
    "systemd/linedrawd.service": "usr/lib/systemd/system/linedrawd.service",
    "systemd/debian/package.conf": "usr/lib/systemd/system/linedrawd.service.d/package.conf",
    "systemd/linedrawd.sysusers": "usr/lib/sysusers.d/linedrawd.conf",
    "systemd/linedrawd.tmpfiles": "usr/lib/tmpfiles.d/linedrawd.conf",
    "systemd/70-linedrawd.rules": "usr/lib/udev/rules.d/70-linedrawd.rules",
    "systemd/linedrawd.logrotate": "etc/logrotate.d/linedrawd",
    "systemd/linedrawd.toml": "etc/linedrawd/linedrawd.toml",
    "systemd/debian/environment": "usr/lib/linedrawd/environment",
    "tests/drawings/house.png": "usr/share/doc/linedrawd/examples/house.png",
    "systemd/drop-ins": "usr/share/doc/linedrawd/examples/drop-ins",
}
SCRIPTS = ("postinst", "prerm", "postrm")
MB = 1e6


def main() -> None:
    """Build what the command line asks for, and print how large each part is."""
    args = _parser().parse_args()
    work = ROOT / "build" / "deb"
    work.mkdir(parents=True, exist_ok=True)
    args.out.mkdir(parents=True, exist_ok=True)
    own = own_wheel(ROOT, work)
    shutil.copy(own, args.out)
    os.environ.setdefault("SOURCE_DATE_EPOCH", str(_last_change_s()))
    for arch in args.arch:
        parts = [repack(own, _emptied(work / f"own-{arch}"), small=False), *_parts(own, arch, args, work)]
        package(parts, arch, args.out, work / f"linedrawd-{arch}")
        shutil.rmtree(work / f"own-{arch}")


def package(parts: list[Part], arch: str, out: Path, tree: Path) -> Path:
    """Lay all files out below tree, and make the package of them."""
    _emptied(tree)
    version = parts[0].version
    for source, place in PLACES.items():
        _install(ROOT / source, tree / place)
    wheels = _emptied(tree / "usr/lib/linedrawd/wheels")
    for part in parts:
        shutil.copy(part.path, wheels)
    content = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(wheels.iterdir()))).hexdigest()
    (tree / "usr/lib/linedrawd/version").write_text(f"{version} {content[:16]}\n")
    (tree / "usr/bin").mkdir(parents=True)
    (tree / "usr/bin/linedrawd").symlink_to("/opt/linedrawd/bin/linedrawd")
    _write_papers(parts, version, arch, tree / "usr/share/doc/linedrawd")
    _write_control(version, arch, tree, unpacked=max(_unpacked(parts).values()))
    file = out / f"linedrawd_{version}_{arch}.deb"
    # The wheels are squeezed already.
    subprocess.run(["dpkg-deb", "-Zgzip", "-z1", "--root-owner-group", "--build", tree, file], check=True)
    _print_sizes(parts, file, tree)
    return file


def _parts(own: Path, arch: str, args: argparse.Namespace, work: Path) -> list[Part]:
    """Fetched and written anew, each wheel once where it serves several Pythons. Nothing is squeezed twice."""
    fetched: dict[str, Path] = {}
    for python in args.python:
        for path in fetch(own, arch, python, ROOT / "constraints.txt", _emptied(work / f"fetched-{arch}-{python}")):
            fetched.setdefault(path.name, path)
    folder = work / f"packed-{arch}-{'small' if args.small else 'quick'}"
    _emptied(folder)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(partial(repack, folder=folder, small=args.small), fetched.values()))
    for part in parts:
        if differences(part.path):
            raise ValueError(f"{part.path.name} and its RECORD disagree: {differences(part.path)}")
    return sorted(parts, key=lambda part: part.path.name)


def _write_papers(parts: list[Part], version: str, arch: str, doc: Path) -> None:
    others = [part for part in parts if part.name != "linedrawd"]
    once = list({part.name: part for part in others}.values())
    own = (ROOT / "LICENSE").read_text(encoding="utf-8")
    (doc / "copyright").write_text(copyright_of(once, own), encoding="utf-8")
    for part in once:
        for path, content in texts(part).items():
            place = doc / "licenses" / part.name / _flat(path)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
    (doc / "sbom.cdx.json").write_text(sbom(others, version=version, arch=arch), encoding="utf-8")
    for page in (ROOT / "docs").rglob("*.md"):
        _install(page, doc / page.relative_to(ROOT / "docs"))
    date = formatdate(int(os.environ["SOURCE_DATE_EPOCH"]), localtime=False)
    said = f"linedrawd ({version}) stable; urgency=medium\n\n  * See CHANGELOG.md.\n\n -- {MAINTAINER}  {date}\n"
    (doc / "changelog.gz").write_bytes(gzip.compress(said.encode(), 9, mtime=0))
    _install(ROOT / "CHANGELOG.md", doc / "CHANGELOG.md")


def _write_control(version: str, arch: str, tree: Path, *, unpacked: int) -> None:
    """Installed-Size holds the virtual environment too, which dpkg does not see."""
    control = tree / "DEBIAN"
    control.mkdir()
    said = {
        "@VERSION@": version,
        "@ARCH@": arch,
        "@MAINTAINER@": MAINTAINER,
        "@SIZE_KB@": str((_size(tree) + unpacked) // 1024),
    }
    text = (HERE / "control").read_text(encoding="utf-8")
    for word, value in said.items():
        text = text.replace(word, value)
    (control / "control").write_text(text, encoding="utf-8")
    for name in ("conffiles", "triggers", *SCRIPTS):
        _install(HERE / name, control / name)
    for path in sorted(path for path in tree.rglob("*") if path.is_file() and not path.is_symlink()):
        if control not in path.parents:
            digest = hashlib.md5(path.read_bytes(), usedforsecurity=False).hexdigest()
            with (control / "md5sums").open("a") as sums:
                sums.write(f"{digest}  {path.relative_to(tree)}\n")
    (control / "md5sums").chmod(0o644)


def _print_sizes(parts: list[Part], file: Path, tree: Path) -> None:
    print(f"\n{file.name}: {file.stat().st_size / MB:.1f} MB; MB of each part:")
    print(f"  {'':42}{'kept':>8}{'in /opt':>9}{'left out':>10}")
    for part in parts:
        name, kept = "-".join(part.path.name.split("-")[:3]), part.path.stat().st_size
        print(f"  {name:42}{kept / MB:8.1f}{part.unpacked / MB:9.1f}{part.left_out / MB:10.1f}")
    for python, size in _unpacked(parts).items():
        print(f"  with Python {python}: {size / MB:.1f} in /opt/linedrawd and bytecode, {_size(tree) / MB:.1f} kept")
    print(end="", flush=True)


def _unpacked(parts: Iterable[Part]) -> dict[str, int]:
    """Bytes of the virtual environment for each Python that there are wheels for."""
    parts = list(parts)
    tags = {python: f"-cp{python.replace('.', '')}-" for python in PYTHONS}
    bound = {python: [part for part in parts if tag in part.path.name] for python, tag in tags.items()}
    free = sum(part.unpacked for part in parts if not any(tag in part.path.name for tag in tags.values()))
    return {python: free + sum(part.unpacked for part in own) for python, own in bound.items() if own}


def _install(source: Path, place: Path) -> None:
    """A file, or a folder of files, with the rights that a package gives."""
    for path in _files(source):
        target = place / path.relative_to(source) if source.is_dir() else place
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        target.chmod(0o755 if path.name in (*SCRIPTS, "environment") else 0o644)


def _files(source: Path) -> Iterator[Path]:
    return (path for path in source.rglob("*") if path.is_file()) if source.is_dir() else iter([source])


def _emptied(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def _flat(path: str) -> str:
    """The name of a text of a licence, told apart from others of the same name by the folders above it."""
    inside = path.rpartition(".dist-info/")[2].removeprefix("licenses/")
    return inside.replace("/", "-")


def _size(tree: Path) -> int:
    return sum(path.stat().st_size for path in tree.rglob("*") if path.is_file() and not path.is_symlink())


def _last_change_s() -> int:
    """When the sources were last committed, or now where there is no git."""
    said = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=False)
    return int(said.stdout) if said.returncode == 0 else int(time.time())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arch", nargs="+", choices=PLATFORMS, default=list(PLATFORMS))
    parser.add_argument("--python", nargs="+", choices=PYTHONS, default=list(PYTHONS))
    parser.add_argument("--out", type=Path, default=ROOT / "dist")
    parser.add_argument(
        "--quick", dest="small", action="store_false", help="without LZMA: in seconds, a third larger; for tests"
    )
    return parser


if __name__ == "__main__":
    main()
