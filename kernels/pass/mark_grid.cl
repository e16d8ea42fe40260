// Marks the pixels of a sparse picture that are cast first: the crossings of the lines of a grid whose
// spacing is in pixels, the last column and the last row among them.
//
// Writes cast, MARK_NEXT or MARK_FILLED.
#include "lib/ray/blocks.clh"

kernel void mark_grid(RayGrid rays, uint spacing, global uint *cast)
{
    Pixels pixels = tile_pixels(rays);
    Mask crossing = on_grid_line(pixels.i, spacing, rays.width) & on_grid_line(pixels.j, spacing, rays.height);
    Ints mark = crossing ? INTS((int)MARK_NEXT) : INTS((int)MARK_FILLED);
    SCATTER(pixels.inside, cast, pixels.index, mark);
}
