#!/usr/bin/env python3
"""Writes the tables of core/body/shape_offsets.cpp: how people's bones and body shapes differ.

    scripts/body_shapes.py body_cc0.h5

Shapes of the CC0 body (its eight directions, drawn at random) change bones and skin. Per capsule of
core/body/capsule_body.cpp the change of its ends and radius that the skin near it asks for is found by least squares;
bodies are brought to one size (the sum of their bones), and the principal components of bones and capsules are
written, a deviation each, millimetres. Needs numpy and h5py. The signs of components are free: run it only when the
template or the body changes, and raise the versions of the stages proportions and fitting.
"""
import re
import sys
from pathlib import Path

import h5py
import numpy as np

COMPONENTS = 5
PEOPLE = 4000
SEED = 1
CHILDREN = 0.15  # share of people
SPREAD = (-0.2, 0.5)  # of the directions heavy, thin, muscular, tall, short
TURN_PENALTY = 0.04  # m that a capsule facing another way counts as farther, as MatchPoints has it
END_RIDGE, RADIUS_RIDGE = 0.02, 0.002

ROOT = Path(__file__).resolve().parent.parent / "core" / "body"


def numbers(text):
    return np.array([float(x) for x in text.split(",")])


def template(parent_name):
    """(frame, end joint, begin offset, end offset, radius) of the left side, bones first, then the other parts."""
    source = (ROOT / "capsule_body.cpp").read_text()
    row = r"\{([^{}]*)\}, \{([^{}]*)\}, ([\d.]+)\},"
    bones = [
        (parent_name[end], end, numbers(b), numbers(e), float(r))
        for end, b, e, r in re.findall(r'\{"(\?_\w+)", ' + row, source)
    ]
    parts = [
        (frame, end, numbers(b), numbers(e), float(r))
        for frame, end, b, e, r in re.findall(r'\{"([?\w]+)", "([?\w]+)", ' + row, source)
    ]
    return bones, parts


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    with h5py.File(sys.argv[1]) as file:
        names = [n.decode() for n in file["joint_names"][:]]
        parents = file["parents"][:]
        faces = file["faces"][:]
        skin = file["v_template"][:].astype(float)
        joints = file["J_template"][:].astype(float)
        skin_directions = file["shapedirs"][:].astype(float)
        joint_directions = file["J_shapedirs"][:].astype(float)
    index = {name: i for i, name in enumerate(names)}
    corners = skin[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(skin)
    for k in range(3):
        np.add.at(normals, faces[:, k], across)
    area = np.linalg.norm(normals, axis=1)
    normals /= area[:, None]

    plain = {n.replace("left", "?"): names[p].replace("left", "?") for n, p in zip(names, parents) if p >= 0}
    bones, parts = template(plain)
    groups = bones + parts
    capsules = []  # frame, end joint, begin, end, radius, group, side
    for group, (frame, end, begin, stop, radius) in enumerate(groups):
        for side in ("left", "right") if "?" in frame else ("",):
            flip = np.array([-1, 1, 1]) if side == "right" else np.ones(3)
            a, b = index[frame.replace("?", side)], index[end.replace("?", side)]
            capsules.append((a, b, begin * flip, stop * flip, radius, group, side))

    nearest = np.full(len(skin), np.inf)
    of_vertex = np.zeros(len(skin), int)
    along = np.zeros(len(skin))
    away = np.zeros_like(skin)
    for c, (a, b, begin, stop, radius, _, _) in enumerate(capsules):
        start, axis = joints[a] + begin, joints[b] + stop - joints[a] - begin
        t = np.clip((skin - start) @ axis / max(axis @ axis, 1e-12), 0, 1)
        offset = skin - start - t[:, None] * axis
        length = np.linalg.norm(offset, axis=1)
        normal = offset / length[:, None]
        score = abs(length - radius) + TURN_PENALTY * (1 - (normal * normals).sum(1))
        closer = score < nearest
        nearest[closer], of_vertex[closer], along[closer], away[closer] = (
            score[closer], c, t[closer], normal[closer])

    def capsule_changes(skin_change, joint_change):
        changes = np.zeros((len(groups), 7))
        for group in range(len(groups)):
            rows, wanted, weights = [], [], []
            for c, (a, b, _, _, _, own, side) in enumerate(capsules):
                if own != group:
                    continue
                m = of_vertex == c
                normal, t = away[m], along[m][:, None]
                moved = (skin_change[m] * normal).sum(1)
                wanted.append(moved - ((1 - t) * (normal @ joint_change[a])[:, None]
                                       + t * (normal @ joint_change[b])[:, None])[:, 0])
                if side == "right":
                    normal = normal * [-1, 1, 1]
                rows.append(np.hstack([(1 - t) * normal, t * normal, np.ones_like(t)]))
                weights.append(area[m])
            rows, wanted, weights = np.vstack(rows), np.hstack(wanted), np.hstack(weights)
            weighted = rows * (weights / weights.sum())[:, None]
            change = np.linalg.solve(weighted.T @ rows + np.diag([END_RIDGE] * 6 + [RADIUS_RIDGE]),
                                     weighted.T @ wanted)
            if "?" not in groups[group][0]:  # the midline stays symmetric
                if groups[group][2][0] != 0.0:
                    change[:3] = 0.5 * (change[:3] + change[3:6] * [-1, 1, 1])
                    change[3:6] = change[:3] * [-1, 1, 1]
                else:
                    change[[0, 3]] = 0.0
            changes[group] = change
        return changes

    def offsets(places):
        return np.array([places[j] - places[p] if p >= 0 else np.zeros(3) for j, p in enumerate(parents)])

    def vector(bone_offsets, capsule_rows):
        return np.concatenate([bone_offsets.ravel(), capsule_rows.ravel()])

    mean = vector(offsets(joints), np.array([[*b, *e, r] for _, _, b, e, r in groups]))
    directions = np.array([vector(offsets(j), capsule_changes(s, j))
                           for s, j in zip(skin_directions, joint_directions)])

    def size(body):
        return np.linalg.norm(body[:3 * len(names)].reshape(-1, 3), axis=1).sum()

    random = np.random.default_rng(SEED)
    people = random.uniform(*SPREAD, (PEOPLE, len(directions)))
    people[:, 0] = random.uniform(-1, 1, PEOPLE)
    people[:, 1] = np.where(random.uniform(size=PEOPLE) < CHILDREN, random.uniform(0, 1, PEOPLE), 0)
    bodies = mean + people @ directions
    bodies *= (size(mean) / np.array([size(b) for b in bodies]))[:, None]
    metric = np.ones(len(mean))
    for group, (frame, *_) in enumerate(groups):
        if "?" in frame:
            first = 3 * len(names) + 7 * group
            metric[first:first + 7] = np.sqrt(2)
    _, spread, modes = np.linalg.svd((bodies - mean) * metric, full_matrices=False)
    spread /= np.sqrt(PEOPLE)
    share = (spread[:COMPONENTS] ** 2).sum() / (spread ** 2).sum()
    components = modes[:COMPONENTS] * spread[:COMPONENTS, None] / metric
    print(f"{COMPONENTS} components hold {100 * share:.1f} % of the variance", file=sys.stderr)

    def text(values):
        return "{" + ", ".join(f"{x:g}" for x in np.round(1e3 * np.asarray(values), 1) + 0.0) + "}"

    def offset_of(component, joint):
        rows = component[:3 * len(names)].reshape(-1, 3)
        if "left" in names[joint]:
            return 0.5 * (rows[joint] + rows[index[names[joint].replace("left", "right")]] * [-1, 1, 1])
        return rows[joint] * [0, 1, 1]

    def capsule_row(component, group):
        row = component[3 * len(names) + 7 * group:][:7]
        return f"{{{text(row[:3])}, {text(row[3:6])}, {round(1e3 * row[6], 1) + 0.0:g}}}"

    def lines(rows):
        return "\n".join("    " + row for row in rows)

    tables = {
        "kOffsets": [f'{{"{n.replace("left", "?")}", {{{{{", ".join(text(offset_of(c, j)) for c in components)}}}}}}},'
                     for j, n in enumerate(names) if parents[j] >= 0 and "right" not in n],
        "kBones": [f'{{{{{", ".join(capsule_row(c, g) for c in components)}}}}},' for g in range(len(bones))],
        "kParts": [f'{{{{{", ".join(capsule_row(c, g) for c in components)}}}}},'
                   for g in range(len(bones), len(groups))],
    }
    path = ROOT / "shape_offsets.cpp"
    source = path.read_text()
    for name, rows in tables.items():
        source = re.sub(rf", \d+> {name} = \{{\{{\n.*?\n\}}\}};",
                        lambda _: f", {len(rows)}> {name} = {{{{\n{lines(rows)}\n}}}};", source, flags=re.S)
    path.write_text(source)


if __name__ == "__main__":
    main()
