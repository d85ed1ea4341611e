"""Cases of hostile.sh: configs, data that look like configs, and texts of strangers. Expectations come before any run."""
import hashlib
import json
import os
import re
import shutil

import numpy as np

from bombs import *
from lab import *


# --- E: configs and data that look like configs --------------------------------------------------------------------------------


@case("E1-decisions", "decisions whose note, finding and dataset name the environment", {0, 2, 3})
def _(box):
    box.dataset()
    box.write(
        "decisions.yaml",
        "dataset: ${SECRET}\ndecisions:\n  - clip: 'lab/p1/run_p1#0-60'\n    decision: drop\n    note: ${SECRET}\n",
    )
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


@case("E1-spans", "canon.trim.spans: a table whose labels name the environment", {0, 2, 3})
def _(box):
    box.job(more="canon: {trim: {rule: annotated, spans: spans.csv}}\n")
    box.write("spans.csv", "clip,begin_s,end_s,label\nlab/p1/run_p1,0.1,1.5,${SECRET}\n")
    box.call("run", "job.yaml", "--to", "assemble", "-o", box.out / "rr")


@case("E1-skeleton", "a skeleton file that names the environment and includes another user's file", {0, 2, 3})
def _(box):
    box.write("walk.bvh", bvh_text())
    box.job()
    for text in ("name: ${SECRET}\njoints:\n  - {name: '${SECRET}'}\n", f"include: {box.outside}/private.yaml\n"):
        box.write("skeleton.yaml", text)
        box.call("fit", "walk.bvh", "--source", "job.yaml", "--skeleton", "skeleton.yaml", "-o", box.out / "new.h5")


@case("E1-rig", "a rig file that includes another user's file, and names the environment", {2, 3})
def _(box):
    box.views()
    for text in (f"include: {box.outside}/private.yaml\n", "rig: ${SECRET}\ncameras: [{name: '${SECRET}'}]\n"):
        box.write("rig.yaml", text)
        box.call(
            "run",
            "views.yaml",
            "--to",
            "fitting",
            "-o",
            box.out / "rr",
            "--set",
            "fitting.keypoints.rig=rig.yaml",
            "--set",
            "fitting.method=keypoints",
        )


@case("E1-config-include", "a config that includes files outside its folder", CONFIG)
def _(box):
    box.job("sound.yaml")
    for include in (
        f"{box.outside}/private.yaml",
        "../outside/private.yaml",
        "${PWD}/../outside/private.yaml",
        "link.yaml",
        "[link.yaml]",
        "sub/../../outside/private.yaml",
    ):
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
config_case(
    "yaml-deep-blocks",
    "YAML nested by 5,000 block lists",
    lambda: "a:\n" + "".join(" " + "- " * i + "\n" for i in range(1)) + " " + "- " * 5000 + "x\n",
)
config_case(
    "yaml-aliases",
    "nine aliases of nine aliases, ten times",
    lambda: "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [" + ", ".join([f"*a{i-1}"] * 9) + "]\n" for i in range(1, 11)),
)
config_case("yaml-cycle", "references in a cycle", "name: ${description}\ndescription: ${takes}\ntakes: ${name}\n")
config_case(
    "yaml-double",
    "each of 60 references is twice the one before",
    lambda: "description: ${ingest.expected.p60}\ningest:\n  expected:\n    p0: xx\n"
    + "".join(f"    p{i}: '${{ingest.expected.p{i-1}}}${{ingest.expected.p{i-1}}}'\n" for i in range(1, 61)),
)
config_case(
    "yaml-number",
    "numbers beyond all ranges",
    "evaluate: {seed: 1e999, repetitions: -1e400}\ntolerated_failures: .nan\n",
)
config_case("yaml-keys", "60,000 unknown keys", lambda: "".join(f"unknown_option_{i}: {i}\n" for i in range(60_000)))
config_case(
    "yaml-references", "30,000 references to nothing", lambda: "".join(f"k{i}: ${{n{i}}}\n" for i in range(30_000))
)
config_case(
    "yaml-long-key", "a key of 8 MB, a value of 8 MB", lambda: "x" * 8_000_000 + ": 1\nname: " + "y" * 7_000_000 + "\n"
)
config_case(
    "yaml-binary",
    "control characters, tags, merge keys",
    "name: !!python/object/apply:os.system ['touch PWN']\n<<: {a: 1}\n",
)
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
    text = (
        (box.input / "job.yaml")
        .read_text()
        .replace("{label}_{person}.bvh", fields + ".bvh")
        .replace("{label}_{person}", "{f1}")
        .replace("{label}", "{f2}")
        .replace("{person}", "{f3}")
    )
    box.write("job.yaml", text)
    for i in range(200):
        box.write(f"bvhs/{'a' * 240}{i:03d}.bvh", bvh_text(frames=3))
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("skeleton-cycle", "skeletons with cycles of parents, 100,000 joints, a joint that is its own parent", NOT_READ)
def _(box):
    box.write("walk.bvh", bvh_text())
    box.job()
    joint = "  - {{name: {0}, parent: {1}, rest_offset: [0, 0.1, 0]}}\n"
    for text in (
        joint.format("a", "b") + joint.format("b", "a"),
        joint.format("a", "a"),
        joint.format("j0", '""') + "".join(joint.format(f"j{i}", f"j{i-1}") for i in range(1, 12_000)),
    ):
        box.write("skeleton.yaml", "name: odd\njoints:\n" + text)
        box.call("fit", "walk.bvh", "--source", "job.yaml", "--skeleton", "./skeleton.yaml", "-o", box.out / "new.h5")


