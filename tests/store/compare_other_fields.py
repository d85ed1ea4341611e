"""Prints the fields of the first file that differ in the second: compare_other_fields.py FILE OTHER PATH..."""

import sys

import h5py
import numpy as np


def same(a, b):
    kind = lambda x: "text" if x.dtype.kind in "SO" else x.dtype
    return kind(a) == kind(b) and a.shape == b.shape and np.array_equal(a[()], b[()])


with h5py.File(sys.argv[1]) as one, h5py.File(sys.argv[2]) as other:
    for path in sys.argv[3:]:
        if path not in other or not same(one[path], other[path]):
            print(path, "differs")
            continue
        if h5py.check_enum_dtype(one[path].dtype) != h5py.check_enum_dtype(other[path].dtype):
            print(path, "is of another type")
        for name, value in one[path].attrs.items():
            if not np.array_equal(value, other[path].attrs.get(name)):
                print(path, name, "differs")
    if one.attrs["doi"] != other.attrs["doi"]:
        print("doi differs")
