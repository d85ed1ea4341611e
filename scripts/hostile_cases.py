"""The cases of hostile.sh: what each file is, and which exit codes are allowed. Expectations come before any run.

A case fails as well where a call ends by a signal or 70, takes too much time or memory, changes anything outside its
outputs and caches, shows the environment or another user's file, or prints bytes that a terminal acts on (hostile_lab.py).
"""
import binascii
import io
import json
import os
import shutil
import struct
import sys
import zlib
from pathlib import Path

import h5py
import numpy as np

from hostile_lab import ROOT, SECRET, Broken, Skipped, bvh_text, case, holds, job_text, main, texts, write_fields

REFUSED = {3}  # the input is unusable
CONFIG = {2}  # a config, map or option is wrong
NOT_READ = {2, 3}  # refused, by whichever rule comes first
READ = {0}
READ_OR_REFUSED = {0, 3}
ANY = {0, 1, 2, 3, 4, 74, 75}  # whatever it says, it does no harm

ESCAPES = "\x1b]0;owned\x07\x1b[2J\x9b31m\u202egnp"  # title, clear, a C1 code, text from right to left
SCRIPT = "<script>alert(1)</script>"
MIB = 1 << 20
GIB = 1 << 30
DEEP = 400_000


# --- bytes of bombs --------------------------------------------------------------------------------------------------


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
            body += struct.pack("<4sHHHHHIIIHH", b"PK\3\4", 20, 0, method, 0, 33, crc, stored, declared, len(name), 0) + name + data
        directory += struct.pack("<4sHHHHHHIIIHHHHHII", b"PK\1\2", 20, 20, 0, method, 0, 33, crc, stored, declared, len(name),
                                 0, 0, 0, 0, 0, at) + name
    return body + directory + struct.pack("<4sHHHHIIH", b"PK\5\6", 0, 0, len(members), len(members), len(directory), len(body), 0)


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
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib_stream(zeros_deflated(count), count)) + chunk(b"IEND", b""))


def sparse(path, size, begin=b"", end=b""):
    with open(path, "wb") as file:
        file.write(begin)
        file.truncate(size)
        file.seek(size - len(end))
        file.write(end)
    return path


def inspected(name, title, codes, file, build):
    """A case that inspects one file. `build(box)` gives its bytes, or writes it and gives None."""

    @case(name, title, codes)
    def try_it(box):
        content = build(box)
        if content is not None:
            box.write(file, content)
        box.call("inspect", file)


# --- P: plans and their workers ------------------------------------------------------------------------------------------


def edit_plan(plan, change):
    """Rewrites the first line of a plan; offsets stay where its length does not change."""
    lines = plan.read_bytes().split(b"\n", 1)
    head = json.loads(lines[0].rstrip(b",") + b"}")
    length = len(lines[0])
    change(head)
    text = json.dumps(head, separators=(",", ":")).encode()[:-1] + b","
    shift = len(text) - length
    for index in ("item_index", "option_index", "task_index"):
        head[index] += shift
    again = json.dumps(head, separators=(",", ":")).encode()[:-1] + b","
    plan.write_bytes(again + b"\n" + lines[1])


def shifted_plan(plan, change):
    """As edit_plan, with a blank-filled first line so that every offset stays right."""
    first, rest = plan.read_bytes().split(b"\n", 1)
    head = json.loads(first.rstrip(b",") + b"}")
    change(head["head"])
    body = json.dumps(head["head"], separators=(",", ":")).encode()
    before = first[:first.index(b'"head": ') + len(b'"head": ')]
    room = len(first) - len(before) - 1
    if len(body) <= room:
        plan.write_bytes(before + body + b" " * (room - len(body)) + b",\n" + rest)
        return
    grown = len(body) - room
    values = {key: head[key] + grown for key in ("item_index", "option_index", "task_index")}
    before = (b'{"mocurate_plan": 1, "item_index": %16d, "option_index": %16d, "task_index": %16d, "head": '
              % (values["item_index"], values["option_index"], values["task_index"]))
    lines = rest.split(b"\n")
    out, section = [], ""
    for line in lines:
        if line.startswith(b'"'):
            section = line
        elif section.endswith(b'_offsets": [') and line[:16].strip().isdigit():
            line = b"%16d" % (int(line[:16]) + grown) + line[16:]
        out.append(line)
    plan.write_bytes(before + body + b",\n" + b"\n".join(out))


def run_tasks(box, plan, codes=None):
    box.call("run", "--plan", plan, "--task", "0", codes=codes)


for label, worker in (("absolute", "{box}/bin/evil"), ("parent", "../../../../../../../../..{box}/bin/evil"),
                      ("proc", "/proc/self/cwd/../bin/evil")):

    def try_worker(box, worker=worker):
        box.program_file("evil", f"touch '{box.outside}/PWN' '{box.input}/PWN'")
        plan = box.plan()
        shifted_plan(plan, lambda head: head.update(worker=worker.replace("{box}", str(box.folder))))
        run_tasks(box, plan)

    case(f"P1-worker-{label}", f"a plan whose worker is another program ({label})", READ_OR_REFUSED)(try_worker)


@case("P1-options", "a plan whose items have other options than its config", REFUSED)
def _(box):
    plan = box.plan()
    text = plan.read_bytes()
    box.demand(b'"cm"' in text, "the plan does not have the option")
    plan.write_bytes(text.replace(b'"cm"', b'"mm"'))
    run_tasks(box, plan)


@case("P1-stage", "a plan whose stage is another one than its items were made for", NOT_READ)
def _(box):
    plan = box.plan()
    shifted_plan(plan, lambda head: head.update(stage="canon"))
    run_tasks(box, plan)


@case("P1-limits", "a plan that allows its items 10^18 bytes and 10^300 s", READ_OR_REFUSED)
def _(box):
    plan = box.plan()
    shifted_plan(plan, lambda head: head.update(limits={"time_s": 1e300, "memory_bytes": 10**18}))
    run_tasks(box, plan)


@case("P1-slurm-program", "slurm/run.json whose program is a command", {0, 3})
def _(box):
    slurm = box.slurm_run()
    run = json.loads((slurm / "run.json").read_text())
    run["program"] = f"touch {box.outside}/PWN; mocurate"
    (slurm / "run.json").write_text(json.dumps(run))
    box.call("jobs", box.out / "rr", "--next")
    for script in slurm.glob("*.sh"):
        box.demand(b"PWN" not in script.read_bytes(), f"{script.name} has the command")


@case("P1-slurm-config", "slurm/run.json whose config includes a file elsewhere", {0, 2, 3})
def _(box):
    slurm = box.slurm_run()
    evil = box.write("evil.yaml", f"include: {box.outside}/private.yaml\nname: small\n")
    run = json.loads((slurm / "run.json").read_text())
    run["config"] = str(evil)
    (slurm / "run.json").write_text(json.dumps(run))
    box.call("jobs", box.out / "rr")


@case("P2-inputs", "an input changes after the plan: another clip's motion under its name", {1, 3})
def _(box):
    plan = box.plan()
    bvhs = box.input / "bvhs"
    kept = {name: (bvhs / name).read_bytes() for name in ("run_p1.bvh", "sit_p1.bvh", "walk_p1.bvh")}
    for file in bvhs.iterdir():
        file.write_text(bvh_text(phase=5.0))
    box.call("run", "--plan", plan, "--task", "0")
    for file in sorted(bvhs.iterdir()):
        if file.name in kept:
            file.write_bytes(kept[file.name])
    shutil.copytree(box.lab.sound_folder / "bvhs", bvhs, dirs_exist_ok=True)
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "again", codes=READ)
    with h5py.File(box.out / "again" / "dataset.h5") as made:
        digest = made.attrs["content_sha256"]
    sound = box.lab.work / "sound_dataset" / "out" / "rr" / "dataset.h5"
    box.lab.dataset()
    with h5py.File(sound) as wanted:
        box.demand(digest == wanted.attrs["content_sha256"], "the cache serves the changed motion under the old name")


@case("plan-offsets", "a plan whose indices lie beyond its end", REFUSED)
def _(box):
    plan = box.plan()
    first, rest = plan.read_bytes().split(b"\n", 1)
    at = first.index(b'"task_index":') + len(b'"task_index":')
    plan.write_bytes(first[:at] + b" 9999999999999999" + first[at + 17:] + b"\n" + rest)
    run_tasks(box, plan)


@case("plan-overflow", "a plan of 2^63 items and tasks whose last task is asked for", NOT_READ)
def _(box):
    plan = box.plan()
    shifted_plan(plan, lambda head: head.update(items=2**63 - 1, tasks=2**63 - 1))
    box.call("run", "--plan", plan, "--task", str(2**63 - 2))


@case("plan-overlap", "a plan whose items all point to one line", {1, 3})
def _(box):
    plan = box.plan()
    lines = plan.read_bytes().split(b"\n")
    at = next(i for i, line in enumerate(lines) if line.startswith(b'],') or line == b'"item_offsets": [')
    start = next(i for i, line in enumerate(lines) if b'"item_offsets": [' in line) + 1
    for i in range(start, start + 3):
        lines[i] = lines[start][:16] + lines[i][16:]
    del at
    plan.write_bytes(b"\n".join(lines))
    run_tasks(box, plan)


@case("plan-cache", "a plan whose cache is another folder", {0, 3, 4})
def _(box):
    plan = box.plan()
    shifted_plan(plan, lambda head: head.update(cache=str(box.outside / "thesis")))
    run_tasks(box, plan)


@case("plan-config", "a plan whose config includes another user's file", NOT_READ)
def _(box):
    plan = box.plan()
    evil = box.write("evil.yaml", f"include: {box.outside}/private.yaml\n")
    shifted_plan(plan, lambda head: head.update(config=str(evil)))
    run_tasks(box, plan)


@case("plan-item-name", "a plan whose item is named ../../x", {0, 1, 3})
def _(box):
    plan = box.plan()
    text = plan.read_bytes()
    plan.write_bytes(text.replace(b"run_p1", b"../../"))
    run_tasks(box, plan)


@case("plan-types", "a plan whose head has wrong types", REFUSED)
def _(box):
    plan = box.plan()
    shifted_plan(plan, lambda head: head.update(items=-1, tasks=[1], arguments={"a": 1}))
    run_tasks(box, plan)


# --- C: caches ---------------------------------------------------------------------------------------------------------


def audited(box):
    """A dataset whose audit is in the cache."""
    dataset = box.dataset()
    box.sound("audit", dataset)
    return dataset


def records(box):
    return [file for file in box.cache.glob("objects/*/*/*.json") if "-" not in file.name]


def edit_records(box, change):
    for record in records(box):
        value = json.loads(record.read_text())
        change(value, record)
        record.write_text(json.dumps(value) + "\n")


THESIS_BYTES = len("all of it\n") + len("years of work\n")

for label, artifact in (("parent", "../../../../outside/thesis"), ("absolute", "{outside}/thesis"), ("dots", ".."),
                        ("folder", "../../../../outside"), ("file", "../../../../outside/target.txt")):

    def try_artifact(box, artifact=artifact):
        dataset = audited(box)
        size = {"outside": 0}.get(artifact.rsplit("/", 1)[-1], THESIS_BYTES)
        if artifact.endswith("target.txt"):
            size = 6
        if artifact.endswith("/outside"):
            size = sum(f.stat().st_size for f in box.outside.rglob("*") if f.is_file())
        edit_records(box, lambda value, _: value.update(artifact=artifact.replace("{outside}", str(box.outside)), bytes=size))
        box.call("audit", dataset)
        box.call("cache", "verify", codes={0, 1, 3})
        box.call("cache", "prune", "--days", "0")

    case(f"C1-{label}", f"cache records whose artifact is {artifact}", READ)(try_artifact)


@case("C2-artifact-link", "an artifact that is a link to a file and to a folder", READ)
def _(box):
    dataset = audited(box)
    for i, artifact in enumerate(sorted(p for p in box.cache.glob("objects/*/*/*") if "-" in p.name)):
        artifact.unlink()
        artifact.symlink_to(box.outside / ("target.txt" if i % 2 else "thesis"))
    box.call("audit", dataset)
    box.call("cache", "stat")
    box.call("cache", "prune", "--days", "0")