@case("decisions-bombs", "decisions with aliases, 90,000 entries of one clip, numbers beyond all", NOT_READ)
def _(box):
    box.dataset()
    entry = "  - {clip: 'lab/p1/run_p1#0-60', decision: keep, finding: f%d}\n"
    for text in (
        "decisions: &a [*a]\n",
        "decisions:\n"
        + "".join("  - {clip: 'lab/p1/run_p1#0-60', decision: cut, begin: 0, end: 1e300}\n" for _ in range(3)),
        "decisions:\n" + "".join(entry % i for i in range(12_000)) + "  - {clip: x, decision: drop, label: y}\n",
    ):
        box.write("decisions.yaml", text)
        box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "new.h5")


@case("relabel-bombs", "a map of 90,000 classes, of 19,000 rules", {0, 2, 3})
def _(box):
    box.dataset()
    box.write(
        "map.yaml",
        "classes: [" + ", ".join(f"c{i}" for i in range(90_000)) + "]\nlabels: {run: c1, sit: c2, walk: c3}\n",
    )
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new.h5")
    box.write("map.yaml", "rules:\n" + "".join(f'  - {{where: "frames > {i}", label: c{i}}}\n' for i in range(30_000)))
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "new2.h5")


@case("S1-conditions", "a map with a condition of 100,000 `and`, one of 100,000 brackets", {0, 2, 3})
def _(box):
    box.dataset()
    for where in (
        " and ".join(["frames > 0"] * 100_000),
        "(" * 100_000 + "frames > 0" + ")" * 100_000,
        "not " * 100_000 + "frames > 0",
        "label in [" + ", ".join(f"l{i}" for i in range(200_000)) + "]",
    ):
        box.write("map.yaml", f'rules:\n  - {{where: "{where}", label: c}}\n')
        box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / f"new{len(where)}.h5")


@case("regex-bombs", "regular expressions that backtrack or grow", {0, 2, 3})
def _(box):
    box.dataset(labels=["a" * 2000] * 6)
    for at, pattern in enumerate(
        (
            "(a*)*b",
            "((a|a)*)*$",
            "(a+){60}",
            "((((a{9}){9}){9}){9}){9}",
            "(.*)(.*)(.*)(.*)(.*)(.*)x",
            "[" * 100,
            "a{99999}",
            "(a?){60}a{60}",
            "(" * 120,
        )
    ):
        box.write("map.yaml", "rules:\n  - {where: \"label =~ '" + pattern + "'\", label: c}\n")
        box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / f"new{at}.h5")


@case("wildcard-bomb", "a known issue of many stars against long names", {0, 2, 3})
def _(box):
    box.job(source="    known_issue_lists: [issues.yaml]\n")
    box.write(
        "issues.yaml",
        "issues:\n  - {kind: k, source: s, note: n, clips: [" + ", ".join(["'" + "*a" * 2000 + "*b'"] * 2000) + "]}\n",
    )
    box.call("run", "job.yaml", "--to", "ingest", "-o", box.out / "rr")


