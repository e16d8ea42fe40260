// The light of two lights that each surface point, in index space's origin, reflects toward the eye. The first is from
// where `place.w` says, LIGHT_FROM_*; the second is at the eye.
#define LANES 1
#include "lib/light/shade.clh"

static inline LightSource light_of_color(float4 numbers, float4 color)
{
    LightSource light;
    light.place = (float4)(0.0f);
    light.diffuse = numbers.y * color;
    light.specular = numbers.z * color;
    light.shines_from = LIGHT_FROM_EYE;
    return light;
}

kernel void reflection(uint count, uint model, float4 numbers, float4 first, float4 second, const global float4 *colors,
                       const global float4 *normals, const global float4 *toward_eye, const global float4 *places,
                       global float4 *seen)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    Shading shading;
    shading.reflection = model;
    shading.ambient = (float4)(numbers.x);
    shading.shininess = numbers.w;
    shading.world_row_x = (float4)(1.0f, 0.0f, 0.0f, 0.0f);
    shading.world_row_y = (float4)(0.0f, 1.0f, 0.0f, 0.0f);
    shading.world_row_z = (float4)(0.0f, 0.0f, 1.0f, 0.0f);
    shading.lights[0] = light_of_color(numbers, first);
    shading.lights[0].place = places[i];
    shading.lights[0].shines_from = (uint)places[i].w;
    shading.lights[1] = light_of_color(numbers, second);
    shading.light_count = 2u;
    Floats3 color = {colors[i].x, colors[i].y, colors[i].z};
    LitPoint point = {{0.0f, 0.0f, 0.0f},
                      {normals[i].x, normals[i].y, normals[i].z},
                      {toward_eye[i].x, toward_eye[i].y, toward_eye[i].z}};
    Floats3 light = reflect_lights(&shading, color, point, FLOATS(1.0f), 0);
    seen[i] = (float4)(light.x, light.y, light.z, 0.0f);
}
