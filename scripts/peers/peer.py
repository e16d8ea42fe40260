"""The side of a peer in the talk with angioray: one JSON object a line (README.md).

A renderer is an object with
  hello() -> dict, load(volume) -> None, prepare(scene) -> Scene or Unsupported raised,
and a scene an object with note, render(camera) -> None, color() and depth() -> arrays; the camera
is the scene's own where it is None.
"""
import json
import os
import sys
import time


class Unsupported(Exception):
    """The scene cannot be drawn, and why."""


def milliseconds(work):
    """What `work` gives, and what it took: wall and CPU time of all threads."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return result, 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - cpu)


class Talk:
    def __init__(self, renderer):
        self.renderer = renderer
        self.scenes = {}

    def load(self, volume):
        self.scenes.clear()
        _, ms, _ = milliseconds(lambda: self.renderer.load(volume))
        return {"loaded": ms}

    def scene(self, scene):
        def prepare():
            prepared = self.renderer.prepare(scene)
            # What is made at the first picture (textures, gradients, shaders) is made for all.
            prepared.render(None)
            return prepared

        try:
            prepared, ms, _ = milliseconds(prepare)
        except Unsupported as why:
            return {"supported": False, "why": str(why)}
        self.scenes[scene["id"]] = prepared
        return {"supported": True, "ready": ms, "note": prepared.note}

    def render(self, request):
        scene = self.scenes[request["id"]]
        _, ms, cpu_ms = milliseconds(lambda: scene.render(request.get("camera")))
        answer = {"ms": ms, "cpu_ms": cpu_ms}
        if "color" in request:
            scene.color().astype("<f4").tofile(request["color"])
        if "depth" in request:
            depth = scene.depth()
            answer["depth"] = depth is not None
            if depth is not None:
                depth.astype("<f4").tofile(request["depth"])
        return answer

    def forget(self, _):
        self.scenes.clear()
        return {}

    def answer(self, line):
        try:
            ((what, request),) = json.loads(line).items()
            return {"load": self.load, "scene": self.scene, "render": self.render, "forget": self.forget}[what](request)
        except Exception as error:  # whatever it is, the other side gets it and may continue
            return {"error": f"{type(error).__name__}: {error}"}


def serve(renderer):
    """Talks until the input ends. What libraries print goes to standard error."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def say(answer):
        print(json.dumps(answer), file=out, flush=True)

    say(renderer.hello())
    talk = Talk(renderer)
    for line in sys.stdin:
        say(talk.answer(line))
