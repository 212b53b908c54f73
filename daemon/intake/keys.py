"""The keys of a keyboard by their names (Linux input-event-codes.h)."""

from __future__ import annotations

from daemon.errors import unknown

_ROWS = {
    1: "esc 1 2 3 4 5 6 7 8 9 0 minus equal backspace tab q w e r t y u i o p leftbrace rightbrace enter leftctrl "
    "a s d f g h j k l semicolon apostrophe grave leftshift backslash z x c v b n m comma dot slash rightshift "
    "kpasterisk leftalt space capslock f1 f2 f3 f4 f5 f6 f7 f8 f9 f10 numlock scrolllock kp7 kp8 kp9 kpminus kp4 kp5 "
    "kp6 kpplus kp1 kp2 kp3 kp0 kpdot",
    86: "102nd f11 f12",
    96: "kpenter rightctrl kpslash sysrq rightalt linefeed home up pageup left right end down pagedown insert delete",
    113: "mute volumedown volumeup power kpequal kpplusminus pause",
    121: "kpcomma",
    125: "leftmeta rightmeta compose stop",
    163: "nextsong playpause previoussong stopcd",
    179: "kpleftparen kprightparen",
    183: "f13 f14 f15 f16 f17 f18 f19 f20 f21 f22 f23 f24",
    256: "btn_0 btn_1 btn_2 btn_3 btn_4 btn_5 btn_6 btn_7 btn_8 btn_9",
    272: "btn_left btn_right btn_middle btn_side btn_extra btn_forward btn_back",
}
KEYS = {name: code for first, row in _ROWS.items() for code, name in enumerate(row.split(), first)}
"""The code of each name, which is the kernel's in small letters and without KEY_."""
MOST = 0x2FF
"""No key has a higher code."""
ANY = "any"


def code_of(key: int | str) -> int | None:
    """Of a key by its name or number; None for any key. Raises ValueError, which says what was meant."""
    if isinstance(key, int):
        if not 1 <= key <= MOST:
            raise ValueError(f"{key} is no number of a key: give one from 1 to {MOST}, or a name such as kpenter")
        return key
    name = key.lower().removeprefix("key_")
    if name != ANY and name not in KEYS:
        raise ValueError(unknown(f"the key {key}", name, [ANY, *KEYS]))
    return KEYS.get(name)
