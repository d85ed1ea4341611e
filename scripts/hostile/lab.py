"""Runs a program on hostile files, each case in a folder of its own, and judges what it did. Used by cases.py."""
import argparse
import fnmatch
import hashlib
import json
import math
import os
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
SECRET = "secret-5d1c7e"  # value of the environment variable SECRET
PRIVATE = "private-9e2b41"  # a line of a file outside the folder of the data
ALLOWED = ("out", "cache", "home", "tmp")  # where the program may write
LARGEST_SPACE = 16 << 30  # address space of a process
REFUSED = {3}  # the input is unusable
CONFIG = {2}  # a config, map or option is wrong
NOT_READ = {2, 3}  # refused, by whichever rule comes first
READ = {0}
READ_OR_REFUSED = {0, 3}
ANY = {0, 1, 2, 3, 4, 74, 75}  # whatever it says, it does no harm
CASES = []


class Case:
    def __init__(self, name, title, codes, make):
        self.name, self.title, self.codes, self.make = name, title, frozenset(codes), make


def case(name, title, codes):
    """Adds a case. `codes`: allowed exit codes. The function builds files in a Box and calls the program."""

    def add(make):
        CASES.append(Case(name, title, codes, make))
        return make

    return add


def inspected(name, title, codes, file, build):
    """A case that inspects one file. `build(box)` gives its bytes, or writes it and gives None."""

    @case(name, title, codes)
    def try_it(box):
        content = build(box)
        if content is not None:
            box.write(file, content)
        box.call("inspect", file)


class Skipped(Exception):
    """A case that cannot be tried on this machine."""


class Broken(Exception):
    """The sound part of a case failed."""


# --- what a call did ---------------------------------------------------------------------------------------------


def processes_below(pid):
    """The process and its descendants."""
    found, todo = [], [pid]
    while todo:
        process = todo.pop()
        found.append(process)
        try:
            for task in os.listdir(f"/proc/{process}/task"):
                todo += [int(child) for child in Path(f"/proc/{process}/task/{task}/children").read_text().split()]
        except OSError:
            pass  # it has ended
    return found


def resident_bytes(pid):
    """Now, and the most that the kernel saw."""
    try:
        facts = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0, 0
    sizes = dict(re.findall(r"^(VmRSS|VmHWM):\s+(\d+) kB", facts, re.MULTILINE))
    return 1024 * int(sizes.get("VmRSS", 0)), 1024 * int(sizes.get("VmHWM", 0))


class Outcome:
    """Of one call: `code` is negative for a signal; `megabytes` is the peak of the program and its workers together."""

    def __init__(self, arguments, code, seconds, megabytes, text, stopped):
        self.arguments, self.code, self.seconds, self.megabytes = arguments, code, seconds, megabytes
        self.text, self.stopped = text, stopped


def measured(arguments, folder, environment, stdin, limits, log, umask):
    """Runs a program. Resident memory of all its processes is summed every 5 ms; the kernel's peak of the largest one
    covers what lies between. (wait4's peak includes our own memory before the exec.) Three times a limit ends it."""
    with open(stdin or os.devnull, "rb") as source, open(log, "wb") as sink:
        begin = time.monotonic()
        process = subprocess.Popen(
            [os.fsencode(a) if isinstance(a, str) else a for a in arguments],
            cwd=folder,
            env=environment,
            stdin=source,
            stdout=sink,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            umask=umask,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (LARGEST_SPACE, LARGEST_SPACE)),
        )
        peak, stopped, known = 0, "", {process.pid}
        while True:
            if os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None:
                break
            tree = processes_below(process.pid)
            known.update(tree)
            sizes = [resident_bytes(one) for one in tree]
            peak = max([peak, sum(now for now, _ in sizes), *(most for _, most in sizes)])
            seconds = time.monotonic() - begin
            if peak > 3e6 * limits.memory or seconds > 3 * limits.time:
                stopped = "memory" if peak > 3e6 * limits.memory else "time"
                for one in tree:
                    try:
                        os.kill(one, signal.SIGKILL)
                    except ProcessLookupError:
                        pass
            time.sleep(0.005)
        seconds = time.monotonic() - begin
        process.wait()
    left = [one for one in known - {process.pid} if Path(f"/proc/{one}").exists() and resident_bytes(one)[0] > 0]
    deadline = time.monotonic() + 3
    while left and time.monotonic() < deadline:  # the kernel ends workers with their runner
        time.sleep(0.02)
        left = [one for one in left if resident_bytes(one)[0] > 0]
    for one in left:
        os.kill(one, signal.SIGKILL)
    with open(log, "rb") as lines:
        text = lines.read(64 << 20)
    outcome = Outcome(arguments, process.returncode, seconds, peak / 1e6, text, stopped)
    return outcome, left


