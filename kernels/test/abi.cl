// Sizes and field offsets of the structs shared with the host, as this device lays them out.
//
// Writes, struct after struct, the size and then each field's offset, in bytes.
#include "lib/abi.clh"

#define OFFSET(type, field) (uint)((const private char *)&value.field - (const private char *)&value)

kernel void abi(global uint *layout)
{
    if (get_global_id(0) != 0 || get_global_id(1) != 0)
        return;
    uint n = 0;
    {
        RayGrid value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(RayGrid, origin);
        layout[n++] = OFFSET(RayGrid, origin_dx);
        layout[n++] = OFFSET(RayGrid, origin_dy);
        layout[n++] = OFFSET(RayGrid, origin_low);
        layout[n++] = OFFSET(RayGrid, origin_dx_low);
        layout[n++] = OFFSET(RayGrid, origin_dy_low);
        layout[n++] = OFFSET(RayGrid, dir_index);
        layout[n++] = OFFSET(RayGrid, dir_index_dx);
        layout[n++] = OFFSET(RayGrid, dir_index_dy);
        layout[n++] = OFFSET(RayGrid, dir_index_low);
        layout[n++] = OFFSET(RayGrid, dir_index_dx_low);
        layout[n++] = OFFSET(RayGrid, dir_index_dy_low);
        layout[n++] = OFFSET(RayGrid, dir_world);
        layout[n++] = OFFSET(RayGrid, dir_world_dx);
        layout[n++] = OFFSET(RayGrid, dir_world_dy);
        layout[n++] = OFFSET(RayGrid, base_mm);
        layout[n++] = OFFSET(RayGrid, width);
        layout[n++] = OFFSET(RayGrid, height);
        layout[n++] = OFFSET(RayGrid, pad);
    }
    {
        VolumeGrid value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(VolumeGrid, gradient_row_x);
        layout[n++] = OFFSET(VolumeGrid, gradient_row_y);
        layout[n++] = OFFSET(VolumeGrid, gradient_row_z);
        layout[n++] = OFFSET(VolumeGrid, nx);
        layout[n++] = OFFSET(VolumeGrid, ny);
        layout[n++] = OFFSET(VolumeGrid, nz);
        layout[n++] = OFFSET(VolumeGrid, levels);
    }
    {
        SurfaceCast value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(SurfaceCast, iso);
        layout[n++] = OFFSET(SurfaceCast, step_mm);
        layout[n++] = OFFSET(SurfaceCast, caps);
        layout[n++] = OFFSET(SurfaceCast, refine);
        layout[n++] = OFFSET(SurfaceCast, iterations);
        layout[n++] = OFFSET(SurfaceCast, traverse);
        layout[n++] = OFFSET(SurfaceCast, probe);
        layout[n++] = OFFSET(SurfaceCast, iso_error);
    }
    {
        ProjectionCast value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(ProjectionCast, step_mm);
        layout[n++] = OFFSET(ProjectionCast, sign);
        layout[n++] = OFFSET(ProjectionCast, threshold);
        layout[n++] = OFFSET(ProjectionCast, traverse);
        layout[n++] = OFFSET(ProjectionCast, probe);
        layout[n++] = OFFSET(ProjectionCast, floor);
        layout[n++] = OFFSET(ProjectionCast, pad_0);
        layout[n++] = OFFSET(ProjectionCast, pad_1);
    }
    {
        EmissionCast value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(EmissionCast, step_mm);
        layout[n++] = OFFSET(EmissionCast, unit_length_mm);
        layout[n++] = OFFSET(EmissionCast, max_absorption);
        layout[n++] = OFFSET(EmissionCast, min_transmittance);
        layout[n++] = OFFSET(EmissionCast, knots);
        layout[n++] = OFFSET(EmissionCast, traverse);
        layout[n++] = OFFSET(EmissionCast, bound);
        layout[n++] = OFFSET(EmissionCast, color_spread);
        layout[n++] = OFFSET(EmissionCast, absorbs_from);
        layout[n++] = OFFSET(EmissionCast, absorbs_to);
        layout[n++] = OFFSET(EmissionCast, layers_from);
        layout[n++] = OFFSET(EmissionCast, mm_per_t);
        layout[n++] = OFFSET(EmissionCast, shadow_step_mm);
        layout[n++] = OFFSET(EmissionCast, pad_0);
        layout[n++] = OFFSET(EmissionCast, pad_1);
        layout[n++] = OFFSET(EmissionCast, pad_2);
    }
    {
        LightGrid value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(LightGrid, x);
        layout[n++] = OFFSET(LightGrid, y);
        layout[n++] = OFFSET(LightGrid, over);
        layout[n++] = OFFSET(LightGrid, depth);
        layout[n++] = OFFSET(LightGrid, side);
        layout[n++] = OFFSET(LightGrid, first);
        layout[n++] = OFFSET(LightGrid, spacing_mm);
        layout[n++] = OFFSET(LightGrid, pad);
    }
    {
        LightSource value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(LightSource, place);
        layout[n++] = OFFSET(LightSource, diffuse);
        layout[n++] = OFFSET(LightSource, specular);
        layout[n++] = OFFSET(LightSource, shines_from);
        layout[n++] = OFFSET(LightSource, pad_0);
        layout[n++] = OFFSET(LightSource, pad_1);
        layout[n++] = OFFSET(LightSource, pad_2);
    }
    {
        Jitter value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(Jitter, parts);
        layout[n++] = OFFSET(Jitter, hashed);
        layout[n++] = OFFSET(Jitter, side);
        layout[n++] = OFFSET(Jitter, along_x);
        layout[n++] = OFFSET(Jitter, along_y);
        layout[n++] = OFFSET(Jitter, start);
        layout[n++] = OFFSET(Jitter, pad_0);
        layout[n++] = OFFSET(Jitter, pad_1);
    }
    {
        Shading value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(Shading, color);
        layout[n++] = OFFSET(Shading, ambient);
        layout[n++] = OFFSET(Shading, world_row_x);
        layout[n++] = OFFSET(Shading, world_row_y);
        layout[n++] = OFFSET(Shading, world_row_z);
        layout[n++] = OFFSET(Shading, lights);
        layout[n++] = OFFSET(Shading, light_count);
        layout[n++] = OFFSET(Shading, shininess);
        layout[n++] = OFFSET(Shading, reflection);
        layout[n++] = OFFSET(Shading, shaded_from);
    }
    {
        Tone value;
        layout[n++] = sizeof(value);
        layout[n++] = OFFSET(Tone, background);
        layout[n++] = OFFSET(Tone, brightness);
        layout[n++] = OFFSET(Tone, contrast);
        layout[n++] = OFFSET(Tone, inverse_gamma);
        layout[n++] = OFFSET(Tone, pad);
    }
}
