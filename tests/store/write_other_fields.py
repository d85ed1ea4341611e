"""Adds fields that the format does not name, of many types: write_other_fields.py FILE."""

import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1], "r+") as file:
    clips, frames = len(file["clips/id"]), len(file["frames/joints"])
    clip = np.arange(clips)
    frame = np.arange(frames)
    file["clips/checked"] = clip % 2 == 0
    file["clips/small"] = clip.astype("i2")
    file["clips/big_endian"] = clip.astype(">f8")
    file["clips/complex"] = clip + 1j
    file["clips/fixed"] = np.array([b"t%d" % i for i in clip], dtype="S7")
    file.create_dataset("clips/text", data=["grüße %d" % i for i in clip], dtype=h5py.string_dtype())
    file["clips/none"] = np.zeros((clips, 0), "f4")
    file["clips/two_rows_more"] = np.arange(clips + 2)
    file["frames/half"] = frame.astype("f2")
    file.create_dataset("frames/phase", data=["p%d" % i for i in frame], dtype=h5py.string_dtype())
    file.create_dataset("frames/table", data=frame[:, None, None] * np.ones((1, 2, 3)), compression="gzip", chunks=True)
    file["mine/deep/one"] = 7
    file["mine/text"] = "text"
    file["clips/small"].attrs["unit"] = "points"
    file["clips/small"].attrs["range"] = np.array([0, 9], "i8")
    file.attrs["doi"] = "10.1000/1"
    # What is not kept: lists of any length, a link, an attribute of a field of the format.
    file.create_dataset("clips/lists", (clips,), dtype=h5py.vlen_dtype("f4"))
    file["clips/link"] = h5py.SoftLink("/clips/small")
    file["frames/joints"].attrs["mine"] = 1
