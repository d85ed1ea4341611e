#!/usr/bin/env python3
"""Each rule, repair and audit of the fits switched off once, against the fits with all of them, clip by clip.

    ablate.py BINARIES RESULTS [--only RULE ...] [--runs RUN ...] [--jobs N] [--images FOLDER] [--list]

BINARIES: folder of the bench_* programs. RESULTS: folder of one JSON-lines file per run (RUN.jsonl) and per rule and
run (RUN--RULE.jsonl); those that exist are not made again, so that an interrupted ablation goes on. Prints the tables
of docs/fitting_ablation.md. --list prints the rules, their runs and which results exist. Rules are names of
`fitting.without`, or options by their path below `fitting`. MOCURATE_DATA: recorded sets and body_cc0. Runs take one
thread each. Intervals: 95 %, bootstrap over persons with all of their clips (compare_fits.py)."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

import numpy as np

import compare_fits

TRACKS = "bench_studio_fits 201 5 one 30"
CLOUDS = "bench_fit_clouds 24 15 1311 IMAGES"
MIXED = "bench_fit_keypoints_clouds 24 15 4242 IMAGES subjects=2"
KEYPOINT_RIG = "bench_keypoint_rigs 60 4711 frames=45"
DEPTH_RIG = "bench_depth_rigs 60 15 907 IMAGES"

# Name -> command; IMAGES: the folder of rendered depth images.
RUNS = {
    "tracks": TRACKS,
    "tracks_gap": TRACKS + " gap=1",
    "tracks_long_gap": TRACKS + " gap=2",
    "tracks_limb": "bench_studio_fits 201 1 one 30 limb=2 gap=1",
    "tracks_unseen": "bench_studio_fits 201 2 one 30 unseen=1",
    "tracks_kard": "bench_studio_fits 201 2 one 30 swapped=0 kard=1",
    "tracks_drift": "bench_studio_fits 201 2 one 30 wander=0.025 wander_frames=60",
    "tracks_frozen": "bench_studio_fits 201 2 one 30 frozen=0.02",
    "kard": "bench_held_out kard openni16 150",
    "msr_action3d": "bench_held_out msr_action3d kinect20 150",
    "utkinect": "bench_held_out utkinect kinect20 1000",
    "florence3d": "bench_held_out florence3d openni16 1000",
    "hdm05": "bench_held_out hdm05 cmu31 1000",
    "keypoints": "bench_keypoints 60 4 4 4711 frames=60",
    "keypoints_body25": "bench_keypoints 36 4 4 9101 body_25=1 frames=60",
    "keypoints_human36m": "bench_keypoints 36 0 4 4711 frames=60",
    "keypoints_exchanged": "bench_keypoints 24 4 4 4711 frames=60 exchanged=30",
    "clouds": CLOUDS,
    "clouds_one_view": CLOUDS + " views=1",
    "clouds_gap": "bench_fit_clouds 24 30 1311 IMAGES gap=14",
    "clouds_hidden": CLOUDS + " hidden=7",
    "clouds_room": "bench_fit_clouds 6 12 812 IMAGES room=1",
    "clouds_mix": CLOUDS + " mix=1",
    "keypoints_clouds": MIXED,
    "keypoints_clouds_two": MIXED + " views=2",
    "keypoints_clouds_one": MIXED + " views=1",
    "rig": KEYPOINT_RIG,
    "rig_moved": KEYPOINT_RIG + " moved=0.12 from=20",
    "rig_clock": KEYPOINT_RIG + " clock=0.08",
    "rig_mirrored": KEYPOINT_RIG + " mirrored=1",
    "rig_all_mirrored": KEYPOINT_RIG + " all_mirrored=1",
    "rig_half": KEYPOINT_RIG + " half=1",
    "rig_rotated": KEYPOINT_RIG + " rotated=1",
    "rig_exchanged": KEYPOINT_RIG + " exchanged=2",
    "rig_sides": KEYPOINT_RIG + " sides=1",
    "rig_trials": "bench_keypoint_rigs 0 0 trials=1 frames=45 every=15",
    "depth": DEPTH_RIG,
    "depth_moved": DEPTH_RIG + " moved=0.03 turned=2",
    "depth_far": DEPTH_RIG + " moved=0.3",
    "depth_all_moved": DEPTH_RIG + " moved=0.03 turned=2 all=1",
    "depth_late": DEPTH_RIG + " late=1",
    "depth_very_late": DEPTH_RIG + " late=9",
    "depth_exchanged": DEPTH_RIG + " exchanged=1",
    "depth_depths": DEPTH_RIG + " depths=1.1",
    "depth_mirrored": DEPTH_RIG + " mirrored=1",
}

RECORDED = ["kard", "msr_action3d", "utkinect", "florence3d", "hdm05"]
STUDIO = ["tracks", "tracks_gap", "tracks_drift"]
KEYPOINTS = ["keypoints", "keypoints_body25", "keypoints_human36m"]
DEPTH_FITS = ["clouds", "clouds_one_view", "clouds_mix", "keypoints_clouds"]
ALL_TRACKS = STUDIO + RECORDED + KEYPOINTS

# Rule -> runs that it can move, and codes of the findings that it leaves.
RULES = {
    "body_errors": (ALL_TRACKS + DEPTH_FITS + ["keypoints_clouds_one"], []),
    "uncertainty_calibration": (ALL_TRACKS, []),
    "variance_factor": (ALL_TRACKS, []),
    "least_variance_factor": (ALL_TRACKS, []),
    "unmeasured_noise": (RECORDED, ["noise_not_measured"]),
    "bone_noise": (ALL_TRACKS, []),
    "process_noise_widening": (ALL_TRACKS, []),
    "autocorrelated_error": (ALL_TRACKS, []),
    "persistent_residuals": (ALL_TRACKS, []),
    "gap_inflation": (["tracks_gap", "tracks_long_gap", "tracks_limb"] + RECORDED, []),
    "ambiguous_rig_covariance": (["keypoints"], ["views_disagree"]),
    "low_coverage": (DEPTH_FITS + ["keypoints_clouds_one"], ["low_coverage"]),
    "unknown_shape": (DEPTH_FITS, []),
    "body_error_factor": (DEPTH_FITS + ["keypoints_clouds_one"], ["high_residual"]),
    "patch_share": (DEPTH_FITS + ["keypoints_clouds_one"], []),
    "surface_weight": (["clouds_mix", "keypoints_clouds", "keypoints_clouds_two"], []),
    "variance_inflation": (["keypoints_clouds", "keypoints_clouds_two"], ["modalities_disagree"]),
    "second_start": (["keypoints_clouds", "keypoints_clouds_two"], []),
    "ray_noise": (["keypoints_clouds_one"], ["one_keypoint_view"]),
    "outlier_rejection": (ALL_TRACKS, ["outliers_rejected"]),
    "body_sides": (["tracks", "keypoints_exchanged"] + RECORDED,
                   ["swapped_sides", "sides_exchanged", "views_swap_sides"]),
    "reversed_body": (["tracks"] + RECORDED, ["body_turned"]),
    "person_points": (["clouds", "clouds_room"], ["points_of_the_room"]),
    "restart_after_gap": (["clouds_gap"], []),
    "refit_poor_frames": (["clouds", "clouds_one_view", "clouds_gap"], []),
    "recover_lost_frames": (["clouds", "clouds_one_view", "clouds_gap"], []),
    "repair.swaps": (["tracks"] + RECORDED + ["keypoints"], ["swapped_sides", "body_turned"]),
    "repair.collapsed": (["tracks"] + RECORDED, ["zero_length_bone", "zero_frames", "collapsed_frames"]),
    "repair.position_jumps": (["tracks"] + RECORDED, ["position_jump", "unrecovered_jump"]),
    "repair.bone_violations": (["tracks"] + RECORDED, ["bone_length_violation"]),
    "repair.repeated_values": (["tracks", "tracks_frozen"] + RECORDED, ["repeated_value"]),
    "joint_tracks.contact_process_noise": (STUDIO + RECORDED, []),
    "joint_tracks.recorded_rotations": (["hdm05"], ["rotations_disagree", "rotations_too_few"]),
    "shared_places": (["rig", "depth"], ["cameras_in_one_place"]),
    "clock_widening": (["rig", "rig_clock"], ["camera_clock_off"]),
    "view_sides": (["rig", "rig_sides"], ["view_swaps_sides"]),
    "sides_throughout": (["rig", "rig_sides"], ["view_swaps_sides"]),
    "inconsistent_cameras": (["rig", "rig_moved", "rig_trials"], ["camera_disagrees"]),
    "person_shape": (["rig", "rig_half", "rig_mirrored", "rig_rotated"], []),
    "keypoints.audit.clocks": (["rig", "rig_clock"], ["camera_clock_off"]),
    "keypoints.audit.moved": (["rig", "rig_moved", "rig_trials"], ["camera_moved", "views_disagree"]),
    "keypoints.audit.exchanged": (["rig", "rig_rotated", "rig_exchanged", "rig_mirrored", "rig_all_mirrored",
                                   "rig_half"], ["cameras_exchanged", "view_mirrored", "keypoint_scale"]),
    "keypoints.audit.sides": (["rig", "rig_sides"], ["view_swaps_sides", "views_swap_sides"]),
    "keypoints.audit.order": (["rig"], ["keypoint_order"]),
    "keypoints.audit.unit": (["rig", "rig_half"], ["calibration_unit"]),
    "wrong_depths": (["depth", "depth_far", "depth_depths"], ["camera_depths_off"]),
    "common_fault": (["depth", "depth_depths", "depth_mirrored"], ["camera_depths_off", "view_mirrored"]),
    "far_move": (["depth", "depth_far"], ["camera_moved"]),
    "inconsistent_views": (["depth", "depth_very_late"], ["views_disagree"]),
    "point_clouds.audit.clocks": (["depth", "depth_late"], ["camera_clock_off"]),
    "point_clouds.audit.moved": (["depth", "depth_moved", "depth_all_moved", "depth_far"], ["camera_moved"]),
    "point_clouds.audit.exchanged": (["depth", "depth_exchanged", "depth_mirrored"], ["cameras_exchanged"]),
    "point_clouds.audit.unit": (["depth", "depth_depths"], ["calibration_unit"]),
}

ERRORS = ["joint_mm", "median_mm", "camera_mm"]  # the first that a line has is its error
SPEED = {"frames_per_s"}


def result_file(results, run, rule):
    return results / (f"{run}--{rule}.jsonl" if rule else f"{run}.jsonl")


def make(arguments, run, rule):
    """Runs a benchmark once; returns a message where it failed."""
    file = result_file(arguments.results, run, rule)
    if file.exists():
        return ""
    part = file.with_suffix(".part")
    part.unlink(missing_ok=True)
    command = [word if word != "IMAGES" else str(arguments.images) for word in RUNS[run].split()]
    environment = {**os.environ, "MOCURATE_CLIPS": str(part), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    environment.pop("MOCURATE_WITHOUT", None)
    if rule:
        environment["MOCURATE_WITHOUT"] = rule
    done = subprocess.run([str(arguments.binaries / command[0]), *command[1:]], env=environment,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    if done.returncode != 0 or not part.exists():
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return f"{run} without {rule or 'nothing'}: exit code {done.returncode}: {last}"
    part.rename(file)
    return ""


def read(file):
    """(fit, clip) -> line."""
    return {(fit, clip): line for (_, fit, clip), line in compare_fits.read(file).items()}


def changed(a, b):
    figures = {name for side in (a, b) for name in side["figures"]} - SPEED
    return (a.get("digest") != b.get("digest") or a.get("findings") != b.get("findings")
            or any(a["figures"].get(name) != b["figures"].get(name) for name in figures))


def median_interval(persons, before, after):
    """Of the difference of two medians over the same clips: persons are drawn with all of their clips."""
    places = [np.flatnonzero(persons == person) for person in np.unique(persons)]
    if len(places) == 1:
        places = [places[0][i:i + 1] for i in range(len(places[0]))]
    random = np.random.default_rng(1)
    drawn = []
    for _ in range(compare_fits.DRAWS):
        chosen = np.concatenate([places[i] for i in random.integers(0, len(places), len(places))])
        drawn.append(np.median(after[chosen]) - np.median(before[chosen]))
    return np.percentile(drawn, [2.5, 97.5])


def columns(before, after, keys, figure):
    kept = [key for key in keys if figure in before[key]["figures"] and figure in after[key]["figures"]]
    return (np.array([before[key]["person"] for key in kept]),
            *(np.array([side[key]["figures"][figure] for key in kept], dtype=float) for side in (before, after)))


def with_interval(value, interval, scale, digits):
    return f"{scale * value:+.{digits}f} ({scale * interval[0]:+.{digits}f}, {scale * interval[1]:+.{digits}f})"


def fired(lines, keys, codes):
    return str(sum(any(code in lines[key].get("findings", {}) for code in codes) for key in keys)) if codes else "-"


def paired(arguments, rule, run):
    """Lines with the rule and without it, of clips that both have."""
    before, after = (read(result_file(arguments.results, run, name)) for name in ("", rule))
    versions = {line["version"] for side in (before, after) for line in side.values()}
    if len(versions) > 1:
        sys.exit(f"{run}: results of several versions ({', '.join(sorted(versions))}); use another folder")
    return before, after, sorted(before.keys() & after.keys()), len(before.keys() ^ after.keys())


def fit_rows(arguments, rule, run):
    before, after, keys, lost = paired(arguments, rule, run)
    for fit in sorted({key[0] for key in keys}):
        of_fit = [key for key in keys if key[0] == fit]
        error = next(name for name in ERRORS if name in before[of_fit[0]]["figures"])
        persons, a, b = columns(before, after, of_fit, error)
        cells = [f"{np.median(a):.1f}",
                 with_interval(np.median(b) - np.median(a), median_interval(persons, a, b), 1.0, 2)]
        for figure in ("within_one", "within_two"):
            persons, a, b = columns(before, after, of_fit, figure)
            if len(a) == 0:
                cells += ["-", "-"]
                continue
            cells += [f"{100 * a.mean():.1f}",
                      with_interval((b - a).mean(), compare_fits.interval(persons, b - a), 100.0, 1)]
        moved = sum(changed(before[key], after[key]) for key in of_fit)
        codes = RULES[rule][1]
        print(f"| `{rule}` | {run}, {fit} | {' | '.join(cells)} | {moved} of {len(of_fit)}"
              f"{f', {lost} lost' if lost else ''} | {fired(before, of_fit, codes)} |")


def rig_rows(arguments, rule, run):
    before, after, keys, lost = paired(arguments, rule, run)
    figures = sorted({name for key in keys for side in (before, after) for name in side[key]["figures"]})
    cells = []
    for figure in figures:
        of_side = []
        for side in (before, after):
            values = [side[key]["figures"][figure] for key in keys if figure in side[key]["figures"]]
            count = figure not in ERRORS + ["loss_after"]
            of_side.append("-" if not values else f"{sum(values):g}" if count else f"{np.median(values):.3g}")
        cells.append(f"{figure} {of_side[0]}" + (f" → {of_side[1]}" if of_side[0] != of_side[1] else ""))
    moved = sum(changed(before[key], after[key]) for key in keys)
    print(f"| `{rule}` | {run} | {', '.join(cells)} | {moved} of {len(keys)}{f', {lost} lost' if lost else ''} "
          f"| {fired(before, keys, RULES[rule][1])} |")


def is_rig(run):
    return RUNS[run].split()[0] in ("bench_keypoint_rigs", "bench_depth_rigs")


def print_tables(arguments, pairs):
    ready = [(rule, run) for rule, run in pairs
             if all(result_file(arguments.results, run, name).exists() for name in ("", rule))]
    print("| without | run, fit | error, mm | change of the median | within one, % | change | within two, % | change "
          "| clips changed | clips with its findings |\n|---|---|---|---|---|---|---|---|---|---|")
    for rule, run in ready:
        if not is_rig(run):
            fit_rows(arguments, rule, run)
    print("\n| without | run | all on → without | clips changed | clips with its findings |\n|---|---|---|---|---|")
    for rule, run in ready:
        if is_rig(run):
            rig_rows(arguments, rule, run)
    print("\n| run | clips | findings: clips that have them |\n|---|---|---|")
    for run in dict.fromkeys(run for _, run in ready):
        lines = read(result_file(arguments.results, run, ""))
        codes = sorted({code for line in lines.values() for code in line.get("findings", {})})
        counts = ", ".join(f"{code} {fired(lines, lines, [code])}" for code in codes)
        print(f"| {run} | {len(lines)} | {counts or '-'} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binaries", type=pathlib.Path)
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--only", action="append", metavar="RULE", choices=RULES, help="this rule; may be repeated")
    parser.add_argument("--runs", action="append", metavar="RUN", choices=RUNS, help="in this run; may be repeated")
    parser.add_argument("--jobs", type=int, default=1, help="benchmarks at a time")
    parser.add_argument("--images", type=pathlib.Path, help="folder of depth images; default: RESULTS/images")
    parser.add_argument("--list", action="store_true", help="print rules and runs, make nothing")
    arguments = parser.parse_args()
    arguments.images = arguments.images or arguments.results / "images"
    pairs = [(rule, run) for rule in arguments.only or RULES for run in RULES[rule][0]
             if arguments.runs is None or run in arguments.runs]
    if arguments.list:
        for rule, run in pairs:
            there = result_file(arguments.results, run, rule).exists()
            print(f"{rule}\t{run}\t{'done' if there else 'missing'}\t{RUNS[run]}")
        return
    arguments.images.mkdir(parents=True, exist_ok=True)
    # Runs with all rules first; they also render the images that the others read.
    batches = [list(dict.fromkeys((run, "") for _, run in pairs)), [(run, rule) for rule, run in pairs]]
    failures = []
    for batch in batches:
        jobs = arguments.jobs if batch is not batches[0] else 1
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            for message in pool.map(lambda item: make(arguments, *item), batch):
                if message:
                    failures.append(message)
                    print(message, file=sys.stderr, flush=True)
    print_tables(arguments, pairs)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
