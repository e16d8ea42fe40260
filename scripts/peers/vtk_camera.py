"""The scene's camera in VTK, and depths along its rays."""
import numpy as np


def set_camera(renderer, request, center_world):
    """Sets the camera and fits the clipping planes to what is shown."""
    eye, forward = np.array(request["eye"]), np.array(request["forward"])
    # Only a direction matters; a point of the volume's own distance keeps digits.
    distance = max(abs(np.dot(center_world - eye, forward)), 1e-3)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*eye)
    camera.SetFocalPoint(*(eye + forward * distance))
    camera.SetViewUp(*request["up"])
    if "fov_deg" in request:
        camera.ParallelProjectionOff()
        camera.SetViewAngle(request["fov_deg"])
    else:
        camera.ParallelProjectionOn()
        camera.SetParallelScale(request["ortho_height_mm"] / 2)
    renderer.ResetCameraClippingRange()


def depth_mm(renderer, request, size, z_buffer):
    """Distances from the eye along the rays; +inf where nothing was drawn."""
    near, far = renderer.GetActiveCamera().GetClippingRange()
    if "ortho_height_mm" in request:
        depth = near + z_buffer * (far - near)
    else:
        ahead = near * far / (far - z_buffer * (far - near))
        depth = ahead * along_ray(request["fov_deg"], size)
    return np.where(z_buffer < 1.0, depth, np.inf)


def along_ray(fov_deg, size):
    """The length of each pixel's ray per length ahead."""
    width, height = size
    half = np.tan(np.radians(fov_deg) / 2)
    across = (2 * np.arange(width) + 1 - width) / height * half
    up = (2 * np.arange(height) + 1 - height) / height * half
    return np.sqrt(1 + across[None, :] ** 2 + up[:, None] ** 2)
