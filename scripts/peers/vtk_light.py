"""The scene's one white light, and Phong's terms on what it lights.

Ours lights every ray along itself (a headlight) or from one direction, on both sides of a surface.
"""
from vtkmodules.vtkRenderingCore import vtkLight

#: Blinn's exponent for about the lobe of Phong's, the light being near the eye.
BLINN_OVER_PHONG = 4.0


def add_light(renderer, toward_light, at_eye):
    """A distant light, or a headlight: at the eye itself, or along the view direction."""
    light = vtkLight()
    light.SetColor(1, 1, 1)
    # Black by default.
    light.SetAmbientColor(1, 1, 1)
    if toward_light is None:
        light.SetLightTypeToHeadlight()
        if at_eye:
            light.PositionalOn()
            light.SetConeAngle(180)
    else:
        light.SetLightTypeToSceneLight()
        light.SetPosition(*toward_light)
        light.SetFocalPoint(0, 0, 0)
    renderer.AutomaticLightCreationOff()
    renderer.TwoSidedLightingOn()
    renderer.AddLight(light)
    return light


def set_phong(prop, phong, has):
    """Sets the terms of a property whose mapper has `has` ("phong", "blinn-phong"); a note where
    the scene asks for the other."""
    prop.SetAmbient(phong["ambient"])
    prop.SetDiffuse(phong["diffuse"])
    prop.SetSpecular(phong["specular"])
    exponent = phong["shininess"]
    wanted = phong["reflection"]
    if wanted != has:
        exponent = exponent * BLINN_OVER_PHONG if has == "blinn-phong" else exponent / BLINN_OVER_PHONG
    prop.SetSpecularPower(exponent)
    if wanted != has and phong["specular"] > 0:
        return f"its highlights are {has}, with an exponent of {exponent:g}"
    return None
