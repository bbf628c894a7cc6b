#!/usr/bin/env python3
"""Plans from the images of another renderer, Mitsuba 3, and measures that plan on the geometry.

    python3 tests/oracle/mitsuba_aov.py JOB --frame 30 [--samples 16] [--depth planar|distance] [--own [--normals]] [--lixel PATH]
            [--keep DIR]

Plans the frame twice from predictions alone: from the scene, and from a depth and shadow layers that Mitsuba renders of it.
Images cannot be looked up by rays, and what is not measured of geometry is not where sides of triangles are left out: the
scene is planned so (quality.measure = "never", map.single_sided = "cull-back"). Then has `lixel verify` draw and count both on
the geometry, both sides of it, the second one at the texels of the first, and prints per light both sizes, in steps of the
size grid, and both counts of wrong pixels.

--samples 1 shoots one ray through each pixel's centre; more are averaged over the pixel by Mitsuba's film (box filter), as
production renderers do. --own takes the images of `lixel render --aov` instead of Mitsuba's, --normals their layer of normals
too. Exit status 0 when counts are at most 5 % over and sizes within one step of the grid, else 1.

Needs numpy, mitsuba but for --own, and scipy for the scene reader.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy as np

import scene

if "--own" in sys.argv:
    mi = None
else:
    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")

# What Mitsuba's film averages into a pixel that sees past everything; lixel takes depths from 1e9 on for background.
BACKGROUND = 1e12
# Counts may differ by this, sizes by one step of the grid and its rounding to texels.
COUNT_TOLERANCE = 0.05
STEP_TOLERANCE = 1.5


class Layers(mi.SamplingIntegrator if mi else object):
    """Depth and, for each light, 1 where it is blocked."""

    def __init__(self, props):
        super().__init__(props)
        self.lights, self.eye, self.axis, self.planar = LIGHTS, EYE, AXIS, PLANAR

    def aov_names(self):
        return ["Z"] + ["shadow_" + light["light"] for light in self.lights]

    def sample(self, scene, sampler, ray, medium=None, active=True):
        return mi.Color3f(0.0), mi.Bool(True), layers(scene, ray, self)


def layers(world, ray, of):
    import drjit as dr
    hit = world.ray_intersect(ray)
    valid = hit.is_valid()
    from_eye = hit.p - mi.Point3f(of.eye)
    depth = dr.dot(from_eye, mi.Vector3f(of.axis)) if of.planar else dr.norm(from_eye)
    values = [dr.select(valid, depth, BACKGROUND)]
    normal = dr.select(dr.dot(hit.n, ray.d) > 0, -hit.n, hit.n)
    for light in of.lights:
        if light.get("position"):
            shadow_ray = hit.spawn_ray_to(mi.Point3f(light["position"]))
            towards = mi.Point3f(light["position"]) - hit.p
        else:
            towards = -mi.Vector3f(light["direction"])
            shadow_ray = hit.spawn_ray(towards)
        faces = valid & (dr.dot(normal, towards) > 0)
        values.append(dr.select(faces & world.ray_test(shadow_ray, faces), 1.0, 0.0))
    return values


def camera_of(plan_camera):
    """Eye, axes (right, up, forward) and vertical field of view of a plan's camera, from its matrix alone."""
    m = np.array(plan_camera["clip_from_world"])
    forward = m[3, :3] / np.linalg.norm(m[3, :3])
    right = m[0, :3] / np.linalg.norm(m[0, :3])
    return np.array(plan_camera["position"]), (right, np.cross(right, forward), forward), 2 * math.atan(1 / np.linalg.norm(m[1, :3]))


