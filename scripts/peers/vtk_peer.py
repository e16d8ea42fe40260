#!/usr/bin/env python3
"""VTK as a peer of angioray: `angioray compare VOLUME --peer 'python vtk_peer.py'`."""
import os

from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion

import vtk_scene
import vtk_volume
import vtk_window
from peer import Unsupported, serve
from vtk_methods import METHODS


class Vtk:
    def __init__(self):
        # The wheel's default uses one core.
        vtkSMPTools.SetBackend("STDThread")
        self.volume = None

    def hello(self):
        settings = [{"name": name, "modes": list(method.modes)} for name, method in METHODS.items()]
        device = f"{os.cpu_count()} threads; OpenGL: {vtk_window.opengl()}"
        return {"peer": "vtk", "version": vtkVersion.GetVTKVersion(), "device": device, "settings": settings}

    def load(self, volume):
        self.volume = vtk_volume.Volume(volume)

    def prepare(self, scene):
        if self.volume is None:
            raise Unsupported("no volume is loaded")
        return vtk_scene.Scene(METHODS[scene["setting"]], self.volume, scene)


if __name__ == "__main__":
    serve(Vtk())
