"""Writes package/sweetspot/records.py, the typed classes of all documents, from their JSON Schemas:

    python python/make_records.py           writes the file
    python python/make_records.py --check   fails if the file does not agree with the schemas
"""

from __future__ import annotations

import json
import keyword
import sys
import textwrap
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SCHEMAS = HERE.parent / "cells" / "schemas"
TARGET = HERE / "package" / "sweetspot" / "records.py"
INPUTS = {"cell", "equipment", "robot", "tool"}

# The nodes of a map are in its table, so the record leaves them out.
LEFT_OUT = {("OperationMapEntry", "nodes")}

HEAD = '''"""Records: the typed documents of the commands. Lengths are in mm and angles in degrees, unless a name says otherwise.

Made by python/make_records.py from the JSON Schemas; do not edit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Literal, Optional

from sweetspot._record import Record, Table

if TYPE_CHECKING:
    from sweetspot._record import _Numbers
'''


class Types:
    """Python types of the definitions in all schemas."""

    def __init__(self, definitions: dict[str, Any]) -> None:
        self.definitions = definitions

    def is_record(self, name: str) -> bool:
        return "properties" in self.definitions[name]

    def of(self, schema: Any) -> tuple[str, tuple[str, str] | None]:
        """Returns the annotation of a value, and how it is read if it is not a plain value."""
        if not isinstance(schema, dict):
            return "Any", None
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            return (name, ("record", name)) if self.is_record(name) else self.of(self.definitions[name])
        for key in ("allOf", "anyOf", "oneOf"):
            if key in schema:
                return self.of_choice(schema[key])
        if "const" in schema:
            return f"Literal[{schema['const']!r}]", None
        if "enum" in schema:
            words = [word for word in schema["enum"] if word is not None]
            text = f"Literal[{', '.join(map(repr, words))}]"
            return (f"Optional[{text}]" if None in schema["enum"] else text), None
        kinds = schema.get("type")
        if isinstance(kinds, list):
            plain = [kind for kind in kinds if kind != "null"]
            annotation, how = self.of({**schema, "type": plain[0]}) if len(plain) == 1 else ("Any", None)
            return (f"Optional[{annotation}]" if "null" in kinds and annotation != "Any" else annotation), how
        if kinds == "array":
            return self.of_list(schema.get("items"))
        if kinds == "object":
            annotation, how = self.of(schema.get("additionalProperties"))
            return f"Dict[str, {annotation}]", (("named", how[1]) if how and how[0] == "record" else None)
        plain_types = {"string": "str", "integer": "int", "number": "float", "boolean": "bool"}
        return plain_types.get(str(kinds), "Any"), None

    def of_choice(self, choices: list[Any]) -> tuple[str, tuple[str, str] | None]:
        others = [choice for choice in choices if choice.get("type") != "null"]
        words = [choice["const"] for choice in others if "const" in choice]
        words += [word for choice in others if "const" not in choice for word in choice.get("enum", [])]
        if words and all("const" in choice or "enum" in choice for choice in others):
            annotation, how = f"Literal[{', '.join(map(repr, words))}]", None
        elif len(others) == 1:
            annotation, how = self.of(others[0])
        else:
            annotation, how = "Any", None
        is_optional = len(others) < len(choices) and annotation != "Any"
        return (f"Optional[{annotation}]" if is_optional else annotation), how

    def of_list(self, items: Any) -> tuple[str, tuple[str, str] | None]:
        if isinstance(items, list):
            inner = {self.of(item)[0] for item in items}
            return f"List[{'float' if inner <= {'float', 'int'} else 'Any'}]", None
        annotation, how = self.of(items)
        if annotation in ("float", "Optional[float]"):
            return "_Numbers", ("numbers", "")
        if how and how[0] == "record":
            return f"Table[{how[1]}]", ("table", how[1])
        if annotation == "_Numbers" and isinstance(items, dict) and items.get("minItems") == items.get("maxItems"):
            is_matrix = items.get("minItems") is not None
            return ("_Numbers", ("numbers", "")) if is_matrix else ("List[List[float]]", None)
        plain = annotation.replace("_Numbers", "List[float]")
        return f"List[{plain}]", None


def text_of(name: str, schema: dict[str, Any], types: Types) -> str:
    def quoted(text: str, indent: str) -> list[str]:
        text = " ".join(text.split()).replace("\\", "\\\\")
        lines = textwrap.wrap(text, 110 - len(indent))
        if len(lines) == 1:
            return [f'{indent}"""{lines[0]}"""']
        return [f'{indent}"""{lines[0]}', *(indent + line for line in lines[1:]), f'{indent}"""']

    lines = [f"class {name}(Record):"]
    lines += [*quoted(schema.get("description", f"Entry {name}."), "    "), ""]
    nested = {}
    for field, of_field in schema["properties"].items():
        if (name, field) in LEFT_OUT:
            continue
        annotation, how = types.of(of_field)
        is_optional = field not in schema.get("required", [])
        if is_optional and annotation != "Any" and not annotation.startswith("Optional["):
            annotation = f"Optional[{annotation}]"
        attribute = f"{field}_" if keyword.iskeyword(field) else field
        attribute = attribute.replace("-", "_")
        lines.append(f"    {attribute}: {annotation}")
        if isinstance(of_field, dict) and "description" in of_field:
            lines += quoted(of_field["description"], "    ")
        if how:
            nested[field] = how
    if nested:
        lines += ["", "    _nested = {"]
        lines += [f"        {field!r}: {how!r}," for field, how in nested.items()]
        lines += ["    }"]
    return "\n".join(lines) + "\n"


def records() -> str:
    definitions: dict[str, Any] = {}
    for path in sorted(SCHEMAS.glob("*.schema.json")):
        if path.name.split(".")[0] in INPUTS:
            continue
        schema = json.loads(path.read_text(encoding="utf-8"))
        for name, definition in [*schema.pop("definitions", {}).items(), (schema["title"], schema)]:
            known = definitions.setdefault(name, definition)
            if known.get("properties") != definition.get("properties"):
                sys.exit(f"two records have the name {name}: {path.name}")
    types = Types(definitions)
    names = sorted(name for name in definitions if types.is_record(name))
    return HEAD + "\n\n".join(["", *(text_of(name, definitions[name], types) for name in names)])


if __name__ == "__main__":
    made = records()
    if "--check" not in sys.argv:
        TARGET.write_text(made, encoding="utf-8")
    elif made != TARGET.read_text(encoding="utf-8"):
        sys.exit(f"{TARGET} is not what the schemas say: run python python/make_records.py")