def render(triangles, camera, lights, size, samples, planar, path):
    global LIGHTS, EYE, AXIS, PLANAR
    eye, (right, up, forward), fov = camera
    LIGHTS, EYE, AXIS, PLANAR = lights, eye.tolist(), forward.tolist(), planar
    mesh = mi.Mesh("all", vertex_count=3 * len(triangles), face_count=len(triangles))
    buffers = mi.traverse(mesh)
    buffers["vertex_positions"] = triangles.reshape(-1).astype("f4")
    buffers["faces"] = np.arange(3 * len(triangles), dtype="u4")
    buffers.update()
    world = mi.load_dict({"type": "scene", "all": mesh})
    width, height = size
    names = ["Z"] + ["shadow_" + light["light"] for light in lights]
    if samples == 1:
        x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
        tangent = math.tan(fov / 2)
        d = forward + tangent * (width / height * x[..., None] * right + y[..., None] * up)
        d = (d / np.linalg.norm(d, axis=-1, keepdims=True)).reshape(-1, 3).astype("f4")
        holder = type("Of", (), {"lights": lights, "eye": EYE, "axis": AXIS, "planar": planar})
        found = layers(world, mi.Ray3f(mi.Point3f(EYE), mi.Vector3f(d.T)), holder)
        image = np.stack([np.array(v) for v in found], -1).reshape(height, width, -1)
    else:
        mi.register_integrator("layers", Layers)
        sensor = mi.load_dict({
            "type": "perspective", "fov": math.degrees(fov), "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e9,
            "to_world": mi.ScalarTransform4f().look_at(EYE, (eye + forward).tolist(), up.tolist()),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                     "component_format": "float32"},
            "sampler": {"type": "stratified", "sample_count": samples},
        })
        image = np.array(mi.render(world, sensor=sensor, integrator=mi.load_dict({"type": "layers"})))
        image = image[..., -len(names):]
    mi.Bitmap(image.astype("f4"), pixel_format=mi.Bitmap.PixelFormat.MultiChannel, channel_names=names).write(path)


def toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml(v)}" for k, v in value.items() if v is not None) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    return json.dumps(value)


def plan(lixel, job, path, *flags):
    subprocess.run([lixel, "plan", job, "-o", path, *flags, "--quiet"])
    return json.load(open(path))


def predicted(lixel, plan_of_scene, folder):
    """The frames of a plan, beside its inputs, planned again from predictions alone."""
    job = {name: value for name, value in plan_of_scene["job"].items() if name != "inputs" and value is not None}
    job["map"] = dict(job["map"], single_sided="cull-back")
    path = os.path.join(folder, "predicted.toml")
    with open(path, "w") as file:
        file.writelines(f"{name} = {toml(value)}\n" for name, value in job.items())
    return plan(lixel, path, os.path.join(folder, "predicted.plan.json"))["frames"]


def write_job(path, of_scene, lights, camera, size, layers_there):
    eye, (right, up, forward), fov = camera
    rows = np.column_stack([right, up, -forward, eye]).tolist() + [[0, 0, 0, 1]]
    frame = of_scene["frames"][0]["frame"]
    json.dump([{"frame": frame, "matrix": rows}], open(os.path.join(os.path.dirname(path), "camera.json"), "w"))
    keys = [("frames", {"range": str(frame)}), ("image", {"size": list(size)}), ("visibility", {"source": "aov"}),
            ("camera", {"file": "camera.json", "fov": math.degrees(fov)}),
            ("aov", layers_there)]
    keys += [(name, of_scene["job"][name]) for name in ("quality", "map", "sampling", "solver")]
    own = {"directional": ["direction"], "point": ["position", "range"], "spot": ["position", "direction", "range"]}
    with open(path, "w") as file:
        for name, value in keys:
            file.write(f"{name} = {toml(value)}\n")
        for light in lights:
            file.write(f"[[light]]\nname = {toml(light['light'])}\nkind = {toml(light['kind'])}\n")
            for key in own[light["kind"]]:
                if key in light:
                    file.write(f"{key} = {toml(light[key])}\n")
            if "cone_degrees" in light:
                file.write(f"cone = {toml(light['cone_degrees'])}\n")


