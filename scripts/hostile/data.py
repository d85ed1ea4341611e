"""Cases of hostile.sh: HDF5, values of datasets, JSON and networks. Expectations come before any run."""
import json
import struct
import zlib
from pathlib import Path

import h5py
import numpy as np

from bombs import *
from lab import *


# --- H: HDF5 -----------------------------------------------------------------------------------------------------------


def bomb_field(box, name, count, filters):
    """A dataset whose field /frames/state unpacks to `count` bytes."""
    path = box.dataset(name)
    with h5py.File(path, "r+") as file:
        frames, joints = file["/frames/state"].shape
        del file["/frames/state"]
        settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        settings.set_chunk((frames, joints))
        for _ in range(filters):
            settings.set_deflate(9)
        field = h5py.h5d.create(
            file.id, b"/frames/state", h5py.h5t.STD_U8LE, h5py.h5s.create_simple((frames, joints)), settings
        )
        data = zlib_stream(zeros_deflated(count), count)
        for _ in range(filters - 1):
            data = zlib.compress(data, 9)
        field.write_direct_chunk((0, 0), data)
    return path


for filters, size in ((2, 3600 * MIB), (1, 1500 * MIB), (3, 3600 * MIB)):

    def try_filters(box, filters=filters, size=size):
        bomb_field(box, "d.h5", size, filters)
        for verb in ("inspect", "audit"):
            box.call(verb, "d.h5")
        box.call("dataset", "card", "d.h5")

    case(f"H1-deflate-{filters}", f"HDF5 whose chunk unpacks to {size >> 20} MB by {filters} deflate", REFUSED)(
        try_filters
    )


@case("H1-checkpoint", "the same in a checkpoint", REFUSED)
def _(box):
    path = box.checkpoint()
    with h5py.File(path, "r+") as file:
        name = next(iter(file["parameters"]))
        shape = file["parameters"][name].shape
        del file["parameters"][name]
        settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        settings.set_chunk(shape)
        settings.set_deflate(9)
        settings.set_deflate(9)
        field = h5py.h5d.create(
            file.id, f"/parameters/{name}".encode(), h5py.h5t.IEEE_F32LE, h5py.h5s.create_simple(shape), settings
        )
        count = 3600 * MIB
        field.write_direct_chunk((0,) * len(shape), zlib.compress(zlib_stream(zeros_deflated(count), count), 9))
    box.call("inspect", path)
    box.call("generate", path, "-o", box.out / "made.h5")


def opened(box, name="d.h5"):
    return h5py.File(box.dataset(name), "r+")


def dataset_case(name, title, codes, change, verbs=("inspect", "audit", "card", "subset", "export")):
    """A dataset that `change(box, file)` makes hostile, in several verbs."""

    @case(name, title, codes)
    def try_it(box):
        with opened(box) as file:
            change(box, file)
        every_verb(box, "d.h5", verbs)


def every_verb(box, dataset, verbs, codes=None):
    calls = {
        "inspect": ["inspect", dataset],
        "audit": ["audit", dataset],
        "card": ["dataset", "card", dataset],
        "diff": ["dataset", "diff", dataset, "sound.h5"],
        "draw": ["draw", dataset, "-o", box.out / "a.svg"],
        "subset": ["dataset", "subset", dataset, "--where", "frames >= 1", "-o", box.out / "subset.h5"],
        "export": ["export", dataset, "-o", box.out / "export"],
        "fit": ["fit", dataset, "-o", box.out / "fit.h5"],
        "survey": [
            "survey",
            "make",
            *REAL_OR_FAKE,
            "--motions",
            f"real={dataset}",
            "--motions",
            f"b={dataset}",
            "-o",
            box.out / "s",
        ],
        "review": ["review", dataset, "-o", box.out / "review.html"],
    }
    for verb in verbs:
        box.call(*calls[verb], codes=codes)


