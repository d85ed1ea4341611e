#!/usr/bin/env python3
"""Fits compared clip by clip: two versions, or two fits of one version.

    compare_fits.py BEFORE.jsonl AFTER.jsonl
    compare_fits.py CLIPS.jsonl clouds tracks_and_clouds
    compare_fits.py CLIPS.jsonl

The files are written by a fit benchmark with MOCURATE_CLIPS=FILE; those of two versions with the same arguments. Prints
a Markdown table: mean of each figure before and after, the mean difference with its 95 % interval (bootstrap over
persons with all of their clips), and in how many clips the figure rose and fell. Of one file alone: each figure's mean
over all commands with the interval over persons, e.g. coverage of bodies of several seeds. Exit code 1 where the clips or the
commands differ."""
import json
import sys

import numpy as np

DRAWS = 2000


def read(path):
    lines = {}
    for number, text in enumerate(open(path), 1):
        line = json.loads(text)
        key = (line["command"], line["fit"], line["clip"])
        if key in lines:
            sys.exit(f"{path}:{number}: {' '.join(key)} occurs twice; write each version to a file of its own")
        lines[key] = line
    return lines


def interval(persons, differences):
    """Of the mean over clips: persons are drawn with all of their clips."""
    groups = [differences[persons == person] for person in np.unique(persons)]
    if len(groups) == 1:  # clips of one person
        groups = [differences[i:i + 1] for i in range(len(differences))]
    random = np.random.default_rng(1)
    sums = np.array([group.sum() for group in groups])
    counts = np.array([len(group) for group in groups])
    drawn = random.integers(0, len(groups), (DRAWS, len(groups)))
    return np.percentile(sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1), [2.5, 97.5])


def of_fit(lines, fit):
    return {(command, "", clip): line for (command, name, clip), line in lines.items() if name == fit}


def person(line):
    """Numbers of persons are those of their seed, which is in the command."""
    return f"{line['command']} {line['person']}"


def print_means(lines):
    print("| fit | figure | clips | persons | mean | 95 % |")
    print("|---|---|---|---|---|---|")
    for fit in sorted({fit for _, fit, _ in lines}):
        of = [line for (_, name, _), line in lines.items() if name == fit]
        for figure in of[0]["figures"]:
            kept = [line for line in of if figure in line["figures"]]
            values = np.array([line["figures"][figure] for line in kept])
            persons = np.array([person(line) for line in kept])
            low, high = interval(persons, values)
            print(f"| {fit} | {figure} | {len(kept)} | {len(np.unique(persons))} | {values.mean():.4g} "
                  f"| {low:.4g}, {high:.4g} |")


def main():
    if len(sys.argv) == 2:
        return print_means(read(sys.argv[1]))
    if len(sys.argv) == 3:
        before, after = read(sys.argv[1]), read(sys.argv[2])
    elif len(sys.argv) == 4:
        lines = read(sys.argv[1])
        before, after = of_fit(lines, sys.argv[2]), of_fit(lines, sys.argv[3])
    else:
        sys.exit(__doc__)
    if not before:
        sys.exit("the file has no clip of that fit")
    if before.keys() != after.keys():
        only = sorted(before.keys() ^ after.keys())[:3]
        sys.exit(f"different clips or commands, e.g. {'; '.join(' '.join(key) for key in only)}")
    print("| command | fit | figure | clips | before | after | difference (95 %) | rose, fell |")
    print("|---|---|---|---|---|---|---|---|")
    for command, fit in sorted({key[:2] for key in before}):
        keys = [key for key in before if key[:2] == (command, fit)]
        for figure in before[keys[0]]["figures"]:
            kept = [key for key in keys if figure in before[key]["figures"] and figure in after[key]["figures"]]
            a, b = (np.array([side[key]["figures"][figure] for key in kept]) for side in (before, after))
            low, high = interval(np.array([before[key]["person"] for key in kept]), b - a)
            print(f"| {command} | {fit} | {figure} | {len(kept)} | {a.mean():.4g} | {b.mean():.4g} "
                  f"| {(b - a).mean():+.3g} ({low:+.3g}, {high:+.3g}) | {(b > a).sum()}, {(b < a).sum()} |")


if __name__ == "__main__":
    main()
