"""VTK's two volume mappers: fixed-point arithmetic on the processor, and OpenGL."""
import ctypes
import os

import numpy as np
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401: registers the OpenGL mappers
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolume, vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper, vtkGPUVolumeRayCastMapper

from peer import Unsupported
from vtk_camera import depth_mm
from vtk_light import add_light, set_phong, toward_light


def show(renderer, volume, mapper, prop):
    shown = vtkVolume()
    shown.SetMapper(mapper)
    shown.SetProperty(prop)
    shown.SetUserMatrix(volume.matrix())
    renderer.AddVolume(shown)


def set_steps(mapper, volume, step_voxels):
    """A ray through every pixel, samples at the given distance, whatever the time."""
    mapper.SetInputData(volume.image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetLockSampleDistanceToInputSpacing(0)
    mapper.SetSampleDistance(step_voxels * volume.spacing.min())
    mapper.SetImageSampleDistance(1.0)


def set_appearance(mapper, prop, volume, request):
    """Blend mode, colours and opacities of a scene."""
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    low, high = volume.range
    mode = request["mode"]
    if mode == "dvr":
        mapper.SetBlendModeToComposite()
        # Two points at one value are a jump.
        color.AllowDuplicateScalarsOn()
        opacity.AllowDuplicateScalarsOn()
        for value, r, g, b, alpha in request["points"]:
            color.AddRGBPoint(value, r, g, b)
            opacity.AddPoint(value, alpha)
        prop.SetScalarOpacityUnitDistance(request["unit_length_mm"])
    elif mode == "iso":
        mapper.SetBlendModeToIsoSurface()
        prop.GetIsoSurfaceValues().SetValue(0, request["iso"])
        for value in (low, high):
            color.AddRGBPoint(value, *request["color"])
            opacity.AddPoint(value, 1)
    else:
        if mode == "mip":
            mapper.SetBlendModeToMaximumIntensity()
        else:
            mapper.SetBlendModeToMinimumIntensity()
        # The grey that is shown, which is linear in the value; decoded when the picture is done.
        black, white = request["window"]
        color.AddRGBPoint(black, 0, 0, 0)
        color.AddRGBPoint(white, 1, 1, 1)
        for value in (low, high):
            opacity.AddPoint(value, 1)
    prop.SetInterpolationTypeToLinear()
    prop.SetColor(color)
    prop.SetScalarOpacity(opacity)


class FixedPoint:
    #: What the mapper's integers call 1.
    ONE = 0x7FFF

    def __init__(self, renderer, volume, request, step_voxels):
        self.notes = []
        mapper = vtkFixedPointVolumeRayCastMapper()
        self.image = mapper.GetRayCastImage()
        set_steps(mapper, volume, step_voxels)
        mapper.SetInteractiveSampleDistance(mapper.GetSampleDistance())
        mapper.SetNumberOfThreads(os.cpu_count())
        mapper.IntermixIntersectingGeometryOff()
        prop = vtkVolumeProperty()
        set_appearance(mapper, prop, volume, request)
        if request["phong"]:
            prop.ShadeOn()
            if toward_light(request) is None and "fov_deg" in request["camera"]:
                self.notes.append("its light falls along the view direction, not along each ray")
            note = set_phong(prop, request["phong"], has="blinn-phong")
            self.notes += [note] if note else []
        add_light(renderer, toward_light(request), at_eye=False)
        show(renderer, volume, mapper, prop)

    def rgba(self, window):
        """The mapper's own image, of the part of the window that the volume covers.

        VTK's window shows it stretched: its outermost pixel centres lie on the quad's edges, half a
        pixel off there, and what lies between is interpolated.
        """
        width, height = window.size
        rgba = np.zeros((height, width, 4), np.float32)
        (stride, rows), (used_width, used_height) = self.image.GetImageMemorySize(), self.image.GetImageInUseSize()
        address = int(self.image.GetImage().split("_")[1], 16)
        held = np.ctypeslib.as_array((ctypes.c_uint16 * (stride * rows * 4)).from_address(address))
        left, bottom = self.image.GetImageOrigin()
        used = held.reshape(rows, stride, 4)[:used_height, :used_width]
        rgba[bottom : bottom + used_height, left : left + used_width] = used / self.ONE
        return rgba[::-1]

    def depth(self, *_):
        return None


class Gpu:
    def __init__(self, renderer, volume, request, step_voxels):
        self.notes = []
        self.mapper = vtkGPUVolumeRayCastMapper()
        set_steps(self.mapper, volume, step_voxels)
        self.mapper.SetUseJittering(0)
        # One read of the voxels is held beside the others' textures.
        self.mapper.SetMaxMemoryFraction(1.0)
        self.mapper.SetDepthImageScalarTypeToFloat()
        prop = vtkVolumeProperty()
        set_appearance(self.mapper, prop, volume, request)
        add_light(renderer, None, at_eye=False)
        if request["phong"]:
            if toward_light(request) is not None:
                raise Unsupported("the GPU mapper is given a headlight only: it adds others' ambient light without the colour")
            if "ortho_height_mm" in request["camera"]:
                self.notes.append("its light falls from one point, not along each ray")
            prop.ShadeOn()
            note = set_phong(prop, request["phong"], has="phong")
            self.notes += [note] if note else []
        if request["mode"] == "iso" and request["caps"] and volume.touches_faces(request["iso"]):
            self.notes.append("surfaces are open at the volume's faces: no caps")
        show(renderer, volume, self.mapper, prop)

    def rgba(self, window):
        return window.rgba()

    def depth(self, renderer, window, request):
        """Of surfaces, from another rendering into an image with depths."""
        if request["mode"] != "iso":
            return None
        self.mapper.RenderToImageOn()
        window.render()
        image = vtkImageData()
        self.mapper.GetDepthImage(image)
        self.mapper.RenderToImageOff()
        width, height = request["size"]
        z_buffer = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width)[::-1]
        return depth_mm(renderer, request["camera"], request["size"], z_buffer.astype(np.float64))
