// The light that each surface point reflects toward the eye; `toward_light.w` = 1: a headlight.
#include "old/shade.clh"

kernel void reflection(uint count, uint model, float4 numbers, const global float4 *colors, const global float4 *normals,
                       const global float4 *toward_eye, const global float4 *toward_light, global float4 *seen)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    Shading shading;
    shading.reflection = model;
    shading.ambient = numbers.x;
    shading.diffuse = numbers.y;
    shading.specular = numbers.z;
    shading.shininess = numbers.w;
    shading.toward_light = toward_light[i];
    seen[i] = (float4)(reflect_light(shading, colors[i].xyz, normals[i].xyz, toward_eye[i].xyz), 0.0f);
}
