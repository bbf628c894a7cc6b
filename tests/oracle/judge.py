#!/usr/bin/env python3
"""Judges a plan as an independent consumer: truth by Embree, maps by Mesa, lookups by the plan's conventions.

    python3 tests/oracle/judge.py PLAN [--scene FILE]... [--frames 1,45] [--lights sun] [--offset METRES] [--json]

Exit status 0 when every judged light stays within 1.15 epsilon (plans bounded by misclassified pixels), else 1.
"""
import argparse
import json
import os
import sys
import tomllib

import numpy as np

import scene
from shadow_map import Mesa, look_up
from truth import LIT, SHADOWED, UNLIT, Truth, towards_light

# What counts as met, over epsilon: the plan's own rule for certain and uncertain pixels together.
ALLOWANCE = 1.15
# Offset of shadow rays over the scene's largest coordinate: 17 times the rounding of an f32. On a scan of 431,541
# triangles surfaces begin to shadow themselves below a quarter of it.
OFFSET = 1e-6
# A larger offset that must not change an answer, and the angle to edge-on, for plans that state none.
LARGER_OFFSET_FACTOR = 16.0
EDGE_ON_DEGREES = 0.5


def read_plan(path):
    text = open(path, encoding="utf-8").read()
    return json.loads(text) if text.lstrip().startswith("{") else tomllib.loads(text)


def scene_files(plan, plan_path, given):
    if given:
        return given
    job = plan["job"]
    folder = os.path.join(os.path.dirname(os.path.abspath(plan_path)), job.get("base") or "")
    paths = [entry["path"] if isinstance(entry, dict) else entry for entry in job.get("inputs", [])]
    return [os.path.join(folder, p) for p in paths if p.lower().endswith((".gltf", ".glb", ".obj"))]


def judge_light(truth, mesa, seen, light, options):
    """Counts of one light of one frame, as a dictionary."""
    pixels, positions, normals = seen
    measured = (light.get("error") or {}).get("measured") or {}
    # "Exact" is defined by the offset of the shadow rays, which the plan states; --offset asks another question.
    offset = options.given_offset or measured.get("ray_offset_m") or options.offset
    exact = truth.lit(positions, normals, light, offset)
    larger = max(measured.get("larger_ray_offset_m", 0.0), LARGER_OFFSET_FACTOR * offset)
    lifted = truth.lit(positions, normals, light, larger)
    depths = [mesa.draw(truth.triangles, m) for m in light["maps"]]
    looked_up = look_up(positions, light["maps"], depths, options.outside == "shadowed")

    judged = exact != UNLIT
    false_lit = judged & (exact == SHADOWED) & ~looked_up
    false_shadow = judged & (exact == LIT) & looked_up
    wrong = false_lit | false_shadow
    edge_on = np.sin(np.radians(measured.get("edge_on_degrees", EDGE_ON_DEGREES)))
    uncertain = wrong & ((lifted != exact) | (cosines(positions, normals, light) < edge_on))
    planned = measured.get("misclassified")
    result = {
        "light": light["light"],
        "status": light["status"],
        "maps": [[m["width"], m["height"]] for m in light["maps"]],
        "seen": len(pixels),
        "judged": int(judged.sum()),
        "shadowed": int((exact == SHADOWED).sum()),
        "false_lit": int(false_lit.sum()),
        "false_shadow": int(false_shadow.sum()),
        "wrong": int(wrong.sum()),
        "uncertain": int(uncertain.sum()),
        "offset_m": offset,
        "lixel": planned,
        "lixel_uncertain": measured.get("uncertain"),
        "ratio": None,
    }
    if planned is not None:
        # Like is compared with like: certain pixels.
        result["ratio"] = (result["wrong"] - result["uncertain"]) / planned if planned else None
    return result


def cosines(positions, normals, light):
    towards = towards_light(positions, light)
    return np.einsum("ij,ij->i", normals, towards) / np.linalg.norm(towards, axis=1)


def judge(plan, options):
    mesa = Mesa()
    origin = np.array(plan.get("origin") or [0, 0, 0], float)
    job = plan.get("job") or {}
    options.outside = (job.get("map") or {}).get("outside", "lit")
    bound = (job.get("quality") or {}).get("bound", "misclassified")
    for frame in plan["frames"]:
        if options.frames and frame["frame"] not in options.frames:
            continue
        truth = Truth(scene.triangles_at(options.files, frame["time_s"], job.get("animation") or []) - origin)
        if options.given_offset is None:
            options.offset = OFFSET * float(np.abs(truth.triangles).max(initial=0.0))
        else:
            options.offset = options.given_offset
        camera = frame["camera"]
        seen = truth.see(camera)
        of_pixels = camera["width"] * camera["height"]
        for light in frame["lights"]:
            if options.lights and light["light"] not in options.lights:
                continue
            result = judge_light(truth, mesa, seen, light, options)
            limit = ALLOWANCE * light["epsilon"] * of_pixels if bound == "misclassified" else None
            result |= {"frame": frame["frame"], "of_pixels": of_pixels, "limit": limit,
                       "met": limit is None or result["wrong"] <= limit}
            yield result


def line(result):
    def shown(value, form="{}"):
        return "-" if value is None else form.format(value)

    maps = "+".join(f"{w}x{h}" for w, h in result["maps"][:2]) or "none"
    if len(result["maps"]) > 2:
        maps = f"{len(result['maps'])} maps, {sum(w * h for w, h in result['maps'])}"
    return (
        f"{result['frame']:>6} {result['light']:<12} {maps:<22} {result['shadowed']:>9} {result['false_lit']:>9} "
        f"{result['false_shadow']:>9} {result['wrong']:>8} {result['uncertain']:>9} {shown(result['lixel']):>8} "
        f"{shown(result['ratio'], '{:.3f}'):>6} {shown(result['limit'], '{:.0f}'):>8} {'met' if result['met'] else 'OVER'}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan")
    parser.add_argument("--scene", action="append", help="scene file, instead of the plan's inputs")
    parser.add_argument("--frames", type=lambda s: {int(f) for f in s.split(",")})
    parser.add_argument("--lights", type=lambda s: set(s.split(",")))
    parser.add_argument("--offset", type=float, dest="given_offset", help="of shadow rays, metres")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    plan = read_plan(options.plan)
    options.files = scene_files(plan, options.plan, options.scene)
    if not options.files:
        parser.error("the plan names no scene file: give --scene FILE")
    results = []
    if not options.json:
        print(" frame light        maps                    shadowed false_lit false_shd    wrong uncertain    lixel  ratio    limit")
    for result in judge(plan, options):
        results.append(result)
        if not options.json:
            print(line(result), flush=True)
    if not results:
        parser.error("nothing in the plan matches --frames and --lights")
    met = all(r["met"] for r in results)
    if options.json:
        print(json.dumps({"met": met, "scene": options.files, "lights": results}, indent=1))
    else:
        print(f"shadow rays leave {results[0]['offset_m']:.3g} m off the surface; ratio compares certain pixels")
    sys.exit(0 if met else 1)


if __name__ == "__main__":
    main()
