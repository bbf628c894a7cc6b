#!/usr/bin/env python3
"""Where the triangles of a glTF file are at a time, computed independently of lixel with numpy, and compared with a dump.

    LIXEL_SCENES=folder LIXEL_DUMP=dump cargo test --release --test scene corpus
    python3 tests/oracle/gltf_pose.py scene.glb dump/scene.glb --animation Walk

A dump is a folder with a file `<seconds>.f32` a frame: triangles as nine little-endian f32, in any order, in scene space
(add the origin in `origin.txt`). Printed for each frame: how many triangles either side has, and the largest distance
from a triangle of one side to the nearest of the other, as points of nine coordinates, winding disregarded.

Handled: TRS and matrices, skins with any number of influences, morph targets, EXT_mesh_gpu_instancing,
KHR_node_visibility, KHR_mesh_quantization, sparse accessors, data URIs, all interpolations, KHR_animation_pointer for
nodes and mesh weights. Written from the specifications, with no regard to how lixel does it.
"""

import argparse
import base64
import json
import os
import struct
import urllib.parse

import numpy as np

TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
TOP = {5120: 127.0, 5121: 255.0, 5122: 32767.0, 5123: 65535.0}
UNREADABLE = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class File:
    def __init__(self, path):
        data = open(path, "rb").read()
        binary = None
        if data[:4] == b"glTF":
            size = struct.unpack_from("<I", data, 12)[0]
            self.json = json.loads(data[20 : 20 + size])
            at = 20 + (size + 3) // 4 * 4
            if at < len(data):
                binary = data[at + 8 : at + 8 + struct.unpack_from("<I", data, at)[0]]
        else:
            self.json = json.loads(data)
        unreadable = set(UNREADABLE) & set(self.json.get("extensionsRequired", []))
        if unreadable:
            raise SystemExit(f"{path}: {', '.join(unreadable)} cannot be read here; export without")
        self.buffers = []
        for buffer in self.json.get("buffers", []):
            uri = buffer.get("uri")
            if uri is None:
                self.buffers.append(binary)
            elif uri.startswith("data:"):
                self.buffers.append(base64.b64decode(uri.split(",", 1)[1]))
            else:
                self.buffers.append(open(os.path.join(os.path.dirname(path), urllib.parse.unquote(uri)), "rb").read())

    def raw(self, view, offset, count, component, width):
        view = self.json["bufferViews"][view]
        kind = np.dtype(TYPES[component])
        stride = view.get("byteStride") or kind.itemsize * width
        begin = view.get("byteOffset", 0) + offset
        at = begin + stride * np.arange(count)[:, None] + kind.itemsize * np.arange(width)[None, :]
        bytes_ = np.frombuffer(self.buffers[view["buffer"]], "u1")
        return bytes_[at[:, :, None] + np.arange(kind.itemsize)].copy().view(kind)[..., 0]

    def accessor(self, index):
        a = self.json["accessors"][index]
        component, width, count = a["componentType"], WIDTH[a["type"]], a["count"]
        values = np.zeros((count, width))
        if "bufferView" in a:
            values = self.raw(a["bufferView"], a.get("byteOffset", 0), count, component, width).astype(float)
        if "sparse" in a:
            s = a["sparse"]
            where = self.raw(s["indices"]["bufferView"], s["indices"].get("byteOffset", 0), s["count"], s["indices"]["componentType"], 1)
            values[where[:, 0]] = self.raw(s["values"]["bufferView"], s["values"].get("byteOffset", 0), s["count"], component, width)
        return np.maximum(values / TOP[component], -1.0) if a.get("normalized") else values


def slerp(a, b, u):
    if a @ b < 0:
        b = -b
    angle = 2 * np.arctan2(np.linalg.norm(b - a), np.linalg.norm(b + a))
    if np.sin(angle) < 1e-300:
        return a
    return (np.sin((1 - u) * angle) * a + np.sin(u * angle) * b) / np.sin(angle)


