"""Scene files -> triangles of a moment, in world space, f64: glTF (.gltf, .glb) and OBJ. Shares no code with lixel."""
import numpy as np

import gltf_pose


def triangles_at(paths, time_s, animations=()):
    """Triangles (n, 3, 3) of all files at a time, with the animations of these names playing."""
    parts = [np.zeros((0, 3, 3))]
    for path in paths:
        if path.lower().endswith(".obj"):
            parts.append(read_obj(path))
        else:
            triangles = gltf_pose.pose(gltf_pose.File(path), time_s, animations)
            # The precision that everyone's vertices have.
            parts.append(triangles.astype("f4").astype(float))
    return np.concatenate(parts)


def read_obj(path):
    positions, triangles = [], []
    for line in open(path, encoding="latin-1"):
        words = line.split()
        if words[:1] == ["v"]:
            positions.append([float(t) for t in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [c - 1 if c > 0 else len(positions) + c for c in corners]
            triangles += [(corners[0], corners[i - 1], corners[i]) for i in range(2, len(corners))]
    return np.array(positions, "f4").astype(float)[np.array(triangles, int).reshape(-1, 3)]
