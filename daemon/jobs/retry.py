"""When an idle machine, or one that is not there, is looked at again."""

from __future__ import annotations

from daemon.errors import MachineFault, NoMachine, Unplugged

IDLE_S = 0.9
"""So that an idle machine that is unplugged is noticed within a second."""
NO_MACHINE_RETRY_S = 3.0
FAULT_RETRY_S = 30.0
"""Opening a port resets many controllers: one that answers, but is not ready, is left alone longer."""


def retry_after_s(error: NoMachine | MachineFault) -> float:
    """How long after this error: a port that is not there is not reset by being looked for."""
    return NO_MACHINE_RETRY_S if isinstance(error, NoMachine | Unplugged) else FAULT_RETRY_S
