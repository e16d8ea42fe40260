"""Voxels as VTK holds them.

The image has the volume's spacing alone. Where it lies in the world is given by a matrix of the prop
that shows it, which all mappers honour; an image's own direction matrix is not by all.
"""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonMath import vtkMatrix4x4

TYPES = {"u8": np.uint8, "u16": np.uint16, "i16": np.int16, "f32": np.float32}


class Volume:
    def __init__(self, request):
        # VTK reads the array in place.
        self.voxels = np.fromfile(request["file"], TYPES[request["type"]])
        self.dims = request["dims"]
        self.spacing = np.array(request["spacing"])
        self.range = request["range"]
        self.image = vtkImageData()
        self.image.SetDimensions(*self.dims)
        self.image.SetSpacing(*self.spacing)
        self.image.GetPointData().SetScalars(numpy_to_vtk(self.voxels, deep=False))
        #: World from the image's own millimetres: rows of a 4 by 4 matrix.
        self.world_from_image = np.eye(4)
        self.world_from_image[:3, :3] = np.array(request["direction"]).T
        self.world_from_image[:3, 3] = request["origin"]

    def matrix(self):
        matrix = vtkMatrix4x4()
        matrix.DeepCopy(self.world_from_image.ravel())
        return matrix

    def is_sheared(self):
        axes = self.world_from_image[:3, :3]
        return not np.allclose(axes.T @ axes, np.eye(3), atol=1e-6)

    def center_world(self):
        middle = (np.array(self.dims) - 1) / 2 * self.spacing
        return self.world_from_image[:3] @ np.append(middle, 1.0)

    def touches_faces(self, iso):
        """Whether a voxel on one of the volume's faces is at least `iso`."""
        field = self.voxels.reshape(self.dims[::-1])
        faces = (field[0], field[-1], field[:, 0], field[:, -1], field[:, :, 0], field[:, :, -1])
        return any((face >= iso).any() for face in faces)