@case("spans-bombs", "spans of 1e308 s, without numbers, 300,000 of one clip", {0, 1, 2, 3})
def _(box):
    box.job(more="canon: {trim: {rule: annotated, spans: spans.csv}}\n")
    head = "clip,begin_s,end_s,label\n"
    for at, text in enumerate(
        (
            "lab/p1/run_p1,-1e308,1e308,x\nlab/p1/run_p1,nan,inf,y\n",
            "lab/p1/run_p1,0,1e300,../../x\n",
            "".join(f"lab/p1/run_p1,{i * 1e-6:.7f},1,x\n" for i in range(300_000)),
        )
    ):
        box.write("spans.csv", head + text)
        box.call("run", "job.yaml", "--to", "canon", "-o", box.out / f"rr{at}")


# --- N, M, X, G: texts of strangers ------------------------------------------------------------------------------------------


def escaped_dataset(box):
    box.dataset("sound.h5")
    box.dataset(
        labels=["run" + ESCAPES] * 2 + ["sit\nFAKE: all well"] * 2,
        persons=["p" + ESCAPES] * 3,
        recordings=["r" + ESCAPES],
        sources=["lab" + ESCAPES] * 6,
        licences=["free" + ESCAPES] * 6,
        joints=["hips" + ESCAPES, "a\nFAKE"],
        findings=[("", "position_jump", "jump" + ESCAPES), ("", "code" + ESCAPES, "\nFAKE: nothing")],
    )


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
    "survey": ["survey", "make", *REAL_OR_FAKE, "--motions", "real=d.h5", "--motions", "b=sound.h5", "-o", "{out}/s"],
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
        box.demand(
            not any(line.startswith(b"FAKE") for line in outcome.text.split(b"\n")), "a text of the file begins a line"
        )

    case(f"N1-{verb}", f"escape sequences of a dataset in `{' '.join(words[:2])}`", {0, 1, 2, 3})(try_escapes)


def escaped_file(name, title, file, content, codes=READ_OR_REFUSED):
    inspected(f"N1-{name}", title, codes, file, content)


escaped_file(
    "bvh", "escape sequences in a joint's name", "x.bvh", lambda box: bvh_text(head="Head\x1b[2J\x9b31m\u202ex")
)
escaped_file(
    "npy", "escape sequences in the type of an npy", "x.npy", lambda box: npy("(4, 3)", bytes(96), "'<\x1b[2Jf8\x9b'")
)
escaped_file(
    "pickle",
    "escape sequences in the class of a pickle",
    "x.pkl",
    lambda box: pickle_call("os\x1b[2J", "sys\x9btem", "x"),
)
escaped_file(
    "npz",
    "escape sequences in a member's name",
    "x.npz",
    lambda box: zip_file([stored("\x1b[2Ja\x9b.npy", npy("(2, 3)", bytes(48)))]),
)
escaped_file("xml", "escape sequences in XML", "x.xml", lambda box: "<a\x9b31m b='\u202e'><c>\x9b2J</c></a>")
escaped_file(
    "json",
    "escape sequences in JSON",
    "x.json",
    lambda box: '{"\\u001b[2J\x9b": [1], "people": [{"\u202e": "\\u009b"}]}',
)
escaped_file(
    "csv",
    "escape sequences in the header of a table",
    "x.csv",
    lambda box: "time,\x1b[2Ja_x,\x9ba_y,a\u202e_z\n" + "0,1,2,3\n0.1,1,2,3\n" * 3,
)
escaped_file(
    "amc",
    "escape sequences in bones",
    "x.asf",
    lambda box: ":version 1.10\n:name \x1b[2Jx\x9b\n:units\n length 0.45\n:root\n order \x9b\n",
)
escaped_file(
    "toml", "escape sequences in TOML", "x.toml", lambda box: "[cam\x9b]\nname = '\u202e\x9b'\nsize = [1, 2]\n", ANY
)


@case("N1-file-names", "a folder of files with escape sequences, line ends and other bytes in their names", {0, 1, 3})
def _(box):
    for name in (
        b"\x1b[2Jwalk_p1.bvh",
        b"a\nFAKE_p1.bvh",
        b"\xff\xfe_p1.bvh",
        b"\xc2\x9b31m_p1.bvh",
        "\u202ex_p1.bvh".encode(),
        b"-rf_p1.bvh",
        b"a" * 240 + b"_p1.bvh",
    ):
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
    (folder / "journal.jsonl").write_text(
        json.dumps({"stage": "fitting" + ESCAPES, "outcome": "done" + ESCAPES, "time": "9999"}) + "\n"
    )
    (folder / "curation_log.jsonl").write_text(json.dumps({"decision": ESCAPES, "clip": ESCAPES}) + "\n")
    box.call("inspect", folder)
    box.call("run", "job.yaml", "-o", folder, codes=ANY)


