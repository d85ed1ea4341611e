"""Writes a set of joints with h5py alone, as docs/store_format.md says: write_store.py FILE DOCUMENT [gzip]."""

import hashlib
import re
import sys

import h5py
import numpy as np

scope = {"np": np, "hashlib": hashlib}
exec(re.search(r"```python\n(.*?)```", open(sys.argv[2], encoding="utf-8").read(), re.S).group(1), scope)

F, J = 4, 3
joints = np.arange(F * J * 3, dtype="f4").reshape(F, J, 3) / 10
text = lambda *texts: ("text", np.array([t.encode() for t in texts], dtype=object))
numbers = lambda kind, values: (kind, np.array(values, dtype=kind))
fields = {
    "/@schema": ("text", b"mocurate/1"),
    "/@kinematics": ("text", b"joints"),
    "/@units": ("text", b"m s rad"),
    "/@skeleton": ("text", b"stick"),
    "/@rate": ("text", b"20"),
    "/@axes": ("text", b"+x +y +z"),
    "/@created_by": ("text", b"write_store.py"),
    "/recipe": ("text", b""),
    "/skeleton/names": text("root", "middle", "top"),
    "/skeleton/parents": numbers("i4", [-1, 0, 1]),
    "/skeleton/rest_offsets": numbers("f8", [[0, 0, 0], [0, 1, 0], [0, 1, 0]]),
    "/skeleton/mirror": numbers("i4", [0, 1, 2]),
    "/skeleton/radius": numbers("f8", [0.05] * J),
    "/skeleton/surface_point": numbers("u1", [0] * J),
    "/frames/joints": ("f4", joints),
    "/clips/id": text("made/p/a#0-3", "made/p/b#0-1"),
    "/clips/source": text("made", "made"),
    "/clips/person": text("p", "p"),
    "/clips/recording": text("a", "b"),
    "/clips/begin_frame": numbers("i4", [0, 0]),
    "/clips/end_frame": numbers("i4", [3, 1]),
    "/clips/session": text("", ""),
    "/clips/view": text("", ""),
    "/clips/licence": text("", ""),
    "/clips/role": text("", ""),
    "/clips/label": text("wave", "grüßen"),
    "/clips/class": numbers("i4", [-1, -1]),
    "/clips/rate": text("20", "20"),
    "/clips/fit_rms": numbers("f8", [0, 0]),
    "/clips/canonical_from_source": numbers("f8", [[1, 0, 0, 0, 0, 0, 0]] * 2),
    "/clips/provenance": text("{}", '{"by": "h5py"}'),
    "/clips/evidence_sha256": text("", ""),
    "/clips/offset": numbers("i8", [0, 3]),
    "/clips/count": numbers("i8", [3, 1]),
    "/clips/field_mask": numbers("u1", [0, 0]),
}
fields["/@content_sha256"] = ("text", scope["content_sha256"](fields).encode())

with h5py.File(sys.argv[1], "w") as file:
    for path, (kind, values) in fields.items():
        if path.startswith("/@"):
            file.attrs[path[2:]] = values.decode()
        elif kind == "text":
            file.create_dataset(path, data=values, dtype=h5py.string_dtype())  # variable length
        elif len(sys.argv) > 3:
            file.create_dataset(path, data=values, compression="gzip", shuffle=True, fletcher32=True)
        else:
            file.create_dataset(path, data=values)
