#!/usr/bin/env python3
"""Our readers against NumPy, Python and assimp on the same files: compare_readers.py BENCH_READERS FOLDER [ROUNDS [SET]].

Both sides run in turn, round by round, set by set; each ratio is formed from neighbours in time. Prints a Markdown table."""
import json
import os
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def lines(command):
    return [json.loads(line) for line in subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()]


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    bench, folder = sys.argv[1:3]
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 3
    if not os.path.isdir(folder) or not os.listdir(folder):
        subprocess.run([bench, folder, "make"], check=True)
    print("| set | MB | ours MB/s | against | its MB/s | ratio (least, most) |\n|---|---|---|---|---|---|")
    for name in [sys.argv[4]] if len(sys.argv) > 4 else sorted(os.listdir(folder)):
        ratios, size = {}, 0
        for i in range(rounds):
            sides = [[bench, folder, name, "3"], [sys.executable, os.path.join(HERE, "readers.py"), folder, name, "1"]]
            if i % 2:
                sides.reverse()
            found = [line for side in sides for line in lines(side)]
            ours = next(l for l in found if l["name"] == "read_" + name and "by" not in l)
            size = ours["items"]
            ratios.setdefault("", []).append((ours["items_per_s"], 0, 0))
            for line in found:
                by = line.get("by") or {"assimp": "assimp", "copy": "a copy in memory"}.get(line["name"].split("_")[0])
                if by:
                    ratios.setdefault(by, []).append((ours["items_per_s"], line["items_per_s"], ours["items_per_s"] / line["items_per_s"]))
        for by, rows in ratios.items():
            if not by and len(ratios) > 1:
                continue
            ours, theirs, ratio = (statistics.median(column) for column in zip(*rows))
            tail = "%s | %.0f | %.1f (%.1f, %.1f)" % (by, theirs, ratio, min(r[2] for r in rows), max(r[2] for r in rows)) if by else "- | - | -"
            print("| %s | %.1f | %.0f | %s |" % (name, size, ours, tail), flush=True)


if __name__ == "__main__":
    main()
