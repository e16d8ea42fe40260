"""A scene in one of VTK's methods, drawn as often as it is requested."""
import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from peer import Unsupported
from vtk_camera import set_camera
from vtk_window import Window


class Scene:
    def __init__(self, method, volume, request):
        self.request = request
        self.center_world = volume.center_world()
        refuse_what_vtk_lacks(volume, request)
        self.renderer = vtkRenderer()
        # The background comes after the picture, and not from here.
        self.renderer.SetBackground(0, 0, 0)
        self.window = Window(self.renderer, request["size"])
        self.drawn = method.make(self.renderer, volume, request, **method.arguments)
        self.note = "; ".join(self.drawn.notes) or None

    def render(self, camera):
        set_camera(self.renderer, camera or self.request["camera"], self.center_world)
        self.window.render()

    def color(self):
        """Linear light, premultiplied."""
        rgba = self.drawn.rgba(self.window)
        if self.request["mode"] in ("mip", "minip"):
            return np.concatenate([linear_from_srgb(rgba[..., :3]), rgba[..., 3:]], axis=2)
        return rgba

    def depth(self):
        return self.drawn.depth(self.renderer, self.window, self.request)


def refuse_what_vtk_lacks(volume, request):
    if request["clip_planes"]:
        raise Unsupported("clip planes are not handed to VTK")
    if request["filter"] != "linear" or request["gradient"] != "central":
        raise Unsupported("VTK interpolates linearly and takes central differences")
    if volume.is_sheared():
        raise Unsupported("the volume's axes are not at right angles")
    if min(volume.dims) < 2:
        raise Unsupported("VTK needs two voxels along every axis")


def linear_from_srgb(encoded):
    encoded = np.clip(encoded, 0, 1)
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
