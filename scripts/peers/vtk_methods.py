"""VTK's methods of drawing a volume, by the names of the settings."""
from dataclasses import dataclass, field

from vtk_mesh import Mesh
from vtk_ray_cast import FixedPoint, Gpu


@dataclass
class Method:
    #: Makes what draws, of (renderer, volume, scene, **arguments).
    make: type
    modes: tuple
    arguments: dict = field(default_factory=dict)


METHODS = {
    "fixed-point, step 1": Method(FixedPoint, ("mip", "minip", "dvr"), {"step_voxels": 1.0}),
    "fixed-point, step 0.5": Method(FixedPoint, ("mip", "minip", "dvr"), {"step_voxels": 0.5}),
    "gpu mapper, step 1": Method(Gpu, ("iso", "mip", "minip", "dvr"), {"step_voxels": 1.0}),
    "gpu mapper, step 0.5": Method(Gpu, ("iso", "mip", "minip", "dvr"), {"step_voxels": 0.5}),
    "mesh": Method(Mesh, ("iso",)),
}
