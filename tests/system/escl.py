"""A network scanner that is driverless (eSCL, Mopria 2.97): what lies on it are pictures of ours. Loopback only."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

_SPACES = 'xmlns:pwg="http://www.pwg.org/schemas/2010/12/sm" xmlns:scan="http://schemas.hp.com/imaging/escl/2011/05/03"'
_SIZES = (
    "<scan:MinWidth>16</scan:MinWidth><scan:MaxWidth>2550</scan:MaxWidth>"
    "<scan:MinHeight>16</scan:MinHeight><scan:MaxHeight>3508</scan:MaxHeight>"
    "<scan:SettingProfiles><scan:SettingProfile>"
    "<scan:ColorModes><scan:ColorMode>Grayscale8</scan:ColorMode><scan:ColorMode>RGB24</scan:ColorMode></scan:ColorModes>"
    "<scan:DocumentFormats><pwg:DocumentFormat>image/jpeg</pwg:DocumentFormat></scan:DocumentFormats>"
    "<scan:SupportedResolutions><scan:DiscreteResolutions>"
    "<scan:DiscreteResolution><scan:XResolution>150</scan:XResolution><scan:YResolution>150</scan:YResolution>"
    "</scan:DiscreteResolution>"
    "<scan:DiscreteResolution><scan:XResolution>300</scan:XResolution><scan:YResolution>300</scan:YResolution>"
    "</scan:DiscreteResolution></scan:DiscreteResolutions></scan:SupportedResolutions>"
    "</scan:SettingProfile></scan:SettingProfiles>"
)
_CAPABILITIES = (
    f'<?xml version="1.0"?><scan:ScannerCapabilities {_SPACES}><pwg:Version>2.6</pwg:Version>'
    "<pwg:MakeAndModel>Our Scanner</pwg:MakeAndModel>"
    f"<scan:Platen><scan:PlatenInputCaps>{_SIZES}</scan:PlatenInputCaps></scan:Platen>"
    f"<scan:Adf><scan:AdfSimplexInputCaps>{_SIZES}</scan:AdfSimplexInputCaps></scan:Adf></scan:ScannerCapabilities>"
)


class Scanner:
    """pages: JPEG files, which lie in the feeder and, the first one, on the glass. busy: so many scans are refused."""

    def __init__(self, pages: Sequence[Path], *, busy: int = 0, adf: str = "ScannerAdfLoaded") -> None:
        self.pages, self.busy, self.adf = list(pages), busy, adf
        self.left: list[Path] = []
        self.asked: list[str] = []

    def begin(self, settings: str) -> bool:
        """A scan has been asked for; False while it is busy."""
        self.asked.append(settings)
        if self.busy:
            self.busy -= 1
            return False
        self.left = self.pages if "Feeder" in settings else self.pages[:1]
        return True

    def shown(self, what: str) -> tuple[bytes, str]:
        """What is under this name, and of what kind; nothing under most, and when no page is left."""
        match what:
            case "ScannerCapabilities":
                return _CAPABILITIES.encode(), "text/xml"
            case "ScannerStatus":
                return self._status().encode(), "text/xml"
            case "NextDocument" if self.left:
                page, *self.left = self.left
                return page.read_bytes(), "image/jpeg"
        return b"", "text/plain"

    def _status(self) -> str:
        return (
            f'<?xml version="1.0"?><scan:ScannerStatus {_SPACES}><pwg:Version>2.6</pwg:Version>'
            f"<pwg:State>Idle</pwg:State><scan:AdfState>{self.adf}</scan:AdfState></scan:ScannerStatus>"
        )


@contextmanager
def serving(scanner: Scanner) -> Iterator[str]:
    """The URL of its eSCL, until the block is left."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), _handler(scanner))
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}/eSCL"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def _handler(scanner: Scanner) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            body, kind = scanner.shown(self.path.rpartition("/")[2])
            self._say(200 if body else 404, body, kind)

        def do_POST(self) -> None:
            settings = self.rfile.read(int(self.headers["Content-Length"])).decode()
            if scanner.begin(settings):
                self._say(201, location=f"http://{self.headers['Host']}/eSCL/ScanJobs/1")
            else:
                self._say(503)

        def do_DELETE(self) -> None:
            self._say(200)

        def log_message(self, format: str, *_: object) -> None:  # noqa: A002
            """Tells nobody."""

        def _say(self, code: int, body: bytes = b"", kind: str = "text/plain", location: str = "") -> None:
            self.send_response(code)
            if location:
                self.send_header("Location", location)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

    return Handler
