"""The papers of the package: whose each part is, under which licence, and the list of all parts for machines."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cyclonedx.model import HashAlgorithm, HashType
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.model.contact import OrganizationalContact
from cyclonedx.model.license import LicenseAcknowledgement, LicenseExpression
from cyclonedx.output.json import JsonV1Dot6
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from packageurl import PackageURL
from wheels import Part

_SAID_OTHERWISE = {
    "annotated-types": "MIT",
    "flatbuffers": "Apache-2.0",
    "onnxruntime": "MIT",
    "opencv-python-headless": "Apache-2.0",
    "protobuf": "BSD-3-Clause",
    "pypdfium2": "(Apache-2.0 OR BSD-3-Clause) AND LicenseRef-PDFium-and-its-parts",
    "pyserial": "BSD-3-Clause",
    "pyusb": "BSD-3-Clause",
    "watchdog": "Apache-2.0",
}
"""Parts whose metadata has no licence in the words of SPDX."""
_HERE = Path(__file__).parent
_TEXTS = {"pyserial": _HERE / "pyserial.LICENSE", "flatbuffers": Path("/usr/share/common-licenses/Apache-2.0")}
"""Of parts whose wheel holds no text of its licence."""


def licence(part: Part) -> str:
    """As an expression of SPDX. Raises KeyError for a part of which nobody has said it yet."""
    return str(part.about["License-Expression"] or _SAID_OTHERWISE[part.name])


def texts(part: Part) -> dict[str, bytes]:
    """The texts of a part's licence by the names of their files. Raises KeyError where there is none."""
    return part.licences or {"LICENSE": _TEXTS[part.name].read_bytes()}


def author(part: Part) -> str:
    return str(part.about["Author"] or part.about["Author-email"] or part.about["Maintainer-email"] or part.name)


def copyright_of(parts: Iterable[Part], own: str) -> str:
    """Debian's machine-readable copyright file. own: the text of linedrawd's licence."""
    parts = list(parts)
    stanzas = [
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: linedrawd",
        "Files: *\nCopyright: 2026 linedrawd contributors\nLicense: MIT",
    ]
    for part in parts:
        files = " ".join(f"*/{top}*" for top in sorted(part.tops))
        stanzas.append(f"Files: {files}\nCopyright: {author(part)}\nLicense: {part.name}")
    stanzas.append("License: MIT\n" + indented(own))
    for part in parts:
        where = f"/usr/share/doc/linedrawd/licenses/{part.name}/"
        stanzas.append(f"License: {part.name}\n {licence(part)}. The whole text lies in {where}")
    return "\n\n".join(stanzas) + "\n"


def indented(text: str) -> str:
    return "\n".join(f" {line}" if line.strip() else " ." for line in text.strip().splitlines())


def sbom(parts: Iterable[Part], *, version: str, arch: str) -> str:
    """CycloneDX 1.6 as JSON. Raises ValueError when it does not keep to the schema."""
    bom = Bom()
    bom.metadata.component = root = Component(
        name="linedrawd", version=version, type=ComponentType.APPLICATION, licenses=_licences("MIT"),
        purl=PackageURL("deb", None, "linedrawd", version, {"arch": arch}),
    )  # fmt: skip
    components = [_component(part) for part in parts]
    bom.components.update(components)
    bom.register_dependency(root, components)
    text = str(JsonV1Dot6(bom).output_as_string(indent=1))
    wrong = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    if wrong:
        raise ValueError(f"the list of parts does not keep to CycloneDX 1.6: {wrong}")
    return text


def _component(part: Part) -> Component:
    return Component(
        name=part.name,
        version=part.version,
        type=ComponentType.LIBRARY,
        authors=[OrganizationalContact(name=author(part))],
        licenses=_licences(licence(part)),
        hashes=[HashType(alg=HashAlgorithm.SHA_256, content=part.sha256)],
        purl=PackageURL("pypi", None, part.name.lower(), part.version, {"file_name": part.wheel}),
        bom_ref=part.wheel,
    )


def _licences(expression: str) -> list[LicenseExpression]:
    return [LicenseExpression(expression, acknowledgement=LicenseAcknowledgement.DECLARED)]
