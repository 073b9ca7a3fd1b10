"""Audits DXF files with ezdxf: python tests/tools/audit_dxf.py FILE...

Prints layers, entity counts and extents. Fails if the audit reports an error or a repair, if two entities
share a handle, or if an entity is on an undefined layer."""

import collections
import sys

import ezdxf
from ezdxf import bbox


def audit(path):
    pairs = open(path, encoding="ascii").read().split("\n")
    handles = collections.Counter(
        value.strip() for code, value in zip(pairs[0::2], pairs[1::2]) if code.strip() in ("5", "105")
    )
    # $HANDSEED, which is also a code 5, is the next handle and belongs to no entity yet.
    twice = [handle for handle, count in handles.items() if count > 1]
    document = ezdxf.readfile(path)
    auditor = document.audit()
    for fault in auditor.errors + auditor.fixes:
        print("  fault:", fault.message)
    model = document.modelspace()
    counts = collections.Counter((entity.dxf.layer, entity.dxftype()) for entity in model)
    print(f"{path}: {document.dxfversion}, units {document.units}, {len(model)} entities")
    for layer in document.layers:
        kinds = {kind: n for (name, kind), n in counts.items() if name == layer.dxf.name}
        print(f"  {layer.dxf.name:12} colour {layer.dxf.color:3} {kinds}")
    box = bbox.extents(model, fast=True)
    print("  extents", [round(v, 1) for v in box.extmin], [round(v, 1) for v in box.extmax])
    unknown = {layer for layer, _ in counts} - {layer.dxf.name for layer in document.layers}
    return not auditor.errors and not auditor.fixes and not twice and not unknown


sys.exit(0 if all([audit(path) for path in sys.argv[1:]]) else 1)
