"""Faults of files and questions, as exceptions and warnings."""

from __future__ import annotations

import warnings
from typing import Any, Iterable, NamedTuple


class Fault(NamedTuple):
    """Fault in one file: where it is, what is wrong, and what to do. Lines and columns are counted from 1.

    A fault in a setting or in a question has line 0. The field `file` then states the setting or the cell.
    """

    severity: str
    file: str
    line: int
    column: int
    message: str
    help: str
    text: str

    def __str__(self) -> str:
        return self.text


class SweetspotError(Exception):
    """Exception that carries faults. The properties (`file`, `line` and others) belong to the first fault that is
    an error."""

    faults: tuple[Fault, ...]

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__(self.faults)

    @property
    def _first(self) -> Fault:
        return next((fault for fault in self.faults if fault.severity == "error"), self.faults[0])

    @property
    def file(self) -> str:
        return self._first.file

    @property
    def line(self) -> int:
        return self._first.line

    @property
    def column(self) -> int:
        return self._first.column

    @property
    def message(self) -> str:
        return self._first.message

    @property
    def help(self) -> str:
        return self._first.help

    def __str__(self) -> str:
        return "\n".join(str(fault) for fault in self.faults)

    @classmethod
    def _of(cls, faults: Iterable[tuple[Any, ...]]) -> SweetspotError:
        return cls(_listed(faults))


class InputError(SweetspotError, ValueError):
    """Error in a cell, a robot or a question. The attribute `faults` lists all faults of all files."""


class UnreadableError(InputError):
    """Error of a cell file or a robot file that cannot be read at all."""


class NoAnswerError(SweetspotError):
    """Error of a valid question that has no answer in this layout, such as the budget at a node out of
    reach."""


class InputWarning(UserWarning):
    """Warning about a cell file or a robot file."""


def _listed(faults: Iterable[tuple[Any, ...]]) -> tuple[Fault, ...]:
    return tuple(Fault(*fault) for fault in faults)


def _warn(faults: Iterable[tuple[Any, ...]]) -> None:
    for fault in _listed(faults):
        warnings.warn(str(fault), InputWarning, stacklevel=2)
