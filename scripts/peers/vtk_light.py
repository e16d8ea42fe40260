"""The scene's one white light, and Phong's terms on what it lights.

Ours lights every ray along itself (a headlight) or from one direction, on both sides of a surface.
"""
from vtkmodules.vtkRenderingCore import vtkLight

from peer import Unsupported

WHITE = [1, 1, 1]

#: Blinn's exponent for about the lobe of Phong's, the light being near the eye.
BLINN_OVER_PHONG = 4.0


def toward_light(request):
    """Toward the scene's light, or None for a headlight; refused are lights and material that VTK is not given."""
    lights, phong = request["lights"], request["phong"]
    if not phong:
        return None
    if len(lights) != 1 or "at" in lights[0] or lights[0]["color"] != WHITE:
        raise Unsupported("VTK is given one white light, a headlight or one far away")
    if any(phong[f"{term}_color"] != WHITE for term in ("ambient", "diffuse", "specular")):
        raise Unsupported("VTK is given a material without colours of its own")
    if request["shaded_from"] > 0:
        raise Unsupported("VTK shades a medium whatever its gradient")
    return lights[0].get("toward")


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