@case("C2-folder-link", "links in the place of folders of objects", READ)
def _(box):
    audited(box)
    objects = box.cache / "objects"
    (objects / "00").symlink_to(box.outside / "thesis")
    (objects / "01").mkdir(exist_ok=True)
    (objects / "01" / "cd").symlink_to(box.outside / "thesis" / "ab" / "cd")
    (objects / "02").symlink_to(box.outside / "thesis" / "ab")
    box.call("cache", "stat")
    box.call("cache", "verify", codes={0, 1, 3})
    box.call("cache", "prune", "--days", "0")


@case("C2-objects-link", "`objects` itself is a link", {0, 2, 3, 74})
def _(box):
    box.cache.mkdir(exist_ok=True)
    (box.cache / "objects").symlink_to(box.outside / "thesis")
    box.call("cache", "prune", "--days", "0")


@case("C2-foreign-files", "files in objects that the cache did not make", READ)
def _(box):
    audited(box)
    folder = box.cache / "objects" / "00" / "00"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "thesis.tex").write_text("mine\n")
    (folder / "album").mkdir()
    (folder / "album" / "photo.jpg").write_text("mine\n")
    for one in (folder / "thesis.tex", folder / "album" / "photo.jpg", folder / "album"):
        os.utime(one, (1, 1))
    box.call("cache", "prune", "--days", "0")
    box.demand((folder / "thesis.tex").exists() and (folder / "album" / "photo.jpg").exists(), "removed what it did not make")


@case("C2-tmp-link", "links in `tmp` and `scratch`", {0, 3, 74})
def _(box):
    host = os.uname().nodename
    (box.cache / "tmp" / host).mkdir(parents=True)
    (box.cache / "tmp" / host / "1-abcdef").symlink_to(box.outside / "thesis")
    (box.cache / "scratch").mkdir()
    (box.cache / "scratch" / ("0" * 64)).symlink_to(box.outside / "thesis")
    box.job()
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")
    box.call("cache", "prune", "--days", "0")


@case("C2-host-link", "the folder of this host in `tmp` is a link", {0, 3, 74})
def _(box):
    (box.cache / "tmp").mkdir(parents=True)
    (box.cache / "tmp" / os.uname().nodename).symlink_to(box.outside / "thesis")
    box.job()
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("cache-negative", "records with negative and huge sizes, wrong types, other keys", READ)
def _(box):
    dataset = audited(box)
    values = [{"bytes": -1}, {"bytes": 2**64}, {"bytes": 1e308}, {"artifact": 7}, {"sha256": None}, {"outcome": []}, {"key": "0" * 64}]

    def change(value, record):
        value.update(values[hash(record.name) % len(values)])

    edit_records(box, change)
    box.call("audit", dataset)
    box.call("cache", "verify", codes={0, 1, 3})
    box.call("cache", "stat")


@case("cache-other-record", "a record whose artifact is another record", READ)
def _(box):
    dataset = audited(box)
    for record in records(box):
        value = json.loads(record.read_text())
        value.update(artifact=record.name, bytes=record.stat().st_size)
        text = json.dumps(value)
        value["bytes"] = len(text) + 1
        record.write_text(json.dumps(value) + "\n")
    box.call("audit", dataset)


@case("cache-fifo", "artifacts and records that are pipes", READ)
def _(box):
    dataset = audited(box)
    for artifact in [p for p in box.cache.glob("objects/*/*/*") if "-" in p.name]:
        artifact.unlink()
        os.mkfifo(artifact)
    edit_records(box, lambda value, _: value.update(bytes=0))
    box.call("audit", dataset)
    for record in records(box):
        record.unlink()
        os.mkfifo(record)
    box.call("cache", "verify", codes={0, 1, 3})
    box.call("audit", dataset, "--set", "labels.ridge=0.2")


@case("cache-deep-record", "records nested 400,000 deep", READ)
def _(box):
    dataset = audited(box)
    for record in records(box):
        record.write_text(nested("[", "]"))
    box.call("audit", dataset)
    box.call("cache", "verify", codes={0, 1, 3})


@case("cache-huge-record", "a record of 8 GiB", READ)
def _(box):
    dataset = audited(box)
    for record in records(box):
        sparse(record, 8 * GIB, b'{"key":')
    box.call("audit", dataset)


@case("cache-is-file", "`objects` is a file", {2, 3, 74})
def _(box):
    dataset = box.dataset()
    (box.cache / "objects").write_text("x")
    box.call("audit", dataset)


# --- T, R: files in shared folders -------------------------------------------------------------------------------------


@case("T1-mode", "umask 077: nothing is readable by others", READ)
def _(box):
    box.job()
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr", umask=0o077)
    box.call("audit", box.out / "rr" / "dataset.h5", "-o", box.out / "audit", umask=0o077)
    for root in (box.out, box.cache):
        for parent, folders, files in os.walk(root):
            for name in folders + files:
                mode = os.lstat(os.path.join(parent, name)).st_mode & 0o777
                box.demand(mode & 0o077 == 0, f"mode {mode:o} of a file in {root.name}")


@case("T1-temporary-links", "links under the temporary names that a process may choose", READ)
def _(box):
    machine = 2166136261
    for c in os.uname().nodename.encode():
        machine = (machine ^ c) * 16777619 % 2**32
    out = box.out / "d"
    out.mkdir()
    last = int(Path("/proc/loadavg").read_text().split()[-1])
    for process in range(last, last + 3000):
        for count in range(2):
            (out / f".tmp-{machine}-{process}-{count}.h5").symlink_to(box.outside / "target.txt")
            (out / f".tmp-{machine}-{process}-{count}.bvh").symlink_to(box.outside / "target.txt")
    box.dataset()
    box.write("decisions.yaml", "dataset: d.h5\ndecisions:\n  - {clip: 'lab/p1/run_p1#0-60', decision: drop}\n")
    box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", out / "new.h5")


for name in ("lock", "journal.jsonl", "dataset.h5", "run.json", "curation_log.jsonl"):

    def try_link(box, name=name):
        folder = box.run_folder()
        if name == "run.json":
            shutil.copy(folder / name, box.outside / "target.txt")
        (folder / name).unlink()
        (folder / name).symlink_to(box.outside / "target.txt")
        box.call("run", "job.yaml", "--to", "assemble", "-o", folder)

    case(f"R1-{name}", f"{name} of a run folder is a link", {2, 3, 74})(try_link)


@case("R1-folder", "folders of a run folder are links", {2, 3, 74})
def _(box):
    folder = box.run_folder()
    (folder / "plan").symlink_to(box.outside / "thesis")
    (box.input / "bvhs" / "run_p1.bvh").write_text(bvh_text(phase=9.0))
    box.call("plan", "job.yaml", "--stage", "ingest", "--tasks", "1", "-o", folder)


@case("R1-tables", "`tables` of `audit -o` and the file of -o are links", {0, 2, 3, 74})
def _(box):
    box.dataset()
    audit = box.out / "audit"
    audit.mkdir()
    for name in ("audit.json", "clips.csv", "audit.html"):
        (audit / name).symlink_to(box.outside / "target.txt")
    box.call("audit", "d.h5", "-o", audit)


# --- H: HDF5 -----------------------------------------------------------------------------------------------------------


def bomb_field(box, name, count, filters):
    """A dataset whose field /frames/state unpacks to `count` bytes."""
    path = box.dataset(name)
    with h5py.File(path, "r+") as file:
        frames, joints = file["/frames/rotation"].shape[:2]
        settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        settings.set_chunk((frames, joints))
        for _ in range(filters):
            settings.set_deflate(9)
        field = h5py.h5d.create(file.id, b"/frames/state", h5py.h5t.STD_U8LE, h5py.h5s.create_simple((frames, joints)), settings)
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

    case(f"H1-deflate-{filters}", f"HDF5 whose chunk unpacks to {size >> 20} MB by {filters} deflate", REFUSED)(try_filters)


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
        field = h5py.h5d.create(file.id, f"/parameters/{name}".encode(), h5py.h5t.IEEE_F32LE, h5py.h5s.create_simple(shape), settings)
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
    calls = {"inspect": ["inspect", dataset], "audit": ["audit", dataset], "card": ["dataset", "card", dataset],
             "diff": ["dataset", "diff", dataset, "sound.h5"], "draw": ["draw", dataset, "-o", box.out / "a.svg"],
             "subset": ["dataset", "subset", dataset, "--where", "frames >= 1", "-o", box.out / "subset.h5"],
             "export": ["export", dataset, "-o", box.out / "export"],
             "fit": ["fit", dataset, "-o", box.out / "fit.h5"],
             "survey": ["survey", "make", "real_or_fake", "--motions", f"real={dataset}", "--motions", f"b={dataset}", "-o", box.out / "s"],
             "review": ["review", dataset, "-o", box.out / "review.html"]}
    for verb in verbs:
        box.call(*calls[verb], codes=codes)


def outside_field(kind):
    def change(box, file):
        shape = file["/frames/joints"].shape[:2]
        target = str(box.outside / "private.txt")
        if kind == "raw":
            settings = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            settings.set_external(target.encode(), 0, shape[0] * shape[1])
            h5py.h5d.create(file.id, b"/frames/state", h5py.h5t.STD_U8LE, h5py.h5s.create_simple(shape), settings)
            h5py.h5d.create(file.id, b"/frames/more", h5py.h5t.STD_U8LE, h5py.h5s.create_simple(shape), settings)
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


dataset_case("hdf5-external-raw", "fields whose values lie in another user's file", REFUSED, outside_field("raw"), ("inspect", "audit"))
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
    file.create_dataset("/frames/more", shape=(file["/frames/joints"].shape[0], 10**9), dtype="f8", chunks=(1, 10**6))


dataset_case("hdf5-unwritten", "unknown fields of 10^12 elements that were never written", READ_OR_REFUSED, huge_unwritten)


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
    file.create_dataset("/rows", data=[np.arange(3)] * 4, dtype=h5py.vlen_dtype("i4"))
    file["/refs"] = np.array([file["/clips"].ref] * 4, dtype=h5py.ref_dtype)


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


