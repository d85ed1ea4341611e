"""Bytes of hostile files, for the cases of hostile.sh. Bombs are made here, never shipped."""
import binascii
import io
import json
import struct
import zlib

import numpy as np

ESCAPES = "\x1b]0;owned\x07\x1b[2J\x9b31m\u202egnp"  # title, clear, a C1 code, text from right to left
SCRIPT = "<script>alert(1)</script>"
MIB = 1 << 20
GIB = 1 << 30
DEEP = 400_000  # levels


def zeros_deflated(count):
    """A raw deflate stream of `count` zero bytes, about 1000 times smaller. Blocks of 1 MiB are alike."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(MIB)) + packer.flush(zlib.Z_FULL_FLUSH)
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return block * (count // MIB) + packer.compress(bytes(count % MIB)) + packer.flush()


def zlib_stream(raw, count):
    """As zlib and HDF5 store it: Adler-32 of `count` zero bytes."""
    return b"\x78\xda" + raw + struct.pack(">I", (count % 65521) << 16 | 1)


def zip_file(members):
    """Members (name, stored bytes, method, bytes declared, CRC); an entry with bytes None shares those of the one before."""
    body, directory, at = b"", b"", 0
    for name, data, method, declared, crc in members:
        name = name.encode()
        if data is not None:
            at, stored = len(body), len(data)
            body += (
                struct.pack("<4sHHHHHIIIHH", b"PK\3\4", 20, 0, method, 0, 33, crc, stored, declared, len(name), 0)
                + name
                + data
            )
        directory += (
            struct.pack(
                "<4sHHHHHHIIIHHHHHII",
                b"PK\1\2",
                20,
                20,
                0,
                method,
                0,
                33,
                crc,
                stored,
                declared,
                len(name),
                0,
                0,
                0,
                0,
                0,
                at,
            )
            + name
        )
    return (
        body
        + directory
        + struct.pack("<4sHHHHIIH", b"PK\5\6", 0, 0, len(members), len(members), len(directory), len(body), 0)
    )


def stored(name, data):
    return (name, data, 0, len(data), binascii.crc32(data))


def npy(shape, data=b"", descr="'<f8'", length=None):
    header = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}".encode()
    header += b" " * (-(len(header) + 13) % 64) + b"\n"
    return b"\x93NUMPY\2\0" + struct.pack("<I", len(header) if length is None else length) + header + data


def array_bytes(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=False)
    return stream.getvalue()


def pickle_call(module, name, *arguments):
    """Protocol 2: what pickle.loads would execute."""
    out = b"\x80\2c" + module.encode() + b"\n" + name.encode() + b"\n("
    for text in arguments:
        out += b"X" + struct.pack("<I", len(text)) + text.encode()
    return out + b"tR."


def nested(opening, closing, depth=DEEP):
    return opening * depth + closing * depth


def safetensors(header, data=b"", length=None):
    header = header if isinstance(header, bytes) else json.dumps(header).encode()
    return struct.pack("<Q", len(header) if length is None else length) + header + data


def png(width, height, depth=16, rows=None):
    """A grey image of zeros."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", binascii.crc32(kind + data))

    count = (rows or height) * (1 + width * depth // 8)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib_stream(zeros_deflated(count), count))
        + chunk(b"IEND", b"")
    )


def sparse(path, size, begin=b"", end=b""):
    with open(path, "wb") as file:
        file.write(begin)
        file.truncate(size)
        file.seek(size - len(end))
        file.write(end)
    return path


DEEP_LIST = nested("[", "]")
DEEP_MAP = nested('{"a":', "}")[:-DEEP] + "1" + "}" * DEEP


def deep_variants(document):
    """Texts of a JSON document, each with another of its values nested 400,000 deep."""

    def variants(value):
        yield "@deep@"
        if isinstance(value, dict):
            for key in value:
                for other in variants(value[key]):
                    yield {**value, key: other}
            yield {**value, "more": "@deep@"}
        elif isinstance(value, list):
            for i in range(min(len(value), 2)):
                for other in variants(value[i]):
                    yield value[:i] + [other] + value[i + 1 :]

    for i, variant in enumerate(variants(document)):
        yield json.dumps(variant).replace('"@deep@"', DEEP_MAP if i % 2 else DEEP_LIST)


CAMERA = {
    "name": "00_00",
    "type": "hd",
    "resolution": [1920, 1080],
    "K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "distCoef": [0, 0, 0, 0, 0],
    "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "t": [[0], [0], [1]],
}
VIEW = {
    "R_p_to_d": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "t_m": [0, 0, 0],
    "fx_fy_cx_cy": [300, 300, 160, 120],
    "size": [320, 240],
}
LABEL = {"raw_label": "x", "proc_label": "x", "seg_id": "s", "act_cat": ["walk"], "start_t": 0.0, "end_t": 1.0}
ANNOTATION = {"babel_lid": "a", "anntr_id": "b", "mul_act": True, "labels": [LABEL]}
DOCUMENTS = {
    "openpose": {"version": 1.3, "people": [{"person_id": [-1], "pose_keypoints_2d": [1, 2, 1]}]},
    "babel": {
        "1": {
            "babel_sid": 1,
            "url": "u",
            "feat_p": "a/b/c.npz",
            "dur": 2.0,
            "seq_ann": ANNOTATION,
            "frame_ann": ANNOTATION,
        }
    },
    "panoptic": {"calibDataSource": "x", "cameras": [CAMERA]},
    "bodies": {"version": 0.7, "univTime": 1.0, "bodies": [{"id": 0, "joints19": [0.0, 1.0]}]},
    "depth": {
        "fps": 30,
        "frames": 10,
        "body": "b",
        "floor": "y",
        "views": {"a": VIEW},
        "labels": [{"action": "walk", "first": 0, "last": 5}],
    },
    "still": {"depth_unit": 0.001, "views": {"a": VIEW}},
    "label": {"content": "walk", "style": "old"},
    "camera": {"cam": {"K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [0, 0, 1]}},
}
