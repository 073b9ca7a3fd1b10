"""Audits DXF files with ezdxf: python tests/tools/audit_dxf.py FILE...

Prints layers, entity counts and extents. Fails if the audit reports an error or a repair, if two entities
share a handle, or if an entity is on an undefined layer."""

import collections
import sys

import ezdxf
from ezdxf import bbox
from ezdxf.acis import api as acis


def area(points):
    return sum(a.x * b.y - a.y * b.x for a, b in zip(points, points[1:] + points[:1])) / 2


def regions(model):
    """Returns whether the faces of all REGION entities enclose as much as the outlines on their layer.

    An outline around a part counts, and an outline around a hole counts negatively."""
    loops = []
    for region in model.query("REGION"):
        for body in acis.load_dxf(region):
            for face in body.lump.shell.faces():
                for loop in face.loops():
                    starts = [coedge.edge.start_vertex.point.location for coedge in loop.coedges()]
                    loops.append(area(starts))
    outlines = [area(list(line.vertices_in_wcs())) for line in model.query("LWPOLYLINE[layer=='REGION']")]
    print(f"  REGION: {len(loops)} loops, {sum(loops) / 1e6:.6f} m2; {len(outlines)} outlines")
    same = zip(sorted(map(abs, loops)), sorted(map(abs, outlines)))
    return len(loops) == len(outlines) and all(abs(a - b) <= 1e-9 * b for a, b in same)


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
    sound = regions(model)
    return sound and not auditor.errors and not auditor.fixes and not twice and not unknown


sys.exit(0 if all([audit(path) for path in sys.argv[1:]]) else 1)
