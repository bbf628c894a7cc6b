"""Scenes of any size, written as GLB: what the growth measurements plan.

hills: one mesh of N triangles, no two alike: a bumpy ground with thin blades on it.
instances: one ragged rock of M triangles, placed K times by EXT_mesh_gpu_instancing, every third mirrored, every second of
    uneven scale, over a ground.
moving: hills, and a rigid rock of M triangles that moves, or with bend = True a morphed one.
"""

import json
import struct

import numpy as np


class Glb:
    """A GLB under construction."""

    def __init__(self):
        self.bin = []
        self.length = 0
        self.json = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "accessors": [], "bufferViews": [],
        }

    def accessor(self, array, kind):
        array = np.ascontiguousarray(array)
        code = {"float32": 5126, "uint32": 5125}[array.dtype.name]
        data = array.tobytes()
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": self.length, "byteLength": len(data)})
        self.bin.append(data)
        self.length += len(data)
        entry = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": code, "count": len(array), "type": kind}
        if kind == "VEC3":
            entry["min"], entry["max"] = array.min(0).tolist(), array.max(0).tolist()
        self.json["accessors"].append(entry)
        return len(self.json["accessors"]) - 1

    def mesh(self, vertices, triangles, **extra):
        primitive = {
            "attributes": {"POSITION": self.accessor(vertices.astype("float32"), "VEC3")},
            "indices": self.accessor(triangles.astype("uint32").reshape(-1), "SCALAR"), **extra,
        }
        self.json["meshes"].append({"primitives": [primitive]})
        return len(self.json["meshes"]) - 1

    def node(self, **node):
        self.json["nodes"].append(node)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)
        return len(self.json["nodes"]) - 1

    def animate(self, node, path, times, values):
        kind = {"translation": "VEC3", "rotation": "VEC4", "weights": "SCALAR"}[path]
        sampler = {"input": self.accessor(np.float32(times), "SCALAR"), "output": self.accessor(np.float32(values), kind)}
        self.json["accessors"][sampler["input"]].update(min=[min(times)], max=[max(times)])
        channel = {"sampler": 0, "target": {"node": node, "path": path}}
        self.json.setdefault("animations", []).append({"samplers": [sampler], "channels": [channel]})

    def write(self, path):
        self.json["buffers"] = [{"byteLength": self.length}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + self.length, len(text), 0x4E4F534A))
            file.write(text)
            file.write(struct.pack("<II", self.length, 0x004E4942))
            for data in self.bin:
                file.write(data)


def ground(triangles, half=50.0):
    """A bumpy ground of about so many triangles."""
    n = max(2, round((triangles / 2) ** 0.5) + 1)
    x, z = np.meshgrid(np.linspace(-half, half, n), np.linspace(-half, half, n))
    y = 2.0 * np.sin(0.11 * x) * np.cos(0.13 * z) + 0.3 * np.sin(1.7 * x + 0.5 * z) + 0.05 * np.sin(9.1 * x) * np.sin(8.3 * z)
    k = np.arange(n * n).reshape(n, n)
    a, b, c, d = k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]
    faces = np.stack([a, b, c, a, c, d], -1).reshape(-1, 3)
    return np.stack([x, y, z], -1).reshape(-1, 3), faces


