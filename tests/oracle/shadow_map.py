"""A plan's map drawn by Mesa and looked up as the plan's conventions say."""
import ctypes

import moderngl
import numpy as np

VERTEX_SHADER = """
#version 330
in vec4 clip;
in float bias;
flat out float triangle_bias;
void main() { gl_Position = clip; triangle_bias = bias; }
"""
FRAGMENT_SHADER = """
#version 330
flat in float triangle_bias;
void main() { gl_FragDepth = gl_FragCoord.z + triangle_bias; }
"""


class Mesa:
    def __init__(self):
        self.gl = moderngl.create_context(standalone=True, backend="egl")
        self.program = self.gl.program(vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER)
        egl = ctypes.CDLL("libEGL.so.1")
        egl.eglGetProcAddress.restype = ctypes.c_void_p
        image = egl.eglGetProcAddress(b"glTexImage2D")
        self.tex_image_2d = ctypes.CFUNCTYPE(None, *[ctypes.c_int] * 8, ctypes.c_void_p)(image)

    def draw(self, triangles, plan_map):
        """Depths (height, width), row 0 at the bottom, of triangles (n, 3, 3) relative to the plan's origin."""
        clip_from_world = np.array(plan_map["clip_from_world"], float)
        width, height = plan_map["width"], plan_map["height"]
        clip = triangles @ clip_from_world[:, :3].T + clip_from_world[:, 3]
        vertices = np.empty((len(triangles), 3, 5), "f4")
        vertices[:, :, :4] = clip
        vertices[:, :, 4] = triangle_bias(clip, width, height, plan_map["bias"])[:, None]
        texture = self.float_depth_texture(width, height)
        framebuffer = self.gl.framebuffer(depth_attachment=texture)
        framebuffer.use()
        framebuffer.clear(depth=1.0)
        self.gl.enable_only(moderngl.DEPTH_TEST)
        buffer = self.gl.buffer(vertices.tobytes())
        array = self.gl.vertex_array(self.program, [(buffer, "4f 1f", "clip", "bias")])
        array.render(moderngl.TRIANGLES)
        depth = np.frombuffer(texture.read(), "<f4").reshape(height, width).copy()
        for resource in (array, buffer, framebuffer, texture):
            resource.release()
        return depth

    def float_depth_texture(self, width, height):
        """A depth texture of format DEPTH_COMPONENT32F; moderngl itself offers 24 bits only."""
        texture = self.gl.depth_texture((width, height), alignment=4)
        texture.use(0)
        texture_2d, depth_component32f, depth_component, float_type = 0x0DE1, 0x8CAC, 0x1902, 0x1406
        # moderngl binds the released framebuffer of the last map once more, an error without effect: forget it.
        _ = self.gl.error
        self.tex_image_2d(texture_2d, 0, depth_component32f, width, height, 0, depth_component, float_type, None)
        error = self.gl.error
        if error != "GL_NO_ERROR":
            raise SystemExit(f"no float depth texture of {width} x {height}: {error}")
        return texture


def triangle_bias(clip, width, height, bias):
    """constant + min(slope max(|z_u|, |z_v|), clamp) of triangles given in clip space (n, 3, 4).

    Window depth is affine in window x and y: Z = a X + b Y + c w at all three vertices, in homogeneous window space.
    """
    x, y, z, w = np.moveaxis(clip, 2, 0)
    x, y, z = 0.5 * width * (x + w), 0.5 * height * (y + w), 0.5 * (z + w)

    def det(a, b, c):
        return np.einsum("ij,ij->i", a, np.cross(b, c))

    with np.errstate(invalid="ignore", divide="ignore"):
        whole = det(x, y, w)
        steepest = np.maximum(np.abs(det(z, y, w) / whole), np.abs(det(x, z, w) / whole))
    clamp = bias.get("clamp")
    steepest = np.nan_to_num(steepest, nan=0.0, posinf=0.0)
    return bias["constant"] + np.minimum(bias["slope"] * steepest, np.inf if clamp is None else clamp)


def row_at(row, points):
    """a x + b y + c z + d from left to right, each operation rounded: borders fall where the planner has them."""
    a, b, c, d = row
    x, y, z = points.T
    return a * x + b * y + c * z + d


def in_domain(points, domain):
    if domain["kind"] == "all":
        return np.ones(len(points), bool)
    if domain["kind"] == "cube-face":
        p = (points - np.array(domain["position"], float)) @ np.array(domain["axes"], float).T
        # argmax takes the first of equals: x before y before z.
        axis = np.abs(p).argmax(1)
        negative = p[np.arange(len(p)), axis] < 0
        sign, name = domain["face"]
        return (axis == "xyz".index(name)) & (negative == (sign == "-"))
    if domain["kind"] == "half-space":
        return row_at(domain["plane"], points) >= 0
    if domain["kind"] == "view-depth":
        x, y, z = (points - np.array(domain["position"], float)).T
        forward = domain["forward"]
        depth = forward[0] * x + forward[1] * y + forward[2] * z
        return (depth >= domain.get("from", -np.inf)) & (depth < domain.get("to", np.inf))
    if domain["kind"] == "light-plane-rectangle":
        x, y, w = (row_at(row, points) for row in domain["plane_from_world"])
        in_front = w > 0
        w = np.where(in_front, w, 1.0)
        (x_min, y_min), (x_max, y_max) = domain["min"], domain["max"]
        return in_front & (x / w >= x_min) & (y / w >= y_min) & (x / w < x_max) & (y / w < y_max)
    if domain["kind"] == "light-plane-polygon":
        x, y, w = (row_at(row, points) for row in domain["plane_from_world"])
        inside = w > 0
        for a, b, c in domain["sides"]:
            inside &= a * x + b * y + c * w >= 0
        return inside
    if domain["kind"] == "intersection":
        return np.logical_and.reduce([in_domain(points, part) for part in domain["of"]])
    raise SystemExit(f"the domain kind {domain['kind']!r} is not known here")


def look_up(points, maps, depths, outside_shadowed):
    """Shadowed or not, as maps in order answer."""
    shadowed = np.full(len(points), outside_shadowed)
    open_points = np.ones(len(points), bool)
    for plan_map, depth in zip(maps, depths):
        mine = np.flatnonzero(open_points & in_domain(points, plan_map["domain"]))
        open_points[mine] = False
        matrix = np.array(plan_map["clip_from_world"], float)
        x, y, z, w = (points[mine] @ matrix[:, :3].T + matrix[:, 3]).T
        in_front = w > 0
        w = np.where(in_front, w, 1.0)
        u, v = 0.5 + 0.5 * x / w, 0.5 + 0.5 * y / w
        inside = in_front & (u >= 0) & (u < 1) & (v >= 0) & (v < 1)
        height, width = depth.shape
        column = np.floor(u[inside] * width).astype(int).clip(0, width - 1)
        row = np.floor(v[inside] * height).astype(int).clip(0, height - 1)
        receiver = np.clip(0.5 + 0.5 * (z / w)[inside], 0.0, 1.0)
        shadowed[mine[inside]] = depth[row, column] < receiver
    return shadowed
