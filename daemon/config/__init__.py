"""The settings: one TOML file, the command line and the environment, read here and nowhere else, checked once."""

from __future__ import annotations

from daemon.config.button import Button
from daemon.config.load import DEFAULT_MACHINE, Options, Settings, load_settings
from daemon.config.machine import SIMULATED_GRBL, AnyMachine, DobotMachine, EmcoMachine, GrblMachine, Machine
from daemon.config.paths import Paths
from daemon.config.pen import PenSettings, ServoPenSettings, ZPenSettings
from daemon.config.pens import Pens
from daemon.config.scanner import Scanner
from daemon.config.section import Section
from daemon.config.sheet import Intake, Keep, Planning, Sheet

__all__ = [
    "DEFAULT_MACHINE",
    "SIMULATED_GRBL",
    "AnyMachine",
    "Button",
    "DobotMachine",
    "EmcoMachine",
    "GrblMachine",
    "Intake",
    "Keep",
    "Machine",
    "Options",
    "Paths",
    "PenSettings",
    "Pens",
    "Planning",
    "Scanner",
    "Section",
    "ServoPenSettings",
    "Settings",
    "Sheet",
    "ZPenSettings",
    "load_settings",
]
