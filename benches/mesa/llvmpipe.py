#!/usr/bin/env python3
"""The rival of benches/raster.rs: the same triangles drawn by Mesa's llvmpipe, depth only, timed to glFinish.

    llvmpipe.py SCENE --sizes 1024,4096 --rounds 9 [--depth PREFIX]   time, one JSON object per size; compare maps
    llvmpipe.py --summary LOG                                         medians and ratios of a log of such objects

Needs EGL with llvmpipe, and the Python packages moderngl and numpy. Set LP_NUM_THREADS before starting.
"""
import argparse
import ctypes
import json
import os
import statistics
import time

import numpy as np

VERTEX_SHADER = """
#version 330
in vec3 position;
uniform mat4 clip_from_scene;
void main() { gl_Position = clip_from_scene * vec4(position, 1.0); }
"""
FRAGMENT_SHADER = "#version 330\nvoid main() {}\n"


def read_scene(path):
    """Matrix by rows (4, 4) f64 and corners (3 n, 3) f32, as benches/raster.rs writes them."""
    data = open(path, "rb").read()
    matrix = np.frombuffer(data, "<f8", 16).reshape(4, 4)
    return matrix, np.frombuffer(data, "<f4", offset=128).reshape(-1, 3)


def first_uses(corners):
    """Vertices without repetition, in order of first use, and indices: what an exporter would write."""
    _, first, inverse = np.unique(corners.view("<u4"), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return corners[first[order]], rank[inverse.reshape(-1)].astype("<u4")


def compare(ours_path, theirs):
    """Texels covered by one only, and depths that differ, ours against theirs."""
    ours = np.fromfile(ours_path, "<f4").reshape(theirs.shape)
    one_only = int(np.count_nonzero((ours == 1) != (theirs == 1)))
    both = (ours != 1) & (theirs != 1)
    difference = np.abs(ours.astype(float) - theirs)[both]
    return {
        "texels": ours.size,
        "covered": int(np.count_nonzero(ours != 1)),
        "covered_by_one_only": one_only,
        "depth_median": float(np.median(difference)),
        "depth_over_1e-6": int(np.count_nonzero(difference > 1e-6)),
        "depth_over_1e-5": int(np.count_nonzero(difference > 1e-5)),
        "depth_over_1e-4": int(np.count_nonzero(difference > 1e-4)),
    }


def float_depth_texture(gl, width, height):
    """A depth texture of format DEPTH_COMPONENT32F; moderngl offers 24 bits only."""
    texture = gl.depth_texture((width, height), alignment=4)
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    image = ctypes.CFUNCTYPE(None, *[ctypes.c_int] * 8, ctypes.c_void_p)(egl.eglGetProcAddress(b"glTexImage2D"))
    texture.use(0)
    texture_2d, depth_component32f, depth_component, float_type = 0x0DE1, 0x8CAC, 0x1902, 0x1406
    image(texture_2d, 0, depth_component32f, width, height, 0, depth_component, float_type, None)
    error = gl.error
    if error != "GL_NO_ERROR":
        raise SystemExit(f"no float depth texture of {width} x {height}: {error}")
    return texture


def run(options):
    import moderngl

    gl = moderngl.create_context(standalone=True, backend="egl")
    matrix, corners = read_scene(options.scene)
    program = gl.program(vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER)
    program["clip_from_scene"].write(np.ascontiguousarray(matrix.T, "<f4").tobytes())
    vertices, indices = first_uses(corners)
    arrays = {
        "soup_ms": gl.vertex_array(program, gl.buffer(corners.tobytes()), "position"),
        "indexed_ms": gl.vertex_array(
            program, [(gl.buffer(vertices.tobytes()), "3f", "position")], gl.buffer(indices.tobytes())
        ),
    }
    gl.enable_only(moderngl.DEPTH_TEST)
    for size in options.sizes:
        texture = float_depth_texture(gl, size, size)
        framebuffer = gl.framebuffer(depth_attachment=texture)
        framebuffer.use()
        result = {"who": "llvmpipe", "size": size, "renderer": gl.info["GL_RENDERER"],
                  "threads": os.environ.get("LP_NUM_THREADS"), "triangles": len(corners) // 3}
        for name, array in arrays.items():
            times = []
            for _ in range(options.rounds + 1):
                gl.finish()
                start = time.perf_counter()
                framebuffer.clear(depth=1.0)
                array.render(moderngl.TRIANGLES)
                gl.finish()
                times.append(1e3 * (time.perf_counter() - start))
            # The first draw compiles shaders.
            result[name] = [round(t, 2) for t in times[1:]]
        if options.depth:
            depth = np.frombuffer(texture.read(), "<f4").reshape(size, size)
            result["compared"] = compare(f"{options.depth}{size}.f32", depth)
        print(json.dumps(result), flush=True)


def summary(path):
    rounds = {}
    compared = {}
    for line in open(path):
        result = json.loads(line)
        for key, values in result.items():
            if key.endswith("_ms"):
                rounds.setdefault((result["size"], result["who"], key), []).extend(values)
        if "compared" in result:
            compared[result["size"]] = result["compared"]
    for size in sorted({size for size, _, _ in rounds}):
        medians = {(who, key): statistics.median(v) for (s, who, key), v in rounds.items() if s == size}
        print(f"{size} x {size}:")
        for (who, key), median in sorted(medians.items()):
            values = rounds[size, who, key]
            print(f"  {who:9} {key:11} median {median:8.2f} ms   least {min(values):8.2f}   {len(values)} rounds")
        rival = min(median for (who, _), median in medians.items() if who == "llvmpipe")
        for key in ("reused_ms", "fresh_ms"):
            print(f"  llvmpipe's better median / lixel {key}: {rival / medians['lixel', key]:.2f}")
        if size in compared:
            print(f"  maps compared: {compared[size]}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--sizes", type=lambda s: [int(t) for t in s.split(",")], default=[1024, 4096])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--depth")
    parser.add_argument("--summary")
    options = parser.parse_args()
    if options.summary:
        summary(options.summary)
    elif options.scene:
        run(options)
    else:
        parser.error("a SCENE or --summary LOG is needed")