inspected("hdf5-truncated", "the first half of a dataset", REFUSED, "half.h5",
          lambda box: (lambda b: b[:len(b) // 2])(box.dataset("whole.h5").read_bytes()))
inspected("hdf5-superblock", "an HDF5 signature and 64 kB of 0xff", REFUSED, "x.h5",
          lambda box: b"\x89HDF\r\n\x1a\n" + b"\xff" * 65536)


@case("hdf5-damaged", "a dataset with each of 60 blocks set to 0xff", READ_OR_REFUSED)
def _(box):
    whole = box.dataset("whole.h5").read_bytes()
    step = len(whole) // 60
    for i in range(60):
        at = i * step
        box.write("d.h5", whole[:at] + b"\xff" * 64 + whole[at + 64:])
        box.call("dataset", "card", "d.h5")


# --- A: values of datasets -----------------------------------------------------------------------------------------------

for label, rate in (("5000", "1/5000"), ("1e18", "1/1000000000000000000"), ("fast", "1000000000000/1"), ("negative", "-30"),
                    ("zero", "30/0"), ("long", "1" * 400)):

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
    every_verb(box, "d.h5", ("audit", "inspect", "export", "draw", "fit"))


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

DEEP_LIST = nested("[", "]")
DEEP_MAP = nested('{"a":', "}")[:-DEEP] + "1" + "}" * DEEP


@case("J1-tally", "a survey key and answers nested 400,000 deep", REFUSED)
def _(box):
    for name, text in (("key.json", DEEP_LIST), ("key2.json", DEEP_MAP), ("key3.json", '{"questions":' + DEEP_LIST + "}")):
        box.write(name, text)
        box.call("survey", "tally", name, "-o", box.out / "t")
    key = survey(box)
    box.write("answers.json", '{"survey": "x", "participant": "p", "answers": ' + DEEP_LIST + ', "missing": []}')
    box.call("survey", "tally", key, "answers.json", "-o", box.out / "t")


def survey(box, name="sound.h5", **changes):
    box.dataset(name, **changes)
    box.sound("survey", "make", "real_or_fake", "--motions", f"real={name}", "--motions", f"b={name}", "-o", box.out / "survey")
    return box.out / "survey" / "key.json"


for label, head in (("list", ""), ("openpose", '{"version": 1.3, "people": '), ("babel", '{"1": {"babel_sid": 1, "seq_ann": '),
                    ("panoptic", '{"cameras": '), ("bodies", '{"bodies": '), ("depth", '{"views": [], "frames": '),
                    ("label", '{"content": "walk", "style": ')):

    def try_json(box, head=head):
        box.write("x.json", (head or '{"a": ') + DEEP_LIST + "}" * head.count("{"))
        box.call("inspect", "x.json")

    case(f"J1-inspect-{label}", f"JSON nested 400,000 deep ({label})", REFUSED)(try_json)


@case("J1-inspect-run", "run.json and lines of a run folder nested 400,000 deep", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    kept = (folder / "run.json").read_bytes()
    (folder / "run.json").write_text(DEEP_MAP)
    box.call("inspect", folder)
    (folder / "run.json").write_bytes(kept)
    for name in ("journal.jsonl", "curation_log.jsonl"):
        (folder / name).write_text(DEEP_LIST + "\n" + DEEP_MAP + "\n")
    box.call("inspect", folder)
    box.call("run", "job.yaml", "--to", "assemble", "-o", folder, codes=ANY)


@case("J1-generate", "checkpoints whose description is nested 400,000 deep", REFUSED)
def _(box):
    box.write("x.safetensors", safetensors(DEEP_MAP.encode()))
    about = json.dumps({"__metadata__": {"mocurate": DEEP_LIST}})
    box.write("y.safetensors", safetensors(about.encode()))
    box.checkpoint(about=lambda told: DEEP_MAP)
    for name in ("x.safetensors", "y.safetensors", "net.h5"):
        box.call("generate", name, "-o", box.out / "made.h5")
        box.call("inspect", name)


@case("J1-plan", "a plan whose head and items are nested 400,000 deep", REFUSED)
def _(box):
    box.write("plan.json", '{"mocurate_plan": 1, "head": ' + DEEP_MAP + ",\n")
    box.call("run", "--plan", "plan.json", "--task", "0")
    plan = box.plan()
    text = plan.read_bytes()
    begin = text.index(b'"items": [\n') + len(b'"items": [\n')
    end = text.index(b"\n", begin)
    plan.write_bytes(text[:begin] + DEEP_LIST.encode() + text[end:])
    run_tasks(box, plan)


@case("J1-jobs", "run.json, jobs.jsonl and outcome.json of Slurm nested 400,000 deep", {0, 3})
def _(box):
    slurm = box.slurm_run()
    for name in ("jobs.jsonl", "outcome.json", "run.json"):
        (slurm / name).write_text(DEEP_MAP + "\n")
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
            box.call(program=[str(found[0])], stdin=frame)
        frame = box.write("frame", struct.pack("<I", 2**32 - 1) + b"{}")
        box.call(program=[str(found[0])], stdin=frame)


@case("J1-audit", "an audit.json nested 400,000 deep, of wrong types", REFUSED)
def _(box):
    box.dataset()
    for text in (DEEP_MAP, '{"findings": ' + DEEP_LIST + "}", '{"findings": [{"clip": 1}], "clips": 7}', "[]", "{}", "null"):
        box.write("audit.json", text)
        box.call("review", "d.h5", "--audit", "audit.json", "-o", box.out / "page.html")


# --- E: configs and data that look like configs --------------------------------------------------------------------------------


@case("E1-decisions", "decisions whose note, finding and dataset name the environment", {0, 2, 3})
def _(box):
    box.dataset()
    box.write("decisions.yaml", "dataset: ${SECRET}\ndecisions:\n  - clip: 'lab/p1/run_p1#0-60'\n    decision: drop\n    note: ${SECRET}\n")
    box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "new.h5", "--excluded", box.out / "old.h5")
    box.call("audit", "d.h5", "--review", "decisions.yaml", "-o", box.out / "audit")
    box.call("review", "d.h5", "--decisions", "decisions.yaml", "-o", box.out / "page.html")


@case("E1-relabel", "a relabel map whose labels name the environment", {0, 2, 3})
def _(box):
    box.dataset()
    box.write("map.yaml", "run: ${SECRET}\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new.h5")
    box.write("map.yaml", "rules:\n  - {where: \"frames > 0\", label: '${SECRET}'}\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new2.h5")
    box.write("map.yaml", "drop: ['${SECRET}']\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new3.h5")


@case("E1-include", "decisions, maps and scripts that include another user's file", NOT_READ)
def _(box):
    box.dataset()
    for include in (f"include: {box.outside}/private.yaml\n", "include: ../outside/private.txt\n"):
        box.write("data.yaml", include)
        box.call("dataset", "apply", "d.h5", "data.yaml", "-o", box.out / "new.h5")
        box.call("dataset", "relabel", "d.h5", "data.yaml", "-o", box.out / "new.h5")
        box.call("review", "d.h5", "--decisions", "data.yaml", "-o", box.out / "page.html")
    box.checkpoint()
    box.call("generate", "net.h5", "--script", "data.yaml", "-o", box.out / "made.h5")


@case("E1-clips-table", "a relabel map whose table is another user's file", NOT_READ)
def _(box):
    box.dataset()
    box.write("map.yaml", f"clips: {box.outside}/private.txt\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new.h5")


@case("E1-job-review", "canon.review of a job names the environment", {0, 2, 3})
def _(box):
    box.job(more="canon: {review: decisions.yaml}\n")
    box.write("decisions.yaml", "decisions:\n  - clip: 'lab/p1/run_p1#0-60'\n    decision: drop\n    note: ${SECRET}\n")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr")


@case("E1-known-issues", "a list of known issues names the environment", {0, 2, 3})
def _(box):
    box.job(source="    known_issue_lists: [issues.yaml]\n")
    box.write("issues.yaml", "issues:\n  - {kind: broken, source: '${SECRET}', note: '${SECRET}', clips: ['*']}\n")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr")
    box.write("issues.yaml", f"include: {box.outside}/private.yaml\n")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr2")


@case("E1-spans", "canon.trim.spans: a table that names the environment, another user's file", {0, 2, 3})
def _(box):
    box.job(more="canon: {trim: {rule: annotated, spans: spans.csv}}\n")
    box.write("spans.csv", "clip,begin_s,end_s,label\nlab/p1/run_p1,0.1,1.5,${SECRET}\n")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr")
    (box.input / "spans.csv").unlink()
    (box.input / "spans.csv").symlink_to(box.outside / "private.txt")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr2")


@case("E1-skeleton", "a skeleton file that names the environment and includes another user's file", {0, 2, 3})
def _(box):
    box.write("walk.bvh", bvh_text())
    box.job()
    for text in ("name: ${SECRET}\njoints:\n  - {name: '${SECRET}', offset: [0, 0, 0]}\n", f"include: {box.outside}/private.yaml\n"):
        box.write("skeleton.yaml", text)
        box.call("fit", "walk.bvh", "--source", "job.yaml", "--skeleton", "skeleton.yaml", "-o", box.out / "new.h5")


@case("E1-rig", "a rig file that includes another user's file", {0, 2, 3, 4})
def _(box):
    box.job(more="fitting: {keypoints: {rig: rig.yaml}}\n")
    box.write("rig.yaml", f"include: {box.outside}/private.yaml\n")
    box.call("run", "job.yaml", "--to", "fitting", "-o", box.out / "rr")


@case("E1-config-include", "a config that includes files outside its folder", CONFIG)
def _(box):
    box.job("sound.yaml")
    for include in (f"{box.outside}/private.yaml", "../outside/private.yaml", "${PWD}/../outside/private.yaml", "link.yaml",
                    "[link.yaml]", "sub/../../outside/private.yaml"):
        if not (box.input / "link.yaml").is_symlink():
            (box.input / "link.yaml").symlink_to(box.outside / "private.yaml")
            (box.input / "sub").mkdir()
        box.write("job.yaml", f"include: {include}\n")
        box.call("config", "show", "job.yaml")


@case("E1-exported-source", "source.yaml of an exported folder names the environment in its classes", {0, 2, 3})
def _(box):
    box.dataset(labels=["${SECRET}"] * 6, persons=["${SECRET}"] * 6)
    box.call("export", "d.h5", "-o", box.out / "arrays", "--layout", "bvh")
    source = box.out / "arrays" / "source.yaml"
    if source.exists():
        box.call("run", source, "--to", "assemble", "-o", box.out / "rr")


@case("E2-include-device", "a config that includes a device or a pipe", CONFIG)
def _(box):
    box.write("zero.yaml", "include: /dev/zero\n")
    box.call("config", "show", "zero.yaml")
    os.mkfifo(box.input / "pipe")
    box.write("pipe.yaml", "include: pipe\n")
    box.call("config", "show", "pipe.yaml")


@case("E2-data-device", "decisions, maps, tables and answers that are devices or pipes", NOT_READ)
def _(box):
    box.dataset()
    os.mkfifo(box.input / "pipe.yaml")
    for file in ("/dev/zero", "pipe.yaml"):
        box.call("dataset", "apply", "d.h5", file, "-o", box.out / "new.h5")
        box.write("map.yaml", f"clips: {file}\n")
        box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new.h5")
        box.call("survey", "tally", file, "-o", box.out / "t")
        box.call("review", "d.h5", "--audit", file, "-o", box.out / "page.html")


@case("E2-large", "a config of 17 MiB, and one that includes it", CONFIG)
def _(box):
    box.write("large.yaml", b"# " + b"x" * 17 * MIB + b"\nname: a\n")
    box.call("config", "show", "large.yaml")
    box.write("job.yaml", "include: large.yaml\n")
    box.call("config", "show", "job.yaml")


def config_case(name, title, text, codes=CONFIG):
    @case(name, title, codes)
    def try_it(box):
        box.write("job.yaml", text() if callable(text) else text)
        box.call("config", "show", "job.yaml")
        box.call("run", "job.yaml", "-o", box.out / "rr")


config_case("yaml-deep", "YAML nested 400,000 deep", lambda: "a: " + DEEP_LIST + "\n")
config_case("yaml-deep-blocks", "YAML nested by 5,000 block lists", lambda: "a:\n" + "".join(" " + "- " * i + "\n" for i in range(1)) + " " + "- " * 5000 + "x\n")
config_case("yaml-aliases", "nine aliases of nine aliases, ten times",
            lambda: "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [" + ", ".join([f"*a{i-1}"] * 9) + "]\n" for i in range(1, 11)))
config_case("yaml-cycle", "references in a cycle", "name: ${description}\ndescription: ${takes}\ntakes: ${name}\n")
config_case("yaml-double", "each of 60 references is twice the one before",
            lambda: "description: ${profiles.p60}\nprofiles:\n  p0: xx\n" + "".join(f"  p{i}: '${{profiles.p{i-1}}}${{profiles.p{i-1}}}'\n" for i in range(1, 61)))
config_case("yaml-number", "numbers beyond all ranges", "evaluate: {seed: 1e999, repetitions: -1e400}\ntolerated_failures: .nan\n")
config_case("yaml-keys", "60,000 unknown keys", lambda: "".join(f"unknown_option_{i}: {i}\n" for i in range(60_000)))
config_case("yaml-references", "30,000 references to nothing", lambda: "".join(f"k{i}: ${{n{i}}}\n" for i in range(30_000)))
config_case("yaml-long-key", "a key of 8 MB, a value of 8 MB", lambda: "x" * 8_000_000 + ": 1\nname: " + "y" * 7_000_000 + "\n")
config_case("yaml-binary", "control characters, tags, merge keys", "name: !!python/object/apply:os.system ['touch PWN']\n<<: {a: 1}\n")
config_case("yaml-anchor-key", "an anchor inside itself", "a: &a [*a]\nb: &b {c: *b}\n")


@case("yaml-include-cycle", "two configs that include each other, and 300 that include one", CONFIG)
def _(box):
    box.write("a.yaml", "include: b.yaml\n")
    box.write("job.yaml", "include: a.yaml\n")
    box.write("b.yaml", "include: [" + ", ".join(["a.yaml"] * 300) + "]\n")
    box.call("config", "show", "job.yaml")


@case("yaml-patterns", "a file pattern of 60 fields against long names", {0, 1, 2, 3})
def _(box):
    fields = "".join("{f%d}a" % i for i in range(60))
    box.job()
    text = (box.input / "job.yaml").read_text().replace("{label}_{person}.bvh", fields + ".bvh")
    box.write("job.yaml", text)
    for i in range(200):
        box.write(f"bvhs/{'a' * 240}{i:03d}.bvh", bvh_text(frames=3))
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("skeleton-cycle", "skeletons with cycles of parents, 100,000 joints, a joint that is its own parent", NOT_READ)
def _(box):
    box.write("walk.bvh", bvh_text())
    box.job()
    joint = "  - {{name: {0}, parent: {1}, offset: [0, 0.1, 0]}}\n"
    for text in (joint.format("a", "b") + joint.format("b", "a"), joint.format("a", "a"),
                 joint.format("j0", '""') + "".join(joint.format(f"j{i}", f"j{i-1}") for i in range(1, 20_000))):
        box.write("skeleton.yaml", "name: odd\njoints:\n" + text)
        box.call("fit", "walk.bvh", "--source", "job.yaml", "--skeleton", "./skeleton.yaml", "-o", box.out / "new.h5")


@case("decisions-bombs", "decisions with aliases, 90,000 entries of one clip, numbers beyond all", NOT_READ)
def _(box):
    box.dataset()
    entry = "  - {clip: 'lab/p1/run_p1#0-60', decision: keep, finding: f%d}\n"
    for text in ("decisions: &a [*a]\n", "decisions:\n" + "".join("  - {clip: 'lab/p1/run_p1#0-60', decision: cut, begin: 0, end: 1e300}\n" for _ in range(3)),
                 "decisions:\n" + "".join(entry % i for i in range(20_000)) + "  - {clip: x, decision: drop, label: y}\n"):
        box.write("decisions.yaml", text)
        box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "new.h5")


@case("relabel-bombs", "a map of 90,000 classes, of 30,000 rules", {0, 2, 3})
def _(box):
    box.dataset()
    box.write("map.yaml", "classes: [" + ", ".join(f"c{i}" for i in range(90_000)) + "]\nlabels: {run: c1, sit: c2, walk: c3}\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new.h5")
    box.write("map.yaml", "rules:\n" + "".join(f"  - {{where: \"frames > {i}\", label: c{i}}}\n" for i in range(30_000)))
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new2.h5")


@case("S1-conditions", "a map with a condition of 100,000 `and`, one of 100,000 brackets", {0, 2, 3})
def _(box):
    box.dataset()
    for where in (" and ".join(["frames > 0"] * 100_000), "(" * 100_000 + "frames > 0" + ")" * 100_000, "not " * 100_000 + "frames > 0",
                  "label in [" + ", ".join(f"l{i}" for i in range(200_000)) + "]"):
        box.write("map.yaml", f"rules:\n  - {{where: \"{where}\", label: c}}\n")
        box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / f"new{len(where)}.h5")


