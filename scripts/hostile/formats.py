"""Cases of hostile.sh: files of captures, bodies and cameras. Expectations come before any run."""
import json
import os
import random
import shutil
import socket
import struct
import zlib

import numpy as np

from bombs import *
from lab import ANY, READ, READ_OR_REFUSED, REAL_OR_FAKE, REFUSED, bvh_text, case, inspected, job_text

# --- files of captures -------------------------------------------------------------------------------------------------------


def flat_bvh(joints, rows, channels="CHANNELS 0"):
    body = b"".join(
        b"JOINT j%d\n{\nOFFSET 0 1 0\n%s\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n" % (i, channels.encode())
        for i in range(joints)
    )
    head = (
        b"HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
        + body
        + b"}\n"
    )
    return head + b"MOTION\nFrames: %d\nFrame Time: 0.033\n" % rows + b"0 0 0 0 0 0\n" * rows


@case("B1-joints", "BVH of 20,000 joints without channels and 20,000 rows", REFUSED)
def _(box):
    box.write("x.bvh", flat_bvh(20_000, 20_000))
    box.job()
    box.call("inspect", "x.bvh")
    box.call("export", "x.bvh", "--source", "job.yaml", "--layout", "bvh", "-o", box.out / "e")


@case("B1-folder", "six such files in a source", {0, 1, 3})
def _(box):
    box.job()
    for name in ("run_p1", "sit_p1"):
        (box.input / "bvhs" / f"{name}.bvh").write_bytes(flat_bvh(20_000, 20_000))
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")
    box.call("inspect", "bvhs")


