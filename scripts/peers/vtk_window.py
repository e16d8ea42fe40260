"""An off-screen window whose pixels are floats.

Pictures are compared in the sRGB code, where dark levels of linear light lie far apart: eight bits
of linear light would be VTK's error in every dark pixel without being a fault of its casting. So
the framebuffers are made anew in float, by VTK's own means.
"""
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_FLOAT
from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkRenderingOpenGL2 import vtkEGLRenderWindow

DEPTH_BITS = 32


def opengl():
    """The renderer and its version, by OpenGL's own account."""
    window = vtkEGLRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(8, 8)
    window.Render()
    capabilities = dict(line.split(":", 1) for line in window.ReportCapabilities().splitlines() if ":" in line)
    parts = (capabilities.get(f"OpenGL {what} string", "").strip() for what in ("renderer", "version"))
    return ", ".join(part for part in parts if part) or "unknown"


class Window:
    def __init__(self, renderer, size):
        self.size = size
        self.window = vtkEGLRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*size)
        # Before there is anything to draw: this makes the framebuffers.
        self.window.Render()
        for buffer in (self.window.GetRenderFramebuffer(), self.window.GetDisplayFramebuffer()):
            if not buffer.PopulateFramebuffer(*size, True, 1, VTK_FLOAT, True, DEPTH_BITS, 0):
                raise RuntimeError("OpenGL has no float framebuffer")
        self.window.AddRenderer(renderer)
        self.pixels = vtkFloatArray()

    def render(self):
        """Draws, and brings the pixels to the host."""
        self.window.Render()
        width, height = self.size
        self.window.GetRGBAPixelData(0, 0, width - 1, height - 1, 0, self.pixels, 0)

    def rgba(self):
        """The pixels as drawn: rows from the top."""
        width, height = self.size
        return vtk_to_numpy(self.pixels).reshape(height, width, 4)[::-1]

    def z_buffer(self):
        """The depth buffer, 0 at the near and 1 at the far plane: rows from the top."""
        width, height = self.size
        depths = vtkFloatArray()
        self.window.GetZbufferData(0, 0, width - 1, height - 1, depths)
        return vtk_to_numpy(depths).reshape(height, width)[::-1].astype(np.float64)