def wrong_pixels(lixel, maps, folder, name):
    path = os.path.join(folder, name)
    json.dump(maps, open(path, "w"))
    out = subprocess.run([lixel, "verify", path, "--json", "--quiet"], capture_output=True, text=True)
    found = json.loads(out.stdout)
    return {light["light"]: light["measured"] + light["uncertain"] for light in found["lights"]}


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("job")
    parse.add_argument("--frame", type=int, default=1)
    parse.add_argument("--size", default="640x360")
    parse.add_argument("--epsilon", default="0.01")
    parse.add_argument("--samples", type=int, default=16)
    parse.add_argument("--depth", choices=["planar", "distance"], default="planar")
    parse.add_argument("--own", action="store_true", help="images of lixel render --aov")
    parse.add_argument("--normals", action="store_true", help="their layer of normals too")
    parse.add_argument("--lixel", default="target/release/lixel")
    parse.add_argument("--keep", help="folder for images, jobs and plans")
    options = parse.parse_args()
    folder = options.keep or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    lixel = os.path.abspath(options.lixel)
    flags = ["--frames", str(options.frame), "--size", options.size, "--epsilon", options.epsilon, "--measure", "never"]
    geometry = plan(lixel, options.job, os.path.join(folder, "geometry.plan.json"), *flags)
    geometry["frames"] = predicted(lixel, geometry, folder)
    frame = geometry["frames"][0]
    lights = [light for light in frame["lights"] if light["maps"]]
    camera, size = camera_of(frame["camera"]), [int(side) for side in options.size.split("x")]
    inputs = [os.path.join(folder, entry["path"]) for entry in geometry["job"]["inputs"]]
    scenes = [path for path in inputs if path.lower().endswith((".gltf", ".glb", ".obj"))]
    planar = options.own or options.depth == "planar"
    if options.own:
        path = os.path.join(folder, "own.exr")
        own = ["--aov", path, "--size", options.size, "--quiet"]
        subprocess.run([lixel, "render", options.job, "--frames", str(options.frame), *own], check=True)
    else:
        path = os.path.join(folder, "mitsuba.exr")
        triangles = scene.triangles_at(scenes, frame["time_s"], geometry["job"].get("animation", []))
        render(triangles, camera, lights, size, options.samples, planar, path)
    job = os.path.join(folder, "images.toml")
    there = {"file": os.path.basename(path), "depth": {"layer": "Z", "kind": "planar" if planar else "distance"}}
    if options.own and options.normals:
        there["normal"] = {}
    write_job(job, geometry, lights, camera, size, there)
    images = plan(lixel, job, os.path.join(folder, "images.plan.json"))

    by_name = {light["light"]: light for light in images["frames"][0]["lights"]}
    swapped = json.loads(json.dumps(geometry))
    step = math.log(geometry["job"]["map"]["step"])
    texels = lambda light: sum(m["width"] * m["height"] for m in light["maps"])
    for k, light in enumerate(swapped["frames"][0]["lights"]):
        if light["light"] in by_name:
            own = json.loads(json.dumps(by_name[light["light"]]))
            scale = math.sqrt(texels(light) / texels(own))
            for m in own["maps"]:
                m["width"], m["height"] = round(m["width"] * scale), round(m["height"] * scale)
            swapped["frames"][0]["lights"][k] = own
    first = wrong_pixels(lixel, geometry, folder, "geometry.plan.json")
    second = wrong_pixels(lixel, swapped, folder, "swapped.plan.json")
    good = True
    print(f"{'light':<12} {'geometry':>12} {'images':>12} {'steps':>6} {'wrong':>7} {'images':>7} {'ratio':>6}")
    for light in lights:
        name, own = light["light"], by_name[light["light"]]
        steps = math.log(texels(own) / texels(light)) / 2 / step
        ratio = second[name] / max(first[name], 1)
        good &= abs(steps) <= STEP_TOLERANCE and ratio <= 1 + COUNT_TOLERANCE
        sizes = [" ".join(f"{m['width']}x{m['height']}" for m in l["maps"][:1]) + ("+" if len(l["maps"]) > 1 else "") for l in (light, own)]
        print(f"{name:<12} {sizes[0]:>12} {sizes[1]:>12} {steps:>6.1f} {first[name]:>7} {second[name]:>7} {ratio:>6.3f}")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
