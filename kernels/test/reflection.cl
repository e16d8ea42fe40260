// The light that each surface point reflects toward the eye; `toward_light.w` = 1: a headlight.
#define LANES 1
#include "lib/light/shade.clh"

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
    Floats3 color = {colors[i].x, colors[i].y, colors[i].z};
    Floats3 normal = {normals[i].x, normals[i].y, normals[i].z};
    Floats3 eye = {toward_eye[i].x, toward_eye[i].y, toward_eye[i].z};
    Floats3 light = reflect_light(shading, color, normal, eye);
    seen[i] = (float4)(light.x, light.y, light.z, 0.0f);
}