@case("regex-bombs", "regular expressions that backtrack or grow", {0, 2, 3})
def _(box):
    box.dataset(labels=["a" * 2000] * 6)
    for at, pattern in enumerate(("(a*)*b", "((a|a)*)*$", "(a+){60}", "((((a{9}){9}){9}){9}){9}", "(.*)(.*)(.*)(.*)(.*)(.*)x", "[" * 100, "a{99999}",
                                  "(a?){60}a{60}", "(" * 120)):
        box.write("map.yaml", "rules:\n  - {where: \"label =~ '" + pattern + "'\", label: c}\n")
        box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / f"new{at}.h5")


@case("wildcard-bomb", "a known issue of many stars against long names", {0, 2, 3})
def _(box):
    box.job(source="    known_issue_lists: [issues.yaml]\n")
    box.write("issues.yaml", "issues:\n  - {kind: k, source: s, note: n, clips: [" + ", ".join(["'" + "*a" * 2000 + "*b'"] * 2000) + "]}\n")
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("spans-bombs", "spans of 1e308 s, without numbers, 300,000 of one clip", {0, 1, 2, 3})
def _(box):
    box.job(more="canon: {trim: {rule: annotated, spans: spans.csv}}\n")
    head = "clip,begin_s,end_s,label\n"
    for at, text in enumerate(("lab/p1/run_p1,-1e308,1e308,x\nlab/p1/run_p1,nan,inf,y\n", "lab/p1/run_p1,0,1e300,../../x\n",
                               "".join(f"lab/p1/run_p1,{i * 1e-6:.7f},1,x\n" for i in range(300_000)))):
        box.write("spans.csv", head + text)
        box.call("run", "job.yaml", "--to", "canon", "-o", box.out / f"rr{at}")


# --- N, M, X, G: texts of strangers ------------------------------------------------------------------------------------------


def escaped_dataset(box):
    box.dataset("sound.h5")
    box.dataset(labels=["run" + ESCAPES] * 2 + ["sit\nFAKE: all well"] * 2, persons=["p" + ESCAPES] * 3, recordings=["r" + ESCAPES],
                sources=["lab" + ESCAPES] * 6, licences=["free" + ESCAPES] * 6, joints=["hips" + ESCAPES, "a\nFAKE"],
                findings=[("", "position_jump", "jump" + ESCAPES), ("", "code" + ESCAPES, "\nFAKE: nothing")])


N1_VERBS = {
    "inspect": ["inspect", "d.h5"],
    "audit": ["audit", "d.h5"],
    "card": ["dataset", "card", "d.h5"],
    "diff": ["dataset", "diff", "d.h5", "sound.h5"],
    "subset": ["dataset", "subset", "d.h5", "--where", "label == runx", "-o", "{out}/a.h5"],
    "subset-done": ["dataset", "subset", "d.h5", "--where", "frames > 1", "-o", "{out}/a.h5"],
    "merge": ["dataset", "merge", "d.h5", "sound.h5", "-o", "{out}/a.h5"],
    "apply": ["dataset", "apply", "d.h5", "decisions.yaml", "-o", "{out}/a.h5"],
    "relabel": ["dataset", "relabel", "d.h5", "map.yaml", "-o", "{out}/a.h5"],
    "export": ["export", "d.h5", "-o", "{out}/e", "--layout", "bvh"],
    "export-actor": ["export", "d.h5", "-o", "{out}/e", "--layout", "actor"],
    "export-clip": ["export", "d.h5", "-o", "{out}/e", "--clip", "none"],
    "draw": ["draw", "d.h5", "-o", "{out}/a.svg"],
    "draw-label": ["draw", "d.h5", "--label", "none", "-o", "{out}/a.svg"],
    "review": ["review", "d.h5", "-o", "{out}/page.html"],
    "annotate": ["review", "d.h5", "--annotate", "--labels", "a,b", "--all", "-o", "{out}/page.html"],
    "survey": ["survey", "make", "real_or_fake", "--motions", "real=d.h5", "--motions", "b=sound.h5", "-o", "{out}/s"],
    "fit": ["fit", "d.h5", "--skeleton", "smpl24", "-o", "{out}/a.h5"],
    "inspect-json": ["--json", "inspect", "d.h5"],
    "audit-json": ["--json", "audit", "d.h5"],
}

for verb, words in N1_VERBS.items():

    def try_escapes(box, words=words):
        escaped_dataset(box)
        box.write("decisions.yaml", "decisions:\n  - {clip: 'lab/p1/none#0-60', decision: drop}\n")
        box.write("map.yaml", "rnu: walk\n")
        outcome = box.call(*[word.replace("{out}", str(box.out)) for word in words])
        box.demand(not any(line.startswith(b"FAKE") for line in outcome.text.split(b"\n")), "a text of the file begins a line")

    case(f"N1-{verb}", f"escape sequences of a dataset in `{' '.join(words[:2])}`", {0, 1, 2, 3})(try_escapes)


def escaped_file(name, title, file, content, codes=READ_OR_REFUSED):
    inspected(f"N1-{name}", title, codes, file, content)


escaped_file("bvh", "escape sequences in a joint's name", "x.bvh", lambda box: bvh_text(head="Head\x1b[2J\x9b31m\u202ex"))
escaped_file("npy", "escape sequences in the type of an npy", "x.npy", lambda box: npy("(4, 3)", bytes(96), "'<\x1b[2Jf8\x9b'"))
escaped_file("pickle", "escape sequences in the class of a pickle", "x.pkl", lambda box: pickle_call("os\x1b[2J", "sys\x9btem", "x"))
escaped_file("npz", "escape sequences in a member's name", "x.npz", lambda box: zip_file([stored("\x1b[2Ja\x9b.npy", npy("(2, 3)", bytes(48)))]))
escaped_file("xml", "escape sequences in XML", "x.xml", lambda box: "<a\x9b31m b='\u202e'><c>\x9b2J</c></a>")
escaped_file("json", "escape sequences in JSON", "x.json", lambda box: '{"\\u001b[2J\x9b": [1], "people": [{"\u202e": "\\u009b"}]}')
escaped_file("csv", "escape sequences in the header of a table", "x.csv",
             lambda box: "time,\x1b[2Ja_x,\x9ba_y,a\u202e_z\n" + "0,1,2,3\n0.1,1,2,3\n" * 3)
escaped_file("amc", "escape sequences in bones", "x.asf", lambda box: ":version 1.10\n:name \x1b[2Jx\x9b\n:units\n length 0.45\n:root\n order \x9b\n")
escaped_file("toml", "escape sequences in TOML", "x.toml", lambda box: "[cam\x9b]\nname = '\u202e\x9b'\nsize = [1, 2]\n", ANY)


@case("N1-file-names", "a folder of files with escape sequences, line ends and other bytes in their names", {0, 1, 3})
def _(box):
    for name in (b"\x1b[2Jwalk_p1.bvh", b"a\nFAKE_p1.bvh", b"\xff\xfe_p1.bvh", b"\xc2\x9b31m_p1.bvh", "\u202ex_p1.bvh".encode(), b"-rf_p1.bvh", b"a" * 240 + b"_p1.bvh"):
        path = os.fsencode(box.input / "bvhs")
        os.makedirs(path, exist_ok=True)
        with open(path + b"/" + name, "w") as file:
            file.write(bvh_text(frames=30))
    box.write("job.yaml", job_text())
    box.call("inspect", "bvhs")
    outcome = box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr")
    box.demand(b"\nFAKE" not in outcome.text, "a file name begins a line")


@case("N1-checkpoint", "escape sequences in a checkpoint's labels and facts", {0, 2, 3})
def _(box):
    def change(about):
        about["labels"] = ["run" + ESCAPES, "sit\nFAKE", "walk"]
        about["kind"] = about["kind"]
        about["facts"]["split"] = ESCAPES

    box.checkpoint(about=change)
    box.call("inspect", "net.h5")
    box.call("generate", "net.h5", "--label", "none", "-o", box.out / "made.h5")
    box.call("generate", "net.h5", "-o", box.out / "made.h5")


