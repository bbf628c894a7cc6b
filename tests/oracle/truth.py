"""Exact visibility of a film by Embree: what every pixel sees, and whether a light reaches it.

Embree finds the triangles, in f32; where a ray meets its triangle is then computed again in f64.
"""
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

UNLIT, LIT, SHADOWED = 0, 1, 2


class Truth:
    """A frame's triangles (n, 3, 3), relative to the plan's origin, under Embree."""

    def __init__(self, triangles):
        self.triangles = triangles
        self.scene = EmbreeScene(robust=True)
        TriangleMesh(self.scene, triangles.astype("f4"))
        edges = triangles[:, 1:] - triangles[:, :1]
        self.normals = np.cross(edges[:, 0], edges[:, 1])
        with np.errstate(invalid="ignore"):
            self.normals /= np.linalg.norm(self.normals, axis=1, keepdims=True)

    def see(self, camera):
        """What the pixel centres see: pixel index, position and normal (towards the viewer) of each hit."""
        width, height = camera["width"], camera["height"]
        clip_from_world = np.array(camera["clip_from_world"], float)
        x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
        x, y = x.reshape(-1), y.reshape(-1)
        world_from_clip = np.linalg.inv(clip_from_world)

        def unprojected(z):
            p = np.stack([x, y, np.full_like(x, z), np.ones_like(x)], 1) @ world_from_clip.T
            return p[:, :3] / p[:, 3:]

        origins = unprojected(-1.0)
        if np.allclose(clip_from_world[3, :3], 0.0, atol=1e-12 * abs(clip_from_world[3, 3])):
            directions = unprojected(0.0) - origins
        else:
            directions = origins - np.array(camera["position"], float)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        hit = self.scene.run(origins.astype("f4"), directions.astype("f4"), output=True)["primID"]
        pixels = np.flatnonzero(hit >= 0)
        hit, origins, directions = hit[pixels], origins[pixels], directions[pixels]
        normals = self.normals[hit]
        facing = np.einsum("ij,ij->i", normals, directions)
        with np.errstate(invalid="ignore", divide="ignore"):
            t = np.einsum("ij,ij->i", normals, self.triangles[hit, 0] - origins) / facing
        positions = origins + t[:, None] * directions
        normals = np.where(facing[:, None] > 0, -normals, normals)
        clip = np.concatenate([positions, np.ones((len(positions), 1))], 1) @ clip_from_world.T
        # Beyond the far plane is background.
        seen = np.isfinite(positions).all(1) & (clip[:, 2] <= clip[:, 3] * (1 + 1e-9))
        return pixels[seen], positions[seen], normals[seen]

    def lit(self, positions, normals, light, offset_m):
        """UNLIT (facing away, out of reach), LIT or SHADOWED for each point; shadow rays leave `offset_m` off it."""
        towards = towards_light(positions, light)
        asked = (np.einsum("ij,ij->i", normals, towards) > 0) & reached(positions, light)
        origins = positions[asked] + normals[asked] * offset_m
        towards = towards_light(origins, light)
        distances = np.linalg.norm(towards, axis=1)
        ends = np.full(len(origins), 1e37) if light["kind"] == "directional" else distances - offset_m
        answer = self.scene.run(
            origins.astype("f4"), (towards / distances[:, None]).astype("f4"), ends.astype("f4"), query="OCCLUDED"
        )
        result = np.full(len(positions), UNLIT)
        result[asked] = np.where(answer >= 0, SHADOWED, LIT)
        return result


def towards_light(points, light):
    """From each point to the light; for a directional light a unit vector against its direction."""
    if light["kind"] == "directional":
        direction = np.array(light["direction"], float)
        return np.broadcast_to(-direction / np.linalg.norm(direction), points.shape)
    return np.array(light["position"], float) - points


def reached(points, light):
    """True inside the light's range and cone."""
    inside = np.ones(len(points), bool)
    if light["kind"] == "directional":
        return inside
    away = points - np.array(light["position"], float)
    distances = np.linalg.norm(away, axis=1)
    if light.get("range") is not None:
        inside &= distances <= light["range"]
    if light["kind"] == "spot" and light.get("cone_degrees") is not None:
        axis = np.array(light["direction"], float) / np.linalg.norm(light["direction"])
        inside &= away @ axis >= np.cos(np.radians(light["cone_degrees"])) * distances
    return inside
