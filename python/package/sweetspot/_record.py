"""Base of all records: reading JSON, comparison, display, and tables for data frames."""

from __future__ import annotations

import json
import keyword
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Iterator, Sequence, TypeVar, overload

if TYPE_CHECKING:
    from typing_extensions import Self

    import numpy as np
    import numpy.typing as npt

    # numpy is imported when the first array is read.
    _Numbers = npt.NDArray[np.float64]

Row = TypeVar("Row", bound="Record", covariant=True)


class Record:
    """Record of the library with typed fields. A record is immutable."""

    # Fields that are not plain values. The pair states how `_read` reads the field, and names the class of
    # the field.
    _nested: ClassVar[dict[str, tuple[str, str]]] = {}
    _data: dict[str, Any]

    def __init__(self, data: dict[str, Any]) -> None:
        self._data = data
        for name, value in data.items():
            how = self._nested.get(name)
            setattr(self, _attribute(name), value if how is None or value is None else _read(value, *how))
        # A field that the document leaves out is None.
        for name in type(self).__annotations__:
            if name not in self.__dict__ and not name.startswith("_"):
                setattr(self, name, None)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Reads the record from the JSON text of a document."""
        return cls(json.loads(text))

    def to_dict(self) -> dict[str, Any]:
        """Returns the record as the JSON object of the document."""
        return json.loads(json.dumps(self._data))  # type: ignore[no-any-return]

    def to_json(self) -> str:
        """Returns the record as JSON text."""
        return json.dumps(self._data)

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self._data == other._data

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[Self], tuple[dict[str, Any]]]:
        return type(self), (self._data,)

    def __repr__(self) -> str:
        def shown(value: Any) -> str:
            text = repr(value)
            return text if len(text) <= 60 else f"{text[:57]}..."

        fields = ", ".join(f"{name}={shown(value)}" for name, value in self._data.items())
        return f"{type(self).__name__}({fields})"


class Table(Generic[Row]):
    """Rows of one kind. Data frames read a table directly: `polars.DataFrame(table)`, `pyarrow.table(table)`.

    The name of a column from a nested record is its path, such as `before.rms_mm`. Nested tables are left out.
    """

    # This class is not a subclass of Sequence, because polars would then not use the Arrow stream.

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = tuple(rows)

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> Table[Row]: ...
    def __getitem__(self, index: int | slice) -> Row | Table[Row]:
        return Table(self._rows[index]) if isinstance(index, slice) else self._rows[index]

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self._rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self._rows == other._rows

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Table({list(self._rows)!r})"

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        from sweetspot._native import arrow_stream

        rows = [dict(_flat(row._data)) for row in self._rows]
        names = list(dict.fromkeys(name for row in rows for name in row))
        columns = [[row.get(name) for row in rows] for name in names]
        kept = [(name, column) for name, column in zip(names, columns) if _is_column(column)]
        return arrow_stream([name for name, _ in kept], [column for _, column in kept])


def _attribute(name: str) -> str:
    name = name.replace("-", "_")
    return f"{name}_" if keyword.iskeyword(name) else name


def _read(value: Any, how: str, name: str) -> Any:
    if how == "numbers":
        import numpy

        return numpy.array(value, dtype=numpy.float64)
    from sweetspot import records

    cls = getattr(records, name)
    if how == "table":
        return Table([cls(row) for row in value])
    if how == "named":
        return {key: cls(entry) for key, entry in value.items()}
    return cls(value)


def _flat(data: dict[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in data.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{path}{name}.")
        else:
            yield f"{path}{name}", value


def _is_column(values: list[Any]) -> bool:
    def is_cell(value: Any) -> bool:
        is_list = isinstance(value, list) and all(isinstance(v, (int, float)) for v in value)
        return value is None or isinstance(value, (str, int, float)) or is_list

    return all(is_cell(value) for value in values)