def outside_field(kind):
    def change(box, file):
        shape = file["/frames/joints"].shape[:2]
        target = str(box.outside / "private.txt")
        if kind == "raw":
            del file["/frames/state"]
            settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            settings.set_external(target.encode(), 0, shape[0] * shape[1])
            h5py.h5d.create(file.id, b"/frames/state", h5py.h5t.STD_U8LE, h5py.h5s.create_simple(shape), settings)
        elif kind == "virtual":
            other = box.outside / "other.h5"
            with h5py.File(other, "w") as store:
                store["x"] = np.zeros(shape, "u1")
            layout = h5py.VirtualLayout(shape=shape, dtype="u1")
            layout[:] = h5py.VirtualSource(str(other), "x", shape=shape)
            file.create_virtual_dataset("/frames/more", layout)
        elif kind == "link":
            other = box.outside / "other.h5"
            with h5py.File(other, "w") as store:
                store["x"] = np.zeros(shape, "u1")
            file["/frames/more"] = h5py.ExternalLink(str(other), "/x")
            file["/clips/more"] = h5py.ExternalLink("/dev/zero", "/x")

    return change


dataset_case(
    "hdf5-external-raw",
    "fields whose values lie in another user's file",
    REFUSED,
    outside_field("raw"),
    ("inspect", "audit"),
)
dataset_case("hdf5-virtual", "a virtual field of another file", READ_OR_REFUSED, outside_field("virtual"))
dataset_case("hdf5-external-link", "links to other files", READ_OR_REFUSED, outside_field("link"))


def soft_cycle(box, file):
    file["/loop"] = h5py.SoftLink("/loop2")
    file["/loop2"] = h5py.SoftLink("/loop")
    file["/frames/more"] = h5py.SoftLink("/frames/more")
    file["/group/a"] = h5py.SoftLink("/group")
    file["/group/back"] = file["/"]
    file["/clips/self"] = file["/clips"]


dataset_case("hdf5-cycles", "soft and hard links in cycles", READ_OR_REFUSED, soft_cycle)


def huge_unwritten(box, file):
    file.create_dataset("/more", shape=(10**6, 10**6), dtype="f8", chunks=(1000, 1000), compression="gzip")
    file.create_dataset("/clips/more", shape=(file["/clips/id"].shape[0], 10**12), dtype="f8", chunks=(1, 10**6))
    file.create_dataset(
        "/frames/more", shape=(file["/frames/joints"].shape[0], 10**9), dtype="f8", chunks=(1, 10**6)
    )


dataset_case(
    "hdf5-unwritten", "unknown fields of 10^12 elements that were never written", READ_OR_REFUSED, huge_unwritten
)


@case("hdf5-frames-unwritten", "/frames/joints of 10^12 elements that were never written", REFUSED)
def _(box):
    with opened(box) as file:
        joints = file["/frames/joints"].shape[1]
        del file["/frames/joints"]
        file.create_dataset("/frames/joints", shape=(10**9, joints, 3), dtype="f4", chunks=(10**6, joints, 3))
    every_verb(box, "d.h5", ("inspect", "audit", "export"))


def many_attributes(box, file):
    for i in range(60):
        file.attrs[f"a{i}"] = np.zeros(8000)
    file.attrs["text"] = np.bytes_(b"x" * 60000)
    file.attrs.create("list", data=np.zeros(1), shape=(1,), dtype="f8")
    file.attrs["reference"] = file["/clips"].ref
    file.attrs["empty"] = h5py.Empty("f4")


dataset_case("hdf5-attributes", "huge and odd attributes", READ_OR_REFUSED, many_attributes)


def variable_texts(box, file):
    kind = h5py.string_dtype("utf-8")
    count = file["/clips/id"].shape[0]
    file.create_dataset("/clips/more", data=["x" * 20 * MIB] * count, dtype=kind)
    file.create_dataset("/more", data=["y"] * 200_000, dtype=kind)
    file.create_dataset("/rows", shape=(4,), dtype=h5py.vlen_dtype("i4"))[0] = np.arange(3, dtype="i4")
    file.create_dataset("/refs", shape=(4,), dtype=h5py.ref_dtype)[0] = file["/clips"].ref


dataset_case("hdf5-variable", "long and many texts of variable length, references", READ_OR_REFUSED, variable_texts)


