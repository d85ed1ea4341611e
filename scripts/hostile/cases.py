"""The cases of hostile.sh: what each file is, and which exit codes are allowed. Expectations come before any run.

A case fails as well where a call ends by a signal or 70, takes too much time or memory, changes anything outside its
outputs and caches, shows the environment or another user's file, or prints bytes that a terminal acts on (lab.py).
"""
import json
import os
import shutil
import sys
from pathlib import Path

import h5py

import configs  # adds its cases, as the next two do
import data
import formats
from bombs import *
from lab import *


# --- P: plans and their workers ------------------------------------------------------------------------------------------


for label, worker in (
    ("absolute", "{box}/bin/evil"),
    ("parent", "../../../../../../../../..{box}/bin/evil"),
    ("proc", "/proc/self/cwd/../bin/evil"),
):

    def try_worker(box, worker=worker):
        box.program_file("evil", f"touch '{box.outside}/PWN' '{box.input}/PWN'")
        plan = box.plan()
        changed_plan(plan, lambda head: head.update(worker=worker.replace("{box}", str(box.folder))))
        run_tasks(box, plan)

    case(f"P1-worker-{label}", f"a plan whose worker is another program ({label})", READ_OR_REFUSED)(try_worker)


@case("P1-options", "a plan whose items have other options than its config", REFUSED)
def _(box):
    plan = box.plan()
    text = plan.read_bytes()
    box.demand(b'"max_gap":0.5' in text, "the plan does not have the option")
    plan.write_bytes(text.replace(b'"max_gap":0.5', b'"max_gap":9.5'))
    run_tasks(box, plan)


@case("P1-stage", "a plan whose stage is another one than its items were made for", NOT_READ)
def _(box):
    plan = box.plan()
    changed_plan(plan, lambda head: head.update(stage="canon"))
    run_tasks(box, plan)


@case("P1-limits", "a plan that allows its items 10^18 bytes and 10^300 s", READ_OR_REFUSED)
def _(box):
    plan = box.plan()
    changed_plan(plan, lambda head: head.update(limits={"time_s": 1e300, "memory_bytes": 10**18}))
    run_tasks(box, plan)


@case("P1-slurm-program", "slurm/run.json whose program is a command", {2})  # --next needs --config
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
    tables = sorted((box.input / "tables").glob("*/*/*.csv"))
    sound = [table.read_bytes() for table in tables]
    for table, content in zip(tables, sound[1:] + sound[:1]):
        table.write_bytes(content)
    box.call("run", "--plan", plan, "--task", "0")
    for table, content in zip(tables, sound):
        table.write_bytes(content)
    source = box.input / "tables" / "source.yaml"
    box.call("run", source, "--to", "assemble", "-o", box.out / "again", codes=READ)
    shutil.rmtree(box.cache)
    box.sound("run", source, "--to", "assemble", "-o", box.out / "anew")
    contents = [h5py.File(box.out / run / "dataset.h5").attrs["content_sha256"] for run in ("again", "anew")]
    box.demand(contents[0] == contents[1], "the cache serves the changed motion under the old name")


@case("plan-overflow", "a plan of 2^63 items and tasks whose last task is asked for", NOT_READ)
def _(box):
    plan = box.plan()
    changed_plan(plan, lambda head: head.update(items=2**63 - 1, tasks=2**63 - 1))
    box.call("run", "--plan", plan, "--task", str(2**63 - 2))


@case("plan-cache", "a plan whose cache is another folder", {0, 3, 4})
def _(box):
    plan = box.plan()
    changed_plan(plan, lambda head: head.update(cache=str(box.outside / "thesis")))
    run_tasks(box, plan)


@case("plan-config", "a plan whose config includes another user's file", NOT_READ)
def _(box):
    plan = box.plan()
    evil = box.write("evil.yaml", f"include: {box.outside}/private.yaml\n")
    changed_plan(plan, lambda head: head.update(config=str(evil)))
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
    changed_plan(plan, lambda head: head.update(items=-1, tasks=[1], arguments={"a": 1}))
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

for label, artifact in (
    ("parent", "../../../../outside/thesis"),
    ("absolute", "{outside}/thesis"),
    ("dots", ".."),
    ("folder", "../../../../outside"),
    ("file", "../../../../outside/target.txt"),
):

    def try_artifact(box, artifact=artifact):
        dataset = audited(box)
        size = {"outside": 0}.get(artifact.rsplit("/", 1)[-1], THESIS_BYTES)
        if artifact.endswith("target.txt"):
            size = 6
        if artifact.endswith("/outside"):
            size = sum(f.stat().st_size for f in box.outside.rglob("*") if f.is_file())
        edit_records(
            box, lambda value, _: value.update(artifact=artifact.replace("{outside}", str(box.outside)), bytes=size)
        )
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
    free = [f"{i:02x}" for i in range(256) if not (objects / f"{i:02x}").exists()]  # keys differ from run to run
    (objects / free[0]).symlink_to(box.outside / "thesis")
    (objects / free[1]).mkdir()
    (objects / free[1] / "cd").symlink_to(box.outside / "thesis" / "ab" / "cd")
    (objects / free[2]).symlink_to(box.outside / "thesis" / "ab")
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
    box.demand(
        (folder / "thesis.tex").exists() and (folder / "album" / "photo.jpg").exists(), "removed what it did not make"
    )


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
    values = [
        {"bytes": -1},
        {"bytes": 2**64},
        {"bytes": 1e308},
        {"artifact": 7},
        {"sha256": None},
        {"outcome": []},
        {"key": "0" * 64},
    ]

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
    box.call("audit", dataset, "--set", "labels.own_share=0.2")


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
    box.call("plan", box.tables(), "--replace", "--stage", "ingest", "--tasks", "1", "-o", folder)


