#!/usr/bin/env python3
"""Traces rays through lenses and writes tests/fixtures/lens/rays.json, the truth of tests/lens.rs.

An implementation of its own, in 50 decimal digits and nothing but Python: points in one frame for the whole lens, surfaces as
zeros of z - sag(x, y) found by Newton steps along the ray, normals as their gradients, Snell's law by the tangential part of
the direction, Fresnel's equations for bare surfaces.

    tools/make_lens_fixture.py
"""

import json
import tomllib
from decimal import Decimal as D
from decimal import getcontext
from pathlib import Path

getcontext().prec = 50
ROOT = Path(__file__).resolve().parent.parent
FIXTURES = ROOT / "tests" / "fixtures" / "lens"
LENSES = [
    ROOT / "data/lenses/heliar.toml",
    ROOT / "data/lenses/angenieux.toml",
    ROOT / "data/lenses/nikon.toml",
    FIXTURES / "asphere.toml",
]
GHOSTS_OF_A_LENS = 12
RAYS_OF_A_LENS = 80
SLOPES = [(D(0), D(0)), (D("0.0875"), D(0)), (D("0.21"), D(0)), (D("0.06"), D("-0.05"))]
# Of the front's clear radius.
ENTRIES = [(D("0"), D("0")), (D("0.13"), D("0.05")), (D("-0.21"), D("0.11")), (D("0.07"), D("-0.3"))]


class Lost(Exception):
    """The ray misses a surface or is reflected totally."""


def number(value):
    return D(str(value))


def read(path):
    """Surfaces in one frame: vertex z, curvature, conic, terms, index after, clear radius, is stop; and the sensor's z."""
    table = tomllib.loads(path.read_text(), parse_float=D)
    surfaces, z = [], D(0)
    for row in table["surfaces"]:
        radius = number(row.get("radius", 0))
        surfaces.append(
            {
                "z": z,
                "curvature": D(0) if radius == 0 or radius.is_infinite() else 1 / radius,
                "conic": number(row.get("conic", 0)),
                "terms": [number(term) for term in row.get("aspheric", [])],
                "index": number(row.get("n_d", 1)),
                "clear": number(row["semi_diameter"]),
                "stop": row.get("stop", False),
                "coated": "coating" in row,
            }
        )
        z += number(row["thickness"])
    return surfaces, z


def sag(surface, x, y):
    """Height over the vertex, and half its derivative by r², which times (2 x, 2 y) is the gradient."""
    c, square = surface["curvature"], x * x + y * y
    inside = 1 - (1 + surface["conic"]) * c * c * square
    if inside <= 0:
        raise Lost
    root = inside.sqrt()
    height, by_square = c * square / (1 + root), c / (2 * root)
    before = D(1)
    for power, term in enumerate(surface["terms"], start=1):
        by_square += power * term * before
        before *= square
        height += term * before
    return height, by_square


def intersection(surface, point, direction):
    """The ray's point on the surface: Newton from the vertex plane."""
    t = (surface["z"] - point[2]) / direction[2]
    for _ in range(100):
        x, y, z = (p + t * d for p, d in zip(point, direction))
        height, by_square = sag(surface, x, y)
        slope = direction[2] - 2 * by_square * (x * direction[0] + y * direction[1])
        if slope == 0:
            raise Lost
        step = (z - surface["z"] - height) / slope
        t -= step
        if abs(step) < D("1e-40"):
            return [p + t * d for p, d in zip(point, direction)]
    raise Lost


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def unit(vector):
    length = dot(vector, vector).sqrt()
    return [component / length for component in vector]


def bend(direction, normal, n1, n2, reflects):
    """The direction after a surface, and the fraction of unpolarised power that goes there."""
    cos1 = dot(direction, normal)
    if cos1 < 0:
        normal, cos1 = [-component for component in normal], -cos1
    across = [d - cos1 * n for d, n in zip(direction, normal)]
    refracted = [n1 / n2 * a for a in across]
    square = 1 - dot(refracted, refracted)
    if square < 0:
        if not reflects:
            raise Lost
        reflected_power = D(1)
    else:
        cos2 = square.sqrt()
        s = (n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2)
        p = (n2 * cos1 - n1 * cos2) / (n2 * cos1 + n1 * cos2)
        reflected_power = (s * s + p * p) / 2
    if reflects:
        return [a - cos1 * n for a, n in zip(across, normal)], reflected_power
    return [r + cos2 * n for r, n in zip(refracted, normal)], 1 - reflected_power


