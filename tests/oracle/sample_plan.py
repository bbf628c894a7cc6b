#!/usr/bin/env python3
"""A plan without a planner, to try judge.py on: one frame from a view over the scene, a sun that looks at all of it.

    python3 tests/oracle/sample_plan.py SCENE -o PLAN.json [--map 1024x1024] [--film 960x540] [--epsilon 0.01]
"""
import argparse
import json
import os

import numpy as np

import scene


def size(text):
    width, height = text.split("x")
    return int(width), int(height)


def look_along(direction):
    """Rows right, up, backward of a camera that looks along a direction."""
    backward = -np.array(direction, float) / np.linalg.norm(direction)
    right = np.cross([0, 1, 0], backward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(backward, right), backward])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--map", type=size, default=(1024, 1024))
    parser.add_argument("--film", type=size, default=(960, 540))
    parser.add_argument("--epsilon", type=float, default=0.01)
    options = parser.parse_args()
    points = scene.triangles_at([options.scene], 0.0).reshape(-1, 3)
    centre, radius = 0.5 * (points.min(0) + points.max(0)), 0.5 * np.linalg.norm(np.ptp(points, axis=0))

    rotation = look_along([-0.6, -0.5, -0.7])
    eye = centre + 1.6 * radius * rotation[2]
    near, far, cot = 0.1 * radius, 10 * radius, 2.0
    width, height = options.film
    clip_from_camera = np.array([
        [cot * height / width, 0, 0, 0], [0, cot, 0, 0],
        [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)], [0, 0, -1, 0],
    ])
    view = np.eye(4)
    view[:3] = np.concatenate([rotation, -rotation @ eye[:, None]], 1)

    direction = np.array([0.3, -0.8, 0.52])
    direction /= np.linalg.norm(direction)
    low, high = ((points - centre) @ look_along(direction).T).min(0), ((points - centre) @ look_along(direction).T).max(0)
    middle, half = 0.5 * (low + high), 0.505 * (high - low)
    # Depth grows along the light, against the camera's backward axis.
    rows = look_along(direction) / (half * [1, 1, -1])[:, None]
    clip_from_world = np.eye(4)
    clip_from_world[:3, :3] = rows
    clip_from_world[:3, 3] = -rows @ centre - middle / (half * [1, 1, -1])

    shadow_map = {
        "method": "focused", "domain": {"kind": "all"}, "clip_from_world": clip_from_world.tolist(),
        "width": options.map[0], "height": options.map[1], "bias": {"constant": 1e-6, "slope": 1.0, "clamp": 0.01},
    }
    light = {"light": "sun", "kind": "directional", "direction": direction.tolist(), "status": "planned",
             "epsilon": options.epsilon, "maps": [shadow_map]}
    camera = {"name": "sample", "clip_from_world": (clip_from_camera @ view).tolist(), "position": eye.tolist(),
              "width": width, "height": height}
    folder = os.path.dirname(os.path.abspath(options.output))
    plan = {"schema": "lixel.plan/1", "origin": [0, 0, 0],
            "job": {"inputs": [{"path": os.path.relpath(options.scene, folder)}], "map": {"outside": "lit"}},
            "frames": [{"frame": 1, "time_s": 0.0, "camera": camera, "lights": [light]}]}
    with open(options.output, "w", encoding="utf-8") as file:
        json.dump(plan, file, indent=1)


if __name__ == "__main__":
    main()