@case("R1-tables", "`tables` of `audit -o` and the file of -o are links", {0, 2, 3, 74})
def _(box):
    box.dataset()
    audit = box.out / "audit"
    audit.mkdir()
    for name in ("audit.json", "clips.csv", "audit.html"):
        (audit / name).symlink_to(box.outside / "target.txt")
    box.call("audit", "d.h5", "-o", audit)


# --- runs, journals, surveys -----------------------------------------------------------------------------------------------------


@case("journal-line", "journals with a line of 1 GiB", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    kept = (folder / "journal.jsonl").read_bytes()
    sparse(folder / "journal.jsonl", GIB, kept + b'{"stage": "', b'"}\n')
    sparse(folder / "curation_log.jsonl", GIB, b'{"decision": "', b'"}\n')
    box.call("inspect", folder)
    box.call("plan", "job.yaml", "--stage", "ingest", "--task-minutes", "1", "-o", folder, codes=ANY)
    box.call("run", "job.yaml", "--to", "assemble", "-o", folder, codes=ANY)


@case("journal-types", "journals and logs of wrong types", {0, 3})
def _(box):
    folder = box.run_folder()
    (folder / "journal.jsonl").write_text(
        '{"stage": 1, "outcome": [], "from_cache": "x", "time": 5}\n{"time": {}}\n[]\n{"seconds": "y", "stage": "ingest", "from_cache": false}\n'
    )
    (folder / "curation_log.jsonl").write_text(
        '{"decision": 5, "findings": 7}\n{"findings": [{"code": []}]}\n{"suspect": "x", "findings": [1]}\n'
    )
    box.call("inspect", folder)
    box.call("plan", "job.yaml", "--stage", "ingest", "--task-minutes", "1", "-o", folder)


@case("run-types", "run.json of wrong types, of other folders", {0, 2, 3})
def _(box):
    folder = box.run_folder()
    kept = json.loads((folder / "run.json").read_text())
    for change in (
        {"ended": []},
        {"ended": {"exit_code": "x"}},
        {"started": 5},
        {"stale": {"a": 1}},
        {"options": {"name": ["x"]}},
        {"options": {"name": "../../x"}},
        {"job": []},
        {"to": 7},
        {"stale": [{"file": "../../../outside/target.txt", "stage": "canon"}]},
        {"created_by": "mocurate 0.1.0", "job": {"config": 3}},
    ):
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


@case("survey-answers", "answers of 300,000 entries, of wrong types, of a participant ../../x", REFUSED)
def _(box):
    _, sound = survey(box)
    key = box.out / "survey" / "key.json"
    for change in (
        {"participant": "../../x"},
        {"participant": "p" + ESCAPES},
        {"answers": sound["answers"][:1] * 300_000},
        {"answers": {}},
        {"survey": 7},
        {"answers": [{"question": ["x"], "answer": {}}]},
        {"missing": [["x"]] * 100_000},
        {"extra" + ESCAPES: 1},
    ):
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
    for change in (
        {"clip": "../../x", "frame_begin": -(2**31), "frame_end": 2**31},
        {"clip": ESCAPES, "message": SCRIPT},
        {"frame_end": "x"},
        {"value": 1e308, "other": 5},
        {"code": []},
    ):
        box.write("audit.json", json.dumps({**audit, "findings": [{**finding, **change}]}))
        box.call("review", dataset, "--audit", "audit.json", "-o", box.out / "page.html", "--force")


@case("findings-home", "findings that name the environment", READ)
def _(box):
    box.dataset(findings=[("", "position_jump", "${SECRET} ${HOME}")], labels=["${SECRET}"], persons=["${HOME}"])
    box.call("audit", "d.h5", "-o", box.out / "a", "--fix", box.out / "safe.yaml", "--with-findings", box.out / "b.h5")
    box.call("review", "d.h5", "-o", box.out / "page.html")
    box.call("dataset", "apply", "d.h5", box.out / "safe.yaml", "-o", box.out / "c.h5", codes={0, 3})


# --- sound files: what must go on --------------------------------------------------------------------------------------------------


@case("sound", "sound files are read, and the limits are far away", READ)
def _(box):
    folder = box.run_folder()
    dataset = folder / "dataset.h5"
    box.write("walk.bvh", bvh_text())
    box.write(
        "decisions.yaml",
        "decisions:\n  - {clip: 'lab/p1/run_p1#0-60', decision: drop, note: 'costs ${5}'}\n".replace("${", "$${"),
    )
    box.write("map.yaml", "run: jog\n")
    for words in (
        ["inspect", "walk.bvh"],
        ["inspect", dataset],
        ["inspect", folder],
        ["audit", dataset, "-o", box.out / "a"],
        ["dataset", "card", dataset],
        ["dataset", "apply", dataset, "decisions.yaml", "-o", box.out / "b.h5"],
        ["dataset", "relabel", dataset, "map.yaml", "-o", box.out / "c.h5"],
        ["export", dataset, "-o", box.out / "e", "--layout", "bvh"],
        ["fit", "walk.bvh", "--source", "job.yaml", "--skeleton", "smpl24", "-o", box.out / "f.h5"],
        ["review", dataset, "-o", box.out / "page.html"],
        ["draw", dataset, "-o", box.out / "a.svg"],
        ["cache", "verify"],
        ["run", "job.yaml", "--to", "assemble", "-o", folder],
        ["cache", "prune", "--days", "0"],
    ):
        box.call(*words)
    box.checkpoint()
    box.call("generate", "net.h5", "-o", box.out / "made.h5")
    box.call("inspect", "net.h5")


if __name__ == "__main__":
    sys.exit(main())
