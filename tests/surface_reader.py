# SPDX-License-Identifier: MIT
"""Reads surfaces as other programs do: for test_surface.sh.

python3 surface_reader.py MAP LABEL FILE...
    compares surfaces with the voxels of a label (0: of all) in a NIfTI of labels: whether they are
    closed, with volume and centroid of the voxels in the world, and STL normals along triangles. A
    line for each that is not.
python3 surface_reader.py FILE...
    what they hold, a line each."""
import re
import struct
import sys


def read_stl(data):
    count = struct.unpack_from("<I", data, 80)[0]
    assert len(data) == 84 + 50 * count, "length"
    places, points, triangles, aligned = {}, [], [], 0
    for i in range(count):
        row = struct.unpack_from("<12fH", data, 84 + 50 * i)
        corner = []
        for k in range(3):
            place = row[3 + 3 * k:6 + 3 * k]
            if place not in places:
                places[place] = len(points)
                points.append(place)
            corner.append(places[place])
        triangles.append(tuple(corner))
        normal = cross(*(points[c] for c in corner))
        length = sum(x * x for x in normal) ** 0.5
        given = row[:3]
        assert length == 0 or abs(sum(x * x for x in given) - 1) < 0.001, "normal"
        aligned += length == 0 or sum(x * y for x, y in zip(normal, given)) > 0.999 * length
    return points, triangles, set(), aligned / count


def read_ply(data):
    head, body = data.split(b"end_header\n", 1)
    assert head.startswith(b"ply\nformat binary_little_endian 1.0\n")
    vertices = int(re.search(rb"element vertex (\d+)", head).group(1))
    faces = int(re.search(rb"element face (\d+)", head).group(1))
    points, colours, triangles = [], set(), []
    for i in range(vertices):
        row = struct.unpack_from("<3f3B", body, 15 * i)
        points.append(row[:3])
        colours.add(row[3:])
    for i in range(faces):
        row = struct.unpack_from("<B3i", body, 15 * vertices + 13 * i)
        assert row[0] == 3
        triangles.append(row[1:])
    assert len(body) == 15 * vertices + 13 * faces, "length"
    return points, triangles, colours, 1


def read_obj(data):
    points, colours, triangles = [], set(), []
    for line in data.decode().splitlines():
        word = line.split()
        if word[0] == "v":
            points.append(tuple(struct.unpack("<3f", struct.pack("<3f", *map(float, word[1:4])))))
            colours.add(tuple(round(255 * float(w)) for w in word[4:]))
        elif word[0] == "f":
            triangles.append(tuple(int(w) - 1 for w in word[1:]))
    return points, triangles, colours, 1


def read_vtp(data):
    head, rest = data.split(b'<AppendedData encoding="raw">\n_', 1)
    array = {}
    for kind, name, parts, offset in re.findall(
            rb'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d)" format="appended" '
            rb'offset="(\d+)"', head):
        at = int(offset)
        length = struct.unpack_from("<Q", rest, at)[0]
        letter = {b"Float32": "f", b"UInt8": "B", b"Int64": "q"}[kind]
        each = struct.calcsize("<" + letter)
        flat = struct.unpack_from("<%d%s" % (length // each, letter), rest, at + 8)
        step = int(parts)
        array[name] = [flat[i:i + step] for i in range(0, len(flat), step)]
    corners = [c for (c,) in array[b"connectivity"]]
    ends = [e for (e,) in array[b"offsets"]]
    assert ends == list(range(3, 3 * len(ends) + 1, 3)), "offsets"
    assert len(array[b"label"]) == len(array[b"Points"])
    triangles = [tuple(corners[i:i + 3]) for i in range(0, len(corners), 3)]
    return array[b"Points"], triangles, set(array[b"colour"]), 1


def cross(a, b, c):
    u = [b[i] - a[i] for i in range(3)]
    v = [c[i] - a[i] for i in range(3)]
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def dot(u, v):
    return sum(x * y for x, y in zip(u, v))


class Facts:
    def __init__(self, points, triangles, colours, aligned):
        edges = {}
        self.points, self.triangles = len(points), len(triangles)
        self.colours, self.aligned = colours, aligned
        self.volume, moment = 0.0, [0.0, 0.0, 0.0]
        for t in triangles:
            for k in range(3):
                edge = (t[k], t[(k + 1) % 3])
                edges[edge] = edges.get(edge, 0) + 1
            a, b, c = (points[i] for i in t)
            part = dot(a, cross((0, 0, 0), b, c)) / 6
            self.volume += part
            for i in range(3):
                moment[i] += part * (a[i] + b[i] + c[i]) / 4
        self.open = sum(1 for (u, v), n in edges.items() if n != 1 or edges.get((v, u)) != 1)
        self.centroid = [x / self.volume for x in moment]

    def __str__(self):
        shown = " ".join("#%02x%02x%02x" % c for c in sorted(self.colours))
        return "points %d triangles %d open %d volume %.2f centroid %s aligned %g colours %s" % (
            self.points, self.triangles, self.open, self.volume,
            ",".join("%.2f" % x for x in self.centroid), self.aligned, shown)

    def fits(self, volume, centroid):
        return (self.open == 0 and self.aligned == 1 and abs(self.volume / volume - 1) < 0.01
                and sum((x - y) ** 2 for x, y in zip(self.centroid, centroid)) < 0.01)


def voxels(name, wanted):
    """Volume in mm3 and centroid in mm of a label."""
    with open(name, "rb") as f:
        data = f.read()
    nx, ny, _ = struct.unpack_from("<3h", data, 42)
    rows = [struct.unpack_from("<4f", data, 280 + 16 * a) for a in range(3)]
    count, sums = 0, [0, 0, 0]
    for i, label in enumerate(data[int(struct.unpack_from("<f", data, 108)[0]):]):
        if label and wanted in (0, label):
            count += 1
            for a, x in enumerate((i % nx, i // nx % ny, i // nx // ny)):
                sums[a] += x
    volume = count * abs(dot(rows[0], cross((0, 0, 0), rows[1], rows[2])))
    return volume, [dot(r, [s / count for s in sums]) + r[3] for r in rows]


READERS = {"stl": read_stl, "ply": read_ply, "obj": read_obj, "vtp": read_vtp}


def facts(name):
    with open(name, "rb") as f:
        return Facts(*READERS[name[-3:]](f.read()))


if sys.argv[1].endswith(".nii"):
    expected = voxels(sys.argv[1], int(sys.argv[2]))
    for name in sys.argv[3:]:
        found = facts(name)
        if not found.fits(*expected):
            print(name, found, "expected", expected)
else:
    for name in sys.argv[1:]:
        print(facts(name))
