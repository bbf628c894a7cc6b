"""Scene files -> triangles of a moment, in world space, f64: glTF (.gltf, .glb) and OBJ. Shares no code with lixel."""
import base64
import json
import os
import struct
import urllib.parse

import numpy as np

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
UNREADABLE = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing")


def triangles_at(paths, time_s):
    """Triangles (n, 3, 3) of all files at a time."""
    parts = [np.zeros((0, 3, 3))]
    for path in paths:
        parts.append(read_obj(path) if path.lower().endswith(".obj") else Gltf(path).triangles_at(time_s))
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


class Gltf:
    def __init__(self, path):
        self.folder = os.path.dirname(path)
        data = open(path, "rb").read()
        self.binary = None
        if data[:4] == b"glTF":
            at = 12
            while at + 8 <= len(data):
                length, kind = struct.unpack_from("<I4s", data, at)
                chunk = data[at + 8 : at + 8 + length]
                if kind == b"JSON":
                    self.json = json.loads(chunk)
                elif kind == b"BIN\0" and self.binary is None:
                    self.binary = chunk
                at += 8 + length
        else:
            self.json = json.loads(data)
        unreadable = set(UNREADABLE) & set(self.json.get("extensionsUsed", []))
        if unreadable:
            raise SystemExit(f"{path}: {', '.join(unreadable)} cannot be read here; export without")
        self.buffers = [self.buffer(b) for b in self.json.get("buffers", [])]

    def buffer(self, buffer):
        uri = buffer.get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return open(os.path.join(self.folder, urllib.parse.unquote(uri)), "rb").read()

    def view(self, index, offset, dtype, count, components):
        """`count` rows of `components` values from a buffer view."""
        view = self.json["bufferViews"][index]
        size = np.dtype(dtype).itemsize
        stride = view.get("byteStride", size * components)
        start = view.get("byteOffset", 0) + offset
        return np.ndarray((count, components), dtype, self.buffers[view["buffer"]], start, (stride, size))

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        components = COMPONENTS[accessor["type"]]
        dtype, count = DTYPES[accessor["componentType"]], accessor["count"]
        if "bufferView" in accessor:
            values = self.view(accessor["bufferView"], accessor.get("byteOffset", 0), dtype, count, components).copy()
        else:
            values = np.zeros((count, components), dtype)
        if sparse := accessor.get("sparse"):
            at, by = sparse["indices"], sparse["values"]
            rows = self.view(at["bufferView"], at.get("byteOffset", 0), DTYPES[at["componentType"]], sparse["count"], 1)
            values[rows[:, 0]] = self.view(by["bufferView"], by.get("byteOffset", 0), dtype, sparse["count"], components)
        if accessor.get("normalized"):
            return np.maximum(values / float(np.iinfo(dtype).max), -1.0)
        return values

    def poses(self, time_s):
        """Per node, the properties that animations drive at a time; the first animation of a property wins."""
        poses = {}
        for animation in self.json.get("animations", []):
            for channel in animation["channels"]:
                node, path = channel["target"].get("node"), channel["target"]["path"]
                if node is None or path not in ("translation", "rotation", "scale") or (node, path) in poses:
                    continue
                sampler = animation["samplers"][channel["sampler"]]
                times = self.accessor(sampler["input"])[:, 0].astype(float)
                values = self.accessor(sampler["output"]).astype(float)
                poses[node, path] = sample(times, values, sampler.get("interpolation", "LINEAR"), path, time_s)
        return poses

    def triangles_at(self, time_s):
        poses = self.poses(time_s)
        nodes = self.json.get("nodes", [])
        scene = self.json["scenes"][self.json.get("scene", 0)]
        parts = [np.zeros((0, 3, 3))]
        waiting = [(root, np.eye(4)) for root in scene.get("nodes", [])]
        while waiting:
            index, world_from_parent = waiting.pop()
            node = nodes[index]
            local = {key[1]: value for key, value in poses.items() if key[0] == index}
            world_from_node = world_from_parent @ local_matrix(node, local)
            waiting += [(child, world_from_node) for child in node.get("children", [])]
            if "mesh" in node:
                for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                    local_triangles = self.primitive(primitive)
                    world = local_triangles @ world_from_node[:3, :3].T + world_from_node[:3, 3]
                    # The precision that everyone's vertices have.
                    parts.append(world.astype("f4").astype(float))
        return np.concatenate(parts)

    def primitive(self, primitive):
        mode = primitive.get("mode", 4)
        if mode not in (4, 5, 6):
            return np.zeros((0, 3, 3))
        positions = self.accessor(primitive["attributes"]["POSITION"]).astype(float)
        count = len(positions)
        indices = self.accessor(primitive["indices"])[:, 0].astype(int) if "indices" in primitive else np.arange(count)
        if mode == 4:
            indices = indices[: len(indices) // 3 * 3].reshape(-1, 3)
        elif mode == 5:
            indices = np.stack([indices[:-2], indices[1:-1], indices[2:]], 1)
        else:
            indices = np.stack([np.full(len(indices) - 2, indices[0]), indices[1:-1], indices[2:]], 1)
        return positions[indices]


def sample(times, values, interpolation, path, t):
    """A track at time t; held before its first and after its last key."""
    if interpolation == "CUBICSPLINE":
        in_tangents, values, out_tangents = values[0::3], values[1::3], values[2::3]
    t = min(max(t, times[0]), times[-1])
    k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, max(len(times) - 2, 0)))
    if len(times) == 1 or (interpolation == "STEP" and t < times[k + 1]):
        result = values[k]
    elif interpolation == "STEP":
        result = values[k + 1]
    else:
        span = times[k + 1] - times[k]
        s = (t - times[k]) / span
        a, b = values[k], values[k + 1]
        if interpolation == "CUBICSPLINE":
            m0, m1 = span * out_tangents[k], span * in_tangents[k + 1]
            s2, s3 = s * s, s * s * s
            result = (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * m0 + (3 * s2 - 2 * s3) * b + (s3 - s2) * m1
        elif path == "rotation":
            result = slerp(a / np.linalg.norm(a), b / np.linalg.norm(b), s)
        else:
            result = (1 - s) * a + s * b
    return result / np.linalg.norm(result) if path == "rotation" else result


def slerp(a, b, s):
    cosine = float(a @ b)
    if cosine < 0:
        b, cosine = -b, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-9:
        return (1 - s) * a + s * b
    return (np.sin((1 - s) * angle) * a + np.sin(s * angle) * b) / np.sin(angle)


def local_matrix(node, pose):
    if "matrix" in node and not pose:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = pose.get("rotation", node.get("rotation", [0, 0, 0, 1]))
    rotation = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * np.array(pose.get("scale", node.get("scale", [1, 1, 1])), float)
    matrix[:3, 3] = pose.get("translation", node.get("translation", [0, 0, 0]))
    return matrix
