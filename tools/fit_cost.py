#!/usr/bin/env python3
"""Fits the cost model to tables of tools/cost_table.sh and judges what --memory chose (docs/cost-model.md).

    tools/fit_cost.py TABLE.csv...

Of each scene the GPU time of the three ray sets is fitted by a + b * (STEP * steps + LOOKUP * lookups + tests), a and b of its own,
STEP and LOOKUP common to all: those of the least relative error, squared and summed over all bakes. Then for every bake with
--memory, and the default, the fastest other bake that takes no more; with a setting that ends in +T, subdivision is not
chosen, so it is one of the others.
"""
import csv
import math
import os
import re
import sys

UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30}


def read_tables(paths):
    scenes = {}
    for path in paths:
        for row in csv.DictReader(open(path)):
            for name in ("bytes", "steps", "lookups", "tests"):
                row[name] = float(row[name])
            row["ms"] = sum(float(row[ray + "_ms"]) for ray in ("camera", "shadow", "diffuse"))
            scenes.setdefault(row["model"], []).append(row)
    return scenes


def fit_line(costs, times):
    """a and b of the least squared error of times / (a + b * cost), relative to the times."""
    weights = [1.0 / t**2 for t in times]
    total = sum(weights)
    mean_cost = sum(w * c for w, c in zip(weights, costs)) / total
    mean_time = sum(w * t for w, t in zip(weights, times)) / total
    above = sum(w * (c - mean_cost) * (t - mean_time) for w, c, t in zip(weights, costs, times))
    below = sum(w * (c - mean_cost) ** 2 for w, c in zip(weights, costs))
    slope = above / below
    return mean_time - slope * mean_cost, slope


def scene_errors(rows, step, lookup):
    costs = [step * r["steps"] + lookup * r["lookups"] + r["tests"] for r in rows]
    times = [r["ms"] for r in rows]
    begin, slope = fit_line(costs, times)
    return begin, slope, [(begin + slope * c) / t - 1.0 for c, t in zip(costs, times)]


def root_mean_square(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def compiled_constants():
    """The two constants that lsbake has."""
    header = open(os.path.join(os.path.dirname(__file__), "../bake/cost_model.h")).read()
    return [float(re.search(rf"#define {name} ([0-9.]+)", header)[1]) for name in ("LS_STEP_COST", "LS_LOOKUP_COST")]


def fit(scenes):
    best = (math.inf, 0.0, 0.0)
    for step in [0.25 * i for i in range(2, 33)]:
        for lookup in [0.25 * i for i in range(0, 33)]:
            errors = [e for rows in scenes.values() for e in scene_errors(rows, step, lookup)[2]]
            best = min(best, (root_mean_square(errors), step, lookup))
    return best


def limit_of(row):
    """Files are a little larger than what tracing takes of them, so a bake's own size counts too."""
    setting = row["setting"]
    memory = 0 if setting == "default" else int(setting[7:-1]) * UNITS[setting[-1]]
    return max(memory, row["bytes"])


def main():
    scenes = read_tables(sys.argv[1:])
    if not scenes:
        sys.exit(__doc__)
    error, step, lookup = fit(scenes)
    print(f"least error: STEP {step:.2f}, LOOKUP {lookup:.2f}, {100 * error:.1f} % (root of the mean square)\n")
    print("| scene | bakes | time by work, ms | error, root of the mean square | largest |\n|---|---|---|---|---|")
    for scene, rows in sorted(scenes.items()):
        begin, slope, errors = scene_errors(rows, *compiled_constants())
        print(f"| {scene} | {len(rows)} | {begin:.3f} + {slope:.4f} work | {100 * root_mean_square(errors):.1f} % | "
              f"{100 * max(map(abs, errors)):.1f} % |")
    print("\n| scene | memory | chosen: cells | MB | ms | best: cells, setting | MB | ms | ratio |\n|---|---|---|---|---|---|---|---|---|")
    for scene, rows in sorted(scenes.items()):
        for row in rows:
            chosen = row["setting"] == "default" or row["setting"].startswith("memory")
            if not chosen or "+" in row["setting"]:
                continue
            best = min((r for r in rows if r["bytes"] <= limit_of(row)), key=lambda r: r["ms"])
            print(f"| {scene} | {row['setting'].replace('memory:', '')} | {row['grid']} | {row['bytes'] / 1e6:.1f} | "
                  f"{row['ms']:.3f} | {best['grid']}, {best['setting']} | {best['bytes'] / 1e6:.1f} | {best['ms']:.3f} | "
                  f"{row['ms'] / best['ms']:.3f} |")


if __name__ == "__main__":
    main()
