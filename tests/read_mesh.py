"""Says what other programs see in mesh files: READER FILE ... -> one JSON object per pair, in a list.

READER is meshio or gmsh. Names are those of the physical groups, or the part's number where a format has no names.
Volumes are signed: a cell that is turned inside out counts as negative.
"""

import json
import sys
from collections import Counter, defaultdict


def signed_volume(a, b, c, d):
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, d))
    cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return sum(x * y for x, y in zip(cross, w)) / 6


class Seen:
    def __init__(self, points):
        self.points = points
        self.cells = {3: Counter(), 4: Counter()}
        self.volumes = defaultdict(float)
        self.fields = {}

    def add(self, name, corners):
        self.cells[len(corners)][str(name)] += 1
        if len(corners) == 4:
            self.volumes[str(name)] += signed_volume(*(self.points[i] for i in corners))

    def result(self):
        return {
            "points": len(self.points),
            "triangles": self.cells[3],
            "tets": self.cells[4],
            "volumes": self.volumes,
            "fields": self.fields,
        }


def with_meshio(path):
    import meshio

    mesh = meshio.read(path)
    seen = Seen(mesh.points.tolist())
    names = {(int(dim), int(tag)): name for name, (tag, dim) in mesh.field_data.items()}
    keys = ("gmsh:physical", "nastran:ref", "region")
    tags = next(mesh.cell_data[key] for key in keys if key in mesh.cell_data)
    for block, block_tags in zip(mesh.cells, tags):
        dim = {"triangle": 2, "tetra": 3}[block.type]
        for corners, tag in zip(block.data.tolist(), block_tags.tolist()):
            seen.add(names.get((dim, int(tag)), int(tag)), corners)
    for key, blocks in mesh.cell_data.items():
        if key not in keys:
            seen.fields[key] = [value for block in blocks for value in block.tolist()]
    return seen.result()


def with_gmsh(path):
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = {int(tag): coordinates[3 * i : 3 * i + 3].tolist() for i, tag in enumerate(tags)}
    seen = Seen(points)
    for dim, entity in gmsh.model.getEntities():
        physical = gmsh.model.getPhysicalGroupsForEntity(dim, entity)
        assert len(physical) <= 1, f"entity {dim}, {entity} is in {len(physical)} groups"
        name = gmsh.model.getPhysicalName(dim, physical[0]) if len(physical) else ""
        for kind, _, nodes in zip(*gmsh.model.mesh.getElements(dim, entity)):
            corners = {2: 3, 4: 4}[int(kind)]
            for i in range(0, len(nodes), corners):
                seen.add(name or entity, [int(n) for n in nodes[i : i + corners]])
    gmsh.finalize()
    return seen.result()


READERS = {"meshio": with_meshio, "gmsh": with_gmsh}

if __name__ == "__main__":
    pairs = zip(sys.argv[1::2], sys.argv[2::2])
    json.dump([READERS[reader](path) for reader, path in pairs], sys.stdout)
