"""The structures of `loop.h` for ctypes, field by field in the same order."""

from __future__ import annotations

import ctypes
from typing import ClassVar

INT = ctypes.c_int32
LONG = ctypes.c_int64
DOUBLE = ctypes.c_double
POINTER = ctypes.c_void_p

DONE, PAUSE, FULL, ACTION, CALL_FAILED, OUT_OF_BOUNDS, GROWTH, CREATED, NOT_FINITE = range(9)
GAUSS_SEIDEL, JACOBI, EXTRAPOLATED = range(3)
NO_LAW, FORCE, TORQUE = range(3)
POINTS = 4
HISTORY = 2049
MEMBERS = 8
MOTIONS = 3

Serve = ctypes.CFUNCTYPE(INT, INT, DOUBLE, DOUBLE)


class Block(ctypes.Structure):
    """Variables of one FMI type that one call sets or gets."""

    _fields_: ClassVar = [
        ("call", POINTER),
        ("references", POINTER),
        ("values", POINTER),
        ("places", POINTER),
        ("indices", POINTER),
        ("reference_count", LONG),
        ("value_count", LONG),
        ("used", LONG),
        ("type", INT),
        ("wide", INT),
    ]


class Transfer(ctypes.Structure):
    """All that is set, or got, of an instance at once."""

    _fields_: ClassVar = [("blocks", POINTER), ("count", LONG), ("buffer", POINTER)]


class Move(ctypes.Structure):
    """A run of neighbouring outputs that go to neighbouring inputs."""

    _fields_: ClassVar = [("target", POINTER), ("source", POINTER), ("count", LONG)]


class Instance(ctypes.Structure):
    """An instance with its inputs and outputs."""

    _fields_: ClassVar = [
        ("component", POINTER),
        ("do_step", POINTER),
        ("get_state", POINTER),
        ("set_state", POINTER),
        ("free_state", POINTER),
        ("serve", Serve),
        ("moves", POINTER),
        ("inputs", POINTER),
        ("gain", POINTER),
        ("offset", POINTER),
        ("sources", POINTER),
        ("plain", POINTER),
        ("arriving", POINTER),
        ("faults", POINTER),
        ("flags", POINTER * 3),
        ("reached", POINTER),
        ("place", POINTER),
        ("set", Transfer),
        ("get", Transfer * 2),
        ("move_count", LONG),
        ("wired", LONG),
        ("plain_count", LONG),
        ("first", LONG),
        ("past", LONG),
        ("steps", LONG),
        ("rollbacks", LONG),
        ("saved", LONG),
        ("warned", LONG),
        ("now", DOUBLE),
        ("kept", DOUBLE),
        ("version", INT),
        ("direct", INT),
    ]


class System(ctypes.Structure):
    """All instances and the values that they share."""

    _fields_: ClassVar = [
        ("values", POINTER),
        ("instances", POINTER),
        ("followers", POINTER),
        ("events", POINTER),
        ("value_count", LONG),
        ("instance_count", LONG),
        ("follower_count", LONG),
        ("event_count", LONG),
    ]


class Past(ctypes.Structure):
    """Values at the last communication points."""

    _fields_: ClassVar = [
        ("values", POINTER * POINTS),
        ("times", DOUBLE * POINTS),
        ("count", LONG),
        ("most", LONG),
    ]


class Master(ctypes.Structure):
    """The method, and what it remembers."""

    _fields_: ClassVar = [
        ("kind", INT),
        ("degree", INT),
        ("past", Past),
        ("mean", POINTER),
        ("last", POINTER),
        ("before", POINTER),
        ("stepped", POINTER),
    ]


class Guard(ctypes.Structure):
    """Bounds and growth of all values."""

    _fields_: ClassVar = [
        ("high", POINTER),
        ("low", POINTER),
        ("wired", POINTER),
        ("peak", POINTER),
        ("previous", POINTER),
        ("growing", POINTER),
        ("every", LONG),
        ("windows", LONG),
        ("count", LONG),
    ]


class Recorder(ctypes.Structure):
    """Rows, and which values they hold."""

    _fields_: ClassVar = [
        ("columns", POINTER),
        ("rows", POINTER),
        ("times", POINTER),
        ("column_count", LONG),
        ("every", LONG),
        ("count", LONG),
        ("capacity", LONG),
        ("from_", DOUBLE),
    ]


class Coupling(ctypes.Structure):
    """One watched power coupling."""

    _fields_: ClassVar = [
        ("inputs", POINTER),
        ("history", POINTER),
        ("members", LONG * MEMBERS),
        ("back", LONG * MOTIONS),
        ("effort", LONG),
        ("flow", LONG),
        ("age", LONG),
        ("kept", LONG),
        ("scale", DOUBLE),
        ("share", DOUBLE),
        ("created", DOUBLE),
        ("exchanged", DOUBLE),
        ("last", DOUBLE * 4),
        ("motion", DOUBLE * MOTIONS),
        ("law", INT),
    ]


class Audit(ctypes.Structure):
    """All watched couplings, and when one of them feeds a growth."""

    _fields_: ClassVar = [
        ("couplings", POINTER),
        ("count", LONG),
        ("checked", LONG),
        ("steps", LONG),
        ("growth", DOUBLE),
        ("rise", DOUBLE),
        ("power", DOUBLE),
        ("even", DOUBLE),
        ("fed", DOUBLE),
        ("blatant", DOUBLE),
        ("faint", DOUBLE),
        ("brief", LONG),
    ]


class Control(ctypes.Structure):
    """Step control: the estimator, the controller, and the last point kept."""

    _fields_: ClassVar = [
        ("columns", POINTER),
        ("whole", POINTER),
        ("error", POINTER),
        ("scale", POINTER),
        ("kept_values", POINTER),
        ("switches", POINTER),
        ("kept_inputs", POINTER),
        ("input_counts", POINTER),
        ("kept_states", POINTER),
        ("kept_past", Past),
        ("seen", Past),
        ("taken", POINTER),
        ("column_count", LONG),
        ("switch_count", LONG),
        ("taken_count", LONG),
        ("taken_capacity", LONG),
        ("rejected", LONG),
        ("tolerance", DOUBLE),
        ("span", DOUBLE),
        ("order", DOUBLE),
        ("most", DOUBLE),
        ("least", DOUBLE),
        ("before", DOUBLE),
        ("first", DOUBLE),
        ("next", DOUBLE),
        ("event", DOUBLE),
        ("latest", DOUBLE),
        ("doubling", INT),
        ("arrived", INT),
    ]


class Run(ctypes.Structure):
    """Where the loop stands, and why it has returned."""

    _fields_: ClassVar = [
        ("points", POINTER),
        ("start", DOUBLE),
        ("stop", DOUBLE),
        ("step", DOUBLE),
        ("margin", DOUBLE),
        ("next_action", DOUBLE),
        ("time", DOUBLE),
        ("end", DOUBLE),
        ("size", DOUBLE),
        ("count", LONG),
        ("index", LONG),
        ("steps", LONG),
        ("within", INT),
        ("whole", INT),
        ("quiet", INT),
        ("place", INT),
        ("phase", INT),
        ("status", INT),
        ("patience", DOUBLE),
    ]