UNSEEN = re.compile("[\x00-\x08\x0b-\x1f\x7f\x80-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def control_bytes(text):
    """What a terminal would act on: control characters but tab and line end, marks of text direction, bytes that are not
    UTF-8 (in which a C1 code may stand)."""
    try:
        decoded = text.decode()
    except UnicodeDecodeError as error:
        return f"byte 0x{text[error.start]:02x}, not UTF-8"
    found = UNSEEN.search(decoded)
    return f"U+{ord(found[0]):04X}" if found else ""


def snapshot(folder):
    """Kind, size, times, link target and (of small files) content of all entries but those where writing is allowed."""
    facts = {}
    for parent, folders, files in os.walk(os.fsencode(folder)):
        if Path(os.fsdecode(parent)) == folder:
            folders[:] = [name for name in folders if os.fsdecode(name) not in ALLOWED]
        for name in folders + files:
            path = os.path.join(parent, name)
            now = os.lstat(path)
            kind = stat.S_IFMT(now.st_mode)
            fact = [kind, stat.S_IMODE(now.st_mode)]
            if kind == stat.S_IFLNK:
                fact.append(os.readlink(path))
            elif kind == stat.S_IFREG:
                fact += [now.st_size, now.st_mtime_ns]
                if now.st_size < 1 << 20:
                    fact.append(hashlib.sha256(Path(os.fsdecode(path)).read_bytes()).hexdigest())
            facts[path] = fact
    return facts


def holds(file, text):
    with open(file, "rb") as stream:
        before = b""
        while part := stream.read(1 << 22):
            if text in before + part:
                return True
            before = part[-len(text) :]
    return False


# --- a case's folder ---------------------------------------------------------------------------------------------


class Box:
    """A folder with `in` (the hostile files; the program runs there), `out`, `cache`, `home`, `tmp` (where it may write)
    and `outside` (canaries: what no call may change, remove or show)."""

    def __init__(self, folder, lab, judged):
        self.folder, self.lab, self.judged = folder, lab, judged
        self.outcomes, self.problems, self.count = [], [], 0
        self.path = []  # folders before those of PATH
        for name in ("in", "bin", *ALLOWED):
            (folder / name).mkdir(parents=True)
        self.input, self.out, self.cache = folder / "in", folder / "out", folder / "cache"
        self.outside = folder / "outside"
        thesis = self.outside / "thesis"
        (thesis / "ab" / "cd").mkdir(parents=True)
        (thesis / "chapter1.txt").write_text("all of it\n")
        (thesis / "ab" / "cd" / "data.txt").write_text("years of work\n")
        (self.outside / "target.txt").write_text("12345\n")
        (self.outside / "private.txt").write_text(f"{PRIVATE} of another user\n" * 3)
        (self.outside / "private.yaml").write_text(f"{PRIVATE}: 1\n")
        os.utime(thesis / "ab" / "cd", (1, 1))
        for old in thesis.rglob("*.txt"):
            os.utime(old, (1, 1))

    def environment(self):
        return {
            "PATH": ":".join([*map(str, self.path), "/usr/bin:/bin"]),
            "HOME": str(self.folder / "home"),
            "MOCURATE_CACHE": str(self.cache),
            "TMPDIR": str(self.folder / "tmp"),
            "LC_ALL": "C.UTF-8",
            "SECRET": SECRET,
        }

    def write(self, name, content):
        path = self.input / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    def demand(self, fact, otherwise):
        if not fact:
            self.problems.append(otherwise)

    def sound(self, *arguments, codes=(0,)):
        """A call on sound files that prepares a case. Not judged."""
        outcome, _ = measured(
            [self.lab.program, *map(str, arguments)],
            self.input,
            self.environment(),
            None,
            self.lab.limits.wide(),
            self.folder / "prepared.log",
            -1,
        )
        if outcome.code not in codes:
            raise Broken(f"{' '.join(map(str, arguments))}: exit code {outcome.code}: {outcome.text[-300:]!r}")
        return outcome

    def call(self, *arguments, codes=None, program=None, stdin=None, umask=-1, binary=False):
        """A judged call. `binary`: its output is not for a terminal."""
        codes = self.judged.codes if codes is None else frozenset(codes)
        before = snapshot(self.folder)
        self.count += 1
        log = self.folder / f"{self.count}.log"
        command = [*(program or [self.lab.program]), *[a if isinstance(a, bytes) else str(a) for a in arguments]]
        log.touch()
        before[os.fsencode(log)] = None
        outcome, left = measured(command, self.input, self.environment(), stdin, self.lab.limits, log, umask)
        after = snapshot(self.folder)
        after[os.fsencode(log)] = None
        self.outcomes.append(outcome)
        wrong = self.problems.append
        limits = self.lab.limits
        if outcome.stopped:
            wrong(f"ended at three times the {outcome.stopped} limit")
        elif outcome.code < 0:
            wrong(f"signal {signal.Signals(-outcome.code).name}")
        elif outcome.code not in codes:
            wrong(f"exit code {outcome.code}" + (", a bug" if outcome.code == 70 else ""))
        if outcome.megabytes > limits.memory and outcome.stopped != "memory":
            wrong(f"{outcome.megabytes:.0f} MB")
        if outcome.seconds > limits.time and outcome.stopped != "time":
            wrong(f"{outcome.seconds:.1f} s")
        for path in sorted(before.keys() | after.keys()):
            name = os.fsdecode(os.path.relpath(path, os.fsencode(self.folder)))
            if path not in after:
                wrong(f"removed {name!r}")
            elif path not in before:
                wrong(f"made {name!r}")
            elif before[path] != after[path]:
                wrong(f"changed {name!r}")
        if not binary and (control := control_bytes(outcome.text)):
            wrong(f"prints {control}")
        for text, what in ((SECRET, "the variable SECRET"), (PRIVATE, "a private file")):
            if text.encode() in outcome.text:
                wrong(f"prints {what}")
            for file in self.made_files():
                if holds(file, text.encode()):
                    wrong(f"writes {what} to {file.relative_to(self.folder)}")
        if left:
            wrong(f"left {len(left)} processes")
        return outcome

    def made_files(self):
        for name in ALLOWED:
            for parent, _, files in os.walk(self.folder / name):
                for file in files:
                    path = Path(parent, file)
                    if path.is_file() and not path.is_symlink():
                        yield path

    # sound files, of which hostile ones are made

    def job(self, name="job.yaml", **more):
        """Six recordings and the config that reads them."""
        shutil.copytree(self.lab.sound_folder / "bvhs", self.input / "bvhs", dirs_exist_ok=True)
        return self.write(name, job_text(**more))

    def fields(self):
        return {path: (kind, value.copy()) for path, (kind, value) in self.lab.dataset().items()}

    def dataset(self, name="d.h5", **changes):
        fields = self.fields()
        change_dataset(fields, **changes)
        return write_fields(self.input / name, fields)

    def checkpoint(self, name="net.h5", about=None, parameters=None):
        """`about` and `parameters` change the description (a mapping) and the arrays of a sound network."""
        fields = {path: (kind, value) for path, (kind, value) in self.lab.network().items()}
        if about is not None:
            told = json.loads(fields["/about"][1][()])
            text = about(told)
            if text is None:
                text = json.dumps(told)
            fields["/about"] = ("text", np.array(text.encode(), dtype=object))
        if parameters is not None:
            parameters(fields)
        return write_fields(self.input / name, fields)

    def run_folder(self):
        """A run that has ended, with its job and its cache."""
        self.job()
        self.sound("run", "job.yaml", "--to", "assemble", "-o", self.out / "rr")
        return self.out / "rr"

    def tables(self):
        """The clips as tables of joints, with the config that reads them."""
        shutil.copytree(self.lab.tables(), self.input / "tables", dirs_exist_ok=True)
        return self.input / "tables" / "source.yaml"

    def views(self):
        """A capture by several cameras, with the config that reads it."""
        shutil.copytree(self.lab.views(), self.input / "openpose_depth")
        self.write(
            "views.yaml", "include: sources/studio_keypoints_depth.yaml\nname: views\ningest: {path: openpose_depth}\n"
        )
        return self.input / "openpose_depth"

    def plan(self):
        self.sound("plan", self.tables(), "--stage", "ingest", "--tasks", "2", "-o", self.out / "rr")
        return self.out / "rr" / "plan" / "ingest.json"

    def program_file(self, name, script):
        path = self.folder / "bin" / name
        path.write_text("#!/bin/sh\n" + script + "\n")
        path.chmod(0o755)
        if self.folder / "bin" not in self.path:
            self.path.append(self.folder / "bin")
        return path

    def slurm(self):
        """Programs in the place of Slurm's, which take any job and run none."""
        self.program_file("sbatch", "echo 12")
        self.program_file("squeue", "exit 0")
        self.program_file("scontrol", "echo 'MaxArraySize = 1001'; echo 'MaxJobCount = 10000'")

    def slurm_run(self):
        self.slurm()
        self.job()
        self.sound("run", self.input / "job.yaml", "-o", self.out / "rr", "--executor", "slurm", "--no-wait")
        return self.out / "rr" / "slurm"


# --- builders ----------------------------------------------------------------------------------------------------

JOINTS = [
    ("Hips", "", (0, 90, 0)),
    ("Spine", "Hips", (0, 20, 0)),
    ("Head", "Spine", (0, 40, 0)),
    ("LeftArm", "Spine", (20, 30, 0)),
    ("LeftHand", "LeftArm", (30, 0, 0)),
    ("RightArm", "Spine", (-20, 30, 0)),
    ("RightHand", "RightArm", (-30, 0, 0)),
    ("LeftUpLeg", "Hips", (10, 0, 0)),
    ("LeftLeg", "LeftUpLeg", (0, -40, 0)),
    ("LeftFoot", "LeftLeg", (0, -40, 0)),
    ("RightUpLeg", "Hips", (-10, 0, 0)),
    ("RightLeg", "RightUpLeg", (0, -40, 0)),
    ("RightFoot", "RightLeg", (0, -40, 0)),
]


def bvh_text(frames=60, phase=0.0, head="Head"):
    """A person who moves; `head` is the name of the joint at the head."""
    lines = ["HIERARCHY"]

    def joint(name, offset, indent):
        children = [(child, at) for child, parent, at in JOINTS if parent == name]
        lines.append(indent + ("JOINT " if indent else "ROOT ") + (head if name == "Head" else name))
        lines.append(indent + "{")
        lines.append(indent + "  OFFSET %g %g %g" % offset)
        lines.append(
            indent
            + "  CHANNELS "
            + ("3" if indent else "6 Xposition Yposition Zposition")
            + " Zrotation Xrotation Yrotation"
        )
        for child, at in children:
            joint(child, at, indent + "  ")
        if not children:
            lines.extend([indent + "  End Site", indent + "  {", indent + "    OFFSET 0 5 0", indent + "  }"])
        lines.append(indent + "}")

    joint("Hips", (0, 90, 0), "")
    lines += ["MOTION", f"Frames: {frames}", "Frame Time: 0.0333333"]
    for f in range(frames):
        row = [2 * math.sin(0.1 * f), 90.0, 1.0 * f, 0.0, 0.0, 0.0]
        for i in range(len(JOINTS) - 1):
            row += [
                20 * math.sin(0.2 * f + i + phase),
                10 * math.cos(0.13 * f + (1 + phase) * i),
                5 * math.sin(0.3 * f + i),
            ]
        lines.append(" ".join("%.4f" % value for value in row))
    return "\n".join(lines) + "\n"


def job_text(source="", more="", include=""):
    """A config of the six recordings; `source` and `more` are lines of YAML of ingest.source and of the top."""
    return (
        include
        + f"""name: small
ingest:
  path: bvhs
  source:
    name: lab
    format: bvh
    files: "{{label}}_{{person}}.bvh"
    axes: "+x +y +z"
    units: cm
    person: "{{person}}"
    recording: "{{label}}_{{person}}"
    label: "{{label}}"
{source}{more}"""
    )


KINDS = {"f4": "<f4", "f8": "<f8", "i4": "<i4", "i8": "<i8", "u1": "u1"}


def read_fields(file):
    """Fields of a file of mocurate: path -> (kind, array); texts are bytes."""
    fields = {}

    def take(path, value, dtype):
        if dtype.kind in "SO":
            texts = np.array(value, dtype=object)
            for at in np.ndindex(texts.shape):
                texts[at] = texts[at] if isinstance(texts[at], bytes) else str(texts[at]).encode()
            fields[path] = ("text", texts)
        else:
            fields[path] = (dtype.kind + str(dtype.itemsize), np.array(value))

    with h5py.File(file, "r") as store:
        for name, value in store.attrs.items():
            if name != "content_sha256":
                value = value.encode() if isinstance(value, str) else value
                take("/@" + name, value, np.dtype("S1"))

        def visit(name, node):
            if isinstance(node, h5py.Dataset):
                value = node.asstr()[()] if node.dtype.kind == "O" else node[()]
                take("/" + name, value, node.dtype)

        store.visititems(visit)
    return fields


def content_sha256(fields):
    """As docs/store_format.md defines it."""
    lines = hashlib.sha256()
    for path in sorted(fields):
        kind, array = fields[path]
        data = b"".join(text + b"\0" for text in array.flat) if kind == "text" else array.astype(KINDS[kind]).tobytes()
        shape = ",".join(map(str, array.shape))
        lines.update(f"{path} {kind} {shape} {hashlib.sha256(data).hexdigest()}\n".encode())
    return lines.hexdigest()


def write_fields(path, fields):
    with h5py.File(path, "w", libver=("v108", "v110")) as store:
        for field, (kind, array) in fields.items():
            if kind == "text":
                size = max([len(text) for text in array.flat] or [1])
                array = array.astype(f"S{max(size, 1)}")
            if field.startswith("/@"):
                store.attrs[field[2:]] = array[()]
            else:
                store[field] = array
        store.attrs["content_sha256"] = np.bytes_(content_sha256(fields))
    return path


def texts(*values):
    return ("text", np.array([v if isinstance(v, bytes) else v.encode() for v in values] or [], dtype=object))


def replaced(now, wanted):
    """The list `now` with its first entries replaced; texts become bytes."""
    wanted = [w if isinstance(w, bytes) else w.encode() for w in wanted or []]
    return wanted + list(now)[len(wanted) :]


def change_dataset(
    fields,
    labels=None,
    persons=None,
    recordings=None,
    sources=None,
    licences=None,
    rates=None,
    joints=None,
    findings=None,
    more=None,
):
    """Other names of clips (the first ones), joints, and findings (clip, code, message)."""
    clips = len(fields["/clips/id"][1])
    column = {
        name: replaced(fields["/clips/" + name][1], wanted)
        for name, wanted in (
            ("label", labels),
            ("person", persons),
            ("recording", recordings),
            ("source", sources),
            ("licence", licences),
            ("rate", rates),
        )
    }
    ends = fields["/clips/end_frame"][1]
    ids = [
        b"%s/%s/%s#0-%d" % (column["source"][i], column["person"][i], column["recording"][i], ends[i])
        for i in range(clips)
    ]
    order = sorted(range(clips), key=lambda i: ids[i])
    for name, values in column.items():
        fields["/clips/" + name] = texts(*[values[i] for i in order])
    fields["/clips/id"] = texts(*[ids[i] for i in order])
    classes = sorted({label for label in column["label"] if label})
    fields["/labels/name"] = texts(*classes)
    fields["/clips/class"] = (
        "i4",
        np.array([classes.index(column["label"][i]) if column["label"][i] else -1 for i in order], dtype="<i4"),
    )
    if rates:
        fields["/@rate"] = ("text", np.array(b"mixed", dtype=object))
    if joints:
        fields["/skeleton/names"] = texts(*replaced(fields["/skeleton/names"][1], joints))
    if findings is not None:
        count = len(findings)
        for name, values in (
            ("clip", [f[0] or os.fsdecode(ids[order[0]]) for f in findings]),
            ("code", [f[1] for f in findings]),
            ("message", [f[2] for f in findings]),
            ("joint", [""] * count),
            ("severity", ["warning"] * count),
            ("action", ["flagged"] * count),
        ):
            fields["/findings/" + name] = texts(*values)
        for name in ("frame_begin", "frame_end"):
            fields["/findings/" + name] = ("i4", np.zeros(count, dtype="<i4"))
        fields["/findings/value"] = ("f8", np.zeros(count))
    fields.update(more or {})


def changed_plan(plan, change):
    """Changes the head of a plan, which is on its first line."""
    first, rest = plan.read_bytes().split(b"\n", 1)
    document = json.loads(first + b"]}")
    change(document["head"])
    text = json.dumps(document).encode()
    plan.write_bytes(text[: -len(b"]}")] + b"\n" + rest)


def run_tasks(box, plan, codes=None):
    box.call("run", "--plan", plan, "--task", "0", codes=codes)


REAL_OR_FAKE = ("real_or_fake", "--questions", "1", "--clips", "2", "--figure", "bones")


def survey(box, name="sound.h5", **changes):
    """A key, and answers to it."""
    box.dataset(name, **changes)
    box.sound(
        "survey",
        "make",
        *REAL_OR_FAKE,
        "--motions",
        f"real={name}",
        "--motions",
        f"b={name}",
        "-o",
        box.out / "survey",
    )
    key = json.loads((box.out / "survey" / "key.json").read_text())
    answers = [{"question": question["question"], "answer": ["real", "real"]} for question in key["questions"]]
    return key, {"survey": key["survey"], "participant": "p1", "answers": answers, "missing": []}


# --- the laboratory ----------------------------------------------------------------------------------------------


class Limits:
    def __init__(self, memory, seconds):
        self.memory, self.time = memory, seconds  # MB, s

    def wide(self):
        return Limits(max(self.memory, 4000), max(self.time, 120))


class Lab:
    def __init__(self, program, work, limits):
        self.program, self.work, self.limits = program, work, limits
        self.sound_folder = work / "sound"
        self._dataset = self._network = None

    def prepare(self):
        """Sound recordings, whose copies the cases damage."""
        folder = self.sound_folder / "bvhs"
        folder.mkdir(parents=True)
        for i, (label, person) in enumerate((l, p) for l in ("run", "sit", "walk") for p in ("p1", "p2")):
            (folder / f"{label}_{person}.bvh").write_text(bvh_text(phase=0.7 * i))

    def _made(self, name, more, last, product):
        box = Box(self.work / name, self, Case(name, "", {0}, None))
        box.job(more=more)
        box.sound("run", "job.yaml", "--to", last, "-o", box.out / "rr")
        return read_fields(box.out / "rr" / product)

    def dataset(self):
        self._dataset = self._dataset or self._made("sound_dataset", "", "assemble", "dataset.h5")
        return self._dataset

    def tables(self):
        folder = self.work / "sound_tables"
        if not folder.exists():
            box = Box(folder, self, Case("sound_tables", "", {0}, None))
            box.sound(
                "export", write_fields(box.input / "d.h5", self.dataset()), "-o", box.out / "tables", "--layout", "csv"
            )
        return folder / "out" / "tables"

    def views(self):
        """A walk before four colour cameras with keypoints and three depth cameras."""
        folder = self.work / "sound_views"
        if not folder.exists():
            box = Box(folder, self, Case("sound_views", "", {0}, None))
            box.sound(
                "synthesize",
                "--layout",
                "openpose_depth",
                "-o",
                box.out / "views",
                "--set",
                "subjects=1",
                "--set",
                "clips=1",
                "--set",
                "actions=[walk]",
                "--set",
                "duration=1 s",
                codes=(0, 2),
            )
            if not (box.out / "views").exists():
                box.sound(
                    "synthesize",
                    "--layout",
                    "openpose_depth",
                    "-o",
                    box.out / "views",
                    "--set",
                    "subjects=1",
                    "--set",
                    "clips=1",
                    "--set",
                    "actions=[walk]",
                )
        return folder / "out" / "views" / "openpose_depth"

    def network(self):
        """A network after one iteration."""
        more = """assemble:
  splits: [{name: person, by: person, test: [p2]}]
train:
  networks: [{kind: action2motion, name: Tiny, split: person, input: resample, batch: 2, iterations: 1}]
"""
        self._network = self._network or self._made("sound_network", more, "train", "checkpoints/Tiny_1.h5")
        return self._network

    def try_case(self, one):
        box = Box(self.work / one.name, self, one)
        try:
            one.make(box)
            verdict = "WRONG" if box.problems else "ok"
        except Skipped as reason:
            verdict, box.problems = "skipped", [str(reason)]
        except Exception as reason:
            verdict, box.problems = "WRONG", [*box.problems, f"not tried: {type(reason).__name__}: {reason}"]
        codes = ",".join(str(o.code) for o in box.outcomes) or "-"
        seconds = max([o.seconds for o in box.outcomes] or [0.0])
        megabytes = max([o.megabytes for o in box.outcomes] or [0.0])
        expected = "|".join(map(str, sorted(one.codes)))
        print(
            f"{one.name:<28} {expected:>9} {codes:>8} {seconds:7.1f} {megabytes:7.0f}  {verdict}"
            + ("" if not box.problems else ": " + "; ".join(dict.fromkeys(box.problems))),
            flush=True,
        )
        return verdict


def remove(folder):
    for parent, folders, _ in os.walk(folder):
        for name in folders:
            path = os.path.join(parent, name)
            if not os.path.islink(path):
                os.chmod(path, 0o700)
    shutil.rmtree(folder)


def main():
    parser = argparse.ArgumentParser(prog="hostile.sh", description=__doc__.split("\n")[0])
    parser.add_argument(
        "--program",
        default=os.environ.get("MOCURATE") or str(ROOT / "build/release/bin/mocurate"),
        help="mocurate to try (default: $MOCURATE, else build/release/bin/mocurate)",
    )
    parser.add_argument(
        "--only", action="append", metavar="PATTERN", help="cases whose id matches, e.g. 'J1*'; may be repeated"
    )
    parser.add_argument(
        "--list", action="store_true", help="show the cases with their expected exit codes, run nothing"
    )
    parser.add_argument("--keep", metavar="DIR", help="build in DIR (new or empty) and keep it")
    parser.add_argument(
        "--memory", type=float, default=1000, metavar="MB", help="resident memory of program and workers (default 1000)"
    )
    parser.add_argument("--time", type=float, default=10, metavar="S", help="seconds of a call (default 10)")
    arguments = parser.parse_args()
    chosen = [
        one
        for one in CASES
        if not arguments.only or any(fnmatch.fnmatch(one.name, pattern) for pattern in arguments.only)
    ]
    if arguments.list:
        for one in chosen:
            print(f"{one.name:<28} {'|'.join(map(str, sorted(one.codes))):>9}  {one.title}")
        return 0
    program = shutil.which(arguments.program)
    if program is None:
        print(f"hostile.sh: {arguments.program} is no program; build it, or name one with --program", file=sys.stderr)
        return 4
    if not chosen:
        print("hostile.sh: no case matches; see --list", file=sys.stderr)
        return 2
    work = Path(arguments.keep or tempfile.mkdtemp(prefix="mocurate-hostile-")).resolve()
    work.mkdir(parents=True, exist_ok=True)
    if any(work.iterdir()):
        print(f"hostile.sh: {work} is not empty", file=sys.stderr)
        return 2
    try:
        lab = Lab(os.path.realpath(program), work, Limits(arguments.memory, arguments.time))
        lab.prepare()
        print(f"{'case':<28} {'expected':>9} {'code':>8} {'s':>7} {'MB':>7}")
        verdicts = []
        for one in chosen:
            verdicts.append(lab.try_case(one))
            if not arguments.keep:
                remove(work / one.name)
        wrong, skipped = verdicts.count("WRONG"), verdicts.count("skipped")
        print(
            f"{len(verdicts)} cases: {verdicts.count('ok')} ok, {wrong} wrong, {skipped} skipped; "
            f"limits {arguments.memory:g} MB, {arguments.time:g} s"
        )
        return 1 if wrong else 0
    finally:
        if not arguments.keep:
            remove(work)