def trace(surfaces, sensor_z, ghost, entry, slope):
    """A ray's places in the stop and on the sensor, its largest relative height beside the stop's, and its power."""
    count = len(surfaces)
    order = [(k, True, False) for k in range(count)]
    if ghost:
        first, second = ghost
        order = [(k, True, False) for k in range(first)] + [(first, True, True)]
        order += [(k, False, False) for k in range(first - 1, second, -1)] + [(second, False, True)]
        order += [(k, True, False) for k in range(second + 1, count)]
    point, direction = [entry[0], entry[1], D(0)], unit([slope[0], slope[1], D(1)])
    stop, height, power = None, D(0), D(1)
    for k, forward, reflects in order:
        surface = surfaces[k]
        point = intersection(surface, point, direction)
        radial = (point[0] ** 2 + point[1] ** 2).sqrt() / surface["clear"]
        if surface["stop"]:
            stop = stop or point[:2]
        else:
            height = max(height, radial)
        before = surfaces[k - 1]["index"] if k else D(1)
        n1, n2 = (before, surface["index"]) if forward else (surface["index"], before)
        _, by_square = sag(surface, point[0], point[1])
        normal = unit([-2 * by_square * point[0], -2 * by_square * point[1], D(1)])
        direction, part = bend(direction, normal, n1, n2, reflects)
        power *= part
    t = (sensor_z - point[2]) / direction[2]
    sensor = [p + t * d for p, d in zip(point, direction)][:2]
    return stop, sensor, height, power


def ghosts_of(surfaces):
    """Pairs of reflecting surfaces on one side of the stop."""
    stop = next(k for k, surface in enumerate(surfaces) if surface["stop"])
    indices = [D(1)] + [surface["index"] for surface in surfaces]
    mirrors = [k for k in range(len(surfaces)) if indices[k] != indices[k + 1]]
    return [(i, j) for i in mirrors for j in mirrors if j < i and (i < stop or j > stop)]


def main():
    fixture = {"columns": "first, second (from 1; 0 = image), entry x y, slope x y, stop x y, sensor x y (mm), height, power", "lenses": []}
    for path in LENSES:
        surfaces, sensor_z = read(path)
        is_bare = not any(surface["coated"] for surface in surfaces)
        ghosts = ghosts_of(surfaces)
        # Ghosts from all parts of the lens.
        stride = max(1, len(ghosts) // GHOSTS_OF_A_LENS)
        rows = []
        for ghost in [None] + ghosts[::stride]:
            for slope in SLOPES:
                for entry in ENTRIES:
                    entry = [part * surfaces[0]["clear"] for part in entry]
                    try:
                        stop, sensor, height, power = trace(surfaces, sensor_z, ghost, entry, slope)
                    except Lost:
                        continue
                    # Beyond it a ray is lost in the barrel, and small errors grow.
                    if height > D("1.5"):
                        continue
                    values = [*entry, *slope, *stop, *sensor, height] + ([power] if is_bare else [])
                    rows.append([k + 1 for k in ghost or (-1, -1)] + [float(value) for value in values])
        gap = sensor_z - surfaces[-1]["z"]
        rows = rows[:: max(1, len(rows) // RAYS_OF_A_LENS)]
        fixture["lenses"].append({"lens": path.stem, "sensor_gap_mm": float(gap), "rays": rows})
        print(f"{path.stem}: {len(rows)} rays, {len({(row[0], row[1]) for row in rows})} paths")
    lines = json.dumps(fixture).replace("[[", "[\n[").replace("], [", "],\n[").replace("]]", "]\n]")
    (FIXTURES / "rays.json").write_text(lines + "\n")


if __name__ == "__main__":
    main()