inspected(
    "bvh-one-line",
    "a million joints in one line",
    REFUSED,
    "x.bvh",
    lambda box: b"HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 0 "
    + b"JOINT a { OFFSET 0 0 0 CHANNELS 0 End Site { OFFSET 0 0 0 } } " * 1_000_000
    + b"}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n",
)
inspected(
    "bvh-deep",
    "joints nested 100,000 deep",
    REFUSED,
    "x.bvh",
    lambda box: b"HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 0\n"
    + b"JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 0\n" * 100_000
    + b"}" * 100_001
    + b"\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n",
)
inspected(
    "bvh-frames",
    "Frames: 10^9",
    READ_OR_REFUSED,
    "x.bvh",
    lambda box: bvh_text().replace("Frames: 60", "Frames: 1000000000"),
)
inspected(
    "bvh-frames-wrap",
    "Frames: 2^64 + 1",
    REFUSED,
    "x.bvh",
    lambda box: bvh_text().replace("Frames: 60", f"Frames: {2**64 + 1}"),
)
inspected("bvh-time", "Frame Time: 1e-300", REFUSED, "x.bvh", lambda box: bvh_text().replace("0.0333333", "1e-300"))
inspected(
    "bvh-channels",
    "CHANNELS 2^31",
    REFUSED,
    "x.bvh",
    lambda box: bvh_text().replace("CHANNELS 3", "CHANNELS 2147483648"),
)
inspected(
    "bvh-long-row",
    "a row of 4 million numbers",
    READ_OR_REFUSED,
    "x.bvh",
    lambda box: bvh_text() + "1 " * 4_000_000 + "\n",
)
inspected(
    "bvh-names",
    "a joint's name of 4 MB, 5,000 joints of one name",
    READ_OR_REFUSED,
    "x.bvh",
    lambda box: flat_bvh(5000, 3)
    .replace(b"JOINT j1\n", b"JOINT " + b"n" * 4_000_000 + b"\n")
    .replace(b"JOINT j2", b"JOINT j"),
)
inspected(
    "asf-cycle",
    "an ASF hierarchy with a cycle",
    REFUSED,
    "x.asf",
    lambda box: ":version 1.10\n:name x\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n:documentation\n x\n:root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n"
    "  position 0 0 0\n  orientation 0 0 0\n:bonedata\n"
    + "".join(
        f"  begin\n   id {i}\n   name {n}\n   direction 0 1 0\n   length 1\n   axis 0 0 0 XYZ\n  end\n"
        for i, n in enumerate("abc", 1)
    )
    + ":hierarchy\n  begin\n    root a\n    a b\n    b c\n    c a\n  end\n",
)
inspected(
    "asf-bones",
    "an ASF of 100,000 bones in one chain",
    REFUSED | READ,
    "x.asf",
    lambda box: ":version 1.10\n:name x\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n:root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n  position 0 0 0\n"
    "  orientation 0 0 0\n:bonedata\n"
    + "".join(
        f"  begin\n   id {i}\n   name b{i}\n   direction 0 1 0\n   length 1\n   axis 0 0 0 XYZ\n  end\n"
        for i in range(100_000)
    )
    + ":hierarchy\n  begin\n    root b0\n"
    + "".join(f"    b{i} b{i+1}\n" for i in range(99_999))
    + "  end\n",
)
inspected(
    "amc-frames",
    "an AMC whose frame numbers jump to 2^31",
    READ_OR_REFUSED,
    "x.amc",
    lambda box: ":FULLY-SPECIFIED\n:DEGREES\n"
    + "".join(f"{n}\nroot 0 0 0 0 0 0\nlowerback 1 2 3\n" for n in (1, 2, 2147483647, 4294967296, 9 * 10**18)),
)
inspected(
    "ntu-counts",
    "an NTU skeleton of 10^9 frames, bodies and joints",
    REFUSED,
    "S001C001P001R001A001.skeleton",
    lambda box: "1000000000\n1000000000\n72057594037935671 0 1 1 1 1 0 0.1 0.2 2\n2000000000\n"
    + "0.1 0.2 0.3 1 2 3 4 0 0 0 1 2\n" * 25,
)
inspected(
    "ntu-empty",
    "an NTU skeleton of 10^7 frames without a body",
    READ_OR_REFUSED,
    "S001C001P001R001A001.skeleton",
    lambda box: "10000000\n" + "0\n" * 10_000_000,
)
inspected(
    "table-columns",
    "a table of a million columns",
    READ_OR_REFUSED,
    "x.csv",
    lambda box: (",".join(["1.5"] * 1_000_000) + "\n") * 3,
)
inspected(
    "table-times",
    "a table whose times reach 1e308",
    READ_OR_REFUSED,
    "x.csv",
    lambda box: "time,a_x,a_y,a_z\n"
    + "".join(f"{t},1,2,3\n" for t in ("0", "1e-300", "1", "1e308", "-1e308", "nan", "1e999")),
)
inspected(
    "table-one-line", "a table of 64 MB in one line", READ_OR_REFUSED, "x.txt", lambda box: b"1.25 " * (64 * MIB // 5)
)
inspected(
    "table-long-number",
    "a number of 32 MB",
    READ_OR_REFUSED,
    "x.txt",
    lambda box: b"1 2 3\n" + b"1" * 32 * MIB + b" 2 3\n",
)


@case("table-laid-out", "times of 10^9 s by which frames are laid out", {0, 1, 2, 3})
def _(box):
    text = (
        job_text()
        .replace("format: bvh", "format: joint_table")
        .replace(".bvh", ".txt")
        .replace("bvhs", "tables")
        .replace("units: cm", "units: m")
    )
    text += (
        "    layout: 'time_s 13*(x y z)'\n    joints: ["
        + ", ".join(f"j{i}" for i in range(13))
        + "]\n    rate: 1000 Hz\n"
    )
    box.write("job.yaml", text)
    row = " ".join(["0.5"] * 39)
    box.write("tables/run_p1.txt", "".join(f"{t} {row}\n" for t in ("0", "0.001", "0.002", "1000000000", "1e15")))
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


inspected(
    "S1-ply-elements",
    "a PLY of 300,000 elements",
    REFUSED,
    "x.ply",
    lambda box: "ply\nformat ascii 1.0\n"
    + "".join(f"element e{i} 0\nproperty float x\n" for i in range(300_000))
    + "end_header\n",
)
inspected(
    "ply-list",
    "a PLY list of 2^31 entries",
    REFUSED,
    "x.ply",
    lambda box: b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1000000000\nproperty list uint int vertex_indices\nend_header\n"
    + bytes(12)
    + struct.pack("<I", 2**31)
    + bytes(100),
)
inspected(
    "ply-vertices",
    "a PLY of 10^12 vertices",
    REFUSED,
    "x.ply",
    lambda box: b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    + bytes(120),
)
inspected(
    "ply-empty",
    "a PLY of 10^9 elements without properties",
    READ_OR_REFUSED,
    "x.ply",
    lambda box: b"ply\nformat ascii 1.0\nelement vertex 1000000000\nelement e 1000000000\nend_header\n",
)


def pcd(width, height, points, data, kind="ascii", fields="x y z", size="4 4 4", types="F F F", count="1 1 1"):
    return (
        f"# .PCD v0.7\nVERSION 0.7\nFIELDS {fields}\nSIZE {size}\nTYPE {types}\nCOUNT {count}\nWIDTH {width}\nHEIGHT {height}\n"
        f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {kind}\n"
    ).encode() + data


def lzf_zeros(count):
    """LZF: a literal zero, then copies of 264 bytes from one byte before."""
    copies = (count - 1) // 264
    return b"\0\0" + b"\xe0\xff\0" * copies


inspected(
    "S1-pcd-lzf",
    "a PCD whose LZF block unpacks to 1.1 GB",
    READ_OR_REFUSED,
    "x.pcd",
    lambda box: (
        lambda block, n: pcd(n // 12, 1, n // 12, struct.pack("<II", len(block), n) + block, "binary_compressed")
    )(lzf_zeros(1100 * MIB // 264 * 264 + 1), (1100 * MIB // 264 * 264 + 1) // 12 * 12),
)
inspected("pcd-negative", "a PCD of negative width", REFUSED, "x.pcd", lambda box: pcd(-1, -1, 1, b"0 0 0\n"))
inspected(
    "pcd-wrap",
    "a PCD of 2^33 x 2^33 points",
    REFUSED,
    "x.pcd",
    lambda box: pcd(2**33, 2**33, 2**64, bytes(120), "binary"),
)
inspected(
    "pcd-count",
    "a PCD with a field of 2^31 numbers",
    REFUSED,
    "x.pcd",
    lambda box: pcd(1, 1, 1, bytes(120), "binary", count="1 1 2147483647"),
)
inspected(
    "pcd-block",
    "a PCD whose block declares 4 GB",
    REFUSED,
    "x.pcd",
    lambda box: pcd(357913941, 1, 357913941, struct.pack("<II", 20, 2**32 - 4) + bytes(20), "binary_compressed"),
)
inspected("png-large", "a PNG of 60,000 x 60,000", ANY, "x.png", lambda box: png(60_000, 60_000, rows=2000))
inspected("png-flat", "a PNG of 60,000 x 1", ANY, "x.png", lambda box: png(60_000, 1))

inspected(
    "S1-npz-bomb",
    "an npz whose member unpacks to 2 GB",
    REFUSED,
    "x.npz",
    lambda box: zip_file([("poses.npy", zeros_deflated(2048 * MIB), 8, 2048 * MIB - 1, 1)]),
)
inspected(
    "zip-many-bombs",
    "an npz of 1000 members of 100 MB that share their bytes",
    REFUSED,
    "x.npz",
    lambda box: zip_file(
        [("a.npy", (lambda h: raw_head(h, 100 * MIB))(npy("(%d,)" % (100 * MIB // 8))), 8, 100 * MIB, 1)]
        + [(f"a{i}.npy", None, 8, 100 * MIB, 1) for i in range(1000)]
    ),
)


def raw_head(head, count):
    """A deflate stream of `head`, then `count` zero bytes."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return packer.compress(head) + packer.flush(zlib.Z_FULL_FLUSH) + zeros_deflated(count)


@case(
    "zip-names",
    "an npz whose members are named ../x, /x, with a zero byte, twice, with 60,000 letters",
    READ_OR_REFUSED,
)
def _(box):
    data = array_bytes(np.zeros((5, 24, 3)))
    for name in ("../../outside/x.npy", "/tmp/x.npy", "a\0b.npy", "x" * 60_000 + ".npy", "poses.npy/../../x.npy"):
        box.write("x.npz", zip_file([stored(name, data)]))
        box.call("inspect", "x.npz")
    box.write("x.npz", zip_file([stored("joints.npy", data)] * 2))
    box.call("inspect", "x.npz")


inspected(
    "zip-64",
    "zip64 with 2^63 entries and offsets",
    REFUSED,
    "x.npz",
    lambda box: b"PK\3\4"
    + bytes(60)
    + struct.pack("<4sQHHIIQQQQ", b"PK\6\6", 44, 45, 45, 0, 0, 2**63, 2**63, 2**63, 2**62)
    + struct.pack("<4sIQI", b"PK\6\7", 0, 64, 1)
    + struct.pack("<4sHHHHIIH", b"PK\5\6", 0, 0, 65535, 65535, 2**32 - 1, 2**32 - 1, 0),
)
inspected(
    "zip-members",
    "an npz of 65,000 empty members",
    READ_OR_REFUSED,
    "x.npz",
    lambda box: zip_file([stored(f"m{i}.npy", b"") for i in range(65_000)]),
)
inspected(
    "zip-entry-4g",
    "an entry that declares 2^32 - 2 bytes and has 10",
    REFUSED,
    "x.npz",
    lambda box: zip_file([("poses.npy", b"0123456789", 0, 2**32 - 2, 1)]),
)

for label, shape, content in (
    ("huge", "(4611686018427387904,)", b""),
    ("wrap", "(4294967296, 4294967296, 3)", b""),
    ("negative", "(-1, -3)", bytes(24)),
    ("zero", "(1099511627776, 0, 3)", b""),
    ("axes", "(" + "1, " * 100_000 + ")", bytes(8)),
    ("nested", "(" * 100_000, b""),
):
    inspected(
        f"npy-{label}", f"an npy of shape {shape[:30]}", REFUSED, "x.npy", lambda box, s=shape, c=content: npy(s, c)
    )
inspected(
    "npy-header",
    "an npy whose header is 4 GB long",
    REFUSED,
    "x.npy",
    lambda box: npy("(2, 3)", bytes(48), length=2**32 - 1),
)
inspected(
    "npy-object",
    "an npy of objects: os.system",
    REFUSED,
    "x.npy",
    lambda box: npy("(1,)", pickle_call("os", "system", "touch PWN"), "'|O'"),
)
inspected(
    "npy-record",
    "an npy of nested records",
    REFUSED,
    "x.npy",
    lambda box: npy("(1,)", bytes(80), "[('a', " * 5000 + "'<f8'" + ")]" * 5000),
)
inspected(
    "npy-text",
    "an npy of texts of 2^31 characters",
    REFUSED,
    "x.npy",
    lambda box: npy("(3,)", bytes(80), "'<U2147483647'"),
)


@case("eval-arrays", "hostile arrays as generated motions", REFUSED)
def _(box):
    box.write("labels.csv", "name,label\na,run\n")
    for at, content in enumerate(
        (
            npy("(1099511627776, 60, 24, 3)"),
            npy("(1, 60, 24, 3)", pickle_call("os", "system", "touch PWN"), "'|O'"),
            npy("()", pickle_call("posix", "system", "touch PWN"), "'|O'"),
            npy("(60, 0, 3)"),
            npy("()", bytes(8)),
        )
    ):
        box.write("results.npy", content)
        box.call(
            "survey",
            "make",
            *REAL_OR_FAKE,
            "--motions",
            "real=results.npy",
            "--motions",
            "b=results.npy",
            "--labels",
            "labels.csv",
            "--extractor",
            "a2m-humanact12",
            "-o",
            box.out / f"s{at}",
        )


PICKLES = {
    "system": lambda: pickle_call("os", "system", "touch PWN"),
    "posix": lambda: pickle_call("posix", "system", "touch PWN"),
    "eval": lambda: pickle_call("builtins", "eval", "__import__('os').system('touch PWN')"),
    "getattr": lambda: pickle_call("builtins", "getattr", "x", "__class__"),
    "numpy-load": lambda: pickle_call("numpy", "load", "x.npy"),
    "runstring": lambda: pickle_call(
        "numpy.testing._private.utils", "runstring", "import os; os.system('touch PWN')", ""
    ),
    "inst": lambda: b"(S'touch PWN'\nios\nsystem\n.",
    "obj": lambda: b"\x80\2(cos\nsystem\nX\x09\0\0\0touch PWNo.",
    "stack-global": lambda: b"\x80\4\x8c\5posix\x8c\6system\x93\x8c\x09touch PWN\x85R.",
    "build": lambda: b"\x80\2cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\nK\0\x85C\1btR(K\1J\xff\xff\xff\x7f\x85cnumpy\ndtype\nX\2\0\0\0f8\x85R\x89C\0tb.",
    "reduce-shape": lambda: b"\x80\2cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n\x8a\x08"
    + b"\xff" * 7
    + b"\x7f\x85C\1btR.",
    "memo": lambda: b"\x80\2" + b"".join(b"r" + struct.pack("<I", 2**32 - 1 - i) for i in range(5)) + b"]q\0.",
    "memo-many": lambda: b"\x80\4]" + b"\x94" * 3_000_000 + b".",
    "doubling": lambda: b"\x80\2]q\0" + b"".join(b"]q%c(h%ch%ce" % (i, i - 1, i - 1) for i in range(1, 60)) + b".",
    "long4": lambda: b"\x80\2\x8b\xff\xff\xff\x7f" + bytes(100),
    "long4-long": lambda: b"\x80\2\x8b" + struct.pack("<I", 4_000_000) + b"\x7f" * 4_000_000 + b".",
    "bytes8": lambda: b"\x80\4\x8e" + b"\xff" * 7 + b"\x3f" + bytes(100),
    "frame": lambda: b"\x80\4\x95" + b"\xff" * 7 + b"\x7f" + b"N.",
    "tuple-self": lambda: b"\x80\2]q\0(h\0h\0e.",
    "deep": lambda: b"\x80\2" + b"]" * 1_000_000 + b"a" * 999_999 + b".",
    "deep-tuple": lambda: b"\x80\2N" + b"\x85" * 1_000_000 + b".",
    "marks": lambda: b"\x80\2" + b"(" * 5_000_000 + b".",
    "dup": lambda: b"\x80\2X\0\0\x10\0" + b"x" * MIB + b"2" * 3_000_000 + b".",
    "int-text": lambda: b"I" + b"9" * 3_000_000 + b"\n.",
    "dict-keys": lambda: b"\x80\2}(" + b"".join(b"K\1K\2" for _ in range(1_000_000)) + b"u.",
    "persistent": lambda: b"\x80\2X\1\0\0\0xQ.",
}
for label, build in PICKLES.items():
    inspected(f"pickle-{label}", f"a pickle: {label}", REFUSED, "x.pkl", lambda box, build=build: build())


@case("pickle-body", "bodies that are hostile pickles and archives", {2, 3, 4})
def _(box):
    box.dataset()
    for label in ("system", "deep", "doubling", "build", "long4"):
        box.write("SMPL_NEUTRAL.pkl", PICKLES[label]())
        box.call("draw", "d.h5", "--figure", "skin", "--body", "SMPL_NEUTRAL.pkl", "-o", box.out / "a.png")


def body_arrays(**changes):
    arrays = {
        "v_template": np.zeros((4, 3)),
        "kintree_table": np.array([[-1, 0] + [1] * 22, range(24)], "i8"),
        "J_regressor": np.full((24, 4), 0.25),
        "weights": np.full((4, 24), 1 / 24),
        "shapedirs": np.zeros((4, 3, 2)),
        "posedirs": np.zeros((4, 3, 207)),
        "f": np.array([[0, 1, 2]], "u4"),
    }
    members = {name + ".npy": array_bytes(value) for name, value in arrays.items()}
    members.update({name + ".npy": value for name, value in changes.items()})
    return zip_file([stored(name, data) for name, data in members.items()])


@case("smpl-faces", "bodies with 2^40 faces, corners of 2^32, parents in a cycle, 2^31 vertices", {2, 3, 4})
def _(box):
    box.dataset()
    cycle = np.array([[1, 2, 1] + [1] * 21, range(24)], "i8")
    for at, change in enumerate(
        (
            {"f": npy("(1099511627776, 3)", descr="'<u4'")},
            {"f": array_bytes(np.full((5, 3), 2**32 - 1, "u4"))},
            {"f": array_bytes(np.zeros((20_000_000, 3), "u1"))},
            {"kintree_table": array_bytes(cycle)},
            {"v_template": npy("(2147483648, 3)")},
            {"posedirs": npy("(4, 3, 1152921504606846976)")},
        )
    ):
        box.write(f"SMPL{at}.npz", body_arrays(**change))
        box.call("draw", "d.h5", "--figure", "skin", "--body", f"SMPL{at}.npz", "-o", box.out / f"a{at}.png")


# --- XML, TOML, cameras, folders ------------------------------------------------------------------------------------------------

LAUGHS = (
    "<?xml version='1.0'?><!DOCTYPE a [<!ENTITY e0 'ha'>"
    + "".join(f"<!ENTITY e{i} '{f'&e{i-1};' * 10}'>" for i in range(1, 10))
    + "<!ENTITY x SYSTEM 'file:///etc/passwd'>]>"
)
for label, text in (
    ("entities", lambda: LAUGHS + "<calibration>&e9;&x;</calibration>"),
    ("opencv-entities", lambda: LAUGHS + "<opencv_storage><K>&e9;</K></opencv_storage>"),
    ("deep", lambda: nested("<a>", "</a>", 1_000_000)),
    ("open", lambda: "<a>" * 2_000_000),
    ("attributes", lambda: "<a " + " ".join(f"x{i}='1'" for i in range(500_000)) + "/>"),
    ("same-attributes", lambda: "<a>" + "<b x='1' x='2'/>" * 100 + "</a>"),
    ("elements", lambda: "<a>" + "<b/>" * 4_000_000 + "</a>"),
    (
        "matrix",
        lambda: "<?xml version='1.0'?><opencv_storage><K type_id='opencv-matrix'><rows>99999</rows><cols>99999</cols><dt>d</dt><data>1</data></K></opencv_storage>",
    ),
):
    inspected(f"xml-{label}", f"XML: {label}", REFUSED, "x.xml", lambda box, text=text: text())
inspected(
    "toml-deep", "TOML arrays nested 400,000 deep", REFUSED, "x.toml", lambda box: "[cam]\na = " + DEEP_LIST + "\n"
)
inspected(
    "toml-dots",
    "TOML keys of 300,000 dots",
    REFUSED,
    "x.toml",
    lambda box: "[a]\n" + ".".join("a" * 300_000) + " = 1\n",
)
inspected(
    "toml-nan",
    "cameras of NaN, inf and 1e308",
    REFUSED,
    "x.toml",
    lambda box: "[cam_0]\nname = 'a'\nsize = [1e308, nan]\nmatrix = [[nan, 0, 0], [0, inf, 0], [0, 0, 1]]\ndistortions = [nan, 0, 0, 0]\nrotation = [nan, 0, 0]\ntranslation = [inf, 0, 0]\n",
)
for label, text in (
    ("deep", lambda: "%YAML:1.0\n---\nK: " + DEEP_LIST + "\n"),
    (
        "aliases",
        lambda: "%YAML:1.0\n---\na0: &a0 [1, 1]\n"
        + "".join(f"a{i}: &a{i} [" + ", ".join([f"*a{i-1}"] * 9) + "]\n" for i in range(1, 12)),
    ),
    (
        "matrix",
        lambda: "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 2147483647\n   cols: 2147483647\n   dt: d\n   data: [ 1. ]\n",
    ),
    (
        "numbers",
        lambda: "%YAML:1.0\n---\nnames: [a]\nK_a: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: ["
        + "1e308, " * 2_000_000
        + "1]\n",
    ),
):
    inspected(f"opencv-{label}", f"OpenCV's YAML: {label}", REFUSED, "intri.yml", lambda box, text=text: text())


@case("openpose-people", "OpenPose's JSON of a million people, of 10^6 numbers", READ_OR_REFUSED)
def _(box):
    person = '{"pose_keypoints_2d":[1,2,1]}'
    box.write("a_000000000000_keypoints.json", '{"version":1.3,"people":[' + ",".join([person] * 1_000_000) + "]}")
    box.call("inspect", "a_000000000000_keypoints.json")
    box.write(
        "b_000000000000_keypoints.json",
        '{"version":1.3,"people":[{"pose_keypoints_2d":[' + ",".join(["1e308"] * 1_000_000) + "]}]}",
    )
    box.call("inspect", "b_000000000000_keypoints.json")


@case("openpose-frames", "frame numbers of 10^12 in file names", {0, 1, 2, 3})
def _(box):
    folder = box.views()
    for file in sorted(folder.rglob("cam0?.0001.json")):
        for number in ("999999999", "999999999999", "99999999999999999999"):
            shutil.copy(file, file.with_name(file.name.replace("0001", number)))
    box.call("inspect", "openpose_depth")
    box.call("run", "views.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("depth-png", "depth images of 60,000 x 60,000, cut off, of other sizes", {0, 1, 2, 3})
def _(box):
    folder = box.views()
    images = sorted(folder.rglob("*.png"))
    bombs = [
        png(60_000, 60_000, rows=1),
        png(60_000, 60_000, rows=30_000),
        png(2, 2),
        images[0].read_bytes()[:200],
        png(1, 60_000),
    ]
    for image, bomb in zip(images, bombs):
        image.write_bytes(bomb)
    box.call("inspect", "openpose_depth")
    box.call("run", "views.yaml", "--to", "ingest", "-o", box.out / "rr")
    box.call("run", "views.yaml", "--to", "fitting", "-o", box.out / "rr")


@case("views-calibration", "calibrations of 1e308, of 10^9 pixels, of 100,000 cameras", {0, 1, 2, 3})
def _(box):
    folder = box.views()
    calibration = json.loads((folder / "calib.json").read_text())
    text = json.dumps(calibration)
    many = (
        {**calibration, "cameras": [{**calibration["cameras"][0], "name": f"c{i}"} for i in range(20_000)]}
        if "cameras" in calibration
        else {}
    )
    for content in (
        text.replace("0.0", "1e308"),
        text.replace("0.0", "NaN"),
        text.replace("640", "1000000000").replace("480", "1000000000"),
        json.dumps(many),
    ):
        (folder / "calib.json").write_text(content)
        box.call("inspect", "openpose_depth")
        box.call("run", "views.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("depth-sequence", "depth sequences of 10^9 pixels and frames, of other folders", READ_OR_REFUSED)
def _(box):
    sound = DOCUMENTS["depth"]
    for change in (
        {"views": {"a": {**VIEW, "size": [10**9, 10**9]}}},
        {"frames": 10_000_000},
        {"frames": 10**12},
        {"fps": 1e-320},
        {"frames": 9_999_999, "fps": 1e6},
        {"views": {"../../outside": VIEW}},
        {"views": {f"v{i}": VIEW for i in range(100_000)}},
        {"frames": 10**6, "labels": [{"action": "w", "first": 0, "last": 10**6 - 1}] * 100_000},
        {"views": {"a": {**VIEW, "fx_fy_cx_cy": [1e-320, 1e308, 0, 0]}}},
    ):
        box.write("views.json", json.dumps({**sound, **change}))
        box.call("inspect", "views.json")


@case("folder-links", "a folder with links to itself, to other folders, a pipe, a socket", {0, 1, 3})
def _(box):
    box.job()
    folder = box.input / "bvhs"
    (folder / "loop").symlink_to(folder)
    (folder / "up").symlink_to(box.outside)
    (folder / "other_p1.bvh").symlink_to(box.outside / "target.txt")
    (folder / "gone_p1.bvh").symlink_to("/nowhere")
    os.mkfifo(folder / "pipe_p1.bvh")
    os.symlink("/dev/zero", folder / "zero_p1.bvh")
    here = os.getcwd()
    os.chdir(folder)
    socket.socket(socket.AF_UNIX).bind("s_p1.bvh")
    os.chdir(here)
    box.call("inspect", "bvhs")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr")


@case("folder-deep", "folders nested 200 deep, 20,000 empty files", {0, 1, 3})
def _(box):
    box.job()
    folder = box.input / "bvhs"
    deep = folder
    for _ in range(200):
        deep = deep / "d"
    deep.mkdir(parents=True)
    (deep / "x_p1.bvh").write_text(bvh_text(frames=3))
    for i in range(20_000):
        (folder / f"e{i}.bvh").touch()
    box.call("inspect", "bvhs")
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


for ending, begin in (
    ("bvh", b"HIERARCHY\nROOT a\n"),
    ("json", b'{"people": [ '),
    ("txt", b"1 2 3\n1 2 3\n"),
    ("npy", b"\x93NUMPY\1\0"),
    ("pkl", b"\x80\2]"),
    ("npz", b"PK\3\4"),
    ("xml", b"<a>"),
    ("ply", b"ply\nformat ascii 1.0\n"),
    ("h5", b"\x89HDF\r\n\x1a\n"),
    ("yml", b"%YAML:1.0\n---\n"),
):

    def try_sparse(box, ending=ending, begin=begin):
        sparse(box.input / f"x.{ending}", 12 * GIB, begin)
        box.call("inspect", f"x.{ending}")

    case(f"sparse-{ending}", f"a sparse file of 12 GiB that begins as {ending}", REFUSED)(try_sparse)


@case("video", "a playlist, a concat list and 4 MB of noise as videos", {0, 1, 2, 3})
def _(box):
    noise = random.Random(1).randbytes(4_000_000)
    for name, content in (
        ("a.avi", f"#EXTM3U\n#EXTINF:1,\nfile://{box.outside}/private.txt\n"),
        ("b.mp4", f"ffconcat version 1.0\nfile {box.outside}/private.txt\n"),
        ("c.avi", b"RIFF\xff\xff\xff\xffAVI LIST" + noise),
        ("d.mp4", b"\0\0\0\x18ftypmp42" + noise),
    ):
        box.write(name, content)
        box.call("inspect", name)


@case("babel-json", "BABEL's annotations of other folders, of 1e308 s, 200,000 labels", READ_OR_REFUSED)
def _(box):
    label = {
        "raw_label": "x",
        "proc_label": "x",
        "seg_id": "s",
        "act_cat": ["walk"] * 3,
        "start_t": -1e308,
        "end_t": 1e308,
    }
    sequence = {
        "babel_sid": 1,
        "url": "http://x",
        "feat_p": "../../../outside/private.txt",
        "dur": 1e308,
        "seq_ann": {"babel_lid": "a", "anntr_id": "b", "mul_act": True, "labels": [label]},
        "frame_ann": {"babel_lid": "a", "anntr_id": "b", "mul_act": True, "labels": [label] * 200_000},
    }
    box.write("train.json", json.dumps({"1": sequence}))
    box.call("inspect", "train.json")


inspected(
    "trc-rows",
    "OpenSim markers of 10^9 frames",
    READ_OR_REFUSED,
    "x.trc",
    lambda box: "PathFileType\t4\t(X/Y/Z)\tx.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n1e300\t1e-300\t1000000000\t1000000\tmm\nFrame#\tTime\ta\n\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n",
)
inspected(
    "c3d",
    "a C3D file, which is not read",
    READ_OR_REFUSED,
    "x.c3d",
    lambda box: b"\2\x50" + b"\xff\x7f" * 255 + bytes(512 * 20),
)
inspected(
    "sto-rows",
    "OpenSim storage of 10^9 rows and columns",
    READ_OR_REFUSED,
    "x.mot",
    lambda box: "x\nversion=1\nnRows=1000000000\nnColumns=1000000000\ninDegrees=no\nendheader\ntime\ta\n0\t1\n0.1\t2\n",
)


@case("amass-values", "AMASS with a rate of 1e-300, NaN, no frames, wrong shapes", REFUSED)
def _(box):
    poses, trans = np.zeros((30, 156)), np.zeros((30, 3))
    for change in (
        {"mocap_framerate": np.float64(1e-300)},
        {"mocap_framerate": np.float64("nan")},
        {"mocap_framerate": np.float64(-30)},
        {"poses": np.zeros((0, 156)), "trans": np.zeros((0, 3))},
        {"trans": np.zeros((29, 3))},
        {"poses": np.full((30, 156), np.nan)},
        {"mocap_framerate": np.float64(1e308)},
    ):
        arrays = {
            "poses": poses,
            "trans": trans,
            "betas": np.zeros(16),
            "mocap_framerate": np.float64(120),
            "gender": np.array("x" * 1000),
            **change,
        }
        box.write(
            "x_poses.npz",
            zip_file([stored(name + ".npy", array_bytes(np.asarray(value))) for name, value in arrays.items()]),
        )
        box.call("inspect", "x_poses.npz")