@case("N1-jobs", "escape sequences in the files of a run on Slurm", {0, 2, 3})
def _(box):
    slurm = box.slurm_run()
    with open(slurm / "jobs.jsonl", "a") as jobs:
        jobs.write(
            json.dumps({"kind": "array", "job": "13" + ESCAPES, "stage": "ingest" + ESCAPES, "tasks": 1, "items": 1})
            + "\n"
        )
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
    changed_plan(plan, lambda head: head.update(config="x" + ESCAPES, arguments=["a=" + ESCAPES]))
    run_tasks(box, plan)
    plan = box.out / "rr" / "plan" / "ingest.json"
    changed_plan(plan, lambda head: head.update(stage="x" + ESCAPES))
    run_tasks(box, plan)


@case("N1-decisions", "escape sequences in decisions, maps and tables", {0, 1, 2, 3})
def _(box):
    box.dataset()
    escaped = json.dumps("x" + ESCAPES)
    box.write("decisions.yaml", f"decisions:\n  - {{clip: {escaped}, decision: drop}}\n")
    box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "a.h5")
    box.write(
        "decisions.yaml",
        f"decisions:\n  - {{clip: 'lab/p1/run_p1#0-60', decision: relabel, label: {escaped}, note: {escaped}}}\n",
    )
    box.call("dataset", "apply", "d.h5", "decisions.yaml", "-o", box.out / "a.h5")
    box.write("map.yaml", f"{escaped}: {escaped}\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "a.h5")
    box.write("map.yaml", "clips: t.csv\n")
    box.write("t.csv", "clip,label\n" + "x" + ESCAPES + ",a\n" + "x" + ESCAPES + ",b\n")
    box.call("dataset", "relabel", "d.h5", "map.yaml", "-o", box.out / "a.h5")
    box.write("job.yaml", f"{escaped}: 1\n")
    box.call("config", "show", "job.yaml")


MARKUP = [
    "<script>alert(1)</script>",
    "[click](http://evil.example)",
    "# heading",
    "| a | b |\n|---|---|",
    "=cmd|'/c calc'!A1",
]


@case("M1-card", "markup in labels, licences and recipes of `dataset card`", READ)
def _(box):
    box.dataset(
        labels=MARKUP,
        persons=MARKUP,
        licences=MARKUP + ["![x](http://evil.example/p.png)"],
        sources=["a<b>\n# heading"] * 6,
        findings=[("", "<script>", SCRIPT)],
        more={"/recipe": ("text", np.array(b"```\n# heading\n<script>alert(1)</script>\n```", dtype=object))},
    )
    outcome = box.call("dataset", "card", "d.h5")
    plain = outcome.text.split(b"```")[0::2]  # outside of blocks of code
    shown = b"".join(plain)
    box.demand(b"<script" not in shown, "the card has <script>")
    box.demand(not re.search(rb"(?<!\\)\]\(http", shown), "the card has a link")
    box.demand(b"\n# heading" not in shown, "the card has a heading of a label")
    box.call("dataset", "card", "d.h5", "--croissant")


@case("M1-tally", "markup in the sources and labels of a survey's key", READ)
def _(box):
    key, _ = survey(box)
    evil = [f"=1+1{SCRIPT}", "@sum(1)|[x](http://evil.example)"]
    text = json.dumps({name: value for name, value in key.items() if name != "survey"})
    text = text.replace('"b"', json.dumps(evil[0])).replace(json.dumps(key["labels"][0]), json.dumps(evil[1]))
    key = json.loads(text)
    key["survey"] = hashlib.sha256(json.dumps(key, sort_keys=True, separators=(",", ":")).encode()).hexdigest()[:16]
    box.write("key.json", json.dumps(key))
    answers = [{"question": question["question"], "answer": ["real", "real"]} for question in key["questions"]]
    box.write(
        "answers.json", json.dumps({"survey": key["survey"], "participant": "p1", "missing": [], "answers": answers})
    )
    outcome = box.call("survey", "tally", "key.json", "answers.json", "-o", box.out / "t")
    if outcome.code == 0:
        made = {file.name: file.read_bytes() for file in (box.out / "t").iterdir()}
        for name in ("tally.md", "figure.svg"):
            box.demand(b"<script" not in made[name], f"{name} has <script>")
        for line in made["tally.csv"].split(b"\n") + made["differences.csv"].split(b"\n"):
            box.demand(
                not any(cell.strip(b'"').startswith((b"=", b"@")) for cell in line.split(b",")),
                "a cell of a table is a formula",
            )


@case("M1-csv", "labels that a spreadsheet calculates", {0, 1})
def _(box):
    box.dataset(labels=["=cmd|'/c calc'!A1", "@sum(1)", "+1", "-1+1", "\t=1"], persons=["=1"] * 3)
    box.call("export", "d.h5", "-o", box.out / "e")
    box.call("audit", "d.h5", "-o", box.out / "a")
    box.call("export", "d.h5", "-o", box.out / "c", "--layout", "csv")
    for folder in ("e", "a", "c"):
        for line in (box.out / folder / "clips.csv").read_bytes().split(b"\n"):
            for cell in line.split(b","):
                number = re.fullmatch(rb"[+-]?[0-9.e+-]+", cell.strip(b'"'))
                box.demand(
                    number or not cell.strip(b'"').startswith((b"=", b"@", b"+", b"\t")),
                    f"a cell of {folder}/clips.csv is a formula",
                )


@case("M1-pages", "markup in pages of review, annotation, survey and audit", READ)
def _(box):
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
    box.dataset(
        labels=[evil] * 3 + ["ok"] * 3, persons=[evil] * 6, joints=[evil], findings=[("", "position_jump", evil)]
    )
    box.write("decisions.yaml", "decisions:\n  - {clip: 'x', decision: drop, note: " + json.dumps(evil) + "}\n")
    box.call("review", "d.h5", "--decisions", "decisions.yaml", "-o", box.out / "review.html")
    box.call("review", "d.h5", "--annotate", "--labels", "a", "--all", "-o", box.out / "annotate.html")
    box.call("survey", "make", *REAL_OR_FAKE, "--motions", "real=d.h5", "--motions", "b=d.h5", "-o", box.out / "s")
    box.call("audit", "d.h5", "-o", box.out / "a")
    box.call("draw", "d.h5", "-o", box.out / "a.svg")
    for page in list(box.out.rglob("*.html")) + list(box.out.rglob("*.svg")):
        text = page.read_bytes()
        box.demand(b"<script>alert" not in text and b"<img src=x" not in text, f"{page.name} has the markup")


NAMES = [
    "clips.csv",
    "source.yaml",
    "x" * 300,
    "../../x",
    "/etc/x",
    "con",
    ".",
    "..",
    "a\nb",
    "\u202egpj",
    "\U0001F525",
    "-rf",
    "~",
    "$HOME",
    "a/b/c",
]

for layout in ("npz", "csv", "bvh", "humanact12", "amass_babel"):

    def try_names(box, layout=layout):
        for i in range(0, len(NAMES), 5):
            names = [*NAMES[i : i + 5], "plain"]
            box.dataset(labels=names)
            out = box.out / f"labels{i}"
            box.call("export", "d.h5", "-o", out, "--layout", layout)
            made = [file for file in out.rglob("*") if file.suffix in (".npz", ".csv", ".bvh", ".npy")]
            made = [file for file in made if file.parent != out or file.name not in ("clips.csv", "labels.csv")]
            box.demand(len(made) >= 5, f"{len(made)} of 6 clips were written")
            names = [name.replace("/", "|") for name in names]
            box.dataset(persons=names, recordings=names)
            box.call("export", "d.h5", "-o", box.out / f"people{i}", "--layout", layout)

    case(f"X1-{layout}", f"hostile labels, persons and recordings as file names ({layout})", {0, 1})(try_names)


@case("X2-lines", "line ends in joints become lines of BVH and CSV", {0, 1})
def _(box):
    names = [f"j{i}\nJOINT EVIL{i}\r\nEVIL{i},1,2" for i in range(10)]
    box.dataset(joints=names)
    for layout in ("bvh", "csv"):
        box.call("export", "d.h5", "-o", box.out / layout, "--layout", layout)
        for file in (box.out / layout).rglob("*." + layout):
            lines = file.read_bytes().replace(b"\r", b"\n").split(b"\n")
            box.demand(
                not any(line.strip().startswith((b"EVIL", b"JOINT EVIL")) for line in lines),
                f"a joint of {layout} begins a line",
            )


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
    box.dataset(
        labels=["x\"\nexecutor: slurm\nslurm: {prologue: ['touch PWN']}\n#", "a: b", "${SECRET}", "- x", "'", "&a"],
        licences=["l\nname: evil"] * 6,
    )
    box.call("export", "d.h5", "-o", box.out / "e", codes={0, 1})
    outcome = box.call("config", "show", box.out / "e" / "source.yaml")
    box.demand(b"executor: local" in outcome.text.split(b"\n"), "a label sets an option")


@case("G1-parallel", "a run folder named `rr;touch PWN;x` in the example of GNU parallel", {0, 1, 2, 3})
def _(box):
    if shutil.which("parallel", path="/usr/bin:/bin") is None:
        raise Skipped("GNU parallel is not installed")
    box.program_file("mocurate", f'exec {box.lab.program} "$@"')
    box.job()
    (box.folder / "home" / ".parallel").mkdir()
    (box.folder / "home" / ".parallel" / "will-cite").touch()
    box.call(
        "job.yaml", box.out / "rr;touch PWN;x", "2", program=["/bin/sh", str(ROOT / "examples/gnu_parallel/run.sh")]
    )


@case("G1-slurm-lines", "a line end in -o, slurm.partition, slurm.account, slurm.scratch", CONFIG)
def _(box):
    box.slurm()
    box.job()
    evil = "x\ntouch PWN #"
    for options in (
        ["-o", str(box.out / evil)],
        ["-o", box.out / "a", "--set", 'slurm.partition="x\\ntouch PWN"'],
        ["-o", box.out / "b", "--set", 'slurm.account="x\\ntouch PWN"'],
        ["-o", box.out / "c", "--set", 'slurm.step.partition="x\\ntouch PWN"'],
        ["-o", box.out / "d", "--set", 'slurm.scratch="x\\ntouch PWN"'],
    ):
        box.call("run", "job.yaml", "--executor", "slurm", "--no-wait", *options)
        for script in box.out.rglob("*.sh"):
            box.demand(
                not any(line.startswith(b"touch") for line in script.read_bytes().split(b"\n")),
                f"{script.name} has a line of its own",
            )


@case("J2-jobs", "jobs.jsonl with 10^12 tasks, negative numbers and wrong types", REFUSED)
def _(box):
    slurm = box.slurm_run()
    kept = (slurm / "jobs.jsonl").read_text()
    for line in (
        {"kind": "array", "job": "13", "stage": "ingest", "tasks": 10**12, "items": 10**12},
        {"kind": "array", "job": "13", "stage": "ingest", "tasks": -5, "items": "x"},
        {"kind": ["array"], "job": {"a": 1}, "stage": 7, "tasks": None},
        {"kind": "array", "job": "13", "stage": "../../../outside/thesis", "tasks": 1, "items": 1, "time_s": "soon"},
    ):
        (slurm / "jobs.jsonl").write_text(kept + json.dumps(line) + "\n")
        box.call("jobs", box.out / "rr")


@case("J2-run", "run.json and outcome.json of Slurm with wrong types", REFUSED)
def _(box):
    slurm = box.slurm_run()
    kept = (slurm / "run.json").read_text()
    (slurm / "outcome.json").write_text('{"exit_code": "x", "message": [1]}')
    box.call("jobs", box.out / "rr")
    (slurm / "outcome.json").unlink()
    for change in ({"task_time_s": "x"}, {"budget": "x"}, {"cache": 5}, {"to": None}):
        (slurm / "run.json").write_text(json.dumps({**json.loads(kept), **change}))
        box.call("jobs", box.out / "rr")


@case("jobs-task-journals", "journals of tasks with wrong types, 10^300 s, another run's claims", {0, 3})
def _(box):
    slurm = box.slurm_run()
    with open(slurm / "jobs.jsonl", "a") as jobs:
        jobs.write(json.dumps({"kind": "array", "job": "13", "stage": "ingest", "tasks": 3, "items": 3}) + "\n")
    tasks = box.out / "rr" / "plan" / "ingest"
    tasks.mkdir(parents=True)
    (tasks / "0.jsonl").write_text(
        '{"task": 0, "job": "13", "event": "begun", "time": "x"}\n{"task": 0, "job": "13", "event": 7, "exit_code": "y", "workers": "z"}\n'
    )
    (tasks / "1.jsonl").write_text('{"task": 1, "job": 13, "event": ["begun"]}\n{"peak_memory_bytes": "much"}\n')
    (tasks / "2.claim").write_text('{"process": -1, "host": 5}')
    box.call("jobs", box.out / "rr")


@case("K1-plan", "`plan` of a BVH job without a skeleton", READ)
def _(box):
    box.job()
    for stage in ("ingest", "proportions", "fitting", "canon"):
        box.call(
            "plan", "job.yaml", "--stage", stage, "--tasks", "2", "-o", box.out / f"rr_{stage}", "--leftovers", "100"
        )