def blades(count, half=50.0, seed=1):
    """Thin triangles that stand on the ground."""
    random = np.random.default_rng(seed)
    at = random.uniform(-half, half, (count, 2))
    y = 2.0 * np.sin(0.11 * at[:, 0]) * np.cos(0.13 * at[:, 1])
    foot = np.stack([at[:, 0], y - 0.4, at[:, 1]], -1)
    turn = random.uniform(0, 2 * np.pi, count)
    wide = 0.03 * np.stack([np.cos(turn), np.zeros(count), np.sin(turn)], -1)
    tip = foot + np.stack([random.normal(0, 0.1, count), random.uniform(0.6, 1.6, count), random.normal(0, 0.1, count)], -1)
    return np.stack([foot - wide, foot + wide, tip], 1).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def rock(triangles):
    """A closed ragged ball of about so many triangles, radius about 1."""
    n = max(4, round((triangles / 4) ** 0.5))
    polar, around = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, 2 * n, endpoint=False), indexing="ij")
    radius = 1.0 + 0.15 * np.sin(5 * polar) * np.sin(4 * around) + 0.03 * np.sin(31 * polar) * np.sin(29 * around)
    v = np.stack([radius * np.sin(polar) * np.cos(around), radius * np.cos(polar), radius * np.sin(polar) * np.sin(around)], -1)
    k = np.arange((n + 1) * 2 * n).reshape(n + 1, 2 * n)
    a, b = k[:-1], k[1:]
    c, d = np.roll(b, -1, 1), np.roll(a, -1, 1)
    return v.reshape(-1, 3), np.stack([a, c, b, a, d, c], -1).reshape(-1, 3)


def turned(random, count):
    q = random.normal(size=(count, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def hills(path, triangles):
    """Half ground, half blades; one mesh each."""
    glb = Glb()
    glb.node(mesh=glb.mesh(*ground(triangles // 2)))
    glb.node(mesh=glb.mesh(*blades(triangles - triangles // 2)))
    glb.write(path)


def instances(path, triangles, count, seed=2):
    glb, random = Glb(), np.random.default_rng(seed)
    glb.node(mesh=glb.mesh(*ground(20_000)))
    mesh = glb.mesh(*rock(triangles))
    at = random.uniform(-40, 40, (count, 3)) * [1, 0, 1] + [0, 1.5, 0]
    scale = random.uniform(0.5, 2.5, (count, 1)) * np.where(np.arange(count)[:, None] % 2, random.uniform(0.3, 1.5, (count, 3)), 1.0)
    scale[::3, 0] *= -1
    attributes = {
        "TRANSLATION": glb.accessor(np.float32(at), "VEC3"), "SCALE": glb.accessor(np.float32(scale), "VEC3"),
        "ROTATION": glb.accessor(np.float32(turned(random, count)), "VEC4"),
    }
    glb.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    glb.json["extensionsUsed"] = glb.json["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    glb.write(path)


def moving(path, still, triangles, bend=False):
    glb = Glb()
    glb.node(mesh=glb.mesh(*ground(still)))
    vertices, faces = rock(triangles)
    extra = {}
    if bend:
        delta = np.float32(0.4 * np.sin(3 * vertices[:, [1, 2, 0]]))
        extra = {"targets": [{"POSITION": glb.accessor(delta, "VEC3")}]}
    node = glb.node(mesh=glb.mesh(vertices, faces, **extra), translation=[0, 3, 0], scale=[2, 2, 2])
    if bend:
        glb.json["meshes"][-1]["weights"] = [0.0]
        glb.animate(node, "weights", [0.0, 1.0], [0.0, 1.0])
    else:
        glb.animate(node, "rotation", [0.0, 1.0], [[0, 0, 0, 1], [0, 0.7071068, 0, 0.7071068]])
    glb.write(path)


def job(path, scene, *, size=(960, 540), lights=1, frames="1", quality="", solver=""):
    """A job over a scene: a camera that moves a little, suns all around."""
    width, height = size
    suns = ""
    for k in range(lights):
        turn = 2.399963 * k
        direction = [round(float(np.cos(turn)), 6), -0.9, round(float(np.sin(turn)), 6)]
        suns += f"[[light]]\nname = 'sun {k}'\nkind = 'directional'\ndirection = {direction}\n"
    with open(path, "w") as file:
        file.write(
            f"scene = '{scene}'\n[frames]\nrange = '{frames}'\n[image]\nsize = [{width}, {height}]\n"
            f"[quality]\nepsilon = 0.01\n{quality}\n{solver}\n"
            "[camera]\nlook_at = [0.0, 0.0, 0.0]\n[[camera.key]]\nframe = 1\nposition = [38.0, 14.0, 38.0]\n"
            "[[camera.key]]\nframe = 64\nposition = [30.0, 14.0, 44.0]\n" + suns
        )