def filtered_field(box, file):
    file.create_dataset("/frames/more", data=np.zeros((file["/frames/joints"].shape[0], 4), "f4"), compression="lzf")
    file.create_dataset("/more", shape=(10,), dtype="f4", chunks=(10,), compression=32000, shuffle=True)


dataset_case("hdf5-lzf", "filters that are not read", READ_OR_REFUSED, filtered_field)


@case("S1-hdf5-groups", "HDF5 groups nested 20,000 deep", READ_OR_REFUSED)
def _(box):
    with opened(box) as file:
        group = file.id
        settings = h5py.h5p.create(h5py.h5p.GROUP_CREATE)
        inner = h5py.h5g.create(group, b"deep", gcpl=settings)
        for _ in range(20_000):
            inner = h5py.h5g.create(inner, b"d", gcpl=settings)
        h5py.h5d.create(inner, b"x", h5py.h5t.STD_U8LE, h5py.h5s.create_simple((1,)))
    every_verb(box, "d.h5", ("inspect", "card", "subset"))


@case("hdf5-many-groups", "100,000 empty groups and 20,000 splits", READ_OR_REFUSED)
def _(box):
    with opened(box) as file:
        for i in range(100_000):
            h5py.h5g.create(file.id, b"g%d" % i)
        splits = h5py.h5g.create(file.id, b"splits") if "splits" not in file else file["splits"].id
        for i in range(20_000):
            h5py.h5g.create(splits, b"s%d" % i)
    every_verb(box, "d.h5", ("inspect", "card", "subset"))


