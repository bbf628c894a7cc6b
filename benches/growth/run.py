#!/usr/bin/env python3
"""Time and peak memory of `lixel plan` as its input grows; prints docs/performance.md's table.

    python3 benches/growth/run.py LIXEL [AXIS ...]        all axes, or triangles pixels lights frames map threads instances

Each row is a run of its own process: CPU time (user and system) and peak memory are the kernel's figures for that
process, wall time and the share of loading are the plan's (`--timings`). The middle one of three runs by CPU time is
shown; scenes above two million triangles run once (ROUNDS=1: all). Exponents are slopes of CPU time between the first and
the last row of an axis, and between the last two.
"""

import json
import math
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time

import scenes

ROUNDS = int(os.environ.get("ROUNDS", 3))
MOST_TRIANGLES = int(os.environ.get("MOST_TRIANGLES", 10_000_000))


def run(lixel, folder, job, threads=2):
    """CPU seconds, wall seconds, peak MB, plan."""
    out = os.path.join(folder, "plan.json")
    begin = time.time()
    child = subprocess.Popen(
        [lixel, "plan", os.path.join(folder, job), "-q", "-o", out, "--timings", "--threads", str(threads)],
        stderr=subprocess.DEVNULL,
    )
    _, status, usage = os.wait4(child.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 3):  # 3: planned, but a bound is not met
        raise SystemExit(f"{job} failed")
    with open(out) as file:
        plan = json.load(file)
    return usage.ru_utime + usage.ru_stime, time.time() - begin, usage.ru_maxrss / 1024, plan


def measured(lixel, folder, job, rounds=ROUNDS, threads=2):
    runs = sorted((run(lixel, folder, job, threads) for _ in range(rounds)), key=lambda r: r[0])
    return runs[len(runs) // 2]


def row(axis, value, result, note=""):
    cpu, wall, peak, plan = result
    t = plan["timings"]
    print(
        f"| {axis} | {value:,} | {cpu:.2f} | {wall:.2f} | {t['load_s']:.2f} | {t['sort_s']:.2f} | "
        f"{t['load_share']:.0%} | {peak:,.0f} | {note} |",
        flush=True,
    )
    return cpu


def made(make, *arguments):
    """Makes a scene in a process of its own: a child's peak memory starts from its parent's."""
    maker = multiprocessing.Process(target=make, args=arguments)
    maker.start()
    maker.join()
    if maker.exitcode != 0:
        raise SystemExit(f"{make.__name__}{arguments} failed")


def exponent(a, b):
    (x0, y0), (x1, y1) = a, b
    return math.log(y1 / y0) / math.log(x1 / x0)


class Axes:
    def __init__(self, lixel, folder):
        self.lixel, self.folder = lixel, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def hills(self, triangles):
        name = f"hills{triangles}.glb"
        if not os.path.exists(self.path(name)):
            made(scenes.hills, self.path(name), triangles)
        return name

    def series(self, axis, values, job, rounds=lambda _: ROUNDS, threads=lambda _: 2, note=lambda _v, _r: ""):
        rows = []
        for value in values:
            job(value)
            result = measured(self.lixel, self.folder, "job.toml", rounds(value), threads(value))
            rows.append((value, row(axis, value, result, note(value, result))))
        if axis != "threads":
            print(f"| {axis} | exponent | {exponent(rows[0], rows[-1]):.2f}, {exponent(*rows[-2:]):.2f} | | | | | | |", flush=True)

    def job(self, scene, quality="[map]\nmax = 2048", **rest):
        # Maps are no larger than that on any axis but their own: their memory would hide that of the triangles.
        scenes.job(self.path("job.toml"), scene, quality=quality, **rest)

    def triangles(self):
        def note(triangles, result):
            file = os.path.getsize(self.path(f"hills{triangles}.glb")) / 2**20
            return f"{(result[2] - file) * 2**20 / triangles:,.0f} B/triangle beyond the file"

        sizes = [n for n in [10_000, 100_000, 1_000_000, 10_000_000] if n <= MOST_TRIANGLES]
        job = lambda n: self.job(self.hills(n))
        self.series("triangles", sizes, job, lambda n: 1 if n > 2_000_000 else ROUNDS, note=note)

    def pixels(self):
        def job(pixels):
            width = round(math.sqrt(pixels * 16 / 9))
            self.job(self.hills(100_000), size=(width, round(pixels / width)))

        self.series("pixels", [129_600, 518_400, 2_073_600], job)

    def lights(self):
        self.series("lights", [1, 4, 16, 64], lambda n: self.job(self.hills(100_000), lights=n, size=(480, 270)),
                    lambda n: 1 if n > 16 else ROUNDS)

    def frames(self):
        job = lambda n: self.job(self.hills(100_000), frames=f"1-{n}", size=(480, 270), quality="[map]\nmax = 2048\n[shot]\ntemporal = 'per-frame'")
        self.series("frames", [1, 4, 16], job)

    def map(self):
        for size in [512, 1024, 2048, 4096]:
            self.job(self.hills(100_000), quality=f"[map]\nmin = {size}\nmax = {size}\nsquare = true")
            row("map side", size, measured(self.lixel, self.folder, "job.toml"))

    def threads(self):
        self.series("threads", [1, 2], lambda _: self.job(self.hills(1_000_000)), threads=lambda n: n)

    def instances(self):
        made(scenes.instances, self.path("rocks.glb"), 77_000, 100)
        for rule in ["auto", "flatten"]:
            self.job("rocks.glb", quality=f"[map]\nmax = 2048\n[visibility]\ninstances = '{rule}'")
            row(f"instances, {rule}", 7_700_000, measured(self.lixel, self.folder, "job.toml"))


def main():
    lixel, axes = os.path.abspath(sys.argv[1]), sys.argv[2:]
    axes = axes or ["triangles", "pixels", "lights", "frames", "map", "threads", "instances"]
    print("| axis | value | CPU s | wall s | load s | sort s | load share | peak MB | |\n|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for axis in axes:
            getattr(Axes(lixel, folder), axis)()


if __name__ == "__main__":
    main()