@case("N1-run-folder", "escape sequences in run.json and the journals of a run", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    run = json.loads((folder / "run.json").read_text())
    run["ended"]["message"] = "done" + ESCAPES + "\nFAKE"
    run["ended"]["exit_code"] = 3
    run["options"]["name"] = "small" + ESCAPES
    run["job"]["name"] = ESCAPES
    run["stale"] = [{"file": "dataset.h5", "stage": ESCAPES}, {"file": "../../x" + ESCAPES, "stage": "canon"}]
    (folder / "run.json").write_text(json.dumps(run))
    (folder / "journal.jsonl").write_text(json.dumps({"stage": "fitting" + ESCAPES, "outcome": "done" + ESCAPES, "time": "9999"}) + "\n")
    (folder / "curation_log.jsonl").write_text(json.dumps({"decision": ESCAPES, "clip": ESCAPES}) + "\n")
    box.call("inspect", folder)
    box.call("run", "job.yaml", "-o", folder, codes=ANY)


@case("N1-jobs", "escape sequences in the files of a run on Slurm", {0, 2, 3})
def _(box):
    slurm = box.slurm_run()
    with open(slurm / "jobs.jsonl", "a") as jobs:
        jobs.write(json.dumps({"kind": "array", "job": "13" + ESCAPES, "stage": "ingest" + ESCAPES, "tasks": 1, "items": 1}) + "\n")
        jobs.write(json.dumps({"kind": "step", "job": "14"}) + "\n")
    (slurm / "logs").mkdir(exist_ok=True)
    (slurm / "logs" / "step-14.log").write_text("log" + ESCAPES + "\n")
    (slurm / "queue.txt").write_text(f"12|PENDING|0|n|reason{ESCAPES}\n")
    box.call("jobs", box.out / "rr")
    (slurm / "outcome.json").write_text(json.dumps({"exit_code": 3, "message": "m" + ESCAPES}))
    box.call("jobs", box.out / "rr")


@case("N1-plan", "escape sequences in a plan", NOT_READ)
def _(box):
    plan = box.plan()
    shifted_plan(plan, lambda head: head.update(config="x" + ESCAPES, arguments=["a=" + ESCAPES]))
    run_tasks(box, plan)
    plan = box.out / "rr" / "plan" / "ingest.json"
    shifted_plan(plan, lambda head: head.update(stage="x" + ESCAPES))
    run_tasks(box, plan)


@case("N1-decisions", "escape sequences in decisions, maps and tables", {0, 1, 2, 3})
def _(box):
    box.dataset()
    escaped = json.dumps("x" + ESCAPES)
    box.write("decisions.yaml", f"decisions:\n  - {{clip: {escaped}, decision: drop}}\n")
    box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "a.h5")
    box.write("decisions.yaml", f"decisions:\n  - {{clip: 'lab/p1/run_p1#0-60', decision: relabel, label: {escaped}, note: {escaped}}}\n")
    box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "a.h5")
    box.write("map.yaml", f"{escaped}: {escaped}\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "a.h5")
    box.write("map.yaml", "clips: t.csv\n")
    box.write("t.csv", "clip,label\n" + "x" + ESCAPES + ",a\n" + "x" + ESCAPES + ",b\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "a.h5")
    box.write("job.yaml", f"{escaped}: 1\n")
    box.call("config", "show", "job.yaml")


MARKUP = ["<script>alert(1)</script>", "[click](http://evil.example)", "# heading", "| a | b |\n|---|---|", "=cmd|'/c calc'!A1"]


@case("M1-card", "markup in labels, licences and recipes of `dataset card`", READ)
def _(box):
    box.dataset(labels=MARKUP, persons=MARKUP, licences=MARKUP + ["![x](http://evil.example/p.png)"], sources=["a<b>\n# heading"] * 6,
                findings=[("", "<script>", SCRIPT)], more={"/recipe": ("text", np.array(b"```\n# heading\n<script>alert(1)</script>\n```", dtype=object))})
    outcome = box.call("dataset", "card", "d.h5")
    plain = outcome.text.split(b"```")[0::2]  # outside of blocks of code
    shown = b"".join(plain)
    box.demand(b"<script" not in shown, "the card has <script>")
    box.demand(b"](http" not in shown, "the card has a link")
    box.demand(b"\n# heading" not in shown, "the card has a heading of a label")
    box.call("dataset", "card", "d.h5", "--croissant")


@case("M1-tally", "markup in the sources and labels of a survey", READ)
def _(box):
    box.dataset("sound.h5", labels=["<script>alert(1)</script>"] * 2 + ["=cmd|' /c calc'!A1"] * 2 + ["a|b\nc"] * 2)
    evil = f"=1+1{SCRIPT}"
    box.sound("survey", "make", "preference", "--motions", f"{evil}=sound.h5", "--motions", "b=sound.h5", "-o", box.out / "s")
    key = json.loads((box.out / "s" / "key.json").read_text())
    answers = {"survey": key["survey"], "participant": "p1", "missing": [],
               "answers": [{"question": q["question"], "answer": "left"} for q in key["questions"]]}
    box.write("answers.json", json.dumps(answers))
    box.call("survey", "tally", box.out / "s" / "key.json", "answers.json", "-o", box.out / "t")
    made = {file.name: file.read_bytes() for file in (box.out / "t").iterdir()}
    for name in ("tally.md", "figure.svg"):
        box.demand(b"<script" not in made[name], f"{name} has <script>")
    for line in made["tally.csv"].split(b"\n"):
        box.demand(not any(cell.strip(b'"').startswith((b"=", b"@")) for cell in line.split(b",")), "a cell of tally.csv is a formula")


@case("M1-csv", "labels that a spreadsheet calculates", {0, 1})
def _(box):
    box.dataset(labels=["=cmd|'/c calc'!A1", "@sum(1)", "+1", "-1+1", "\t=1"], persons=["=1"] * 3)
    box.call("export", "d.h5", "-o", box.out / "e")
    box.call("audit", "d.h5", "-o", box.out / "a")
    box.call("export", "d.h5", "-o", box.out / "c", "--layout", "csv")
    for folder in ("e", "a", "c"):
        for line in (box.out / folder / "clips.csv").read_bytes().split(b"\n"):
            for cell in line.split(b","):
                box.demand(not cell.strip(b'"').startswith((b"=", b"@", b"+", b"\t")), f"a cell of {folder}/clips.csv is a formula")


@case("M1-pages", "markup in pages of review, annotation, survey and audit", READ)
def _(box):
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
    box.dataset(labels=[evil] * 3 + ["ok"] * 3, persons=[evil] * 6, joints=[evil], findings=[("", "position_jump", evil)])
    box.write("decisions.yaml", "decisions:\n  - {clip: 'x', decision: drop, note: " + json.dumps(evil) + "}\n")
    box.call("review", "d.h5", "--decisions", "decisions.yaml", "-o", box.out / "review.html")
    box.call("review", "d.h5", "--annotate", "--labels", "a", "--all", "-o", box.out / "annotate.html")
    box.call("survey", "make", "real_or_fake", "--motions", "real=d.h5", "--motions", "b=d.h5", "-o", box.out / "s")
    box.call("audit", "d.h5", "-o", box.out / "a")
    box.call("draw", "d.h5", "-o", box.out / "a.svg")
    for page in list(box.out.rglob("*.html")) + list(box.out.rglob("*.svg")):
        text = page.read_bytes()
        box.demand(b"<script>alert" not in text and b"<img src=x" not in text, f"{page.name} has the markup")


NAMES = ["clips.csv", "source.yaml", "x" * 300, "../../x", "/etc/x", "con", ".", "..", "a\nb", "\u202egpj", "\U0001F525", "-rf", "~", "$HOME", "a/b/c"]

for layout in ("npz", "csv", "bvh", "humanact12", "amass_babel"):

    def try_names(box, layout=layout):
        for i in range(0, len(NAMES), 5):
            label = (NAMES[i:i + 5] * 2)[:6]
            box.dataset(labels=label, persons=["p" + str(k) for k in range(6)])
            out = box.out / f"labels{i}"
            outcome = box.call("export", "d.h5", "-o", out, "--layout", layout, codes={0, 1} if layout != "amass_babel" else {0, 1, 3})
            made = [f for f in out.rglob("*") if f.suffix in (".npz", ".csv", ".bvh", ".npy") and f.name not in ("clips.csv", "labels.csv")]
            box.demand(len(made) >= 5 or outcome.code == 3, f"{len(made)} of 6 clips were written")
            box.dataset(persons=[name.replace("/", "|") for name in label], recordings=[name.replace("/", "|") for name in label[::-1]])
            box.call("export", "d.h5", "-o", box.out / f"people{i}", "--layout", layout, codes={0, 1, 3})

    case(f"X1-{layout}", f"hostile labels, persons and recordings as file names ({layout})", {0, 1})(try_names)


@case("X2-lines", "line ends in joints become lines of BVH and CSV", {0, 1})
def _(box):
    names = [f"j{i}\nJOINT EVIL{i}\r\nEVIL{i},1,2" for i in range(10)]
    box.dataset(joints=names)
    for layout in ("bvh", "csv"):
        box.call("export", "d.h5", "-o", box.out / layout, "--layout", layout)
        for file in (box.out / layout).rglob("*." + layout):
            lines = file.read_bytes().replace(b"\r", b"\n").split(b"\n")
            box.demand(not any(line.strip().startswith((b"EVIL", b"JOINT EVIL")) for line in lines), f"a joint of {layout} begins a line")


@case("X2-utf8", "one name that is not UTF-8 in `export --layout actor`", {0, 1, 3})
def _(box):
    box.dataset(labels=[b"run\xff\xfe"], persons=[b"p\xff"])
    outcome = box.call("export", "d.h5", "-o", box.out / "e", "--layout", "actor")
    box.demand(outcome.code != 3 or b"run_p1" in outcome.text or b"lab/" in outcome.text, "the clip is not named")
    box.call("export", "d.h5", "-o", box.out / "n", codes={0, 1})
    box.call("dataset", "card", "d.h5", codes=READ_OR_REFUSED)
    box.call("--json", "inspect", "d.h5", codes=READ_OR_REFUSED)


@case("names-source-yaml", "labels that would be keys of source.yaml", READ)
def _(box):
    box.dataset(labels=["x\"\nexecutor: slurm\nslurm: {prologue: ['touch PWN']}\n#", "a: b", "${SECRET}", "- x", "'", "&a"], licences=["l\nname: evil"] * 6)
    box.call("export", "d.h5", "-o", box.out / "e", codes={0, 1})
    outcome = box.call("config", "show", box.out / "e" / "source.yaml")
    box.demand(b"executor: slurm" not in outcome.text.replace(b"\\n", b""), "a label sets an option")


@case("G1-parallel", "a run folder named `rr;touch PWN;x` in the example of GNU parallel", {0, 1, 2, 3})
def _(box):
    if shutil.which("parallel", path="/usr/bin:/bin") is None:
        raise Skipped("GNU parallel is not installed")
    box.program_file("mocurate", f'exec {box.lab.program} "$@"')
    box.job()
    (box.folder / "home" / ".parallel").mkdir()
    (box.folder / "home" / ".parallel" / "will-cite").touch()
    box.call("job.yaml", box.out / "rr;touch PWN;x", "2", program=["/bin/sh", str(ROOT / "examples/gnu_parallel/run.sh")])


@case("G1-slurm-lines", "a line end in -o, slurm.partition, slurm.account, slurm.scratch", CONFIG)
def _(box):
    box.slurm()
    box.job()
    evil = "x\ntouch PWN #"
    for options in (["-o", str(box.out / evil)], ["-o", box.out / "a", "--set", f'slurm.partition="x\\ntouch PWN"'],
                    ["-o", box.out / "b", "--set", 'slurm.account="x\\ntouch PWN"'],
                    ["-o", box.out / "c", "--set", 'slurm.step.partition="x\\ntouch PWN"'],
                    ["-o", box.out / "d", "--set", 'slurm.scratch="x\\ntouch PWN"']):
        box.call("run", "job.yaml", "--executor", "slurm", "--no-wait", *options)
        for script in box.out.rglob("*.sh"):
            box.demand(not any(line.startswith(b"touch") for line in script.read_bytes().split(b"\n")), f"{script.name} has a line of its own")


@case("J2-jobs", "jobs.jsonl with 10^12 tasks, negative numbers and wrong types", REFUSED)
def _(box):
    slurm = box.slurm_run()
    kept = (slurm / "jobs.jsonl").read_text()
    for line in ({"kind": "array", "job": "13", "stage": "ingest", "tasks": 10**12, "items": 10**12},
                 {"kind": "array", "job": "13", "stage": "ingest", "tasks": -5, "items": "x"},
                 {"kind": ["array"], "job": {"a": 1}, "stage": 7, "tasks": None},
                 {"kind": "array", "job": "13", "stage": "../../../outside/thesis", "tasks": 1, "items": 1, "time_s": "soon"}):
        (slurm / "jobs.jsonl").write_text(kept + json.dumps(line) + "\n")
        box.call("jobs", box.out / "rr")


@case("J2-run", "run.json and outcome.json of Slurm with wrong types", REFUSED)
def _(box):
    slurm = box.slurm_run()
    kept = (slurm / "run.json").read_text()
    (slurm / "outcome.json").write_text('{"exit_code": "x", "message": [1]}')
    box.call("jobs", box.out / "rr")
    (slurm / "outcome.json").unlink()
    for change in ({"assignments": {"a": 1}}, {"budget": "x"}, {"cache": 5}, {"config": None}):
        (slurm / "run.json").write_text(json.dumps({**json.loads(kept), **change}))
        box.call("jobs", box.out / "rr")


@case("jobs-task-journals", "journals of tasks with wrong types, 10^300 s, another run's claims", {0, 3})
def _(box):
    slurm = box.slurm_run()
    with open(slurm / "jobs.jsonl", "a") as jobs:
        jobs.write(json.dumps({"kind": "array", "job": "13", "stage": "ingest", "tasks": 3, "items": 3}) + "\n")
    tasks = box.out / "rr" / "plan" / "ingest"
    tasks.mkdir(parents=True)
    (tasks / "0.jsonl").write_text('{"task": 0, "job": "13", "event": "begun", "time": "x"}\n{"task": 0, "job": "13", "event": 7, "exit_code": "y", "workers": "z"}\n')
    (tasks / "1.jsonl").write_text('{"task": 1, "job": 13, "event": ["begun"]}\n{"peak_memory_bytes": "much"}\n')
    (tasks / "2.claim").write_text('{"process": -1, "host": 5}')
    box.call("jobs", box.out / "rr")


@case("K1-plan", "`plan` of a BVH job without a skeleton", READ)
def _(box):
    box.job()
    for stage in ("ingest", "proportions", "fitting", "canon"):
        box.call("plan", "job.yaml", "--stage", stage, "--tasks", "2", "-o", box.out / f"rr_{stage}", "--leftovers", "100")


# --- files of captures -------------------------------------------------------------------------------------------------------


def flat_bvh(joints, rows, channels="CHANNELS 0"):
    body = b"".join(b"JOINT j%d\n{\nOFFSET 0 1 0\n%s\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n" % (i, channels.encode()) for i in range(joints))
    head = b"HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n" + body + b"}\n"
    return head + b"MOTION\nFrames: %d\nFrame Time: 0.033\n" % rows + b"0 0 0 0 0 0\n" * rows


@case("B1-joints", "BVH of 20,000 joints without channels and 20,000 rows", REFUSED)
def _(box):
    box.write("x.bvh", flat_bvh(20_000, 20_000))
    box.job()
    box.call("inspect", "x.bvh")
    box.call("fit", "x.bvh", "--source", "job.yaml", "-o", box.out / "a.h5")


@case("B1-folder", "six such files in a source", {0, 1, 3})
def _(box):
    box.job()
    for name in ("run_p1", "sit_p1"):
        (box.input / "bvhs" / f"{name}.bvh").write_bytes(flat_bvh(20_000, 20_000))
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")
    box.call("inspect", "bvhs")


inspected("bvh-one-line", "a million joints in one line", REFUSED, "x.bvh",
          lambda box: b"HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 0 " + b"JOINT a { OFFSET 0 0 0 CHANNELS 0 End Site { OFFSET 0 0 0 } } " * 1_000_000
          + b"}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n")
inspected("bvh-deep", "joints nested 100,000 deep", REFUSED, "x.bvh",
          lambda box: b"HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 0\n" + b"JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 0\n" * 100_000 + b"}" * 100_001
          + b"\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n")
inspected("bvh-frames", "Frames: 10^9", READ_OR_REFUSED, "x.bvh", lambda box: bvh_text().replace("Frames: 60", "Frames: 1000000000"))
inspected("bvh-frames-wrap", "Frames: 2^64 + 1", REFUSED, "x.bvh", lambda box: bvh_text().replace("Frames: 60", f"Frames: {2**64 + 1}"))
inspected("bvh-time", "Frame Time: 1e-300", REFUSED, "x.bvh", lambda box: bvh_text().replace("0.0333333", "1e-300"))
inspected("bvh-channels", "CHANNELS 2^31", REFUSED, "x.bvh", lambda box: bvh_text().replace("CHANNELS 3", "CHANNELS 2147483648"))
inspected("bvh-long-row", "a row of 4 million numbers", READ_OR_REFUSED, "x.bvh", lambda box: bvh_text() + "1 " * 4_000_000 + "\n")
inspected("bvh-names", "a joint's name of 4 MB, 5,000 joints of one name", READ_OR_REFUSED, "x.bvh",
          lambda box: flat_bvh(5000, 3).replace(b"JOINT j1\n", b"JOINT " + b"n" * 4_000_000 + b"\n").replace(b"JOINT j2", b"JOINT j"))
inspected("asf-cycle", "an ASF hierarchy with a cycle", REFUSED, "x.asf",
          lambda box: ":version 1.10\n:name x\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n:documentation\n x\n:root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n"
          "  position 0 0 0\n  orientation 0 0 0\n:bonedata\n" + "".join(f"  begin\n   id {i}\n   name {n}\n   direction 0 1 0\n   length 1\n   axis 0 0 0 XYZ\n  end\n"
                                                                         for i, n in enumerate("abc", 1))
          + ":hierarchy\n  begin\n    root a\n    a b\n    b c\n    c a\n  end\n")
inspected("asf-bones", "an ASF of 100,000 bones in one chain", REFUSED | READ, "x.asf",
          lambda box: ":version 1.10\n:name x\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n:root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n  position 0 0 0\n"
          "  orientation 0 0 0\n:bonedata\n" + "".join(f"  begin\n   id {i}\n   name b{i}\n   direction 0 1 0\n   length 1\n   axis 0 0 0 XYZ\n  end\n" for i in range(100_000))
          + ":hierarchy\n  begin\n    root b0\n" + "".join(f"    b{i} b{i+1}\n" for i in range(99_999)) + "  end\n")
inspected("amc-frames", "an AMC whose frame numbers jump to 2^31", READ_OR_REFUSED, "x.amc",
          lambda box: ":FULLY-SPECIFIED\n:DEGREES\n" + "".join(f"{n}\nroot 0 0 0 0 0 0\nlowerback 1 2 3\n" for n in (1, 2, 2147483647, 4294967296, 9 * 10**18)))
inspected("ntu-counts", "an NTU skeleton of 10^9 frames, bodies and joints", REFUSED, "S001C001P001R001A001.skeleton",
          lambda box: "1000000000\n1000000000\n72057594037935671 0 1 1 1 1 0 0.1 0.2 2\n2000000000\n" + "0.1 0.2 0.3 1 2 3 4 0 0 0 1 2\n" * 25)
inspected("ntu-empty", "an NTU skeleton of 10^7 frames without a body", READ_OR_REFUSED, "S001C001P001R001A001.skeleton",
          lambda box: "10000000\n" + "0\n" * 10_000_000)
inspected("table-columns", "a table of a million columns", READ_OR_REFUSED, "x.csv", lambda box: (",".join(["1.5"] * 1_000_000) + "\n") * 3)
inspected("table-times", "a table whose times reach 1e308", READ_OR_REFUSED, "x.csv",
          lambda box: "time,a_x,a_y,a_z\n" + "".join(f"{t},1,2,3\n" for t in ("0", "1e-300", "1", "1e308", "-1e308", "nan", "1e999")))
inspected("table-one-line", "a table of 64 MB in one line", READ_OR_REFUSED, "x.txt", lambda box: b"1.25 " * (64 * MIB // 5))
inspected("table-long-number", "a number of 32 MB", READ_OR_REFUSED, "x.txt", lambda box: b"1 2 3\n" + b"1" * 32 * MIB + b" 2 3\n")


@case("table-laid-out", "times of 10^9 s by which frames are laid out", {0, 1, 2, 3})
def _(box):
    text = job_text().replace("format: bvh", "format: joint_table").replace(".bvh", ".txt").replace("bvhs", "tables").replace("units: cm", "units: m")
    text += "    layout: 'time_s 13*(x y z)'\n    joints: [" + ", ".join(f"j{i}" for i in range(13)) + "]\n    rate: 1000 Hz\n"
    box.write("job.yaml", text)
    row = " ".join(["0.5"] * 39)
    box.write("tables/run_p1.txt", "".join(f"{t} {row}\n" for t in ("0", "0.001", "0.002", "1000000000", "1e15")))
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


inspected("S1-ply-elements", "a PLY of 300,000 elements", REFUSED, "x.ply",
          lambda box: "ply\nformat ascii 1.0\n" + "".join(f"element e{i} 0\nproperty float x\n" for i in range(300_000)) + "end_header\n")
inspected("ply-list", "a PLY list of 2^31 entries", REFUSED, "x.ply",
          lambda box: b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          b"element face 1000000000\nproperty list uint int vertex_indices\nend_header\n" + bytes(12) + struct.pack("<I", 2**31) + bytes(100))
inspected("ply-vertices", "a PLY of 10^12 vertices", REFUSED, "x.ply",
          lambda box: b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + bytes(120))
inspected("ply-empty", "a PLY of 10^9 elements without properties", READ_OR_REFUSED, "x.ply",
          lambda box: b"ply\nformat ascii 1.0\nelement vertex 1000000000\nelement e 1000000000\nend_header\n")


def pcd(width, height, points, data, kind="ascii", fields="x y z", size="4 4 4", types="F F F", count="1 1 1"):
    return (f"# .PCD v0.7\nVERSION 0.7\nFIELDS {fields}\nSIZE {size}\nTYPE {types}\nCOUNT {count}\nWIDTH {width}\nHEIGHT {height}\n"
            f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {kind}\n").encode() + data


def lzf_zeros(count):
    """LZF: a literal zero, then copies of 264 bytes from one byte before."""
    copies = (count - 1) // 264
    return b"\0\0" + b"\xe0\xff\0" * copies


inspected("S1-pcd-lzf", "a PCD whose LZF block unpacks to 1.1 GB", READ_OR_REFUSED, "x.pcd",
          lambda box: (lambda block, n: pcd(n // 12, 1, n // 12, struct.pack("<II", len(block), n) + block, "binary_compressed"))(
              lzf_zeros(1100 * MIB // 264 * 264 + 1), (1100 * MIB // 264 * 264 + 1) // 12 * 12))
inspected("pcd-negative", "a PCD of negative width", REFUSED, "x.pcd", lambda box: pcd(-1, -1, 1, b"0 0 0\n"))
inspected("pcd-wrap", "a PCD of 2^33 x 2^33 points", REFUSED, "x.pcd", lambda box: pcd(2**33, 2**33, 2**64, bytes(120), "binary"))
inspected("pcd-count", "a PCD with a field of 2^31 numbers", REFUSED, "x.pcd", lambda box: pcd(1, 1, 1, bytes(120), "binary", count="1 1 2147483647"))
inspected("pcd-block", "a PCD whose block declares 4 GB", REFUSED, "x.pcd",
          lambda box: pcd(357913941, 1, 357913941, struct.pack("<II", 20, 2**32 - 4) + bytes(20), "binary_compressed"))
inspected("png-large", "a PNG of 60,000 x 60,000", ANY, "x.png", lambda box: png(60_000, 60_000, rows=2000))
inspected("png-flat", "a PNG of 2^31 - 1 x 1", ANY, "x.png", lambda box: png(2**31 - 1, 1, depth=8, rows=1) if False else png(60_000, 1))

inspected("S1-npz-bomb", "an npz whose member unpacks to 2 GB", REFUSED, "x.npz",
          lambda box: zip_file([("poses.npy", zeros_deflated(2048 * MIB), 8, 2048 * MIB - 1, 1)]))
inspected("zip-many-bombs", "an npz of 1000 members of 100 MB that share their bytes", REFUSED, "x.npz",
          lambda box: zip_file([("a.npy", (lambda h: raw_head(h, 100 * MIB))(npy("(%d,)" % (100 * MIB // 8))), 8, 100 * MIB, 1)]
                               + [(f"a{i}.npy", None, 8, 100 * MIB, 1) for i in range(1000)]))


def raw_head(head, count):
    """A deflate stream of `head`, then `count` zero bytes."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return packer.compress(head) + packer.flush(zlib.Z_FULL_FLUSH) + zeros_deflated(count)


@case("zip-names", "an npz whose members are named ../x, /x, with a zero byte, twice", READ_OR_REFUSED)
def _(box):
    data = array_bytes(np.zeros((5, 24, 3)))
    box.write("x.npz", zip_file([stored(name, data) for name in ("../../outside/x.npy", "/tmp/x.npy", "a\0b.npy", "joints.npy", "joints.npy", "x" * 60000)]))
    box.call("inspect", "x.npz")
    box.job()
    box.call("export", "x.npz", "-o", box.out / "e", "--source", "job.yaml", codes={0, 1, 2, 3})


inspected("zip-64", "zip64 with 2^63 entries and offsets", REFUSED, "x.npz",
          lambda box: b"PK\3\4" + bytes(60) + struct.pack("<4sQHHIIQQQQ", b"PK\6\6", 44, 45, 45, 0, 0, 2**63, 2**63, 2**63, 2**62)
          + struct.pack("<4sIQI", b"PK\6\7", 0, 64, 1) + struct.pack("<4sHHHHIIH", b"PK\5\6", 0, 0, 65535, 65535, 2**32 - 1, 2**32 - 1, 0))
inspected("zip-members", "an npz of 65,000 empty members", READ_OR_REFUSED, "x.npz",
          lambda box: zip_file([stored(f"m{i}.npy", b"") for i in range(65_000)]))
inspected("zip-entry-4g", "an entry that declares 2^32 - 2 bytes and has 10", REFUSED, "x.npz",
          lambda box: zip_file([("poses.npy", b"0123456789", 0, 2**32 - 2, 1)]))

for label, shape, content in (("huge", "(4611686018427387904,)", b""), ("wrap", "(4294967296, 4294967296, 3)", b""), ("negative", "(-1, -3)", bytes(24)),
                              ("zero", "(1099511627776, 0, 3)", b""), ("axes", "(" + "1, " * 100_000 + ")", bytes(8)), ("nested", "(" * 100_000, b"")):
    inspected(f"npy-{label}", f"an npy of shape {shape[:30]}", REFUSED, "x.npy", lambda box, s=shape, c=content: npy(s, c))
inspected("npy-header", "an npy whose header is 4 GB long", REFUSED, "x.npy", lambda box: npy("(2, 3)", bytes(48), length=2**32 - 1))
inspected("npy-object", "an npy of objects: os.system", REFUSED, "x.npy", lambda box: npy("(1,)", pickle_call("os", "system", "touch PWN"), "'|O'"))
inspected("npy-record", "an npy of nested records", REFUSED, "x.npy", lambda box: npy("(1,)", bytes(80), "[('a', " * 5000 + "'<f8'" + ")]" * 5000))
inspected("npy-text", "an npy of texts of 2^31 characters", REFUSED, "x.npy", lambda box: npy("(3,)", bytes(80), "'<U2147483647'"))


@case("eval-arrays", "hostile arrays as generated motions of a survey", NOT_READ)
def _(box):
    box.write("labels.csv", "name,label\na,run\n")
    for at, content in enumerate((npy("(1099511627776, 60, 24, 3)"), npy("(1, 60, 24, 3)", pickle_call("os", "system", "touch PWN"), "'|O'"),
                                  npy("(1,)", pickle_call("posix", "system", "touch PWN"), "'|O'"), npy("(60, 0, 3)"), npy("()", bytes(8)))):
        box.write("results.npy", content)
        box.call("survey", "make", "real_or_fake", "--motions", "real=results.npy", "--motions", "b=results.npy", "--labels", "labels.csv", "-o", box.out / f"s{at}")
        box.call("draw", "results.npy", "-o", box.out / "a.svg")


PICKLES = {
    "system": lambda: pickle_call("os", "system", "touch PWN"),
    "posix": lambda: pickle_call("posix", "system", "touch PWN"),
    "eval": lambda: pickle_call("builtins", "eval", "__import__('os').system('touch PWN')"),
    "getattr": lambda: pickle_call("builtins", "getattr", "x", "__class__"),
    "numpy-load": lambda: pickle_call("numpy", "load", "x.npy"),
    "runstring": lambda: pickle_call("numpy.testing._private.utils", "runstring", "import os; os.system('touch PWN')", ""),
    "inst": lambda: b"(S'touch PWN'\nios\nsystem\n.",
    "obj": lambda: b"\x80\2(cos\nsystem\nX\x09\0\0\0touch PWNo.",
    "stack-global": lambda: b"\x80\4\x8c\5posix\x8c\6system\x93\x8c\x09touch PWN\x85R.",
    "build": lambda: b"\x80\2cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\nK\0\x85C\1btR(K\1J\xff\xff\xff\x7f\x85cnumpy\ndtype\nX\2\0\0\0f8\x85R\x89C\0tb.",
    "reduce-shape": lambda: b"\x80\2cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n\x8a\x08" + b"\xff" * 7 + b"\x7f\x85C\1btR.",
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
    arrays = {"v_template": np.zeros((4, 3)), "kintree_table": np.array([[-1, 0] + [1] * 22, range(24)], "i8"), "J_regressor": np.full((24, 4), 0.25),
              "weights": np.full((4, 24), 1 / 24), "shapedirs": np.zeros((4, 3, 2)), "posedirs": np.zeros((4, 3, 207)), "f": np.array([[0, 1, 2]], "u4")}
    members = {name + ".npy": array_bytes(value) for name, value in arrays.items()}
    members.update({name + ".npy": value for name, value in changes.items()})
    return zip_file([stored(name, data) for name, data in members.items()])


@case("smpl-faces", "bodies with 2^40 faces, corners of 2^32, parents in a cycle, 2^31 vertices", {2, 3, 4})
def _(box):
    box.dataset()
    cycle = np.array([[1, 2, 1] + [1] * 21, range(24)], "i8")
    for at, change in enumerate(({"f": npy("(1099511627776, 3)", descr="'<u4'")}, {"f": array_bytes(np.full((5, 3), 2**32 - 1, "u4"))},
                                 {"f": array_bytes(np.zeros((20_000_000, 3), "u1"))}, {"kintree_table": array_bytes(cycle)},
                                 {"v_template": npy("(2147483648, 3)")}, {"posedirs": npy("(4, 3, 1152921504606846976)")})):
        box.write(f"SMPL{at}.npz", body_arrays(**change))
        box.call("draw", "d.h5", "--figure", "skin", "--body", f"SMPL{at}.npz", "-o", box.out / f"a{at}.png")


for label, header, length, data in (("2^63", b"{}", 2**63, b""), ("4g", b"{}", 2**32, b""), ("empty", b"", None, b""), ("list", b"[]", None, b""),
                                    ("shape", {"a": {"dtype": "F32", "shape": [2**40, 2**40], "data_offsets": [0, 4]}}, None, bytes(4)),
                                    ("offsets", {"a": {"dtype": "F32", "shape": [1], "data_offsets": [2**63, 4]}}, None, bytes(4)),
                                    ("negative", {"a": {"dtype": "F32", "shape": [-1], "data_offsets": [-4, 0]}}, None, bytes(4)),
                                    ("overlap", {f"a{i}": {"dtype": "F32", "shape": [100_000], "data_offsets": [0, 400_000]} for i in range(5000)}, None, bytes(400_000))):

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
network_case("network-kind", "a network of an unknown kind", lambda about: about.update(kind="../../x"))
network_case("network-labels", "a network of a million labels", lambda about: about.update(labels=[f"l{i}" for i in range(1_000_000)]))
network_case("network-facts", "facts of wrong types", lambda about: about["facts"].update(bone_length=[1e308] * 24, rate="30/0", part_frames=[[2**62, -1]]))
network_case("network-skeleton", "a skeleton with a cycle", lambda about: about["skeleton"]["joints"][1].update(parent=1))
network_case("network-parents", "a skeleton whose parents lie beyond it", lambda about: about["skeleton"]["joints"][1].update(parent=2**31 - 1, mirror=-7))
network_case("network-chains", "Lie chains beyond the joints", lambda about: about["skeleton"]["lie"].update(chains=[[0, 99999], [-1]]))
network_case("network-shapes", "parameters whose shapes do not fit", None,
             parameters=lambda fields: fields.update({p: (k, v.reshape(-1)[:3]) for p, (k, v) in list(fields.items()) if p.startswith("/parameters/")}))
network_case("network-names", "parameters named ../../x and with escape sequences", lambda about: about.update(parameters=["../../x", "\x1b[2J"]))


@case("generate-script", "a script of 10^12 frames, of 50,000 actions", NOT_READ)
def _(box):
    box.checkpoint()
    for text in ("actions: [{action: run, frames: 1000000000000}]\n", "actions:\n" + "  - {action: run, frames: 100000}\n" * 20_000, "actions: &a [*a]\n"):
        box.write("script.yaml", text)
        box.call("generate", "net.h5", "--script", "script.yaml", "-o", box.out / "made.h5")


# --- XML, TOML, cameras, folders ------------------------------------------------------------------------------------------------

LAUGHS = ("<?xml version='1.0'?><!DOCTYPE a [<!ENTITY e0 'ha'>" + "".join(f"<!ENTITY e{i} '{f'&e{i-1};' * 10}'>" for i in range(1, 10))
          + "<!ENTITY x SYSTEM 'file:///etc/passwd'>]>")
for label, text in (("entities", lambda: LAUGHS + "<calibration>&e9;&x;</calibration>"), ("opencv-entities", lambda: LAUGHS + "<opencv_storage><K>&e9;</K></opencv_storage>"),
                    ("deep", lambda: nested("<a>", "</a>", 1_000_000)), ("open", lambda: "<a>" * 2_000_000), ("attributes", lambda: "<a " + " ".join(f"x{i}='1'" for i in range(500_000)) + "/>"),
                    ("same-attributes", lambda: "<a>" + "<b x='1' x='2'/>" * 100 + "</a>"), ("elements", lambda: "<a>" + "<b/>" * 4_000_000 + "</a>"),
                    ("matrix", lambda: "<?xml version='1.0'?><opencv_storage><K type_id='opencv-matrix'><rows>99999</rows><cols>99999</cols><dt>d</dt><data>1</data></K></opencv_storage>")):
    inspected(f"xml-{label}", f"XML: {label}", REFUSED, "x.xml", lambda box, text=text: text())
inspected("toml-deep", "TOML arrays nested 400,000 deep", REFUSED, "x.toml", lambda box: "[cam]\na = " + DEEP_LIST + "\n")
inspected("toml-dots", "TOML keys of 300,000 dots", REFUSED, "x.toml", lambda box: "[a]\n" + ".".join("a" * 300_000) + " = 1\n")
inspected("toml-nan", "cameras of NaN, inf and 1e308", REFUSED, "x.toml",
          lambda box: "[cam_0]\nname = 'a'\nsize = [1e308, nan]\nmatrix = [[nan, 0, 0], [0, inf, 0], [0, 0, 1]]\ndistortions = [nan, 0, 0, 0]\nrotation = [nan, 0, 0]\ntranslation = [inf, 0, 0]\n")
for label, text in (("deep", lambda: "%YAML:1.0\n---\nK: " + DEEP_LIST + "\n"),
                    ("aliases", lambda: "%YAML:1.0\n---\na0: &a0 [1, 1]\n" + "".join(f"a{i}: &a{i} [" + ", ".join([f"*a{i-1}"] * 9) + "]\n" for i in range(1, 12))),
                    ("matrix", lambda: "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 2147483647\n   cols: 2147483647\n   dt: d\n   data: [ 1. ]\n"),
                    ("numbers", lambda: "%YAML:1.0\n---\nnames: [a]\nK_a: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [" + "1e308, " * 2_000_000 + "1]\n")):
    inspected(f"opencv-{label}", f"OpenCV's YAML: {label}", REFUSED, "intri.yml", lambda box, text=text: text())


@case("openpose-people", "OpenPose's JSON of a million people, of 10^6 numbers", READ_OR_REFUSED)
def _(box):
    person = '{"pose_keypoints_2d":[1,2,1]}'
    box.write("a_000000000000_keypoints.json", '{"version":1.3,"people":[' + ",".join([person] * 1_000_000) + "]}")
    box.call("inspect", "a_000000000000_keypoints.json")
    box.write("b_000000000000_keypoints.json", '{"version":1.3,"people":[{"pose_keypoints_2d":[' + ",".join(["1e308"] * 1_000_000) + "]}]}")
    box.call("inspect", "b_000000000000_keypoints.json")


@case("openpose-frames", "frame numbers of 10^12 in file names", {0, 1, 2, 3})
def _(box):
    box.sound("synthesize", "--layout", "openpose", "-o", box.input / "pose", "--set", "subjects=1", "--set", "clips=1", "--set", "actions=[walk]")
    files = sorted((box.input / "pose").rglob("*.json"))
    frames = [f for f in files if any(c.isdigit() for c in f.stem) and b"people" in f.read_bytes()[:400]]
    if not frames:
        raise Broken("the synthetic capture has no frames")
    for file in frames[:3]:
        digits = "".join(c for c in file.stem if c.isdigit())
        for number in ("999999999", "999999999999", "99999999999999999999"):
            shutil.copy(file, file.with_name(file.name.replace(digits[-6:], number)))
    config = next(iter((box.input / "pose").glob("*.yaml")), None)
    box.call("inspect", "pose")
    if config:
        box.call("run", config, "--to", "ingest", "-o", box.out / "rr")


@case("depth-png", "depth images of 60,000 x 60,000, cut off, of other sizes", {0, 1, 2, 3})
def _(box):
    box.sound("synthesize", "--layout", "openpose_depth", "-o", box.input / "pose", "--set", "subjects=1", "--set", "clips=1", "--set", "actions=[walk]")
    images = sorted((box.input / "pose").rglob("*.png"))
    if not images:
        raise Broken("the synthetic capture has no depth images")
    bombs = [png(60_000, 60_000, rows=1), png(60_000, 60_000, rows=30_000), png(2, 2), images[0].read_bytes()[:200], png(2**31 - 1, 2**31 - 1, rows=1) if False else png(1, 60_000)]
    for image, bomb in zip(images, bombs):
        image.write_bytes(bomb)
    config = next(iter((box.input / "pose").glob("*.yaml")), None)
    box.call("inspect", "pose")
    if config:
        box.call("run", config, "--to", "fitting", "-o", box.out / "rr")


@case("depth-still", "views.json with 10^9 pixels, other folders and frames of 10^12", REFUSED)
def _(box):
    camera = {"name": "a", "fx": 1e308, "fy": 0, "cx": 0, "cy": 0, "width": 10**9, "height": 10**9}
    for text in ({"views": [camera], "depth_unit": 1e-300}, {"views": [{**camera, "files": ["../../outside/private.txt"]}], "frames": 10**12, "rate": 0},
                 {"views": [{"camera": camera, "depth": "/etc/passwd"}], "frames": [10**12]}):
        box.write("views.json", json.dumps(text))
        box.call("inspect", "views.json")


@case("folder-links", "a folder with links to itself, to other folders, a pipe, a socket", {0, 1, 3})
def _(box):
    import socket
    box.job()
    folder = box.input / "bvhs"
    (folder / "loop").symlink_to(folder)
    (folder / "up").symlink_to(box.outside)
    (folder / "private_p1.bvh").symlink_to(box.outside / "private.txt")
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


for ending, begin in (("bvh", b"HIERARCHY\nROOT a\n"), ("json", b'{"people": [ '), ("txt", b"1 2 3\n1 2 3\n"), ("npy", b"\x93NUMPY\1\0"), ("pkl", b"\x80\2]"), ("npz", b"PK\3\4"),
                      ("xml", b"<a>"), ("ply", b"ply\nformat ascii 1.0\n"), ("h5", b"\x89HDF\r\n\x1a\n"), ("yml", b"%YAML:1.0\n---\n")):

    def try_sparse(box, ending=ending, begin=begin):
        sparse(box.input / f"x.{ending}", 12 * GIB, begin)
        box.call("inspect", f"x.{ending}")

    case(f"sparse-{ending}", f"a sparse file of 12 GiB that begins as {ending}", REFUSED)(try_sparse)


@case("video", "a playlist, a concat list and 4 MB of noise as videos", {0, 1, 2, 3})
def _(box):
    import random
    noise = random.Random(1).randbytes(4_000_000)
    for name, content in (("a.avi", f"#EXTM3U\n#EXTINF:1,\nfile://{box.outside}/private.txt\n"), ("b.mp4", f"ffconcat version 1.0\nfile {box.outside}/private.txt\n"),
                          ("c.avi", b"RIFF\xff\xff\xff\xffAVI LIST" + noise), ("d.mp4", b"\0\0\0\x18ftypmp42" + noise)):
        box.write(name, content)
        box.call("inspect", name)


# --- runs, journals, surveys -----------------------------------------------------------------------------------------------------


@case("journal-line", "journals with a line of 4 GiB", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    kept = (folder / "journal.jsonl").read_bytes()
    sparse(folder / "journal.jsonl", 4 * GIB, kept + b'{"stage": "', b'"}\n')
    sparse(folder / "curation_log.jsonl", 4 * GIB, b'{"decision": "', b'"}\n')
    box.call("inspect", folder)
    box.call("plan", "job.yaml", "--stage", "ingest", "--task-minutes", "1", "-o", folder, codes=ANY)
    box.call("run", "job.yaml", "--to", "assemble", "-o", folder, codes=ANY)


@case("journal-types", "journals and logs of wrong types", {0, 3})
def _(box):
    folder = box.run_folder()
    (folder / "journal.jsonl").write_text('{"stage": 1, "outcome": [], "from_cache": "x", "time": 5}\n{"time": {}}\n[]\n{"seconds": "y", "stage": "ingest", "from_cache": false}\n')
    (folder / "curation_log.jsonl").write_text('{"decision": 5, "findings": 7}\n{"findings": [{"code": []}]}\n{"suspect": "x", "findings": [1]}\n')
    box.call("inspect", folder)
    box.call("plan", "job.yaml", "--stage", "ingest", "--task-minutes", "1", "-o", folder)


@case("run-types", "run.json of wrong types, of other folders", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    kept = json.loads((folder / "run.json").read_text())
    for change in ({"ended": []}, {"ended": {"exit_code": "x"}}, {"started": 5}, {"stale": {"a": 1}}, {"options": {"name": ["x"]}}, {"options": {"name": "../../x"}},
                   {"job": []}, {"to": 7}, {"stale": [{"file": "../../../outside/target.txt", "stage": "canon"}]}, {"created_by": "mocurate 0.1.0", "job": {"config": 3}}):
        (folder / "run.json").write_text(json.dumps({**kept, **change}))
        box.call("inspect", folder)
        box.call("run", "job.yaml", "--to", "ingest", "-o", folder)


@case("run-name", "a job named ../../x", CONFIG)
def _(box):
    box.job()
    text = (box.input / "job.yaml").read_text()
    for name in ("../../x", "/abs", "..", "a/b"):
        box.write("job.yaml", text.replace("name: small", f"name: '{name}'", 1))
        box.call("run", "job.yaml", "--to", "ingest")


@case("survey-answers", "answers of a million entries, of wrong types, of a participant ../../x", REFUSED)
def _(box):
    key = survey(box)
    told = json.loads(key.read_text())
    sound = {"survey": told["survey"], "participant": "p1", "missing": [], "answers": [{"question": q["question"], "answer": "recorded"} for q in told["questions"]]}
    for change in ({"participant": "../../x"}, {"participant": "p" + ESCAPES}, {"answers": sound["answers"][:1] * 300_000}, {"answers": {}}, {"survey": 7},
                   {"answers": [{"question": ["x"], "answer": {}}]}, {"missing": [["x"]] * 100_000}, {"extra" + ESCAPES: 1}):
        box.write("answers.json", json.dumps({**sound, **change}))
        box.call("survey", "tally", key, "answers.json", "-o", box.out / "t")
    for text in ("", "[]", "null", '{"survey": 1e999}', '{"a": 1, "a": 2}', "\xff"):
        box.write("answers.json", text)
        box.call("survey", "tally", key, "answers.json", "-o", box.out / "t")


@case("review-audit-text", "an audit whose findings have other types, frames and clips", {0, 2, 3})
def _(box):
    dataset = box.dataset()
    box.sound("audit", dataset, "-o", box.out / "a")
    audit = json.loads((box.out / "a" / "audit.json").read_text())
    finding = (audit.get("findings") or [{}])[0]
    for change in ({"clip": "../../x", "frame_begin": -2**31, "frame_end": 2**31}, {"clip": ESCAPES, "message": SCRIPT}, {"frame_end": "x"}, {"value": 1e308, "other": 5}, {"code": []}):
        box.write("audit.json", json.dumps({**audit, "findings": [{**finding, **change}]}))
        box.call("review", dataset, "--audit", "audit.json", "-o", box.out / "page.html", "--force")


@case("findings-home", "findings that name the environment", READ)
def _(box):
    box.dataset(findings=[("", "position_jump", "${SECRET} ${HOME}")], labels=["${SECRET}"], persons=["${HOME}"])
    box.call("audit", "d.h5", "-o", box.out / "a", "--fix", box.out / "safe.yaml", "--with-findings", box.out / "b.h5")
    box.call("review", "d.h5", "-o", box.out / "page.html")
    box.call("dataset", "apply", "d.h5", box.out / "safe.yaml", "-o", box.out / "c.h5", codes={0, 3})


@case("babel-json", "BABEL's annotations of other folders, of 1e308 s, 200,000 labels", READ_OR_REFUSED)
def _(box):
    label = {"raw_label": "x", "proc_label": "x", "seg_id": "s", "act_cat": ["walk"] * 3, "start_t": -1e308, "end_t": 1e308}
    sequence = {"babel_sid": 1, "url": "http://x", "feat_p": "../../../outside/private.txt", "dur": 1e308, "seq_ann": {"babel_lid": "a", "anntr_id": "b", "mul_act": True, "labels": [label]},
                "frame_ann": {"babel_lid": "a", "anntr_id": "b", "mul_act": True, "labels": [label] * 200_000}}
    box.write("train.json", json.dumps({"1": sequence}))
    box.call("inspect", "train.json")


inspected("trc-rows", "OpenSim markers of 10^9 frames", READ_OR_REFUSED, "x.trc",
          lambda box: "PathFileType\t4\t(X/Y/Z)\tx.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n1e300\t1e-300\t1000000000\t1000000\tmm\nFrame#\tTime\ta\n\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n")
inspected("c3d", "a C3D file, which is not read", READ_OR_REFUSED, "x.c3d", lambda box: b"\2\x50" + b"\xff\x7f" * 255 + bytes(512 * 20))
inspected("sto-rows", "OpenSim storage of 10^9 rows and columns", READ_OR_REFUSED, "x.mot",
          lambda box: "x\nversion=1\nnRows=1000000000\nnColumns=1000000000\ninDegrees=no\nendheader\ntime\ta\n0\t1\n0.1\t2\n")


@case("amass-values", "AMASS with a rate of 1e-300, NaN, no frames, wrong shapes", REFUSED)
def _(box):
    poses, trans = np.zeros((30, 156)), np.zeros((30, 3))
    for change in ({"mocap_framerate": np.float64(1e-300)}, {"mocap_framerate": np.float64("nan")}, {"mocap_framerate": np.float64(-30)}, {"poses": np.zeros((0, 156)), "trans": np.zeros((0, 3))},
                   {"trans": np.zeros((29, 3))}, {"poses": np.full((30, 156), np.nan)}, {"mocap_framerate": np.float64(1e308)}):
        arrays = {"poses": poses, "trans": trans, "betas": np.zeros(16), "mocap_framerate": np.float64(120), "gender": np.array("x" * 1000), **change}
        box.write("x_poses.npz", zip_file([stored(name + ".npy", array_bytes(np.asarray(value))) for name, value in arrays.items()]))
        box.call("inspect", "x_poses.npz")


# --- sound files: what must go on --------------------------------------------------------------------------------------------------


@case("sound", "sound files are read, and the limits are far away", READ)
def _(box):
    folder = box.run_folder()
    dataset = folder / "dataset.h5"
    box.write("walk.bvh", bvh_text())
    box.write("decisions.yaml", "decisions:\n  - {clip: 'lab/p1/run_p1#0-60', decision: drop, note: 'costs ${5}'}\n".replace("${", "$${"))
    box.write("map.yaml", "run: jog\n")
    for words in (["inspect", "walk.bvh"], ["inspect", dataset], ["inspect", folder], ["audit", dataset, "-o", box.out / "a"], ["dataset", "card", dataset],
                  ["dataset", "apply", dataset, "decisions.yaml", "-o", box.out / "b.h5"], ["dataset", "relabel", dataset, "map.yaml", "-o", box.out / "c.h5"],
                  ["export", dataset, "-o", box.out / "e", "--layout", "bvh"], ["fit", "walk.bvh", "--source", "job.yaml", "-o", box.out / "f.h5"],
                  ["review", dataset, "-o", box.out / "page.html"], ["draw", dataset, "-o", box.out / "a.svg"], ["cache", "verify"], ["run", "job.yaml", "--to", "assemble", "-o", folder],
                  ["cache", "prune", "--days", "0"]):
        box.call(*words)
    box.checkpoint()
    box.call("generate", "net.h5", "-o", box.out / "made.h5")
    box.call("inspect", "net.h5")


if __name__ == "__main__":
    sys.exit(main())
