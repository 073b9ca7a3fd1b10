"""Reads Parquet files with pyarrow and compares each with map.csv: python tests/tools/read_parquet.py FILE CSV

Fails if a column, type, number or text differs."""

import csv
import sys

import pyarrow.parquet as pq

table = pq.read_table(sys.argv[1])
said = {k.decode(): v.decode() for k, v in pq.read_metadata(sys.argv[1]).metadata.items()}
print({k: v for k, v in said.items() if k.startswith("sweetspot.")})
rows = list(csv.DictReader(open(sys.argv[2], newline="")))
assert table.num_rows == len(rows), (table.num_rows, len(rows))
assert table.column_names == list(rows[0]), "other columns"
types = {}
for name in table.column_names:
    kind = str(table.schema.field(name).type)
    types[kind] = types.get(kind, 0) + 1
    for value, row in zip(table[name].to_pylist(), rows):
        text = row[name]
        if kind == "string":
            assert value == text or "'" + value == text, (name, value, text)
        elif value is None:
            assert text == "", (name, text)
        else:
            assert float(value) == float(text), (name, value, text)
print(f"{sys.argv[1]}: {table.num_rows} rows, columns {types}")
