"""A PyTorch Dataset over a dataset.h5 of mocurate (docs/store_format.md). Without torch: a sequence of the same items.

    clips = MotionClips("runs/kard/dataset.h5", frames=60, split="cross_subject", part="train")
    loader = torch.utils.data.DataLoader(clips, batch_size=32, shuffle=True, num_workers=4)
    motion, label = clips[0]        # joints (60, J, 3), metres, y up; class index, -1 without one
"""
import os
import random

import h5py
import numpy as np

try:
    from torch.utils.data import Dataset
except ImportError:
    Dataset = object


class MotionClips(Dataset):
    """Windows of `frames` frames, begun at random; a shorter clip stands still at its end. frames=None: whole clips."""

    def __init__(self, path, frames=60, split=None, part="train", field="joints"):
        self.path, self.frames, self.field, self.file, self.process = path, frames, field, None, None
        with h5py.File(path, "r") as file:
            rows = file[f"splits/{split}/{part}"][:] if split else np.arange(len(file["clips/count"]))
            self.names = file["labels/name"].asstr()[:] if "labels" in file else []
            self.clips = [tuple(int(file[f"clips/{of}"][row]) for of in ("offset", "count", "class")) for row in rows]

    def __len__(self):
        return len(self.clips)

    def __getitem__(self, index):
        if self.process != os.getpid():  # each worker opens the file itself, when it reads first
            self.file, self.process = h5py.File(self.path, "r"), os.getpid()
        offset, count, label = self.clips[index]
        frames = self.frames or count
        begin = random.randint(0, max(0, count - frames))  # workers of torch seed `random` each in its own way
        window = self.file[f"frames/{self.field}"][offset + begin : offset + min(count, begin + frames)]
        return np.concatenate([window, np.repeat(window[-1:], frames - len(window), axis=0)]), label

    def __getstate__(self):  # an open file does not travel to a worker
        return {**self.__dict__, "file": None, "process": None}