inspected(
    "hdf5-truncated",
    "the first half of a dataset",
    REFUSED,
    "half.h5",
    lambda box: (lambda b: b[: len(b) // 2])(box.dataset("whole.h5").read_bytes()),
)
inspected(
    "hdf5-superblock",
    "an HDF5 signature and 64 kB of 0xff",
    REFUSED,
    "x.h5",
    lambda box: b"\x89HDF\r\n\x1a\n" + b"\xff" * 65536,
)


@case("hdf5-damaged", "a dataset with each of 60 blocks set to 0xff", READ_OR_REFUSED)
def _(box):
    whole = box.dataset("whole.h5").read_bytes()
    step = len(whole) // 60
    for i in range(60):
        at = i * step
        box.write("d.h5", whole[:at] + b"\xff" * 64 + whole[at + 64 :])
        box.call("dataset", "card", "d.h5")


# --- A: values of datasets -----------------------------------------------------------------------------------------------

for label, rate in (
    ("5000", "1/5000"),
    ("1e18", "1/1000000000000000000"),
    ("fast", "1000000000000/1"),
    ("negative", "-30"),
    ("zero", "30/0"),
    ("long", "1" * 400),
):

    def try_rate(box, rate=rate):
        box.dataset(rates=[rate] * 6, more={"/@rate": ("text", np.array(rate.encode(), dtype=object))})
        every_verb(box, "d.h5", ("audit", "inspect", "export", "draw"))

    case(f"A1-rate-{label}", f"a dataset at {rate[:24]} Hz", REFUSED)(try_rate)


@case("dataset-far", "joints 10^38 m away, spans of 2^31 frames", READ_OR_REFUSED)
def _(box):
    fields = box.fields()
    fields["/frames/joints"][1][:] = 3e38
    fields["/frames/root_translation"][1][:] = 3e38
    write_fields(box.input / "d.h5", fields)
    every_verb(box, "d.h5", ("audit", "inspect", "export", "draw"))
    box.call("fit", "d.h5", "--skeleton", "kinect20", "-o", box.out / "fit.h5")


@case("dataset-ends", "end_frame 2^31 - 1 and offsets that wrap", REFUSED)
def _(box):
    fields = box.fields()
    fields["/clips/count"][1][:] = 2**62
    fields["/clips/offset"][1][1:] = 2**63 - 1
    write_fields(box.input / "d.h5", fields)
    every_verb(box, "d.h5", ("audit", "inspect", "export"))


@case("dataset-many-labels", "30,000 labels", READ_OR_REFUSED)
def _(box):
    names = [f"label{i:05d}" for i in range(30_000)]
    fields = box.fields()
    fields["/labels/name"] = texts(*names)
    fields["/clips/label"] = texts(*names[:6])
    fields["/clips/class"] = ("i4", np.arange(6, dtype="<i4"))
    write_fields(box.input / "d.h5", fields)
    every_verb(box, "d.h5", ("audit", "inspect", "card", "subset"))


@case("dataset-many-findings", "200,000 findings", READ_OR_REFUSED)
def _(box):
    box.dataset(findings=[("", "position_jump", "x" * 20)] * 200_000)
    every_verb(box, "d.h5", ("audit", "inspect", "card", "subset", "review"))


@case("dataset-provenance", "provenance nested 400,000 deep, and /about", REFUSED)
def _(box):
    fields = box.fields()
    fields["/clips/provenance"] = texts(*[nested("[", "]")] * 6)
    write_fields(box.input / "d.h5", fields)
    every_verb(box, "d.h5", ("inspect", "audit", "card"))
    fields = box.fields()
    fields["/about"] = ("text", np.array(nested('{"a":', "}").encode(), dtype=object))
    write_fields(box.input / "d.h5", fields)
    every_verb(box, "d.h5", ("inspect", "audit", "card"))


# --- J: JSON --------------------------------------------------------------------------------------------------------------


@case("J1-tally", "a survey's key and answers, each value nested 400,000 deep", REFUSED)
def _(box):
    key, answers = survey(box)
    for text in deep_variants(key):
        box.write("key.json", text)
        box.call("survey", "tally", "key.json", "-o", box.out / "t")
    for text in deep_variants(answers):
        box.write("answers.json", text)
        box.call("survey", "tally", box.out / "survey" / "key.json", "answers.json", "-o", box.out / "t")


for kind, document in DOCUMENTS.items():

    def try_json(box, document=document):
        for text in deep_variants(document):
            if text[0] == "{":  # else no JSON for `inspect`
                box.write("x.json", text)
                box.call("inspect", "x.json")

    case(f"J1-inspect-{kind}", f"JSON ({kind}), each value nested 400,000 deep", REFUSED)(try_json)


@case("J1-inspect-run", "run.json and lines of a run folder, each value nested 400,000 deep", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    run = json.loads((folder / "run.json").read_text())
    small = {key: run[key] for key in ("created_by", "ended", "job", "machine", "started", "to", "stale")}
    for text in deep_variants({**small, "options": {"name": "small", "description": ""}}):
        (folder / "run.json").write_text(text)
        box.call("inspect", folder)
    (folder / "run.json").write_text(json.dumps(run))
    kept = {name: (folder / name).read_text().split("\n")[0] for name in ("journal.jsonl", "curation_log.jsonl")}
    for name, line in kept.items():
        for text in deep_variants(json.loads(line)):
            (folder / name).write_text(text + "\n")
            box.call("inspect", folder)
    (folder / "run.json").write_text(DEEP_MAP)
    box.call("run", "job.yaml", "--to", "assemble", "-o", folder, codes=ANY)


@case("J1-generate", "checkpoints whose description has values nested 400,000 deep", {0, 2, 3})
def _(box):
    told = {}
    box.checkpoint(about=told.update)
    small = {
        key: told[key]
        for key in ("kind", "facts", "labels", "step", "finished", "optimisers", "best", "dataset_sha256")
    }
    variants = list(deep_variants(small))[1:] + [DEEP_MAP]
    rest = json.dumps({key: value for key, value in told.items() if key not in small})[1:-1]
    for at, text in enumerate(variants):
        about = text[:-1] + ", " + rest + "}" if text != DEEP_MAP else text
        box.checkpoint(about=lambda told, about=about: about)
        box.call("inspect", "net.h5")
        if at % 8 == 0 or about == DEEP_MAP:
            box.call("generate", "net.h5", "-o", box.out / "made.h5", "--force")
    for at, text in enumerate(
        (
            DEEP_MAP,
            json.dumps({"__metadata__": {"mocurate": DEEP_LIST}}),
            '{"a": ' + DEEP_LIST + "}",
            '{"__metadata__": ' + DEEP_MAP + "}",
        )
    ):
        box.write("x.safetensors", safetensors(text.encode()))
        box.call("generate", "x.safetensors", "-o", box.out / "made.h5", codes=REFUSED)
        box.call("inspect", "x.safetensors", codes=REFUSED)


@case("J1-plan", "a plan whose head, items and options have values nested 400,000 deep", REFUSED)
def _(box):
    plan = box.plan()
    kept = plan.read_bytes()
    first, rest = kept.split(b"\n", 1)
    for text in deep_variants(json.loads(first + b"]}")):
        plan.write_bytes(text.encode()[: -len(b"]}")] + b"\n" + rest)
        run_tasks(box, plan)
    for task in (
        '{"items":[],"options":[' + DEEP_MAP + "]}",
        '{"items":' + DEEP_LIST + ',"options":[{}]}',
        '{"items":[{"inputs":[["a","b","c",' + DEEP_LIST + ']],"item":"x","options":0}],"options":[{}]}',
    ):
        plan.write_bytes(first + b"\n" + task.encode() + b"\n]}\n")
        run_tasks(box, plan)


@case("J1-jobs", "run.json, jobs.jsonl, outcome.json and journals of a run on Slurm nested 400,000 deep", {0, 3})
def _(box):
    slurm = box.slurm_run()
    tasks = box.out / "rr" / "plan" / "ingest"
    tasks.mkdir(parents=True)
    kept = (slurm / "jobs.jsonl").read_text()
    array = {
        "kind": "array",
        "job": "13",
        "stage": "ingest",
        "tasks": 1,
        "items": 1,
        "time_s": 5.0,
        "memory_bytes": 1.0,
        "cores": 1,
    }
    for text in deep_variants(array):
        (slurm / "jobs.jsonl").write_text(kept + text + "\n")
        box.call("jobs", box.out / "rr")
    (slurm / "jobs.jsonl").write_text(kept + json.dumps(array) + "\n")
    for text in deep_variants(
        {
            "task": 0,
            "job": "13",
            "event": "ended",
            "exit_code": 0,
            "message": "",
            "workers": 1,
            "time": "2024-05-01T12:34:56.789Z",
        }
    ):
        (tasks / "0.jsonl").write_text(text + "\n")
        box.call("jobs", box.out / "rr")
    for name in ("outcome.json", "run.json"):
        document = (
            {"exit_code": 3, "message": "m"} if name == "outcome.json" else json.loads((slurm / name).read_text())
        )
        for text in deep_variants(document):
            (slurm / name).write_text(text)
            box.call("jobs", box.out / "rr")


@case("J1-worker", "a worker's request nested 400,000 deep", ANY)
def _(box):
    for worker in ("mocurate-annotate", "mocurate-learn", "mocurate-video"):
        beside = Path(box.lab.program).parent
        found = [p for p in (beside / worker, beside / "../libexec/mocurate" / worker) if p.exists()]
        if not found:
            raise Skipped(f"{worker} is not beside the program")
        for text in (DEEP_LIST, DEEP_MAP):
            frame = box.write("frame", struct.pack("<I", len(text)) + text.encode())
            box.call(program=[str(found[0])], stdin=frame, binary=True)


@case("J1-audit", "an audit.json, each value nested 400,000 deep", {0, 3})
def _(box):
    fields = box.fields()
    for name in ("joints", "root_translation", "rotation"):
        fields["/frames/" + name][1][10:40] = fields["/frames/" + name][1][10]
    write_fields(box.input / "d.h5", fields)
    box.sound("audit", "d.h5", "-o", box.out / "a")
    audit = json.loads((box.out / "a" / "audit.json").read_text())
    audit = {key: value[:1] if isinstance(value, list) else value for key, value in audit.items()}
    box.demand(audit["findings"], "the audit found nothing")
    for text in deep_variants(audit):
        box.write("audit.json", text)
        box.call("review", "d.h5", "--audit", "audit.json", "-o", box.out / "page.html", "--force")


@case("audit-types", "audit.json of other types", REFUSED)
def _(box):
    box.dataset()
    for text in (
        '{"findings": [{"clip": 1}], "clips": 7}',
        "[]",
        "{}",
        "null",
        '{"findings": {}}',
        '{"findings": [7]}',
        "\xff",
        "",
    ):
        box.write("audit.json", text)
        box.call("review", "d.h5", "--audit", "audit.json", "-o", box.out / "page.html", "--force")


# --- networks ---


for label, header, length, data in (
    ("2^63", b"{}", 2**63, b""),
    ("4g", b"{}", 2**32, b""),
    ("empty", b"", None, b""),
    ("list", b"[]", None, b""),
    ("shape", {"a": {"dtype": "F32", "shape": [2**40, 2**40], "data_offsets": [0, 4]}}, None, bytes(4)),
    ("offsets", {"a": {"dtype": "F32", "shape": [1], "data_offsets": [2**63, 4]}}, None, bytes(4)),
    ("negative", {"a": {"dtype": "F32", "shape": [-1], "data_offsets": [-4, 0]}}, None, bytes(4)),
    (
        "overlap",
        {f"a{i}": {"dtype": "F32", "shape": [100_000], "data_offsets": [0, 400_000]} for i in range(5000)},
        None,
        bytes(400_000),
    ),
):

    def try_tensors(box, header=header, length=length, data=data):
        box.write("x.safetensors", safetensors(header, data, length))
        box.call("inspect", "x.safetensors")
        box.call("generate", "x.safetensors", "-o", box.out / "made.h5")

    case(f"safetensors-{label}", f"safetensors: {label}", REFUSED)(try_tensors)


def network_case(name, title, change, codes=NOT_READ, parameters=None, more=()):
    @case(name, title, codes)
    def try_it(box):
        box.checkpoint(about=change, parameters=parameters)
        box.call("inspect", "net.h5", codes=READ_OR_REFUSED)
        box.call("generate", "net.h5", "-o", box.out / "made.h5", *more)
        box.call("export", "net.h5", "-o", box.out / "made.safetensors", codes=READ_OR_REFUSED)


def set_options(**values):
    def change(about):
        about["options"].update(values)

    return change


network_case("network-hidden", "a network of 10^9 hidden units", set_options(hidden=10**9))
network_case("network-latent", "a network with -1 latent numbers", set_options(latent=-1))
network_case("network-frames", "a network of 10^12 frames", set_options(frames=10**12))
network_case("network-frames-1e8", "a network of 10^8 frames", set_options(frames=10**8))
network_case(
    "network-kind",
    "a network of an unknown kind",
    lambda about: (about.update(kind="../../x"), about["options"].update(kind="../../x")) and None,
)
network_case(
    "network-labels",
    "a network of a million labels",
    lambda about: about.update(labels=[f"l{i}" for i in range(1_000_000)]),
)
network_case(
    "network-facts",
    "facts of wrong types",
    lambda about: about["facts"].update(bone_length=[1e308] * 24, rate="30/0", part_frames=[[2**62, -1]]),
)
network_case(
    "network-skeleton", "a skeleton with a cycle", lambda about: about["skeleton"]["joints"][1].update(parent=1)
)
network_case(
    "network-parents",
    "a skeleton whose parents lie beyond it",
    lambda about: about["skeleton"]["joints"][1].update(parent=2**31 - 1, mirror=-7),
)
network_case(
    "network-chains",
    "Lie chains beyond the joints",
    lambda about: about["skeleton"]["lie"].update(chains=[[0, 99999], [-1]]),
)
network_case(
    "network-shapes",
    "parameters whose shapes do not fit",
    None,
    parameters=lambda fields: fields.update(
        {p: (k, v.reshape(-1)[:3]) for p, (k, v) in list(fields.items()) if p.startswith("/parameters/")}
    ),
)
network_case(
    "network-names",
    "parameters named ../../x and with escape sequences",
    lambda about: about.update(parameters=["../../x", "\x1b[2J"]),
)
