"""Reads what `mocurate export` wrote with numpy and pickle alone, as another program would; prints one JSON document.

read_exports.py LAYOUT FOLDER: {clip id: {"joints": numbers of frame 5, "label": ..., ...}}
read_exports.py dataset FILE EXAMPLES: items of examples/python/dataset.py
"""
import csv
import json
import pickle
import sys
from pathlib import Path

import numpy as np

FRAME = 5


def table(folder):
    with open(folder / "clips.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def npz(folder):
    clips = {}
    for row in table(folder):
        clip = np.load(folder / row["file"])
        assert str(clip["clip"]) == row["clip"] and str(clip["label"]) == row["label"]
        clips[row["clip"]] = {"joints": clip["joints"][FRAME], "poses": clip["poses"][FRAME],
                              "frames": len(clip["joints"]), "rate": float(clip["mocap_frame_rate"])}
    return clips


def humanact12(folder):
    clips = {}
    for row in table(folder):
        joints, name = np.load(folder / row["file"]), row["file"]
        assert joints.dtype == np.float64 and joints.shape[1:] == (24, 3)
        assert int(name[15:19]) - int(name[10:14]) + 1 == len(joints)
        clips[row["clip"]] = {"joints": joints[FRAME], "frames": len(joints), "coarse": name[name.find("A") + 1:][:2],
                              "person": name[:3], "part": row["split_mixed"]}
    return clips


def actor(folder):
    with open(folder / "actor.pkl", "rb") as file:
        data = pickle.load(file)
    assert data["oldposes"] == [] and len(data["poses"]) == len(data["joints3D"]) == len(data["y"])
    clips = {}
    for i, clip in enumerate(data["clips"]):
        parts = [part for part, rows in data["splits"]["mixed"].items() if i in rows]
        clips[clip] = {"joints": data["joints3D"][i][FRAME], "poses": data["poses"][i][FRAME].reshape(24, 3),
                       "frames": len(data["poses"][i]), "label": data["labels"][data["y"][i]], "part": parts[0],
                       "person": data["persons"][i], "rate": data["rate_hz"]}
    return clips


def amass_babel(folder):
    clips = {}
    babel = {}
    for part in ("train", "val", "test"):
        with open(folder / "babel_v1.0_release" / f"{part}.json", encoding="utf-8") as file:
            for sequence in json.load(file).values():
                babel[sequence["feat_p"].split("/", 1)[1]] = (part, sequence)
    for row in table(folder):
        motion = np.load(folder / row["file"])
        assert motion["poses"].shape[1] == 156 and motion["betas"].shape == (16,)
        part, sequence = babel[row["file"]]
        frames = sequence["frame_ann"]["labels"] if sequence["frame_ann"] else []
        clips[row["clip"]] = {"poses": motion["poses"][FRAME][:66].reshape(22, 3), "trans": motion["trans"][FRAME],
                              "frames": len(motion["poses"]), "rate": float(motion["mocap_framerate"]), "part": part,
                              "label": sequence["seq_ann"]["labels"][0]["proc_label"],
                              "segments": [[l["proc_label"], l["start_t"], l["end_t"], l["act_cat"]] for l in frames]}
    return clips


def csv_tables(folder):
    clips = {}
    for row in table(folder):
        numbers = np.loadtxt(folder / row["file"], delimiter=",", skiprows=1)
        with open(folder / row["file"], encoding="utf-8") as file:
            header = file.readline().strip().split(",")
        assert header[:4] == ["time_s", "pelvis_x", "pelvis_y", "pelvis_z"] and len(header) == numbers.shape[1]
        clips[row["clip"]] = {"joints": numbers[FRAME, 1:].reshape(-1, 3), "frames": len(numbers),
                              "rate": (len(numbers) - 1) / numbers[-1, 0]}
    return clips


def dataset(file, examples):
    sys.dont_write_bytecode = True  # nothing is added to the source tree
    sys.path.insert(0, str(examples))
    from dataset import MotionClips
    whole = MotionClips(file, frames=None)
    windows = MotionClips(file, frames=10, split="mixed", part="train", field="rotation")
    long = MotionClips(pickle.loads(pickle.dumps(whole)).path, frames=1000)
    return {"whole": [{"joints": whole[i][0][FRAME], "frames": len(whole[i][0]), "label": whole[i][1]}
                      for i in range(len(whole))],
            "names": list(whole.names), "windows": [list(windows[i][0].shape) for i in range(len(windows))],
            "held": bool((long[0][0][-1] == whole[0][0][-1]).all())}


if __name__ == "__main__":
    if sys.argv[1] == "dataset":
        answer = dataset(sys.argv[2], sys.argv[3])
    else:
        readers = {"npz": npz, "humanact12": humanact12, "actor": actor, "amass_babel": amass_babel, "csv": csv_tables}
        answer = readers[sys.argv[1]](Path(sys.argv[2]))
    print(json.dumps(answer, default=lambda value: value.tolist()))
