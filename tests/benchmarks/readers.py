#!/usr/bin/env python3
"""Reads the folders of `bench_readers FOLDER make` with NumPy, pickle, json and pure Python: readers.py FOLDER SET|all [REPEATS].

Files are in memory first, as on our side; a JSON line per set and reader. One thread."""
import os
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"
import io
import json
import math
import pickle
import statistics
import struct
import sys
import time
import numpy as np


def loadtxt(raw):
    return np.loadtxt(io.BytesIO(raw))


def loadtxt_comma(raw):
    return np.loadtxt(io.BytesIO(raw), delimiter=",")


def opensim(raw):
    return np.loadtxt(raw[raw.index(b"endheader"):].decode().splitlines()[2:])


def bvh_loadtxt(raw):
    lines = raw[raw.index(b"MOTION"):].decode("ascii", "replace").splitlines()
    return np.loadtxt(lines[3:3 + int(lines[1].split(":")[1])], ndmin=2)


def bvh_python(raw):
    """Hierarchy and motion."""
    lines = iter(raw.decode("ascii", "replace").splitlines())
    joints, stack, end = [], [], False
    for line in lines:
        words = line.split()
        if not words:
            continue
        if words[0] in ("ROOT", "JOINT"):
            joints.append([words[1], stack[-1] if stack else -1, None, None])
        elif words[0] == "OFFSET" and stack[-1] >= 0:
            joints[stack[-1]][2] = [float(v) for v in words[1:]]
        elif words[0] == "CHANNELS":
            joints[stack[-1]][3] = words[2:]
        elif words[0] == "{":
            stack.append(len(joints) - 1 if not end else -1)
        elif words[0] == "}":
            stack.pop()
        elif words[0] == "MOTION":
            break
        end = words[0] == "End"
    count = int(next(lines).split(":")[1])
    float(next(lines).split(":")[1])
    return joints, np.array([[float(v) for v in next(lines).split()] for _ in range(count)])


def c3d_python(raw):
    """Points and residuals of an Intel file: a tuple a frame, as readers in pure Python do."""
    points, analog, first, last = struct.unpack_from("<4H", raw, 2)
    scale, = struct.unpack_from("<f", raw, 12)
    start = (struct.unpack_from("<H", raw, 16)[0] - 1) * 512
    kind, size = ("f", 4) if scale < 0 else ("h", 2)
    frame = struct.Struct("<%d%s" % (4 * points + analog, kind))
    places, residuals = [], []
    for f in range(last - first + 1):
        words = frame.unpack_from(raw, start + f * frame.size)
        row, rest = [], []
        for p in range(0, 4 * points, 4):
            x, y, z, w = words[p:p + 4]
            seen = w >= 0
            row.append((x, y, z) if seen else (0.0, 0.0, 0.0))
            rest.append((int(w) & 255) * abs(scale) if seen else -1.0)
        places.append(row)
        residuals.append(rest)
    return places, residuals


def trc_python(raw):
    lines = raw.decode("latin1").splitlines()
    names = [name for name in lines[3].split("\t")[2:] if name]
    rows = []
    for line in lines[5:]:
        cells = line.split("\t")
        if len(cells) > 2:
            cells += [""] * (2 + 3 * len(names) - len(cells))
            rows.append([float(cell) if cell.strip() else math.nan for cell in cells[2:2 + 3 * len(names)]])
    return names, rows


def ntu_python(raw):
    lines = iter(raw.decode("ascii").splitlines())
    frames = []
    for _ in range(int(next(lines))):
        bodies = []
        for _ in range(int(next(lines))):
            head = next(lines).split()
            joints = [[float(v) for v in next(lines).split()] for _ in range(int(next(lines)))]
            bodies.append((int(head[0]), [float(v) for v in head[1:]], np.array(joints)))
        frames.append(bodies)
    return frames


def amc_python(raw):
    frames = []
    for line in raw.decode("ascii", "replace").splitlines():
        if not line or line[0] in "#:":
            continue
        words = line.split()
        if len(words) == 1:
            frames.append({})
        else:
            frames[-1][words[0]] = [float(v) for v in words[1:]]
    return frames


def np_load(raw):
    return np.load(io.BytesIO(raw))


def np_load_all(raw):
    archive = np.load(io.BytesIO(raw), allow_pickle=False)
    return [archive[name] for name in archive.files]


def ply_python(raw):
    end = raw.index(b"end_header\n") + 11
    counts = [int(line.split()[2]) for line in raw[:end].decode().splitlines() if line.startswith("element")]
    lines = raw[end:].decode().splitlines()
    vertices = np.array([[float(v) for v in line.split()] for line in lines[:counts[0]]])
    return vertices, np.array([[int(v) for v in line.split()[1:]] for line in lines[counts[0]:sum(counts)]])


def ply_numpy(raw):
    end = raw.index(b"end_header\n") + 11
    counts = [int(line.split()[2]) for line in raw[:end].decode().splitlines() if line.startswith("element")]
    vertices = np.frombuffer(raw, "<f4", counts[0] * 3, end).astype(float)
    faces = np.frombuffer(raw, np.dtype([("n", "u1"), ("i", "<i4", 3)]), counts[1], end + counts[0] * 12)
    return vertices, faces["i"].astype(np.int64)


TABLE = {"numpy.loadtxt": loadtxt}
READERS = {"kard": TABLE, "florence3d": TABLE, "msr_action3d": TABLE, "phspd_pose": TABLE,
           "expmap": {"numpy.loadtxt": loadtxt_comma}, "opensim": {"numpy.loadtxt": opensim},
           "bvh": {"pure Python": bvh_python, "numpy.loadtxt (motion alone)": bvh_loadtxt},
           "c3d_float": {"pure Python": c3d_python}, "trc": {"pure Python": trc_python},
           "ntu_skeleton": {"pure Python": ntu_python}, "amc": {"pure Python": amc_python},
           "npy": {"numpy.load": np_load}, "amass_npz": {"numpy.load": np_load_all},
           "humanact12_pickle": {"pickle.loads": pickle.loads}, "uestc_pickle": {"pickle.loads": pickle.loads},
           "babel_json": {"json.loads": json.loads}, "openpose_json": {"json.loads": json.loads},
           "ply_ascii": {"pure Python": ply_python}, "ply_binary": {"numpy.frombuffer": ply_numpy}}


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    repeats = int(sys.argv[3]) if len(sys.argv) > 3 else 3
    for name, readers in READERS.items():
        if sys.argv[2] not in ("all", name):
            continue
        folder = os.path.join(sys.argv[1], name)
        raws = [open(os.path.join(folder, f), "rb").read() for f in sorted(os.listdir(folder))]
        size = sum(map(len, raws)) / 1e6
        for by, read in readers.items():
            seconds = []
            for i in range(repeats + 1):
                begin = time.perf_counter()
                for raw in raws:
                    read(raw)
                seconds.append(time.perf_counter() - begin)
            median = statistics.median(seconds[1:])
            print(json.dumps({"name": "read_" + name, "by": by, "seconds_median": median, "items": size, "unit": "MB",
                              "items_per_s": size / median, "numpy": np.__version__, "threads": 1}), flush=True)


if __name__ == "__main__":
    main()
