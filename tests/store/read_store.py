"""Prints what h5py sees in a dataset file, as JSON: read_store.py FILE DOCUMENT."""

import hashlib
import json
import re
import sys

import h5py
import numpy as np

scope = {"np": np, "hashlib": hashlib}
exec(re.search(r"```python\n(.*?)```", open(sys.argv[2], encoding="utf-8").read(), re.S).group(1), scope)

seen = {}
fields = {}
with h5py.File(sys.argv[1], "r") as file:
    for name, value in file.attrs.items():
        text = value.decode() if isinstance(value, bytes) else str(value)
        seen["/@" + name] = text
        fields["/@" + name] = ("text", text.encode())

    def visit(name, item):
        if not isinstance(item, h5py.Dataset):
            return
        values = item[()]
        if item.dtype.kind == "S":
            kind = "text"
            values = np.array(values).astype(object)
            seen["/" + name] = [text.decode() for text in values.flat]
        else:
            kind = item.dtype.kind + str(item.dtype.itemsize)
            seen["/" + name] = values.tolist()
        fields["/" + name] = (kind, values)

    file.visititems(visit)
del fields["/@content_sha256"]
seen["computed_sha256"] = scope["content_sha256"](fields)
json.dump(seen, sys.stdout)
