"""The isosurface as triangles: extracted once, then drawn by OpenGL."""
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from vtk_camera import depth_mm
from vtk_light import add_light, set_phong, toward_light


class Mesh:
    def __init__(self, renderer, volume, request):
        self.notes = []
        surface = vtkFlyingEdges3D()
        surface.SetInputData(volume.image)
        surface.SetValue(0, request["iso"])
        surface.ComputeNormalsOn()
        surface.ComputeScalarsOff()
        surface.Update()
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(surface.GetOutput())
        mapper.ScalarVisibilityOff()
        mapper.SetStatic(1)
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.SetUserMatrix(volume.matrix())
        prop = actor.GetProperty()
        prop.SetColor(*request["color"])
        if request["phong"]:
            prop.SetInterpolationToPhong()
            prop.SetSpecularColor(1, 1, 1)
            note = set_phong(prop, request["phong"], has="phong")
            self.notes += [note] if note else []
        else:
            prop.LightingOff()
        add_light(renderer, toward_light(request), at_eye="fov_deg" in request["camera"])
        if request["caps"] and volume.touches_faces(request["iso"]):
            self.notes.append("surfaces are open at the volume's faces: no caps")
        renderer.AddActor(actor)

    def rgba(self, window):
        return window.rgba()

    def depth(self, renderer, window, request):
        return depth_mm(renderer, request["camera"], request["size"], window.z_buffer())