def sample(file, sampler, time, rotation):
    """The value of an animation sampler at a time, as one flat row."""
    keys = file.accessor(sampler["input"])[:, 0]
    mode = sampler.get("interpolation", "LINEAR")
    rows = 3 if mode == "CUBICSPLINE" else 1
    values = file.accessor(sampler["output"]).reshape(len(keys), rows, -1)
    value = values[:, rows // 2]
    if time <= keys[0]:
        return value[0]
    if time >= keys[-1]:
        return value[-1]
    k = int(np.searchsorted(keys, time, side="right")) - 1
    span = keys[k + 1] - keys[k]
    u = (time - keys[k]) / span
    if mode == "STEP":
        return value[k]
    if mode == "LINEAR":
        return slerp(value[k], value[k + 1], u) if rotation else (1 - u) * value[k] + u * value[k + 1]
    h = [2 * u**3 - 3 * u**2 + 1, u**3 - 2 * u**2 + u, -2 * u**3 + 3 * u**2, u**3 - u**2]
    return h[0] * value[k] + h[1] * span * values[k, 2] + h[2] * value[k + 1] + h[3] * span * values[k + 1, 0]


def trs(t, r, s):
    x, y, z, w = np.asarray(r, float) / np.linalg.norm(r)
    m = np.eye(4)
    m[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    m[:3, :3] *= np.asarray(s, float)[None, :]
    m[:3, 3] = t
    return m


def apply(m, v):
    return v @ m[:3, :3].T + m[:3, 3]


def pose(file, time, wanted):
    """Triangles (n, 3, 3) of the default scene at a time, with the animations of the given names playing."""
    j = file.json
    nodes = [dict(n) for n in j.get("nodes", [])]
    mesh_weights = [list(m.get("weights", [])) for m in j.get("meshes", [])]
    for number, animation in enumerate(j.get("animations", [])):
        if (animation.get("name") or f"animation-{number}") not in wanted:
            continue
        for channel in animation["channels"]:
            target, sampler = channel["target"], animation["samplers"][channel["sampler"]]
            if target["path"] == "pointer":
                steps = target["extensions"]["KHR_animation_pointer"]["pointer"].split("/")[1:]
                if steps[0] == "meshes" and steps[2:] == ["weights"]:
                    mesh_weights[int(steps[1])] = list(sample(file, sampler, time, False))
                if steps[0] != "nodes":
                    continue
                node, path = int(steps[1]), "/".join(steps[2:])
            elif "node" in target:
                node, path = target["node"], target["path"]
            else:
                continue
            value = sample(file, sampler, time, path == "rotation")
            if path.startswith("weights/"):
                weights = list(nodes[node].get("weights", mesh_weights[nodes[node]["mesh"]]))
                weights[int(path.split("/")[1])] = value[0]
                nodes[node]["weights"] = weights
            elif path.endswith("visible"):
                extensions = dict(nodes[node].get("extensions", {}))
                nodes[node]["extensions"] = extensions | {"KHR_node_visibility": {"visible": bool(value[0])}}
            else:
                nodes[node][path] = list(value)
    world, hidden = {}, {}
    scene = j["scenes"][j.get("scene", 0)]
    stack = [(n, np.eye(4), False) for n in scene["nodes"]]
    while stack:
        index, above, hides = stack.pop()
        n = nodes[index]
        if "matrix" in n:
            local = np.array(n["matrix"], float).reshape(4, 4).T
        else:
            local = trs(n.get("translation", [0, 0, 0]), n.get("rotation", [0, 0, 0, 1]), n.get("scale", [1, 1, 1]))
        world[index] = above @ local
        hidden[index] = hides or n.get("extensions", {}).get("KHR_node_visibility", {}).get("visible") is False
        stack += [(c, world[index], hidden[index]) for c in n.get("children", [])]
    triangles = [np.zeros((0, 3, 3))]
    for index in world:
        n = nodes[index]
        if "mesh" not in n or hidden[index]:
            continue
        weights = n.get("weights") or mesh_weights[n["mesh"]]
        for primitive in j["meshes"][n["mesh"]]["primitives"]:
            mode = primitive.get("mode", 4)
            if mode < 4 or "POSITION" not in primitive["attributes"]:
                continue
            v = file.accessor(primitive["attributes"]["POSITION"])
            for target, weight in zip(primitive.get("targets", []), weights):
                if "POSITION" in target:
                    v = v + weight * file.accessor(target["POSITION"])
            for placed in places(file, n, primitive, world, index, v):
                ids = np.arange(len(v)) if "indices" not in primitive else file.accessor(primitive["indices"])[:, 0].astype(int)
                if mode == 4:
                    ids = ids[: len(ids) // 3 * 3].reshape(-1, 3)
                elif mode == 5:
                    ids = np.array([ids[k : k + 3] for k in range(len(ids) - 2)]).reshape(-1, 3)
                else:
                    ids = np.array([[ids[0], ids[k], ids[k + 1]] for k in range(1, len(ids) - 1)]).reshape(-1, 3)
                triangles.append(placed[ids])
    return np.concatenate(triangles)


def places(file, n, primitive, world, index, v):
    """World positions of the vertices of a primitive, once for each instance."""
    if "skin" in n:
        skin = file.json["skins"][n["skin"]]
        inverse = np.tile(np.eye(4), (len(skin["joints"]), 1, 1))
        if "inverseBindMatrices" in skin:
            inverse = file.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        matrices = np.array([world[joint] @ inverse[k] for k, joint in enumerate(skin["joints"])])
        total, blend = np.zeros(len(v)), np.zeros((len(v), 4, 4))
        k = 0
        while f"JOINTS_{k}" in primitive["attributes"]:
            joints = file.accessor(primitive["attributes"][f"JOINTS_{k}"]).astype(int)
            weights = file.accessor(primitive["attributes"][f"WEIGHTS_{k}"])
            blend += np.einsum("vi,vijk->vjk", weights, matrices[joints])
            total += weights.sum(1)
            k += 1
        blend /= total[:, None, None]
        return [np.einsum("vij,vj->vi", blend, np.c_[v, np.ones(len(v))])[:, :3]]
    instancing = n.get("extensions", {}).get("EXT_mesh_gpu_instancing")
    if instancing is None:
        return [apply(world[index], v)]
    parts = {name: file.accessor(a) for name, a in instancing["attributes"].items()}
    count = len(next(iter(parts.values())))
    t = parts.get("TRANSLATION", np.zeros((count, 3)))
    r = parts.get("ROTATION", np.tile([0.0, 0, 0, 1], (count, 1)))
    s = parts.get("SCALE", np.ones((count, 3)))
    return [apply(world[index] @ trs(t[k], r[k], s[k]), v) for k in range(count)]


def distance(a, b):
    """Largest distance from a triangle of `a` to the nearest of `b`, either way round."""
    from scipy.spatial import cKDTree

    turned = np.concatenate([b, b[:, [0, 2, 1]]]).reshape(-1, 9)
    return cKDTree(turned).query(a.reshape(-1, 9))[0].max() if len(a) and len(b) else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("dump")
    parser.add_argument("--animation", action="append", default=[])
    args = parser.parse_args()
    file = File(args.scene)
    origin = np.array([float(x) for x in open(os.path.join(args.dump, "origin.txt")).read().split()])
    for name in sorted((n for n in os.listdir(args.dump) if n.endswith(".f32")), key=lambda n: float(n[:-4])):
        time = float(name[:-4])
        dumped = np.fromfile(os.path.join(args.dump, name), "<f4").reshape(-1, 3, 3).astype(float) + origin
        own = pose(file, time, args.animation)
        own = own[np.linalg.norm(np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]), axis=1) > 0]
        size = np.linalg.norm(np.ptp(own.reshape(-1, 3), axis=0))
        there, back = distance(dumped, own), distance(own, dumped)
        print(f"t = {time:.6f} s: {len(dumped)} and {len(own)} triangles, largest difference {max(there, back):.3e} of {size:.3e}")


if __name__ == "__main__":
    main()
