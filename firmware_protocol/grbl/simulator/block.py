"""One line of G-code sorted into modal groups and words, with the errors that need no state (GRBL 1.1h, step 2)."""

from __future__ import annotations

from dataclasses import dataclass, field

from firmware_protocol.gcode import GcodeError, Word, read_words

UNSUPPORTED = 20
GROUP_REPEATED = 21
NOT_AN_INTEGER = 23
AXES_TAKEN_TWICE = 24
WORD_REPEATED = 25
TOOL_TOO_BIG = 38
NEGATIVE = 4

NON_MODAL, MOTION, PLANE, DISTANCE, ARC_DISTANCE, FEED_MODE, UNITS, CUTTER, LENGTH, WORK, PATH = range(11)
FLOW, SPINDLE, COOLANT = range(20, 23)

# Codes are ten times the number behind the letter, so that G38.2 is 382.
_G_GROUPS: dict[int, int] = {
    **dict.fromkeys((40, 100, 280, 281, 300, 301, 530, 920, 921), NON_MODAL),
    **dict.fromkeys((0, 10, 20, 30, 382, 383, 384, 385, 800), MOTION),
    **dict.fromkeys((170, 180, 190), PLANE),
    **dict.fromkeys((900, 910), DISTANCE),
    **dict.fromkeys((930, 940), FEED_MODE),
    **dict.fromkeys((200, 210), UNITS),
    **dict.fromkeys((431, 490), LENGTH),
    **dict.fromkeys((540, 550, 560, 570, 580, 590), WORK),
    911: ARC_DISTANCE,
    400: CUTTER,
    610: PATH,
}
_M_GROUPS: dict[int, int] = {
    **dict.fromkeys((0, 1, 2, 30), FLOW),
    **dict.fromkeys((3, 4, 5), SPINDLE),
    **dict.fromkeys((8, 9), COOLANT),
}
_KNOWN_G = {code // 10 for code in _G_GROUPS}
_OTHER_DECIMALS_UNSUPPORTED = {28, 30, 38, 43, 61, 90, 91, 92}
_AXES_USED_BY = {
    **dict.fromkeys((0, 10, 20, 30, 382, 383, 384, 385), MOTION),
    **dict.fromkeys((100, 280, 300, 920), NON_MODAL),
    **dict.fromkeys((431, 490), LENGTH),
}
_LETTERS = set("FIJKLNPRSTXYZ")
_NEVER_NEGATIVE = set("FNPST")


@dataclass(slots=True)
class Block:
    """What a line says. `axes_for`: the group whose command takes X, Y and Z; `spare`: words that nothing has used."""

    groups: dict[int, int] = field(default_factory=dict)
    words: dict[str, float] = field(default_factory=dict)
    axes_for: int | None = None
    spare: set[str] = field(default_factory=set)
    jog: bool = False

    def has(self, group: int, code: int) -> bool:
        return self.groups.get(group) == code

    @property
    def axes(self) -> list[int]:
        """The axes with a word, X = 0."""
        return [index for index, letter in enumerate("XYZ") if letter in self.words]


def read_block(line: str, *, jog: bool = False) -> Block:
    """Sort a cleaned line. Raises GcodeError with the code of GRBL's first complaint."""
    block = Block(jog=jog)
    for word in read_words(line):
        if word.letter == "G":
            _read_g(block, word.value)
        elif word.letter == "M":
            _read_m(block, word.value)
        else:
            _read_value(block, word)
    block.spare = set(block.words) - {"N"}
    if block.axes and block.axes_for is None:
        block.axes_for = MOTION
    return block


def _read_g(block: Block, value: float) -> None:
    whole, code = _code(value)
    user = _AXES_USED_BY.get(code)
    if user is not None:
        if block.axes_for is not None:
            raise GcodeError(AXES_TAKEN_TWICE)
        block.axes_for = user
    group = _G_GROUPS.get(code)
    if group is None:
        known = whole in _KNOWN_G and whole not in _OTHER_DECIMALS_UNSUPPORTED
        raise GcodeError(NOT_AN_INTEGER if known else UNSUPPORTED)
    _take_group(block, group, code)


def _read_m(block: Block, value: float) -> None:
    whole, code = _code(value)
    if code != whole * 10:
        raise GcodeError(NOT_AN_INTEGER)
    group = _M_GROUPS.get(whole)
    if group is None:
        raise GcodeError(UNSUPPORTED)
    _take_group(block, group, whole)


def _read_value(block: Block, word: Word) -> None:
    letter, value = word
    if letter not in _LETTERS:
        raise GcodeError(UNSUPPORTED)
    if letter == "T" and value > 255:
        raise GcodeError(TOOL_TOO_BIG)
    if letter in block.words:
        raise GcodeError(WORD_REPEATED)
    if letter in _NEVER_NEGATIVE and value < 0:
        raise GcodeError(NEGATIVE)
    block.words[letter] = value


def _take_group(block: Block, group: int, code: int) -> None:
    if group in block.groups:
        raise GcodeError(GROUP_REPEATED)
    block.groups[group] = code


def _code(value: float) -> tuple[int, int]:
    """The whole number as the byte that GRBL keeps of it, and the code with its decimal (-1: no such decimal)."""
    whole = int(value) & 0xFF
    hundredths = round(100 * (value - whole))
    return whole, whole * 10 + hundredths // 10 if hundredths % 10 == 0 and 0 <= hundredths < 100 else -1
