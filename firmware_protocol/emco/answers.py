"""Answers of a control to single blocks: control characters anywhere in the stream, or lines of text."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum, auto

LIMIT_BYTES = 256
"""Of what is no answer only the last so many bytes are kept."""


class Answer(Enum):
    ACK = auto()
    NAK = auto()


class AnswerReader:
    """Finds answers in a stream of bytes, however it is chunked.

    An answer of printable characters is one when it is a whole line, so that `ok` is not found in `look`; any other
    is found anywhere. Raises ValueError for answers that are empty or that cannot be told apart.
    """

    def __init__(self, *, ack: bytes, nak: bytes) -> None:
        if not ack or not nak or ack.endswith(nak) or nak.endswith(ack):
            raise ValueError(f"the answers {ack!r} and {nak!r} cannot be told apart: choose two different ones")
        answers = {ack: Answer.ACK, nak: Answer.NAK}
        self._lines = {text: answer for text, answer in answers.items() if _is_text(text)}
        self._marks = {mark: answer for mark, answer in answers.items() if not _is_text(mark)}
        self._line = bytearray()
        self.other = ""
        """The last line that was no answer."""

    def feed(self, data: bytes) -> Iterator[Answer]:
        """The answers that `data` completes. Take them all before feeding again."""
        for byte in data:
            if byte in b"\r\n" and not self._marked(byte):
                if (answer := self._whole_line()) is not None:
                    yield answer
                continue
            self._line.append(byte)
            del self._line[:-LIMIT_BYTES]
            for mark, answer in self._marks.items():
                if self._line.endswith(mark):
                    self._line.clear()
                    yield answer
                    break

    def _marked(self, byte: int) -> bool:
        """An answer that is not text may hold line ends."""
        return any(byte in mark for mark in self._marks)

    def _whole_line(self) -> Answer | None:
        line = bytes(self._line).strip()
        self._line.clear()
        answer = self._lines.get(line)
        if answer is None and line:
            self.other = line.decode("latin-1")
        return answer


def _is_text(answer: bytes) -> bool:
    return all(0x20 <= byte < 0x7F for byte in answer)
